"""Files of FreeSurfer, Scanco, TIFF, OME-Zarr and VTK, written by those formats' own libraries, are read as these mean them."""

import json
import struct
import subprocess

import nibabel as nib
import numcodecs
import numpy as np
import py_aimio
import pytest
import pyvista
import SimpleITK as sitk
import tifffile
import zarr
from conftest import BINARY, measure, oblique
from PIL import Image
from test_formats import check, labels
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

SPACING = [0.7, 1.1, 1.9]


def refused(path, *options):
    """What is said of an input that is not read."""
    done = subprocess.run([str(BINARY), "info", str(path), *options], capture_output=True, text=True, check=False)
    assert done.returncode == 1, done.stdout
    return done.stderr


@pytest.mark.parametrize("name", ["a.mgh", "a.mgz"])
@pytest.mark.parametrize("dtype", ["uint8", "int16", "int32", "float32"])
@pytest.mark.parametrize("handedness", [1.0, -1.0])
def test_freesurfer_by_nibabel(tmp_path, name, dtype, handedness):
    image = labels(dtype)
    affine = oblique() @ np.diag([handedness, 1, 1, 1])
    nib.save(nib.MGHImage(image, affine), tmp_path / name)
    check(tmp_path / name, image, affine, tolerance=1e-3)


@pytest.mark.parametrize("kind", ["int8", "int16", "float32", "runs"])
def test_scanco_by_aimio(tmp_path, kind):
    image = (labels("uint8") == 1).astype("int8") * 127 if kind == "runs" else labels(kind)
    path = tmp_path / "M.AIM;1"
    meta = {"element_size": SPACING, "position": [3, -5, 7]}
    py_aimio.write_aim(str(path), np.ascontiguousarray(image.transpose(2, 1, 0)), meta)
    affine = np.diag([*SPACING, 1.0])
    affine[:3, 3] = np.multiply(SPACING, [3, -5, 7])
    check(path, image, affine)


def stored(image):
    """z, y, x, as TIFF and Zarr have their axes."""
    return np.ascontiguousarray(image.transpose(2, 1, 0))


def placed(origin=(0, 0, 0)):
    affine = np.diag([*SPACING, 1.0])
    affine[:3, 3] = origin
    return affine


GIVEN = ["--spacing", ",".join(map(str, SPACING))]


