"""DICOM as pydicom and highdicom write it: series in any order, and segmentations of every kind, on an oblique lattice of three
spacings whose slices have no whole number of bytes of bits."""

import struct

import highdicom as hd
import nibabel as nib
import numpy as np
import pydicom
import pytest
from conftest import affine_of, info, lumpy, measure, oblique, surfometry
from pydicom.sr.codedict import codes
from pydicom.uid import (
    DeflatedExplicitVRLittleEndian,
    ExplicitVRBigEndian,
    ExplicitVRLittleEndian,
    ImplicitVRLittleEndian,
    generate_uid,
)
from test_label_names import numbers, surfometry_error

SHAPE = (33, 31, 27)
LPS = np.diag([-1.0, -1.0, 1.0, 1.0])
AFFINE = oblique()


def geometry(affine=AFFINE):
    """Directions of a row and a column, spacing between rows and columns, and where slice k begins, in LPS."""
    lps = LPS @ affine
    lengths = np.linalg.norm(lps[:3, :3], axis=0)
    directions = lps[:3, :3] / lengths
    return [*directions[:, 0], *directions[:, 1]], [lengths[1], lengths[0]], lambda k: lps[:3, 3] + k * lps[:3, 2], lengths[2]


def slice_of(voxels, k, syntax=ExplicitVRLittleEndian, affine=AFFINE, **more):
    """Slice k of an image (x, y, z) as a CT image."""
    orientation, spacing, position, thickness = geometry(affine)
    data_set = pydicom.Dataset()
    data_set.file_meta = pydicom.dataset.FileMetaDataset()
    data_set.file_meta.TransferSyntaxUID = syntax
    data_set.SOPClassUID = data_set.file_meta.MediaStorageSOPClassUID = "1.2.840.10008.5.1.4.1.1.2"
    data_set.SOPInstanceUID = data_set.file_meta.MediaStorageSOPInstanceUID = generate_uid(entropy_srcs=[f"{k}"])
    data_set.PatientID = data_set.PatientName = "synthetic"
    data_set.PatientBirthDate = data_set.PatientSex = data_set.AccessionNumber = ""
    data_set.StudyDate, data_set.StudyTime, data_set.StudyID = "20260101", "120000", "1"
    data_set.ReferringPhysicianName, data_set.Modality = "", "CT"
    data_set.StudyInstanceUID = generate_uid(entropy_srcs=["study"])
    data_set.SeriesInstanceUID = generate_uid(entropy_srcs=["series"])
    data_set.FrameOfReferenceUID = generate_uid(entropy_srcs=["frame"])
    data_set.SeriesNumber, data_set.InstanceNumber, data_set.SeriesDescription = 1, k + 1, "abdomen"
    data_set.ImagePositionPatient = [f"{v:.6f}" for v in position(k)]
    data_set.ImageOrientationPatient = [f"{v:.9f}" for v in orientation]
    data_set.PixelSpacing = [f"{v:.6f}" for v in spacing]
    # Not the distance of slices, as in many series.
    data_set.SliceThickness = "5"
    plane = np.ascontiguousarray(voxels[:, :, k].T)
    data_set.Rows, data_set.Columns = plane.shape
    data_set.SamplesPerPixel, data_set.PhotometricInterpretation = 1, "MONOCHROME2"
    data_set.BitsAllocated = data_set.BitsStored = 8 * plane.itemsize
    data_set.HighBit = data_set.BitsStored - 1
    data_set.PixelRepresentation = int(np.issubdtype(plane.dtype, np.signedinteger))
    order = ">" if syntax == ExplicitVRBigEndian else "<"
    data_set.PixelData = plane.astype(plane.dtype.newbyteorder(order)).tobytes() + b"\0" * (plane.nbytes % 2)
    for name, value in more.items():
        setattr(data_set, name, value)
    return data_set


def write_series(folder, voxels, name=lambda k: f"IM{(7 * k) % 27:04d}", **more):
    """A file a slice, in an order that is not theirs."""
    folder.mkdir(exist_ok=True)
    for k in range(voxels.shape[2]):
        slice_of(voxels, k, **more).save_as(folder / name(k), enforce_file_format=True)
    return folder


