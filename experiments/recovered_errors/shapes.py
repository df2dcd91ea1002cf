"""Shapes by a function that is negative inside, in voxels; masks in random poses; what is true of them.

Truth comes from two meshes of the function, their vertices moved onto it, extrapolated to step 0.
"""

from dataclasses import dataclass

import nibabel
import numpy as np
import trimesh
from scipy import ndimage as ndi
from scipy.spatial.transform import Rotation
from skimage.measure import marching_cubes

CHUNK = 200_000
# Step of the coarse lattice on which the boundary is looked for.
COARSE = 0.5
CUBE = np.ones((3, 3, 3))


class Shape:
    """A function that is negative inside, within a box of two corners; steps are of its differences."""

    gradient_step = 1e-3
    curvature_step = 0.02

    def value(self, points):
        raise NotImplementedError

    def values(self, points):
        """The function at many points, in parts that fit into memory."""
        return np.concatenate([self.value(points[i : i + CHUNK]) for i in range(0, len(points), CHUNK)])

    def gradient(self, points):
        step = self.gradient_step
        differences = [self.value(points + d) - self.value(points - d) for d in step * np.eye(3)]
        return np.stack(differences, 1) / (2 * step)

    def mean_curvature(self, points):
        """H, positive where the shape is convex, by central differences."""
        step = self.curvature_step
        moves = step * np.eye(3)
        centre = self.value(points)
        gradient = np.empty((3, len(points)))
        bent = np.zeros(len(points))
        trace = np.zeros(len(points))
        for axis, move in enumerate(moves):
            after, before = self.value(points + move), self.value(points - move)
            gradient[axis] = (after - before) / (2 * step)
            second = (after - 2 * centre + before) / step**2
            trace += second
            bent += gradient[axis] ** 2 * second
        for a, b in ((0, 1), (0, 2), (1, 2)):
            along, across = moves[a] + moves[b], moves[a] - moves[b]
            same = self.value(points + along) + self.value(points - along)
            opposite = self.value(points + across) + self.value(points - across)
            bent += 2 * gradient[a] * gradient[b] * (same - opposite) / (4 * step**2)
        squared = (gradient**2).sum(0)
        return (trace - bent / squared) / (2 * np.sqrt(squared))


class Superellipsoid(Shape):
    """|x / a|^n + |y / b|^n + |z / c|^n < 1: an ellipsoid at n = 2, a box with rounded edges at 10."""

    def __init__(self, radii, exponent):
        self.radii = np.array(radii)
        self.exponent = exponent
        self.box = (-self.radii, self.radii)

    def value(self, points):
        powers = (np.abs(points / self.radii) ** self.exponent).sum(1)
        return ((powers + 1e-300) ** (1 / self.exponent) - 1) * self.radii.min()


class Ball(Shape):
    def __init__(self, centre, radius):
        self.centre = np.array(centre)
        self.radius = radius
        self.box = (self.centre - radius, self.centre + radius)

    def value(self, points):
        return np.linalg.norm(points - self.centre, axis=1) - self.radius


class Torus(Shape):
    def __init__(self, major, minor):
        self.major, self.minor = major, minor
        corner = np.array([major + minor, major + minor, minor])
        self.box = (-corner, corner)

    def value(self, points):
        from_axis = np.hypot(points[:, 0], points[:, 1])
        return np.hypot(from_axis - self.major, points[:, 2]) - self.minor


class Cup(Shape):
    """The part below z = `rim` of a spherical wall, `half` thick to both sides, with a rounded rim."""

    ROUNDING = 0.35

    def __init__(self, radius, half, rim):
        self.radius, self.half, self.rim = radius, half, rim
        self.box = (np.full(3, -radius - half), np.full(3, radius + half))

    def value(self, points):
        wall = np.abs(np.linalg.norm(points, axis=1) - self.radius) - self.half
        return -soft_minimum([-wall, self.rim - points[:, 2]], self.ROUNDING)


class Tube(Shape):
    """Round a Bézier curve of four points; its radius goes from the first to the second, plus a belly."""

    PART = 50_000

    def __init__(self, control, radii, samples=60):
        self.control, self.radii = control, radii
        self.parameters = np.linspace(0, 1, samples)
        self.curve = self.place(self.parameters)
        self.thickness = self.radius(self.parameters)
        largest = self.thickness.max()
        self.box = (self.curve.min(0) - largest, self.curve.max(0) + largest)

    def place(self, t):
        t = t[:, None]
        a, b, c, d = self.control
        return (1 - t) ** 3 * a + 3 * t * (1 - t) ** 2 * b + 3 * t * t * (1 - t) * c + t**3 * d

    def radius(self, t):
        first, last, belly = self.radii
        return first + (last - first) * t + belly * np.sin(np.pi * t) ** 2

    def value(self, points):
        parts = [self.nearest(points[i : i + self.PART]) for i in range(0, len(points), self.PART)]
        return np.concatenate(parts)

    def nearest(self, points):
        """The least over the curve of distance less radius: the best sample, refined twice by a parabola."""

        def beyond(t):
            return np.sqrt(((points - self.place(t)) ** 2).sum(1) + 1e-20) - self.radius(t)

        squared = ((points[:, None] - self.curve[None]) ** 2).sum(2)
        t = self.parameters[(np.sqrt(np.maximum(squared, 1e-20)) - self.thickness).argmin(1)]
        step = 1 / (len(self.parameters) - 1)
        for _ in range(2):
            middle = np.clip(t, 1e-9, 1 - 1e-9)
            before, here, after = beyond(middle - step), beyond(middle), beyond(middle + step)
            bend = before - 2 * here + after
            curved = bend > 1e-14
            move = np.where(curved, 0.5 * step * (before - after) / np.where(curved, bend, 1), 0)
            t = np.clip(middle + np.clip(move, -step, step), 0, 1)
            step *= 0.2
        return beyond(t)


