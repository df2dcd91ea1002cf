"""Voxel maps, read by nibabel: on the input's grid, SciPy's numbers, and sums that are the measured integrals."""

import nibabel as nib
import numpy as np
import pytest
import SimpleITK as sitk
from conftest import curvatures, gaussian_derivatives, lumpy, measure, mirrored, oblique, save_mask, surfometry
from scipy import ndimage

NAMES = {
    "mean-curvature": "mean_curvature_per_mm",
    "gaussian-curvature": "gaussian_curvature_per_mm2",
    "delta": "delta_per_mm",
    "phi": "phi",
    "band": "band",
}
SIGMA = 2.0
AFFINES = {"oblique": oblique(), "mirrored": mirrored()}


class Maps:
    """All maps of one file, and what was measured of it."""

    def __init__(self, path, *options):
        self.source = nib.load(path)
        (self.record,) = measure(path, *options)
        surfometry("map", path, *options, "--voxels", ",".join(NAMES), "-o", path.with_name("m.nii.gz"))
        self.images = {key: nib.load(path.with_name(f"m_{name}.nii.gz")) for key, name in NAMES.items()}
        self.cell = abs(np.linalg.det(self.source.affine[:3, :3]))

    def __getitem__(self, key):
        return np.asarray(self.images[key].dataobj).astype(np.float64)

    def check_integrals(self, rel):
        """Of the surface, by sums over voxels: area, total mean curvature, Euler characteristic."""
        element = self["delta"] * self.cell
        found = [
            element.sum(),
            (element * self["mean-curvature"]).sum(),
            (element * self["gaussian-curvature"]).sum() / (2 * np.pi),
        ]
        names = ["surface_area_mm2", "total_mean_curvature_mm", "euler_characteristic"]
        np.testing.assert_allclose(found, [self.record["blurred"][name] for name in names], rtol=rel)


@pytest.fixture(scope="module", params=AFFINES)
def maps(request, tmp_path_factory):
    path = tmp_path_factory.mktemp(request.param) / "mask.nii.gz"
    # Clear of the border by more than the kernels' reach, so that no map is cut.
    return Maps(save_mask(path, np.pad(lumpy((42, 36, 30), 3), 14), AFFINES[request.param]), "--sigma", SIGMA)


def test_maps_lie_on_the_inputs_grid(maps):
    for key, image in maps.images.items():
        assert image.shape == maps.source.shape
        assert image.get_data_dtype() == np.float32
        np.testing.assert_allclose(image.affine, maps.source.affine, atol=1e-6)
        np.testing.assert_allclose(image.get_qform(), image.get_sform(), atol=1e-4)
        assert image.header["descrip"].item() == NAMES[key].encode()


def test_sums_over_voxels_are_the_integrals(maps):
    maps.check_integrals(rel=1e-5)


def test_phi_is_the_blurred_mask(maps):
    spacing = maps.source.header.get_zooms()
    mask = np.asarray(maps.source.dataobj).astype(np.float64)
    blurred = ndimage.gaussian_filter(mask, [SIGMA / h for h in spacing], truncate=5.0, mode="constant")
    # Kernels end at 5 sigma in both, to a voxel.
    np.testing.assert_allclose(maps["phi"], 0.5 - blurred, atol=1e-5)
    inside = (maps["phi"] < 0).sum() * maps.cell
    assert inside == pytest.approx(maps.record["blurred"]["volume_mm3"], rel=1e-2)
    assert inside == pytest.approx(maps.record["mesh"]["volume_mm3"], rel=1e-2)


def test_the_band_is_where_phi_is_small_and_curvature_is_there_only(maps):
    band, distance = maps["band"], np.abs(maps["phi"]) - maps.record["parameters"]["epsilon"]
    assert set(np.unique(band)) == {0.0, 1.0}
    # Rounded to single precision at the rim.
    clear = np.abs(distance) > 1e-6
    np.testing.assert_array_equal(band[clear], (distance < 0)[clear])
    assert (~clear).sum() < 5
    for key in ["mean-curvature", "gaussian-curvature", "delta"]:
        assert (maps[key][band == 0] == 0).all()
    assert (maps["delta"][band == 1] >= 0).all()


