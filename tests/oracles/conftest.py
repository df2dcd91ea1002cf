"""What the oracle tests share: the binary under test and how it is called."""

import json
import os
import pathlib
import subprocess

import nibabel as nib
import numpy as np
import pytest
from scipy import ndimage, spatial

ROOT = pathlib.Path(__file__).resolve().parents[2]
BINARY = pathlib.Path(os.environ.get("SURFOMETRY", ROOT / "target" / "debug" / "surfometry"))
DATA = ROOT.parent / "shared" / "data" / "real"

needs_data = pytest.mark.skipif(not DATA.is_dir(), reason="../shared/data is absent")


def surfometry(*arguments, status=0):
    """Runs the command line, which exits with this status; what it prints."""
    command = [str(BINARY), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == status, done.stderr
    return done.stdout


def measure(path, *options):
    """Records of `surfometry measure`."""
    return json.loads(surfometry("measure", path, "--format", "json", *options))["results"]


def info(path, *options):
    """What `surfometry info` says of one file."""
    return json.loads(surfometry("info", path, "--json", *options))[0]


def affine_of(document):
    """4 x 4 RAS affine out of an `info` document."""
    affine = np.eye(4)
    affine[:3, :3] = document["affine_ras_mm"]["linear"]
    affine[:3, 3] = document["affine_ras_mm"]["origin"]
    return affine


def lumpy(shape, seed):
    """A random smooth binary object, clear of the border, in x, y, z order."""
    rng = np.random.default_rng(seed)
    field = ndimage.gaussian_filter(rng.standard_normal(shape), 3.0)
    grid = np.meshgrid(*[np.linspace(-1.3, 1.3, n) for n in shape], indexing="ij")
    radius = np.sqrt(sum(g**2 for g in grid))
    return (radius + 8.0 * field < 0.85).astype(np.uint8)


def oblique():
    """Turned about (1, 2, 3), three spacings, an origin far from zero."""
    axis = np.array([1.0, 2.0, 3.0])
    affine = np.eye(4)
    affine[:3, :3] = spatial.transform.Rotation.from_rotvec(0.8 * axis / np.linalg.norm(axis)).as_matrix()
    affine[:3, :3] *= [0.8, 1.0, 1.3]
    affine[:3, 3] = [-112.5, 40.25, 907.0]
    return affine


def mirrored():
    """A left-handed image, as most radiological ones are."""
    affine = np.diag([-0.9, 1.1, 1.2, 1.0])
    affine[:3, 3] = [90.0, -126.0, -72.0]
    return affine


def save_mask(path, mask, affine):
    """Writes 0 and 1; the path."""
    nib.save(nib.Nifti1Image(np.asarray(mask).astype(np.uint8), affine), path)
    return path


def gaussian_derivatives(mask, sigma, spacing):
    """Gradient and Hessian of phi by SciPy's own derivative-of-Gaussian filters."""
    scale = [sigma / h for h in spacing]

    def of(order):
        filtered = ndimage.gaussian_filter(mask, scale, order=order, truncate=5.0, mode="constant")
        return -filtered / np.prod([h**n for h, n in zip(spacing, order)])

    unit = np.eye(3, dtype=int)
    gradient = np.array([of(unit[a]) for a in range(3)])
    hessian = np.array([[of(unit[a] + unit[b]) for b in range(3)] for a in range(3)])
    return gradient, hessian


def curvatures(gradient, hessian):
    """H by the divergence of the normal, K by the bordered determinant."""
    norm = np.sqrt((gradient**2).sum(axis=0))
    normal = gradient / norm
    along = np.einsum("a...,ab...,b...->...", normal, hessian, normal)
    mean = (np.trace(hessian) - along) / (2 * norm)
    bordered = np.zeros((4, 4, norm.size))
    bordered[:3, :3] = hessian.reshape(3, 3, -1)
    bordered[:3, 3] = bordered[3, :3] = gradient.reshape(3, -1)
    gaussian = -np.linalg.det(bordered.transpose(2, 0, 1)) / norm.ravel() ** 4
    return mean, gaussian.reshape(mean.shape), norm
