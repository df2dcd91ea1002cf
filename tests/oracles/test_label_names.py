"""Names of labels as other programs write them, in images and beside them, and what they are good for."""

import json
import pathlib

import nibabel as nib
import nrrd
import numpy as np
import pytest
from conftest import info, measure, surfometry

AFFINE = np.array([[0.0, -0.9, 0, 3], [0.8, 0, 0, -7], [0, 0, 1.3, 11], [0, 0, 0, 1]])
NAMES = {2: "Liver", 5: "kidney, left", 9: "spleen"}


def image():
    """Three boxes of different sizes."""
    voxels = np.zeros((40, 24, 22), np.uint8)
    voxels[4:12, 5:15, 6:15], voxels[16:24, 5:16, 6:16], voxels[28:36, 5:17, 6:17] = 2, 5, 9
    return voxels


def caret(names, code=0):
    """The extension of `TotalSegmentator --ml` and of Connectome Workbench."""
    label = '<Label Key="{}" Red="{}" Green="0.5" Blue="0" Alpha="1"><![CDATA[{}]]></Label>'
    rows = "\n".join(label.format(key, key / 10, name) for key, name in names.items())
    text = f'<?xml version="1.0" encoding="UTF-8"?> <CaretExtension>  <Date><![CDATA[2013-07-14T05:45:09]]></Date>   <VolumeInformation Index="0">   <LabelTable>\n{rows}\n</LabelTable> <VolumeType><![CDATA[Label]]></VolumeType>   </VolumeInformation></CaretExtension>'
    return nib.nifti1.Nifti1Extension(code, text.encode())


def nifti(path, extensions, kind=nib.Nifti1Image):
    written = kind(image(), AFFINE)
    written.header.extensions.extend(extensions)
    nib.save(written, path)
    return path


def names_of(path, *options):
    return {entry["label"]: entry["name"] for entry in info(path, *options)["labels"]}


@pytest.mark.parametrize("name", ["a.nii", "a.nii.gz", "a.hdr"])
@pytest.mark.parametrize("kind", [nib.Nifti1Image, nib.Nifti2Image])
@pytest.mark.parametrize("code", [0, 30])
def test_caret_label_table(tmp_path, name, kind, code):
    others = [nib.nifti1.Nifti1Extension(6, b"a comment"), nib.nifti1.Nifti1Extension(4, b"<a><LabelTable/>")]
    pair = {nib.Nifti1Image: nib.Nifti1Pair, nib.Nifti2Image: nib.Nifti2Pair}
    kind = pair[kind] if name.endswith("hdr") else kind
    path = nifti(tmp_path / name, [*others, caret(NAMES, code)], kind)
    assert names_of(path) == NAMES
    assert [entry["colour"] for entry in info(path)["labels"]] == ["#338000", "#808000", "#e68000"]


def test_a_label_with_two_names_in_an_image(tmp_path):
    """As in a table beside it."""
    twice = caret(NAMES).get_content()
    for name, refused in [(b"Liver", False), (b"lung", True)]:
        row = b'<Label Key="2" Red="0" Green="0" Blue="0" Alpha="1"><![CDATA[' + name + b"]]></Label>\n</LabelTable>"
        path = nifti(tmp_path / "a.nii", [nib.nifti1.Nifti1Extension(0, twice.replace(b"</LabelTable>", row))])
        if refused:
            error = surfometry_error("info", path)
            assert "label 2 has two names, `Liver` (entry 1) and `lung` (entry 4)" in error and "-volume-label-import" in error
        else:
            assert names_of(path) == NAMES


def test_broken_extensions_leave_the_numbers(tmp_path):
    path = nifti(tmp_path / "a.nii", [caret(NAMES)])
    whole = path.read_bytes()
    for at, bytes_ in [(352, b"\xff\xff\xff\x7f"), (352, b"\0\0\0\0"), (370, b"<<<<"), (356, b"\x10\0\0\0")]:
        path.write_bytes(whole[:at] + bytes_ + whole[at + len(bytes_) :])
        assert set(names_of(path)) == {2, 5, 9}


def segmentation(path, **changes):
    """As 3D Slicer writes it: LPS, a field a line, in an order of its own."""
    fields = {"space": "left-posterior-superior", "space directions": (np.diag([-1, -1, 1]) @ AFFINE[:3, :3]).T}
    fields |= {"space origin": np.diag([-1, -1, 1]) @ AFFINE[:3, 3], "encoding": "gzip"}
    for number, (label, name) in enumerate(NAMES.items()):
        fields |= {f"Segment{number}_Name": name, f"Segment{number}_LabelValue": str(label)}
        fields |= {f"Segment{number}_Color": "1 0.5 0", f"Segment{number}_Layer": "0"}
    fields |= {key: value for key, value in changes.items() if value is not None}
    fields = {key: value for key, value in fields.items() if changes.get(key, value) is not None}
    nrrd.write(str(path), image(), fields, custom_field_map={})
    return path


