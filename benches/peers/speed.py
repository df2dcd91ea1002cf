"""surfometry against what users would pick instead: seconds, ratios, memory and errors against truth, in one interleaved run.

Every tool runs on the same masks in turn, five times (slow ones once), each time twice in a process of its own; the least time counts.

    python3.11 -m venv a && a/bin/pip install -r benches/peers/requirements.txt
    python3.9 -m venv b && b/bin/pip install numpy==1.26.4 setuptools wheel versioneer cython \
        && b/bin/pip install --no-build-isolation -r benches/peers/requirements-old.txt
    a/bin/python benches/peers/speed.py --old b/bin/python [--runs 5] [--full] > speed.md
"""

import argparse
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import masks
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
NEW = ["scipy", "itk", "vtk", "scikit-image", "diplib", "pykarambola"]
OLD = ["quantimpy", "pyradiomics"]
# More than ten seconds a run: once, and on the gyroid only with --full.
SLOW = {"itk", "pykarambola", "pyradiomics"}
OURS = ["integrals", "measure", "surface"]
REQUIRED = {"gyroid 256": {"scipy": 100, "vtk": 80, "quantimpy": 2.5}, "torus 0.5 mm": {"scipy": 150, "vtk": 25, "quantimpy": 2}}


def bench(name):
    """Builds a bench of the library without running it; its path."""
    command = ["cargo", "bench", "-p", "surfometry", "--bench", name, "--no-run", "--message-format=json"]
    lines = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.splitlines()
    return [message for message in map(json.loads, lines) if message.get("executable")][-1]["executable"]


def run(command):
    """What a command prints and says on stderr, its seconds on the clock and its peak memory in MiB."""
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        start = time.perf_counter()
        process = subprocess.Popen(command, stdout=out, stderr=err)
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - start
        out.seek(0)
        err.seek(0)
        return (out.read() if status == 0 else ""), err.read(), seconds, usage.ru_maxrss / 1024


def output_and_peak(command):
    """The last line that a command prints, none if it failed, and its peak memory in MiB."""
    text, _, _, peak = run(command)
    return (text.splitlines()[-1] if text else None), peak


class Case:
    """A mask, with what is true of it."""

    def __init__(self, name, path, mask, spacing, sigma, thickness, truth):
        np.save(path, mask)
        self.name, self.path, self.truth = name, str(path), truth
        self.numbers = [str(v) for v in (spacing, sigma, thickness)]
        self.mask = mask


def cases(folder):
    shape = (256, 256, 256)
    gyroid = np.stack([masks.gyroid_slice(shape, z) for z in range(256)]).astype(np.uint8)
    r, R = 10.0, 30.0
    truth = {"V": 2 * math.pi**2 * R * r**2, "A": 4 * math.pi**2 * R * r, "M": 2 * math.pi**2 * R, "chi": 0.0}
    return [
        Case("gyroid 256", folder / "gyroid.npy", gyroid, 1.0, 2.0, 2.5, {}),
        Case("torus 0.5 mm", folder / "torus.npy", masks.torus().astype(np.uint8), 0.5, 1.0, 1.25, truth),
    ]


def ours(binary, case, what):
    h, sigma, thickness = case.numbers
    text, peak = output_and_peak([binary, case.path, sigma, thickness, what, "2", h])
    _, loaded = output_and_peak([binary, case.path, sigma, thickness, "load"])
    result = json.loads(text)
    found = result["found"]
    values = {}
    if "plain" in found:
        keys = ("volume_mm3", "surface_area_mm2", "total_mean_curvature_mm")
        source = found.get("original", found["plain"])
        values = dict(zip("VAM", (source[key] for key in keys)), chi=found["plain"]["euler_characteristic"])
    return {"seconds": result["seconds"], "mib": peak - loaded, **values, "stages": found.get("stages")}


def theirs(python, case, tool):
    text, _ = output_and_peak([python, str(ROOT / "benches/peers/worker.py"), tool, case.path, *case.numbers])
    return json.loads(text) if text else None


def error(values, truth, key):
    if key not in values or key not in truth:
        return "-"
    if key == "chi":
        return f"{values[key] - truth[key]:+.3f}"
    return f"{100 * (values[key] / truth[key] - 1):+.2f} %"


