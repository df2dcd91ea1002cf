"""Segments that may overlap: 3D Slicer's layers, a folder of masks. Each is measured as its mask alone, to the bit."""

import nibabel as nib
import nrrd
import numpy as np
import pytest
from conftest import info, measure, surfometry
from test_label_names import numbers, surfometry_error

AFFINE = np.array([[0.0, -0.9, 0, 3], [0.8, 0, 0, -7], [0, 0, 1.3, 11], [0, 0, 0, 1]])
LPS = np.diag([-1.0, -1.0, 1.0, 1.0])
SHAPE = (37, 31, 24)


def masks():
    """A turned ellipsoid, one that overlaps it, one inside the first, and two that are the same."""
    x, y, z = np.meshgrid(*[np.arange(n) for n in SHAPE], indexing="ij")

    def ellipsoid(centre, radii):
        u, v, w = (x - centre[0]) * 0.8, (y - centre[1]) * 0.9, (z - centre[2]) * 1.3
        u, v = 0.9 * u + 0.436 * v, 0.9 * v - 0.436 * u
        return (u / radii[0]) ** 2 + (v / radii[1]) ** 2 + (w / radii[2]) ** 2 < 1

    shapes = {
        "liver": ellipsoid((13.3, 15.2, 11.7), (8.1, 9.6, 10.2)),
        "tumour": ellipsoid((22.1, 14.9, 12.2), (7.2, 8.1, 9.3)),
        "core": ellipsoid((13.1, 15.3, 11.2), (4.1, 5.2, 5.9)),
        "twin": ellipsoid((22.1, 14.9, 12.2), (7.2, 8.1, 9.3)),
    }
    return {name: mask.astype(np.uint8) for name, mask in shapes.items()}


def alone(tmp_path, mask, *options, nifti=False):
    """The mask in a file of its own, whose affine has the digits of the other's: single precision in NIfTI."""
    path = tmp_path / ("alone.nii.gz" if nifti else "alone.nrrd")
    if nifti:
        nib.save(nib.Nifti1Image(mask, AFFINE), path)
    else:
        lps = LPS @ AFFINE
        fields = {"space": "left-posterior-superior", "space directions": lps[:3, :3].T, "space origin": lps[:3, 3]}
        nrrd.write(str(path), mask, fields)
    return measure(path, *options)


def check_each(tmp_path, path, names, *options, nifti=False):
    """The input has these objects, each of which measures as its mask alone."""
    found = measure(path, *options)
    shapes = masks()
    assert {record["name"] for record in found} == set(names)
    for record in found:
        assert numbers([record]) == numbers(alone(tmp_path, shapes[record["name"]], *options, nifti=nifti))
    return found


def layered(path, layers, segments, **more):
    """As 3D Slicer writes layers: a `list` axis in front."""
    directions = (LPS[:3, :3] @ AFFINE[:3, :3]).T
    fields = {"space": "left-posterior-superior", "kinds": ["list", "domain", "domain", "domain"], "encoding": "gzip"}
    fields["space directions"] = np.vstack([[np.nan] * 3, directions])
    fields["space origin"] = (LPS @ AFFINE)[:3, 3]
    for number, (name, layer, label) in enumerate(segments):
        fields |= {f"Segment{number}_Name": name, f"Segment{number}_Layer": str(layer)}
        fields |= {f"Segment{number}_LabelValue": str(label), f"Segment{number}_Color": "0 1 0.2"}
    nrrd.write(str(path), np.stack(layers), fields | more)
    return path


def slicer_file(path, dtype=np.uint8):
    """Three layers; the same label means another segment in each."""
    shapes = masks()
    first = np.where(shapes["liver"], 1, 0)
    second = np.where(shapes["tumour"], 1, np.where(shapes["core"], 2, 0))
    layers = [layer.astype(dtype) for layer in (first, second, 3 * shapes["twin"])]
    return layered(path, layers, [("liver", 0, 1), ("core", 1, 2), ("tumour", 1, 1), ("twin", 2, 3)])


@pytest.mark.parametrize("dtype", [np.uint8, ">i2", np.float32])
def test_layers_of_slicer(tmp_path, dtype):
    path = slicer_file(tmp_path / "a.seg.nrrd", dtype)
    shapes = masks()
    # The tumour hides part of the core in their layer.
    shapes["core"] *= 1 - shapes["tumour"]
    found = measure(path)
    assert [(record["label"], record["name"]) for record in found] == [(1, "liver"), (2, "core"), (3, "tumour"), (4, "twin")]
    for record in found:
        assert numbers([record]) == numbers(alone(tmp_path, shapes[record["name"]]))
    document = info(path)
    counted = {entry["name"]: (entry["voxels"], entry["colour"]) for entry in document["labels"]}
    assert counted == {name: (int(mask.sum()), "#00ff33") for name, mask in shapes.items()}


