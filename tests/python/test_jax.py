"""The JAX function: against NumPy's, under jit, grad and vmap."""

import numpy as np
import pytest
from conftest import SPACING
from test_differentiable import KINDS

from surfometry import differentiable

jax = pytest.importorskip("jax")
jax.config.update("jax_enable_x64", True)

import surfometry.jax  # noqa: E402

WEIGHTS = np.array([1e-3, 1e-2, 0.1, 1.0, 1.0])


@pytest.mark.parametrize("name", KINDS)
def test_is_what_numpy_has(name):
    make, options = KINDS[name]
    image = np.stack([make(), make()[::-1] + 0.005])

    def loss(image):
        return (jax.numpy.stack(surfometry.jax.integrals(image, SPACING, **options), axis=-1) @ WEIGHTS).sum()

    expected = np.stack(differentiable.integrals(image, SPACING, **options), axis=-1)
    gradient = differentiable.vjp(image, dict(zip(differentiable.Integrals._fields, WEIGHTS)), SPACING, **options)
    for run in (lambda f: f, jax.jit):
        value, found = run(jax.value_and_grad(loss))(image)
        assert value == pytest.approx((expected @ WEIGHTS).sum(), rel=1e-14)
        assert np.array_equal(found, gradient)
    mapped = jax.vmap(jax.grad(loss))(image)
    assert np.array_equal(mapped, gradient)
    single = jax.grad(loss)(image.astype(np.float32))
    assert single.dtype == np.float32 and np.allclose(single, gradient, rtol=1e-3, atol=1e-4 * np.abs(gradient).max())
