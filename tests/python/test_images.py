"""Images of other libraries: three sizes, three spacings, an oblique direction; results come back in their place."""

import itertools
import re
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


def test_nibabel_with_a_channel_in_front_is_refused_as_its_file_is(tmp_path):
    """The affine is that of the first three axes, of which the channel is one."""
    kept = nibabel_image()
    image = nibabel.Nifti1Image(np.asanyarray(kept.dataobj)[None], kept.affine)
    nibabel.save(image, tmp_path / "body.nii")
    for given, spacing in itertools.product([image, nibabel.load(tmp_path / "body.nii"), tmp_path / "body.nii"], [None, X_FIRST]):
        with pytest.raises(surfometry.InputError, match="is a channel and not x, so the spacings that the header names belong"):
            surfometry.measure(given, spacing)
    behind = nibabel.Nifti1Image(np.asanyarray(kept.dataobj)[..., None, None], kept.affine)
    assert numbers(surfometry.measure(behind)) == numbers(surfometry.measure(kept))


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


ORDERS = list(itertools.permutations("zyx"))


def in_order(values, dims):
    """What has an entry an axis z, y, x, in the order of the dimensions."""
    return [values["zyx".index(dim)] for dim in dims]


@pytest.mark.parametrize("dims", ORDERS)
@pytest.mark.parametrize("coordinates", ["", "x", "zy"])
def test_xarray_has_its_spacing_in_the_order_of_its_dimensions(dims, coordinates):
    """The numbers, the surface and the maps are those of the same voxels as an array (z, y, x)."""
    known = data_array(dims)
    image = xarray.DataArray(known.values, dims=dims, coords={dim: known.coords[dim] for dim in coordinates})
    spacing = in_order(SPACING, dims)
    plain = turned_body()
    with pytest.raises(surfometry.InputError, match="in the order of the array's axes"):
        surfometry.measure(image)
    assert numbers(surfometry.measure(image, spacing)) == numbers(surfometry.measure(plain, SPACING))
    ours, theirs = surfometry.surface(image, spacing), surfometry.surface(plain, SPACING)
    assert np.array_equal(ours.vertices, theirs.vertices) and np.array_equal(ours.faces, theirs.faces)
    made = surfometry.voxel_maps(image, spacing, quantities="phi")["phi"]
    assert made.dims == dims and set(made.coords) == set(coordinates)
    phi = surfometry.voxel_maps(plain, SPACING, quantities="phi")["phi"]
    assert np.array_equal(made.transpose("z", "y", "x").values, phi)


@pytest.mark.parametrize("dims", ORDERS)
def test_every_command_has_the_spacing_of_an_xarray_in_the_same_order(dims):
    image, plain = data_array(dims).drop_vars(list(dims)), turned_body()
    spacing = in_order(SPACING, dims)

    def both(command):
        return command(image, spacing), command(plain, SPACING)

    ours, theirs = both(lambda *given: surfometry.measure_labels(*given, name="body", as_frame=False))
    volatile = [name for name in ours if "seconds" in name]
    assert {**ours, **dict.fromkeys(volatile)} == {**theirs, **dict.fromkeys(volatile)}
    ours, theirs = both(lambda *given: surfometry.reference(*given, methods=["crofton-3"], name="body"))
    assert [one["surface_area_mm2"] for one in ours] == [one["surface_area_mm2"] for one in theirs]
    (ours,), (theirs,) = both(lambda image, spacing: surfometry.sweep(image, [1.5], spacing))
    assert numbers(ours) == numbers(theirs)


@pytest.mark.parametrize("dims", ORDERS)
def test_a_spacing_in_the_place_of_coordinates(dims):
    """It keeps the place, and a length is not taken for another axis's."""
    image = data_array(dims)
    same, doubled = (surfometry.measure(image, [factor * h for h in in_order(SPACING, dims)]) for factor in (1, 2))
    assert same.surface_area == pytest.approx(surfometry.measure(image).surface_area, rel=1e-9)
    assert doubled.to_dict()["grid"]["spacing_mm"] == pytest.approx([2 * h for h in X_FIRST])
    other = list(map(str.upper, dims))
    capital = image.rename(dict(zip(dims, other)))
    assert surfometry.measure(capital, in_order(SPACING, dims)).surface_area == same.surface_area


def test_dimensions_of_other_names_are_z_y_x_as_an_array_is():
    image = xarray.DataArray(turned_body(), dims=("depth", "lat", "lon"))
    assert numbers(surfometry.measure(image, SPACING)) == numbers(surfometry.measure(turned_body(), SPACING))