def test_curvature_in_the_band_is_scipys(maps):
    mask = np.asarray(maps.source.dataobj).astype(np.float64)
    band = maps["band"] == 1
    gradient, hessian = gaussian_derivatives(mask, SIGMA, maps.source.header.get_zooms())
    mean, gaussian, norm = curvatures(gradient[:, band], hessian[:, :, band])
    epsilon = maps.record["parameters"]["epsilon"]
    delta = (1 + np.cos(np.pi * maps["phi"][band] / epsilon)) / (2 * epsilon) * norm
    for key, expected in [("mean-curvature", mean), ("gaussian-curvature", gaussian), ("delta", delta)]:
        np.testing.assert_allclose(maps[key][band], expected, atol=2e-3 * np.abs(expected).max())


def test_a_given_field_comes_back(tmp_path):
    # Of a ball of 12 mm; not a distance, so that the gradient varies over the band.
    affine = mirrored()
    index = np.stack(np.meshgrid(*[np.arange(n) for n in (46, 40, 38)], indexing="ij"), axis=-1)
    centre = nib.affines.apply_affine(affine, [22.3, 19.6, 18.2])
    distance = np.linalg.norm(nib.affines.apply_affine(affine, index) - centre, axis=-1)
    field = np.float32(distance - 12 + 0.01 * (distance - 12) ** 2)
    nib.save(nib.Nifti1Image(field, affine), tmp_path / "field.nii")
    maps = Maps(tmp_path / "field.nii", "--embedding", "given")
    np.testing.assert_array_equal(maps["phi"], field)
    maps.check_integrals(rel=1e-5)
    assert maps.record["surface_area_mm2"] == pytest.approx(4 * np.pi * 12**2, rel=5e-3)
    band = maps["band"] == 1
    np.testing.assert_allclose(maps["mean-curvature"][band], 1 / distance[band], rtol=1e-2)
    np.testing.assert_allclose(maps["gaussian-curvature"][band], 1 / distance[band] ** 2, rtol=2e-2)


def test_one_quantity_keeps_the_name(tmp_path):
    surfometry("map", "phantom:ball?radius=6", "-o", tmp_path / "m.nii", "--voxels", "band")
    assert [path.name for path in tmp_path.iterdir()] == ["m.nii"]
    assert nib.load(tmp_path / "m.nii").header["descrip"].item() == b"band"


def test_distances_are_scipys_and_itks(tmp_path):
    """To the voxels' faces, by brute force on a refined lattice along the axes; and zero on boundary voxels, exactly as ITK's."""
    spacing = (0.7, 1.0, 1.6)
    mask = np.pad(lumpy((16, 14, 12), 3), 5).astype(bool)
    path = tmp_path / "mask.nii"
    nib.save(nib.Nifti1Image(mask.astype(np.uint8), np.diag([*spacing, 1])), path)

    def phi(embedding):
        file = tmp_path / f"{embedding}.nii.gz"
        surfometry("map", path, "--embedding", embedding, "--thickness", 4, "--voxels", "phi", "-o", file)
        return np.asarray(nib.load(file).dataobj)

    image = sitk.GetImageFromArray(mask.T.astype(np.uint8))
    image.SetSpacing(spacing)
    itk = sitk.GetArrayFromImage(sitk.SignedMaurerDistanceMap(image, squaredDistance=False, useImageSpacing=True)).T
    near = np.abs(itk) < 3
    np.testing.assert_allclose(phi("distance-to-voxels")[near], itk[near], atol=1e-5)
    # Cubes three times refined have a centre in the middle of each voxel's face, edge and corner, a third of a voxel from its faces.
    fine = np.kron(mask, np.ones((3, 3, 3), bool))
    to_faces = ndimage.distance_transform_edt(~fine, [h / 3 for h in spacing])[1::3, 1::3, 1::3]
    outside = ~mask & (to_faces < 3)
    # From centre to centre of small cubes it is more by up to half of one.
    excess = to_faces[outside] - phi("distance")[outside]
    assert excess.min() > 0 and excess.max() < np.linalg.norm(spacing) / 6 + 1e-6


