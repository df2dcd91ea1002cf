"""Closed meshes that VTK, PyVista, trimesh, meshio and nibabel write are read as they mean them."""

import gzip

import meshio
import nibabel as nib
import numpy as np
import pytest
import pyvista
import trimesh
import vtk
from conftest import measure, surfometry
from scipy.spatial.transform import Rotation

CENTRE = np.array([20.3, -31.1, 41.7])
SPACING = "0.45,0.5,0.6"


@pytest.fixture(scope="module")
def shape():
    """A turned ellipsoid of 9, 7 and 5 mm, as trimesh has it."""
    mesh = trimesh.creation.icosphere(subdivisions=4)
    turned = Rotation.from_rotvec([0.3, -0.5, 0.7]).apply(mesh.vertices * [9, 7, 5])
    return trimesh.Trimesh(turned + CENTRE, mesh.faces, process=False)


def check(path, shape, centre=CENTRE, times=1.0):
    """The voxels of it have the mesh's own volume, to what a lattice can, and its centroid."""
    (record,) = measure(path, "--spacing", SPACING)
    assert record["voxels"]["volume_mm3"] == pytest.approx(times * shape.volume, rel=3e-3)
    np.testing.assert_allclose(record["voxels"]["centroid_mm"], centre, atol=0.02)
    assert record["flags"] == []


def poly_data(shape):
    return pyvista.PolyData.from_regular_faces(shape.vertices, shape.faces)


def strips(shape):
    stripper = vtk.vtkStripper()
    stripper.SetInputData(poly_data(shape))
    stripper.Update()
    made = stripper.GetOutput()
    assert made.GetNumberOfStrips() > 0
    return made


@pytest.mark.parametrize("data", [poly_data, strips])
@pytest.mark.parametrize("mode", ["Ascii", "Binary", "Appended"])
def test_vtp(tmp_path, shape, data, mode):
    for name, set_up in {
        "zlib": lambda writer: writer.SetCompressorTypeToZLib(),
        "bare": lambda writer: writer.SetCompressorTypeToNone(),
        "raw": lambda writer: writer.EncodeAppendedDataOff(),
        "wide": lambda writer: writer.SetHeaderTypeToUInt64(),
        "big": lambda writer: writer.SetByteOrderToBigEndian(),
    }.items():
        writer = vtk.vtkXMLPolyDataWriter()
        writer.SetInputData(data(shape))
        writer.SetFileName(str(tmp_path / f"{name}.vtp"))
        getattr(writer, f"SetDataModeTo{mode}")()
        set_up(writer)
        assert writer.Write()
        check(tmp_path / f"{name}.vtp", shape)


def test_a_compressor_that_is_not_read_is_named(tmp_path, shape):
    writer = vtk.vtkXMLPolyDataWriter()
    writer.SetInputData(poly_data(shape))
    writer.SetFileName(str(tmp_path / "a.vtp"))
    writer.SetCompressorTypeToLZ4()
    assert writer.Write()
    assert "LZ4" in surfometry("measure", tmp_path / "a.vtp", "--spacing", SPACING, status=1)


@pytest.mark.parametrize("data", [poly_data, strips])
@pytest.mark.parametrize("version", [42, 51])
@pytest.mark.parametrize("binary", [True, False])
def test_legacy_vtk(tmp_path, shape, data, version, binary):
    made = pyvista.wrap(data(shape))
    made.field_data["texts"] = ["one", "two and a half"]
    made.field_data["numbers"] = np.arange(6.0).reshape(3, 2)
    made.point_data["values"] = np.arange(made.n_points)
    writer = vtk.vtkPolyDataWriter()
    writer.SetInputData(made)
    writer.SetFileName(str(tmp_path / "a.vtk"))
    writer.SetFileVersion(version)
    writer.SetHeader("3D Slicer output. SPACE=LPS")
    (writer.SetFileTypeToBinary if binary else writer.SetFileTypeToASCII)()
    assert writer.Write()
    check(tmp_path / "a.vtk", shape, CENTRE * [-1, -1, 1])


@pytest.mark.parametrize("name", ["a.stl", "a.ply", "a.obj", "a.off", "a.glb"])
def test_trimesh(tmp_path, shape, name):
    shape.export(tmp_path / name)
    check(tmp_path / name, shape)
    packed = tmp_path / f"{name}.gz"
    packed.write_bytes(gzip.compress((tmp_path / name).read_bytes()))
    check(packed, shape)


def test_text_forms_of_trimesh(tmp_path, shape):
    shape.export(tmp_path / "a.stl", file_type="stl_ascii")
    shape.export(tmp_path / "a.ply", encoding="ascii")
    for name in ["a.stl", "a.ply"]:
        check(tmp_path / name, shape)


@pytest.mark.parametrize("name", ["a.stl", "a.ply", "a.obj", "a.off", "a.vtk"])
def test_meshio(tmp_path, shape, name):
    meshio.Mesh(shape.vertices, [("triangle", shape.faces)]).write(tmp_path / name)
    if name == "a.vtk":
        # meshio has no poly data.
        # Lines are broken where they are too long.
        failed = " ".join(surfometry("measure", tmp_path / name, "--spacing", SPACING, status=1).split())
        assert "UNSTRUCTURED_GRID" in failed and "extract its surface" in failed
    else:
        check(tmp_path / name, shape)


