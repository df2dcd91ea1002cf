#!/usr/bin/env python3
"""How far background lies inside a blurred surface at hollow creases, and what A and M lack there, with SciPy alone.

target/oracles/bin/python experiments/hollow_creases/depths.py PROGRAM

Two balls overlap at random poses. Their mask is blurred, and at background voxels inside the level 1/2 where the surface is hollow
in one direction, the depth beyond sigma^2 |H| is summed, with and without the curvature along the crease. PROGRAM measures the
same masks. Printed: what A and M lack of their closed forms, in units of those sums (`LEFT` of
`crates/surfometry/src/measurement/hollow_creases.rs`), and what smooth bodies have of them, in % of their area.
"""

import json
import math
import pathlib
import subprocess
import sys
import tempfile

import nibabel as nib
import numpy as np
from scipy.ndimage import gaussian_filter
from scipy.spatial.transform import Rotation
from scipy.special import ndtri

NOISE = 0.05
LEFT = 25.0
RANDOM = np.random.default_rng(5)


def mask_of(inside, extent, spacing):
    """Voxels of a shape in a pose by chance."""
    sides = np.ceil(2 * (extent + 8 * spacing.max()) / spacing).astype(int)
    axes = [(np.arange(n) - (n - 1) / 2) * h for n, h in zip(sides, spacing)]
    places = np.stack(np.meshgrid(*axes, indexing="ij"), -1) + RANDOM.uniform(-0.5, 0.5, 3) * spacing
    return inside(places @ Rotation.random(random_state=RANDOM).as_matrix())


def depths(mask, spacing):
    """Sums over voxels of depth, and of depth times the smaller principal curvature, over sigma^2, times a voxel's volume."""
    sigma = 2 * spacing.prod() ** (1 / 3)
    derivative = lambda order: gaussian_filter(mask.astype(float), sigma / spacing, order=order, truncate=6) / np.prod(spacing**order)
    blurred = derivative(np.zeros(3, int))
    wrong = np.where(~mask & (blurred > 0.5))
    if not len(wrong[0]):
        return np.zeros(2)
    unit = np.eye(3, dtype=int)
    gradient = np.stack([derivative(unit[a])[wrong] for a in range(3)], -1)
    hessian = np.stack([np.stack([derivative(unit[a] + unit[b])[wrong] for b in range(3)], -1) for a in range(3)], -1)
    slope = np.linalg.norm(gradient, axis=-1)
    normal = gradient / slope[:, None]
    along = np.eye(3) - normal[:, :, None] * normal[:, None, :]
    shape = -along @ hessian @ along / slope[:, None, None]
    mean = np.trace(shape, axis1=1, axis2=2) / 2
    root = np.sqrt(np.maximum((shape**2).sum((1, 2)) / 2 - mean**2, 0))
    most, least = mean + root, mean - root
    erf = ndtri(np.clip(blurred[wrong], 1e-12, 1 - 1e-12))
    depth = np.abs(erf) * np.exp(-(erf**2) / 2) / math.sqrt(2 * math.pi) / slope
    beyond = depth - sigma**2 * np.abs(mean)
    half_voxel = 0.5 * (np.abs(normal) * spacing).sum(-1)
    told = (beyond > NOISE * spacing.max()) & (depth <= 1.5 * sigma**2 * np.abs(mean) + half_voxel) & (least < 0)
    other = np.minimum(np.abs(most), np.abs(least))
    return spacing.prod() / sigma**2 * np.array([beyond[told].sum(), (beyond * other)[told].sum()])


def measured(program, mask, spacing):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "a.nii"
        nib.save(nib.Nifti1Image(mask.astype("uint8"), np.diag([*spacing, 1.0])), path)
        command = [program, "measure", path, "--sigma", str(2 * spacing.prod() ** (1 / 3)), "--format", "json"]
        record = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)["results"][0]
    return np.array([record["surface_area_mm2"], record["total_mean_curvature_mm"]])


def balls(first, second, distance):
    """A shape, its extent, A and M, and the angle by which normals turn where they meet."""
    plane = (distance**2 + first**2 - second**2) / (2 * distance)
    circle = math.sqrt(first**2 - plane**2)
    areas = [4 * math.pi * r**2 - 2 * math.pi * r * (r - d) for r, d in [(first, plane), (second, distance - plane)]]
    turn = math.asin(plane / first) + math.asin((distance - plane) / second)
    centre = (distance + second - first) / 2
    inside = lambda p: (np.linalg.norm(p + [centre, 0, 0], axis=-1) < first) | (
        np.linalg.norm(p - [distance - centre, 0, 0], axis=-1) < second
    )
    mean = areas[0] / first + areas[1] / second - math.pi * circle * turn
    return inside, (first + second + distance) / 2, np.array([sum(areas), mean]), math.degrees(turn)


def main(program):
    cubes, slices = np.ones(3), np.array([0.6, 1.0, 1.4])
    for shape in [(10, 10, 12), (16, 16, 19.2), (25, 25, 30), (30, 12, 32), (20, 6, 22), (13, 13, 10.4), (16, 16, 10)]:
        inside, extent, truth, angle = balls(*shape)
        for spacing in [cubes, slices]:
            masks = [mask_of(inside, extent, spacing) for _ in range(3)]
            sums = np.mean([depths(mask, spacing) for mask in masks], 0)
            lacks = truth - np.mean([measured(program, mask, spacing) for mask in masks], 0)
            print(f"balls {shape}, {angle:3.0f} degrees, {spacing}: A {lacks[0] / sums[0]:5.1f}, M {lacks[1] / sums[1]:5.1f}", flush=True)
    ring = lambda p: np.hypot(np.hypot(p[..., 0], p[..., 1]) - 24, p[..., 2]) < 8
    hollow = lambda p: (np.linalg.norm(p, axis=-1) < 16) & (np.linalg.norm(p, axis=-1) > 9)
    for name, inside, extent, area in [("torus 24, 8", ring, 32, 768 * math.pi**2), ("shell 16, 9", hollow, 16, 1348 * math.pi)]:
        for spacing in [cubes, slices]:
            share = LEFT * np.mean([depths(mask_of(inside, extent, spacing), spacing)[0] for _ in range(3)]) / area
            print(f"{name}, {spacing}: {100 * share:.3f} %", flush=True)


main(sys.argv[1])
