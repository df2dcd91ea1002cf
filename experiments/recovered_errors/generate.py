"""Writes masks of shapes in random poses, clean and noisy, and what is true of them. README.md says what for.

    python generate.py FOLDER            # all kinds, 15 to 20 minutes on one core
    python generate.py FOLDER ell tube2  # some of them

FOLDER/KIND_NUMBER_POSE.nii.gz has voxels of 1 mm. POSE is a number for a clean mask, else its noise, one of
NOISES. FOLDER/truth.json has, by KIND_NUMBER, what `shapes.Truth` has.
"""

import argparse
import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Callable

import nibabel
import numpy as np

from sharp_bodies import Cone, Cuboid, Cylinder, Sharp
from shapes import (
    Ball,
    Cup,
    Superellipsoid,
    Torus,
    Tube,
    Union,
    flipped,
    posed,
    random_field,
    random_tube,
    smoothed_label,
    truth,
)

ROOT = Path(__file__).resolve().parents[2]
REAL = ROOT.parent / "shared" / "data" / "real"
VERTEBRAE = REAL / "bone" / "sub-verse004_seg-vert_msk.nii.gz"
ORGANS = REAL / "bone" / "totalseg_ct_3mm_62labels.nii.gz"
BRAIN = REAL / "brain" / "freesurfer_subcortical_1mm.nii.gz"

# Labels of what is whole and neither tiny nor huge. Those held out of organs are others than those fitted on.
OF_BRAIN = (4, 10, 11, 12, 13, 16, 17, 18, 26, 43, 49, 50, 51, 52, 53, 54, 58)
OF_ORGANS = (1, 3, 4, 18, 19, 25, 26, 28, 63, 65, 67, 68, 77, 82, 84, 88, 89)
HELD_OUT_ORGANS = (2, 5, 27, 29, 31, 64, 66, 78, 85)
LARGE_ORGAN = 5
FIRST_VERTEBRA = 16

# Shares of voxels flipped, and by how many voxels slices are shifted at most.
FLIPPED = {"f1": 0.01, "f2": 0.02, "f5": 0.05}
SHIFTED = {"s05": 0.5, "s10": 1.0}
NOISES = (*FLIPPED, *SHIFTED)


def ellipsoid(rng, _):
    return Superellipsoid(rng.uniform(3, 9, 3), rng.uniform(2, 3.5))


def box(rng, _):
    return Superellipsoid(rng.uniform(3, 9, 3), rng.uniform(6, 12))


def plate(rng, _):
    wide = rng.uniform(6, 10), rng.uniform(6, 10)
    return Superellipsoid([*wide, rng.uniform(1.3, 2.5)], rng.uniform(2.5, 8))


def torus(rng, _):
    return Torus(rng.uniform(6, 12), rng.uniform(1.2, 3))


def cup(rng, _):
    return Cup(rng.uniform(6, 9), rng.uniform(1.1, 2), rng.uniform(-2, 3))


def tube(radius, length):
    """Tubes of radii and lengths from a range each."""

    def make(rng, _):
        return Tube(*random_tube(rng, rng.uniform(*radius), rng.uniform(*length)))

    return make


def branches(rng, _):
    """A tube from which three others go off."""
    radius = rng.uniform(1.2, 2.6)
    trunk = Tube(*random_tube(rng, radius, 30))
    parts = [trunk]
    for _ in range(3):
        control, radii = random_tube(rng, radius * rng.uniform(0.75, 1.0), 20)
        parts.append(Tube(control + trunk.curve[rng.integers(8, 52)], radii, 40))
    return Union(parts, 0.3)


def blobs(rng, _):
    """Balls, each on the surface of one before it."""
    parts = []
    centre = np.zeros(3)
    for _ in range(rng.integers(6, 14)):
        radius = rng.uniform(2.2, 5)
        direction = rng.standard_normal(3)
        direction /= np.linalg.norm(direction)
        if parts:
            other = parts[rng.integers(len(parts))]
            centre = other.centre + direction * radius * rng.uniform(0.7, 1.2)
        parts.append(Ball(centre, radius))
    return Union(parts, 0.5)


