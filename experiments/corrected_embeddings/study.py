"""Local curvature of the original surface by several corrections of the blurred mask, each at its best scale: README.md says why and what came out."""

import argparse
import sys
from pathlib import Path

import numpy as np
from scipy import ndimage
from skimage import measure

sys.path.append(str(Path(__file__).resolve().parents[2] / "benches/peers"))
from shapes import SHAPES, Case  # noqa: E402
from worker import curvatures  # noqa: E402

ORDERS = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (2, 0, 0), (0, 2, 0), (0, 0, 2), (1, 1, 0), (1, 0, 1), (0, 1, 1)]
SCALES = (0.6, 0.8, 1.05, 1.4)
VERTICES = 1000


def odd_powers(*widths):
    """Weights of blurs of some widths that keep a constant and cancel the width's first odd powers: near an edge phi is (x + s^2 H + ...) / s, so a shift of the
    surface is an odd power of s."""
    rows = [[1.0] * len(widths)] + [[w ** (2 * n + 1) for w in widths] for n in range(len(widths) - 1)]
    right = np.zeros(len(widths))
    right[0] = 1
    return list(zip(np.linalg.solve(rows, right), widths))


EMBEDDINGS = {
    "plain": [(1.0, 1.0)],
    "corrected, widths 1, sqrt 2": odd_powers(1, np.sqrt(2)),
    "corrected, widths 1, 1.2": odd_powers(1, 1.2),
    "corrected, widths 1, 2": odd_powers(1, 2),
    "6th order, widths 1, sqrt 2, 2": odd_powers(1, np.sqrt(2), 2),
}


class Blurs:
    """A mask's blurs and their derivatives with their splines, made when they are asked for."""

    def __init__(self, mask, reach):
        self.pad = int(reach)
        self.inside = np.pad(mask, self.pad).astype(np.float64)
        self.made = {}

    def blur(self, sigma, order=(0, 0, 0)):
        key = (round(sigma, 6), order)
        if key not in self.made:
            offset = 0.5 if order == (0, 0, 0) else 0.0
            field = offset - ndimage.gaussian_filter(self.inside, sigma, order=order, truncate=4.5)
            self.made[key] = field, ndimage.spline_filter(field, output=np.float32)
        return self.made[key][0]

    def at(self, terms, sigma, order, points):
        """An embedding, or a derivative of it, between the voxels."""
        total = 0
        for weight, width in terms:
            self.blur(width * sigma, order)
            spline = self.made[round(width * sigma, 6), order][1]
            total += weight * ndimage.map_coordinates(spline, points.T, prefilter=False)
        return total


def on_surface(blurs, terms, sigma, points, steps=3):
    """Points of phi = 0, and gradient and second derivatives there."""
    for _ in range(steps):
        gradient = np.stack([blurs.at(terms, sigma, order, points) for order in ORDERS[:3]], axis=-1)
        phi = blurs.at(terms, sigma, (0, 0, 0), points)
        points = points - np.clip(phi[:, None] * gradient / (gradient**2).sum(-1, keepdims=True), -1, 1)
    return points, [blurs.at(terms, sigma, order, points) for order in ORDERS]


def embedding(terms):
    def method(blurs, sigma, start):
        points, jet = on_surface(blurs, terms, sigma, start)
        return (points, *curvatures(*jet)[1:])

    return method


def richardson(blurs, sigma, start):
    """Place, H and K extrapolated along normals from sigma and sqrt 2 sigma to 0."""
    plain = EMBEDDINGS["plain"]
    near, jet = on_surface(blurs, plain, sigma, start)
    far, wide = on_surface(blurs, plain, np.sqrt(2) * sigma, near)
    pairs = zip(curvatures(*jet)[1:], curvatures(*wide)[1:])
    return (2 * near - far, *(2 * a - b for a, b in pairs))


