"""The paper's method written again in NumPy and SciPy, formulas from the text with docs/decisions.md's errata, against ours."""

import nibabel as nib
import numpy as np
import pytest
from conftest import curvatures, gaussian_derivatives, lumpy, measure
from scipy import ndimage, special

SPACING = (0.8, 1.0, 1.3)


def differences(phi, spacing):
    """Fourth-order central differences: gradient and Hessian (Besler et al., appendix)."""
    first = np.array([1, -8, 0, 8, -1]) / 12.0
    second = np.array([-1, 16, -30, 16, -1]) / 12.0

    def along(field, weights, axis, order):
        return ndimage.correlate1d(field, weights, axis=axis) / spacing[axis] ** order

    gradient = [along(phi, first, axis, 1) for axis in range(3)]
    hessian = [[None] * 3 for _ in range(3)]
    for a in range(3):
        for b in range(3):
            hessian[a][b] = along(phi, second, a, 2) if a == b else along(gradient[a], first, b, 1)
    return np.array(gradient), np.array(hessian)


def paper(mask, sigma, thickness, derivatives):
    """V, A, M and chi by the plain sum."""
    phi = 0.5 - ndimage.gaussian_filter(mask, [sigma / h for h in SPACING], truncate=5.0, mode="constant")
    epsilon = 0.5 * special.erf(thickness / (2 * np.sqrt(2) * sigma))
    gradient, hessian = (
        differences(phi, SPACING) if derivatives == "finite-difference" else gaussian_derivatives(mask, sigma, SPACING)
    )
    inside = -phi
    heaviside = np.where(
        np.abs(inside) <= epsilon,
        0.5 * (1 + inside / epsilon + np.sin(np.pi * inside / epsilon) / np.pi),
        inside > 0,
    )
    band = np.abs(phi) <= epsilon
    delta = (1 + np.cos(np.pi * phi[band] / epsilon)) / (2 * epsilon)
    mean, gaussian, norm = curvatures(gradient[:, band], hessian[:, :, band])
    cell = np.prod(SPACING)
    # Where the gradient has collapsed there is no surface (docs/quantities.md).
    area = delta * norm * cell * (norm >= 0.05 * 2 * epsilon / thickness)
    return {
        "volume_mm3": heaviside.sum() * cell,
        "surface_area_mm2": area.sum(),
        "total_mean_curvature_mm": (area * mean).sum(),
        "euler_characteristic": (area * gaussian).sum() / (2 * np.pi),
        "total_squared_mean_curvature": (area * mean**2).sum(),
    }


@pytest.mark.parametrize("derivatives", ["finite-difference", "gaussian"])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_scipy_finds_the_same(tmp_path, derivatives, seed):
    mask = np.pad(lumpy((40, 44, 36), seed), 14)
    path = tmp_path / "mask.nii.gz"
    nib.save(nib.Nifti1Image(mask, np.diag([*SPACING, 1.0])), path)
    options = ["--sigma", "2.5", "--thickness", "3.25", "--derivatives", derivatives]
    record = measure(path, *options)[0]
    expected = paper(mask.astype(np.float64), 2.5, 3.25, derivatives)
    # Kernels end at 5 sigma in both; ours are normalised to reproduce polynomials, SciPy's are not, and fields are f32.
    for key, value in expected.items():
        scale = max(abs(value), 1.0)
        found = record["blurred"][key]
        assert abs(found - value) < 5e-4 * scale, (key, found, value)