@pytest.mark.parametrize("dtype", ["uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "float32", "float64"])
@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize(
    "options",
    [
        {},
        {"bigtiff": True},
        {"compression": "zlib"},
        {"compression": "zlib", "predictor": True},
        {"tile": (16, 32)},
        {"rowsperstrip": 3, "compression": "zlib"},
        {"photometric": "miniswhite"},
    ],
    ids=str,
)
def test_tiff_by_tifffile(tmp_path, dtype, order, options):
    if options.get("predictor") and dtype in ("uint64", "float32", "float64"):
        pytest.skip("tifffile writes these predictors with imagecodecs alone")
    image = labels(dtype)
    tifffile.imwrite(tmp_path / "a.tif", stored(image), byteorder=order, **options)
    check(tmp_path / "a.tif", image, placed(), *GIVEN)
    assert "no voxel spacing" in refused(tmp_path / "a.tif")


@pytest.mark.parametrize("compression", ["tiff_lzw", "packbits", "tiff_adobe_deflate", "zstd"])
def test_tiff_by_pillow(tmp_path, compression):
    image = labels("uint8")
    pages = [Image.fromarray(page) for page in stored(image)]
    pages[0].save(tmp_path / "a.tif", save_all=True, append_images=pages[1:], compression=compression)
    check(tmp_path / "a.tif", image, placed(), *GIVEN)


def test_tiff_of_one_bit(tmp_path):
    image = (labels("uint8") == 1).astype("uint8")
    for photometric in ["minisblack", "miniswhite"]:
        tifffile.imwrite(tmp_path / "a.tif", stored(image).astype(bool), photometric=photometric)
        check(tmp_path / "a.tif", image, placed(), *GIVEN)


@pytest.mark.parametrize("dtype", ["int16", "float32"])
def test_tiff_that_would_be_turned_round(tmp_path, dtype):
    """White as zero of compressed numbers with a sign, and bits from right to left."""
    tifffile.imwrite(tmp_path / "a.tif", stored(labels(dtype)), photometric="miniswhite", compression="zlib")
    assert "WhiteIsZero" in refused(tmp_path / "a.tif", *GIVEN)
    # tifffile reads the tag and does not write it: one of nobody's takes its place.
    tifffile.imwrite(tmp_path / "b.tif", stored(labels(dtype)), byteorder="<", extratags=[(65000, 3, 1, 2, False)])
    data = (tmp_path / "b.tif").read_bytes()
    (tmp_path / "b.tif").write_bytes(data.replace(struct.pack("<HHI", 65000, 3, 1), struct.pack("<HHI", 266, 3, 1)))
    with tifffile.TiffFile(tmp_path / "b.tif") as tiff:
        assert all(page.fillorder == 2 for page in tiff.pages)
    assert "FillOrder" in refused(tmp_path / "b.tif", *GIVEN)


@pytest.mark.parametrize("unit, factor", [("mm", 1.0), ("micron", 1000.0), ("\\u00B5m", 1000.0), ("cm", 0.1)])
@pytest.mark.parametrize("truncate", [False, True])
def test_tiff_of_imagej(tmp_path, unit, factor, truncate):
    image = labels("uint16")
    x, y, z = (length * factor for length in SPACING)
    tifffile.imwrite(
        tmp_path / "a.tif", stored(image), imagej=True, resolution=(1 / x, 1 / y), metadata={"spacing": z, "unit": unit, "axes": "ZYX"}
    )
    if truncate:
        # As ImageJ itself writes more than 4 GiB: one page, the slices behind it.
        data = bytearray((tmp_path / "a.tif").read_bytes())
        with tifffile.TiffFile(tmp_path / "a.tif") as tiff:
            assert tiff.pages[0].dataoffsets[0] + image.nbytes <= len(data)
            first = tiff.pages[0]
            end = first.offset + 2 + 12 * len(first.tags)
        data[end : end + 4] = bytes(4)
        (tmp_path / "a.tif").write_bytes(data)
    check(tmp_path / "a.tif", image, placed(), tolerance=1e-4)


def test_tiff_of_imagej_in_latin_1(tmp_path):
    image = labels("uint8")
    x, y, z = (length * 1000 for length in SPACING)
    metadata = {"spacing": z, "unit": "um", "axes": "ZYX"}
    tifffile.imwrite(tmp_path / "a.tif", stored(image), imagej=True, resolution=(1 / x, 1 / y), metadata=metadata)
    data = (tmp_path / "a.tif").read_bytes()
    assert data.count(b"unit=um\n") == 1
    (tmp_path / "a.tif").write_bytes(data.replace(b"unit=um\n", b"unit=\xb5m\n"))
    check(tmp_path / "a.tif", image, placed(), tolerance=1e-4)


def test_tiff_of_imagej_with_a_unit_an_axis(tmp_path):
    image = labels("uint8")
    x, y, z = SPACING
    for units, lengths in [({"zunit": "mm"}, (1000 * x, 1000 * y, z)), ({"yunit": "mm", "zunit": "cm"}, (1000 * x, y, z / 10))]:
        metadata = {"axes": "ZYX", "unit": "um", "spacing": lengths[2], **units}
        resolution = (1 / lengths[0], 1 / lengths[1])
        tifffile.imwrite(tmp_path / "a.tif", stored(image), imagej=True, resolution=resolution, metadata=metadata)
        check(tmp_path / "a.tif", image, placed(), tolerance=1e-4)


def test_tiff_of_imagej_with_channels_or_frames(tmp_path):
    image = stored(labels("uint8"))
    for axes, word in [("CYX", "Split Channels"), ("TYX", "set Slices to 23 and Frames to 1")]:
        tifffile.imwrite(tmp_path / "a.tif", image, imagej=True, metadata={"axes": axes})
        assert word in refused(tmp_path / "a.tif")


@pytest.mark.parametrize("unit, factor", [("mm", 1.0), ("µm", 1000.0), ("nm", 1e6), (None, 1000.0)])
def test_tiff_of_ome(tmp_path, unit, factor):
    image = labels("int32")
    metadata = {"axes": "ZYX"}
    for axis, length in zip("XYZ", SPACING):
        metadata[f"PhysicalSize{axis}"] = length * factor
        metadata |= {f"PhysicalSize{axis}Unit": unit} if unit else {}
    tifffile.imwrite(tmp_path / "a.ome.tif", stored(image), metadata=metadata, compression="zlib")
    check(tmp_path / "a.ome.tif", image, placed())
    tifffile.imwrite(tmp_path / "b.ome.tif", np.stack([stored(image)] * 2), metadata={"axes": "CZYX"})
    assert "2 channels" in refused(tmp_path / "b.ome.tif")


OME = (
    '<?xml version="1.0"?><OME xmlns="http://www.openmicroscopy.org/Schemas/OME/2016-06" UUID="urn:uuid:a"><Image ID="Image:0">'
    '<Pixels ID="Pixels:0" DimensionOrder="XYZCT" Type="uint8" SizeX="17" SizeY="19" SizeZ="23" SizeC="1" SizeT="1">'
    '<Channel ID="Channel:0:0" SamplesPerPixel="1"/>{}</Pixels></Image></OME>'
)


@pytest.mark.parametrize("order", ["reversed", "shuffled", "two halves", "one block"])
def test_tiff_of_ome_whose_pages_stand_in_another_order(tmp_path, order):
    image = labels("uint8")
    data, count = stored(image), len(stored(image))
    slices = {
        "reversed": np.arange(count)[::-1],
        "shuffled": np.random.default_rng(4).permutation(count),
        "two halves": np.roll(np.arange(count), 9),
        "one block": np.arange(count),
    }[order]
    blocks = [f'<TiffData FirstZ="{z}" IFD="{page}"/>' for page, z in enumerate(slices)]
    if order == "two halves":
        blocks = [f'<TiffData FirstZ="{count - 9}" IFD="0" PlaneCount="9"/>', f'<TiffData IFD="9" PlaneCount="{count - 9}"/>']
    if order == "one block":
        blocks = ["<TiffData/>"]
    path = tmp_path / "a.ome.tif"
    tifffile.imwrite(path, data[slices], description=OME.format("".join(blocks)), metadata=None, photometric="minisblack")
    if order != "one block":
        np.testing.assert_array_equal(tifffile.imread(path), data)
    check(path, image, placed(), *GIVEN)
    elsewhere = blocks[0].replace("/>", '><UUID FileName="b.ome.tif">urn:uuid:b</UUID></TiffData>')
    tifffile.imwrite(path, data[slices], description=OME.format("".join([elsewhere, *blocks[1:]])), metadata=None)
    assert "2 files" in refused(path, *GIVEN)


def test_tiff_with_a_file_of_nnunet(tmp_path):
    image = labels("uint8")
    tifffile.imwrite(tmp_path / "case.tif", stored(image))
    (tmp_path / "case.json").write_text(json.dumps({"spacing": SPACING[::-1]}))
    check(tmp_path / "case.tif", image, placed())
    (tmp_path / "case.json").write_text(json.dumps({"spacing": [1, 2]}))
    assert "[z, y, x]" in refused(tmp_path / "case.tif")


def test_tiff_of_colours(tmp_path):
    tifffile.imwrite(tmp_path / "a.tif", np.zeros((5, 6, 7, 3), "uint8"), photometric="rgb")
    assert "colour pixels" in refused(tmp_path / "a.tif")


@pytest.mark.parametrize("ending", ["tif", "png"])
def test_folder_of_slices(tmp_path, ending):
    for dtype in ["uint8", "uint16"]:
        image = labels(dtype)
        folder = tmp_path / dtype
        folder.mkdir()
        for z, page in enumerate(stored(image), start=8):
            Image.fromarray(page).save(folder / f"slice_{z}.{ending}")
        check(folder, image, placed(), *GIVEN)
        (folder / f"slice_12.{ending}").unlink()
        assert f"between slice_11.{ending} and slice_13.{ending}" in refused(folder, *GIVEN)


@pytest.mark.parametrize("name", ["Series003_z{:02}_ch00.tif", "bone_{:04}_seg2.png", "s{}_seg2.tif", "scan_10um_{:03}.png", "a-{}.x.png"])
def test_slices_whose_names_have_other_numbers(tmp_path, name):
    image = labels("uint8")
    for z, page in enumerate(stored(image), start=3):
        Image.fromarray(page).save(tmp_path / name.format(z))
    check(tmp_path, image, placed(), *GIVEN)


def test_slices_whose_names_differ_in_several_numbers(tmp_path):
    for folder, name, said in [
        ("channels", "s_z{0:02}_ch{1}.png", "(s_z00 to s_z04, _ch0 to _ch1)"),
        ("decimals", "s{0}.{2}.png", "(s0 to s4, .0 to .5)"),
    ]:
        (tmp_path / folder).mkdir()
        for z, page in enumerate(stored(labels("uint8"))[:5]):
            for part in range(2):
                Image.fromarray(page).save(tmp_path / folder / name.format(z, part, 5 * part))
        error = refused(tmp_path / folder, *GIVEN)
        assert "differ in 2 numbers" in error and said in error and "into a folder of its own, or rename" in error
    # The cure works.
    (tmp_path / "one").mkdir()
    for path in (tmp_path / "channels").glob("*_ch1.png"):
        path.rename(tmp_path / "one" / path.name)
    for folder in ["one", "channels"]:
        check(tmp_path / folder, labels("uint8")[:, :, :5], placed(), *GIVEN)


@pytest.mark.parametrize("ending, words", [("bmp", "convert"), ("jpg", "labels are damaged")])
def test_slices_of_other_pictures(tmp_path, ending, words):
    """As scanners export them."""
    for z, page in enumerate(stored(labels("uint8"))[:9]):
        Image.fromarray(page).save(tmp_path / f"s_{z:04}.{ending}")
    (tmp_path / "s_rec.log").write_text("[System]")
    for path, what in [(tmp_path, f"9 .{ending} pictures"), (tmp_path / f"s_0003.{ending}", f"a .{ending} picture")]:
        error = refused(path, *GIVEN)
        assert what in error and words in error and "PNG or TIFF" in error and "--raw" not in error


def test_meshes_that_are_not_read(tmp_path):
    vertices, faces = np.eye(4, 3), np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    nib.freesurfer.write_geometry(tmp_path / "lh.white", vertices, faces)
    grid = pyvista.UnstructuredGrid(np.insert(faces, 0, 3, axis=1).ravel(), np.full(4, 5, np.uint8), vertices)
    grid.save(tmp_path / "a.vtu")
    (tmp_path / "a.gltf").write_text('{"asset": {"version": "2.0"}}')
    for name, words in [("lh.white", "mris_convert"), ("a.vtu", "unstructured grid"), ("a.gltf", "glTF")]:
        error = refused(tmp_path / name)
        assert words in error and "GLB (.glb)" in error and "--spacing X,Y,Z" in error and "--raw" not in error


def test_png_slices_of_one_bit_and_palettes(tmp_path):
    image = labels("uint8") % 4
    for mode in ["1", "P"]:
        expected = np.minimum(image, 1) if mode == "1" else image
        folder = tmp_path / mode
        folder.mkdir()
        for z, page in enumerate(stored(expected)):
            picture = Image.fromarray(page * 255).convert("1") if mode == "1" else Image.fromarray(page, mode="P")
            if mode == "P":
                picture.putpalette([200, 0, 0, 0, 200, 0, 0, 0, 200, 9, 9, 9])
            picture.save(folder / f"{z:03}.png")
        check(folder, expected, placed(), *GIVEN)


def ome(version, path, axes="zyx", scale=None, units=None, translation=None, more=None):
    """Attributes of an image of one resolution."""
    kinds = {"t": "time", "c": "channel"}
    described = [{"name": a, "type": kinds.get(a, "space")} for a in axes]
    for axis, unit in zip(described[-3:], units or []):
        axis["unit"] = unit
    transformations = [{"type": "scale", "scale": scale}]
    if translation:
        transformations.append({"type": "translation", "translation": translation})
    multiscales = [{"axes": described, "datasets": [{"path": path, "coordinateTransformations": transformations}]}]
    if version == "0.4":
        multiscales[0]["version"] = version
        return {"multiscales": multiscales, **(more or {})}
    return {"ome": {"version": version, "multiscales": multiscales, **(more or {})}}


ZARR_FORMAT = {"0.4": 2, "0.5": 3, "0.6": 3}
MM = ["millimeter"] * 3


@pytest.mark.parametrize("version", ["0.4", "0.5"])
@pytest.mark.parametrize("dtype", ["bool", "uint8", "int8", "uint16", "int16", "uint32", "int64", "float32", "float64", ">i2"])
def test_ome_zarr_by_zarr(tmp_path, version, dtype):
    image = labels("int16" if dtype == "bool" else dtype.replace(">i2", "int16"))
    image = image.astype(dtype).astype("uint8") if dtype == "bool" else image
    group = zarr.open_group(tmp_path / "a.zarr", mode="w", zarr_format=ZARR_FORMAT[version])
    kind = "int16" if dtype == ">i2" and version == "0.5" else dtype
    array = group.create_array("0", shape=stored(image).shape, chunks=(5, 7, 8), dtype=kind)
    array[:] = stored(image).astype(kind)
    group.attrs.update(ome(version, "0", scale=SPACING[::-1], units=MM, translation=[3.0, 2.0, 1.0]))
    check(tmp_path / "a.zarr", image.astype("int64"), placed([1, 2, 3]))


CODECS = {
    "none": None,
    "gzip": zarr.codecs.GzipCodec(),
    "zstd": zarr.codecs.ZstdCodec(),
    "blosc lz4": zarr.codecs.BloscCodec(cname="lz4"),
    "blosc zstd": zarr.codecs.BloscCodec(cname="zstd", shuffle="bitshuffle"),
    "blosc zlib": zarr.codecs.BloscCodec(cname="zlib"),
}
OLD_CODECS = {
    "none": None,
    "zlib": numcodecs.Zlib(),
    "gzip": numcodecs.GZip(),
    "bz2": numcodecs.BZ2(),
    "zstd": numcodecs.Zstd(),
    "blosc": numcodecs.Blosc(cname="blosclz"),
}


@pytest.mark.parametrize("codec", CODECS)
@pytest.mark.parametrize("shards", [None, (10, 14, 16)])
def test_zarr_3_codecs(tmp_path, codec, shards):
    image = labels("uint16")
    data = stored(image)
    array = zarr.create_array(
        tmp_path / "a.zarr", shape=data.shape, dtype="uint16", chunks=(5, 7, 8), shards=shards, compressors=CODECS[codec]
    )
    array[:] = data
    check(tmp_path / "a.zarr", image, placed(), *GIVEN)


@pytest.mark.parametrize("codec", OLD_CODECS)
@pytest.mark.parametrize("order", ["C", "F"])
def test_zarr_2_codecs(tmp_path, codec, order):
    image = labels("uint16")
    data = stored(image)
    array = zarr.create_array(
        tmp_path / "a.zarr", shape=data.shape, dtype="uint16", chunks=(5, 7, 8), zarr_format=2, order=order, compressors=OLD_CODECS[codec]
    )
    array[:] = data
    check(tmp_path / "a.zarr", image, placed(), *GIVEN)
    assert "no voxel spacing" in refused(tmp_path / "a.zarr")


UNITS = [("micrometer", 1000), ("µm", 1000), ("micron", 1000), ("um", 1000), ("nanometer", 1e6), ("angstrom", 1e7), ("meter", 1e-3), ("centimeter", 0.1), ("mm", 1)]


def image_group(path, image, version="0.5", **options):
    group = zarr.open_group(path, mode="w", zarr_format=ZARR_FORMAT[version])
    rank = len(options.get("axes", "zyx"))
    data = stored(image).reshape((1,) * (rank - 3) + stored(image).shape)
    group.create_array("s0", shape=data.shape, chunks=(1,) * (rank - 3) + (9, 9, 9), dtype=data.dtype)[:] = data
    group.attrs.update(ome(version, "s0", **options))
    return group


@pytest.mark.parametrize("unit, factor", UNITS)
def test_ome_zarr_units(tmp_path, unit, factor):
    image = labels("uint8")
    scale = [length * factor for length in SPACING[::-1]]
    image_group(tmp_path / "a.zarr", image, scale=scale, units=[unit] * 3)
    check(tmp_path / "a.zarr", image, placed())


@pytest.mark.parametrize("units, word", [(None, "(none stated)"), ([" "] * 3, "(none stated)"), (["parsec"] * 3, "parsec")])
def test_ome_zarr_without_a_length(tmp_path, units, word):
    image = labels("uint8")
    image_group(tmp_path / "a.zarr", image, scale=[9, 9, 9], units=units)
    assert word in refused(tmp_path / "a.zarr")
    check(tmp_path / "a.zarr", image, placed(), *GIVEN)


def test_ome_zarr_axes_of_one_sample_and_of_several(tmp_path):
    image = labels("uint8")
    scale = [1, 1, *SPACING[::-1]]
    image_group(tmp_path / "a.zarr", image, version="0.4", axes="tczyx", scale=scale, units=MM)
    check(tmp_path / "a.zarr", image, placed())
    group = zarr.open_group(tmp_path / "b.zarr", mode="w")
    group.create_array("s0", shape=(2, 9, 9, 9), dtype="uint8")
    group.attrs.update(ome("0.5", "s0", axes="czyx", scale=[1, *SPACING], units=MM))
    assert "c = 2" in refused(tmp_path / "b.zarr")


def test_ome_zarr_axes_in_another_order(tmp_path):
    image = labels("uint8")
    # x is the slowest axis: what is read has it last.
    group = zarr.open_group(tmp_path / "a.zarr", mode="w")
    group.create_array("0", shape=image.shape, dtype="uint8", chunks=(4, 5, 6))[:] = image
    group.attrs.update(ome("0.5", "0", axes="xyz", scale=SPACING, units=MM, translation=[1, 2, 3]))
    expected = placed([1, 2, 3])[:, [2, 1, 0, 3]]
    check(tmp_path / "a.zarr", image.transpose(2, 1, 0), expected)


def test_ome_zarr_levels(tmp_path):
    image = labels("uint8")
    group = image_group(tmp_path / "a.zarr", image, scale=SPACING[::-1], units=MM)
    half = image[::2, ::2, ::2]
    group.create_array("s1", shape=stored(half).shape, dtype="uint8", chunks=(4, 4, 4))[:] = stored(half)
    attributes = group.attrs.asdict()
    coarse = [{"type": "scale", "scale": [2 * length for length in SPACING[::-1]]}]
    attributes["ome"]["multiscales"][0]["datasets"].append({"path": "s1", "coordinateTransformations": coarse})
    # A transformation of all resolutions is applied last.
    attributes["ome"]["multiscales"][0]["coordinateTransformations"] = [{"type": "scale", "scale": [1.0, 1.0, 3.0]}]
    group.attrs.update(attributes)
    wide = np.diag([3.0, 1, 1, 1]) @ placed()
    check(tmp_path / "a.zarr", image, wide)
    check(tmp_path / "a.zarr/s0", image, wide)
    check(tmp_path / "a.zarr/s1", half, wide @ np.diag([2, 2, 2, 1]))


@pytest.mark.parametrize("version", ["0.4", "0.5"])
def test_ome_zarr_labels(tmp_path, version):
    image = labels("uint8")
    root = image_group(tmp_path / "a.zarr", image * 0, version=version, scale=SPACING[::-1], units=MM)
    more = {"image-label": {"colors": [{"label-value": 1, "rgba": [255, 0, 9, 255]}], "properties": [{"label-value": 1, "name": "femur"}]}}

    def add(names):
        group = root.require_group("labels")
        group.attrs.update({"labels": names} if version == "0.4" else {"ome": {"version": version, "labels": names}})
        one = group.require_group(names[-1])
        one.create_array("0", shape=stored(image).shape, dtype="uint8")[:] = stored(image)
        one.attrs.update(ome(version, "0", scale=SPACING[::-1], units=MM, more=more))

    add(["bones"])
    for path in ["a.zarr", "a.zarr/labels", "a.zarr/labels/bones", "a.zarr/labels/bones/0"]:
        check(tmp_path / path, image, placed())
    assert measure(tmp_path / "a.zarr", "--label", "1")[0]["name"] == "femur"
    add(["bones", "muscles"])
    said = refused(tmp_path / "a.zarr")
    assert "2 sets of labels" in said and "labels/muscles" in said
    check(tmp_path / "a.zarr/labels/muscles", image, placed())


def test_ome_zarr_that_is_refused(tmp_path):
    image_group(tmp_path / "a.zarr", labels("uint8"), version="0.6", scale=[1, 1, 1], units=MM)
    assert "up to 0.5 are read" in refused(tmp_path / "a.zarr")
    group = zarr.open_group(tmp_path / "plate.zarr", mode="w")
    group.attrs["ome"] = {"version": "0.5", "plate": {"wells": []}}
    assert "a plate" in refused(tmp_path / "plate.zarr")
    group = zarr.open_group(tmp_path / "two.zarr", mode="w")
    for name in "ab":
        group.create_array(name, shape=(9, 9, 9), dtype="uint8")
    assert "two.zarr/a" in refused(tmp_path / "two.zarr")
    array = zarr.create_array(tmp_path / "c.zarr", shape=(9, 9, 9), dtype="uint8", chunks=(9, 9, 9))
    array[:] = 7
    chunk = tmp_path / "c.zarr" / "c" / "0" / "0" / "0"
    chunk.write_bytes(chunk.read_bytes()[:-3])
    assert "damaged" in refused(tmp_path / "c.zarr", *GIVEN)


def vtk_image(image, cells=False):
    grid = pyvista.ImageData(dimensions=np.add(image.shape, int(cells)), spacing=SPACING, origin=(-3.0, 4.5, 1000.25))
    data = grid.cell_data if cells else grid.point_data
    data["labels"] = image.ravel(order="F")
    data.active_scalars_name = "labels"
    return grid


VTK_TYPES = ["uint8", "int8", "uint16", "int16", "uint32", "int32", "int64", "float32", "float64"]


@pytest.mark.parametrize("dtype", VTK_TYPES)
@pytest.mark.parametrize("binary", [True, False])
@pytest.mark.parametrize("cells", [True, False])
def test_legacy_vtk(tmp_path, dtype, binary, cells):
    image = labels(dtype)
    vtk_image(image, cells).save(tmp_path / "a.vtk", binary=binary)
    origin = np.array([-3.0, 4.5, 1000.25]) + (np.divide(SPACING, 2) if cells else 0)
    check(tmp_path / "a.vtk", image, placed(origin), tolerance=1e-4)


def test_legacy_vtk_by_simpleitk(tmp_path):
    image = labels("int16")
    itk = sitk.GetImageFromArray(stored(image))
    itk.SetSpacing(SPACING)
    sitk.WriteImage(itk, tmp_path / "a.vtk")
    check(tmp_path / "a.vtk", image, placed())


def test_legacy_vtk_of_other_data(tmp_path):
    pyvista.RectilinearGrid([0, 1, 3], [0, 1, 2], [0, 1, 2]).save(tmp_path / "a.vtk")
    assert "images are STRUCTURED_POINTS" in refused(tmp_path / "a.vtk")


@pytest.mark.parametrize("mode", ["Ascii", "Binary", "Appended"])
@pytest.mark.parametrize("compressed", [True, False])
@pytest.mark.parametrize("big", [True, False])
@pytest.mark.parametrize("wide", [True, False])
def test_vti_by_vtk(tmp_path, mode, compressed, big, wide):
    for dtype in VTK_TYPES:
        image = labels(dtype)
        for cells in [False, True]:
            grid = vtk_image(image, cells)
            grid.direction_matrix = oblique()[:3, :3] / np.linalg.norm(oblique()[:3, :3], axis=0)
            for encoded in [True, False] if mode == "Appended" else [True]:
                writer = vtkXMLImageDataWriter()
                writer.SetFileName(str(tmp_path / "a.vti"))
                writer.SetInputData(grid)
                getattr(writer, f"SetDataModeTo{mode}")()
                writer.SetCompressorTypeToZLib() if compressed else writer.SetCompressorTypeToNone()
                writer.SetByteOrderToBigEndian() if big else writer.SetByteOrderToLittleEndian()
                writer.SetHeaderTypeToUInt64() if wide else writer.SetHeaderTypeToUInt32()
                writer.SetEncodeAppendedData(encoded)
                writer.SetBlockSize(4096)
                assert writer.Write() == 1
                turned = np.eye(4)
                turned[:3, :3] = grid.direction_matrix * SPACING
                turned[:3, 3] = grid.origin
                first = np.eye(4)
                first[:3, 3] = 0.5 if cells else 0
                check(tmp_path / "a.vti", image, turned @ first, tolerance=1e-4)


@pytest.mark.parametrize("mode", ["Ascii", "Binary", "Appended"])
def test_vti_with_other_arrays(tmp_path, mode):
    """What is called the scalars is meant, of cells too; marks of what does not count are no voxels."""

    def write(name, grid):
        writer = vtkXMLImageDataWriter()
        writer.SetFileName(str(tmp_path / name))
        writer.SetInputData(grid)
        getattr(writer, f"SetDataModeTo{mode}")()
        assert writer.Write() == 1
        return tmp_path / name

    image = labels("uint8")
    grid = vtk_image(image, cells=True)
    grid.point_data["stray"] = np.ones(grid.n_points, "uint8")
    grid.point_data.active_scalars_name = None
    grid.cell_data.active_scalars_name = "labels"
    middle = np.add([-3.0, 4.5, 1000.25], np.divide(SPACING, 2))
    check(write("a.vti", grid), image, placed(middle), tolerance=1e-4)
    marked = pyvista.ImageData(dimensions=image.shape, spacing=SPACING, origin=(-3.0, 4.5, 1000.25))
    marked.point_data["vtkGhostType"] = np.zeros(image.size, "uint8")
    marked.point_data["labels"] = image.ravel(order="F")
    marked.point_data.active_scalars_name = None
    check(write("b.vti", marked), image, placed([-3.0, 4.5, 1000.25]), tolerance=1e-4)
    marked.save(tmp_path / "b.vtk", binary=False)
    assert "vtkGhostType" in refused(tmp_path / "b.vtk")


def test_vti_that_is_refused(tmp_path):
    grid = vtk_image(labels("uint8"))
    grid.point_data["labels"] = np.zeros((grid.n_points, 3), "uint8")
    grid.save(tmp_path / "a.vti")
    assert "3 components" in refused(tmp_path / "a.vti")
    vtk_image(labels("uint8")).save(tmp_path / "b.vti")
    whole = (tmp_path / "b.vti").read_bytes()
    for part in [0.1, 0.5, 0.9]:
        (tmp_path / "b.vti").write_bytes(whole[: int(part * len(whole))])
        assert "b.vti" in refused(tmp_path / "b.vti")
