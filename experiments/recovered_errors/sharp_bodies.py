"""Bodies with edges, by a function that is negative inside, in voxels; V, A and M by closed forms (Steiner's)."""

import numpy as np

from shapes import Shape, Truth


class Sharp(Shape):
    """What is convex: M is that of its faces, and half of length times outer angle of its edges."""

    def exact(self):
        volume, area, mean = self.integrals()
        return Truth(volume, area, mean, mean, 2, (0.0, 0.0))


class Cuboid(Sharp):
    def __init__(self, sides):
        self.sides = np.asarray(sides)
        self.box = (-self.sides / 2, self.sides / 2)

    def value(self, points):
        return (np.abs(points) - self.sides / 2).max(1)

    def integrals(self):
        a, b, c = self.sides
        return a * b * c, 2 * (a * b + b * c + a * c), np.pi * (a + b + c)


class Cylinder(Sharp):
    def __init__(self, radius, height):
        self.radius, self.height = radius, height
        corner = np.array([radius, radius, height / 2])
        self.box = (-corner, corner)

    def value(self, points):
        across = np.hypot(points[:, 0], points[:, 1]) - self.radius
        return np.maximum(across, np.abs(points[:, 2]) - self.height / 2)

    def integrals(self):
        r, h = self.radius, self.height
        return np.pi * r * r * h, 2 * np.pi * r * (r + h), np.pi * (h + np.pi * r)


class Cone(Sharp):
    """Its base is at z = 0."""

    def __init__(self, radius, height):
        self.radius, self.height = radius, height
        self.box = (np.array([-radius, -radius, 0.0]), np.array([radius, radius, height]))

    def value(self, points):
        z = points[:, 2]
        return np.maximum(np.hypot(points[:, 0], points[:, 1]) - self.radius * (1 - z / self.height), -z)

    def integrals(self):
        r, h = self.radius, self.height
        side = np.hypot(r, h)
        rim = np.pi - np.arccos(r / side)
        return np.pi * r * r * h / 3, np.pi * r * (r + side), np.pi * (h + r * rim)
