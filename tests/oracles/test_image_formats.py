"""Files of FreeSurfer, Scanco, TIFF, OME-Zarr and VTK, written by those formats' own libraries, are read as these mean them."""

import nibabel as nib
import numpy as np
import py_aimio
import pytest
from conftest import oblique
from test_formats import check, labels

SPACING = [0.7, 1.1, 1.9]


@pytest.mark.parametrize("name", ["a.mgh", "a.mgz"])
@pytest.mark.parametrize("dtype", ["uint8", "int16", "int32", "float32"])
@pytest.mark.parametrize("handedness", [1.0, -1.0])
def test_freesurfer_by_nibabel(tmp_path, name, dtype, handedness):
    image = labels(dtype)
    affine = oblique() @ np.diag([handedness, 1, 1, 1])
    nib.save(nib.MGHImage(image, affine), tmp_path / name)
    check(tmp_path / name, image, affine, tolerance=1e-3)


@pytest.mark.parametrize("kind", ["int8", "int16", "float32", "runs"])
def test_scanco_by_aimio(tmp_path, kind):
    image = (labels("uint8") == 1).astype("int8") * 127 if kind == "runs" else labels(kind)
    path = tmp_path / "M.AIM;1"
    meta = {"element_size": SPACING, "position": [3, -5, 7]}
    py_aimio.write_aim(str(path), np.ascontiguousarray(image.transpose(2, 1, 0)), meta)
    affine = np.diag([*SPACING, 1.0])
    affine[:3, 3] = np.multiply(SPACING, [3, -5, 7])
    check(path, image, affine)