def test_a_channel_goes_before_an_axis_of_one_voxel():
    flat = data_array(("x", "y", "z")).isel(x=slice(19, 20)).drop_vars("x").expand_dims("c", 3)
    assert flat.shape == (1, *SHAPE[1::-1], 1)
    assert numbers(surfometry.measure(flat, X_FIRST)) == numbers(surfometry.measure(turned_body()[:, :, 19:20], SPACING))


def test_a_coordinate_of_one_value_tells_no_spacing():
    flat = data_array().isel(x=slice(19, 20))
    with pytest.raises(surfometry.InputError, match="coordinate x has one value, and no step: say what the voxel spacing is"):
        surfometry.measure(flat)
    assert surfometry.measure(flat, SPACING).to_dict()["grid"]["spacing_mm"] == list(X_FIRST)


@pytest.mark.parametrize("axes", ["".join(order) for order in ORDERS])
def test_an_image_with_its_axes_in_any_order(axes):
    affine = lps_affine(oblique_directions(), ORIGIN)
    image = surfometry.Image(turned_body().transpose(["zyx".index(axis) for axis in axes]), axes, affine[:3].tolist())
    assert image.voxels.shape == SHAPE and image.spacing == pytest.approx(in_order(SPACING, axes))
    check_place(surfometry.measure(image), affine)
    made = surfometry.voxel_maps(image, in_order(SPACING, axes), quantities="phi")["phi"]
    assert ((made < 0) != (image.array > 0)).mean() < 0.02
    with pytest.raises(surfometry.ParameterError, match="the letters x, y and z"):
        surfometry.Image(turned_body(), "zy" + axes[0].upper())


LENGTHS = {
    "mm": 1, "millimeter": 1, "millimetres": 1, "MM": 1, "um": 1e-3, "µm": 1e-3, "μm": 1e-3, "micron": 1e-3, "microns": 1e-3,
    "micrometers": 1e-3, "Micrometre": 1e-3, "nm": 1e-6, "nanometres": 1e-6, "Å": 1e-7, "angstroms": 1e-7, "cm": 10,
    "centimeters": 10, "m": 1e3, "meters": 1e3, "in": 25.4, "inch": 25.4, "inches": 25.4,
}  # fmt: skip
NO_LENGTHS = ["pixel", "pixels", "px", "voxel", "Voxels", "furlong", "degrees_north", "1", "0.1 mm", "unknown", "ms", "???"]


@pytest.mark.parametrize("unit", LENGTHS)
def test_xarray_in_units_as_they_are_read_of_files(unit, tmp_path):
    body, length = np.ascontiguousarray(turned_body()), LENGTHS[unit]
    measured = surfometry.measure(data_array(unit=unit, scale=1 / length))
    assert measured.surface_area == pytest.approx(surfometry.measure(data_array()).surface_area, rel=1e-5)
    sizes, lengths = " ".join(map(str, SHAPE[::-1])), " ".join(repr(h / length) for h in X_FIRST)
    units = f'"{unit}" ' * 3
    header = f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: {sizes}\nspacings: {lengths}\nunits: {units}\nencoding: raw\n\n"
    (tmp_path / "body.nrrd").write_bytes(header.encode() + body.tobytes())
    assert surfometry.measure(tmp_path / "body.nrrd").surface_area == pytest.approx(measured.surface_area, rel=1e-5)


@pytest.mark.parametrize("unit", NO_LENGTHS)
def test_coordinates_in_no_length_want_a_spacing(unit):
    """Their place is in no length either: what is measured lies as an array does."""
    image = data_array(("y", "x", "z"), unit=unit)
    with pytest.raises(surfometry.InputError, match=f"`{re.escape(unit)}`, which is no length that is known: say what the voxel") as raised:
        surfometry.measure(image)
    assert raised.value.field == "spacing" and "spacing=1 where a voxel is the unit" in str(raised.value)
    measured = surfometry.measure(image, in_order(SPACING, "yxz"))
    assert numbers(measured) == numbers(surfometry.measure(turned_body(), SPACING))
    assert surfometry.voxel_maps(image, in_order(SPACING, "yxz"))["mean_curvature_per_mm"].dims == ("y", "x", "z")


def test_coordinates_without_a_unit_are_mm():
    image = data_array()
    for dim in "zyx":
        del image.coords[dim].attrs["units"]
    assert numbers(surfometry.measure(image)) == numbers(surfometry.measure(data_array()))


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


def test_a_napari_layer_in_no_length_wants_a_spacing():
    layer = NapariLayer("furlong")
    with pytest.raises(surfometry.InputError, match="`furlong`, which is no length that is known: say what the voxel spacing is"):
        surfometry.measure(layer)
    assert numbers(surfometry.measure(layer, SPACING)) == numbers(surfometry.measure(turned_body(), SPACING))


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
