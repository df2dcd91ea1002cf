#!/usr/bin/env python3
"""Standard errors of V against what V is off by, over places of the grid: study.py SURFOMETRY [--places 80]"""

import argparse
import json
import math
import random
import subprocess
import tempfile

# A shape and how it lies; each is put in so many places. Ranges are drawn from anew for each.
POSES = {
    "ball, R 10": "ball?radius=10",
    "ball, R 20, 0.6 x 0.8 x 1.2": "ball?radius=20&spacing=0.6,0.8,1.2",
    "ball, R 16, 0.8 x 0.8 x 3": "ball?radius=16&spacing=0.8,0.8,3",
    "tube along z, R 1.6 to 3": "capsule?radius={1.6:3}&length=45",
    "tube along z, R 3 to 5": "capsule?radius={3:5}&length=45",
    "tube along z, R 5 to 15": "capsule?radius={5:15}&length=45",
    "tube along a diagonal, R 5 to 15": "capsule?radius={5:15}&length=45&rotate=45,0,0",
    "tube 26.565 degrees off, R 5 to 15": "capsule?radius={5:15}&length=45&rotate=26.565,0,0",
    "tube 0.2 degrees off, R 8 to 15": "capsule?radius={8:15}&length=45&rotate=0.2,0,0",
    "tube 2 degrees off, R 8 to 15": "capsule?radius={8:15}&length=45&rotate=2,0,0",
    "tube 2 and 3 degrees off, R 8 to 15": "capsule?radius={8:15}&length=45&rotate=2,3,0",
    "tube in any direction, R 8 to 15": "capsule?radius={8:15}&length=45&rotate={0:360},{0:90},0",
    "tube along z, R 8, 0.8 x 0.8 x 3": "capsule?radius=8&length=40&spacing=0.8,0.8,3",
    "tube along y, R 8, 0.8 x 0.8 x 3": "capsule?radius=8&length=40&rotate=90,0,0&spacing=0.8,0.8,3",
    "torus 20:8, axis along z": "torus?major=20&minor=8",
    "torus 30:10, README's": "torus?rotate=-35,10,25&spacing=0.8,0.8,1.2",
    "rounded box along the grid": "rounded-box?radii=14.3,11.6,9.1&radius=3",
    "ellipsoid 24:16:10": "ellipsoid?radii=24,16,10&rotate=20,30,10",
}


def spec(pose, drawn):
    while "{" in pose:
        before, rest = pose.split("{", 1)
        ends, after = rest.split("}", 1)
        low, high = map(float, ends.split(":"))
        pose = f"{before}{drawn.uniform(low, high):.3f}{after}"
    spacing = pose.split("spacing=")[1].split("&")[0] if "spacing=" in pose else "1,1,1"
    shift = ",".join(f"{drawn.uniform(-0.5, 0.5) * float(h):.4f}" for h in spacing.split(","))
    return f"phantom:{pose}&shift={shift}"


def rms(values):
    return math.sqrt(sum(v * v for v in values) / len(values))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("--places", type=int, default=80)
    arguments = parser.parse_args()
    print("| pose | V off by, rms mm³ | its standard error | rms z of V | largest | of A | of M |\n|---|---|---|---|---|---|---|")
    for name, pose in POSES.items():
        drawn = random.Random(name)
        inputs = [spec(pose, drawn) for _ in range(arguments.places)]
        with tempfile.NamedTemporaryFile(suffix=".json") as file:
            subprocess.run([arguments.program, "measure", *inputs, "-q", "-o", file.name], check=True)
            results = json.load(open(file.name))["results"]
        off = {}
        for n in ("volume_mm3", "surface_area_mm2", "total_mean_curvature_mm"):
            off[n] = [(r[n] - r["truth"][n], r["standard_error"][n]) for r in results if r["standard_error"][n] is not None]
        z = {n: [error / told for error, told in pairs] for n, pairs in off.items()}
        volume = off["volume_mm3"]
        print(
            f"| {name} | {rms([e for e, _ in volume]):.1f} | {rms([s for _, s in volume]):.1f} | {rms(z['volume_mm3']):.2f}"
            f" | {max(map(abs, z['volume_mm3'])):.1f} | {rms(z['surface_area_mm2']):.2f} | {rms(z['total_mean_curvature_mm']):.2f} |"
        )


if __name__ == "__main__":
    main()
