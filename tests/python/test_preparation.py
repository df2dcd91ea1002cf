"""Thresholds, largest pieces and filled cavities, against SciPy; and axes that are not perpendicular, against nibabel's affine."""

import nibabel as nib
import numpy as np
import pytest
from conftest import SHAPE, SPACING, numbers, records
from scipy import ndimage

import surfometry

EVERYWHERE = np.ones((3, 3, 3))


def scan():
    """Grey values: a turned shell of 300 with marrow of 0, air of -1000, noise, and specks in both."""
    z, y, x = np.meshgrid(*[(np.arange(n) - n / 2 + 0.2) * h for n, h in zip(SHAPE, SPACING)], indexing="ij")
    u, v = 0.8 * x + 0.6 * y, -0.6 * x + 0.8 * y
    distance = np.sqrt((u / 1.3) ** 2 + v**2 + (z / 1.2) ** 2)
    grey = np.select([distance < 4, distance < 8], [0, 300], -1000)
    noise = np.random.default_rng(7).normal(0, 90, SHAPE)
    return (grey + noise).astype(np.int16)


def by_scipy(inside, largest, filled):
    if largest:
        pieces, _ = ndimage.label(inside, EVERYWHERE)
        inside = pieces == np.bincount(pieces[inside]).argmax()
    return ndimage.binary_fill_holes(inside) if filled else inside


@pytest.mark.parametrize("largest", [False, True])
@pytest.mark.parametrize("filled", [False, True])
@pytest.mark.parametrize("threshold", [(150, None), (None, -900.5), (200, 320), "150..400"])
def test_as_scipy(threshold, largest, filled):
    grey = scan()
    low, high = (150, 400) if isinstance(threshold, str) else threshold
    inside = (grey >= (-np.inf if low is None else low)) & (grey <= (np.inf if high is None else high))
    expected = by_scipy(inside, largest, filled)
    found = surfometry.measure(grey, SPACING, threshold=threshold, largest_component=largest, fill_cavities=filled)
    assert found.to_dict()["voxels"]["count"] == expected.sum()
    mask = surfometry.measure(expected, SPACING)
    names = ("preparation", "flags")
    assert {k: v for k, v in numbers(found).items() if k not in names} == {k: v for k, v in numbers(mask).items() if k not in names}
    counts = found.to_dict()["preparation"]
    assert counts["dropped_voxels"] == (inside.sum() - by_scipy(inside, True, False).sum() if largest else 0)
    assert counts["filled_voxels"] == expected.sum() - by_scipy(inside, largest, False).sum()


def test_every_label_by_itself(tmp_path):
    """Labels of noise in a file: pieces and cavities of each, as SciPy finds them, and the same from the command line."""
    smooth = ndimage.gaussian_filter(np.random.default_rng(3).normal(size=SHAPE), 1.2)
    labels = np.digitize(smooth, [0.02, 0.12, 0.2]).astype(np.uint8)
    path = tmp_path / "labels.nii.gz"
    nib.save(nib.Nifti1Image(labels.transpose(2, 1, 0), np.diag([*SPACING[::-1], 1])), path)
    table = surfometry.measure_labels(path, largest_component=True, as_frame=False)
    expected = [int(by_scipy(labels == label, True, False).sum()) for label in (1, 2, 3)]
    assert table["voxels_count"] == expected
    assert [record["voxels"]["count"] for record in records(path, "--largest-component")] == expected


def test_words_that_make_no_sense():
    for threshold in (5, (1, 2, 3), (3, 1), "3", ("low", "high"), (float("nan"), 2)):
        with pytest.raises(surfometry.ParameterError, match="threshold"):
            surfometry.measure(scan(), SPACING, threshold=threshold)
    with pytest.raises(surfometry.InputError, match="from -1") as refused:
        surfometry.measure(scan(), SPACING, threshold=(9000, None))
    assert "threshold=(low, high)" in str(refused.value)


def test_a_tilted_gantry(tmp_path):
    """V is nibabel's determinant times the count; 1 degree is the most."""
    body = (scan() > 150).astype(np.uint8).transpose(2, 1, 0)
    for degrees in (0.2, 0.5, 0.99):
        affine = np.diag([*SPACING[::-1], 1.0])
        affine[1, 2] = SPACING[0] * np.tan(np.radians(degrees))
        nib.save(nib.Nifti1Image(body, affine), tmp_path / "tilted.nii.gz")
        found = surfometry.measure(tmp_path / "tilted.nii.gz", largest_component=True)
        read = nib.load(tmp_path / "tilted.nii.gz").affine
        assert found.volume == pytest.approx(found.to_dict()["voxels"]["count"] * np.linalg.det(read[:3, :3]), rel=1e-6)
        assert "sheared-grid" in [flag.code for flag in found.flags]
    affine[1, 2] = SPACING[0] * np.tan(np.radians(1.2))
    nib.save(nib.Nifti1Image(body, affine), tmp_path / "tilted.nii.gz")
    with pytest.raises(surfometry.InputError, match="within 1 degree"):
        surfometry.measure(tmp_path / "tilted.nii.gz")
