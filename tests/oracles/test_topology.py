"""Exact topology of noisy masks against scikit-image and SciPy."""

import nibabel as nib
import numpy as np
import pytest
from conftest import lumpy, measure
from scipy import ndimage
from skimage.measure import euler_number


@pytest.mark.parametrize("seed", range(6))
def test_euler_numbers_components_cavities(tmp_path, seed):
    rng = np.random.default_rng(seed)
    mask = lumpy((30, 26, 34), seed)
    # Salt and pepper: components, cavities, tunnels, and voxels that touch at edges and corners.
    mask ^= (rng.random(mask.shape) < 0.01 * (seed + 1)).astype(np.uint8)
    mask[[0, -1]] = mask[:, [0, -1]] = mask[:, :, [0, -1]] = 0
    path = tmp_path / "mask.nii.gz"
    nib.save(nib.Nifti1Image(mask, np.eye(4)), path)
    topology = measure(path, "--sigma", "1")[0]["topology"]
    assert topology["euler_characteristic_voxels_26"] == 2 * euler_number(mask, connectivity=3)
    assert topology["euler_characteristic_voxels_6"] == 2 * euler_number(mask, connectivity=1)
    assert topology["components"] == ndimage.label(mask, np.ones((3, 3, 3)))[1]
    assert topology["cavities"] == ndimage.label(mask == 0)[1] - 1
    solid = topology["components"] - topology["handles"] + topology["cavities"]
    assert solid == euler_number(mask, connectivity=3)
