"""Surfaces for other libraries: winding, order of axes, arrays, files."""

import json
import pickle

import nibabel
import numpy as np
import pytest
import pyvista
import trimesh
from conftest import SPACING, command_line, turned_body

import surfometry

R, RADIUS = 24.0, 9.0
TORUS = f"phantom:torus?major={R}&minor={RADIUS}&rotate=20,30,40&spacing=0.8,1,1.2"


@pytest.fixture(scope="module")
def torus():
    return surfometry.surface(TORUS)


def enclosed(vertices, faces):
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def test_curvature_is_the_shapes_own(torus):
    k1, k2 = torus.arrays["k1_per_mm"], torus.arrays["k2_per_mm"]
    # The tube's own curvature everywhere, and the ring's, which is between -1/(R - r) and 1/(R + r).
    assert np.median(k1) == pytest.approx(1 / RADIUS, rel=0.02)
    assert np.quantile(k2, 0.01) == pytest.approx(-1 / (R - RADIUS), rel=0.15)
    assert np.quantile(k2, 0.99) == pytest.approx(1 / (R + RADIUS), rel=0.15)
    assert enclosed(torus.vertices, torus.faces) == pytest.approx(2 * np.pi**2 * R * RADIUS**2, rel=0.02)
    assert torus.curvature["distributions"] and torus.measurement.topology.handles == 1


def test_axes_of_plain_arrays():
    body = turned_body()
    surface = surfometry.surface(body, SPACING)
    index = np.argwhere(body).mean(axis=0)[::-1]
    assert np.allclose(surface.vertices.mean(axis=0), index * SPACING[::-1], atol=0.6)
    assert surface.frame == "own"


def test_pyvista(torus):
    mesh = torus.to_pyvista()
    assert isinstance(mesh, pyvista.PolyData) and mesh.is_manifold
    assert mesh.volume == pytest.approx(enclosed(torus.vertices, torus.faces), rel=1e-6)
    own = mesh.compute_normals(auto_orient_normals=False, consistent_normals=False, point_normals=True)
    assert np.einsum("ij,ij->i", own.point_data["Normals"], mesh.point_data["normal"]).min() > 0.5
    assert np.array_equal(mesh.point_data["mean_curvature_per_mm"], torus.arrays["mean_curvature_per_mm"])


def test_trimesh(torus):
    mesh = torus.to_trimesh()
    assert isinstance(mesh, trimesh.Trimesh) and mesh.is_watertight and mesh.is_winding_consistent
    assert mesh.volume == pytest.approx(enclosed(torus.vertices, torus.faces), rel=1e-9)
    assert len(mesh.vertices) == len(torus.vertices) and mesh.euler_number == 0
    assert np.array_equal(mesh.vertex_attributes["k1_per_mm"], torus.arrays["k1_per_mm"])


def test_napari_has_axes_of_arrays(torus):
    (vertices, faces, values), options, kind = torus.to_napari()
    assert kind == "surface" and np.array_equal(vertices[:, ::-1], torus.vertices)
    # Turned inside out by the order of axes, and back by that of corners.
    assert enclosed(vertices, faces) == pytest.approx(enclosed(torus.vertices, torus.faces), rel=1e-9)
    assert np.array_equal(values, torus.arrays["mean_curvature_per_mm"])
    assert len(options["features"]["k1_per_mm"]) == len(vertices) and "normal" not in options["features"]
    with pytest.raises(surfometry.ParameterError, match="k1_per_mm"):
        torus.to_napari("normal")


@pytest.mark.parametrize("ending", [".vtp", ".ply", ".stl", ".csv", ".glb"])
def test_files_are_those_of_map(torus, tmp_path, ending):
    ours, theirs = tmp_path / f"ours{ending}", tmp_path / f"theirs{ending}"
    assert torus.save(ours) == [str(ours)]
    command_line("map", TORUS, "--curvature-sigma", "auto", "-o", theirs, "-q")
    if ending in (".ply", ".stl", ".glb"):
        assert ours.read_bytes() == theirs.read_bytes()
    elif ending == ".csv":
        own, other = (np.genfromtxt(path, delimiter=",", names=True) for path in (ours, theirs))
        assert all(np.array_equal(own[name], other[name]) for name in other.dtype.names)
    else:
        own, other = pyvista.read(ours), pyvista.read(theirs)
        assert np.array_equal(own.points, other.points) and np.array_equal(own.faces, other.faces)
        assert all(np.array_equal(own[name], other[name]) for name in other.point_data)


def test_surfaces_go_to_other_processes(torus, tmp_path):
    again = pickle.loads(pickle.dumps(torus))
    assert np.array_equal(again.vertices, torus.vertices) and again.measurement == torus.measurement
    again.save(tmp_path / "again.ply")
    torus.save(tmp_path / "torus.ply")
    assert (tmp_path / "again.ply").read_bytes() == (tmp_path / "torus.ply").read_bytes()


