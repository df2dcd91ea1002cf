"""Images of other libraries, known by what they offer: none of them is imported before one of its objects is passed.

A new kind is a function here and a line of ``_KINDS``.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._errors import InputError, UnsupportedTypeError
from ._image import Axes, Frame, Image, Rows, names_of, native, three_axes

# mm in the units that images of other libraries name, those of files' headers (`mm_per`); no name counts as mm.
_MILLIMETRES = {
    "": 1.0, "mm": 1.0, "millimeter": 1.0, "um": 1e-3, "µm": 1e-3, "μm": 1e-3, "micron": 1e-3, "micrometer": 1e-3,
    "nm": 1e-6, "nanometer": 1e-6, "å": 1e-7, "angstrom": 1e-7, "cm": 10.0, "centimeter": 10.0, "m": 1e3, "meter": 1e3,
    "in": 25.4, "inch": 25.4, "inche": 25.4,
}  # fmt: skip
# What nibabel and napari say of an image whose unit nobody set, which is what most are: lengths are mm then.
_NOT_SET = ("unknown", "pixel", "voxel")
# How far steps of coordinates may differ, in units of the step.
_REGULAR = 1e-3


def image_of(image: object) -> Image:
    """Whatever was passed, as an image; paths and names of phantoms are none."""
    if isinstance(image, Image):
        return image
    for is_kind, made in _KINDS:
        if is_kind(image):
            return made(image)
    raise UnsupportedTypeError(
        f"{type(image).__module__}.{type(image).__qualname__} is no image that is known; pass an array with its spacing, "
        "a path, or an image of SimpleITK, itk, nibabel, xarray, napari, MONAI, TorchIO or PyVista",
        field="image",
    )


def _has(*names: str) -> Callable[[object], bool]:
    return lambda image: all(hasattr(image, name) for name in names)


def _of_simpleitk(image: Any) -> Image:
    sitk = _module_of(image)
    _check_itk(image.GetDimension(), image.GetNumberOfComponentsPerPixel())

    def like(array: NDArray[Any]) -> object:
        made = sitk.GetImageFromArray(array)
        made.CopyInformation(image)
        return made

    affine = _itk_affine(image.GetDirection(), image.GetSpacing(), image.GetOrigin())
    voxels = sitk.GetArrayViewFromImage(image)
    return Image(voxels, "zyx", affine, "SimpleITK image", frame="LPS", like=like)


def _of_itk(image: Any) -> Image:
    itk = _module_of(image)
    _check_itk(image.GetImageDimension(), image.GetNumberOfComponentsPerPixel())
    direction = itk.array_from_matrix(image.GetDirection())
    # The first voxel is that of the region's start, which need not be index 0.
    start = image.TransformIndexToPhysicalPoint(image.GetLargestPossibleRegion().GetIndex())
    affine = _itk_affine(direction, list(image.GetSpacing()), list(start))

    def like(array: NDArray[Any]) -> object:
        made = itk.image_from_array(np.ascontiguousarray(array))
        made.SetDirection(image.GetDirection())
        made.SetSpacing(image.GetSpacing())
        made.SetOrigin(start)
        return made

    return Image(itk.array_view_from_image(image), "zyx", affine, "itk image", frame="LPS", like=like)


def _check_itk(dimension: int, components: int) -> None:
    if dimension != 3 or components != 1:
        raise InputError(
            f"an image of {dimension} dimensions and {components} numbers a voxel: surfometry measures 3-D images of one "
            "number a voxel",
            field="image",
        )


def _itk_affine(direction: Any, spacing: Any, origin: Any) -> Rows:
    """Directions are the columns of ITK's matrix, one an axis, x first."""
    columns = np.asarray(direction, dtype=float).reshape(3, 3).T.tolist()
    return _core.affine_of_directions(columns, _floats(spacing), _floats(origin), True)


def _of_nibabel(image: Any) -> Image:
    # Of what is stored: get_fdata() would make doubles of labels.
    voxels = np.asanyarray(image.dataobj)
    while voxels.ndim > 3 and voxels.shape[-1] == 1:
        voxels = voxels[..., 0]
    if voxels.ndim > 3 and voxels.shape[0] == 1:
        # As of the same file by its path.
        raise InputError(
            f"the axes are {list(image.shape)}: the first one, of a single sample, is a channel and not x, so the spacings "
            "that the header names belong to other axes; make an image of the three axes of space with their affine",
            field="image",
        )
    affine = np.array(image.affine, dtype=float)
    if hasattr(image.header, "get_xyzt_units"):
        affine[:3] *= _millimetres(image.header.get_xyzt_units()[0])

    def like(array: NDArray[Any]) -> object:
        # In the header's own unit, which the copy names.
        return type(image)(array, image.affine, _typed_header(image.header, array))

    path = image.get_filename() if hasattr(image, "get_filename") else None
    name = os.fspath(path) if path else "nibabel image"
    return Image(three_axes(voxels), "xyz", _rows(affine), name, frame="RAS", like=like)


def _typed_header(header: Any, array: NDArray[Any]) -> Any:
    copied = header.copy()
    copied.set_data_dtype(array.dtype)
    return copied


