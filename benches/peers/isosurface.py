"""Iso-surface of one field of about a million triangles: surfometry against scikit-image's marching cubes.

Both run on the same field, in turn, five times; minima and their ratio are printed.

    pip install -r benches/peers/requirements.txt
    python benches/peers/isosurface.py
"""

import subprocess
import tempfile
import time

import masks
import numpy as np
from scipy import ndimage
from skimage import measure
from speed import bench

RUNS = 5


def gyroid(n=256):
    """A gyroid mask, empty near the faces, blurred by sigma = 2 voxels: phi, negative inside."""
    inside = np.stack([masks.gyroid_slice((n, n, n), z, period=150.0) for z in range(n)]).transpose()
    return 0.5 - ndimage.gaussian_filter(inside.astype(np.float32), 2.0)


def main():
    binary, phi = bench("isosurface"), gyroid()
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