def lump(rng, _):
    return random_field(rng, rng.uniform(1.5, 3.0), rng.uniform(6, 11))


def coarse_vertebra(rng, number):
    return smoothed_label(VERTEBRAE, FIRST_VERTEBRA + number, 1.8, 3.0 * rng.uniform(0.9, 1.1))


def fine_vertebra(_, number):
    return smoothed_label(VERTEBRAE, FIRST_VERTEBRA + number, 1.8, 1.26)


def smoother_vertebra(_, number):
    return smoothed_label(VERTEBRAE, FIRST_VERTEBRA + number, 2.5, 2.7)


def brain_part(_, number):
    return smoothed_label(BRAIN, OF_BRAIN[number], 1.2, 1.0)


def coarse_brain_part(_, number):
    return smoothed_label(BRAIN, OF_BRAIN[number], 1.0, 1.5)


def organ(_, number):
    return smoothed_label(ORGANS, OF_ORGANS[number], 3.3, 3.0)


def held_out_organ(_, number):
    label = HELD_OUT_ORGANS[number]
    return smoothed_label(ORGANS, label, 3.6, 6.0 if label == LARGE_ORGAN else 4.0)


def cuboid(rng, _):
    return Cuboid(rng.uniform(8, 32, 3))


def cylinder(rng, _):
    return Cylinder(rng.uniform(4, 15), rng.uniform(4, 30))


def cone(rng, _):
    return Cone(rng.uniform(6, 18), rng.uniform(8, 30))


def small_cuboid(rng, _):
    return Cuboid(rng.uniform(4, 14, 3))


def small_cylinder(rng, _):
    return Cylinder(rng.uniform(2.5, 7), rng.uniform(4, 14))


def small_cone(rng, _):
    radius = rng.uniform(4, 9)
    return Cone(radius, radius * rng.uniform(1.2, 2.4))


def flat_cone(rng, _):
    radius = rng.uniform(8, 20)
    return Cone(radius, radius * rng.uniform(0.3, 0.7))


def slim_cone(rng, _):
    radius = rng.uniform(4, 9)
    return Cone(radius, radius * rng.uniform(3, 6))


def square_rod(rng, _):
    return Cuboid([*rng.uniform(2.5, 5, 2), rng.uniform(12, 30)])


def cuboid_along(rng, _):
    return Cuboid(rng.uniform(5, 25, 3))


def small_ball(rng, _):
    return Superellipsoid([rng.uniform(2, 6)] * 3, 2.0)


def small_ellipsoid(rng, _):
    return Superellipsoid(rng.uniform(2.2, 6, 3), 2.0)


@dataclass(frozen=True)
class Kind:
    """What is made of it: so many shapes, clean in so many poses, the first few with every noise too.

    `step` is that of the coarser mesh of its truth. Poses are turned by `tilt` degrees at most, if any way
    where it is None. Errors were fitted without those held out.
    """

    make: Callable
    shapes: int
    poses: int
    step: float
    noisy: int = 0
    source: Path | None = None
    held_out: bool = False
    tilt: float | None = None


