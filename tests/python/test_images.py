"""Images of other libraries: three sizes, three spacings, an oblique direction; results come back in their place."""

import types

import nibabel
import numpy as np
import pytest
import pyvista
import SimpleITK
from conftest import ORIGIN, SHAPE, SPACING, NapariLayer, numbers, oblique_directions, turned_body

import surfometry

xarray = pytest.importorskip("xarray")
X_FIRST = SPACING[::-1]


def lps_affine(direction, origin):
    """From index (x, y, z) to LPS."""
    affine = np.eye(4)
    affine[:3, :3] = np.asarray(direction).reshape(3, 3) * X_FIRST
    affine[:3, 3] = origin
    return affine


RAS_OF_LPS = np.diag([-1.0, -1.0, 1.0, 1.0])


def simpleitk_image():
    image = SimpleITK.GetImageFromArray(turned_body())
    image.SetSpacing(X_FIRST)
    image.SetDirection(oblique_directions().ravel())
    image.SetOrigin(ORIGIN)
    return image


def itk_image():
    """The package, where it is installed, and the same in it."""
    itk = pytest.importorskip("itk")
    image = itk.image_from_array(turned_body())
    image.SetSpacing(X_FIRST)
    image.SetDirection(itk.matrix_from_array(oblique_directions()))
    image.SetOrigin(ORIGIN)
    return itk, image


def centroid_index():
    return np.argwhere(turned_body().T).mean(axis=0)


def check_place(measured, affine_ras):
    """The centroid is where the image's own transform puts it."""
    expected = affine_ras @ [*centroid_index(), 1.0]
    assert measured.to_dict()["voxels"]["centroid_mm"] == pytest.approx(expected[:3], abs=1e-9)


def check_surface(image, to_world):
    """Vertices lie around the centroid in the image's own world, and normals point away from the body."""
    surface = surfometry.surface(image)
    centre = np.asarray(to_world(centroid_index()))
    assert np.allclose(surface.vertices.mean(axis=0), centre, atol=1.0)
    outward = surface.arrays["normal"]
    a, b, c = (surface.vertices[surface.faces[:, k]] for k in range(3))
    volume = np.einsum("ij,ij->", a - centre, np.cross(b - centre, c - centre)) / 6
    assert volume == pytest.approx(surface.measurement.volume, rel=0.05)
    assert np.mean(np.einsum("ij,ij->i", outward, surface.vertices - centre) > 0) > 0.99


def test_simpleitk(tmp_path):
    image = simpleitk_image()
    SimpleITK.WriteImage(image, str(tmp_path / "body.mha"))
    measured = surfometry.measure(image)
    assert numbers(measured) == numbers(surfometry.measure(tmp_path / "body.mha"))
    check_place(measured, RAS_OF_LPS @ lps_affine(image.GetDirection(), image.GetOrigin()))
    check_surface(image, image.TransformContinuousIndexToPhysicalPoint)
    made = surfometry.voxel_maps(image, quantities="band")["band"]
    assert made.GetDirection() == image.GetDirection() and made.GetOrigin() == image.GetOrigin()
    inside = SimpleITK.GetArrayFromImage(made)[SimpleITK.GetArrayFromImage(image) > 0]
    assert 0.1 < inside.mean() < 1


def test_simpleitk_with_another_spacing():
    doubled = surfometry.measure(simpleitk_image(), spacing=[2 * h for h in SPACING])
    assert doubled.volume == pytest.approx(8 * surfometry.measure(simpleitk_image()).volume, rel=1e-12)


def test_itk_with_a_region_that_does_not_begin_at_zero():
    _, image = itk_image()
    region = image.GetLargestPossibleRegion()
    region.SetIndex([5, -7, 11])
    image.SetRegions(region)
    measured = surfometry.measure(image)
    shifted = lps_affine(oblique_directions(), ORIGIN)
    shifted[:3, 3] = (shifted @ [5, -7, 11, 1])[:3]
    check_place(measured, RAS_OF_LPS @ shifted)
    assert measured.to_dict()["grid"]["spacing_mm"] == pytest.approx(X_FIRST)
    made = surfometry.voxel_maps(image)["mean_curvature_per_mm"]
    assert list(made.TransformIndexToPhysicalPoint([0, 0, 0])) == pytest.approx(shifted[:3, 3])
    check_surface(image, lambda index: (shifted @ [*index, 1])[:3])


