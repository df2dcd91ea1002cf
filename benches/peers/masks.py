"""Masks on which all are timed, as .npy files of shape (nz, ny, nx), made slice by slice so that they may be larger than memory."""

import sys

import numpy as np


def gyroid_slice(dimensions, z, period=64.0, margin=6):
    """One slice of a gyroid, index times 2 pi / period; the outer voxels on each face empty."""
    nx, ny, nz = dimensions
    x, y, t = (np.arange(n) * 2 * np.pi / period for n in (nx, ny, nz))
    x, y, t = x[None, :], y[:, None], t[z]
    inside = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(t) + np.sin(t) * np.cos(x) < 0
    inside[:margin] = inside[-margin:] = False
    inside[:, :margin] = inside[:, -margin:] = False
    return inside if margin <= z < nz - margin else np.zeros_like(inside)


def torus(spacing=0.5, major=30.0, minor=10.0):
    """A torus off the grid, turned about its axis, in the smallest box with two voxels around it."""
    sin, cos = np.sin(np.radians(17)), np.cos(np.radians(17))
    turn = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
    half = major + minor + 5 * spacing
    axes = np.arange(-half, half, spacing) + 0.17 * spacing
    z, y, x = np.meshgrid(axes, axes, axes, indexing="ij")
    points = np.stack([x, y, z], axis=-1) @ turn
    inside = (np.hypot(points[..., 0], points[..., 1]) - major) ** 2 + points[..., 2] ** 2 < minor**2
    kept = [np.flatnonzero(inside.any(axis=tuple(a for a in range(3) if a != axis))) for axis in range(3)]
    return np.pad(inside[tuple(slice(k[0], k[-1] + 1) for k in kept)], 2)


def ball_slice(dimensions, z, radius=40.0):
    """One slice of a ball in the middle of a box, off the grid."""
    centre = [(n - 1) / 2 + shift for n, shift in zip(dimensions, (0.3, 0.17, 0.43))]
    x, y = np.arange(dimensions[0])[None, :] - centre[0], np.arange(dimensions[1])[:, None] - centre[1]
    return x**2 + y**2 + (z - centre[2]) ** 2 < radius**2


def write(path, dimensions, slice_of):
    """Writes slices one after another: x fastest."""
    header = {"descr": "|u1", "fortran_order": False, "shape": tuple(reversed(dimensions))}
    with open(path, "wb") as file:
        np.lib.format.write_array_header_1_0(file, header)
        for z in range(dimensions[2]):
            file.write(slice_of(dimensions, z).astype(np.uint8).tobytes())


if __name__ == "__main__":
    name, path, *dimensions = sys.argv[1:]
    write(path, [int(n) for n in dimensions], {"gyroid": gyroid_slice, "ball": ball_slice}[name])
