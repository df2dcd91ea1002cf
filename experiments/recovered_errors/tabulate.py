"""Measures the masks of generate.py with a program: how far off it is, and how far off it says it is.

    python tabulate.py PROGRAM FOLDER

Cells have V, A and M. Bias, rms and mean standard error are in % of V, of A and, for M, of the integral of
|H|; z is an error in standard errors.
"""

import argparse
import json
import subprocess
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from generate import KINDS, NOISES

# By what share of V and A truth may be unsure.
UNSURE = 0.005
# Column of the program's results and size of the error's unit, by the name in truth.json.
QUANTITIES = {
    "V": ("volume_mm3", "V"),
    "A": ("surface_area_mm2", "A"),
    "M": ("total_mean_curvature_mm", "absolute_M"),
}
COLUMNS = (
    "masks",
    "called noisy",
    "large errors",
    "bias, %",
    "rms, %",
    "standard error, %",
    "rms z",
    "within 1.96",
)


@dataclass
class Measured:
    """One mask; errors and standard errors of V, A and M are shares."""

    kind: str
    noise: str | None
    called_noisy: bool
    large_error: bool
    errors: np.ndarray
    standard_errors: np.ndarray


def results(program, folder):
    """What the program says of all masks, in one run."""
    masks = sorted(folder.glob("*.nii.gz"))
    command = [program, "measure", "-q", "--format", "json", *masks]
    run = subprocess.run(command, stdout=subprocess.PIPE, check=True)
    return json.loads(run.stdout)["results"]


def compared(result, truths):
    """A result with its truth; none where there is no surface or truth is unsure."""
    stem, pose = Path(result["input"]).name.removesuffix(".nii.gz").rsplit("_", 1)
    true = truths[stem]
    if max(true["unsure"]) > UNSURE or result["surface_area_mm2"] is None:
        return None
    names = [(name, column, true[unit]) for name, (column, unit) in QUANTITIES.items()]
    return Measured(
        kind=stem.rsplit("_", 1)[0],
        noise=pose if pose in NOISES else None,
        called_noisy=bool(result["recovery"] and result["recovery"]["noisy"]),
        large_error=any(flag["code"] == "large-error" for flag in result["flags"]),
        errors=np.array([(result[column] - true[name]) / unit for name, column, unit in names]),
        standard_errors=np.array([result["standard_error"][column] / unit for _, column, unit in names]),
    )


def rms(values):
    return np.sqrt((values**2).mean(0))


def cell(values, digits):
    return ", ".join(f"{value:.{digits}f}" for value in values)


def row(name, masks):
    errors = np.array([mask.errors for mask in masks])
    standard_errors = np.array([mask.standard_errors for mask in masks])
    z = errors / standard_errors
    cells = [
        name,
        str(len(masks)),
        str(sum(mask.called_noisy for mask in masks)),
        str(sum(mask.large_error for mask in masks)),
        cell(100 * errors.mean(0), 2),
        cell(100 * rms(errors), 2),
        cell(100 * standard_errors.mean(0), 2),
        cell(rms(z), 2),
        cell((np.abs(z) < 1.96).mean(0), 2),
    ]
    return f"| {' | '.join(cells)} |"


def table(title, masks, group):
    """A row for every group of masks, one for all of them."""
    groups = defaultdict(list)
    for mask in masks:
        groups[group(mask)].append(mask)
    if not groups:
        return
    print(f"\n### {title}\n\n| | {' | '.join(COLUMNS)} |\n|{'---|' * (1 + len(COLUMNS))}")
    for name, members in groups.items():
        print(row(name, members))
    if len(groups) > 1:
        print(row("all", masks))


def by_kind(mask):
    return mask.kind


def by_noise(mask):
    verdict = "called noisy" if mask.called_noisy else "not"
    return f"{mask.noise}, {verdict}"


def main():
    parser = argparse.ArgumentParser(description="Compares a program's results and errors with the truth.")
    parser.add_argument("program")
    parser.add_argument("folder", type=Path)
    arguments = parser.parse_args()
    truths = json.loads((arguments.folder / "truth.json").read_text())
    found = [compared(result, truths) for result in results(arguments.program, arguments.folder)]
    masks = [mask for mask in found if mask is not None]
    masks.sort(key=lambda mask: (list(KINDS).index(mask.kind), mask.noise or "", mask.called_noisy))
    clean = [mask for mask in masks if mask.noise is None]
    noisy = [mask for mask in masks if mask.noise is not None]
    table("Clean, fitted on", [mask for mask in clean if not KINDS[mask.kind].held_out], by_kind)
    table("Clean, held out", [mask for mask in clean if KINDS[mask.kind].held_out], by_kind)
    table("Noisy, fitted on, by kind", noisy, by_kind)
    table("The same by noise", sorted(noisy, key=by_noise), by_noise)
    print(f"\nLeft out, without a surface or with truth unsure by 0.5 %: {len(found) - len(masks)}.")


if __name__ == "__main__":
    main()