def nibabel_image(unit="mm", scale=1.0, kind=nibabel.Nifti1Image, dtype=np.uint8):
    affine = np.eye(4)
    affine[:3] = (RAS_OF_LPS @ lps_affine(oblique_directions(), ORIGIN))[:3] * scale
    image = kind(turned_body().T.astype(dtype), affine)
    if kind is nibabel.Nifti1Image:
        image.header.set_xyzt_units(unit)
    return image


@pytest.mark.parametrize("unit, scale", [("mm", 1.0), ("micron", 1000.0), ("meter", 0.001)])
def test_nibabel_in_any_unit(unit, scale):
    image = nibabel_image(unit, scale)
    measured = surfometry.measure(image)
    check_place(measured, np.diag([1 / scale] * 3 + [1]) @ image.affine)
    assert measured.to_dict()["grid"]["dimensions"] == list(SHAPE[::-1])
    made = surfometry.voxel_maps(image, quantities="phi")["phi"]
    assert made.shape == image.shape and np.array_equal(made.affine, image.affine)
    assert made.get_data_dtype() == np.float32
    assert ((np.asanyarray(made.dataobj) < 0) != (np.asanyarray(image.dataobj) > 0)).mean() < 0.02


def test_mgz_is_big_endian(tmp_path):
    nibabel.save(nibabel_image(kind=nibabel.MGHImage, dtype=np.int32), tmp_path / "body.mgz")
    image = nibabel.load(tmp_path / "body.mgz")
    assert not np.asanyarray(image.dataobj).dtype.isnative
    check_place(surfometry.measure(image), image.affine)
    check_surface(nibabel_image(), lambda index: (nibabel_image().affine @ [*index, 1])[:3])


def data_array(dims=("z", "y", "x"), unit="mm", scale=1.0):
    coordinates = {
        dim: (dim, (ORIGIN[2 - n] + np.arange(SHAPE[n]) * SPACING[n]) * scale, {"units": unit})
        for n, dim in enumerate(("z", "y", "x"))
    }
    return xarray.DataArray(turned_body(), dims=("z", "y", "x"), coords=coordinates, name="body").transpose(*dims)


@pytest.mark.parametrize("dims", [("z", "y", "x"), ("x", "y", "z"), ("y", "z", "x")])
def test_xarray_in_any_order(dims):
    image = data_array(dims)
    measured = surfometry.measure(image)
    affine = np.diag([*X_FIRST, 1.0])
    affine[:3, 3] = ORIGIN
    check_place(measured, affine)
    check_surface(image, lambda index: (affine @ [*index, 1])[:3])
    made = surfometry.voxel_maps(image)["mean_curvature_per_mm"]
    assert made.dims == dims and made.coords["y"].equals(image.coords["y"])


def test_xarray_that_grows_downward_in_micrometres():
    image = data_array(unit="um", scale=1000.0)
    turned = image.isel(z=slice(None, None, -1))
    plain, down = surfometry.measure(image), surfometry.measure(turned)
    assert down.to_dict()["voxels"]["centroid_mm"] == pytest.approx(plain.to_dict()["voxels"]["centroid_mm"])
    assert plain.volume == pytest.approx(surfometry.measure(data_array()).volume)


def test_xarray_of_itk():
    itk, image = itk_image()
    measured = surfometry.measure(itk.xarray_from_image(image))
    check_place(measured, RAS_OF_LPS @ lps_affine(oblique_directions(), ORIGIN))


def test_xarray_with_unequal_steps_is_refused():
    image = data_array()
    bent = image.assign_coords(y=image.coords["y"].values ** 1.01)
    with pytest.raises(surfometry.InputError, match="coordinate y has unequal steps"):
        surfometry.measure(bent)


