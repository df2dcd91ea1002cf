"""Files written by nibabel, SimpleITK, pynrrd and NumPy are read as those tools mean them, and ours as we do."""

import nibabel as nib
import nrrd
import numpy as np
import pytest
import SimpleITK as sitk
from conftest import affine_of, info, lumpy, needs_data, DATA, surfometry

LPS = np.diag([-1.0, -1.0, 1.0, 1.0])


def labels(dtype):
    """A small label image, not symmetric in anything, with labels that need the type."""
    image = lumpy((17, 19, 23), seed=5).astype(dtype)
    image[2:5, 3:4, 4:9] = 100 if np.dtype(dtype).itemsize == 1 else 1000
    return image


def oblique(handedness=1.0):
    """An affine with a rotation, three spacings and an offset."""
    angle = 0.4
    rotation = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, handedness]]
    )
    tilt = np.array([[1, 0, 0], [0, np.cos(0.3), -np.sin(0.3)], [0, np.sin(0.3), np.cos(0.3)]])
    affine = np.eye(4)
    affine[:3, :3] = tilt @ rotation @ np.diag([0.7, 1.1, 1.9])
    affine[:3, 3] = [12.5, -40.25, 7.0]
    return affine


def check(path, image, affine, *options, tolerance=1e-5):
    """The file holds these labels, at these places."""
    document = info(path, *options)
    assert document["dimensions"] == list(image.shape)
    if affine is not None:
        np.testing.assert_allclose(affine_of(document), affine, atol=tolerance)
    counted = {entry["label"]: entry for entry in document["labels"]}
    values, counts = np.unique(image[image != 0], return_counts=True)
    assert {int(v): int(n) for v, n in zip(values, counts)} == {k: e["voxels"] for k, e in counted.items()}
    for value in values:
        where = np.argwhere(image == value)
        box = counted[int(value)]["bounding_box"]
        assert box == [where.min(axis=0).tolist(), where.max(axis=0).tolist()]


TYPES = ["uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "int64", "float32", "float64"]


@pytest.mark.parametrize("dtype", TYPES)
@pytest.mark.parametrize("kind", [nib.Nifti1Image, nib.Nifti2Image])
def test_nibabel(tmp_path, dtype, kind):
    image = labels(dtype)
    written = kind(image, oblique(), dtype=np.dtype(dtype))
    for name in ["a.nii", "a.nii.gz"]:
        nib.save(written, tmp_path / name)
        check(tmp_path / name, image, oblique())


@pytest.mark.parametrize("handedness", [1.0, -1.0])
def test_nibabel_qform_only_pair_and_big_endian(tmp_path, handedness):
    image = labels("int16")
    qform = nib.Nifti1Image(image, None)
    qform.set_qform(oblique(handedness), code=1)
    qform.set_sform(None, code=0)
    nib.save(qform, tmp_path / "q.nii.gz")
    check(tmp_path / "q.nii.gz", image, oblique(handedness))
    nib.save(nib.Nifti1Pair(image, oblique(handedness)), tmp_path / "pair.img")
    check(tmp_path / "pair.hdr", image, oblique(handedness))
    check(tmp_path / "pair.img", image, oblique(handedness))
    header = nib.Nifti1Header(endianness=">")
    header.set_data_dtype(">i2")
    nib.save(nib.Nifti1Image(image.astype(">i2"), oblique(handedness), header), tmp_path / "big.nii")
    check(tmp_path / "big.nii", image, oblique(handedness))


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("name", ["a.mha", "a.mhd", "a.nrrd", "a.nii.gz"])
def test_simpleitk(tmp_path, name, compressed):
    for dtype in ["uint8", "int16", "uint32", "float32", "float64"]:
        image = labels(dtype)
        itk = sitk.GetImageFromArray(image.transpose(2, 1, 0))
        affine = LPS @ oblique()
        spacing = np.linalg.norm(affine[:3, :3], axis=0)
        itk.SetSpacing(spacing.tolist())
        itk.SetDirection((affine[:3, :3] / spacing).ravel().tolist())
        itk.SetOrigin(affine[:3, 3].tolist())
        sitk.WriteImage(itk, str(tmp_path / name), useCompression=compressed)
        check(tmp_path / name, image, oblique())


@pytest.mark.parametrize("encoding", ["raw", "gzip", "bzip2"])
@pytest.mark.parametrize("detached", [False, True])
def test_pynrrd(tmp_path, encoding, detached):
    image = labels("uint16")
    affine = LPS @ oblique()
    header = {
        "space": "left-posterior-superior",
        "space directions": affine[:3, :3].T,
        "space origin": affine[:3, 3],
        "encoding": encoding,
    }
    name = tmp_path / ("a.nhdr" if detached else "a.nrrd")
    nrrd.write(str(name), image, header, detached_header=detached)
    check(name, image, oblique())
    micron = {**header, "space directions": affine[:3, :3].T * 1000, "space origin": affine[:3, 3] * 1000}
    micron["space units"] = ["um", "um", "um"]
    nrrd.write(str(name), image, micron, detached_header=detached)
    check(name, image, oblique())


@pytest.mark.parametrize("order", ["C", "F"])
def test_numpy(tmp_path, order):
    for dtype in [*TYPES, "bool", ">i4"]:
        image = labels("int16" if dtype == "bool" else dtype)
        image = image.astype(dtype)
        # x is the fastest axis in memory: the last one in C order.
        stored = np.ascontiguousarray(image.transpose(2, 1, 0)) if order == "C" else np.asfortranarray(image)
        np.save(tmp_path / "a.npy", stored)
        expected = np.diag([0.5, 0.6, 0.7, 1.0])
        check(tmp_path / "a.npy", image.astype("int64"), expected, "--spacing", "0.5,0.6,0.7")


@pytest.mark.parametrize("name", ["p.nii", "p.nii.gz"])
def test_what_we_write_nibabel_reads(tmp_path, name):
    spec = "genus?genus=1&major=5&minor=3&rotate=20,30,40&spacing=0.5,0.6,0.7"
    surfometry("phantom", spec, "-o", tmp_path / name)
    image = nib.load(tmp_path / name)
    document = info(tmp_path / name)
    np.testing.assert_allclose(image.affine, affine_of(document), atol=1e-5)
    np.testing.assert_allclose(image.get_qform(), image.get_sform(), atol=1e-5)
    assert int(image.header["qform_code"]) == int(image.header["sform_code"]) == 1
    assert image.header.get_xyzt_units()[0] == "mm"
    voxels = np.asarray(image.dataobj)
    assert voxels.dtype == np.uint8
    assert int((voxels == 1).sum()) == document["labels"][0]["voxels"]
    assert sitk.ReadImage(str(tmp_path / name)).GetSize() == voxels.shape


@needs_data
def test_real_files_lie_where_nibabel_says():
    for path in sorted(DATA.glob("*/*.nii.gz")):
        if path.parent.name == "bad":
            continue
        image = nib.load(path)
        np.testing.assert_allclose(affine_of(info(path)), image.affine, atol=1e-4, err_msg=str(path))
        assert info(path)["axes"] == "".join(nib.aff2axcodes(image.affine))