@pytest.mark.parametrize("name", ["a.stl", "a.ply", "a.vtp"])
@pytest.mark.parametrize("binary", [True, False])
def test_pyvista(tmp_path, shape, name, binary):
    poly_data(shape).save(tmp_path / name, binary=binary)
    check(tmp_path / name, shape)


@pytest.mark.parametrize("encoding", ["ASCII", "B64BIN", "B64GZ"])
@pytest.mark.parametrize("order", ["C", "F"])
def test_gifti(tmp_path, shape, encoding, order):
    arrays = [
        nib.gifti.GiftiDataArray(values.astype(kind), intent, encoding=encoding, ordering=order)
        for values, kind, intent in [
            (shape.vertices, "float32", "NIFTI_INTENT_POINTSET"),
            (shape.faces, "int32", "NIFTI_INTENT_TRIANGLE"),
        ]
    ]
    # As FreeSurfer writes it: a shift from its own axes to the scanner's.
    shift = np.eye(4)
    shift[:3, 3] = [1.5, -2.5, 3.5]
    arrays[0].coordsys = nib.gifti.GiftiCoordSystem(0, 1, shift)
    nib.save(nib.gifti.GiftiImage(darrays=arrays), tmp_path / "a.surf.gii")
    check(tmp_path / "a.surf.gii", shape, CENTRE + shift[:3, 3])
    thickness = nib.gifti.GiftiDataArray(np.ones(len(shape.vertices), "float32"), "NIFTI_INTENT_SHAPE")
    nib.save(nib.gifti.GiftiImage(darrays=[thickness]), tmp_path / "a.shape.gii")
    failed = surfometry("measure", tmp_path / "a.shape.gii", "--spacing", SPACING, status=1)
    assert "POINTSET" in failed and ".surf.gii" in failed


def test_gifti_of_columns_in_one_line(tmp_path, shape):
    """nibabel writes a line a row, whatever the order; in one line the numbers have the order that the file says."""
    arrays = [
        nib.gifti.GiftiDataArray(values.astype(kind), intent, encoding="ASCII", ordering="F")
        for values, kind, intent in [
            (shape.vertices, "float32", "NIFTI_INTENT_POINTSET"),
            (shape.faces, "int32", "NIFTI_INTENT_TRIANGLE"),
        ]
    ]
    text = nib.gifti.GiftiImage(darrays=arrays).to_xml().decode()
    for values in [shape.vertices.astype("float32"), shape.faces]:
        first = text.index("<Data>") + len("<Data>")
        columns = " ".join(map(str, values.flatten("F")))
        text = text[: first - len("<Data>")] + "<data>" + columns + "</data>" + text[text.index("</Data>", first) + len("</Data>") :]
    path = tmp_path / "a.surf.gii"
    path.write_text(text.replace("<data>", "<Data>").replace("</data>", "</Data>"))
    np.testing.assert_array_equal(nib.load(path).agg_data("triangle"), shape.faces)
    check(path, shape)


def test_wavefront_with_comments_behind_faces(tmp_path, shape):
    text = trimesh.exchange.obj.export_obj(shape)
    lines = [line + " # a face" if line.startswith("f ") else line for line in text.splitlines()]
    (tmp_path / "a.obj").write_text("\n".join([*lines, ""]))
    check(tmp_path / "a.obj", shape)


def test_several_objects_in_one_file(tmp_path, shape):
    other = shape.copy()
    other.apply_translation([40, 0, 0])
    both = trimesh.util.concatenate([shape, other])
    solids = [trimesh.exchange.stl.export_stl_ascii(mesh) for mesh in (shape, other)]
    (tmp_path / "two.stl").write_text("".join(solids))
    (tmp_path / "two_binary.stl").write_bytes(shape.export(file_type="stl") + other.export(file_type="stl"))
    both.export(tmp_path / "two.ply")
    trimesh.Scene([shape, other]).export(tmp_path / "two.glb")
    pyvista.merge([poly_data(shape), poly_data(other)]).save(tmp_path / "two.vtp")
    for name in ["two.stl", "two_binary.stl", "two.ply", "two.glb", "two.vtp"]:
        check(tmp_path / name, shape, CENTRE + [20, 0, 0], 2.0)


def test_what_map_writes_is_measured_again(tmp_path):
    """At the same place, with the volume of the mesh that was written."""
    ellipsoid = "phantom:ellipsoid?radii=12,9,7&rotate=20,30,40&shift=3.3,-2.2,9.1&spacing=0.8,1,1.2"
    names = ["m.vtp", "m.ply", "m.stl", "m.obj", "m.glb", "m.surf.gii"]
    surfometry("map", ellipsoid, *[argument for name in names for argument in ("-o", tmp_path / name)])
    truth = trimesh.load_mesh(tmp_path / "m.ply")
    for name in names:
        check(tmp_path / name, truth, truth.center_mass)