@pytest.mark.parametrize("values_at", ["points", "cells"])
def test_pyvista(values_at):
    at_points = values_at == "points"
    dimensions = np.array(SHAPE[::-1]) + (not at_points)
    grid = pyvista.ImageData(dimensions=dimensions, spacing=X_FIRST, origin=ORIGIN)
    grid.direction_matrix = oblique_directions()
    data = grid.point_data if at_points else grid.cell_data
    data["body"] = turned_body().ravel()
    grid.set_active_scalars("body")
    affine = lps_affine(oblique_directions(), ORIGIN)
    if not at_points:
        affine[:3, 3] += affine[:3, :3].sum(axis=1) / 2
    check_place(surfometry.measure(grid), affine)
    check_surface(grid, lambda index: (affine @ [*index, 1])[:3])
    made = surfometry.voxel_maps(grid, quantities="phi")["phi"]
    kept = made.point_data if at_points else made.cell_data
    assert np.array_equal(made.direction_matrix, grid.direction_matrix)
    assert ((kept["values"] < 0) != (turned_body().ravel() > 0)).mean() < 0.02


def test_pair_of_aimio():
    meta = {"element_size": X_FIRST, "origin": tuple(ORIGIN), "direction": tuple(oblique_directions().ravel())}
    measured = surfometry.measure((turned_body(), meta))
    assert numbers(measured) == numbers(surfometry.measure(simpleitk_image()))
    array, given = surfometry.voxel_maps((turned_body(), meta))["mean_curvature_per_mm"]
    assert array.shape == SHAPE and given == meta


@pytest.mark.parametrize("unit, scale, multiscale", [("pixel", 1, False), ("micrometer", 1000, True)])
def test_napari_layer(unit, scale, multiscale):
    layer = NapariLayer(unit, scale, multiscale)
    affine = np.eye(4)
    affine[:3, :3] = oblique_directions() * X_FIRST
    affine[:3, 3] = oblique_directions() @ ORIGIN
    check_place(surfometry.measure(layer), affine)
    check_surface(layer, lambda index: (affine @ [*index, 1])[:3])


class Tensor:
    """What a tensor on the CPU offers; PyTorch is too large to be installed here."""

    def __init__(self, array, **attributes):
        self._array = np.asarray(array)
        self.__dict__.update(attributes)

    def detach(self):
        return self

    cpu = detach

    def numpy(self):
        return self._array


def test_metatensor():
    affine = RAS_OF_LPS @ lps_affine(oblique_directions(), ORIGIN)
    known = {"affine": affine, "meta": {"space": "RAS"}, "pixdim": np.array(X_FIRST)}
    check_place(surfometry.measure(Tensor(turned_body().T[None], **known)), affine)
    swapped = {**known, "affine": RAS_OF_LPS @ affine, "meta": {"space": "LPS"}}
    check_place(surfometry.measure(Tensor(turned_body().T, **swapped)), affine)
    with pytest.raises(surfometry.InputError, match="one by one"):
        surfometry.measure(Tensor(turned_body().T[None, None], **{**known, "affine": affine[None]}))
    with pytest.raises(surfometry.InputError, match="one-hot"):
        surfometry.measure(Tensor(np.stack([turned_body().T] * 2), **known))


def test_torchio():
    affine = RAS_OF_LPS @ lps_affine(oblique_directions(), ORIGIN)
    image = types.SimpleNamespace(data=Tensor(turned_body().T[None]), affine=affine, spatial_shape=SHAPE[::-1])
    check_place(surfometry.measure(image), affine)


def test_plain_tensors_are_arrays():
    plain = surfometry.measure(Tensor(turned_body(), __array__=None), SPACING)
    assert numbers(plain) == numbers(surfometry.measure(turned_body(), SPACING))


def test_names_of_labels():
    body = 4 * turned_body()
    measured = surfometry.measure(body, SPACING, names={4: "L4"}, name="scan 7")
    assert (measured.name, measured.input) == ("L4", "scan 7")
    assert surfometry.measure(surfometry.Image(body, label_names={4: "L4"}), SPACING).name == "L4"


def test_other_libraries_are_imported_by_nobody():
    import subprocess
    import sys

    code = (
        "import sys, numpy, surfometry; surfometry.measure(numpy.pad(numpy.ones((9, 9, 9), bool), 4), 1);"
        "print([m for m in ('nibabel', 'SimpleITK', 'itk', 'xarray', 'pyvista', 'pandas', 'torch') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-W", "ignore", "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
