"""Whole commands, file in and numbers out: surfometry against SciPy's version of the paper and VTK, in one interleaved run.

    cargo build --release && a/bin/python benches/peers/commands.py [--runs 5]        # the environment of speed.py

Each is a process of its own that reads the same .nii.gz (SimpleITK for Python) and writes its numbers; its start and its imports are timed apart and also taken off, so
that both comparisons stand there. The least of the runs counts.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile
import time

import masks
import numpy as np
import worker

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "target/release/surfometry"
SIGMA, THICKNESS = 2.0, 2.5
PEERS = {"scipy": worker.scipy_paper, "vtk": worker.vtk_surface}
IMPORTS = {"scipy": "import SimpleITK, scipy.ndimage", "vtk": "import SimpleITK, vtk"}
ASKED = {"scipy": 10, "vtk": 5}


def peer(tool, path, out):
    """What a user's script does: file in, numbers out."""
    import SimpleITK as sitk

    image = sitk.ReadImage(path)
    found = PEERS[tool](sitk.GetArrayFromImage(image), image.GetSpacing()[0], SIGMA, THICKNESS)
    pathlib.Path(out).write_text(json.dumps(found))


def seconds(command):
    start = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - start


def gyroid(path, n=256):
    import SimpleITK as sitk

    mask = np.stack([masks.gyroid_slice((n, n, n), z) for z in range(n)]).astype(np.uint8)
    sitk.WriteImage(sitk.GetImageFromArray(mask), str(path), useCompression=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--peer", nargs=3, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.peer:
        peer(*options.peer)
        return
    with tempfile.TemporaryDirectory() as folder:
        path, out = pathlib.Path(folder) / "gyroid.nii.gz", pathlib.Path(folder) / "numbers"
        gyroid(path)
        ours = [PROGRAM, "measure", path, "--sigma", str(SIGMA), "--thickness", str(THICKNESS), "-q", "-o", f"{out}.csv"]
        commands = {"surfometry": ours}
        for tool in PEERS:
            commands[tool] = [sys.executable, __file__, "--peer", tool, path, f"{out}.json"]
            commands[f"{tool} imports"] = [sys.executable, "-c", IMPORTS[tool]]
        times = {name: [] for name in commands}
        for _ in range(options.runs):
            for name, command in commands.items():
                times[name].append(seconds([str(part) for part in command]))
    best = {name: min(runs) for name, runs in times.items()}
    print("| command | seconds | x of surfometry | without start and imports | asked |\n|---|---|---|---|---|")
    print(f"| surfometry | {best['surfometry']:.2f} | 1 | 1 | |")
    for tool in PEERS:
        whole, work = best[tool], best[tool] - best[f"{tool} imports"]
        ratios = [f"{t / best['surfometry']:.1f}" for t in (whole, work)]
        print(f"| {tool} | {whole:.2f} | {ratios[0]} | {ratios[1]} | {ASKED[tool]} |")


if __name__ == "__main__":
    main()
