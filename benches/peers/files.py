"""Whole programs on files: cost against the box, memory against the volume, many labels against one, and against decompression.

    a/bin/python benches/peers/files.py [--huge]        # the environment of speed.py; --huge writes 4 GiB to the temporary folder
"""

import argparse
import json
import os
import pathlib
import re
import subprocess
import tempfile
import time

import masks
import numpy as np
import worker
from speed import bench, output_and_peak, run

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = ROOT.parent / "shared/data/real/bone"
PROGRAM = ROOT / "target/release/surfometry"
RUNS = 5


def program(path, *options):
    """Wall seconds, peak MiB and the seconds by stage that the program tells."""
    command = [str(PROGRAM), "measure", str(path), "--timings", "--format", "json", "-o", "/dev/null", *options]
    _, said, seconds, peak = run(command)
    stages = {name: float(value) for name, value in re.findall(r"(\w+) (\d+\.\d+)", said.split("seconds:")[-1])}
    return seconds, peak, stages


def balls(folder):
    """A ball of radius 40 in ever larger boxes: from an array in memory."""
    print("\n| box | ms | of which finding the object | the rest |\n|---|---|---|---|")
    for n in (128, 256, 512, 1024):
        path = folder / "ball.npy"
        masks.write(path, [n] * 3, masks.ball_slice)
        result = json.loads(output_and_peak([bench("whole_run"), str(path), "2", "2.5", "integrals", str(RUNS)])[0])
        total, scan = 1000 * result["seconds"], 1000 * result["setup"]
        print(f"| {n}^3 | {total:.1f} | {scan:.1f} | {total - scan:.1f} |", flush=True)


def volumes(folder, huge):
    """Gyroids that span files larger than what may be held."""
    print("\n| file | voxels | seconds | peak memory, MiB (asked: 256) |\n|---|---|---|---|")
    for dimensions in [(1024, 1024, 1024)] + ([(2048, 2048, 1024)] if huge else []):
        path = folder / "gyroid.npy"
        masks.write(path, dimensions, masks.gyroid_slice)
        seconds, peak, _ = program(path, "--spacing", "1,1,1", "--sigma", "2", "--thickness", "2.5")
        print(f"| {' x '.join(map(str, dimensions))} | {np.prod(dimensions) / 1e9:.2f} G | {seconds:.1f} | {peak:.0f} |", flush=True)
        path.unlink()


def labels():
    """All 62 labels of a file against SciPy on one label's box."""
    import SimpleITK as sitk

    path = DATA / "totalseg_ct_3mm_62labels.nii.gz"
    image = sitk.GetArrayFromImage(sitk.ReadImage(str(path)))
    # The liver is label 5; four sigma and two voxels around it, as the paper pads.
    where = np.argwhere(image == 5)
    box = tuple(slice(max(low - 10, 0), high + 11) for low, high in zip(where.min(0), where.max(0)))
    liver = (image[box] == 5).astype(np.uint8)
    ours, theirs = [], []
    for _ in range(RUNS):
        ours.append(program(path)[0])
        start = time.perf_counter()
        worker.scipy_paper(liver, 1.0, 2.0, 2.5)
        theirs.append(time.perf_counter() - start)
    print(f"\nall 62 labels, file to results: {min(ours):.3f} s; SciPy on the liver's box {liver.shape}: {min(theirs):.3f} s")


def femur():
    """A whole scan against its own decompression."""
    runs = [program(DATA / "libhip_m3_left_proximal_femur_1mm.nii.gz")[2] for _ in range(2 * RUNS)]
    threads = os.cpu_count()
    integrals = min((s["embed"] + s["derive"] + s["integrate"]) / threads for s in runs)
    everything = min((integrals + (s["surface"] + s["topology"]) / threads) for s in runs)
    decode = min(s["decode"] for s in runs)
    print(f"\nfemur at 1 mm: decompression and labels {1000 * decode:.1f} ms; integrals {1000 * integrals:.1f} ms, with mesh and topology {1000 * everything:.1f} ms")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--huge", action="store_true", help="a file of 2048 x 2048 x 1024 voxels too")
    options = parser.parse_args()
    subprocess.run(["cargo", "build", "--release", "-p", "surfometry-cli"], cwd=ROOT, check=True, capture_output=True)
    with tempfile.TemporaryDirectory() as folder:
        balls(pathlib.Path(folder))
        volumes(pathlib.Path(folder), options.huge)
    if DATA.exists():
        labels()
        femur()
    else:
        print("\n../shared/data is absent: labels and femur are left out")


if __name__ == "__main__":
    main()