def test_labels_of_their_own_stay(tmp_path):
    shapes = masks()
    layers = [7 * shapes["liver"], 12 * shapes["tumour"]]
    path = layered(tmp_path / "a.seg.nrrd", layers, [("liver", 0, 7), ("tumour", 1, 12)])
    assert [record["label"] for record in check_each(tmp_path, path, ["liver", "tumour"])] == [7, 12]
    (union,) = measure(path, "--label", "7+tumour")
    assert numbers([union]) == numbers(alone(tmp_path, shapes["liver"] | shapes["tumour"]))
    by_name = measure(path, "--label", "tumour,liver", "--sigma", "1,liver=1.5")
    assert numbers(by_name[1:]) == numbers(alone(tmp_path, shapes["liver"], "--sigma", "1.5"))


def test_old_files_have_a_layer_each_and_say_nothing(tmp_path):
    shapes = masks()
    segments = [("liver", 0, 1), ("tumour", 1, 1)]
    path = layered(tmp_path / "a.seg.nrrd", [shapes["liver"], shapes["tumour"]], segments)
    text = path.read_bytes().partition(b"\n\n")
    lines = [line for line in text[0].split(b"\n") if b"_Layer" not in line and b"_LabelValue" not in line]
    path.write_bytes(b"\n".join(lines) + text[1] + text[2])
    assert [record["label"] for record in check_each(tmp_path, path, ["liver", "tumour"])] == [1, 2]


def test_a_file_of_one_voxel_has_no_segments(tmp_path):
    fields = {"space": "left-posterior-superior", "space directions": np.eye(3), "Segmentation_MasterRepresentation": "Binary labelmap"}
    nrrd.write(str(tmp_path / "a.seg.nrrd"), np.zeros((1, 1, 1), np.uint8), fields)
    assert "without segments" in surfometry_error("measure", tmp_path / "a.seg.nrrd")


def test_a_label_without_a_segment_is_refused(tmp_path):
    shapes = masks()
    path = layered(tmp_path / "a.seg.nrrd", [shapes["liver"], 5 * shapes["tumour"]], [("liver", 0, 1), ("tumour", 1, 1)])
    assert "label 5 in layer 1" in surfometry_error("measure", path)


@pytest.mark.parametrize("layers", [1, 2])
def test_a_cropped_file_is_not_cut(tmp_path, layers):
    """A file that ends where its segments do; the image that it was made on went on, but not in front along x."""
    liver = masks()["liver"]
    box = tuple(slice(where.min(), where.max() + 1) for where in np.nonzero(liver))
    cropped, first = liver[box], [side.start for side in box]
    geometry = ";".join(map(str, np.eye(4).ravel())) + f";{first[0]};99;0;99;0;{first[2] + cropped.shape[2] - 1};"
    more = {
        "Segmentation_ReferenceImageExtentOffset": " ".join(map(str, first)),
        "Segmentation_ConversionParameters": f"Collapse labelmaps|1|Merge&Reference image geometry|{geometry}|Whole&x|1|",
    }
    if layers == 1:
        fields = {"space": "left-posterior-superior", "space directions": AFFINE[:3, :3].T, "space origin": [1.0, 2, 3]}
        fields |= {"Segment0_Name": "liver", "Segment0_LabelValue": "1", **more}
        nrrd.write(str(tmp_path / "a.seg.nrrd"), cropped, fields)
    else:
        layered(tmp_path / "a.seg.nrrd", [cropped, 0 * cropped], [("liver", 0, 1), ("none", 1, 1)], **more)
    document = info(tmp_path / "a.seg.nrrd")
    # One voxel of background where the image went on: behind along x, both along y, in front along z.
    assert document["dimensions"] == [cropped.shape[0] + 1, cropped.shape[1] + 2, cropped.shape[2] + 1]
    assert document["labels"][0]["bounding_box"][0] == [0, 1, 1]
    origin = np.array(document["affine_ras_mm"]["origin"]) + np.array(document["affine_ras_mm"]["linear"]) @ [0, 1, 1]
    expected = [-1, -2, 3] if layers == 1 else AFFINE[:3, 3]
    np.testing.assert_allclose(origin, expected, atol=1e-6)
    (record,) = measure(tmp_path / "a.seg.nrrd", "--sigma", "1.5")
    (whole,) = alone(tmp_path, liver, "--sigma", "1.5")
    # The object is the same; the image that it was cropped of really ends at two of its sides.
    assert record["voxels"]["count"] == whole["voxels"]["count"]
    assert "touches-border" in [flag["code"] for flag in record["flags"]]
    del more["Segmentation_ConversionParameters"]
    layered(tmp_path / "b.seg.nrrd", [cropped, 0 * cropped], [("liver", 0, 1), ("none", 1, 1)], **more)
    (record,) = measure(tmp_path / "b.seg.nrrd", "--sigma", "1.5")
    assert "touches-border" not in [flag["code"] for flag in record["flags"]]
    np.testing.assert_allclose(record["surface_area_mm2"], whole["surface_area_mm2"], rtol=1e-9)