def test_slicer_segmentation(tmp_path):
    path = segmentation(tmp_path / "a.seg.nrrd")
    assert names_of(path) == NAMES
    assert info(path)["labels"][0]["colour"] == "#ff8000"
    # A colour or a name that is missing takes nothing else along.
    path = segmentation(tmp_path / "b.seg.nrrd", Segment1_Color=None, Segment2_Name=None, Segment0_Layer=None)
    assert names_of(path) == {2: "Liver", 5: "kidney, left", 9: None}


TABLES = {
    "dataset.json": json.dumps({"labels": {"background": 0, "Liver": 2, "kidney, left": [5], "spleen": 9}}),
    "old.json": json.dumps({"labels": {"0": "background", "2": "Liver", "5": "kidney, left", "9": "spleen"}}),
    "plain.json": json.dumps({"2": "Liver", "5": "kidney, left", "9": "spleen"}),
    "a.csv": 'label,name\n2,Liver\n5,"kidney, left"\n9,spleen\n',
    "a.tsv": "index\tname\tcolor\n2\tLiver\t#ff0000\n5\tkidney, left\t#00ff00\n9\tspleen\t#0000ff\n",
    "itksnap.txt": '# ITK-SnAP\n 0 0 0 0 0 0 0 "Clear Label"\n 2 255 0 0 1 1 1 "Liver"\n 5 0 255 0 1 1 1 "kidney, left"\n 9 0 0 255 1 1 1 "spleen"\n',
}


@pytest.mark.parametrize("table", TABLES)
def test_tables_beside_the_image(tmp_path, table):
    path = nifti(tmp_path / "a.nii.gz", [caret({2: "old", 7: "absent"})])
    (tmp_path / table).write_text(TABLES[table])
    assert names_of(path, "--names", tmp_path / table) == NAMES
    records = measure(path, "--names", tmp_path / table)
    assert {record["label"]: record["name"] for record in records} == NAMES


def test_a_table_of_freesurfer_wins_label_by_label(tmp_path):
    path = nifti(tmp_path / "a.nii.gz", [caret(NAMES)])
    (tmp_path / "lut.txt").write_text("#No. Label Name: R G B A\n0 Unknown 0 0 0 0\n2 Left-Hepar 1 2 3 0\n")
    assert names_of(path, "--names", tmp_path / "lut.txt") == NAMES | {2: "Left-Hepar"}
    assert info(path, "--names", tmp_path / "lut.txt")["labels"][0]["colour"] == "#010203"


COLOURED = {
    "slicer.csv": 'LabelValue,Name,Color_R,Color_G,Color_B,Color_A,Segmented property category\n2,Liver,221,130,101,255,\n5,"kidney, left",185,102,83,255,\n9,spleen,157,108,162,255,\n',
    "short.csv": 'label,name,R,G,B\n2,Liver,221,130,101\n5,"kidney, left",185,102,83\n9,spleen,157,108,162\n',
    "words.tsv": "Red\tGreen\tBlue\tName\tLabel\n221\t130\t101\tLiver\t2\n185\t102\t83\tkidney, left\t5\n157\t108\t162\tspleen\t9\n",
    "slicer.txt": '# Color table\n2 "Liver" 221 130 101 255\n5 "kidney, left" 185 102 83 255\n9 spleen 157 108 162 255\n',
}


@pytest.mark.parametrize("table", COLOURED)
def test_colours_of_tables(tmp_path, table):
    path = nifti(tmp_path / "a.nii.gz", [])
    (tmp_path / table).write_text(COLOURED[table])
    assert names_of(path, "--names", tmp_path / table) == NAMES
    colours = [entry["colour"] for entry in info(path, "--names", tmp_path / table)["labels"]]
    assert colours == ["#dd8265", "#b96653", "#9d6ca2"]


@pytest.mark.parametrize("text", ["", "nonsense\n", "{}", '{"labels": 3}', '{"liver": "x"}', "label,name\nx,liver\n", "\0\1\2"])
def test_what_is_no_table_is_refused_with_what_is_expected(tmp_path, text):
    path = nifti(tmp_path / "a.nii.gz", [])
    (tmp_path / "names").write_text(text)
    done = surfometry_error("info", path, "--names", tmp_path / "names")
    assert str(tmp_path / "names") in done and "FreeSurfer" in done