def touching_labels():
    """Two balls that share a wall and a third beside them, near enough for all their bands to meet."""
    spacing = np.array([0.8, 1.0, 1.3])
    place = np.stack(np.meshgrid(*[np.arange(n) for n in (56, 44, 34)], indexing="ij"), axis=-1) * spacing
    labels = np.zeros(place.shape[:3], np.uint8)
    for label, centre, radius in [(1, (14, 21, 20), 9), (5, (29.3, 21.7, 20.4), 8), (9, (21, 34.2, 22), 5)]:
        labels[(np.linalg.norm(place - centre, axis=-1) < radius) & (labels == 0)] = label
    return labels, np.diag([*spacing, 1])


def test_maps_of_all_labels_in_one_image(tmp_path):
    """A voxel has its own label's value where that has a band there, else that of the nearest surface."""
    labels, affine = touching_labels()
    path = save_mask(tmp_path / "labels.nii.gz", labels, affine)
    kinds = ["mean-curvature", "delta", "phi", "band"]
    options = ["--sigma", 1.6, "--thickness", 4, "--voxels", ",".join(kinds), "--outside", "nan"]
    surfometry("map", path, *options, "-o", tmp_path / "one.nii.gz")
    surfometry("map", path, *options, "--together", "-o", tmp_path / "all.nii.gz")
    records = measure(path, "--sigma", 1.6, "--thickness", 4)

    def load(name):
        return np.asarray(nib.load(tmp_path / name).dataobj)

    apart = {kind: [load(f"one_label-{n}_{NAMES[kind]}.nii.gz") for n in (1, 5, 9)] for kind in kinds}
    together = {kind: load(f"all_{NAMES[kind]}.nii.gz") for kind in kinds}
    epsilon = [record["parameters"]["epsilon"] for record in records]
    in_band = np.stack(apart["band"]) == 1
    own = np.stack([labels == n for n in (1, 5, 9)])
    distance = np.stack([np.abs(phi) / e for phi, e in zip(apart["phi"], epsilon)])
    rank = np.where(in_band, np.where(own, -1, distance), np.inf)
    winner = rank.argmin(axis=0)
    somewhere = in_band.any(axis=0)
    # Bands do overlap, also where none of them is the voxel's own.
    several = in_band.sum(axis=0) > 1
    assert several.sum() > 300 and (several & (labels == 0)).sum() > 100
    for kind, outside in [("mean-curvature", np.nan), ("delta", 0), ("band", 0)]:
        chosen = np.take_along_axis(np.stack(apart[kind]), winner[None], axis=0)[0]
        np.testing.assert_array_equal(together[kind], np.where(somewhere, chosen, outside))
    np.testing.assert_array_equal(together["phi"], np.min(apart["phi"], axis=0))


def test_outside_is_0_or_not_a_number(tmp_path):
    ball = "phantom:ball?radius=7&spacing=1,0.8,1.3&shift=0.3,0.2,0.1"
    maps = {}
    for outside in ["0", "nan"]:
        path = tmp_path / f"m{outside}.nii"
        surfometry("map", ball, "--voxels", "gaussian-curvature,band", "--outside", outside, "-o", path)
        maps[outside] = np.asarray(nib.load(path.with_name(f"m{outside}_{NAMES['gaussian-curvature']}.nii")).dataobj)
        band = np.asarray(nib.load(path.with_name(f"m{outside}_band.nii")).dataobj) == 1
    np.testing.assert_array_equal(np.isnan(maps["nan"]), ~band)
    np.testing.assert_array_equal(np.nan_to_num(maps["nan"]), maps["0"])
