"""Local curvature head to head: surfometry, DGtal's integral invariants, libigl's quadrics and vtkCurvatures at the same vertices.

Shapes and poses are those of `surfometry validate --first-pose 200 --ratios 1`, made here without it; so are the errors: area-weighted rms over
the surface in % of k_rms (H) and of its square (K), where k_rms = 1 / R is the rms of the larger principal curvature. What a peer finds goes to
each of our vertices from the nearest of its own. We choose our scale from the mask. A peer gets, for H and for K each, the setting that turns out
best against the truth: of usual ones, and of any, among them scales that no one would choose without the truth; so do we in the last column.

    python3.11 -m venv a && a/bin/pip install -r benches/peers/requirements.txt
    cargo build --release && a/bin/python benches/peers/local_curvature.py [--surfometry PATH] [--resolutions 10,20] > local.md
"""

import argparse
import pathlib
import subprocess
import sys
import tempfile
import time

import dgtal
import igl
import numpy as np
import vtk
from scipy import ndimage, spatial
from shapes import SHAPES, Case, vertex_areas
from skimage import measure
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
FIRST_POSE = 200
# More of the surface says the same: cells of so many voxels are left out, whole ones, as DGtal goes faster from neighbour to neighbour.
MOST_SURFELS, CELL = 20_000, 16
# Blur before meshing in voxels, usual up to 2; rings of libigl's patch, of which 5 is the default; radius of DGtal's ball in units of R^(2/3) voxels,
# which is its h^(1/3) law, usual up to 1.5: 7 voxels at R = 10, 11 at R = 20 (its default is 3, its documents' example has 7).
BLURS, USUAL_BLUR = [1.5, 2.0, 3.0, 4.0, 6.0], 2.0
RINGS = [3, 5, 8]
BALLS, USUAL_BALL = [1.0, 1.5, 2.0, 2.5, 3.0], 1.5
# Our sigma in units of R^(5/7) voxels, beside the one that is chosen: near 0.66 on a smooth object.
SCALES = [0.5, 0.6, 0.7, 0.85, 1.0]
TOOLS = ["surfometry", "DGtal", "libigl", "vtkCurvatures"]
ASKED = {"DGtal": 3.0, "libigl": 1.3}


def ours(binary, mask, folder, scale="object"):
    """Vertices, their areas, and H and K there."""
    source, target = folder / "mask.npy", folder / "surface.vtp"
    np.save(source, np.ascontiguousarray(mask.T.astype(np.uint8)))
    options = ["--spacing", "1,1,1", "--curvature-sigma", scale, "--threads", "1", "-q"]
    subprocess.run([binary, "map", source, "-o", target, *options], check=True, stdout=subprocess.DEVNULL)
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(str(target))
    reader.Update()
    surface = reader.GetOutput()
    array = lambda name: vtk_to_numpy(surface.GetPointData().GetArray(name))
    vertices = vtk_to_numpy(surface.GetPoints().GetData()).astype(float)
    faces = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    found = np.stack([array("mean_curvature_per_mm"), array("gaussian_curvature_per_mm2")])
    return vertices, vertex_areas(vertices, faces), found


def blurred_mesh(mask, sigma):
    blurred = ndimage.gaussian_filter(mask.astype(np.float32), sigma, mode="constant")
    vertices, faces, _, _ = measure.marching_cubes(blurred, 0.5)
    return vertices.astype(float), faces[:, ::-1].astype(np.int64)  # outward, so that a ball has H > 0


def libigl_quadric(vertices, faces, rings):
    _, _, k1, k2, _ = igl.principal_curvature(vertices, faces, rings)
    return np.stack([0.5 * (k1 + k2), k1 * k2])


