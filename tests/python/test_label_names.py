"""Names of labels: of the caller, of a table in a file, of a folder of masks; and objects that are chosen by them."""

import json

import nibabel as nib
import numpy as np
import pytest
from conftest import numbers

import surfometry

SPACING = (1.3, 0.9, 0.8)
NAMES = {2: "Liver", 5: "kidney, left"}


def image():
    voxels = np.zeros((20, 22, 34), np.uint8)
    voxels[5:14, 5:16, 4:13], voxels[4:15, 5:16, 19:29] = 2, 5
    return voxels


@pytest.mark.parametrize("names", [NAMES, "file"])
def test_objects_are_chosen_by_name(tmp_path, names):
    if names == "file":
        names = tmp_path / "dataset.json"
        names.write_text(json.dumps({"labels": {"background": 0, "Liver": 2, "kidney, left": 5, "both": [2, 5]}}))
    by_name = surfometry.measure(image(), SPACING, label="liver", names=names)
    assert (by_name.label, by_name.name) == (2, "Liver")
    assert numbers(by_name) | {"name": None} == numbers(surfometry.measure(image(), SPACING, label=2))
    both = surfometry.measure(image(), SPACING, label=(2, "'kidney, left'"), names=names)
    assert numbers(both) | {"name": None} == numbers(surfometry.measure(image(), SPACING, label=(2, 5)))
    table = surfometry.measure_labels(image(), SPACING, names=names, sigma={"Liver": 1.5, "all": 2}, as_frame=False)
    assert (table["name"], table["parameters_sigma_mm"]) == (["Liver", "kidney, left"], [1.5, 2.0])


def test_names_for_a_file(tmp_path):
    path = tmp_path / "a.nii.gz"
    nib.save(nib.Nifti1Image(image().T, np.diag([*SPACING[::-1], 1])), path)
    assert surfometry.measure(path, label="Liver", names=NAMES).name == "Liver"
    (record, *_) = surfometry.reference(path, label="'kidney, left'", names=NAMES, methods=["voxels"])
    assert record["name"] == "kidney, left"
    found = surfometry.cohort([path], tmp_path / "t.csv", label="Liver", names=NAMES)
    assert found.rows == 1 and ",2,Liver," in (tmp_path / "t.csv").read_text()
    with pytest.raises(surfometry.InputError, match="did you mean Liver"):
        surfometry.measure(path, label="livver", names=NAMES)
    with pytest.raises(surfometry.ParameterError, match="FreeSurfer"):
        surfometry.measure(path, names={"liver": "x"})


def test_a_folder_of_masks(tmp_path):
    for label, name in NAMES.items():
        nib.save(nib.Nifti1Image((image() == label).T.astype(np.uint8), np.diag([*SPACING[::-1], 1])), tmp_path / f"{name}.nii.gz")
    table = surfometry.measure_labels(tmp_path, as_frame=False)
    assert table["name"] == ["Liver", "kidney, left"]
    assert surfometry.read(tmp_path).label_names == {1: "Liver", 2: "kidney, left"}
