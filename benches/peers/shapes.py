"""The smooth shapes of `surfometry validate` in its poses, made without it: masks, and the curvature of the exact surface beside any point."""

import numpy as np
from scipy import spatial
from skimage import measure
from worker import curvatures

# Background voxels around a shape, as around a phantom.
MARGIN = 2


class Shape:
    """A body of unit size: negative inside, with half the edges of its box."""

    def __init__(self, implicit, half):
        self.implicit, self.half = implicit, np.array(half)

    def jet(self, points, step=1e-3):
        """Gradient and second derivatives (xx, yy, zz, xy, xz, yz) by central differences, which are good to 1e-6 of them."""
        axes = step * np.eye(3)
        f = lambda offset: self.implicit(points + offset)
        centre, ahead, behind = f(0), [f(a) for a in axes], [f(-a) for a in axes]
        first = [(p - m) / (2 * step) for p, m in zip(ahead, behind)]
        second = [(p - 2 * centre + m) / step**2 for p, m in zip(ahead, behind)]
        for a, b in ((0, 1), (0, 2), (1, 2)):
            u, v = axes[a], axes[b]
            second.append((f(u + v) - f(u - v) - f(v - u) + f(-u - v)) / (4 * step**2))
        return first + second

    def feet(self, points, steps=60):
        """The points of the surface beside others; steps along the surface are damped, as it may be curved towards them."""
        feet = points
        for _ in range(steps):
            gradient = np.stack(self.jet(feet)[:3], axis=-1)
            size = np.linalg.norm(gradient, axis=-1, keepdims=True)
            normal, offset = gradient / size, points - feet
            along = (offset * normal).sum(-1, keepdims=True)
            step = 0.7 * (offset - along * normal) - self.implicit(feet)[:, None] / size * normal
            feet = feet + step
            if np.abs(step).max() < 1e-7:
                break
        return feet

    def curvature(self, points):
        """H and K of the surface beside points."""
        return np.stack(curvatures(*self.jet(self.feet(points)))[1:])

    def rms_curvature(self):
        """Rms over the surface of the larger principal curvature, from a fine mesh of it."""
        step = self.half.min() / 32
        axes = [np.arange(-h - 2 * step, h + 3 * step, step) for h in self.half]
        values = self.implicit(np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1))
        vertices, faces, _, _ = measure.marching_cubes(values, 0)
        mean, gauss = self.curvature(vertices * step + [a[0] for a in axes])
        larger = np.abs(mean) + np.sqrt(np.maximum(mean**2 - gauss, 0))
        return np.sqrt(np.average(larger**2, weights=vertex_areas(vertices, faces)))


def ellipsoid(*radii):
    return Shape(lambda p: 0.5 * min(radii) * (((p / radii) ** 2).sum(-1) - 1), radii)


def torus(major, minor):
    outer = major + minor
    return Shape(lambda p: np.hypot(np.hypot(p[..., 0], p[..., 1]) - major, p[..., 2]) - minor, (outer, outer, minor))


def schwarz_p(period=4.0, size=6.0):
    """One side of the surface in a rounded box, both joined smoothly: as in src/phantoms/periodic.rs."""

    def implicit(p):
        wave, core = 2 * np.pi / period, 0.01
        network = np.cos(wave * p).sum(-1) * 0.7 / wave
        box = ((((2 * p / size) ** 6).sum(-1) + core) ** (1 / 6) - (1 + core) ** (1 / 6)) * size / 2
        return 0.5 * (network + box + np.hypot(network - box, 0.2 * period))

    return Shape(implicit, [size / 2] * 3)


SHAPES = {
    "ellipsoid 3:2:1.5": ellipsoid(3, 2, 1.5),
    "ellipsoid 2:2:1": ellipsoid(2, 2, 1),
    "ellipsoid 4:3:2": ellipsoid(4, 3, 2),
    "torus 3:1": torus(3, 1),
    "torus 2:1": torus(2, 1),
    "schwarz-p": schwarz_p(),
}


def vertex_areas(vertices, faces):
    """A third of the triangles around each vertex."""
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=-1) / 6
    return np.bincount(faces.ravel(), np.repeat(areas, 3), len(vertices))


def pose(number):
    """Rotation (about x, y, z), shift in voxels and size: as in src/validation/poses.rs."""
    root = 1.5
    for _ in range(60):
        root = (1 + root) ** (1 / 8)
    place = [(0.5 + (number + 1) * root ** -(n + 1)) % 1 for n in range(7)]
    degrees = [360 * place[0], np.degrees(np.arcsin(2 * place[1] - 1)), 360 * place[2]]
    rotation = spatial.transform.Rotation.from_euler("xyz", degrees, degrees=True).as_matrix()
    return rotation, np.array(place[3:6]) - 0.5, 0.9 + 0.2 * place[6]


class Case:
    """A shape in a pose: its mask (nx, ny, nz), and the truth beside any point, in voxels."""

    def __init__(self, shape, resolution, number):
        self.shape, self.resolution = shape, resolution
        self.rotation, self.shift, size = pose(number)
        unit_curvature = shape.rms_curvature()
        self.scale = size * resolution * unit_curvature
        self.rms_curvature = unit_curvature / self.scale
        reach = self.scale * np.abs(self.rotation) @ shape.half + np.abs(self.shift)
        dimensions = np.ceil(2 * reach).astype(int) + 1 + 2 * MARGIN
        self.middle = (dimensions - 1) / 2 + self.shift
        self.mask = shape.implicit(self.unit(np.moveaxis(np.indices(dimensions), 0, -1))) < 0

    def unit(self, points):
        """Points of the grid in the frame of the shape of unit size."""
        return (points - self.middle) @ self.rotation / self.scale

    def truth(self, points):
        mean, gauss = self.shape.curvature(self.unit(points))
        return np.stack([mean / self.scale, gauss / self.scale**2])
