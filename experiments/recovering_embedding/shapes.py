"""Shapes by a function that is negative inside, in units of the geometric mean spacing, with pose, mask, noise and what is true of them."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy import ndimage as ndi
from skimage import measure

length = lambda p: np.sqrt((p * p).sum(-1) + 1e-18)


def segment(p, half):
    q = p.copy()
    q[..., 0] -= np.clip(q[..., 0], -half, half)
    return length(q)


def disc(p, radius):
    """Distance from a flat disc: the plate of thickness 2 r with round edges is where it is below r."""
    s = np.maximum(np.hypot(p[..., 0], p[..., 1]) - radius, 0)
    return np.hypot(s, p[..., 2])


def bumpy(p, R):
    u = p / length(p)[..., None]
    bumps = 2.2 * 5.196 * u[..., 0] * u[..., 1] * u[..., 2] + 2 * (u[..., 2] ** 2 - 1 / 3) + 1.2 * np.sin(5 * u[..., 0]) * np.sin(4 * u[..., 1])
    return length(p) - R * (1 + bumps / 18)


def dimple(p, R):
    angle = R * np.arccos(np.clip(p[..., 2] / length(p), -1, 1))
    return length(p) - (R - 3 * np.exp(-(angle**2) / 32))


def gyroid(p, period, R):
    q = 2 * np.pi * p / period
    s, c = np.sin(q), np.cos(q)
    wave = s[..., 0] * c[..., 1] + s[..., 1] * c[..., 2] + s[..., 2] * c[..., 0]
    return np.maximum((np.abs(wave) - 0.6) * period / (2 * np.pi) / 1.4, length(p) - R)


def directions(count):
    n = np.arange(count) + 0.5
    polar, turn = np.arccos(1 - 2 * n / count), np.pi * (1 + 5**0.5) * n
    return np.stack([np.cos(turn) * np.sin(polar), np.sin(turn) * np.sin(polar), np.cos(polar)], -1)


def rods(p, R, count, radius, from_, to):
    """Distance from rods along radii."""
    nearest = np.full(p.shape[:-1], np.inf)
    for u in directions(count):
        along = np.clip(p @ u, from_, to)
        nearest = np.minimum(nearest, length(p - along[..., None] * u))
    return nearest - radius


def struts(p, period, radius, R):
    """A cubic lattice of rods, cut by a ball."""
    q = np.abs((p + period / 2) % period - period / 2)
    rods = [np.hypot(q[..., a], q[..., b]) for a, b in ((0, 1), (1, 2), (0, 2))]
    return np.maximum(np.minimum.reduce(rods) - radius, length(p) - R)


SHAPES = {
    "ellipsoid 16:11:8": (18, lambda p: length(p / [1.6, 1.1, 0.8]) - 10),
    "ellipsoid 24:16.5:12": (26, lambda p: length(p / [1.6, 1.1, 0.8]) - 15),
    "bumpy ball": (22, lambda p: bumpy(p, 16)),
    "dimple": (23, lambda p: dimple(p, 20)),
    "torus 10.5 / 4.2": (16, lambda p: np.hypot(np.hypot(p[..., 0], p[..., 1]) - 10.5, p[..., 2]) - 4.2),
    **{f"capsule r = {r}": (12 + r, lambda p, r=r: segment(p, 12) - r) for r in (1.5, 2.0, 2.5, 3.0)},
    **{f"plate {t}": (12 + t, lambda p, t=t: disc(p, 12 - t / 2) - t / 2) for t in (3, 4, 6)},
    "spicules": (22, lambda p: np.minimum(length(p) - 13, rods(p, 13, 14, 1.0, 10, 19))),
    "pits": (18, lambda p: np.maximum(length(p) - 16, -rods(p, 16, 14, 1.2, 8, 22))),
    "cube 20": (19, lambda p: np.abs(p).max(-1) - 10),
    "struts r = 2": (16, lambda p: struts(p, 9.0, 2.0, 15.0)),
    "gyroid": (16, lambda p: gyroid(p, 24.0, 14.0)),
}
# Where curvature is not defined at creases it is not compared.
CREASED = {"spicules", "pits", "gyroid", "cube 20", "struts r = 2", *(f"plate {t}" for t in (3, 4, 6))}
THIN = [name for name in SHAPES if name.startswith(("capsule", "plate"))]
SMOOTH = ["ellipsoid 16:11:8", "ellipsoid 24:16.5:12", "bumpy ball", "dimple", "torus 10.5 / 4.2"]
DETAILED = ["spicules", "pits", "gyroid"]
SHARP = ["cube 20", "struts r = 2"]
SPACINGS = {"1:1:1": (1.0, 1.0, 1.0), "1:1:2.5": tuple(np.array([1, 1, 2.5]) / 2.5 ** (1 / 3))}
NOISES = ("clean", "1 % flipped", "5 % flipped", "slices shifted")


@dataclass
class Case:
    name: str
    spacing: tuple
    mask: np.ndarray
    turn: np.ndarray
    centre: np.ndarray

    @property
    def field(self):
        return SHAPES[self.name][1]

    def local(self, points):
        """Coordinates of the shape for fractional voxel indices times the spacing."""
        return (points - self.centre) @ self.turn


def case(name, spacing, seed, margin=9.0):
    rng = np.random.default_rng([seed, *name.encode()])
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    h = np.array(SPACINGS[spacing])
    half = SHAPES[name][0] + margin
    n = np.ceil(2 * half / h).astype(int) + 1
    centre = (n - 1) / 2 * h + rng.uniform(-0.5, 0.5, 3) * h
    grid = np.stack(np.meshgrid(*[np.arange(k) * d for k, d in zip(n, h)], indexing="ij"), -1)
    made = Case(name, tuple(h), None, turn, centre)
    made.mask = made.field(made.local(grid)) < 0
    return made


def beside(mask, connectivity):
    """Voxels with a neighbour (6: connectivity 1, 26: 3) on the other side."""
    around = ndi.generate_binary_structure(3, connectivity)
    return ndi.binary_dilation(mask, around) & ~ndi.binary_erosion(mask, around)


def noisy(mask, kind, seed):
    rng = np.random.default_rng([seed, len(kind)])
    if kind == "clean":
        return mask
    if kind == "slices shifted":
        return np.stack([np.roll(mask[:, :, k], rng.integers(-1, 2, 2), (0, 1)) for k in range(mask.shape[2])], 2)
    share = int(kind.split()[0]) / 100
    return mask ^ (beside(mask, 1) & (rng.random(mask.shape) < share))


def mesh_numbers(vertices, faces):
    """V, A, integral of mean curvature, Euler characteristic of a closed mesh."""
    v = vertices.astype(float)
    t = v[faces]
    cross = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    area = np.linalg.norm(cross, axis=-1)
    volume = (t[:, 0] * np.cross(t[:, 1], t[:, 2])).sum() / 6
    normal = cross / np.maximum(area, 1e-12)[:, None]
    edges = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    owner = np.repeat(np.arange(len(faces)), 3)
    order = np.lexsort(np.sort(edges, 1).T)
    pairs = order.reshape(-1, 2)
    a, b = pairs.T
    along = v[edges[a, 1]] - v[edges[a, 0]]
    size = np.linalg.norm(along, axis=-1)
    n1, n2 = normal[owner[a]], normal[owner[b]]
    sine = (np.cross(n1, n2) * along).sum(-1) / np.maximum(size, 1e-12)
    angle = np.arctan2(sine, (n1 * n2).sum(-1))
    mean = (size * angle).sum() / 2
    chi = len(v) - len(pairs) + len(faces)
    sign = np.sign(volume)
    return abs(volume), area.sum() / 2, sign * mean, chi


@cache
def exact(name):
    """V, A, M, chi of the shape: of meshes of its function at two fine steps, extrapolated."""
    half, field = SHAPES[name][0] + 2, SHAPES[name][1]
    if name in THIN:
        r = float(name.split()[-1]) / (2 if name.startswith("plate") else 1)
        a, m = (0, np.pi * 24) if name.startswith("capsule") else (2 * np.pi * (12 - r) ** 2, np.pi**2 * (12 - r))
        return a * r + m * r**2 + 4 / 3 * np.pi * r**3, a + 2 * m * r + 4 * np.pi * r**2, m + 4 * np.pi * r, 2
    found = []
    for step in (0.5, 0.35):
        n = int(2 * half / step)
        axis = (np.arange(n) - (n - 1) / 2 + 0.13) * step
        values = np.stack([field(np.stack(np.meshgrid([x], axis, axis, indexing="ij"), -1))[0] for x in axis])
        v, f, _, _ = measure.marching_cubes(values.astype(np.float32), 0.0, spacing=(step,) * 3)
        found.append(mesh_numbers(v, f))
    weight = 0.35**2 / (0.5**2 - 0.35**2)
    numbers = [b + weight * (b - a) for a, b in zip(*found)]
    return (*numbers[:3], found[1][3])


def truth(made, points):
    """H, K and distance at the nearest points of the exact surface."""
    local, e = made.local(points), 2e-3
    step = np.eye(3) * e
    F = made.field
    slope = lambda p: np.stack([(F(p + d) - F(p - d)) / (2 * e) for d in step], -1)
    foot = local.copy()
    for _ in range(6):
        g = slope(foot)
        foot = foot - (F(foot) / np.maximum((g * g).sum(-1), 1e-9))[:, None] * g
    second = [[(F(foot + a + b) - F(foot + a - b) - F(foot - a + b) + F(foot - a - b)) / (4 * e * e) for b in step] for a in step]
    H, K = curvatures(slope(foot), np.moveaxis(np.array(second), -1, 0))
    return H, K, np.linalg.norm(foot - local, axis=-1)


def curvatures(g, second):
    n = np.sqrt((g * g).sum(-1))
    trace, bent = np.trace(second, axis1=1, axis2=2), np.einsum("ni,nij,nj->n", g, second, g)
    adjugate = np.stack([np.cross(second[:, 1], second[:, 2]), np.cross(second[:, 2], second[:, 0]), np.cross(second[:, 0], second[:, 1])], 1)
    return (trace - bent / n**2) / (2 * n), np.einsum("ni,nij,nj->n", g, adjugate, g) / n**4


def jet(phi, spacing, points):
    """Gradient and second derivatives by differences of a quintic spline."""
    spline, h = ndi.spline_filter(phi, order=5), np.array(spacing)
    e = 0.3 * min(spacing)
    f = lambda p: ndi.map_coordinates(spline, (p / h).T, order=5, prefilter=False)
    d = np.eye(3) * e
    centre = f(points)
    plus, minus = [f(points + a) for a in d], [f(points - a) for a in d]
    g = np.stack([(p - m) / (2 * e) for p, m in zip(plus, minus)], -1)
    second = np.empty((len(points), 3, 3))
    for i in range(3):
        second[:, i, i] = (plus[i] - 2 * centre + minus[i]) / e**2
        for j in range(i):
            both = f(points + d[i] + d[j]) + f(points - d[i] - d[j]) - f(points + d[i] - d[j]) - f(points - d[i] + d[j])
            second[:, i, j] = second[:, j, i] = both / (4 * e * e)
    return g, second


def surface(made, phi):
    v, f, _, _ = measure.marching_cubes(phi, 0.0, spacing=made.spacing, allow_degenerate=False)
    if len(f) % 2:  # what was left out opened it
        v, f, _, _ = measure.marching_cubes(phi, 0.0, spacing=made.spacing)
    return v.astype(float), f


def errors(made, phi, sample=800):
    """Signed % errors of V, A, M; chi less the true one; rms of H in % of k_rms, K of k_rms^2, and of the place."""
    if not np.isfinite(phi).all() or not (phi < 0).any():
        return None
    v, f = surface(made, phi)
    got, want = mesh_numbers(v, f), exact(made.name)
    out = {k: 100 * (a / b - 1) for k, a, b in zip("VAM", got, want)}
    out["chi"] = got[3] - want[3]
    pick = np.random.default_rng(0).permutation(len(v))[:sample]
    points = v[pick]
    H0, K0, place = truth(made, points)
    out["place"] = np.sqrt(np.mean(np.minimum(place, 3.0) ** 2))
    if made.name not in CREASED:
        H, K = curvatures(*jet(phi, made.spacing, points))
        ok = np.isfinite(H0) & np.isfinite(H)
        k = np.sqrt(np.mean((np.abs(H0) + np.sqrt(np.maximum(H0**2 - K0, 0)))[ok] ** 2))
        out["H"] = 100 * np.sqrt(np.mean((H - H0)[ok] ** 2)) / k
        out["K"] = 100 * np.sqrt(np.mean((K - K0)[ok] ** 2)) / k**2
    return out