def surfometry_error(*arguments):
    import subprocess

    from conftest import BINARY

    done = subprocess.run([str(BINARY), *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode != 0
    return done.stderr


def numbers(records):
    drop = ("seconds", "read_seconds", "name", "label", "input", "input_sha256")
    return [{key: value for key, value in record.items() if key not in drop} for record in records]


def test_labels_are_chosen_by_name(tmp_path):
    path = nifti(tmp_path / "a.nii.gz", [caret(NAMES)])
    (by_name,), (by_number,) = measure(path, "--label", "liver"), measure(path, "--label", "2")
    assert by_name["label"] == 2 and by_name["name"] == "Liver"
    assert numbers([by_name]) == numbers([by_number])
    united = measure(path, "--label", "9,'kidney, left'+Liver")
    assert [(record["label"], record["name"]) for record in united] == [(9, "spleen"), ("5+2", "kidney, left + Liver")]
    assert numbers(united) == numbers(measure(path, "--label", "9,5+2"))
    by_name = measure(path, "--sigma", "2,spleen=1.5,'kidney, left'=auto")
    assert numbers(by_name) == numbers(measure(path, "--sigma", "2,9=1.5,5=auto"))


def test_regions_of_nnunet_are_unions(tmp_path):
    path = nifti(tmp_path / "a.nii.gz", [])
    labels = {"background": 0, "whole tumor": [2, 5, 9], "core": [5, 9], "enhancing": 9}
    (tmp_path / "dataset.json").write_text(json.dumps({"labels": labels, "regions_class_order": [2, 5, 9]}))
    names = ("--names", tmp_path / "dataset.json")
    (region,) = measure(path, *names, "--label", "whole tumor")
    assert (region["label"], region["name"]) == ("2+5+9", "whole tumor")
    assert numbers([region]) == numbers(measure(path, "--label", "2+5+9"))


def test_names_that_no_label_has(tmp_path):
    path = nifti(tmp_path / "a.nii.gz", [caret(NAMES | {11: "heart", 12: "LIVER"})])
    assert "did you mean spleen?" in surfometry_error("measure", path, "--label", "spleeen")
    assert "did you mean 'kidney, left'?" in surfometry_error("measure", path, "--label", "kidney")
    # As written, before other cases; in other cases only where one name is meant.
    assert measure(path, "--label", "Liver")[0]["label"] == 2
    assert "labels 2 and 12" in surfometry_error("measure", path, "--label", "lIVER")
    assert "`heart` (label 11) has no voxels" in surfometry_error("measure", path, "--label", "heart")
    plain = nifti(tmp_path / "b.nii.gz", [])
    assert "--names FILE" in surfometry_error("measure", plain, "--label", "liver")
    # The cure works.
    (tmp_path / "names.csv").write_text("2,liver\n")
    assert measure(plain, "--label", "liver", "--names", tmp_path / "names.csv")[0]["label"] == 2


def test_names_in_tables_files_and_pages(tmp_path):
    path = nifti(tmp_path / "a.nii.gz", [caret(NAMES | {9: "a/b\x07*"})])
    text = surfometry("measure", path)
    assert "2 Liver" in text and "5 kidney, left" in text and "\x07" not in text
    surfometry("map", path, "-o", tmp_path / "m.ply", "--sigma", "1.5")
    assert {file.name for file in tmp_path.glob("*.ply")} == {"m_Liver.ply", "m_kidney-left.ply", "m_a-b.ply"}
    (tmp_path / "same.csv").write_text("2,bone\n5,Bone\n")
    surfometry("map", path, "-o", tmp_path / "n.ply", "--names", tmp_path / "same.csv", "--sigma", "1.5")
    assert {file.name for file in tmp_path.glob("n*")} == {"n_label-2_bone.ply", "n_label-5_Bone.ply", "n_a-b.ply"}
    surfometry("report", path, "-o", tmp_path / "r.html", "--label", "Liver")
    page = (tmp_path / "r.html").read_text()
    assert "Liver" in page and '"#338000"' in page
    reference = json.loads(surfometry("reference", path, "--format", "json", "--label", "Liver"))["results"]
    assert {record["name"] for record in reference} == {"Liver"}


def test_a_run_goes_on_with_the_same_names_only(tmp_path):
    path, out = nifti(tmp_path / "a.nii.gz", [caret(NAMES)]), tmp_path / "r.csv"
    surfometry("measure", path, "--label", "Liver", "--resume", "-o", out)
    assert pathlib.Path(out).read_text().splitlines()[1].split(",")[1:3] == ["2", "Liver"]
