"""The same integrals in plain PyTorch, as one would write them: dense, differentiated by autograd.

Written from the paper's formulas and independent of the library: the test of its values and gradients, and what its speed
is compared with.
"""

import math

import torch

EDGE = 2  # voxels that a fourth-order difference reaches


def kernel(sigma, spacing, truncation, like):
    radius = max(1, math.ceil(truncation * sigma / spacing - 1e-3))
    x = torch.arange(-radius, radius + 1, dtype=torch.float64) * spacing
    bell = torch.exp(-(x**2) / (2 * sigma**2))
    return (bell / bell.sum()).to(like)


def blur(p, sigma, spacing, truncation=5.0):
    """Of (B, C, z, y, x), 0 beyond the edge, on a box larger by the kernel and the differences.

    As products with banded matrices: of conv3d, conv1d, sums of shifted images and these, the fastest by far on a CPU.
    """
    for axis, h in enumerate(spacing, start=2):
        taps = kernel(sigma, h, truncation, p)
        radius, length = len(taps) // 2, p.shape[axis]
        grown = radius + EDGE
        offsets = (torch.arange(length + 2 * grown)[:, None] - grown - torch.arange(length)).abs()
        matrix = torch.where(offsets <= radius, taps[(radius + offsets).clamp(max=2 * radius)], 0)
        p = torch.tensordot(p, matrix, dims=([axis], [1])).movedim(-1, axis)
    return p


def part(f, axis, offset, length):
    return f.narrow(axis, EDGE + offset, length)


def first(f, axis, h):
    n = f.shape[axis] - 2 * EDGE
    return (part(f, axis, -2, n) - 8 * part(f, axis, -1, n) + 8 * part(f, axis, 1, n) - part(f, axis, 2, n)) / (12 * h)


def second(f, axis, h):
    n = f.shape[axis] - 2 * EDGE
    outer, inner = part(f, axis, -2, n) + part(f, axis, 2, n), part(f, axis, -1, n) + part(f, axis, 1, n)
    return (-outer + 16 * inner - 30 * part(f, axis, 0, n)) / (12 * h**2)


def inner(f, *axes):
    for axis in axes:
        f = f.narrow(axis, EDGE, f.shape[axis] - 2 * EDGE)
    return f


def integrals(p, spacing, sigma, thickness, level=0.5):
    """V, A and the integrals of H, K, H^2, each (B, C)."""
    phi = level - blur(p, sigma, spacing)
    epsilon = 0.5 * math.erf(thickness / (2 * math.sqrt(2) * sigma))
    slopes = [first(phi, axis, h) for axis, h in zip((2, 3, 4), spacing)]
    z, y, x = inner(slopes[0], 3, 4), inner(slopes[1], 2, 4), inner(slopes[2], 2, 3)
    zz, yy, xx = (inner(second(phi, a, h), *({2, 3, 4} - {a})) for a, h in zip((2, 3, 4), spacing))
    yz = inner(first(slopes[0], 3, spacing[1]), 4)
    xz = inner(first(slopes[0], 4, spacing[2]), 3)
    xy = inner(first(slopes[1], 4, spacing[2]), 2)
    phi = inner(phi, 2, 3, 4)
    square = x * x + y * y + z * z
    slope = square.clamp(min=1e-24).sqrt()
    stands = (phi.abs() <= epsilon) & (slope >= 0.05 * 2 * epsilon / thickness)
    inverse = torch.where(stands, 1 / slope, torch.zeros_like(slope))
    h = x * x * (yy + zz) + y * y * (xx + zz) + z * z * (xx + yy) - 2 * (x * y * xy + x * z * xz + y * z * yz)
    k = (
        x * x * (yy * zz - yz * yz) + y * y * (xx * zz - xz * xz) + z * z * (xx * yy - xy * xy)
        + 2 * (x * y * (xz * yz - xy * zz) + y * z * (xy * xz - yz * xx) + x * z * (xy * yz - xz * yy))
    )  # fmt: skip
    mean, gaussian = 0.5 * h * inverse**3, k * inverse**4
    ratio = (phi / epsilon).clamp(-1, 1)
    area = torch.where(stands, (1 + torch.cos(math.pi * ratio)) / (2 * epsilon) * slope, torch.zeros_like(slope))
    inside = 0.5 * (1 - ratio - torch.sin(math.pi * ratio) / math.pi)
    cell = math.prod(spacing)
    return [cell * f.sum(dim=(2, 3, 4)) for f in (inside, area, area * mean, area * gaussian, area * mean**2)]
