"""The figures of docs/coming_from.md: the same masks measured by each tool, held against the exact shapes."""

import re

import numpy as np
import pytest
import pyvista
import SimpleITK
from conftest import ROOT
from skimage.measure import euler_number, marching_cubes, mesh_surface_area, regionprops

import surfometry

PAGE = ROOT / "docs" / "coming_from.md"
TURNED = {"rotate": (20, 30, 40), "shift": (0.3, 0.2, 0.1)}
SHAPES = {
    "ball": surfometry.phantom("ball", radius=10, shift=(0.3, 0.2, 0.1), spacing=1),
    "ellipsoid": surfometry.phantom("ellipsoid", radii=(20, 15, 12), spacing=(1.2, 0.8, 0.8), **TURNED),
    "torus": surfometry.phantom("torus", major=22, minor=8, spacing=(1.2, 0.8, 0.8), **TURNED),
}
A, M, V = "surface_area_mm2", "total_mean_curvature_mm", "volume_mm3"


def scikit_image(image):
    vertices, triangles, _, _ = marching_cubes(np.pad(image.array, 1).astype(float), 0.5, spacing=image.spacing)
    return {V: regionprops(image.array, spacing=image.spacing)[0].area, A: mesh_surface_area(vertices, triangles)}


def vtk(image):
    grid = pyvista.ImageData(dimensions=image.array.shape[::-1], spacing=image.spacing[::-1])
    grid["mask"] = np.ascontiguousarray(image.array).ravel()
    mesh = grid.contour([0.5], scalars="mask").triangulate().clean()
    corners = mesh.faces.reshape(-1, 4)[:, 1:]
    weights = np.bincount(corners.ravel(), np.repeat(mesh.compute_cell_sizes()["Area"] / 3, 3), mesh.n_points)
    return {V: mesh.volume, A: mesh.area, M: float(np.nansum(weights * mesh.curvature("mean")))}


def simple_itk(image):
    labels = SimpleITK.GetImageFromArray(image.array)
    labels.SetSpacing(image.spacing[::-1])
    shapes = SimpleITK.LabelShapeStatisticsImageFilter()
    shapes.Execute(labels)
    return {V: shapes.GetPhysicalSize(1), A: shapes.GetPerimeter(1)}


def ours(image):
    measured = surfometry.measure(image).to_dict()
    return {name: measured[name] for name in (V, A, M)}


def ours_blurred(image):
    return surfometry.measure(image).to_dict()["blurred"]


TOOLS = {
    "`surfometry.measure`": ours,
    "its blurred surface": ours_blurred,
    "scikit-image: `regionprops` area, `marching_cubes`": scikit_image,
    "VTK, PyVista: contour of the mask, `vtkCurvatures`": vtk,
    "SimpleITK: `LabelShapeStatistics`": simple_itk,
}


def off(found, truth, name):
    # Nothing is added so that there is no -0.0.
    return "-" if found.get(name) is None else f"{round(100 * (found[name] / truth[name] - 1), 1) + 0.0:+.1f}"


def rows():
    """The table of the page: off by %, of each shape V, A, M."""
    for tool, measured in TOOLS.items():
        cells = [
            ", ".join(off(found, image.truth, name) for name in (V, A, M))
            for image, found in ((image, measured(image)) for image in SHAPES.values())
        ]
        yield f"| {tool} | {' | '.join(cells)} |"


def test_the_table_is_what_the_tools_give():
    page = PAGE.read_text(encoding="utf-8")
    for row in rows():
        assert row in page, row


def test_every_name_of_ours_on_the_page_is_one():
    """What stands in single backticks in the second column is a function, a column, a field or a method's name."""
    (record,) = surfometry.reference(SHAPES["ball"], methods=["crofton-13"])
    known = {*surfometry.__all__, *record, "vertices", *surfometry.measure_labels(SHAPES["ball"], as_frame=False)}
    cells = [line.split("|")[2] for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("| ")]
    names = {name.replace(".", "_") for cell in cells for name in re.findall(r"`([a-z][a-z_.0-9]+)`", cell)}
    assert len(names) > 15 and names <= known, names - known


def test_the_same_numbers_have_the_same_value():
    """What the page says is equal: volumes to rounding, Euler numbers twice, sphericity as derived."""
    for image in SHAPES.values():
        measured, region = surfometry.measure(image), regionprops(image.array, spacing=image.spacing)[0]
        assert abs(measured.volume / region.area - 1) < 1e-12
        assert measured.euler_characteristic == 2 * euler_number(image.array, connectivity=3)
        low, high = (np.array(corner)[::-1] for corner in measured.to_dict()["voxels"]["bounding_box"])
        assert [*low, *(high + 1)] == list(region.bbox)
        centroid = np.array(measured.to_dict()["voxels"]["centroid_mm"])
        first = np.array(image.affine)[:, 3]
        assert np.allclose(np.abs(centroid - first)[::-1], region.centroid, atol=1e-9)


def test_perimeters_of_itk_are_crofton_13_in_cubic_voxels():
    (crofton,) = surfometry.reference(SHAPES["ball"], methods=["crofton-13"])
    assert simple_itk(SHAPES["ball"])[A] == pytest.approx(crofton[A], rel=1e-6)


def test_a_spacing_that_is_left_out_is_a_third_of_the_area():
    ellipsoid = SHAPES["ellipsoid"]
    unspaced = surfometry.Image(ellipsoid.array, affine=np.eye(4)[:3].tolist())
    assert f"{scikit_image(unspaced)[A] / ellipsoid.truth[A] - 1:.0%}".replace("%", " %") in PAGE.read_text(encoding="utf-8")


def sphericity(found):
    return (36 * np.pi * found[V] ** 2) ** (1 / 3) / found[A]


def test_a_ball_of_triangles_is_not_round():
    ball = SHAPES["ball"]
    shown = f"{sphericity(scikit_image(ball)):.2f}", f"{sphericity(ours(ball)):.3f}"
    assert all(f"{value} " in PAGE.read_text(encoding="utf-8") for value in shown), shown