def body(seed=3, shape=SHAPE):
    return lumpy(shape, seed)


def check(path, voxels, affine=AFFINE, tolerance=2e-5):
    """The input holds these labels, at these places, as a NIfTI file would."""
    document = info(path)
    assert document["format"] == "DICOM" and document["dimensions"] == list(voxels.shape)
    np.testing.assert_allclose(affine_of(document), affine, atol=tolerance * 1000)
    np.testing.assert_allclose(document["spacing_mm"], np.linalg.norm(affine[:3, :3], axis=0), rtol=tolerance)
    counted = {entry["label"]: (entry["voxels"], entry["bounding_box"]) for entry in document["labels"]}
    values = [int(value) for value in np.unique(voxels) if value]
    boxes = {value: np.argwhere(voxels == value) for value in values}
    assert counted == {v: (len(at), [at.min(axis=0).tolist(), at.max(axis=0).tolist()]) for v, at in boxes.items()}


@pytest.mark.parametrize("syntax", [ExplicitVRLittleEndian, ImplicitVRLittleEndian, ExplicitVRBigEndian])
@pytest.mark.parametrize("dtype", [np.uint8, np.int16, np.uint16, np.int32])
def test_a_series_of_labels(tmp_path, syntax, dtype):
    voxels = body().astype(dtype) * 3
    voxels[10:14, 12:15, 9:16] = 7
    folder = write_series(tmp_path / "series", voxels, syntax=syntax)
    if syntax == ExplicitVRBigEndian and dtype == np.int32:
        assert "32 bits a pixel in big-endian order" in surfometry_error("info", folder)
        return
    (folder / "README.txt").write_text("not an image")
    check(folder, voxels)
    # Any file of it stands for it.
    check(folder / "IM0000", voxels)
    nib.save(nib.Nifti1Image(voxels.astype(np.int16), AFFINE), tmp_path / "same.nii.gz")
    (ours, theirs) = (measure(path, "--label", "3") for path in (folder, tmp_path / "same.nii.gz"))
    np.testing.assert_allclose(ours[0]["surface_area_mm2"], theirs[0]["surface_area_mm2"], rtol=1e-5)
    np.testing.assert_allclose(ours[0]["voxels"]["centroid_mm"], theirs[0]["voxels"]["centroid_mm"], atol=1e-3)


def test_grey_values_are_scaled(tmp_path):
    """Values of a slice are its own slope and intercept times and plus what is stored; twelve bits of sixteen count."""
    voxels = body().astype(np.int16) * 5
    stored = (voxels + 1024).astype(np.uint16)
    folder = write_series(tmp_path / "series", stored, RescaleSlope="1", RescaleIntercept="-1024")
    check(folder, voxels)
    own = tmp_path / "own"
    own.mkdir()
    for k in range(SHAPE[2]):
        data_set = slice_of(voxels * (1 + k % 2), k, RescaleSlope=str(1 / (1 + k % 2)), RescaleIntercept="0")
        data_set.save_as(own / f"{k}.dcm", enforce_file_format=True)
    check(own, voxels)
    with_overlay = (stored & 0x0FFF) | 0x3000
    twelve = write_series(tmp_path / "t", with_overlay, RescaleIntercept="-1024", RescaleSlope="1", BitsStored=12, HighBit=11)
    check(twelve, voxels)


def test_slices_that_are_missing_double_or_mixed(tmp_path):
    voxels = body()
    folder = write_series(tmp_path / "gap", voxels, name=lambda k: f"{k:02d}")
    (folder / "11").unlink()
    error = surfometry_error("measure", folder)
    assert "10 and 12 are 2.6" in error and "as a rule slices are 1.3" in error
    slice_of(voxels, 5).save_as(folder / "11", enforce_file_format=True)
    error = surfometry_error("measure", folder)
    assert "slices are missing, double or uneven" in error
    mixed = write_series(tmp_path / "mixed", voxels, name=lambda k: f"a{k:02d}")
    write_series(mixed, voxels, name=lambda k: f"b{k:02d}", SeriesInstanceUID="1.2.3", SeriesDescription="scout")
    error = surfometry_error("measure", mixed)
    assert "2 series" in error and "abdomen (27 files, as a00)" in error and "scout (27 files, as b00)" in error
    # The cure works.
    check(mixed / "b04", voxels)
    other = write_series(tmp_path / "other", voxels, name=lambda k: f"{k:02d}")
    slice_of(voxels, 3, PixelSpacing=[0.5, 0.5]).save_as(other / "03", enforce_file_format=True)
    assert "00 and 03 have other orientations or pixel spacings" in surfometry_error("measure", other)