def vtk_curvatures(vertices, faces):
    cells = vtk.vtkCellArray()
    cells.SetData(numpy_to_vtkIdTypeArray(np.arange(0, faces.size + 1, 3), deep=True), numpy_to_vtkIdTypeArray(faces.ravel(), deep=True))
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(vertices, deep=True))
    mesh = vtk.vtkPolyData()
    mesh.SetPoints(points)
    mesh.SetPolys(cells)
    found = []
    for kind, name in ((vtk.VTK_CURVATURE_MEAN, "Mean_Curvature"), (vtk.VTK_CURVATURE_GAUSS, "Gauss_Curvature")):
        curvature = vtk.vtkCurvatures()
        curvature.SetInputData(mesh)
        curvature.SetCurvatureType(kind)
        curvature.Update()
        found.append(vtk_to_numpy(curvature.GetOutput().GetPointData().GetArray(name)).copy())
    return np.stack(found)


class Surfels:
    """DGtal's digital surface of a mask: the centres of its faces, and which of them are looked at: not by their order, which starts anywhere."""

    def __init__(self, mask, margin):
        point, self.tools = dgtal.kernel.Point3D, dgtal.SH3
        padded = np.pad(mask, margin)
        domain = dgtal.kernel.DomainZ3i(point(0, 0, 0), point(*(n - 1 for n in padded.shape)))
        self.parameters = self.tools.defaultParameters()
        self.parameters.set("verbose", 0)
        self.parameters.set("surfaceTraversal", "DepthFirst")
        self.image = self.tools.makeBinaryImage(padded.T.ravel().astype(float).tolist(), domain)
        space = self.tools.getKSpace(self.image, self.parameters)
        surface = self.tools.makeLightDigitalSurface(self.image, space, self.parameters)
        surfels = self.tools.getSurfelRange(surface, self.parameters)
        self.centres = np.reshape(self.tools.getEmbeddedPositions(space, surfels), (-1, 3)) - margin
        self.kept = (self.centres // CELL).sum(axis=1) % -(-len(surfels) // MOST_SURFELS) == 0
        self.surfels = [surfel for surfel, kept in zip(surfels, self.kept) if kept]

    def invariants(self, radius):
        """H and K from the covariance of the body in a ball; H from its volume, with the same K."""
        self.parameters.set("r-radius", float(radius))
        arguments = self.image, self.surfels, self.parameters
        k1, k2 = np.array([found[:2] for found in self.tools.getIIPrincipalCurvaturesAndDirections(*arguments)]).T
        yield "covariance", np.stack([0.5 * (k1 + k2), k1 * k2])
        yield "volume", np.stack([self.tools.getIIMeanCurvatures(*arguments), k1 * k2])


def nearest(places, vertices):
    """Which place is nearest to each vertex; of two as near the same one, in whatever order they come."""
    order = np.lexsort(places.T)
    return order[spatial.cKDTree(places[order]).query(vertices)[1]]


def found_by_peers(case, surfels, vertices):
    """Tool, setting, whether it is usual, and H and K at the vertices, for all settings."""
    for sigma in BLURS:
        places, faces = blurred_mesh(case.mask, sigma)
        to, usual = nearest(places, vertices), sigma <= USUAL_BLUR
        yield "vtkCurvatures", f"blur {sigma:g}", usual, vtk_curvatures(places, faces)[:, to]
        for rings in RINGS:
            yield "libigl", f"blur {sigma:g}, {rings} rings", usual, libigl_quadric(places, faces, rings)[:, to]
    to = nearest(surfels.centres[surfels.kept], vertices)
    for ball in BALLS:
        radius = ball * case.resolution ** (2 / 3)
        for kind, values in surfels.invariants(radius):
            yield "DGtal", f"r {radius:.1f}, {kind}", ball <= USUAL_BALL, values[:, to]


def squared_errors(case, binary, folder):
    """Mean squares of the errors of H and K, in units of the rms curvature: by (tool, setting, whether usual)."""
    surfels = Surfels(case.mask, int(max(BALLS) * case.resolution ** (2 / 3)) + 2)
    vertices, areas, values = ours(binary, case.mask, folder)
    seen = surfels.kept[nearest(surfels.centres, vertices)]
    vertices, areas, values = vertices[seen], areas[seen], values[:, seen]
    truth, units = case.truth(vertices), case.rms_curvature ** np.array([1, 2])
    square = lambda found: np.average((found - truth) ** 2, axis=1, weights=areas) / units**2
    errors = {("surfometry", "object", True): square(values)}
    for scale in SCALES:
        sigma = f"{scale * case.resolution ** (5 / 7):.2f}"
        places, _, found = ours(binary, case.mask, folder, sigma)
        errors["surfometry", f"sigma {sigma}", False] = square(found[:, nearest(places, vertices)])
    for tool, setting, usual, found in found_by_peers(case, surfels, vertices):
        errors[tool, setting, usual] = square(found)
    return errors


def best(errors, tool, usual):
    """The least error of H and of K in %, with their settings."""
    rows = [(error, setting) for (name, setting, is_usual), error in errors.items() if name == tool and (is_usual or not usual)]
    return [min((error[i], setting) for error, setting in rows) for i in range(2)]


def joined(numbers, digits):
    return " / ".join(f"{number:.{digits}f}" for number in numbers)


def print_rows(name, resolution, errors):
    """A row for each tool; the ratios of H and K of its best settings to ours."""
    found = {(tool, usual): best(errors, tool, usual) for tool in TOOLS for usual in (True, False)}
    values = {key: np.array([error for error, _ in pair]) for key, pair in found.items()}
    own, own_best = values["surfometry", True], values["surfometry", False]
    for tool in TOOLS:
        row = [name, f"{resolution:g}", tool]
        for usual in (True, False):
            settings = "; ".join(dict.fromkeys(setting for _, setting in found[tool, usual]))
            row += [settings, joined(values[tool, usual], 1), joined(values[tool, usual] / own, 2)]
        print(f"| {' | '.join(row)} | {joined(values[tool, False] / own_best, 2)} |", flush=True)
    return {(tool, usual): values[tool, usual] / own for tool in ASKED for usual in (True, False)}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--surfometry", default=ROOT / "target/release/surfometry", help="the program")
    parser.add_argument("--resolutions", default="10,20", help="R in voxels")
    parser.add_argument("--poses", type=int, default=2)
    parser.add_argument("--shapes", nargs="+", default=list(SHAPES), choices=list(SHAPES))
    options = parser.parse_args()
    print("| shape | R | tool | usual setting | H / K, % | x ours | any setting | H / K, % | x ours | x ours, any |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    ratios = {}
    for resolution in map(float, options.resolutions.split(",")):
        for name in options.shapes:
            start, cases = time.perf_counter(), []
            for number in range(FIRST_POSE, FIRST_POSE + options.poses):
                with tempfile.TemporaryDirectory() as folder:
                    case = Case(SHAPES[name], resolution, number)
                    cases.append(squared_errors(case, options.surfometry, pathlib.Path(folder)))
            errors = {key: 100 * np.sqrt(np.mean([case[key] for case in cases], axis=0)) for key in cases[0]}
            for key, pair in print_rows(name, resolution, errors).items():
                ratios.setdefault(key, []).append(pair)
            print(f"{name}, R = {resolution:g}: {time.perf_counter() - start:.0f} s", file=sys.stderr)
    for (tool, usual), pairs in ratios.items():
        held = int(np.sum(np.min(pairs, axis=1) >= ASKED[tool]))
        least, middle = joined(np.min(pairs, axis=0), 2), joined(np.median(pairs, axis=0), 2)
        setting = "usual" if usual else "any"
        print(f"\n{tool}, {setting} setting: {ASKED[tool]:g} x ours, as asked, in {held} of {len(pairs)} rows; least {least}, median {middle}")


if __name__ == "__main__":
    main()
