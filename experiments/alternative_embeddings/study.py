"""The embeddings that the paper's discussion names, on the same phantoms as the blur: README.md says why and what came out."""

import argparse
import csv
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import SimpleITK as sitk
from scipy import ndimage, special

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "benches/peers"))
from shapes import SHAPES, Case  # noqa: E402

PROGRAM = ROOT / "target/release/surfometry"
# Field around the mask, so that no embedding feels an edge.
PADDING = 12


def distance(inside):
    """Signed distance to the voxels' faces, to half a voxel."""
    outward = ndimage.distance_transform_edt(~inside)
    return np.where(inside, 0.5 - ndimage.distance_transform_edt(inside), outward - 0.5)


def blur(inside, sigma=2.0):
    return 0.5 - ndimage.gaussian_filter(inside.astype(float), sigma, truncate=4.5)


def filtered(image_filter, field, **settings):
    image = sitk.GetImageFromArray(field)
    for name, value in settings.items():
        getattr(image_filter, f"Set{name}")(value)
    return sitk.GetArrayFromImage(image_filter.Execute(image)).astype(float)


def reinitialised(field):
    """The distance to the zero level of a field, by fast marching from its sub-voxel crossings."""
    return filtered(sitk.ReinitializeLevelSetImageFilter(), field.astype(np.float32))


def dithered(inside):
    """Distance with half a voxel of noise against its steps, reinitialised (the authors' earlier proposal)."""
    noise = np.random.default_rng(1).uniform(-0.5, 0.5, inside.shape)
    field = distance(inside)
    return reinitialised(np.where(np.abs(field) < 3, field + noise, field))


def diffused(inside, conductance):
    """Perona and Malik's anisotropic diffusion of the indicator, for as long as a blur of 2 voxels takes; the conductance is in units of the mean gradient."""
    smooth = filtered(
        sitk.GradientAnisotropicDiffusionImageFilter(), inside.astype(np.float32), NumberOfIterations=32, TimeStep=0.0625, ConductanceParameter=conductance
    )
    return 0.5 - smooth


def anti_aliased(inside):
    """Whitaker's constrained flow: the smoothest surface that separates the voxels as they are."""
    return -filtered(sitk.AntiAliasBinaryImageFilter(), inside.astype(np.uint8), NumberOfIterations=200, MaximumRMSError=0.002)


def spline(inside):
    """Cubic B-spline approximation: the indicator's samples as coefficients."""
    return 0.5 - ndimage.convolve1d(ndimage.convolve1d(ndimage.convolve1d(inside.astype(float), KERNEL, 0), KERNEL, 1), KERNEL, 2)


KERNEL = np.array([1, 4, 1]) / 6

def corrected(inside, sigma=2.0):
    """Our corrected embedding: two blurs whose surfaces' shifts cancel."""
    near, far = np.sqrt(2) + 2, np.sqrt(2) + 1
    return near * blur(inside, sigma) - far * blur(inside, np.sqrt(2) * sigma)


# Fields that saturate at 0.5 have a band in units of the field, the one that a blur of 2 voxels has for t = 2.5 voxels; distances have t itself.
INDICATOR = ("--epsilon", 0.5 * special.erf(2.5 / (2 * np.sqrt(2) * 2)))
DISTANCE = ("--thickness", 2.5)

EMBEDDINGS = {
    "blur, 2 voxels": blur,
    "corrected blur, 2 voxels": corrected,
    "corrected blur, 4 voxels": lambda inside: corrected(inside, 4.0),
    "distance": distance,
    "blur, reinitialised": lambda inside: reinitialised(blur(inside)),
    "dithered, reinitialised": dithered,
    "anisotropic diffusion, conductance 3": lambda inside: diffused(inside, 3.0),
    "anisotropic diffusion, conductance 30": lambda inside: diffused(inside, 30.0),
    "anti-aliasing": anti_aliased,
    "cubic B-spline": spline,
    "anti-aliasing, blurred by 1 voxel": lambda inside: ndimage.gaussian_filter(anti_aliased(inside), 1.0),
}


# The same shapes, a unit as many mm as a case has voxels.
PHANTOMS = {
    "ellipsoid 3:2:1.5": lambda s: f"phantom:ellipsoid?radii={3 * s},{2 * s},{1.5 * s}",
    "torus 2:1": lambda s: f"phantom:torus?major={2 * s}&minor={s}",
    "schwarz-p": lambda s: f"phantom:schwarz-p?period={4 * s}&size={6 * s}",
}


