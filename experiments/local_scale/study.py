"""One scale for an object, or one for each vertex: README.md says what is asked and what came out.

    cargo build --release
    python study.py            # NumPy, nibabel; an hour on one core
    python study.py zoo        # one of: zoo, detail, noise, time
"""

import csv
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import nibabel
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "target/release/surfometry"
FAULTS = Path("/work/shared/data/faults/measures")
SCALES = ("object", "local")
rms = lambda values: float(np.sqrt(np.mean(np.square(values))))


def run(*arguments):
    return subprocess.run([PROGRAM, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


def vertices(image, scale):
    """The map's table of an image: place, and columns by name."""
    with tempfile.TemporaryDirectory() as folder:
        table = Path(folder) / "map.csv"
        run("map", image, "--curvature-sigma", scale, "-o", table)
        with table.open() as lines:
            rows = list(csv.DictReader(lines))
    columns = {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}
    return np.stack([columns[f"{a}_mm"] for a in "xyz"], axis=-1), columns


def zoo():
    """Held-out poses (200 and on) of all shapes: H | K in %, place in voxels, share within the bars."""
    for resolution, ratio, poses in ((10, 1, 3), (20, 1, 2), (10, 2.5, 1)):
        print(f"\nR = {resolution}, spacings 1:{ratio}\n\n| shape | object | local |\n|---|---|---|")
        found = {}
        for scale in SCALES:
            text = run("validate", "--resolutions", resolution, "--ratios", ratio, "--poses", poses, "--first-pose", 200,
                       "--curvature-sigma", scale, "--format", "json", "--quiet")
            found[scale] = {row["shape"]: row for row in json.loads(text)["summaries"]}
        for shape in found["object"]:
            cells = []
            for scale in SCALES:
                row = found[scale][shape]
                covered = " ".join(f"{share:.0f}" for share in row["local_coverage"])
                cells.append(f"{row['mean_curvature']:.1f} | {row['gaussian_curvature']:.1f}, {row['position_voxels']:.3f}, {covered}".replace("|", "\\|"))
            print(f"| {shape} | {' | '.join(cells)} |", flush=True)


def detail():
    """What a pilot at a larger scale does not see."""
    bottom, small = np.array([30, 59.7, 36]), np.array([39.81, 40.29, 84.39])
    for scale in SCALES:
        places, columns = vertices(FAULTS / "dimple_R28_h3_w4.nii.gz", scale)
        nearest = np.argmin(np.linalg.norm(places - bottom, axis=1))
        mean, bar = (columns["mean_curvature_per_mm" + suffix] for suffix in ("", "_standard_error"))
        print(f"{scale}: dimple, H {mean[nearest]:+.3f} +- {bar[nearest]:.3f} at {np.round(places[nearest], 1)}; -0.194 is right")
        places, columns = vertices(FAULTS / "two_balls_28_6.nii.gz", scale)
        radius = np.linalg.norm(places - small, axis=1)
        near = radius < 10
        mean, bar = (columns["mean_curvature_per_mm" + suffix][near] for suffix in ("", "_standard_error"))
        within = np.mean(np.abs(mean - 1 / 6) < 1.96 * bar)
        print(f"{scale}: small ball, H {mean.mean():.4f}, scatter {mean.std():.4f}, radius {radius[near].mean():.3f}, {100 * within:.0f} % within the bars")


def noisy(kind, seed):
    """An ellipsoid of 24, 18 and 12 voxels, turned; its mask, and H at places near its surface."""
    rng = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    radii, middle = np.array([24.0, 18.0, 12.0]), 32 + rng.uniform(-0.5, 0.5, 3)
    level = lambda p: (((p - middle) @ turn / radii) ** 2).sum(-1)
    grid = np.stack(np.meshgrid(*[np.arange(64.0)] * 3, indexing="ij"), axis=-1)
    mask = level(grid) < 1
    near = np.abs(np.sqrt(level(grid)) - 1) * 15 < 0.8
    if kind == "1 % flipped":
        mask ^= near & (rng.random(mask.shape) < 0.01)
    if kind == "5 % flipped":
        mask ^= near & (rng.random(mask.shape) < 0.05)
    if kind == "slices shifted":
        for z in range(64):
            mask[:, :, z] = np.roll(mask[:, :, z], rng.integers(-1, 2, 2), axis=(0, 1))
    if kind == "jittered edge":
        mask = level(grid + rng.normal(scale=0.25, size=grid.shape)) < 1

    def mean_curvature(p):
        q = (p - middle) @ turn
        q = q / np.sqrt((q**2 / radii**2).sum(-1, keepdims=True))
        w = (q**2 / radii**4).sum(-1)
        return ((1 / radii**2).sum() - (q**2 / radii**6).sum(-1) / w) / (2 * np.sqrt(w))

    return mask, mean_curvature


def noise():
    """Masks that are wrong: rms error of H in %, and the share of vertices within the bars."""
    print("\n| mask | object | local |\n|---|---|---|")
    for kind in ("clean", "jittered edge", "1 % flipped", "5 % flipped", "slices shifted"):
        cells = []
        for scale in SCALES:
            errors, within = [], []
            for seed in (1, 2):
                mask, exact = noisy(kind, seed)
                with tempfile.TemporaryDirectory() as folder:
                    path = Path(folder) / "noisy.nii"
                    nibabel.save(nibabel.Nifti1Image(mask.astype(np.uint8), np.eye(4)), path)
                    places, columns = vertices(path, scale)
                error = columns["mean_curvature_per_mm"] - exact(places)
                errors.append(100 * rms(error) / rms(exact(places)))
                within.append(100 * np.mean(np.abs(error) < 1.96 * columns["mean_curvature_per_mm_standard_error"]))
            cells.append(f"{np.mean(errors):.1f}, {np.mean(within):.0f}")
        print(f"| {kind} | {' | '.join(cells)} |", flush=True)


def times():
    """Seconds of a map."""
    for shape in ("ellipsoid?radii=20,14,10", "ellipsoid?radii=60,42,30", "schwarz-p?period=60&size=90", "ellipsoid?radii=20,14,10&spacing=1,1,0.4"):
        taken = []
        for scale in SCALES:
            start = time.perf_counter()
            run("map", f"phantom:{shape}", "--curvature-sigma", scale, "-o", "/tmp/local_scale_study.csv")
            taken.append(time.perf_counter() - start)
        print(f"{shape}: {taken[0]:.2f}, {taken[1]:.2f} s, {taken[1] / taken[0]:.1f} times", flush=True)


if __name__ == "__main__":
    parts = {"detail": detail, "noise": noise, "time": times, "zoo": zoo}
    for name in sys.argv[1:] or parts:
        print(f"\n## {name}\n")
        parts[name]()
