"""Meshes and their arrays, read back by VTK, trimesh, meshio and nibabel: the same numbers in the same place."""

import json
import struct

import meshio
import nibabel as nib
import numpy as np
import pytest
import pyvista
import trimesh
import vtk
from conftest import lumpy, mirrored, oblique, save_mask, surfometry
from scipy import ndimage, spatial

SCALARS = [
    "mean_curvature_per_mm",
    "gaussian_curvature_per_mm2",
    "k1_per_mm",
    "k2_per_mm",
    "shape_index",
    "curvedness_per_mm",
    "displacement_mm",
]
VECTORS = ["normal", "direction_1", "direction_2"]
FILES = ["m.vtp", "m.ply", "m.stl", "m.obj", "m.glb", "m.surf.gii", "m.csv"]


AFFINES = {"oblique": oblique(), "mirrored": mirrored(), "phantom": None}
ELLIPSOID = "ellipsoid?radii=12,9,7&rotate=20,30,40&shift=0.3,0.2,0.1&spacing=0.8,1,1.2"


class Surface:
    """One object in all formats; the numbers to compare with are those of VTP, which has all digits."""

    def __init__(self, folder, kind):
        self.folder = folder
        source = mask = folder / "mask.nii.gz"
        if kind == "phantom":
            source = f"phantom:{ELLIPSOID}"
            surfometry("phantom", ELLIPSOID, "-o", mask)
        else:
            # Smoothed, so that the blur of the method moves its centroid by little.
            blurred = ndimage.gaussian_filter(np.pad(lumpy((48, 42, 36), 7), 6).astype(float), 4.0)
            save_mask(mask, blurred > 0.5, AFFINES[kind])
        self.image = nib.load(mask)
        outputs = [argument for name in FILES for argument in ("-o", folder / name)]
        surfometry("map", source, "--sigma", "1.2", *outputs)
        with pyvista.VtkErrorCatcher(raise_errors=True):
            self.vtp = pyvista.read(self["m.vtp"])
        self.vertices = np.asarray(self.vtp.points)
        self.triangles = self.vtp.regular_faces
        self.arrays = {name: np.asarray(self.vtp.point_data[name]) for name in SCALARS + VECTORS}
        self.colors = np.asarray(self.vtp.point_data["color"])

    def __getitem__(self, name):
        return self.folder / name

    def glb(self):
        """The JSON chunk and the binary one, by the specification's own layout."""
        data = self["m.glb"].read_bytes()
        magic, version, total, length, kind = struct.unpack("<4sII I4s", data[:20])
        assert (magic, version, total, kind) == (b"glTF", 2, len(data), b"JSON")
        binary_length, binary_kind = struct.unpack("<I4s", data[20 + length : 28 + length])
        assert binary_kind == b"BIN\0"
        assert binary_length == len(data) - 28 - length
        assert length % 4 == binary_length % 4 == 0
        return json.loads(data[20 : 20 + length]), data[28 + length :]


@pytest.fixture(scope="module", params=AFFINES)
def surface(request, tmp_path_factory):
    return Surface(tmp_path_factory.mktemp(request.param), request.param)


def same(actual, expected):
    """The double, or its nearest float where that is what was stored."""
    actual = np.asarray(actual)
    stored = expected if actual.dtype == np.float64 else np.asarray(expected).astype(np.float32)
    np.testing.assert_array_equal(actual, stored)


def same_single(actual, expected):
    """For readers that turn the floats of a file into doubles."""
    np.testing.assert_array_equal(np.asarray(actual, dtype=np.float32), np.asarray(expected, dtype=np.float32))


def geometries(surface):
    """Vertices and triangles by every format and reader."""
    yield "vtp vtk", surface.vertices, surface.triangles
    for name in ["m.ply", "m.stl", "m.obj", "m.glb"]:
        mesh = trimesh.load_mesh(surface[name], process=False, maintain_order=True)
        if isinstance(mesh, trimesh.Scene):
            (mesh,) = mesh.geometry.values()
        yield f"{name} trimesh", mesh.vertices, mesh.faces
    for name in ["m.ply", "m.stl", "m.obj"]:
        with pyvista.VtkErrorCatcher(raise_errors=True):
            mesh = pyvista.read(surface[name])
        yield f"{name} vtk", mesh.points, mesh.regular_faces
    for name in ["m.ply", "m.obj"]:
        mesh = meshio.read(surface[name])
        # meshio takes the colours behind OBJ's positions for more of these.
        yield f"{name} meshio", mesh.points[:, :3], mesh.cells_dict["triangle"]
    gifti = nib.load(surface["m.surf.gii"])
    yield "gifti nibabel", *gifti.agg_data(("pointset", "triangle"))


