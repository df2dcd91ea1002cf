"""Files written by nibabel, SimpleITK, pynrrd and NumPy are read as those tools mean them, and ours as we do."""

import bz2
import itertools
import pathlib

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


def test_pairs_in_any_case_and_packing(tmp_path):
    image = labels("int16")
    nib.save(nib.Nifti1Pair(image, oblique()), tmp_path / "pair.img")
    parts = {ending: (tmp_path / f"pair.{ending}").read_bytes() for ending in ["hdr", "img"]}
    ways = {"": bytes, ".bz2": bz2.compress}
    for number, (of_header, of_image) in enumerate(itertools.product(ways, ways)):
        names = {"hdr": f"p{number}.hdr{of_header}", "img": f"p{number}.img{of_image}"}
        for part, packing in [("hdr", of_header), ("img", of_image)]:
            (tmp_path / names[part]).write_bytes(ways[packing](parts[part]))
        for name in names.values():
            check(tmp_path / name, image, oblique())
    for number, case in enumerate([str.capitalize, str.upper]):
        for part, data in parts.items():
            (tmp_path / f"Q{number}.{case(part)}").write_bytes(data)
        for part in parts:
            check(tmp_path / f"Q{number}.{case(part)}", image, oblique())


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


def nrrd_of(path, image, *fields):
    sizes = " ".join(map(str, image.shape))
    lines = ["NRRD0005", "type: uchar", f"dimension: {image.ndim}", f"sizes: {sizes}", "encoding: raw", *fields, "", ""]
    pathlib.Path(path).write_bytes("\n".join(lines).encode() + image.tobytes("F"))
    return path


@pytest.mark.parametrize("centers", [None, "cell cell cell", "node node node", "cell node ???"])
def test_where_a_nrrd_without_directions_lies(tmp_path, centers):
    """At its axis mins, or half a voxel on, as ITK has it."""
    image = labels("uint8")
    fields = ["spacings: 0.8 1 1.5", "axis mins: 10 -20 30.5", *([f"centers: {centers}"] if centers else [])]
    path = nrrd_of(tmp_path / "a.nrrd", image, *fields)
    affine = np.diag([0.8, 1, 1.5, 1])
    affine[:3, 3] = sitk.ReadImage(path).GetOrigin()
    check(path, image, LPS @ affine)
    nrrd_of(path, image, "spacings: 0.8 1 1.5", "axis mins: 10 nan 30.5")
    check(path, image, np.diag([-0.8, -1, 1.5, 1]))


def in_world(image):
    """An ITK image's affine, RAS."""
    affine = np.eye(4)
    affine[:3, :3] = np.reshape(image.GetDirection(), (3, 3)) * image.GetSpacing()
    affine[:3, 3] = image.GetOrigin()
    return LPS @ affine


@pytest.mark.parametrize("space", ["space dimension: 3", "space: 3D-right-handed", "space: scanner-xyz", "space: 3D-left-handed"])
def test_a_nrrd_that_does_not_say_where_the_patient_is(tmp_path, space):
    """As ITK has it, and so as its other formats have the same image."""
    image = labels("uint8")
    path = nrrd_of(tmp_path / "a.nrrd", image, space, "space directions: (0.8,0,0) (0,0,1.5) (0,1,0)", "space origin: (10,-5,7)")
    check(path, image, in_world(sitk.ReadImage(path)))


def test_itk_writes_a_series_of_one(tmp_path):
    """Its NRRD has no name of a space then."""
    image = labels("uint8")
    one = sitk.GetImageFromArray(image.T)
    one.SetSpacing((0.8, 1, 1.5))
    one.SetOrigin((10, -5, 7))
    for ending in ["nrrd", "mha", "nii"]:
        path = tmp_path / f"a.{ending}"
        sitk.WriteImage(sitk.JoinSeries([one]), path)
        check(path, image, in_world(one))


@pytest.mark.parametrize(
    "space, turn", [("RAST", [1, 1]), ("LPST", [-1, -1]), ("LAST", [-1, 1]), ("left-posterior-superior-time", [-1, -1])]
)
def test_a_nrrd_of_one_time(tmp_path, space, turn):
    image = labels("uint8")
    directions = "space directions: (0.8,0,0,0) (0,1,0,0) (0,0,1.5,0) (0,0,0,2)"
    fields = [f"space: {space}", directions, "space origin: (1,2,3,0)", 'space units: "mm" "mm" "mm" "s"']
    path = nrrd_of(tmp_path / "a.nrrd", image[..., None], *fields)
    affine = np.diag([*turn, 1, 1]) @ np.diag([0.8, 1, 1.5, 1])
    affine[:3, 3] = [turn[0], 2 * turn[1], 3]
    check(path, image, affine)
    times = ["spacings: 800 1000 1500 nan", 'units: "um" "um" "um" "s"', "kinds: domain domain domain time"]
    check(nrrd_of(path, image[..., None], *times), image, np.diag([-0.8, -1, 1.5, 1]))


def test_metaimage_with_colons(tmp_path):
    image = labels("uint8")
    sizes = " ".join(map(str, image.shape))
    lines = ["ObjectType: Image", "NDims: 3", f"DimSize: {sizes}", "ElementSpacing = 0.8 1 1.5", "ElementType: MET_UCHAR", "ElementDataFile: LOCAL"]
    (tmp_path / "a.mha").write_bytes("\n".join([*lines, ""]).encode() + image.tobytes("F"))
    read = sitk.ReadImage(tmp_path / "a.mha")
    np.testing.assert_array_equal(sitk.GetArrayFromImage(read).T, image)
    check(tmp_path / "a.mha", image, np.diag([-0.8, -1, 1.5, 1]))


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
