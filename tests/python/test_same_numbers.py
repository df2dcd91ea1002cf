"""The numbers are the command line's, to the bit, whatever is measured and however."""

import csv
import io
import json

import nibabel
import numpy as np
import pytest
from conftest import ORIGIN, SPACING, command_line, numbers, oblique_directions, records, turned_body, turned_field

import surfometry

PHANTOMS = [
    "phantom:ball?radius=7&spacing=0.7,0.9,1.3",
    "phantom:torus?major=9&minor=4&rotate=20,30,40",
    "phantom:ellipsoid?radii=9,7,6&rotate=10,20,30&spacing=0.8,1,1.2",
    "phantom:capsule?radius=5&length=10&rotate=15,0,40",
    "phantom:shell?radius=9&inner=5",
    "phantom:rounded-box?rotate=10,20,30",
    "phantom:two-balls",
    "phantom:genus?genus=2",
]


@pytest.mark.parametrize("name", PHANTOMS)
def test_built_in_shapes(name):
    assert surfometry.measure(name).to_dict() | {"seconds": 0, "read_seconds": 0} == records(name)[0] | {
        "seconds": 0,
        "read_seconds": 0,
    }


OPTIONS = [
    {},
    {"sigma": 1.7},
    {"sigma": {3: 1.5}, "thickness": 3},
    {"embedding": "corrected"},
    {"embedding": "gaussian", "derivatives": "finite-difference", "quadrature": "simpson"},
    {"paper": True},
    {"paper": True, "level": 0.4},
    {"label": (3,)},
    {"explain": True},
]


def as_options(options):
    words = []
    for name, value in options.items():
        text = {"sigma": "3=1.5"}.get(name) if isinstance(value, dict) else value
        text = value[0] if isinstance(value, tuple) else text
        words += [f"--{name}"] if value is True else [f"--{name}", text]
    return words


@pytest.mark.parametrize("options", OPTIONS, ids=str)
def test_options(tmp_path, options):
    body = 3 * turned_body()
    np.save(tmp_path / "body.npy", body)
    spacing = ",".join(map(str, SPACING[::-1]))
    expected = records(tmp_path / "body.npy", "--spacing", spacing, *as_options(options))
    assert numbers(surfometry.measure(body, SPACING, **options)) == numbers(expected[0])


def nifti(tmp_path, array, name="body.nii.gz"):
    affine = np.eye(4)
    affine[:3, :3] = oblique_directions() * SPACING[::-1]
    affine[:3, 3] = ORIGIN
    image = nibabel.Nifti1Image(array.T, affine)
    image.set_sform(affine, 1)
    nibabel.save(image, tmp_path / name)
    return tmp_path / name


@pytest.mark.parametrize("kind", ["float32 probability", "field", "int16 labels", "path"])
def test_files_of_all_kinds(tmp_path, kind):
    body = turned_body()
    soft = 0.25 * body + 0.75 * np.roll(body, 1, axis=2)
    arrays = {
        "float32 probability": (soft.astype(np.float32), {"embedding": "probability"}),
        "field": (turned_field().astype(np.float32), {"embedding": "given"}),
        "int16 labels": (-7 * body.astype(np.int16), {"label": -7}),
        "path": (body, {}),
    }
    array, options = arrays[kind]
    path = nifti(tmp_path, array)
    words = [word for name, value in options.items() for word in (f"--{name}", value)]
    expected = numbers(records(path, *words)[0])
    image = path if kind == "path" else nibabel.load(path)
    assert numbers(surfometry.measure(image, **options)) == expected
    assert numbers(surfometry.measure(surfometry.read(path), **options)) == expected


def labelled():
    """Three labels, two of which are of two pieces or touch."""
    body = turned_body().astype(np.int32)
    body[:, :, 20:] *= 2
    body[2:5, 2:6, 2:5] = 5
    return body


def test_labels_are_the_table(tmp_path):
    np.save(tmp_path / "labels.npy", labelled())
    spacing = ",".join(map(str, SPACING[::-1]))
    text = command_line("measure", tmp_path / "labels.npy", "--spacing", spacing, "--format", "csv")
    rows = list(csv.DictReader(io.StringIO(text)))
    columns = surfometry.measure_labels(labelled(), SPACING, as_frame=False)
    assert columns.pop("index") == [1, 2, 5]
    assert list(columns) == [name for name in rows[0] if name != "error"]
    for name, values in columns.items():
        if name not in ("input", "input_sha256", "read_seconds", "seconds"):
            written = ["" if value is None else value if isinstance(value, str) else json.dumps(value) for value in values]
            assert written == [row[name] for row in rows], name


def test_labels_by_pieces_and_unions():
    united = surfometry.measure_labels(labelled(), SPACING, label=[(1, 2), 5], as_frame=False)
    assert united["label"] == ["1+2", 5]
    pieces = surfometry.measure_labels(labelled(), SPACING, label=(1, 5), per_component=True, as_frame=False)
    assert pieces["component"] == [1, 2]
    assert sum(pieces["voxels_count"]) == int(np.isin(labelled(), (1, 5)).sum())


def test_sweeps_references_and_comparisons(tmp_path):
    name = "phantom:torus?major=9&minor=4"
    swept = surfometry.sweep(name, [1.5, 2.0, 2.5])
    text = command_line("sweep", name, "--range", "1.5:2.5:3", "--format", "json")
    assert [numbers(m) for m in swept] == [numbers(record) for record in json.loads(text)["results"]]
    classical = json.loads(command_line("reference", name, "--format", "json"))["results"]
    assert surfometry.reference(name) == classical
    assert len(surfometry.reference(name, methods=["crofton-13"])) == 1
    ours, theirs = tmp_path / "ours.csv", tmp_path / "theirs.csv"
    inputs = [f"phantom:ball?radius={radius}" for radius in (6, 7, 8, 9)]
    command_line("measure", *inputs, "-o", ours)
    command_line("reference", *inputs, "--method", "crofton-13", "-o", theirs)
    command_line("compare", ours, theirs, "-o", tmp_path / "agreement.json")
    assert surfometry.compare(ours, theirs) == json.loads((tmp_path / "agreement.json").read_text())


def test_voxel_maps_are_those_of_map(tmp_path):
    path = nifti(tmp_path, turned_body())
    command_line("map", path, "-o", tmp_path / "map.nii.gz", "--voxels", "phi", "-q")
    written = nibabel.load(tmp_path / "map.nii.gz")
    made = surfometry.voxel_maps(nibabel.load(path), quantities="phi")["phi"]
    assert np.array_equal(np.asanyarray(made.dataobj), np.asanyarray(written.dataobj))
    assert np.array_equal(made.affine, written.affine)


def test_numbers_do_not_depend_on_threads():
    one, two = (surfometry.measure(turned_body(), SPACING, threads=n) for n in (1, 2))
    assert one == two


def test_the_command_line_comes_along(tmp_path):
    import subprocess
    import sys

    arguments = ["measure", PHANTOMS[0], "--format", "csv"]
    ours = subprocess.run([sys.executable, "-m", "surfometry", *arguments], capture_output=True, text=True, check=True)
    shown = [line.rsplit(",", 3)[0] for line in ours.stdout.splitlines()]
    assert shown and len(shown) == len(command_line(*arguments).splitlines())
    wrong = subprocess.run([sys.executable, "-m", "surfometry", "measure", "none.nii"], capture_output=True, check=False)
    assert wrong.returncode == 1