def test_what_cannot_be_written_leaves_nothing(torus, tmp_path):
    with pytest.raises(surfometry.ParameterError, match=r"\.ply, \.vtp"):
        torus.save(tmp_path / "torus.xyz")
    with pytest.raises(surfometry.FileError):
        torus.save(tmp_path / "no folder" / "torus.ply")
    torus.arrays["my value"] = torus.arrays["k1_per_mm"]
    with pytest.raises(surfometry.ParameterError, match="my value"):
        torus.save(tmp_path / "torus.ply")
    del torus.arrays["my value"]
    assert not list(tmp_path.iterdir())


def test_nothing_left_is_no_surface():
    speck = np.zeros((9, 9, 9), np.uint8)
    speck[4, 4, 4] = 1
    with pytest.raises(surfometry.InputError, match="no surface"):
        surfometry.surface(speck, 1, curvature_sigma=None, sigma=3)


def test_a_page(tmp_path):
    surfometry.report(turned_body(), tmp_path / "page.html", SPACING, title="A body", name="scan 7")
    page = (tmp_path / "page.html").read_text()
    assert "A body" in page and "scan 7" in page and "</html>" in page
    with pytest.raises(surfometry.InputError):
        surfometry.report(0 * turned_body(), tmp_path / "none.html", SPACING)
    assert not (tmp_path / "none.html").exists()


def test_reading_gives_what_is_stored(tmp_path):
    command_line("phantom", "ball?radius=5&spacing=0.7,0.9,1.3", "-o", tmp_path / "ball.nii.gz")
    image = surfometry.read(tmp_path / "ball.nii.gz")
    made = surfometry.phantom("ball", radius=5, spacing=(1.3, 0.9, 0.7))
    assert image.spacing == pytest.approx(made.spacing, rel=1e-6) and image.array.dtype == np.uint8
    assert np.array_equal(image.array, made.array)
    truth = json.loads((tmp_path / "ball.truth.json").read_text())["truth"]
    assert made.truth == truth
    assert surfometry.read(tmp_path / "ball.nii.gz", spacing=2).spacing == pytest.approx((2, 2, 2))


def ball(radius, shape, spacing, centre):
    """A ball about a place in mm, on a lattice whose first voxel is the origin; axes are (z, y, x)."""
    places = np.meshgrid(*(np.arange(n) * h for n, h in zip(shape, spacing, strict=True)), indexing="ij")
    return sum((place - c) ** 2 for place, c in zip(places, centre, strict=True)) < radius**2


def test_distances_to_a_later_surface(tmp_path):
    centre = (15.2, 14.7, 15.4)
    first = ball(9.0, (28, 34, 34), (1.1, 0.9, 0.9), centre)
    later = ball(10.5, (33, 33, 38), (0.9, 0.9, 0.8), centre)
    images = [nibabel.Nifti1Image(mask.T.astype(np.uint8), np.diag([*spacing[::-1], 1.0]))
              for mask, spacing in ((first, (1.1, 0.9, 0.9)), (later, (0.9, 0.9, 0.8)))]  # fmt: skip
    nibabel.save(images[1], tmp_path / "later.nii.gz")
    surface = surfometry.surface(images[0], against=images[1], curvature_sigma=None)
    distance, told = surface.arrays["distance_mm"], surface.arrays["distance_mm_standard_error"]
    assert distance.mean() == pytest.approx(1.5, abs=0.04) and (distance > 1.0).all()
    assert np.sqrt(np.mean((distance - 1.5) ** 2)) < 1.3 * np.sqrt(np.mean(told**2))
    change = surface.curvature["against"]
    assert change["distance_mm"]["mean"] == pytest.approx(1.5, abs=0.04)
    assert change["distance_mm"]["share_beyond_noise"] > 0.99
    assert change["mean_curvature_change_per_mm"]["mean"] == pytest.approx(1 / 10.5 - 1 / 9, abs=0.003)
    of_file = surfometry.surface(images[0], against=tmp_path / "later.nii.gz", curvature_sigma=None)
    # The file holds its affine in single precision.
    assert np.allclose(of_file.arrays["distance_mm"], distance, atol=1e-4)
    back = surfometry.surface(tmp_path / "later.nii.gz", against=images[0], curvature_sigma=None)
    assert back.arrays["distance_mm"].mean() == pytest.approx(-1.5, abs=0.04)
    assert surfometry.surface(images[0]).curvature["against"] is None


def test_a_later_image_without_the_object_is_told():
    image = turned_body().astype(np.uint8)
    with pytest.raises(surfometry.InputError, match=r"later image.*label 1"):
        surfometry.surface(image, SPACING, against=3 * image, curvature_sigma=None)
    with pytest.raises(surfometry.FileError, match=r"nowhere\.nii"):
        surfometry.surface(image, SPACING, against="nowhere.nii", curvature_sigma=None)