def _of_xarray(image: Any) -> Image:
    single = [dim for dim in image.dims if image.sizes[dim] == 1]
    # A time or channel goes before an axis of space that has one voxel.
    single.sort(key=lambda dim: str(dim).lower() in ("x", "y", "z"))
    spatial = image.squeeze(single[: max(0, image.ndim - 3)])
    if spatial.ndim != 3:
        three_axes(spatial.values)
    letters = [str(dim).lower() for dim in spatial.dims]
    # As passed, for a spacing is given in the order of the axes.
    axes = cast(Axes, "".join(letters)) if sorted(letters) == ["x", "y", "z"] else "zyx"
    steps: list[_Step] = []
    if all(dim in spatial.coords for dim in spatial.dims):
        steps = [_step(spatial.coords[spatial.dims[axes.index(axis)]]) for axis in "xyz"]
    unspaced = next((step.unknown for step in steps if step.unknown), "")
    affine = None
    if steps and not unspaced:
        affine = _xarray_affine(image.attrs.get("direction"), [step.mm for step in steps], [step.first for step in steps])

    def like(array: NDArray[Any]) -> object:
        return spatial.copy(data=array)

    # An image that has no place lies among the axes of its array.
    frame: Frame = "LPS" if affine is not None and "direction" in image.attrs else "own"
    name = str(image.name) if image.name is not None else "DataArray"
    return Image(three_axes(spatial.values), axes, affine, name, frame=frame, like=like, unspaced=unspaced)


def _xarray_affine(direction: Any, steps: list[float], origin: list[float]) -> Rows:
    if direction is None:
        affine = np.diag([*steps, 1.0])
        affine[:3, 3] = origin
        return _rows(affine)
    # itk names both axes of the matrix z first.
    return _itk_affine(np.flip(np.asarray(direction, dtype=float)), steps, origin)


@dataclass(frozen=True)
class _Step:
    """The step of a coordinate and its first value, mm; or why they are not known."""

    mm: float = 1.0
    first: float = 0.0
    unknown: str = ""


def _step(coordinate: Any) -> _Step:
    name = str(coordinate.name)
    values = np.asarray(coordinate.values, dtype=float)
    if len(values) < 2:
        return _Step(unknown=f"the coordinate {name} has one value, and no step")
    steps = np.diff(values)
    step = float((values[-1] - values[0]) / (len(values) - 1))
    if step == 0.0 or not np.all(np.abs(steps - step) <= _REGULAR * abs(step)):
        raise InputError(
            f"the coordinate {name} has unequal steps, from {steps.min():.6g} to {steps.max():.6g}: interpolate the image "
            "to a regular lattice first",
            field="image",
        )
    unit = coordinate.attrs.get("units")
    mm = _mm_per("" if unit is None else unit)
    if mm is None:
        return _Step(unknown=f"the coordinate {name} is in `{unit}`, which is no length that is known")
    return _Step(step * mm, float(values[0]) * mm)


def _of_napari(layer: Any) -> Image:
    data = layer.data[0] if getattr(layer, "multiscale", False) else layer.data
    leading = max(0, np.ndim(data) - 3)
    place = np.zeros(leading + 3)

    def world(*index: float) -> NDArray[Any]:
        return np.asarray(layer.data_to_world([*place[:leading], *index]), dtype=float)[leading:]

    corner = world(0, 0, 0)
    try:
        units = napari_units(layer)
    except InputError as unknown:
        return Image(three_axes(data), name=str(layer.name), unspaced=str(unknown))
    columns = [world(*step) - corner for step in np.eye(3)]
    # napari's axes and world both go z, y, x.
    linear = (np.array(columns).T * units[:, None])[::-1, ::-1]
    affine = np.column_stack([linear, (corner * units)[::-1]])
    return Image(three_axes(data), "zyx", _rows(affine), str(layer.name))


def napari_units(layer: Any) -> NDArray[np.float64]:
    """mm in the units of a layer's axes z, y, x."""
    units = getattr(layer, "units", None) or [""] * 3
    return np.array([_millimetres(unit) for unit in tuple(units)[-3:]])


def _of_metatensor(image: Any) -> Image:
    voxels = image.detach().cpu().numpy()
    affine = np.asarray(image.affine, dtype=float)
    if affine.ndim != 2:
        raise InputError("a batch of images: pass them one by one, image[0], image[1]", field="image")

    def like(array: NDArray[Any]) -> object:
        tensor = type(image)(np.ascontiguousarray(array).reshape(voxels.shape), affine=image.affine)
        return tensor

    is_lps = str(image.meta.get("space", "RAS")).upper().endswith("LPS")
    rows = _lps_swapped(affine) if is_lps else affine
    frame: Frame = "LPS" if is_lps else "RAS"
    return Image(three_axes(voxels), "xyz", _rows(rows), "MetaTensor", frame=frame, like=like)


