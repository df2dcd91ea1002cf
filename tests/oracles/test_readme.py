"""The README's commands, literally: each line that begins with `$ surfometry` is run by a shell, on files that built-in shapes stand in for."""

import os
import pathlib
import re
import shlex
import shutil
import subprocess

import numpy as np
import pytest

from conftest import BINARY, ROOT, surfometry

README = (ROOT / "README.md").read_text(encoding="utf-8")
COMMANDS = re.findall(r"^\$ (surfometry .*)$", README, re.MULTILINE)
BONE = "ball?radius=12&shift=0.3,0.2,0.1"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The files that the README's commands name."""
    place = tmp_path_factory.mktemp("readme")
    for name in ("bone", "scan", "scan1", "part", "later"):
        surfometry("phantom", BONE, "-o", place / f"{name}.nii.gz")
    (place / "scans").mkdir()
    for number in range(3):
        shutil.copy(place / "scan.nii.gz", place / "scans" / f"{number}.nii.gz")
    labels = np.zeros((24, 30, 60), np.uint8)
    for number, label in enumerate((20, 21, 22)):
        labels[6:18, 6:22, 4 + 18 * number : 16 + 18 * number] = label
    np.save(place / "array.npy", labels)
    import SimpleITK as sitk

    for name in ("scan2.mha", "big.mha", "vertebrae.nii.gz"):
        sitk.WriteImage(sitk.GetImageFromArray(labels), str(place / name))
    sitk.WriteImage(sitk.GetImageFromArray(np.where(labels == 21, 700, -1000).astype(np.int16)), str(place / "ct.nii.gz"))
    scan = sitk.ReadImage(str(place / "scan.nii.gz"))
    z = np.indices(sitk.GetArrayViewFromImage(scan).shape)[0]
    for name, voxels in (("dose", z.astype(np.float32)), ("zones", (1 + z // 10).astype(np.uint8))):
        image = sitk.GetImageFromArray(voxels)
        image.CopyInformation(scan)
        sitk.WriteImage(image, str(place / f"{name}.nii.gz"))
    import zarr

    mask = np.zeros((83, 50, 80), np.uint8)
    mask[20:60, 10:40, 15:65] = 1
    mask.tofile(place / "mask.raw")
    image = zarr.open_group(str(place / "image.zarr"), mode="w", zarr_format=2)
    axes = [{"name": name, "type": "space", "unit": "millimeter"} for name in "zyx"]
    datasets = [{"path": "0", "coordinateTransformations": [{"type": "scale", "scale": [2.5, 2, 1.5]}]}]
    image.create_group("labels").attrs["labels"] = ["nuclei"]
    nuclei = image["labels"].create_group("nuclei")
    nuclei.create_array("0", data=mask, chunks=(32, 32, 32))
    nuclei.attrs["multiscales"] = [{"version": "0.4", "axes": axes, "datasets": datasets}]
    nuclei.attrs["image-label"] = {"version": "0.4"}
    surfometry("map", f"phantom:{BONE}", "-o", place / "bone.stl", "-q")
    surfometry("map", f"phantom:{BONE}", "-o", place / "phi.nii.gz", "--voxels", "phi", "-q")
    sitk.WriteImage(sitk.ReadImage(str(place / "phi.nii.gz")), str(place / "phi.nrrd"))
    for name, radius in (("ours", 12), ("theirs", 12.5)):
        inputs = [f"phantom:ball?radius={radius + n}" for n in range(4)]
        surfometry("measure", *inputs, "-o", place / f"{name}.csv")
        table = (place / f"{name}.csv").read_text().replace(f"radius={radius}", "radius=12")
        for n in range(4):
            table = table.replace(f"phantom:ball?radius={radius + n}", f"scan{n}.nii.gz")
        (place / f"{name}.csv").write_text(table)
    return place


def test_there_are_commands():
    assert len(COMMANDS) > 10


# A cohort of a hundred bones takes minutes: of each kind one is asked for instead. The zoo takes one shape.
SHORTER = {"cohort -o cohort": "cohort -o cohort --femurs 0 --vertebrae 1", "surfometry validate  ": "surfometry validate --shape torus --poses 1 --resolutions 10 --ratios 1 "}


@pytest.mark.parametrize("command", COMMANDS)
def test_command_runs(folder, command):
    for long, short in SHORTER.items():
        command = command.replace(long, short)
    environment = {**os.environ, "PATH": f"{pathlib.Path(BINARY).parent}:{os.environ['PATH']}"}
    done = subprocess.run(command, shell=True, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    words = shlex.split(command, comments=True)
    for option in ("-o", "--png", "--chart"):
        for at, word in enumerate(words[:-1]):
            if word == option:
                # Where there are several quantities, their names go before the ending.
                stem, _, ending = words[at + 1].partition(".")
                assert list(folder.glob(f"{stem}*{ending}")), words[at + 1]