def volume_and_centroid(vertices, triangles):
    """Of the closed mesh: signed tetrahedra."""
    origin = vertices[0].astype(np.float64)
    a, b, c = (vertices[triangles[:, i]] - origin for i in range(3))
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
    return volumes.sum(), origin + (volumes[:, None] * (a + b + c)).sum(axis=0) / (4 * volumes.sum())


def test_every_reader_sees_the_same_triangles_right_side_out(surface):
    expected = surface.vertices[surface.triangles]
    volume, centroid = volume_and_centroid(surface.vertices, surface.triangles)
    assert volume > 0
    for name, vertices, triangles in geometries(surface):
        same_single(vertices[triangles], expected)
        if "stl" not in name:
            np.testing.assert_array_equal(triangles, surface.triangles, err_msg=name)
            same_single(vertices, surface.vertices)
        found = volume_and_centroid(np.asarray(vertices), np.asarray(triangles))
        assert found[0] == pytest.approx(volume, rel=1e-4), name
        np.testing.assert_allclose(found[1], centroid, atol=1e-3, err_msg=name)


def test_the_mesh_lies_where_the_mask_does(surface):
    mask, affine = np.asarray(surface.image.dataobj) == 1, surface.image.affine
    centroid = nib.affines.apply_affine(affine, np.argwhere(mask).mean(axis=0))
    both_sides = ndimage.binary_dilation(mask) ^ ndimage.binary_erosion(mask)
    tree = spatial.cKDTree(np.argwhere(both_sides))
    for name, vertices, triangles in geometries(surface):
        found = volume_and_centroid(np.asarray(vertices), np.asarray(triangles))[1]
        np.testing.assert_allclose(found, centroid, atol=0.1, err_msg=name)
        indices = nib.affines.apply_affine(np.linalg.inv(affine), vertices)
        assert tree.query(indices, p=np.inf)[0].max() < 1, name


def test_the_arrays_are_what_their_names_say(surface):
    a = surface.arrays
    for name in VECTORS:
        np.testing.assert_allclose(np.linalg.norm(a[name], axis=1), 1, atol=1e-6)
    for first, second in [(0, 1), (0, 2), (1, 2)]:
        dots = np.einsum("ij,ij->i", a[VECTORS[first]], a[VECTORS[second]])
        np.testing.assert_allclose(dots, 0, atol=1e-6)
    k1, k2 = a["k1_per_mm"], a["k2_per_mm"]
    assert (k1 >= k2).all()
    np.testing.assert_allclose((k1 + k2) / 2, a["mean_curvature_per_mm"], atol=1e-9)
    np.testing.assert_allclose(k1 * k2, a["gaussian_curvature_per_mm2"], atol=1e-9)
    np.testing.assert_allclose(np.sqrt((k1**2 + k2**2) / 2), a["curvedness_per_mm"], atol=1e-9)
    assert (np.abs(a["shape_index"]) <= 1).all()
    # Outward: with the triangles around each vertex.
    corners = surface.vertices[surface.triangles]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    around = np.zeros_like(surface.vertices)
    for i in range(3):
        np.add.at(around, surface.triangles[:, i], areas)
    assert (np.einsum("ij,ij->i", around, a["normal"]) > 0).all()


def test_vtp(surface):
    data = surface.vtp.point_data
    assert (data.active_normals_name, data.active_scalars_name) == ("normal", "mean_curvature_per_mm")
    assert surface.vertices.dtype == np.float64
    assert all(values.dtype == np.float64 for values in surface.arrays.values())
    assert list(surface.vtp.field_data["SPACE"]) == ["RAS"]
    assert "surfometry" in surface.vtp.field_data["title"][0]


def test_ply(surface):
    points = meshio.read(surface["m.ply"])
    same(points.points, surface.vertices)
    raw = trimesh.load(surface["m.ply"], process=False).metadata["_ply_raw"]["vertex"]["data"]
    for read in [points.point_data, raw]:
        for name in SCALARS:
            same(np.ravel(read[name]), surface.arrays[name])
        for name, columns in [("normal", ["nx", "ny", "nz"])] + [
            (name, [f"{name}_{axis}" for axis in "xyz"]) for name in VECTORS[1:]
        ]:
            same(np.column_stack([np.ravel(read[c]) for c in columns]), surface.arrays[name])
        for i, name in enumerate(["red", "green", "blue"]):
            # meshio takes uchar for a signed type.
            np.testing.assert_array_equal(np.ravel(read[name]).astype(np.uint8), surface.colors[:, i])
    with_vtk = pyvista.read(surface["m.ply"])
    np.testing.assert_array_equal(with_vtk["RGB"], surface.colors)
    same_single(with_vtk["Normals"], surface.arrays["normal"])


def test_obj(surface):
    mesh = trimesh.load_mesh(surface["m.obj"], process=False, maintain_order=True)
    same(np.asarray(mesh.vertices), surface.vertices)
    np.testing.assert_array_equal(mesh.visual.vertex_colors[:, :3], surface.colors)
    same_single(meshio.read(surface["m.obj"]).point_data["obj:vn"], surface.arrays["normal"])


