"""The commands of the README and of the book, literally: each page's are run by a shell, one after the other, on files that
built-in shapes stand in for. What a page shows below a command is what it prints, lines left out."""

import os
import pathlib
import re
import shlex
import shutil
import subprocess
import textwrap

import numpy as np
import pytest

from conftest import BINARY, ROOT, surfometry

# What begins otherwise is not run here, and this is why.
NOT_RUN = {
    "cargo ": "builds: .ci/run does it",
    "pip ": "installs: scripts/wheels tries wheels, .ci/run and scripts/test install from here",
    "scripts/": "are the tests themselves, or make releases",
    "PYTHONS=": "makes releases",
    "python3.": "installs what is compared with",
    "a/bin/": "runs what is compared with: minutes, and half a gigabyte",
    "b/bin/": "the same",
    "job=$(sbatch": "needs Slurm: tests/python/test_cohorts.py runs the script",
    "sbatch ": "the same",
}
RUN = ("surfometry ", "head ")
# What takes minutes is asked for less: of a cohort of a hundred bones one, of the zoo one shape; of eight shards there is one.
SHORTER = [
    (r"cohort -o cohort(?=\s+#)", "cohort -o cohort --femurs 0 --vertebrae 1"),
    (r"--vertebrae 3", "--vertebrae 1"),
    (r"validate(?=\s+#)", "validate --shape ball --poses 1 --resolutions 10 --ratios 1"),
    (r"validate(.*) --poses \d+ --resolutions 10,20", r"validate\1 --shape ball --poses 1 --resolutions 10"),
    (r"--shard 3/8 -o shard-3", "--shard 1/1 -o shard-1"),
]
BONE = "ball?radius=12&shift=0.3,0.2,0.1"


def commands(page):
    """Command lines of a page, each with the lines that are shown below it."""
    found = []
    for block in re.findall(r"^ *```console\n(.*?)^ *```$", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL):
        for line in textwrap.dedent(block).splitlines():
            if line.startswith("$ "):
                found.append((line[2:], []))
            elif line:
                found[-1][1].append(line)
    return found


def is_run(command):
    return command.startswith(RUN)


PAGES = [page for page in [ROOT / "README.md", *sorted(ROOT.glob("docs/*.md"))] if any(is_run(c) for c, _ in commands(page))]