def folder_of_masks(folder, shapes, ending=".nii.gz", affine=AFFINE):
    folder.mkdir()
    for name, mask in shapes.items():
        nib.save(nib.Nifti1Image(mask, affine), folder / f"{name}{ending}")
    (folder / "statistics.json").write_text("{}")
    (folder / ".hidden.nii.gz").write_bytes(b"")
    return folder


@pytest.mark.parametrize("ending", [".nii.gz", ".hdr", ".nii"])
def test_a_folder_of_masks(tmp_path, ending):
    shapes = masks() | {"nothing": np.zeros(SHAPE, np.uint8)}
    if ending == ".hdr":
        folder = tmp_path / "segmentations"
        folder.mkdir()
        for name, mask in shapes.items():
            nib.save(nib.Nifti1Pair(mask, AFFINE), folder / f"{name}.hdr")
    else:
        folder = folder_of_masks(tmp_path / "segmentations", shapes, ending)
    found = check_each(tmp_path, folder, set(shapes) - {"nothing"}, nifti=True)
    assert [(record["label"], record["name"]) for record in found] == [(1, "core"), (2, "liver"), (4, "tumour"), (5, "twin")]
    assert info(folder)["format"] == "masks"
    assert "`nothing` (label 3) has no voxels" in surfometry_error("measure", folder, "--label", "nothing")
    surfometry("map", folder, "-o", tmp_path / "m.ply", "--label", "core,liver", "--sigma", "1.5")
    assert {file.name for file in tmp_path.glob("*.ply")} == {"m_core.ply", "m_liver.ply"}
    surfometry("report", folder, "-o", tmp_path / "r.html", "--label", "core")


def test_empty_masks_are_named(tmp_path):
    folder = folder_of_masks(tmp_path / "s", {"liver": masks()["liver"], "void": np.zeros(SHAPE, np.uint8)})
    import subprocess

    from conftest import BINARY

    done = subprocess.run([str(BINARY), "measure", str(folder)], capture_output=True, text=True, check=True)
    assert "without voxels, and so without results: void" in done.stderr


def test_folders_that_are_not_masks_of_one_image(tmp_path):
    shapes = masks()
    folder = folder_of_masks(tmp_path / "a", {"liver": shapes["liver"], "two": shapes["liver"] + shapes["core"]})
    error = surfometry_error("measure", folder)
    assert "two.nii.gz" in error and "labels 1 and 2" in error
    folder = folder_of_masks(tmp_path / "b", {"liver": shapes["liver"]})
    moved = AFFINE.copy()
    moved[0, 3] += 1
    nib.save(nib.Nifti1Image(shapes["core"], moved), folder / "other.nii.gz")
    error = surfometry_error("measure", folder)
    assert "other.nii.gz" in error and "another lattice" in error
    (tmp_path / "c").mkdir()
    assert "without slices, masks or DICOM files" in surfometry_error("measure", tmp_path / "c")
    folder = folder_of_masks(tmp_path / "d", {"liver": shapes["liver"]})
    whole = (folder / "liver.nii.gz").read_bytes()
    (folder / "liver.nii.gz").write_bytes(whole[: len(whole) // 2])
    assert "liver.nii.gz" in surfometry_error("measure", folder)


def test_threads_and_order_change_nothing(tmp_path, monkeypatch):
    path = slicer_file(tmp_path / "a.seg.nrrd")
    one, all_ = measure(path, "--threads", "1"), measure(path)
    assert numbers(one) == numbers(all_)
