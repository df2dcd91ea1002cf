"""Second-order compensation of V, A and M by Richardson's extrapolation in sigma^4, against first order: README.md says why and what came out."""

import argparse
import json
import math
import random
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# Shapes whose smallest radius of curvature is near one unit; the rims of `gyroid` and the edges of `rounded-box` are sharper.
SHAPES = {
    "ball": "ball?radius={1}",
    "ellipsoid 3:2:1.5": "ellipsoid?radii={2.4},{1.6},{1.2}",
    "ellipsoid 2:2:1": "ellipsoid?radii={2.4},{2.4},{1.2}",
    "torus 2:1": "torus?major={2}&minor={1}",
    "capsule": "capsule?radius={1}&length={3}",
    "shell": "shell?radius={2.4}&inner={1}",
    "genus 2": "genus?genus=2&major={1.2}&minor={1}",
    "schwarz-p": "schwarz-p?period={3.5}&size={5}",
    "gyroid": "gyroid?period={4}&size={6}",
    "rounded box": "rounded-box?radii={2.5},{2},{1.6}&radius={1}",
}
VALUES = ("volume_mm3", "surface_area_mm2", "total_mean_curvature_mm")


def spec(name, unit, pose):
    """A shape of some size, in one of the poses: rotated at random, shifted by a part of a voxel."""
    chance = random.Random(f"{name} {unit} {pose}")
    text = SHAPES[name]
    while "{" in text:
        before, _, rest = text.partition("{")
        size, _, after = rest.partition("}")
        text = f"{before}{float(size) * unit:.6f}{after}"
    rotate = ",".join(f"{chance.uniform(0, 360):.2f}" for _ in range(3))
    shift = ",".join(f"{chance.uniform(-0.5, 0.5):.3f}" for _ in range(3))
    return f"phantom:{text}&rotate={rotate}&shift={shift}"


def compensated(program, phantom, sigma):
    """Errors of V, A and M in %, after first-order compensation."""
    command = [program, "measure", phantom, "--sigma", str(sigma), "--format", "json", "-q"]
    record = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)["results"][0]
    truth, values = record["truth"], record
    mean = max(abs(truth[VALUES[2]]), 0.02 * truth[VALUES[1]])
    units = (truth[VALUES[0]], truth[VALUES[1]], mean)
    return [100 * (values[v] - truth[v]) / u if values[v] is not None else math.nan for v, u in zip(VALUES, units)]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--surfometry", default=ROOT / "target/release/surfometry")
    parser.add_argument("--radii", default="6,10,20", help="the unit, in voxels")
    parser.add_argument("--poses", type=int, default=6)
    args = parser.parse_args()
    rms = lambda errors: math.sqrt(sum(e * e for e in errors) / len(errors))
    print("| shape | unit | V first, second order | A | M |\n|---|---|---|---|---|")
    for name in SHAPES:
        for unit in map(float, args.radii.split(",")):
            pairs = []
            for pose in range(args.poses):
                phantom = spec(name, unit, pose)
                # sigma^4 is four times as large in the second.
                narrow, wide = (compensated(args.surfometry, phantom, sigma) for sigma in (2, 2 * math.sqrt(2)))
                pairs.append([(n, (4 * n - w) / 3) for n, w in zip(narrow, wide)])
            cells = [" , ".join(f"{rms([p[v][order] for p in pairs]):.3f}" for order in (0, 1)) for v in range(3)]
            print(f"| {name} | {unit:g} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