def soft_minimum(values, width):
    """The least of several functions, rounded where two are within `width` of each other."""
    values = np.stack(values)
    least = values.min(0)
    return least - width * np.log(np.exp(-(values - least) / width).sum(0))


class Union(Shape):
    """Parts put together with rounded creases."""

    def __init__(self, parts, width):
        self.parts, self.width = parts, width
        low = np.min([part.box[0] for part in parts], 0) - 2 * width
        high = np.max([part.box[1] for part in parts], 0) + 2 * width
        self.box = (low, high)

    def value(self, points):
        return soft_minimum([part.value(points) for part in self.parts], self.width)


class Spline(Shape):
    """The cubic spline through a field's values on a lattice, `spacing` in voxels of the mask to come."""

    gradient_step = 0.02
    curvature_step = 0.2

    def __init__(self, field, spacing):
        self.spacing = np.broadcast_to(np.asarray(spacing, float), 3)
        self.coefficients = ndi.spline_filter(field.astype(float), 3)
        inside = np.argwhere(field < 0)
        low, high = inside.min(0) * self.spacing, inside.max(0) * self.spacing
        self.box = (low - self.spacing, high + self.spacing)
        slope = np.sqrt(sum(g * g for g in np.gradient(field, *self.spacing)))
        self.scale = 1 / np.median(slope[np.abs(field) < 0.15])

    def value(self, points):
        at = (points / self.spacing).T
        how = {"order": 3, "mode": "nearest", "prefilter": False}
        return self.scale * ndi.map_coordinates(self.coefficients, at, **how)


def largest_part(mask):
    """The largest of the parts that hang together by faces, edges or corners."""
    labels, count = ndi.label(mask, CUBE)
    if count < 2:
        return mask
    return labels == 1 + np.argmax(ndi.sum(mask, labels, range(1, count + 1)))


def without_islands(field):
    """A field of which only the largest part is inside."""
    near = ndi.binary_dilation(largest_part(field < 0), CUBE, 2)
    return np.where(near, field, np.maximum(field, 0.05))


def smoothed_label(path, label, smoothing, voxel):
    """A label of a file, blurred by `smoothing` mm, as a shape for masks with voxels of `voxel` mm."""
    image = nibabel.load(path)
    spacing = np.array(image.header.get_zooms()[:3], float)
    mask = np.asarray(image.dataobj) == label
    inside = np.argwhere(mask)
    low, high = inside.min(0) - 8, inside.max(0) + 9
    padding = [(max(0, -a), max(0, b - n)) for a, b, n in zip(low, high, mask.shape)]
    cut = tuple(slice(a + before, b + before) for a, b, (before, _) in zip(low, high, padding))
    mask = largest_part(np.pad(mask, padding)[cut]).astype(float)
    blurred = ndi.gaussian_filter(mask, smoothing / spacing, truncate=5)
    return Spline(without_islands(0.5 - blurred), spacing / voxel)


def random_field(rng, correlation, radius):
    """A lump of a Gaussian random field, its detail `correlation` and its radius about `radius` voxels."""
    size = int(4 * radius) + 24
    noise = ndi.gaussian_filter(rng.standard_normal((size,) * 3), 2 * correlation, truncate=5)
    noise /= noise.std()
    axis = (np.arange(size) - size / 2) * 0.5
    scaled = [axis / (radius * rng.uniform(0.5, 1.0)) for _ in range(3)]
    from_centre = sum(x * x for x in np.meshgrid(*scaled, indexing="ij", sparse=True))
    field = np.clip(0.6 * noise + 1.2 * (from_centre - 1), -3, 3) * 0.3
    return Spline(without_islands(field), 0.5)


def random_tube(rng, radius, length):
    """Points and radii for a `Tube`."""
    control = np.zeros((4, 3))
    direction = rng.standard_normal(3)
    direction /= np.linalg.norm(direction)
    for i in range(1, 4):
        direction = direction + 0.7 * rng.standard_normal(3)
        direction /= np.linalg.norm(direction)
        control[i] = control[i - 1] + direction * length / 3
    first = radius * rng.uniform(0.85, 1.15)
    last = radius * rng.uniform(0.85, 1.15)
    return control, (first, last, radius * rng.uniform(-0.1, 0.15))