def table(case, best):
    base = best["surfometry integrals"]["seconds"]
    print(f"\n{case.name}: {case.mask.size / 1e6:.1f} M voxels; errors against the original shape\n")
    print("| tool | seconds | x of integrals | MiB beyond the array | V | A | M | chi |")
    print("|---|---|---|---|---|---|---|---|")
    for tool, r in best.items():
        errors = " | ".join(error(r, case.truth, key) for key in ("V", "A", "M", "chi"))
        print(f"| {tool} | {r['seconds']:.4f} | {r['seconds'] / base:.1f} | {r['mib']:.0f} | {errors} |")
    for tool, wanted in REQUIRED[case.name].items():
        if tool in best:
            print(f"\n{tool} / surfometry integrals: {best[tool]['seconds'] / base:.1f} (asked: {wanted})", end="")
    if "vtk" in best:
        print(f"\nvtk / surfometry surface with attributes: {best['vtk']['seconds'] / best['surfometry surface']['seconds']:.1f} (asked, on the gyroid: 10)")


def roofline(case, best, machine):
    """Shares of what the machine could do, stage by stage; operations are counted from the formulas, halos left out."""
    stages, threads = best["surfometry measure"]["stages"], machine["threads"]
    epsilon = 0.5 * math.erf(2.5 / (2 * math.sqrt(2) * 2))
    from scipy import ndimage

    band = int((np.abs(0.5 - ndimage.gaussian_filter(case.mask.astype(np.float32), 2.0)) <= epsilon).sum())
    # Per voxel: two passes of 8 pairs (an addition, a multiplication, an addition) and the centre. Per band voxel: nine stencils of four pairs,
    # and curvature with sums.
    operations = {"embed": case.mask.size * 2 * (8 * 3 + 2), "derive": band * 9 * 4 * 3, "integrate": band * 150}
    read = case.mask.size / machine["bytes_a_second"]
    print(f"\nRoofline of {case.name}: {machine['bytes_a_second'] / 1e9:.1f} GB/s, {machine['flops'] / 1e9:.0f} Gflop/s on {threads} threads; ")
    least = read + sum(operations.values()) / machine["flops"]
    print(f"reading the mask {1000 * read:.1f} ms, all operations {1000 * (least - read):.1f} ms; reached {1000 * best['surfometry integrals']['seconds']:.1f} ms: {100 * least / best['surfometry integrals']['seconds']:.0f} % of the limit\n")
    print("| stage | thread-ms | Gflop | share of peak |\n|---|---|---|---|")
    for stage, count in operations.items():
        share = count / (stages[stage] / threads) / machine["flops"]
        print(f"| {stage} | {1000 * stages[stage]:.0f} | {count / 1e9:.2f} | {100 * share:.0f} % |")
    for stage in ("surface", "topology"):
        print(f"| {stage} | {1000 * stages[stage]:.0f} | - | - |")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--old", help="a Python with requirements-old.txt")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--full", action="store_true", help="slow tools on the gyroid too")
    options = parser.parse_args()
    binary, machine = bench("whole_run"), json.loads(output_and_peak([bench("roofline")])[0])
    tools = [(tool, sys.executable) for tool in NEW] + [(tool, options.old) for tool in OLD if options.old]
    with tempfile.TemporaryDirectory() as folder:
        for number, case in enumerate(cases(pathlib.Path(folder))):
            results = {}
            for number_of_run in range(options.runs):
                for what in OURS:
                    results.setdefault(f"surfometry {what}", []).append(ours(binary, case, what))
                for tool, python in tools:
                    if tool in SLOW and (number_of_run > 0 or (number == 0 and not options.full)):
                        continue
                    result = theirs(python, case, tool)
                    if result:
                        results.setdefault(tool, []).append(result)
                print(f"{case.name}: run {number_of_run + 1} of {options.runs}", file=sys.stderr)
            best = {tool: min(runs, key=lambda r: r["seconds"]) for tool, runs in results.items()}
            table(case, best)
            if number == 0:
                roofline(case, best, machine)


if __name__ == "__main__":
    main()
