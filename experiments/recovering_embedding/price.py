"""What a correction may cost, voxel by voxel, from what the violations around it look like."""

from dataclasses import dataclass

import numpy as np
from scipy import ndimage as ndi

from solver import CORRECTED, Kernel, slope_at_edge


@dataclass
class Rule:
    """Depths and prices are displacements of the surface in geometric mean spacings: lambda = price * slope / K(0)."""

    small: float = 0.5  # windows of the neighbours that speak for a voxel, in sigma; at least 1.5 voxels along every axis
    large: float = 1.0
    coherent: float = 0.6  # supported: S >= this times T in the small window, or
    coherent_large: float = 0.8  # this times T in the large one,
    support: float = 3.0  # and S >= this times its own depth
    shallow: float = 0.15  # alone: deeper than this,
    against: float = 0.2  # S < this times T
    company: float = 1.5  # or S < this times its own depth, both in the small window,
    seen: float = 0.1  # and deeper than this, in voxels, in a corrected blur of one voxel along each axis (the fine one)
    noise: float = 0.02  # noisy: rms depth of those alone over all voxels beside the boundary is above this,
    fine_noise: float = 0.01  # and that of all violations of the fine blur, in voxels, above this; each of the side of the boundary that has less, both taken to be like it
    kappa: float = 2.0  # support in a noisy object: S over the window's voxels beside the boundary above this times the noise
    price: float = 1.0
    alone: float = 0.4  # price of those alone where the object is not noisy


def window(kernel, size):
    """Sums over the others within a Gaussian window whose weight is 1 at no distance."""
    width = np.maximum(size * kernel.sigma / np.array(kernel.spacing), 1.5)
    blur = lambda v: ndi.gaussian_filter(v.astype(float), width, truncate=3, mode="constant")
    centre = blur(np.pad([[[1.0]]], [(int(3 * w + 1),) * 2 for w in width])).max()
    return lambda v: blur(v) / centre - v


def priced(mask, near, phi0, kernel, rule=Rule()):
    """A cap of lambda for every voxel, and the noise: S is the depth of the neighbours that want the surface moved the same way less that of those that
    want the opposite, T the sum of both."""
    sign = np.where(mask, -1.0, 1.0)
    depth = np.maximum(0, -sign * phi0) * near / slope_at_edge(kernel.sigma)
    violated, supported = depth > 0, np.zeros(mask.shape, bool)
    mean = np.zeros(mask.shape)
    for size, coherent in ((rule.small, rule.coherent), (rule.large, rule.coherent_large)):
        others = window(kernel, size)
        total, agree = others(depth), sign * others(sign * depth)
        if size == rule.small:
            against = (agree < rule.against * total) | (agree < rule.company * depth)
        here = violated & (agree >= coherent * total) & (agree >= rule.support * depth)
        mean = np.maximum(mean, np.where(here, agree / np.maximum(others(near), 1e-9), 0))
        supported |= here
    fine = np.maximum(0, -sign * (0.5 - Kernel(CORRECTED, 1.0, (1.0, 1.0, 1.0)).blur(mask))) * near / slope_at_edge(1.0)
    alone = violated & ~supported & against & (depth > rule.shallow) & (fine > rule.seen)
    lesser = lambda square: np.sqrt(2 * min(square[mask].sum(), square[~mask].sum()) / max(1, near.sum()))
    noise, fine_noise = lesser(alone * depth**2), lesser(fine**2)
    if noise < rule.noise or fine_noise < rule.fine_noise:
        price = np.where(alone, rule.alone, rule.price)
    else:
        price = np.where(supported & (mean >= rule.kappa * noise), rule.price, 0.0)
    return price * slope_at_edge(kernel.sigma) / kernel.peak(), noise
