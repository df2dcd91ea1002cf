"""A noisy segmentation pulled to a known area and to smoothness, while its Euler characteristic is watched.

    target/oracles/bin/python experiments/differentiable/study.py [--steps 200] [--figure PATH.png]

NumPy, SciPy, Matplotlib and the package; no framework. Logits are changed by Adam so that the segmentation stays near what the
noisy one says, its area comes to the truth's and its bending energy falls.
"""

import argparse
import warnings

import numpy as np
from matplotlib import pyplot
from scipy.ndimage import gaussian_filter

import surfometry
from surfometry import differentiable

SPACING = (1.4, 0.8, 0.9)
OPTIONS = {"spacing": SPACING, "embedding": "probability", "sigma": 2.45}


def truth():
    """A turned torus as probabilities: one handle, Euler characteristic 0."""
    z, y, x = np.meshgrid(*[(np.arange(n) - n / 2 + 0.3) * h for n, h in zip((30, 56, 56), SPACING)], indexing="ij")
    u, w = 0.96 * x + 0.28 * z, -0.28 * x + 0.96 * z
    return 1 / (1 + np.exp((np.hypot(np.hypot(u, y) - 13, w) - 5) / 0.4))


def smooth(noise, passes):
    """A running mean of three along each axis, scaled to a standard deviation of 1."""
    for _ in range(passes):
        for axis in range(3):
            noise = (np.roll(noise, 1, axis) + noise + np.roll(noise, -1, axis)) / 3
    return noise / noise.std()


def noisy_logits(p, noise=2.8, seed=3):
    """Logits of the probabilities, capped as a network's are, with noise of a few voxels' extent."""
    rng = np.random.default_rng(seed)
    return np.log(p.clip(0.05, 0.95) / (1 - p.clip(0.05, 0.95))) + noise * smooth(rng.normal(size=p.shape), 3)


class Adam:
    """Kingma and Ba 2015."""

    def __init__(self, rate):
        self.rate, self.count, self.mean, self.square = rate, 0, 0.0, 0.0

    def step(self, gradient):
        self.count += 1
        self.mean = 0.9 * self.mean + 0.1 * gradient
        self.square = 0.999 * self.square + 0.001 * gradient**2
        mean, square = self.mean / (1 - 0.9**self.count), self.square / (1 - 0.999**self.count)
        return -self.rate * mean / (np.sqrt(square) + 1e-8)


def refined(start, area, steps, bend=0.3, stay=30.0):
    """Logits after each step's numbers: V, A, and the integrals of H, K, H^2."""
    logits, adam, history = start.copy(), Adam(0.05), []
    before = 1 / (1 + np.exp(-start))
    for _ in range(steps + 1):
        p = 1 / (1 + np.exp(-logits))
        found = differentiable.integrals(p, **OPTIONS)
        history.append([float(number) for number in found])
        weights = {
            "surface_area": 100 * (found.surface_area / area - 1) / area,
            "total_squared_mean_curvature": bend / (4 * np.pi),
        }
        by_p = differentiable.vjp(p, weights, **OPTIONS) + 2 * stay * (p - before) / p.size
        logits = logits + adam.step(by_p * p * (1 - p))
    return p, np.array(history)


def chi_of_mesh(p):
    """Euler characteristic of the same surface, phi = 0, as a mesh: exact."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", surfometry.SurfometryWarning)
        return surfometry.measure(p, **OPTIONS).topology.euler_characteristic_mesh


def inside(p):
    """Voxels where phi is negative."""
    return gaussian_filter(p, np.array(OPTIONS["sigma"]) / SPACING, mode="constant") > 0.5


def dice(p, q):
    """Of the solids within phi = 0."""
    return 2 * (inside(p) & inside(q)).sum() / (inside(p).sum() + inside(q).sum())


def figure(path, exact, noisy, refined_p, history, area):
    panels = pyplot.figure(figsize=(11, 6), layout="constrained").subplots(2, 3)
    for panel, (title, p) in zip(panels[0], {"truth": exact, "noisy": noisy, "refined": refined_p}.items()):
        panel.imshow(p[15], cmap="gray", vmin=0, vmax=1, aspect=SPACING[1] / SPACING[2])
        panel.contour(gaussian_filter(p, np.array(OPTIONS["sigma"]) / SPACING, mode="constant")[15], [0.5], colors="tab:red", linewidths=1)
        panel.set(title=title, xticks=[], yticks=[])
    curves = {
        "area, mm²": (history[:, 1], area),
        "bending energy / 4π": (history[:, 4] / (4 * np.pi), None),
        "Euler characteristic, Gauss-Bonnet": (history[:, 3] / (2 * np.pi), 0),
    }
    for panel, (title, (curve, wanted)) in zip(panels[1], curves.items()):
        panel.plot(curve)
        if wanted is not None:
            panel.axhline(wanted, color="gray", linewidth=0.8)
        panel.set(title=title, xlabel="step")
    panels[0, 0].figure.savefig(path, dpi=90)


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--steps", type=int, default=200)
    arguments.add_argument("--figure")
    given = arguments.parse_args()
    exact = truth()
    start = noisy_logits(exact)
    area = float(differentiable.integrals(exact, **OPTIONS).surface_area)
    noisy = 1 / (1 + np.exp(-start))
    p, history = refined(start, area, given.steps)
    print(f"target area {area:.1f} mm²")
    for name, image, numbers in (("noisy", noisy, history[0]), ("refined", p, history[-1])):
        chi = numbers[3] / (2 * np.pi)
        print(
            f"{name:8} A {numbers[1]:7.1f} mm² ({100 * (numbers[1] / area - 1):+.2f} %), bending {numbers[4] / (4 * np.pi):6.2f}, "
            f"chi of the band {chi:6.2f}, of the mesh {chi_of_mesh(image)}, Dice with the truth {dice(image, exact):.3f}"
        )
    if given.figure:
        figure(given.figure, exact, noisy, p, history, area)


if __name__ == "__main__":
    main()
