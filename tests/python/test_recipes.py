"""The recipes of docs/recipes: what of them needs no application."""

import csv
import importlib.util
import pathlib

import nibabel
import numpy as np
import pytest
from conftest import ORIGIN, ROOT, SPACING, numbers, oblique_directions, turned_body

import surfometry


def recipe(name):
    """A recipe as a module."""
    spec = importlib.util.spec_from_file_location(name, ROOT / "docs" / "recipes" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def ijk_to_ras():
    matrix = np.eye(4)
    matrix[:3, :3] = oblique_directions() * SPACING[::-1]
    matrix[:3, 3] = ORIGIN
    return matrix


def test_a_label_map_of_slicer_lies_where_nibabel_puts_it(tmp_path):
    image = recipe("slicer").image_of(turned_body(), ijk_to_ras(), ["body"])
    measured = surfometry.measure(image)
    same = nibabel.Nifti1Image(turned_body().T, ijk_to_ras())
    assert measured.name == "body"
    assert numbers(surfometry.measure(same, names={1: "body"})) == numbers(measured)
    surfometry.surface(image).save(tmp_path / "slicer.vtp")
    surfometry.surface(same).save(tmp_path / "nibabel.vtp")
    import pyvista

    ours, theirs = (pyvista.read(tmp_path / name) for name in ("slicer.vtp", "nibabel.vtp"))
    assert np.array_equal(ours.points, theirs.points) and list(ours.field_data["SPACE"]) == ["RAS"]


def test_a_table_of_slicer_names_its_segments(tmp_path):
    slicer = recipe("slicer")
    halves = turned_body().astype(np.uint8)
    halves[:, :, 18:] *= 2
    columns = surfometry.measure_labels(slicer.image_of(halves, ijk_to_ras(), ["left", "right"]), as_frame=False)
    slicer.write_table(columns, tmp_path / "table.csv")
    with open(tmp_path / "table.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["Segment"] for row in rows] == ["left", "right"]
    assert [float(row["surface_area_mm2"]) for row in rows] == columns["surface_area_mm2"]


@pytest.mark.parametrize("version", ["0.4", "0.5"])
def test_a_task_of_fractal_writes_a_feature_table(version, tmp_path):
    ngio = pytest.importorskip("ngio", reason="ngio is not installed here: with what it wants it is 850 MB")
    url = pathlib.Path(tmp_path) / "image.zarr"
    # In micrometres, as microscopes have them; one length for both axes of a slice is all that ngio takes here.
    container = ngio.create_ome_zarr_from_array(
        url, turned_body(), pixelsize=(SPACING[1] * 1e3, SPACING[2] * 1e3), z_spacing=SPACING[0] * 1e3, ngff_version=version
    )
    labels = container.derive_label("bodies")
    halves = turned_body().astype(labels.dtype)
    halves[:, :, 18:] *= 2
    labels.set_array(halves)
    labels.consolidate()
    task = recipe("fractal_task")
    task.measure_surfaces(zarr_url=str(url), label_name="bodies")
    table = ngio.open_ome_zarr_container(url).get_table("surfaces").dataframe
    expected = surfometry.measure_labels(halves, SPACING)
    assert list(table.index) == list(expected["label"])
    for name in ("volume_mm3", "surface_area_mm2", "standard_error_surface_area_mm2"):
        assert table[name].to_numpy() == pytest.approx(expected[name].to_numpy(), rel=1e-12)