def program(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments), "-q"], capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(done.stderr)
    return done.stdout


def record(*arguments):
    return json.loads(program("measure", *arguments, "--format", "json"))["results"][0]


def errors(case, exact, field, folder):
    """Of V, A, M in %, of chi; rms of H and K in % of 1/R and 1/R^2."""
    file, vertices = folder / "field.nii.gz", folder / "surface.csv"
    sitk.WriteImage(sitk.GetImageFromArray(field.astype(np.float32)), str(file))
    band = DISTANCE if np.abs(field).max() > 2 else INDICATOR
    values = record(file, "--embedding", "given", *band)
    vertices.unlink(missing_ok=True)
    program("map", file, "--embedding", "given", *band, "-o", vertices)
    with open(vertices) as rows:
        table = list(csv.DictReader(rows))
    column = lambda name: np.array([float(row[name]) for row in table])
    # Vertices are in RAS, SimpleITK's image axes are z, y, x in LPS.
    places = np.stack([column("z_mm"), -column("y_mm"), -column("x_mm")], axis=-1) - PADDING
    chosen = np.random.default_rng(1).permutation(len(places))[:2000]
    mean, gauss = case.truth(places[chosen])
    rms = lambda v: np.sqrt(np.nanmean(v**2))
    integrals = ("volume_mm3", "surface_area_mm2", "total_mean_curvature_mm")
    percent = [100 * ((values[name] or np.nan) / exact[name] - 1) for name in integrals]
    h = 100 * rms(column("mean_curvature_per_mm")[chosen] - mean) / case.rms_curvature
    k = 100 * rms(column("gaussian_curvature_per_mm2")[chosen] - gauss) / case.rms_curvature**2
    return *percent, (values["euler_characteristic"] or np.nan) - exact["euler_characteristic"], h, k


NUMBERS = Path(__file__).parent / "expected" / "numbers.csv"
COLUMNS = ("V_percent", "A_percent", "M_percent", "chi", "H_percent", "K_percent")
# Filters and libraries differ between versions and machines.
TOLERANCE = 0.02


def differences(found):
    """Where numbers are not the expected ones, a line each; NaN is a number that could not be had."""
    with open(NUMBERS) as rows:
        expected = {row["name"]: float(row["value"]) for row in csv.DictReader(rows)}
    for name, value in found.items():
        other = expected.get(name, float("inf"))
        if not (np.isnan(value) and np.isnan(other)) and not abs(value - other) <= TOLERANCE * max(abs(other), 1):
            yield f"{name} is {value}, expected {other}"


def study(shape, resolution, pose):
    """All embeddings of a shape: prints its table, gives its numbers by name."""
    case = Case(SHAPES[shape], resolution, pose)
    exact = record(PHANTOMS[shape](case.scale))["truth"]
    inside = np.pad(case.mask, PADDING)
    print(f"\n{shape}, R = {resolution:g} voxels\n\n| embedding | V % | A % | M % | chi | H % | K % | s |\n|---|---|---|---|---|---|---|---|")
    numbers = {}
    for name, embed in EMBEDDINGS.items():
        start = time.perf_counter()
        field = embed(inside)
        seconds = time.perf_counter() - start
        with tempfile.TemporaryDirectory() as folder:
            values = errors(case, exact, field, Path(folder))
        numbers |= {f"{name}.{shape}.{column}": float(value) for column, value in zip(COLUMNS, values)}
        v, a, m, chi, h, k = values
        print(f"| {name} | {v:+.2f} | {a:+.2f} | {m:+.2f} | {chi:+.2f} | {h:.1f} | {k:.1f} | {seconds:.1f} |", flush=True)
    return numbers


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--resolution", type=float, default=15, help="R in voxels")
    parser.add_argument("--shapes", nargs="+", default=list(PHANTOMS), choices=list(PHANTOMS))
    parser.add_argument("--pose", type=int, default=300)
    parser.add_argument("--check", action="store_true", help="compare with expected/; exit status 1 where numbers differ")
    parser.add_argument("--accept", action="store_true", help="take the numbers into expected/, from where the page of the paper's results has them")
    args = parser.parse_args()
    numbers = {}
    for shape in args.shapes:
        numbers |= study(shape, args.resolution, args.pose)
    if args.accept:
        NUMBERS.parent.mkdir(exist_ok=True)
        with open(NUMBERS, "w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([("name", "value"), *((name, f"{value:.4f}") for name, value in numbers.items())])
    wrong = list(differences(numbers)) if args.check else []
    print(*wrong, sep="\n")
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