def _of_torchio(image: Any) -> Image:
    tensor = image.data
    voxels = tensor.numpy() if hasattr(tensor, "numpy") else np.asarray(tensor)
    affine = np.asarray(getattr(image.affine, "numpy", lambda: image.affine)(), dtype=float)

    def like(array: NDArray[Any]) -> object:
        return type(image)(tensor=np.ascontiguousarray(array)[None], affine=affine)

    return Image(three_axes(voxels), "xyz", _rows(affine), "TorchIO image", frame="RAS", like=like)


def _of_pyvista(grid: Any) -> Image:
    name, at_points = _active(grid)
    data = grid.point_data if at_points else grid.cell_data
    dimensions = [int(n) - (not at_points) for n in grid.dimensions]
    linear = np.asarray(grid.direction_matrix, dtype=float) * np.asarray(grid.spacing, dtype=float)
    # The first voxel's centre: of cells half a voxel behind the first point.
    origin = np.asarray(grid.origin, dtype=float) + (0.0 if at_points else linear.sum(axis=1) / 2)
    array = np.asarray(data[name]).reshape(dimensions, order="F")

    def like(array: NDArray[Any]) -> object:
        made = grid.copy()
        made.clear_data()
        kept = made.point_data if at_points else made.cell_data
        kept["values"] = array.ravel(order="F")
        return made

    return Image(array, "xyz", _rows(np.column_stack([linear, origin])), name, like=like)


def _active(grid: Any) -> tuple[str, bool]:
    """The array that a PyVista image is of, and whether its values are at points."""
    name = grid.active_scalars_name
    if name is None:
        raise InputError(
            "the image has no active scalars: say which array is meant, with image.set_active_scalars(NAME)", field="image"
        )
    return str(name), name in grid.point_data


def _is_pair(image: object) -> bool:
    return isinstance(image, tuple) and len(image) == 2 and isinstance(image[1], Mapping)


def _of_pair(pair: tuple[Any, Mapping[str, Any]]) -> Image:
    """An array (z, y, x) and what is known of it, x first, as aimio-py has them."""
    array, meta = pair
    spacing = meta.get("spacing", meta.get("element_size"))
    if spacing is None:
        raise InputError("the second of the pair names no `spacing`, x first, in mm", field="image")
    direction = meta.get("direction", np.eye(3))
    affine = _itk_affine(direction, spacing, meta.get("origin", (0.0, 0.0, 0.0)))

    def like(array: NDArray[Any]) -> object:
        return array, dict(meta)

    names = names_of(meta.get("label_names"))
    return Image(three_axes(array), "zyx", affine, "image", names, frame="LPS", like=like)


def _of_array(array: Any) -> Image:
    if hasattr(array, "detach"):
        array = array.detach().cpu().numpy()
    return Image(three_axes(array))


def _is_array(image: object) -> bool:
    return isinstance(image, (np.ndarray, Sequence)) or hasattr(image, "__array__")


def _mm_per(unit: object) -> float | None:
    """mm in a unit of length, in whatever case; None for an unknown one."""
    # pint writes a unit as a quantity of one.
    word = str(unit).strip().lower().removeprefix("1 ").replace("metre", "meter")
    # Words have a plural; `ms` and `s` are times.
    return _MILLIMETRES.get(word.removesuffix("s") if len(word) > 4 else word)


def _millimetres(unit: object) -> float:
    """Of nibabel and napari."""
    if str(unit).strip().lower() in _NOT_SET:
        return 1.0
    mm = _mm_per(unit)
    if mm is None:
        raise InputError(f"lengths are in `{unit}`, which is no length that is known", field="spacing")
    return mm


def _lps_swapped(affine: NDArray[Any]) -> NDArray[Any]:
    turned: NDArray[Any] = np.diag([-1.0, -1.0, 1.0, 1.0]) @ affine
    return turned


def _rows(affine: NDArray[Any]) -> Rows:
    rows: Rows = np.asarray(affine, dtype=float)[:3, :4].tolist()
    return rows


def _floats(values: Any) -> list[float]:
    return [float(value) for value in values]


def _module_of(image: object) -> Any:
    """The package that an object is of."""
    import importlib

    return importlib.import_module(type(image).__module__.split(".")[0])


# Who knows more stands before who knows less: a MetaTensor is an array too.
_KINDS: list[tuple[Callable[[object], bool], Callable[[Any], Image]]] = [
    (_is_pair, _of_pair),
    (_has("GetLargestPossibleRegion", "TransformIndexToPhysicalPoint"), _of_itk),
    (_has("GetDirection", "GetSpacing", "GetNumberOfComponentsPerPixel"), _of_simpleitk),
    (_has("dataobj", "affine", "header"), _of_nibabel),
    (_has("data_to_world", "translate"), _of_napari),
    (_has("affine", "meta", "pixdim", "detach"), _of_metatensor),
    (_has("affine", "spatial_shape", "data"), _of_torchio),
    (_has("direction_matrix", "dimensions", "point_data"), _of_pyvista),
    (_has("dims", "coords", "sizes", "transpose"), _of_xarray),
    (_is_array, _of_array),
]


def readable(image: Image, name: str | None) -> Image:
    """The image as the extension module reads it, under the name that the caller gives."""
    return replace(
        image,
        array=native(three_axes(image.array)),
        name=image.name if name is None else name,
    )
