"""Images in memory: an array, where it lies in the world, and how to give something back in its place."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import InputError, ParameterError, UnsupportedTypeError

#: Which axis of an array runs along which axis of the lattice: first to last.
Axes: TypeAlias = Literal["zyx", "zxy", "yzx", "yxz", "xzy", "xyz"]
#: The frame of world coordinates; ``own`` is whatever the image says.
Frame: TypeAlias = Literal["RAS", "LPS", "own"]
#: Rows of a matrix from index (x, y, z) to world, mm.
Rows: TypeAlias = list[list[float]]


def _same(array: NDArray[Any]) -> object:
    return array


@dataclass(frozen=True, eq=False)
class Image:
    """An image in memory.

    Attributes
    ----------
    array : ndarray
        The voxels, three axes, in the order of whatever the image was made of.
    axes : {"zyx", "xyz", ...}
        What the axes of `array` are, in any order; x is the lattice's first axis, named first in all results.
    affine : list of three rows, or None
        From index (x, y, z) to world (RAS), mm; None where nothing is known.
    name : str
        What results are called.
    label_names : dict
        Names of labels.
    frame : {"RAS", "LPS", "own"}
        The frame in which whoever made the image has its coordinates; surfaces are given in it.
    truth : dict or None
        Exact integrals of a built-in shape.
    """

    array: NDArray[Any]
    axes: Axes = "zyx"
    affine: Rows | None = None
    name: str = "array"
    label_names: dict[int, str] = field(default_factory=dict)
    frame: Frame = "own"
    truth: dict[str, float] | None = None
    #: Makes an image of the same kind in the same place, of an array in this order of axes.
    like: Callable[[NDArray[Any]], object] = _same
    #: Why there is no spacing, in the words of an error, where more can be said than that there is none.
    unspaced: str = ""

    def __post_init__(self) -> None:
        if sorted(self.axes) != ["x", "y", "z"]:
            raise ParameterError(
                f"axes={self.axes!r}: the letters x, y and z in the order of the array's axes, such as 'zyx'", field="axes"
            )

    @property
    def spacing(self) -> tuple[float, float, float] | None:
        """Distance between voxels in mm, in the order of the array's axes."""
        if self.affine is None:
            return None
        lengths = np.linalg.norm(np.array(self.affine)[:, :3], axis=0)
        first, second, third = (float(lengths["xyz".index(axis)]) for axis in self.axes)
        return first, second, third

    @property
    def voxels(self) -> NDArray[Any]:
        """The array as (z, y, x), a view."""
        return np.transpose(self.array, [self.axes.index(axis) for axis in "zyx"])

    def given_back(self, array: NDArray[Any]) -> object:
        """An array (z, y, x) as an image of this kind, in the same place."""
        return self.like(np.transpose(array, ["zyx".index(axis) for axis in self.axes]))

    def __repr__(self) -> str:
        return f"Image({self.name}, {self.array.shape} {self.array.dtype}, spacing={self.spacing})"


def spacing_words(spacing: float | Sequence[float] | None, axes: Axes) -> list[float] | None:
    """A spacing in the order of an array's axes, as x, y, z."""
    if spacing is None:
        return None
    try:
        lengths = [float(length) for length in np.broadcast_to(np.asarray(spacing, dtype=float), 3)]
    except (TypeError, ValueError) as error:
        message = f"spacing={spacing!r}: three numbers in mm, in the order of the array's axes, or one for all"
        raise ParameterError(message, field="spacing") from error
    return [lengths[axes.index(axis)] for axis in "xyz"]


def native(array: NDArray[Any]) -> NDArray[Any]:
    """The array in a type, byte order and alignment that can be read in place, else a copy that can."""
    kind, size = array.dtype.kind, array.dtype.itemsize
    if kind not in "biuf":
        raise UnsupportedTypeError(
            f"voxels of type {array.dtype}: take numbers, such as image.astype('uint8') of labels", field="image"
        )
    if kind == "f" and size not in (4, 8):
        # Half precision fits single exactly; what is wider than double is rounded to it.
        return array.astype(np.float32 if size == 2 else np.float64)
    if not array.dtype.isnative:
        return array.astype(array.dtype.newbyteorder("="))
    return array if array.flags.aligned else array.copy()


def three_axes(array: ArrayLike) -> NDArray[Any]:
    """An array of three axes: axes of one element in front, as of a batch or channel, are dropped."""
    voxels = np.asanyarray(array)
    if isinstance(voxels, np.ma.MaskedArray):
        voxels = unmasked(voxels)
    while voxels.ndim > 3 and voxels.shape[0] == 1:
        voxels = voxels[0]
    if voxels.ndim != 3:
        raise InputError(
            f"an array of shape {voxels.shape}: surfometry measures 3-D images, one at a time; of a one-hot image take "
            "one channel, or argmax over its channels",
            field="image",
        )
    return np.asarray(voxels)


def unmasked(array: np.ma.MaskedArray[Any, Any]) -> NDArray[Any]:
    """What a masked array holds, where nothing of it is masked."""
    if np.ma.is_masked(array):
        raise InputError(
            "some voxels are masked: say what they are, with image.filled(0) where they are background", field="image"
        )
    return np.asarray(array.data)


def names_of(names: Mapping[int, str] | None) -> dict[int, str]:
    """Names of labels with whole keys."""
    return {int(label): str(name) for label, name in (names or {}).items()}
