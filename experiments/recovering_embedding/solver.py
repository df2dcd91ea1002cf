"""phi = 1/2 - K * I - C * (S lambda): corrections lambda at voxels whose centres would lie on the wrong side."""

from dataclasses import dataclass

import numpy as np
from scipy import ndimage as ndi


def taps(sigma, h, cut=5.0):
    radius = max(1, int(np.ceil(cut * sigma / h - 1e-3)))
    bell = np.exp(-((np.arange(-radius, radius + 1) * h) ** 2) / (2 * sigma**2))
    return bell / bell.sum()


ROOT = np.sqrt(2)
A, B = ROOT / (ROOT - 1), -1 / (ROOT - 1)
# Blurs as (weight, width in sigma).
CORRECTED = ((A, 1.0), (B, ROOT))
TWICE = ((A * A, ROOT), (2 * A * B, np.sqrt(3)), (B * B, 2.0))
PLAIN = ((1.0, 1.0),)
WIDE = ((1.0, ROOT),)
FORMULATIONS = {"K": CORRECTED, "K K": TWICE, "G": PLAIN, "G, sqrt 2": WIDE}


@dataclass
class Kernel:
    terms: tuple
    sigma: float
    spacing: tuple

    def __post_init__(self):
        self.axes = [(w, [taps(self.sigma * s, h) for h in self.spacing]) for w, s in self.terms]

    def blur(self, values):
        total = 0.0
        for weight, axes in self.axes:
            part = values.astype(np.float64)
            for axis, k in enumerate(axes):
                part = ndi.correlate1d(part, k, axis=axis, mode="constant")
            total = total + weight * part
        return total

    def between(self, a, b):
        """Values of the kernel for all pairs of voxels of two lists."""
        total = 0.0
        for weight, axes in self.axes:
            part = weight
            for axis, k in enumerate(axes):
                r = len(k) // 2
                d = np.abs(a[:, None, axis] - b[None, :, axis])
                half = np.append(k[r:], 0.0)
                part = part * half[np.minimum(d, r + 1)]
            total = total + part
        return total

    def peak(self):
        return float(self.between(np.zeros((1, 3), int), np.zeros((1, 3), int))[0, 0])


def slope_at_edge(sigma):
    """Of the corrected blur across a flat face, per unit of length."""
    return (A - -B / ROOT) / (np.sqrt(2 * np.pi) * sigma)


def sweep(Q, b, lam, q, cap, sweeps, tolerance):
    """Projected Gauss-Seidel on 1/2 lam Q lam - b lam, 0 <= lam <= cap, in the order of the list."""
    diagonal = np.diag(Q).copy()
    for number in range(sweeps):
        worst = 0.0
        for i in range(len(b)):
            new = min(max(lam[i] - (q[i] - b[i]) / diagonal[i], 0.0), cap[i])
            step = new - lam[i]
            if step != 0.0:
                q += step * Q[i]
                lam[i] = new
                worst = max(worst, abs(step) * diagonal[i])
        if worst < tolerance:
            return number + 1
    return sweeps


@dataclass
class Found:
    phi: np.ndarray
    voxels: np.ndarray
    signs: np.ndarray
    lam: np.ndarray
    cap: np.ndarray
    left: int
    worst: float
    rounds: int
    sweeps: int
    violated: int


def recover(mask, phi0, kernel, near, cap=np.inf, margin=0.0, rounds=12, sweeps=200, tolerance=2e-4, prices=None):
    """Rounds of: solve on the list, evaluate everywhere near, add what is wrong now. `prices` gives each voxel its own cap."""
    sign = np.where(mask, -1.0, 1.0)
    phi = phi0
    margin = np.broadcast_to(margin, mask.shape)
    voxels, lam = np.zeros((0, 3), int), np.zeros(0)
    listed = np.zeros(mask.shape, bool)
    total = done = first = 0
    for done in range(rounds):
        wrong = near & ~listed & (sign * phi < margin - (0 if done == 0 else tolerance))
        new = np.argwhere(wrong)
        if done == 0:
            first = len(new)
        if len(new) == 0 and done > 0:
            break
        listed |= wrong
        voxels, lam = np.concatenate([voxels, new]), np.concatenate([lam, np.zeros(len(new))])
        if len(voxels) == 0:
            break
        at = tuple(voxels.T)
        s = sign[at]
        caps = np.full(len(lam), cap) if prices is None else prices(voxels, s)
        Q = kernel.between(voxels, voxels) * s[:, None] * s[None, :]
        b = margin[at] - s * phi0[at]
        total += sweep(Q, b, lam, Q @ lam, caps, sweeps, tolerance / 4)
        extra = np.zeros(mask.shape)
        extra[at] = s * lam
        phi = phi0 + kernel.blur(extra)
    at = tuple(voxels.T)
    v = sign * phi * near
    left = v < -tolerance
    caps = np.full(len(lam), cap) if prices is None else (prices(voxels, sign[at]) if len(lam) else lam)
    return Found(phi, voxels, sign[at], lam, caps, int(left.sum()), float(max(0.0, -v.min())), done, total, first)
