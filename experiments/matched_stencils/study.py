"""Differences matched to a Gaussian blur against FD8 and Gaussian derivatives: see README.md."""

import math

import numpy as np
from scipy import ndimage

THICKNESS = 2.5
ORDERS = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (2, 0, 0), (0, 2, 0), (0, 0, 2), (1, 1, 0), (1, 0, 1), (0, 1, 1)]


def matched_stencils(sigma, reach):
    """First and second difference over `reach` voxels a side, fitted where a field blurred by sigma has its energy."""
    omega = np.linspace(1e-4, np.pi, 4000)
    energy = np.exp(-(sigma**2) * omega**2)
    steps = np.arange(1, reach + 1)

    def fit(responses, wanted, constraint):
        """Least squares with one linear constraint, by Lagrange's multiplier."""
        normal = responses.T @ (responses * energy[:, None])
        system = np.block([[normal, constraint[:, None]], [constraint[None, :], np.zeros((1, 1))]])
        right = np.append(responses.T @ (energy * wanted), 1.0)
        return np.linalg.solve(system, right)[:reach]

    # Exact on ramps: sum 2 k a_k = 1; on parabolas: sum k^2 c_k = 1.
    first = fit(2 * np.sin(np.outer(omega, steps)), omega, 2.0 * steps)
    second = fit(2 * (np.cos(np.outer(omega, steps)) - 1), -(omega**2), 1.0 * steps**2)
    return stencils(first, second)


def stencils(first, second):
    """Both halves of an antisymmetric and a symmetric stencil."""
    return (
        np.concatenate([-first[::-1], [0.0], first]),
        np.concatenate([second[::-1], [-2 * second.sum()], second]),
    )


FD8 = stencils(np.array([4 / 5, -1 / 5, 4 / 105, -1 / 280]), np.array([8 / 5, -1 / 5, 8 / 315, -1 / 560]))


def differences(phi, first, second):
    """The nine derivatives, in the order of ORDERS; mixed ones are first differences of first differences."""

    def along(values, stencil, axis):
        return ndimage.correlate1d(values, stencil, axis=axis)

    gradient = [along(phi, first, axis) for axis in range(3)]
    pure = [along(phi, second, axis) for axis in range(3)]
    mixed = [along(gradient[a], first, b) for a, b in ((0, 1), (0, 2), (1, 2))]
    return gradient + pure + mixed


def integrals(phi, derivatives, sigma):
    """A, M and chi over the band."""
    epsilon = 0.5 * math.erf(THICKNESS / (2 * math.sqrt(2) * sigma))
    band = np.abs(phi) <= epsilon
    x, y, z, xx, yy, zz, xy, xz, yz = (values[band] for values in derivatives)
    square = x * x + y * y + z * z
    mean = x * x * (yy + zz) + y * y * (xx + zz) + z * z * (xx + yy) - 2 * (x * y * xy + x * z * xz + y * z * yz)
    gaussian = x * x * (yy * zz - yz * yz) + y * y * (xx * zz - xz * xz) + z * z * (xx * yy - xy * xy)
    gaussian += 2 * (x * y * (xz * yz - xy * zz) + y * z * (xy * xz - yz * xx) + x * z * (xy * yz - xz * yy))
    area = (1 + np.cos(np.pi * phi[band] / epsilon)) / (2 * epsilon) * np.sqrt(square)
    return area.sum(), (area * mean / (2 * square**1.5)).sum(), (area * gaussian / square**2).sum() / (2 * np.pi)


def rotation(degrees):
    """About x, then y, then z."""
    (sx, sy, sz), (cx, cy, cz) = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def mask(name, size=110):
    """A rotated, off-grid ball of 20 voxels or torus of 30 and 10."""
    points = np.stack(np.meshgrid(*[np.arange(size) - (size - 1) / 2] * 3, indexing="ij"), axis=-1)
    points = (points - [0.3, 0.17, 0.43]) @ rotation([20, 30, 40])
    if name == "ball":
        return (np.linalg.norm(points, axis=-1) < 20).astype(float)
    ring = np.hypot(points[..., 0], points[..., 1]) - 30
    return (ring**2 + points[..., 2] ** 2 < 100).astype(float)


def main():
    for name in ("ball", "torus"):
        inside = mask(name)
        for sigma in (1.0, 1.25, 1.5, 2.0, 3.0):
            phi = 0.5 - ndimage.gaussian_filter(inside, sigma, truncate=6)
            exact = [-ndimage.gaussian_filter(inside, sigma, order=order, truncate=6) for order in ORDERS]
            area, total, chi = integrals(phi, exact, sigma)
            single = phi.astype(np.float32).astype(float)
            schemes = {"FD8": FD8} | {f"matched {r}": matched_stencils(sigma, r) for r in (4, 5, 3)}
            for scheme, pair in schemes.items():
                a, m, c = integrals(phi, differences(single, *pair), sigma)
                print(f"{name} sigma {sigma} {scheme}: A {a / area - 1:+.1e}, M {m / total - 1:+.1e}, chi {c - chi:+.4f}")


if __name__ == "__main__":
    main()
