"""Measures for scikit-image's regionprops."""

import warnings

import numpy as np
import pytest
from conftest import SPACING, turned_body
from skimage.measure import regionprops, regionprops_table

import surfometry
import surfometry.skimage


def labels():
    """A body in two halves, and a label of one voxel."""
    image = turned_body().astype(np.int32)
    image[:, :, 18:] *= 2
    image[1, 1, 1] = 7
    return image


def test_a_table_with_toy_masks_and_specks():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        table = regionprops_table(
            labels(),
            properties=("label", "area"),
            spacing=SPACING,
            extra_properties=surfometry.skimage.properties(spacing=SPACING, embedding="gaussian"),
        )
    ours = surfometry.measure_labels(labels(), SPACING, embedding="gaussian", as_frame=False)
    assert list(table["label"]) == ours["label"]
    for name, column in [("volume", "volume_mm3"), ("surface_area", "surface_area_mm2")]:
        expected = [np.nan if value is None else value for value in ours[column]]
        assert table[name] == pytest.approx(expected, nan_ok=True, rel=1e-9)
    assert table["volume"] == pytest.approx(table["area"], nan_ok=True)
    assert table["euler_characteristic"][:2].tolist() == [2, 2]


def test_each_label_is_measured_once(monkeypatch):
    calls = []

    def counted(*arguments, **options):
        calls.append(1)
        return surfometry.measure(*arguments, **options)

    monkeypatch.setattr("surfometry.skimage.measure", counted)
    functions = surfometry.skimage.properties(spacing=SPACING)
    for region in regionprops(labels(), spacing=SPACING, cache=False):
        assert [function(region.image) for function in functions]
    assert len(calls) == 3


def test_other_measures_and_options():
    (function,) = surfometry.skimage.properties(SPACING, measures=["total_gaussian_curvature"], sigma=1.5)
    assert function.__name__ == "total_gaussian_curvature"
    assert function(turned_body() > 0) == pytest.approx(4 * np.pi)