def test_stl_normals(surface):
    record = np.dtype([("normal", "<3f4"), ("corners", "<(3,3)f4"), ("attribute", "<u2")])
    records = np.frombuffer(surface["m.stl"].read_bytes(), record, offset=84)
    a, b, c = surface.vertices[surface.triangles].transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    solid = lengths > 0
    np.testing.assert_allclose(records["normal"][solid], (normals / lengths[:, None])[solid], atol=1e-6)
    assert (records["normal"][~solid] == 0).all()


def test_3d_slicer_finds_the_space_where_it_looks(surface):
    # The calls of vtkMRMLModelStorageNode::ReadDataInternal.
    ply, stl, obj = vtk.vtkPLYReader(), vtk.vtkSTLReader(), vtk.vtkOBJReader()
    for reader, name in [(ply, "m.ply"), (stl, "m.stl"), (obj, "m.obj")]:
        reader.SetFileName(str(surface[name]))
        reader.Update()
    comments = ply.GetComments()
    assert "SPACE=RAS" in [comments.GetValue(i) for i in range(comments.GetNumberOfValues())]
    for text in [stl.GetHeader(), obj.GetComment()]:
        assert "SPACE=RAS" in text and "surfometry" in text


def test_glb_attributes(surface):
    root, binary = surface.glb()
    assert root["asset"]["version"] == "2.0"
    assert "surfometry" in root["asset"]["extras"]["title"]
    primitive = root["meshes"][0]["primitives"][0]
    for accessor in root["accessors"]:
        view = root["bufferViews"][accessor["bufferView"]]
        assert view["byteOffset"] % 4 == 0
        width = {"SCALAR": 1, "VEC3": 3}[accessor["type"]]
        assert view["byteLength"] == 4 * width * accessor["count"]
        assert view["target"] == (34963 if accessor["componentType"] == 5125 else 34962)
    assert sum(view["byteLength"] for view in root["bufferViews"]) == root["buffers"][0]["byteLength"] == len(binary)
    positions = root["accessors"][primitive["attributes"]["POSITION"]]
    single = surface.vertices.astype(np.float32)
    np.testing.assert_array_equal(np.float32(positions["min"]), single.min(axis=0))
    np.testing.assert_array_equal(np.float32(positions["max"]), single.max(axis=0))

    scene = trimesh.load(surface["m.glb"], process=False)
    np.testing.assert_array_equal(scene.graph.get(next(iter(scene.graph.nodes_geometry)))[0], np.eye(4))
    (mesh,) = scene.geometry.values()
    same_single(mesh.vertex_normals, surface.arrays["normal"])
    for name in SCALARS + VECTORS[1:]:
        same(np.squeeze(mesh.vertex_attributes[f"_{name.upper()}"]), surface.arrays[name])
    # Linear light in the file; back to sRGB there is no step lost.
    view = root["bufferViews"][root["accessors"][primitive["attributes"]["COLOR_0"]]["bufferView"]]
    light = np.frombuffer(binary, "<f4", view["byteLength"] // 4, view["byteOffset"]).reshape(-1, 3)
    encoded = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    np.testing.assert_array_equal(np.round(255 * encoded), surface.colors)
    np.testing.assert_array_equal(mesh.visual.vertex_attributes["color"], light)


def test_gifti(surface):
    gifti = nib.load(surface["m.surf.gii"])
    (points,) = gifti.get_arrays_from_intent("NIFTI_INTENT_POINTSET")
    system = points.coordsys
    assert nib.nifti1.xform_codes.label[system.dataspace] == "scanner"
    np.testing.assert_array_equal(system.xform, np.eye(4))
    assert len(gifti.darrays) == 2 and "surfometry" in gifti.meta["Title"]
    for name, intent, wanted in [("shape", "SHAPE", SCALARS), ("vector", "VECTOR", VECTORS)]:
        beside = nib.load(surface[f"m.{name}.gii"])
        arrays = beside.get_arrays_from_intent(f"NIFTI_INTENT_{intent}")
        assert sorted(array.meta["Name"] for array in arrays) == sorted(wanted)
        assert len(arrays) == len(beside.darrays)
        for array in arrays:
            same(array.data, surface.arrays[array.meta["Name"]])


def test_csv(surface):
    table = np.genfromtxt(surface["m.csv"], delimiter=",", names=True)
    assert table.dtype.names[:3] == ("x_mm", "y_mm", "z_mm")
    same(np.column_stack([table[f"{axis}_mm"] for axis in "xyz"]), surface.vertices)
    for name in SCALARS:
        same(table[name], surface.arrays[name])
    for name in VECTORS:
        same(np.column_stack([table[f"{name}_{axis}"] for axis in "xyz"]), surface.arrays[name])
