"""Integrals over surfaces and their exact derivatives by every voxel, on NumPy arrays.

What `surfometry.torch` and `surfometry.jax` wrap, and all that another framework needs: a value and its vector-Jacobian
product. The numbers are those of the blurred surface, ``measure(...).blurred``; docs/differentiable.md says what they
mean, where they hold and what they cost.

>>> import numpy as np
>>> from surfometry import differentiable
>>> z, y, x = np.mgrid[-12:13, -12:13, -12:13]
>>> phi = np.sqrt((z - 0.31) ** 2 + (y + 0.22) ** 2 + (x - 0.17) ** 2) - 8.0  # negative inside a ball of 8 mm
>>> integrals = differentiable.integrals(phi, spacing=1, embedding="given")
>>> bool(abs(integrals.surface_area / (4 * np.pi * 64) - 1) < 0.01)
True
>>> area, gradient = differentiable.value_and_grad(phi, {"surface_area": 1}, spacing=1, embedding="given")
>>> bool(abs(gradient.sum() / (-8 * np.pi * 8) - 1) < 0.01)  # raised by a constant, the ball shrinks
True
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._errors import InputError, ParameterError
from ._image import native, unmasked
from ._options import options_of
from ._session import threads_of

#: Distance between voxels in mm, in the order of the spatial axes; one for all, three, or three for each image.
Spacing: TypeAlias = float | Sequence[float] | ArrayLike


class Integrals(NamedTuple):
    """Integrals over phi = 0, one for each image: arrays of the leading axes' shape.

    Attributes
    ----------
    volume : array
        V, mm³.
    surface_area : array
        A, mm².
    total_mean_curvature : array
        Integral of H, mm.
    total_gaussian_curvature : array
        Integral of K, which is 2 pi times the surface's Euler characteristic.
    total_squared_mean_curvature : array
        Integral of H², the bending energy; 4 pi of any ball.
    """

    volume: Any
    surface_area: Any
    total_mean_curvature: Any
    total_gaussian_curvature: Any
    total_squared_mean_curvature: Any


@dataclass(frozen=True)
class _Integration:
    """How integrals are taken, as the extension module reads it."""

    options: dict[str, str]
    spacings: list[list[float]]
    threads: int


def integrals(
    image: ArrayLike,
    spacing: Spacing,
    *,
    embedding: str,
    sigma: float | None = None,
    thickness: float | None = None,
    epsilon: float | None = None,
    level: float | None = None,
    derivatives: str | None = None,
    quadrature: str | None = None,
    delta: str | None = None,
    threads: int | None = None,
) -> Integrals:
    """Volume, area and curvature of the surfaces in images.

    Parameters
    ----------
    image : array, shape (..., z, y, x)
        Fields or soft segmentations, as ``embedding`` says; each of the leading axes' images has a surface of its own.
        Taken as float32 or float64; sums are in double precision either way.
    spacing : float, three floats, or an array (..., 3)
        mm, in the order of the three last axes.
    embedding : {"given", "probability"}
        ``"given"``: a field, negative inside, which ends at the edge of its image. ``"probability"``: values from 0 to 1,
        blurred to phi = level - G_sigma * image; beyond the edge of the image they are 0.
    sigma : float, optional
        Blur of probabilities, mm. By default twice the geometric mean of the spacings, or 1.75 of the largest.
    thickness : float, optional
        Of the band, mm; of a field that of a signed distance. By default 2.5 of the largest spacing.
    epsilon : float, optional
        Half-width of the band in units of the field, in the place of a thickness.
    level, derivatives, quadrature, delta : optional
        As of `surfometry.measure`; derivatives are ``"matched"`` or ``"finite-difference"``.
    threads : int, optional
        As of `surfometry.measure`; they change no bit.

    Returns
    -------
    Integrals
        float64. Without a surface 0, and the volume that of all voxels or none.

    Raises
    ------
    InputError
        Values that are not finite, or no probabilities.
    ParameterError
        Arguments that make no sense or have no derivative.
    """
    images = _Images.of(image)
    integration = _integration(locals(), images)
    return Integrals(*np.moveaxis(_core.integrals(images.flat, integration).reshape(*images.leading, 5), -1, 0))


def vjp(
    image: ArrayLike,
    weights: Integrals | Mapping[str, ArrayLike],
    spacing: Spacing,
    *,
    embedding: str,
    sigma: float | None = None,
    thickness: float | None = None,
    epsilon: float | None = None,
    level: float | None = None,
    derivatives: str | None = None,
    quadrature: str | None = None,
    delta: str | None = None,
    threads: int | None = None,
) -> NDArray[Any]:
    """The vector-Jacobian product of `integrals`: the derivative of their weighted sum by every voxel.

    It is the exact derivative of the numbers that `integrals` returns, of the same arguments.

    Parameters
    ----------
    weights : Integrals or mapping
        A weight for each integral that counts, by its name: numbers, or arrays of the leading axes' shape.
    image, spacing, embedding, sigma, thickness, epsilon, level, derivatives, quadrature, delta, threads
        As of `integrals`.

    Returns
    -------
    array
        Of the image's shape; float32 of a float32 image, else float64.
    """
    images = _Images.of(image)
    integration = _integration(locals(), images)
    gradient = _core.integrals_vjp(images.flat, _weights(weights, images), integration)
    return gradient.reshape(images.shape)


def value_and_grad(
    image: ArrayLike, weights: Integrals | Mapping[str, ArrayLike], spacing: Spacing, **options: Any
) -> tuple[NDArray[np.float64], NDArray[Any]]:
    """The weighted sum of the integrals, and its derivative by every voxel.

    Parameters
    ----------
    image, weights, spacing, **options
        As of `vjp`.

    Returns
    -------
    value : array
        Of the leading axes' shape.
    gradient : array
        As of `vjp`.
    """
    images = _Images.of(image)
    values = integrals(images.array, spacing, **options)
    own = _weights(weights, images).reshape(*images.leading, 5)
    # A weight of 0 is no part of the sum.
    value = (own * np.stack(values, axis=-1)).sum(axis=-1)
    return value, vjp(images.array, weights, spacing, **options)


@dataclass(frozen=True, eq=False)
class _Images:
    """Images of some shape, the last three axes of which are space."""

    array: NDArray[Any]

    @classmethod
    def of(cls, image: ArrayLike) -> _Images:
        array = np.asanyarray(image)
        if isinstance(array, np.ma.MaskedArray):
            array = unmasked(array)
        array = native(np.asarray(array))
        if array.ndim < 3:
            raise InputError(
                f"an array of shape {array.shape}: its last three axes are space, those before them make a batch",
                field="image",
            )
        return cls(array if array.dtype in (np.float32, np.float64) else array.astype(np.float64))

    @property
    def shape(self) -> tuple[int, ...]:
        return self.array.shape

    @property
    def leading(self) -> tuple[int, ...]:
        return self.shape[:-3]

    @property
    def flat(self) -> NDArray[Any]:
        """As a batch (n, z, y, x), where the array lies if it is dense."""
        return np.ascontiguousarray(self.array).reshape(-1, *self.shape[-3:])


def _integration(local: Mapping[str, Any], images: _Images) -> _Integration:
    names = ("embedding", "sigma", "thickness", "epsilon", "level", "derivatives", "quadrature", "delta")
    if local["embedding"] not in ("given", "probability"):
        message = f"embedding={local['embedding']!r}: \"given\" of a field, negative inside, or \"probability\" of values from 0 to 1"
        raise ParameterError(message, field="embedding")
    options = options_of(**{name: local[name] for name in names})
    return _Integration(options, _spacings(local["spacing"], images), threads_of(local["threads"]))


def _spacings(spacing: Spacing, images: _Images) -> list[list[float]]:
    """Those of the images, x first; one where all have the same."""
    try:
        lengths = np.asarray(spacing, dtype=float)
        shape = (*images.leading, 3) if lengths.ndim > 1 else (3,)
        broadcast = np.broadcast_to(lengths, shape).reshape(-1, 3)
    except (TypeError, ValueError) as error:
        message = f"spacing={spacing!r}: three numbers in mm, in the order of the last three axes, one for all, or three an image"
        raise ParameterError(message, field="spacing") from error
    rows: list[list[float]] = broadcast[:, ::-1].tolist()
    return rows


def _weights(weights: Integrals | Mapping[str, ArrayLike], images: _Images) -> NDArray[np.float64]:
    """Rows (n, 5)."""
    by_name = weights._asdict() if isinstance(weights, Integrals) else dict(weights)
    unknown = by_name.keys() - set(Integrals._fields)
    if unknown:
        known = ", ".join(Integrals._fields)
        raise ParameterError(f"weights of {', '.join(sorted(unknown))}: there are {known}", field="weights")
    rows = np.zeros((*images.leading, 5))
    try:
        for number, name in enumerate(Integrals._fields):
            rows[..., number] = np.asarray(by_name.get(name, 0.0), dtype=float)
    except (TypeError, ValueError) as error:
        message = f"weights={weights!r}: numbers, or arrays of the shape {images.leading} of the batch"
        raise ParameterError(message, field="weights") from error
    return rows.reshape(-1, 5)