KINDS = {
    "fs": Kind(brain_part, 17, 4, 0.25, 17, source=BRAIN),
    "vert3": Kind(coarse_vertebra, 9, 5, 0.25, 9, source=VERTEBRAE),
    "ell": Kind(ellipsoid, 14, 3, 0.25, 8),
    "sharp": Kind(box, 12, 3, 0.25, 6),
    "blobs": Kind(blobs, 16, 3, 0.25, 8),
    "grf": Kind(lump, 16, 3, 0.25, 8),
    "organ3": Kind(organ, 17, 2, 0.5, 8, source=ORGANS),
    "tube1": Kind(tube((0.9, 1.3), (12, 40)), 10, 4, 0.25),
    "tube2": Kind(tube((1.4, 2.2), (12, 40)), 10, 4, 0.5, 6),
    "tube3": Kind(tube((2.3, 4), (15, 50)), 8, 4, 0.5),
    "vertfine": Kind(fine_vertebra, 5, 3, 0.5, source=VERTEBRAE),
    "branch": Kind(branches, 6, 4, 0.5),
    "cuboid": Kind(cuboid, 12, 2, 0.0),
    "near": Kind(cuboid, 12, 2, 0.0, tilt=14),
    "cyl": Kind(cylinder, 10, 2, 0.0),
    "cone": Kind(cone, 10, 2, 0.0),
    "cuboidS": Kind(small_cuboid, 14, 3, 0.0),
    "cylS": Kind(small_cylinder, 14, 3, 0.0),
    "coneS": Kind(small_cone, 14, 3, 0.0),
    "coneF": Kind(flat_cone, 8, 3, 0.0),
    "coneL": Kind(slim_cone, 8, 3, 0.0),
    "rodsq": Kind(square_rod, 10, 3, 0.0),
    "along": Kind(cuboid_along, 16, 2, 0.0, tilt=0),
    "ballS": Kind(small_ball, 12, 3, 0.25),
    "ellS": Kind(small_ellipsoid, 12, 3, 0.25),
    "plate": Kind(plate, 8, 3, 0.25, held_out=True),
    "torus": Kind(torus, 7, 3, 0.5, held_out=True),
    "cup": Kind(cup, 7, 3, 0.5, held_out=True),
    "fsC": Kind(coarse_brain_part, 9, 3, 0.25, source=BRAIN, held_out=True),
    "vertB": Kind(smoother_vertebra, 9, 3, 0.25, source=VERTEBRAE, held_out=True),
    "organB": Kind(held_out_organ, 9, 3, 0.5, source=ORGANS, held_out=True),
    "ribs": Kind(tube((1.0, 1.6), (20, 60)), 6, 3, 0.5, held_out=True),
}


def save(mask, path):
    nibabel.save(nibabel.Nifti1Image(mask.astype(np.uint8), np.eye(4)), path)


def write(folder, name, number):
    """The masks of one shape; what is true of it."""
    kind = KINDS[name]
    seed = [sum(name.encode()), number]
    rng = np.random.default_rng([999, *seed] if kind.held_out else seed)
    shape = kind.make(rng, number)
    stem = f"{name}_{number:02d}"
    masks = [posed(shape, rng, tilt=kind.tilt) for _ in range(kind.poses)]
    for pose, mask in enumerate(masks):
        save(mask, folder / f"{stem}_{pose}.nii.gz")
    if number < kind.noisy:
        rng = np.random.default_rng([7, *reversed(seed)])
        for noise, share in FLIPPED.items():
            save(flipped(masks[0], share, rng), folder / f"{stem}_{noise}.nii.gz")
        for noise, most in SHIFTED.items():
            save(posed(shape, rng, most), folder / f"{stem}_{noise}.nii.gz")
    return stem, asdict(shape.exact() if isinstance(shape, Sharp) else truth(shape, kind.step))


def main():
    parser = argparse.ArgumentParser(description="Writes masks of shapes and what is true of them.")
    parser.add_argument("folder", type=Path)
    parser.add_argument("kinds", nargs="*", metavar="kind", help=f"of {', '.join(KINDS)}")
    arguments = parser.parse_args()
    unknown = set(arguments.kinds) - set(KINDS)
    if unknown:
        parser.error(f"no such kinds: {', '.join(sorted(unknown))}")
    arguments.folder.mkdir(parents=True, exist_ok=True)
    truths = {}
    for name in arguments.kinds or KINDS:
        kind = KINDS[name]
        if kind.source and not kind.source.exists():
            print(f"{name}: skipped, there is no {kind.source}", flush=True)
            continue
        truths.update(write(arguments.folder, name, number) for number in range(kind.shapes))
        (arguments.folder / "truth.json").write_text(json.dumps(truths, indent=1))
        print(f"{name}: written", flush=True)


if __name__ == "__main__":
    main()