def test_a_tilted_gantry_is_named(tmp_path):
    sheared = AFFINE.copy()
    sheared[:3, 2] += 0.2 * AFFINE[:3, 1]
    folder = write_series(tmp_path / "tilt", body(), affine=sheared)
    assert "gantry tilt" in surfometry_error("measure", folder)


REFUSED = {
    "SamplesPerPixel": (3, "a colour picture"),
    "ImagePositionPatient": (None, "no ImagePositionPatient"),
    "ImageOrientationPatient": ([0, 0, 0, 0, 1, 0], "direction of length 0"),
    "PixelSpacing": (None, "no PixelSpacing"),
    "Rows": (None, "no Rows"),
    "BitsAllocated": (12, "bits a pixel are not read"),
    "NumberOfFrames": (4, "nothing says where they lie"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_read_is_said(tmp_path, name):
    value, words = REFUSED[name]
    data_set = slice_of(body(), 3)
    if value is None:
        delattr(data_set, name)
    else:
        setattr(data_set, name, value)
    data_set.save_as(tmp_path / "a", enforce_file_format=True)
    error = surfometry_error("measure", tmp_path / "a")
    assert words in error and str(tmp_path / "a") in error


def test_compressed_pixels_are_named(tmp_path):
    folder = tmp_path / "s"
    folder.mkdir()
    for k in range(3):
        data_set = slice_of(body(), k)
        data_set.compress(pydicom.uid.RLELossless)
        data_set.save_as(folder / str(k), enforce_file_format=True)
    assert "compressed with RLE" in surfometry_error("measure", folder)


def test_a_file_that_is_compressed_as_a_whole_is_named(tmp_path):
    slice_of(body(), 3, DeflatedExplicitVRLittleEndian).save_as(tmp_path / "a", enforce_file_format=True)
    assert pydicom.dcmread(tmp_path / "a").Rows == SHAPE[1]
    error = surfometry_error("measure", tmp_path / "a")
    assert "compressed with deflate" in error and "dcmconv +te" in error and "feature" not in error


@pytest.mark.parametrize(("name", "dtype"), [("FloatPixelData", np.float32), ("DoubleFloatPixelData", np.float64)])
def test_images_of_floats_are_named(tmp_path, name, dtype):
    data_set = slice_of(body(), 3)
    for element in ["PixelData", "BitsStored", "HighBit", "PixelRepresentation"]:
        delattr(data_set, element)
    data_set.BitsAllocated = 8 * dtype().itemsize
    setattr(data_set, name, np.ascontiguousarray(body()[:, :, 3].T).astype(dtype).tobytes())
    data_set.save_as(tmp_path / "a", enforce_file_format=True)
    assert pydicom.dcmread(tmp_path / "a").pixel_array.dtype == dtype
    assert f"an image of floats ({name}" in surfometry_error("measure", tmp_path / "a")


def test_one_slice_and_a_name_of_another_format(tmp_path):
    slice_of(body(), 3).save_as(tmp_path / "a.nii.gz", enforce_file_format=True)
    assert "this is DICOM, not NIfTI" in surfometry_error("measure", tmp_path / "a.nii.gz")
    (tmp_path / "one").mkdir()
    slice_of(body(), 3).save_as(tmp_path / "one" / "a", enforce_file_format=True)
    assert "stack the slices" in surfometry_error("measure", tmp_path / "one")


def source(voxels):
    return [slice_of(voxels.astype(np.int16), k) for k in range(voxels.shape[2])]


def described(number, name):
    colour = hd.color.CIELabColor.from_rgb(20 + 60 * number, 200, 90)
    return hd.seg.SegmentDescription(
        segment_number=number,
        segment_label=name,
        segmented_property_category=codes.SCT.Organ,
        segmented_property_type=codes.SCT.Liver,
        algorithm_type=hd.seg.SegmentAlgorithmTypeValues.MANUAL,
        display_color=colour,
    )


def segmentation(path, arrays, names, kind="BINARY", image=None, **more):
    """What highdicom makes of masks (x, y, z), which may overlap."""
    stacked = np.stack([np.transpose(array, (2, 1, 0)) for array in arrays], axis=-1)
    if kind == "LABELMAP":
        stacked = np.max(stacked * np.arange(1, len(names) + 1), axis=-1).astype(np.uint8)
    written = hd.seg.Segmentation(
        source_images=source(arrays[0] if image is None else image),
        pixel_array=stacked,
        segmentation_type=kind,
        segment_descriptions=[described(number, name) for number, name in enumerate(names, 1)],
        series_instance_uid=generate_uid(),
        series_number=2,
        sop_instance_uid=generate_uid(),
        instance_number=1,
        manufacturer="none",
        manufacturer_model_name="none",
        software_versions="1",
        device_serial_number="1",
        **more,
    )
    written.save_as(path, enforce_file_format=True)
    return path


def organs():
    """Two that overlap, and one that lies inside the first, none in the outer slices."""
    x, y, z = np.meshgrid(*[np.arange(n) for n in SHAPE], indexing="ij")
    ball = lambda a, b, c, r: (((x - a) * 0.8) ** 2 + (y - b) ** 2 + ((z - c) * 1.3) ** 2 < r**2).astype(np.uint8)
    return {"Leber": ball(14.2, 15.1, 12.8, 8.3), "kidney, left": ball(21.7, 14.6, 13.1, 7.4), "core": ball(13.9, 15.3, 12.2, 4.6)}


@pytest.mark.parametrize("omit", [True, False])
@pytest.mark.parametrize("shuffled", [True, False])
def test_segments_that_overlap(tmp_path, omit, shuffled):
    shapes = organs()
    path = segmentation(tmp_path / "seg.dcm", list(shapes.values()), list(shapes), omit_empty_frames=omit)
    if shuffled:
        shuffle_frames(path)
    document = info(path)
    assert [(entry["label"], entry["name"]) for entry in document["labels"]] == [(1, "Leber"), (2, "kidney, left"), (3, "core")]
    for entry, rgb in zip(document["labels"], [(80, 200, 90), (140, 200, 90), (200, 200, 90)]):
        found = [int(entry["colour"][at : at + 2], 16) for at in (1, 3, 5)]
        np.testing.assert_allclose(found, rgb, atol=2)
    for record in measure(path):
        nib.save(nib.Nifti1Image(shapes[record["name"]], AFFINE), tmp_path / "alone.nii.gz")
        (alone,) = measure(tmp_path / "alone.nii.gz")
        assert record["voxels"]["count"] == int(shapes[record["name"]].sum())
        for name in ["volume_mm3", "surface_area_mm2", "total_mean_curvature_mm"]:
            np.testing.assert_allclose(record[name], alone[name], rtol=2e-5)
        np.testing.assert_allclose(record["voxels"]["centroid_mm"], alone["voxels"]["centroid_mm"], atol=1e-3)
        assert "touches-border" not in [flag["code"] for flag in record["flags"]]


@pytest.mark.parametrize("thickness", ["0.65", "1.3", "2.6"])
@pytest.mark.parametrize("omit", [True, False])
def test_slices_of_a_segmentation_are_as_far_apart_as_their_positions(tmp_path, thickness, omit):
    """Where nothing says SpacingBetweenSlices, SliceThickness does not say it either: as highdicom's volume has it."""
    shape = organs()["Leber"]
    path = segmentation(tmp_path / "seg.dcm", [shape], ["Leber"], omit_empty_frames=omit)
    data_set = pydicom.dcmread(path)
    (measures,) = data_set.SharedFunctionalGroupsSequence[0].PixelMeasuresSequence
    del measures.SpacingBetweenSlices
    measures.SliceThickness = thickness
    data_set.save_as(path, enforce_file_format=True)
    spacing = hd.seg.segread(path).get_volume().spacing[::-1]
    np.testing.assert_allclose(info(path)["spacing_mm"], spacing, rtol=1e-4)
    (record,) = measure(path)
    assert record["voxels"]["count"] == int(shape.sum())
    np.testing.assert_allclose(record["voxels"]["volume_mm3"], shape.sum() * np.prod(spacing), rtol=1e-4)


def test_folders_with_segmentations(tmp_path):
    shapes = organs()
    folder = tmp_path / "seg"
    folder.mkdir()
    segmentation(folder / "a", [shapes["Leber"]], ["Leber"])
    assert [record["name"] for record in measure(folder)] == ["Leber"]
    write_series(folder, body())
    assert "1 segmentations, as a, and 27 files of images" in surfometry_error("measure", folder)
    assert [record["name"] for record in measure(folder / "a")] == ["Leber"]


def shuffle_frames(path):
    """The same file with its frames in another order."""
    data_set = pydicom.dcmread(path)
    count, pixels = data_set.NumberOfFrames, data_set.Rows * data_set.Columns
    bits = np.unpackbits(np.frombuffer(data_set.PixelData, np.uint8), bitorder="little")[: count * pixels].reshape(count, pixels)
    order = np.random.default_rng(1).permutation(count)
    packed = np.packbits(bits[order].ravel(), bitorder="little").tobytes()
    data_set.PixelData = packed + b"\0" * (len(packed) % 2)
    groups = data_set.PerFrameFunctionalGroupsSequence
    data_set.PerFrameFunctionalGroupsSequence = pydicom.Sequence([groups[n] for n in order])
    data_set.save_as(path, enforce_file_format=True)


@pytest.mark.parametrize("unit", [8, 16])
def test_frames_that_begin_a_byte_or_two(tmp_path, unit):
    """Packed as MeVisLab of old and others did, against the standard; the length says so."""
    shapes = organs()
    path = segmentation(tmp_path / "seg.dcm", list(shapes.values()), list(shapes))
    data_set = pydicom.dcmread(path)
    expected = [record["voxels"]["count"] for record in measure(path)]
    count, pixels = data_set.NumberOfFrames, data_set.Rows * data_set.Columns
    bits = np.unpackbits(np.frombuffer(data_set.PixelData, np.uint8), bitorder="little")[: count * pixels].reshape(count, pixels)
    padded = np.pad(bits, [(0, 0), (0, -pixels % unit)])
    packed = np.packbits(padded.ravel(), bitorder="little").tobytes()
    data_set.PixelData = packed + b"\0" * (len(packed) % 2)
    data_set.save_as(path, enforce_file_format=True)
    assert [record["voxels"]["count"] for record in measure(path)] == expected
    data_set.PixelData = data_set.PixelData[:-10]
    data_set.save_as(path, enforce_file_format=True)
    assert "bytes of pixels" in surfometry_error("measure", path)


def test_a_label_map(tmp_path):
    shapes = organs()
    core = shapes["core"]
    apart = {"Leber": shapes["Leber"] & ~core & 1, "core": core}
    path = segmentation(tmp_path / "seg.dcm", list(apart.values()), list(apart), kind="LABELMAP")
    counts = {record["name"]: record["voxels"]["count"] for record in measure(path)}
    assert counts == {name: int(mask.sum()) for name, mask in apart.items()}


def test_fractions_are_a_soft_segmentation(tmp_path):
    from scipy import ndimage

    soft = np.clip(ndimage.gaussian_filter(organs()["Leber"].astype(float), 1.0), 0, 1)
    more = {"fractional_type": "PROBABILITY", "max_fractional_value": 200}
    path = segmentation(tmp_path / "seg.dcm", [soft], ["Leber"], kind="FRACTIONAL", **more)
    (record,) = measure(path, "--embedding", "probability")
    stored = np.round(soft * 200) / 200
    nib.save(nib.Nifti1Image(stored, AFFINE), tmp_path / "soft.nii.gz")
    (expected,) = measure(tmp_path / "soft.nii.gz", "--embedding", "probability")
    for name in ["volume_mm3", "surface_area_mm2"]:
        np.testing.assert_allclose(record[name], expected[name], rtol=2e-4)
    assert "threshold" in surfometry_error("measure", path)


def test_files_that_are_damaged(tmp_path):
    """Truncated or with a bit changed: read, or refused in words; never a panic."""
    import subprocess

    from conftest import BINARY

    shapes = organs()
    path = segmentation(tmp_path / "seg.dcm", list(shapes.values()), list(shapes))
    whole = path.read_bytes()
    slice_of(body(), 3).save_as(tmp_path / "ct", enforce_file_format=True)
    rng = np.random.default_rng(8)
    for n in range(60):
        data = bytearray((tmp_path / "ct").read_bytes() if n % 3 == 0 else whole)
        if n % 2:
            data = data[: rng.integers(132, len(data))]
        else:
            data[rng.integers(132, min(len(data), 4000))] ^= 1 << rng.integers(8)
        (tmp_path / "bad.dcm").write_bytes(data)
        command = ["bash", "-c", f"ulimit -v 4000000; exec {BINARY} info {tmp_path / 'bad.dcm'} --threads 1"]
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=20)
        assert done.returncode in (0, 1), (n, done.returncode, done.stderr)
        assert "panicked" not in done.stderr


def error_of(tmp_path, head, skipped, replaced, by, *syntax):
    """What is said of a slice in which some bytes behind the beginning of an element's head are others."""
    path = tmp_path / "a.dcm"
    slice_of(body(), 3, *syntax).save_as(path, enforce_file_format=True)
    data = bytearray(path.read_bytes())
    at = data.index(head) + skipped
    data[at : at + replaced] = by
    path.write_bytes(data)
    return surfometry_error("info", path)


def test_a_representation_that_there_is_not(tmp_path):
    """Readers take it for UN, whose length has four bytes: 2 GB were made room for in a file of 4 kB (found by fuzz/)."""
    claim = b"\x91T\0\0" + (2433941536).to_bytes(4, "little")
    assert "claims 2433941536 bytes" in error_of(tmp_path, b"\x20\x00\x13\x00IS", 4, 8, claim)


IMPLICIT_ITEM = struct.pack("<HHI", 0x0009, 0x1001, 4) + b"abcd"
NESTED = struct.pack("<HHI", 0x0009, 0x1002, 0xFFFFFFFF) + struct.pack("<HHIHHI", 0xFFFE, 0xE000, 0, 0xFFFE, 0xE0DD, 0)
ENDS = [struct.pack("<HHI", 0xFFFE, 0xE00D, 0), struct.pack("<HHI", 0xFFFE, 0xE0DD, 0)]


@pytest.mark.parametrize("is_defined", [False, True])
def test_sequences_of_no_known_representation(tmp_path, is_defined):
    """Their items have no representations, whatever the file's have (PS3.5, 6.2.2); pydicom reads them, and we leave them out."""
    voxels = body()
    folder = write_series(tmp_path / "series", voxels)
    inside = IMPLICIT_ITEM + NESTED
    item = struct.pack("<HHI", 0xFFFE, 0xE000, len(inside) if is_defined else 0xFFFFFFFF) + inside
    element = struct.pack("<HH2s2sI", 0x0009, 0x1000, b"UN", b"", 0xFFFFFFFF) + item
    element += ENDS[1] if is_defined else b"".join(ENDS)
    for path in folder.iterdir():
        data = path.read_bytes()
        # In front of the patient's name.
        at = data.index(struct.pack("<HH", 0x0010, 0x0010))
        path.write_bytes(data[:at] + element + data[at:])
        assert pydicom.dcmread(path)[0x0009, 0x1000].value is not None
    check(folder, voxels)


@pytest.mark.parametrize("padding", [b"\0" * 7, b"\0" * 100, b"\0" * 512, b"\xff" * 64])
def test_padding_behind_the_pixels(tmp_path, padding):
    voxels = body()
    folder = write_series(tmp_path / "series", voxels)
    for path in folder.iterdir():
        path.write_bytes(path.read_bytes() + padding)
    check(folder, voxels)


def test_an_item_in_no_sequence(tmp_path):
    """It is read as an element: 2.7 GB were made room for in a file of 3 kB (found by fuzz/)."""
    claim = b"\xfe\xff\0\xe0" + (2684354638).to_bytes(4, "little")
    assert "claims 2684354638 bytes" in error_of(tmp_path, b"\x20\x00\x13\x00IS", 0, 8, claim)


def test_numbers_that_are_not_whole(tmp_path):
    """What is over was taken for the next element: 1.1 GB were made room for in a file of 5 kB (found by fuzz/)."""
    longer = (3).to_bytes(2, "little") + b"\0"
    assert "claims 3 bytes of numbers of 2 bytes each" in error_of(tmp_path, b"\x28\x00\x10\x00US", 6, 2, longer)


def test_a_length_in_big_endian_order(tmp_path):
    """Out of use, but read: 2 GB were made room for in a file of 5 kB (found by fuzz/)."""
    claim = b"UN\0\0" + (2433941536).to_bytes(4, "big")
    assert "claims 2433941536 bytes" in error_of(tmp_path, b"\0\x20\0\x13IS", 4, 8, claim, ExplicitVRBigEndian)


@pytest.mark.parametrize("damage", [b"", b"\0" * 200, b"<html>", b"version https://git-lfs.github.com/spec/v1\n", None])
def test_a_damaged_slice_at_an_end_is_no_slice_less(tmp_path, damage):
    voxels = body()
    folder = write_series(tmp_path / "series", voxels, name=lambda k: f"{k:03d}.dcm")
    last = folder / "026.dcm"
    last.write_bytes(last.read_bytes()[:300] if damage is None else damage)
    for path in (folder, folder / "003.dcm"):
        assert "026.dcm" in surfometry_error("measure", path)


def test_segments_that_nothing_describes_or_that_are_there_twice(tmp_path):
    arrays = organs()
    path = segmentation(tmp_path / "a.dcm", list(arrays.values()), list(arrays))
    data_set = pydicom.dcmread(path)
    last = data_set.SegmentSequence.pop()
    data_set.save_as(path)
    assert f"segment {last.SegmentNumber}, which SegmentSequence (0062,0002) does not describe" in surfometry_error("measure", path)
    last.SegmentNumber = 1
    data_set.SegmentSequence.append(last)
    data_set.save_as(path)
    assert "two segments have SegmentNumber 1" in surfometry_error("measure", path)


def test_sequences_without_end(tmp_path):
    data_set = slice_of(body(), 3)
    inner = pydicom.Dataset()
    for _ in range(200):
        outer = pydicom.Dataset()
        outer.ReferencedSeriesSequence = pydicom.Sequence([inner])
        inner = outer
    data_set.ReferencedSeriesSequence = inner.ReferencedSeriesSequence
    data_set.save_as(tmp_path / "deep.dcm", enforce_file_format=True)
    assert "more than 64 deep" in surfometry_error("measure", tmp_path / "deep.dcm")


CHARACTER_SETS = [
    ("ISO_IR 100", "Fémur gauche"),
    ("ISO_IR 148", "Karaciğer, İlik"),
    ("ISO_IR 144", "печень"),
    ("ISO_IR 192", "Fémur 肝"),
    ("GB18030", "肝脏"),
    (["", "ISO 2022 IR 87"], "Leber 肝臓 R"),
    (["ISO 2022 IR 13", "ISO 2022 IR 87"], "ｶﾝ 肝臓"),
    (["", "ISO 2022 IR 149"], "liver 간"),
    (["ISO 2022 IR 100", "ISO 2022 IR 126"], "Fémur ήπαρ"),
    (["ISO 2022 IR 6", "ISO 2022 IR 100", "ISO 2022 IR 144"], "Fémur печень"),
]


@pytest.mark.parametrize(("sets", "name"), CHARACTER_SETS)
def test_names_in_any_character_set(tmp_path, sets, name):
    """As pydicom writes them, with the escapes of ISO 2022 where there are several sets."""
    path = segmentation(tmp_path / "seg.dcm", [organs()["Leber"]], ["Leber"])
    data_set = pydicom.dcmread(path)
    data_set.SpecificCharacterSet = sets
    data_set.SegmentSequence[0].SegmentLabel = name
    data_set.save_as(path, enforce_file_format=True)
    assert pydicom.dcmread(path).SegmentSequence[0].SegmentLabel == name
    assert [entry["name"] for entry in info(path)["labels"]] == [name]
