"""`embed` against SciPy's Gaussian filter."""

import itertools
import nibabel as nib
import numpy as np
from conftest import surfometry
from scipy import ndimage

SPACING = np.array((0.8, 1.0, 1.3))
SIGMA = 1.6
AFFINE = np.array([[0, -1.0, 0, 12], [0.8, 0, 0, -7], [0, 0, 1.3, 5], [0, 0, 0, 1]])


def image():
    """Two halves of one slanting ellipsoid, 3 and 700, and a rod, -4, that reaches the border."""
    at = np.stack(np.indices((60, 50, 40)), -1) - (29.7, 25.2, 18.9)
    turned = at * SPACING @ np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    labels = np.zeros(at.shape[:3], np.int16)
    inside = (turned**2 / np.square((18, 13, 11))).sum(-1) < 1
    labels[inside & (turned[..., 0] < 2)] = 3
    labels[inside & (turned[..., 0] >= 2)] = 700
    labels[(at[..., 0] ** 2 + at[..., 1] ** 2 > 27**2) & (at[..., 0] > 0) & (at[..., 1] > 0)] = -4
    return labels


def shares(labels, sigma):
    """The blurred indicator of each label, background beyond the image."""
    blurred = {}
    for label in (-4, 3, 700):
        mask = np.pad((labels == label).astype(float), 12)
        blurred[label] = ndimage.gaussian_filter(mask, sigma / SPACING, truncate=6)[12:-12, 12:-12, 12:-12]
    return blurred


def embedded(tmp_path, labels, *options):
    nib.save(nib.Nifti1Image(labels, AFFINE), tmp_path / "labels.nii.gz")
    shown = surfometry("embed", tmp_path / "labels.nii.gz", "-o", tmp_path / "mask.nii.gz", *options)
    mask = nib.load(tmp_path / "mask.nii.gz")
    np.testing.assert_allclose(mask.affine, AFFINE, atol=1e-6)
    return np.asanyarray(mask.dataobj), shown


def table(shown):
    """The cells of the objects' rows, without the flags below them."""
    return [line.split() for line in itertools.takewhile(lambda line: not line.startswith("  !"), shown.splitlines()[2:])]


def differing(found, expected):
    return (found != expected).sum()


def test_half_shares(tmp_path):
    """A voxel has the label of which the blur leaves it more than half."""
    labels = image()
    found, shown = embedded(tmp_path, labels, "--embedding", "gaussian", "--sigma", SIGMA)
    blurred = shares(labels, SIGMA)
    expected = sum(label * (share > 0.5) for label, share in blurred.items())
    near = sum((np.abs(share - 0.5) < 1e-3).sum() for share in blurred.values())
    assert differing(found, labels) > 1000
    assert differing(found, expected) <= near < 60
    rows = {row[0]: list(map(int, row[3:])) for row in table(shown)}
    for label in (-4, 3, 700):
        own, inside = labels == label, found == label
        assert rows[str(label)] == [own.sum(), inside.sum(), (own & ~inside).sum(), (inside & ~own).sum(), 0]


def test_the_larger_share_has_what_several_claim(tmp_path):
    """Below half, two labels may claim a voxel; and each has its own blur."""
    labels = image()
    found, shown = embedded(tmp_path, labels, "--level", 0.2, "--sigma", f"{SIGMA},700=2.2")
    blurred = shares(labels, SIGMA) | {700: shares(labels, 2.2)[700]}
    best = np.max(list(blurred.values()), axis=0)
    expected = sum(label * ((share == best) & (share > 0.2)) for label, share in blurred.items())
    close = np.sort(list(blurred.values()), axis=0)
    near = (np.abs(best - 0.2) < 1e-3).sum() + ((best > 0.2) & (close[-1] - close[-2] < 1e-3)).sum()
    assert differing(found, expected) <= near < 400
    given_up = sum(int(row[-1]) for row in table(shown))
    claimed = sum((share > 0.2).sum() for share in blurred.values())
    assert abs(given_up - (claimed - (found != 0).sum())) <= near
    assert given_up > 500


def test_one_image_an_input_and_no_other_format(tmp_path):
    nib.save(nib.Nifti1Image(image(), AFFINE), tmp_path / "labels.nii.gz")
    balls = ["phantom:ball?radius=6", "phantom:torus?major=9&minor=4"]
    surfometry("embed", *balls, "-o", tmp_path / "mask.nii")
    assert {path.name for path in tmp_path.glob("mask*")} == {"mask_ball.nii", "mask_torus.nii"}
    surfometry("embed", tmp_path / "labels.nii.gz", "-o", tmp_path / "mask.png", status=2)
    surfometry("embed", tmp_path / "labels.nii.gz", "-o", tmp_path / "labels.nii.gz", status=2)
