"""The classical methods against scikit-image, DIPlib and Karambola."""

import json

import diplib as dip
import nibabel as nib
import numpy as np
import pykarambola as karambola
import pytest
from conftest import surfometry
from scipy import ndimage
from skimage import measure

SPACING = (0.8, 1.0, 1.3)


def values(path):
    records = json.loads(surfometry("reference", path, "--format", "json"))["results"]
    return {record["method"]: record for record in records}


def save(mask, path, spacing=SPACING):
    nib.save(nib.Nifti1Image(mask.astype(np.uint8), np.diag([*spacing, 1])), path)
    return path


@pytest.mark.parametrize("seed", range(4))
def test_euler_numbers_of_random_masks(tmp_path, seed):
    """Exactly twice scikit-image's, both adjacencies."""
    mask = np.random.default_rng(seed).random((14, 11, 9)) < 0.2 + 0.15 * seed
    found = values(save(mask, tmp_path / "mask.nii"))
    for connectivity, name in ((3, "odgaard-gundersen-26"), (1, "odgaard-gundersen-6")):
        assert found[name]["euler_characteristic"] == 2 * measure.euler_number(mask, connectivity)


def test_areas_of_an_ellipsoid(tmp_path):
    """A of voxel faces exactly; triangulated areas as of marching cubes, whose tables triangulate a mask's vertices a little less tightly."""
    grid = np.stack(np.indices((70, 60, 50)), -1) - (34.3, 29.6, 24.8)
    turned = grid * SPACING @ np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    mask = (turned**2 / np.square((23, 18, 15))).sum(-1) < 1
    found = values(save(mask, tmp_path / "mask.nii"))

    padded = np.pad(mask, 1).astype(np.int8)
    faces = [np.abs(np.diff(padded, axis=axis)).sum() * np.delete(SPACING, axis).prod() for axis in range(3)]
    np.testing.assert_allclose(found["voxels"]["surface_area_mm2"], sum(faces), rtol=1e-6)

    def area(field, level):
        vertices, triangles, _, _ = measure.marching_cubes(field, level, spacing=SPACING)
        return measure.mesh_surface_area(vertices, triangles)

    assert 0.99 < found["triangulation"]["surface_area_mm2"] / area(padded.astype(float), 0.5) < 1
    sigma = 0.8 * np.prod(SPACING) ** (1 / 3) / np.array(SPACING)
    smoothed = ndimage.gaussian_filter(np.pad(mask, 4).astype(float), sigma)
    np.testing.assert_allclose(found["triangulation-smoothed"]["surface_area_mm2"], area(smoothed, 0.5), rtol=2e-3)
    total = mask.size * np.prod(SPACING)
    np.testing.assert_allclose(found["voxels"]["bone_volume_fraction"], mask.sum() * np.prod(SPACING) / total)


def ellipsoid_mask():
    """Rotated and off the grid, half-axes of 23, 18 and 15 cubic voxels."""
    grid = np.stack(np.indices((70, 60, 50)), -1) - (34.3, 29.6, 24.8)
    turned = grid @ np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    return (turned**2 / np.square((23, 18, 15))).sum(-1) < 1


def test_weighted_neighbourhoods_against_diplib(tmp_path):
    """DIPlib weighs voxels by their free faces (Mullikin and Verbeek), as unbiased on planes as Lindblad's weights and Crofton's lines are."""
    mask = ellipsoid_mask()
    area = np.array(dip.MeasurementTool.Measure(dip.Label(dip.Image(mask)), features=["SurfaceArea"]))[0, 0]
    found = values(save(mask, tmp_path / "mask.nii", (1, 1, 1)))
    for method in ("lindblad", "crofton-13"):
        assert found[method]["surface_area_mm2"] == pytest.approx(area, rel=2e-3)


def test_minkowski_functionals_against_karambola(tmp_path):
    """V, A / 3 and M / 3 of marching cubes on the blurred mask are Karambola's W0, W1 and W2, M from the dihedral angles of a mesh."""
    mask = ellipsoid_mask()
    blurred = ndimage.gaussian_filter(mask.astype(float), 0.8)
    vertices, faces, *_ = measure.marching_cubes(blurred, 0.5)
    surface = karambola.minkowski_tensors(vertices.astype(float), faces[:, ::-1], compute=["w000", "w100", "w200"])
    found = values(save(mask, tmp_path / "mask.nii", (1, 1, 1)))["triangulation-smoothed"]
    for name, key, factor in (("volume_mm3", "w000", 1), ("surface_area_mm2", "w100", 3), ("total_mean_curvature_mm", "w200", 3)):
        assert found[name] == pytest.approx(abs(factor * surface[key]), rel=5e-3), name
