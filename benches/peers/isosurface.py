"""Iso-surface of one field of about a million triangles: surfometry against scikit-image's marching cubes.

Both run on the same field, in turn, five times; minima and their ratio are printed.

    pip install -r benches/peers/requirements.txt
    python benches/peers/isosurface.py
"""

import json
import pathlib
import subprocess
import tempfile
import time

import numpy as np
from scipy import ndimage
from skimage import measure

ROOT = pathlib.Path(__file__).resolve().parents[2]
RUNS = 5


def gyroid(n=256, period=150.0, margin=6):
    """A gyroid mask, empty near the faces, blurred by sigma = 2 voxels: phi, negative inside."""
    x, y, z = np.meshgrid(*[np.arange(n) * 2 * np.pi / period] * 3, indexing="ij", sparse=True)
    inside = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x) < 0
    for axis in range(3):
        ends = [slice(None)] * 3
        for end in (slice(None, margin), slice(-margin, None)):
            ends[axis] = end
            inside[tuple(ends)] = False
    return 0.5 - ndimage.gaussian_filter(inside.astype(np.float32), 2.0)


def bench_binary():
    """Builds the bench without running it; its path."""
    command = ["cargo", "bench", "-p", "surfometry", "--bench", "isosurface", "--no-run", "--message-format=json"]
    lines = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout.splitlines()
    artifacts = [message for message in map(json.loads, lines) if message.get("executable")]
    return artifacts[-1]["executable"]


def main():
    binary, phi = bench_binary(), gyroid()
    ours, theirs = [], []
    with tempfile.NamedTemporaryFile(suffix=".npy") as file:
        np.save(file.name, phi)
        for _ in range(RUNS):
            seconds, triangles, vertices = subprocess.run(
                [binary, file.name], capture_output=True, text=True, check=True
            ).stdout.split()
            ours.append(float(seconds))
            start = time.perf_counter()
            points, faces, _, _ = measure.marching_cubes(phi, 0.0)
            theirs.append(time.perf_counter() - start)
    print(f"surfometry    {min(ours):.3f} s  {triangles} triangles, {vertices} vertices")
    print(f"scikit-image  {min(theirs):.3f} s  {len(faces)} triangles, {len(points)} vertices")
    print(f"ratio         {min(theirs) / min(ours):.1f}")


if __name__ == "__main__":
    main()