def mesh(shape, step):
    """Vertices and triangles of the surface: a lattice of `step`, filled in near the boundary only."""
    low, high = np.floor(shape.box[0]) - 2, np.ceil(shape.box[1]) + 2
    count = ((high - low) / COARSE).astype(int) + 1
    axes = [a + COARSE * np.arange(n) for a, n in zip(low, count)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
    inside = shape.values(points).reshape(count) < 0
    band = ndi.binary_dilation(inside, CUBE, 2) & ~ndi.binary_erosion(inside, CUBE, 2)
    fine = np.ones((int(round(COARSE / step)),) * 3, np.float32)
    sign = np.where(inside, -1.0, 1.0)[:-1, :-1, :-1]
    field = np.kron(sign, fine).astype(np.float32)
    near = np.kron(band[:-1, :-1, :-1], fine.astype(bool))
    field[near] = shape.values(low + np.argwhere(near) * step)
    vertices, triangles, _, _ = marching_cubes(field, 0.0, allow_degenerate=False)
    return onto_surface(shape, vertices * step + low, step), triangles


def onto_surface(shape, vertices, step):
    """Two Newton steps of at most half a step of the lattice."""
    for _ in range(2):
        gradient = shape.gradient(vertices)
        squared = np.maximum((gradient**2).sum(1), 1e-12)
        move = -(shape.value(vertices) / squared)[:, None] * gradient
        length = np.maximum(np.linalg.norm(move, axis=1), 1e-12)
        vertices = vertices + move * np.minimum(1, 0.5 * step / length)[:, None]
    return vertices


def integrals(shape, step):
    """V, A, M (of the angles at edges) and the integral of |H|; and chi."""
    vertices, triangles = mesh(shape, step)
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    signed = (a * np.cross(b, c)).sum() / 6
    of_vertex = np.bincount(triangles.ravel(), np.repeat(areas / 3, 3), len(vertices))
    absolute = (of_vertex * np.abs(shape.mean_curvature(vertices))).sum()
    surface = trimesh.Trimesh(vertices, triangles, process=False)
    edges = vertices[surface.face_adjacency_edges]
    lengths = np.linalg.norm(edges[:, 0] - edges[:, 1], axis=1)
    signs = np.where(surface.face_adjacency_convex, 1, -1) * np.sign(signed)
    mean = 0.5 * (lengths * surface.face_adjacency_angles * signs).sum()
    return np.array([abs(signed), areas.sum(), mean, absolute]), surface.euler_number


@dataclass
class Truth:
    """What is true of a shape; `unsure` is by what shares of V and A the extrapolation moved them."""

    V: float
    A: float
    M: float
    absolute_M: float
    chi: int
    unsure: tuple


def truth(shape, step):
    """Of meshes of `step` and half of it."""
    coarse, _ = integrals(shape, step)
    fine, chi = integrals(shape, step / 2)
    best = (4 * fine - coarse) / 3
    unsure = np.abs(best - fine) / np.abs(best)
    return Truth(*map(float, best), int(chi), tuple(map(float, unsure[:2])))


def turned(rng, tilt):
    """A rotation, about any axis by up to `tilt` degrees."""
    axis = rng.standard_normal(3)
    angle = np.radians(rng.uniform(0, tilt))
    return Rotation.from_rotvec(angle * axis / np.linalg.norm(axis)).as_matrix()


def posed(shape, rng, jitter=0.0, tilt=None):
    """The mask in a random pose, turned by up to `tilt` degrees or, if None, any way; with `jitter`, its
    slices shifted in plane by up to that many voxels."""
    if tilt is None:
        rotation = Rotation.random(random_state=int(rng.integers(1 << 31))).as_matrix()
    else:
        rotation = turned(rng, tilt)
    corners = np.stack(np.meshgrid(*zip(*shape.box), indexing="ij"), -1).reshape(-1, 3) @ rotation.T
    margin = 7 if jitter else 6
    low, high = np.floor(corners.min(0)) - margin, np.ceil(corners.max(0)) + margin
    count = (high - low).astype(int) + 1
    shift = rng.uniform(0, 1, 3)
    points = np.stack(np.meshgrid(*map(np.arange, count), indexing="ij"), -1) + low + shift
    if jitter:
        points[..., :2] += rng.uniform(-jitter, jitter, (count[2], 2))
    points = points.reshape(-1, 3) @ rotation
    near = ((points > shape.box[0] - 1) & (points < shape.box[1] + 1)).all(1)
    mask = np.zeros(len(points), bool)
    mask[near] = shape.values(points[near]) < 0
    return mask.reshape(count)


def beside(mask):
    """Voxels with a neighbour, by a face, on the other side."""
    return ndi.binary_dilation(mask) & ~ndi.binary_erosion(mask)


def flipped(mask, share, rng):
    """The mask with a share of the voxels beside its boundary on the wrong side."""
    return mask ^ (beside(mask) & (rng.random(mask.shape) < share))
