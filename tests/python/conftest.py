"""What the tests of the Python package share: objects, lattices, and the command line that it must agree with."""

import json
import os
import pathlib
import subprocess
import warnings

import numpy as np
import pytest

import surfometry

ROOT = pathlib.Path(__file__).resolve().parents[2]
BINARY = pathlib.Path(os.environ.get("SURFOMETRY", ROOT / "target" / "debug" / "surfometry"))
# Three sizes and three spacings, axes z, y, x: what is swapped shows.
SHAPE = (26, 31, 38)
SPACING = (1.3, 0.9, 0.7)


@pytest.fixture(autouse=True)
def flags_are_no_failures():
    """Flags of small objects are not what these tests are about; those that are look for them."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", surfometry.SurfometryWarning)
        yield


def command_line(*arguments):
    """What the command line prints."""
    done = subprocess.run([str(BINARY), *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def records(*arguments):
    """Records of `surfometry measure`."""
    return json.loads(command_line("measure", *arguments, "--format", "json"))["results"]


def numbers(record):
    """A record without what an input is called, whether it is a file, and how long it took."""
    record = record.to_dict() if isinstance(record, surfometry.Measurement) else record
    return {key: value for key, value in record.items() if key not in ("input", "input_sha256", "read_seconds", "seconds")}


def turned_field():
    """A field, negative in a lumpy body of three different semi-axes, turned, clear of the border; axes z, y, x."""
    z, y, x = np.meshgrid(*[(np.arange(n) - n / 2 + 0.2) * h for n, h in zip(SHAPE, SPACING)], indexing="ij")
    u, v, w = 0.8 * x + 0.6 * y, -0.6 * x + 0.8 * y, z + 0.2 * x
    return 4 * ((u / 9.5) ** 2 + (v / 7.5) ** 2 + (w / 9.0) ** 2 + 0.15 * np.sin(u / 2) - 1)


def turned_body():
    """The body as uint8."""
    return (turned_field() < 0).astype(np.uint8)


def oblique_directions():
    """Columns are the directions of the axes x, y, z: a rotation about (1, 2, 3)."""
    axis = np.array([1.0, 2.0, 3.0]) / np.sqrt(14)
    cross = np.cross(np.eye(3), axis).T
    return np.eye(3) + np.sin(0.8) * cross + (1 - np.cos(0.8)) * cross @ cross


def gyroid(size):
    """A network of period 25 voxels, cut by the edge."""
    z, y, x = np.mgrid[:size, :size, :size].astype(np.float32) / 4
    return np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x) < 0


ORIGIN = np.array([-120.5, 33.25, 870.0])


class NapariLayer:
    """What a labels layer of napari offers; napari itself wants Qt and 900 MB, and is there where scripts/napari has put it."""

    def __init__(self, unit="pixel", scale=1.0, multiscale=False):
        self.data = [turned_body(), turned_body()[::2, ::2, ::2]] if multiscale else turned_body()
        self.multiscale, self.name, self.scale = multiscale, "labels", np.array(SPACING) * scale
        self.translate, self.units = ORIGIN[::-1] * scale, (unit,) * 3

    def data_to_world(self, position):
        # Its affine turns what scale and translate have made.
        turn = oblique_directions()[::-1, ::-1]
        return turn @ (np.asarray(position) * self.scale + self.translate)