@pytest.fixture(scope="module")
def stand_ins(tmp_path_factory):
    """The files that the pages' commands name."""
    place = tmp_path_factory.mktemp("stand_ins")
    for name in ("bone", "scan", "scan1", "part", "later", "core"):
        surfometry("phantom", BONE, "-o", place / f"{name}.nii.gz")
    (place / "scans").mkdir()
    for number in range(3):
        surfometry("phantom", f"ball?radius={12 + number}", "-o", place / "scans" / f"scan{number}.nii.gz")
    labels = np.zeros((24, 30, 60), np.uint8)
    for number, label in enumerate((20, 21, 22)):
        labels[6:18, 6:22, 4 + 18 * number : 16 + 18 * number] = label
    np.save(place / "array.npy", labels)
    import SimpleITK as sitk

    for name in ("scan2.mha", "big.mha", "vertebrae.nii.gz"):
        sitk.WriteImage(sitk.GetImageFromArray(labels), str(place / name))
    sitk.WriteImage(sitk.GetImageFromArray(np.where(labels == 21, 700, -1000).astype(np.int16)), str(place / "ct.nii.gz"))
    scan = sitk.ReadImage(str(place / "scan.nii.gz"))
    z = np.indices(sitk.GetArrayViewFromImage(scan).shape)[0]
    surfometry("map", f"phantom:{BONE}", "-o", place / "phi.nii.gz", "--voxels", "phi", "-q")
    phi = sitk.ReadImage(str(place / "phi.nii.gz"))
    sitk.WriteImage(phi, str(place / "phi.nrrd"))
    probability = 0.5 - sitk.GetArrayFromImage(phi)
    for name, voxels in (("dose", z.astype(np.float32)), ("zones", (1 + z // 10).astype(np.uint8)), ("probability", probability)):
        image = sitk.GetImageFromArray(voxels)
        image.CopyInformation(scan)
        sitk.WriteImage(image, str(place / f"{name}.nii.gz"))
    import zarr

    mask = np.zeros((83, 50, 80), np.uint8)
    mask[20:60, 10:40, 15:65] = 1
    mask.tofile(place / "mask.raw")
    image = zarr.open_group(str(place / "image.zarr"), mode="w", zarr_format=2)
    axes = [{"name": name, "type": "space", "unit": "millimeter"} for name in "zyx"]
    datasets = [{"path": "0", "coordinateTransformations": [{"type": "scale", "scale": [2.5, 2, 1.5]}]}]
    image.create_group("labels").attrs["labels"] = ["nuclei"]
    nuclei = image["labels"].create_group("nuclei")
    nuclei.create_array("0", data=mask, chunks=(32, 32, 32))
    nuclei.attrs["multiscales"] = [{"version": "0.4", "axes": axes, "datasets": datasets}]
    nuclei.attrs["image-label"] = {"version": "0.4"}
    surfometry("map", f"phantom:{BONE}", "-o", place / "bone.stl", "-q")
    surfometry("reference", *sorted((place / "scans").glob("*.nii.gz")), "--format", "csv", "-o", place / "reference.csv")
    inputs = [f"phantom:ball?radius={12.5 + n}" for n in range(3)]
    surfometry("measure", *inputs, "-o", place / "balls.csv")
    header, *rows = (place / "balls.csv").read_text().splitlines()
    (place / "balls.csv").unlink()
    rows = [row.replace(inputs[n], f"scan{n}.nii.gz") for n, row in enumerate(rows)]
    (place / "ours.csv").write_text("\n".join([header, *rows]) + "\n")
    # With names of its own, as another program's table.
    named = [f"{row},scan{n}.nii.gz,{1800 + 300 * n}" for n, row in enumerate(rows)]
    (place / "theirs.csv").write_text("\n".join([f"{header},Image,BS", *named]) + "\n")
    (place / "ours").mkdir()
    shutil.copy(place / "ours.csv", place / "ours")
    return place


def test_every_line_is_run_or_said_why_not():
    lines = {page: [c for c, _ in commands(page)] for page in [ROOT / "README.md", *ROOT.glob("docs/*.md")]}
    assert sum(map(len, lines.values())) > 50
    unknown = [f"{page.name}: {c}" for page, all_ in lines.items() for c in all_ if not is_run(c) and not c.startswith(tuple(NOT_RUN))]
    assert not unknown
    unused = [start for start in NOT_RUN if not any(c.startswith(start) for all_ in lines.values() for c in all_)]
    assert not unused


def problem(command, shown, folder):
    """What is wrong with a command that a page has, or None."""
    run = command
    for long, short in SHORTER:
        run = re.sub(long, short, run)
    environment = {**os.environ, "PATH": f"{pathlib.Path(BINARY).parent}:{os.environ['PATH']}"}
    done = subprocess.run(run, shell=True, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        return f"exit status {done.returncode}: {done.stderr}"
    words = shlex.split(run, comments=True)
    for option in ("-o", "--png", "--chart"):
        for word in (after for before, after in zip(words, words[1:]) if before == option):
            # Where there are several quantities, their names go before the ending.
            stem, _, ending = word.partition(".")
            if not list(folder.glob(f"{stem}*{ending}")):
                return f"{word} was not written"
    # In this order, others between them. Where less is asked for, other numbers come.
    printed = iter(done.stdout.splitlines())
    missing = [line for line in shown if line.rstrip() not in (found.rstrip() for found in printed)]
    return f"does not print {missing[0]!r}\n{done.stdout}" if missing and run == command else None


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_commands_of_a_page(page, stand_ins, tmp_path):
    folder = tmp_path / "files"
    shutil.copytree(stand_ins, folder)
    wrong = [f"$ {c}\n{found}" for c, shown in commands(page) if is_run(c) and (found := problem(c, shown, folder))]
    assert not wrong, "\n\n".join(wrong)


def examples():
    """Commands below the help of the program and of each of its commands; what stands three spaces off tells what for."""
    names = re.findall(r"^  (\w+) ", surfometry("--help").split("Commands:")[1].split("Options:")[0], re.MULTILINE)
    assert len(names) > 10
    helps = [surfometry("--help"), *(surfometry(name, "--help") for name in names if name != "help")]
    assert all("Examples:" in text for text in helps)
    return [re.split(r" {3,}", line)[0] for text in helps for line in re.findall(r"^  (surfometry .*)$", text, re.MULTILINE)]


def test_examples_of_the_help(stand_ins, tmp_path):
    folder = tmp_path / "files"
    shutil.copytree(stand_ins, folder)
    made_before = ["surfometry measure scans/*.nii.gz --shard 1/1 -o shard-1.jsonl", "surfometry measure scan.nii.gz -o results.json"]
    wrong = [f"$ {c}\n{found}" for c in [*made_before, *examples()] if (found := problem(c, [], folder))]
    assert not wrong, "\n\n".join(wrong)
