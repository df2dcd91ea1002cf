"""What the oracle tests share: the binary under test and how it is called."""

import json
import os
import pathlib
import subprocess

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BINARY = pathlib.Path(os.environ.get("SURFOMETRY", ROOT / "target" / "debug" / "surfometry"))
DATA = ROOT.parent / "shared" / "data" / "real"

needs_data = pytest.mark.skipif(not DATA.is_dir(), reason="../shared/data is absent")


def surfometry(*arguments):
    """Runs the command line; what it prints."""
    command = [str(BINARY), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
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
    from scipy import ndimage

    rng = np.random.default_rng(seed)
    field = ndimage.gaussian_filter(rng.standard_normal(shape), 3.0)
    grid = np.meshgrid(*[np.linspace(-1.3, 1.3, n) for n in shape], indexing="ij")
    radius = np.sqrt(sum(g**2 for g in grid))
    return (radius + 8.0 * field < 0.85).astype(np.uint8)