def surface_laplacian(blurs, sigma, start):
    """The plain surface moved by d = sigma^2 H along its normal, which takes the Hessian of d over the surface and d S^2 off the shape operator S."""
    plain = EMBEDDINGS["plain"]
    fields = [blurs.blur(sigma, order) for order in ORDERS]
    band = np.abs(blurs.blur(sigma)) < 0.45
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = np.where(band, curvatures(*fields)[1], 0)
    points, jet = on_surface(blurs, plain, sigma, start)
    _, h, k = curvatures(*jet)
    second = np.array([-1, 16, -30, 16, -1]) / 12
    first = np.array([1, -8, 0, 8, -1]) / 12
    along = lambda field, stencil, axis: ndimage.correlate1d(field, stencil, axis=axis)
    at = lambda field: ndimage.map_coordinates(field, points.T, order=3)
    slopes = [along(mean, first, axis) for axis in range(3)]
    hessian = [along(mean, second, axis) for axis in range(3)]
    hessian += [along(slopes[a], first, b) for a, b in ((0, 1), (0, 2), (1, 2))]
    gradient = np.stack(jet[:3], axis=-1)
    size = np.linalg.norm(gradient, axis=-1)
    normal = gradient / size[:, None]
    tangential = np.eye(3) - normal[:, :, None] * normal[:, None, :]
    shape = tangential @ symmetric(jet[3:]) @ tangential / size[:, None, None]
    shift = sigma**2 * h
    normal_slope = sigma**2 * sum(n * at(s) for n, s in zip(normal.T, slopes))
    bending = sigma**2 * tangential @ symmetric([at(f) for f in hessian]) @ tangential - normal_slope[:, None, None] * shape
    change = bending + shift[:, None, None] * (shape @ shape)
    trace = lambda tensor: np.trace(tensor, axis1=1, axis2=2)
    gauss = k - (trace(shape) * trace(change) - trace(shape @ change))
    return points + shift[:, None] * normal, h - 0.5 * trace(change), gauss


def symmetric(six):
    xx, yy, zz, xy, xz, yz = six
    return np.stack([np.stack(row, axis=-1) for row in ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))], axis=-2)


METHODS = {name: embedding(terms) for name, terms in EMBEDDINGS.items()}
METHODS["surface Laplacian of the shift"] = surface_laplacian
METHODS["Richardson of place, H, K"] = richardson


def errors(case, blurs, method, sigma, start):
    """Rms errors of H in % of 1/R, of K in % of 1/R^2, and of the place in voxels."""
    points, mean, gauss = method(blurs, sigma, start)
    good = np.isfinite(mean) & np.isfinite(gauss) & (np.abs(points - start).max(-1) < 4)
    points, mean, gauss = points[good] - blurs.pad, mean[good], gauss[good]
    exact = case.truth(points)
    feet = case.shape.feet(case.unit(points))
    distance = case.scale * np.linalg.norm(feet - case.unit(points), axis=-1)
    rms = lambda values: np.sqrt(np.mean(values**2))
    curvature = case.rms_curvature
    return 100 * rms(mean - exact[0]) / curvature, 100 * rms(gauss - exact[1]) / curvature**2, rms(distance)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--resolutions", default="10,20", help="R in voxels")
    parser.add_argument("--shapes", nargs="+", default=["ellipsoid 3:2:1.5", "torus 2:1", "schwarz-p"], choices=list(SHAPES))
    parser.add_argument("--pose", type=int, default=300)
    args = parser.parse_args()
    for resolution in map(float, args.resolutions.split(",")):
        table = {name: {} for name in METHODS}
        rule = 0.66 * resolution ** (5 / 7)
        for shape in args.shapes:
            case = Case(SHAPES[shape], resolution, args.pose)
            blurs = Blurs(case.mask, 3 * SCALES[-1] * rule + 3)
            vertices = measure.marching_cubes(blurs.blur(rule), 0)[0]
            start = np.random.default_rng(1).permutation(vertices)[:VERTICES]
            for scale in SCALES:
                for name, method in METHODS.items():
                    table[name].setdefault(scale, []).append(errors(case, blurs, method, scale * rule, start))
                blurs.made.clear()
        print(f"\nR = {resolution:g}: H / K in %, place in voxels\n\n| method | sigma | {' | '.join(args.shapes)} |\n|---|---|{'---|' * len(args.shapes)}")
        for name, by_scale in table.items():
            # The best common scale: the least sum of H over its best on each shape.
            best = np.min([[e[0] for e in row] for row in by_scale.values()], axis=0)
            scale = min(by_scale, key=lambda s: sum(e[0] / b for e, b in zip(by_scale[s], best)))
            cells = " | ".join(f"{h:.1f} / {k:.1f}, {p:.2f}" for h, k, p in by_scale[scale])
            print(f"| {name} | {scale * rule:.2f} | {cells} |", flush=True)


if __name__ == "__main__":
    main()
