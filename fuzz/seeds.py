#!/usr/bin/env python3
"""Writes the seeds of `fuzz/corpus/`: small right files of each kind by other programs: target/oracles/bin/python fuzz/seeds.py

A seed has two labels in 6 x 5 x 4 voxels, a tetrahedron, or a few rows.
"""

import io
import pathlib
import shutil
import sys
import tempfile

import nibabel as nib
import numpy as np
import py_aimio
import pydicom
import pyvista
import SimpleITK as sitk
import tifffile
import trimesh
import zarr

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "tests" / "oracles"))
from test_dicom import segmentation, slice_of  # noqa: E402

SPACING = (0.8, 1.0, 1.5)
x, y, z = np.indices((6, 5, 4))
BODY = np.where((7 * x * y + 13 * y * z + 5 * z * x) % 11 < 6, 1, 3).astype("uint8")
BODY[[0, -1]] = BODY[:, [0, -1]] = BODY[:, :, [0, -1]] = 0
AFFINE = np.diag([*SPACING, 1.0])
TETRAHEDRON = trimesh.Trimesh([[0, 0, 0], [6, 0, 1], [0, 6, 1], [1, 1, 6]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


def images(folder):
    """(target, file) of images."""

    def at(target, name):
        return target, folder / name

    for number, kind in enumerate([nib.Nifti1Image, nib.Nifti2Image]):
        target, path = at("nii", f"{number}.nii")
        nib.save(kind(BODY.astype("int16" if number else "uint8"), AFFINE), path)
        yield target, path
    target, path = at("mgh", "a.mgh")
    nib.save(nib.MGHImage(BODY, AFFINE), path)
    yield target, path
    image = sitk.GetImageFromArray(BODY.T)
    image.SetSpacing(SPACING)
    for target in ["mha", "nrrd"]:
        for packed in [False, True]:
            path = folder / f"{packed}.{target}"
            sitk.WriteImage(image, str(path), useCompression=packed)
            yield target, path
    for key, value in {"ID": "first", "Name": "first", "LabelValue": "1", "Layer": "0", "Color": "1 0 0"}.items():
        image.SetMetaData(f"Segment0_{key}", value)
        image.SetMetaData(f"Segment1_{key}", value.replace("first", "second").replace("1", "3") if key != "Layer" else "0")
    path = folder / "a.seg.nrrd"
    sitk.WriteImage(image, str(path))
    yield "seg_nrrd", path
    for order in "CF":
        path = folder / f"{order}.npy"
        np.save(path, np.asarray(BODY, order=order))
        yield "npy", path
    for name, options in {
        "plain": {},
        "deflate": {"compression": "zlib", "byteorder": ">"},
        "tiles": {"tile": (16, 16)},
        "imagej": {"imagej": True, "resolution": (1, 1), "metadata": {"unit": "mm", "spacing": 1.5, "axes": "ZYX"}},
        "bigtiff": {"bigtiff": True},
    }.items():
        path = folder / f"{name}.tif"
        tifffile.imwrite(path, BODY.T, photometric="minisblack", **options)
        yield "tif", path
    path = folder / "slice.dcm"
    slice_of(BODY.astype("uint16"), 1).save_as(path, enforce_file_format=True)
    yield "dcm", path
    for kind in ["BINARY", "LABELMAP"]:
        path = folder / f"{kind.lower()}.dcm"
        yield "dcm", segmentation(path, [BODY == 1, BODY == 3], ["first", "second"], kind)
    for kind in ["runs", "int16"]:
        path = folder / f"{kind}.aim"
        voxels = (BODY == 1).astype("int8") * 127 if kind == "runs" else BODY.astype(kind)
        py_aimio.write_aim(str(path), np.ascontiguousarray(voxels.T), {"element_size": SPACING, "position": [3, -5, 7]})
        yield "aim", path
    header = np.zeros(128, "<i4")
    header.view("S16")[0] = b"CTDATA-HEADER_V1"
    header[[5, *range(11, 14), *range(14, 17)]] = [-1, *BODY.shape, *(int(1000 * h * n) for h, n in zip(SPACING, BODY.shape))]
    path = folder / "a.isq"
    path.write_bytes((header.tobytes() + (BODY.T.astype("<i2") * 4000).tobytes()).ljust(1024, b"\0"))
    yield "isq", path
    grid = pyvista.ImageData(dimensions=BODY.shape, spacing=SPACING)
    grid.point_data["labels"] = BODY.ravel(order="F")
    for ending in ["vtk", "vti"]:
        for binary in [True, False]:
            path = folder / f"{binary}.{ending}"
            grid.save(path, binary=binary)
            yield ending, path


def meshes(folder):
    """(target, file) of meshes."""
    for ending in ["stl", "ply", "obj", "off", "glb"]:
        path = folder / f"mesh.{ending}"
        TETRAHEDRON.export(path)
        yield ending, path
    for target, ending in {"stl": "stl_ascii", "ply": "ply"}.items():
        path = folder / f"text.{target}"
        text = {"encoding": "ascii"} if target == "ply" else {}
        written = trimesh.exchange.export.export_mesh(TETRAHEDRON, io.BytesIO(), file_type=ending, **text)
        path.write_bytes(written if isinstance(written, bytes) else written.encode())
        yield target, path
    surface = pyvista.wrap(TETRAHEDRON)
    for binary in [True, False]:
        for ending in ["vtp", "vtk"]:
            path = folder / f"mesh_{binary}.{ending}"
            surface.save(path, binary=binary)
            yield ending, path
    path = folder / "a.gii"
    points = nib.gifti.GiftiDataArray(TETRAHEDRON.vertices.astype("float32"), "NIFTI_INTENT_POINTSET", "NIFTI_TYPE_FLOAT32")
    faces = nib.gifti.GiftiDataArray(TETRAHEDRON.faces.astype("int32"), "NIFTI_INTENT_TRIANGLE", "NIFTI_TYPE_INT32")
    nib.save(nib.gifti.GiftiImage(darrays=[points, faces]), path)
    yield "gii", path


def arrays(folder):
    """(target, file) of Zarr arrays: metadata, a NUL byte, the chunk."""
    codecs = {"plain": None, "gzip": zarr.codecs.GzipCodec(), "zstd": zarr.codecs.ZstdCodec(), "blosc": zarr.codecs.BloscCodec(cname="lz4")}
    for name, codec in codecs.items():
        store = folder / f"{name}.zarr"
        array = zarr.create_array(store, shape=BODY.T.shape, dtype="uint8", chunks=BODY.T.shape, compressors=codec)
        array[:] = BODY.T
        path = folder / f"{name}.parts"
        path.write_bytes((store / "zarr.json").read_bytes() + b"\0" + (store / "c/0/0/0").read_bytes())
        yield "zarr", path


TEXTS = {
    "table": {
        "ours.csv": "input,label,name,volume_mm3,surface_area_mm2,euler_characteristic\n"
        + "".join(f"scan{n}.nii,1,,{100 + 7 * n % 13},{60.5 + 3 * n % 7},{2 - n % 2 * 2}\n" for n in range(8)),
        "theirs.tsv": "ID\tBV (mm³)\n" + "".join(f"case {n}\t{1.5 * n}\n" for n in range(7)),
    },
    "names": {
        "dataset.json": '{"labels": {"background": 0, "whole": [1, 2], "core": 2}}',
        "itksnap.txt": '    0     0    0    0        0  0  0    "Clear Label"\n    1   255    0    0        1  1  1    "Femur"\n',
        "freesurfer.txt": "#No. Label Name: R G B A\n2 Left-Cerebral-White-Matter 245 245 245 0\n",
        "names.csv": "label,name\n1,femur\n2,tibia\n",
    },
}


def main():
    corpus = HERE / "corpus"
    shutil.rmtree(corpus, ignore_errors=True)
    with tempfile.TemporaryDirectory() as made:
        for target, path in [found for make in (images, meshes, arrays) for found in make(pathlib.Path(made))]:
            (corpus / target).mkdir(parents=True, exist_ok=True)
            shutil.copy(path, corpus / target / path.name)
    for target, files in TEXTS.items():
        (corpus / target).mkdir()
        for name, text in files.items():
            (corpus / target / name).write_text(text)
    for target in ["object", "speck"]:
        (corpus / target).mkdir()
        for number in range(4):
            (corpus / target / f"{number}").write_bytes(np.random.default_rng(number).bytes(40 + 60 * number))


main()
