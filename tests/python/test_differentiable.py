"""Integrals and their derivatives on arrays: against `measure`, central differences and closed forms."""

import doctest

import numpy as np
import pytest
from conftest import SPACING, turned_field

import surfometry
from surfometry import differentiable

NAMES = differentiable.Integrals._fields


def soft_body():
    """Probabilities of the turned body, clear of 0 and 1 so that steps stay between them."""
    return 0.01 + 0.98 / (1 + np.exp(turned_field() / 0.5))


KINDS = {
    "given": (turned_field, {"embedding": "given", "epsilon": 0.9}),
    "probability": (soft_body, {"embedding": "probability", "sigma": 2.3}),
}


@pytest.fixture(params=KINDS)
def kind(request):
    """An image and its options."""
    make, options = KINDS[request.param]
    return make(), options


def test_numbers_are_those_of_measure(kind):
    image, options = kind
    blurred = surfometry.measure(image, SPACING, **options).blurred
    found = differentiable.integrals(image, SPACING, **options)
    for name in NAMES:
        assert getattr(found, name) == pytest.approx(getattr(blurred, name), rel=2e-5), name


def test_derivatives_are_those_of_the_numbers(kind):
    image, options = kind
    direction = np.random.default_rng(5).uniform(-1, 1, image.shape)
    step = 1e-4

    def along(length):
        return np.stack(differentiable.integrals(image + length * direction, SPACING, **options))

    slopes = (along(-2 * step) - 8 * along(-step) + 8 * along(step) - along(2 * step)) / (12 * step)
    for name, slope in zip(NAMES, slopes):
        gradient = differentiable.vjp(image, {name: 1}, SPACING, **options)
        scale = np.linalg.norm(gradient * direction)
        assert abs((gradient * direction).sum() - slope) < 1e-6 * scale, name


def test_a_ball_is_a_ball():
    z, y, x = np.meshgrid(*[(np.arange(n) - n / 2 + 0.3) * h for n, h in zip((24, 30, 34), SPACING)], indexing="ij")
    phi = np.sqrt(z**2 + y**2 + x**2) - 9
    found = differentiable.integrals(phi, SPACING, embedding="given")
    exact = (4 / 3 * np.pi * 729, 4 * np.pi * 81, 4 * np.pi * 9, 4 * np.pi, 4 * np.pi)
    for name, value, truth in zip(NAMES, found, exact):
        # The band averages over parallel surfaces: t² / 30 of V's and A's second derivatives.
        assert value == pytest.approx(truth, rel=0.02), name
    value, gradient = differentiable.value_and_grad(phi, {"surface_area": 1, "volume": 2}, SPACING, embedding="given")
    assert value == pytest.approx(found.surface_area + 2 * found.volume, rel=1e-14)
    # Raised by a constant, R falls: -(8 pi R + 2 A).
    assert gradient.sum() == pytest.approx(-8 * np.pi * 9 - 2 * 4 * np.pi * 81, rel=0.02)


def test_each_image_of_a_batch_is_its_own(kind):
    image, options = kind
    other = image[::-1] + 0.01
    batch = np.stack([[image, other, image], [other, image, other]])
    spacings = np.array([SPACING, SPACING[::-1]])[:, None]
    weights = {"surface_area": np.arange(6.0).reshape(2, 3), "total_squared_mean_curvature": -1.0}
    found = differentiable.integrals(batch, spacings, **options)
    gradient = differentiable.vjp(batch, weights, spacings, **options)
    assert found.volume.shape == (2, 3) and gradient.shape == batch.shape
    for b, c in np.ndindex(2, 3):
        spacing = tuple(spacings[b, 0])
        own = {"surface_area": weights["surface_area"][b, c], "total_squared_mean_curvature": -1.0}
        alone = differentiable.integrals(batch[b, c], spacing, **options)
        assert [numbers[b, c] for numbers in found] == list(alone)
        assert np.array_equal(gradient[b, c], differentiable.vjp(batch[b, c], own, spacing, **options))


def test_how_an_array_lies_in_memory_changes_no_bit(kind):
    image, options = kind
    image = image.astype(np.float32)
    expected = differentiable.vjp(image, {"total_gaussian_curvature": 1}, SPACING, **options)
    assert expected.dtype == np.float32
    spread = np.empty((*image.shape[:2], 2 * image.shape[2]), np.float32)
    spread[..., ::2] = image
    for same in (np.asfortranarray(image), spread[..., ::2], image[::-1][::-1], image.astype(">f4")):
        for threads in (1, 2):
            found = differentiable.vjp(same, {"total_gaussian_curvature": 1}, SPACING, threads=threads, **options)
            assert np.array_equal(found, expected)
    turned = differentiable.vjp(image.T, {"total_gaussian_curvature": 1}, SPACING[::-1], **options)
    assert np.allclose(turned.T, expected, rtol=1e-4, atol=1e-5 * np.abs(expected).max())


def test_what_makes_no_sense_is_refused():
    image = soft_body()

    def refused(kind, words, *arguments, **options):
        options = {"embedding": "probability", **options}
        with pytest.raises(kind, match=words):
            differentiable.integrals(*arguments, **options)

    refused(surfometry.ParameterError, "given", image, SPACING, embedding="gaussian")
    refused(surfometry.ParameterError, "spacing", image, (1, 2))
    refused(surfometry.ParameterError, "larger sigma", image, SPACING, sigma=1.0)
    refused(surfometry.ParameterError, "leave derivatives out", image, SPACING, derivatives="gaussian")
    refused(surfometry.InputError, "values from 0 to 1", 8 * image, SPACING)
    refused(surfometry.InputError, "last three axes", image[0], SPACING)
    refused(surfometry.InputError, "positive", image, (1, 0, 1))
    refused(surfometry.InputError, "NaN", np.where(image > 0.5, np.nan, 1), SPACING, embedding="given")
    refused(surfometry.UnsupportedTypeError, "type", np.array(["a"]), SPACING)
    with pytest.raises(surfometry.ParameterError, match="area"):
        differentiable.vjp(image, {"area": 1}, SPACING, embedding="probability")
    with pytest.raises(surfometry.ParameterError, match="shape"):
        differentiable.vjp(image, {"volume": [1, 2]}, SPACING, embedding="probability")


def test_nothing_is_no_error():
    image = np.zeros((0, 2, 8, 9, 10))
    found = differentiable.integrals(image, SPACING, embedding="given")
    assert found.volume.shape == (0, 2)
    assert differentiable.vjp(image, {"volume": 1}, SPACING, embedding="given").shape == image.shape


def test_the_example_of_the_module():
    assert doctest.testmod(differentiable) == (0, 8)
