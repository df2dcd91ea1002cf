"""Integrals over surfaces as a JAX function; needs ``jax`` (``pip install surfometry[jax]``).

>>> import jax, surfometry.jax  # doctest: +SKIP
>>> area = lambda phi: surfometry.jax.integrals(phi, spacing=(2.0, 0.8, 0.8), embedding="given").surface_area  # doctest: +SKIP
>>> jax.jit(jax.grad(area))(phi)  # doctest: +SKIP

The work is done on the CPU, in the library, by `surfometry.differentiable`; arrays of another device are copied to it and
back. docs/differentiable.md says what the numbers mean.
"""

from __future__ import annotations

import functools
from typing import Any

import jax
import numpy as np
from jax import Array
from jax import numpy as jnp

from . import differentiable
from .differentiable import Integrals, Spacing

__all__ = ["integrals"]

#: Spacing and options, which JAX must be able to compare.
_Fixed = tuple[tuple[float, ...], tuple[tuple[str, Any], ...]]


def integrals(image: Array, spacing: Spacing, *, embedding: str, **options: Any) -> Integrals:
    """Volume, area and curvature of the surfaces in images, with gradients.

    Works under ``jit`` and ``vmap``. There are first derivatives in reverse mode only.

    Parameters
    ----------
    image : Array, shape (..., z, y, x)
        As of `surfometry.differentiable.integrals`. Half precision is taken as float32.
    spacing : float or three floats
        mm, in the order of the three last axes.
    embedding, **options
        As of `surfometry.differentiable.integrals`.

    Returns
    -------
    Integrals
        Arrays of the leading axes' shape, of the type of the image.
    """
    image = jnp.asarray(image)
    if image.dtype not in (jnp.float32, jnp.float64):
        image = image.astype(jnp.float32)
    lengths = tuple(float(length) for length in np.broadcast_to(np.asarray(spacing, dtype=float), 3))
    fixed = (lengths, tuple(sorted({"embedding": embedding, **options}.items())))
    return Integrals(*jnp.moveaxis(_integrals(image, fixed), -1, 0))


@functools.partial(jax.custom_vjp, nondiff_argnums=(1,))
def _integrals(image: Array, fixed: _Fixed) -> Array:
    def on_host(image: Any) -> Any:
        spacing, options = fixed
        found = differentiable.integrals(np.asarray(image), spacing, **dict(options))
        return np.stack(found, axis=-1).astype(image.dtype)

    shape = jax.ShapeDtypeStruct((*image.shape[:-3], 5), image.dtype)
    return jax.pure_callback(on_host, shape, image, vmap_method="broadcast_all")


def _forward(image: Array, fixed: _Fixed) -> tuple[Array, Array]:
    return _integrals(image, fixed), image


def _backward(fixed: _Fixed, image: Array, weights: Array) -> tuple[Array]:
    def on_host(image: Any, weights: Any) -> Any:
        spacing, options = fixed
        by_name = Integrals(*np.moveaxis(np.asarray(weights), -1, 0))
        return differentiable.vjp(np.asarray(image), by_name, spacing, **dict(options))

    shape = jax.ShapeDtypeStruct(image.shape, image.dtype)
    return (jax.pure_callback(on_host, shape, image, weights, vmap_method="broadcast_all"),)


_integrals.defvjp(_forward, _backward)
