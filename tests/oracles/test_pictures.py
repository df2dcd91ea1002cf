"""Pictures by what is on them: silhouettes against the projected mask, mirror symmetry, VTK's colours, sizes."""

import base64
import io
import shutil
import subprocess
from functools import cached_property
from xml.etree import ElementTree

import nibabel as nib
import numpy as np
import pytest
import trimesh
import vtk
from conftest import DATA, lumpy, measure, mirrored, needs_data, oblique, save_mask, surfometry
from PIL import Image
from scipy import ndimage

# Directions at the picture's bottom and right.
VIEWS = {"anterior": "IL", "posterior": "IR", "left": "IP", "right": "IA", "superior": "PR", "inferior": "PL"}
DIRECTIONS = dict(zip("RASLPI", np.vstack([np.eye(3), -np.eye(3)])))
SVG = "{http://www.w3.org/2000/svg}"


class Panel:
    """The raster of one view, as it is embedded in an SVG picture."""

    def __init__(self, image, mm_per_unit):
        _, data = image.get("href").split("base64,")
        self.pixels = np.asarray(Image.open(io.BytesIO(base64.b64decode(data))).convert("RGB")).astype(float)
        self.box = [float(image.get(key)) for key in ["x", "y", "width", "height"]]
        self.mm_per_pixel = mm_per_unit * self.box[2] / self.pixels.shape[1]

    @cached_property
    def object(self):
        """Pixels that are not background: shading only darkens, and grey is as light as colours get."""
        return self.pixels.min(axis=2) < 238

    def at(self, down, right):
        """Whether the object is seen at places (mm from the middle) of a grid."""
        rows, columns = (
            np.clip((place / self.mm_per_pixel + n / 2).astype(int), 0, n - 1)
            for place, n in zip([down, right], self.object.shape)
        )
        return self.object[np.ix_(rows, columns)]

    def offsets(self):
        """From the middle, mm: down by row, right by column."""
        return [(np.arange(n) + 0.5 - n / 2) * self.mm_per_pixel for n in self.object.shape]


def panels(path):
    """Of a picture of views: its panels by name, at the scale of its bar."""
    elements = list(ElementTree.parse(path).getroot())
    bars = [i for i, e in enumerate(elements) if e.tag == SVG + "rect" and e.get("height") == "3.00"]
    length, unit = elements[bars[-1] + 1].text.split()
    assert unit == "mm"
    mm_per_unit = float(length) / float(elements[bars[-1]].get("width"))
    return {
        name.text.lower(): Panel(image, mm_per_unit)
        for name, image in zip(elements, elements[1:])
        if image.tag == SVG + "image" and (name.text or "").lower() in VIEWS
    }


def draw(source, path, *options, views="anterior"):
    """The panels of a picture."""
    surfometry("map", source, "-o", path, "--view", views, *options)
    return panels(path)


def overlap(a, b):
    return (a & b).sum() / (a | b).sum()


def check_silhouettes(found, mask, affine, mesh, least):
    """All six views show the mask's shadow; the middles of the panels are where the mesh has its own."""
    assert found.keys() == VIEWS.keys()
    # The shell casts the same shadow. Points in it are closer than the cells in which they are counted.
    shell = np.argwhere(mask ^ ndimage.binary_erosion(mask)).astype(np.float32)
    parts = np.stack(np.meshgrid(*[[-0.25, 0.25]] * 3), axis=-1).reshape(-1, 3)
    points = nib.affines.apply_affine(affine, (shell[:, None] + parts).reshape(-1, 3)) - mesh.bounds.mean(axis=0)
    cell = nib.affines.voxel_sizes(affine).max() * 0.55
    for view, panel in found.items():
        assert 0.15 < panel.object.mean() < 0.95, view
        cells = [int(n * panel.mm_per_pixel / cell) for n in panel.object.shape]
        shadow = np.zeros(cells, dtype=bool)
        shadow[tuple((points @ DIRECTIONS[d] / cell + n / 2).astype(int) for d, n in zip(VIEWS[view], cells))] = True
        met = overlap(panel.at(*[(np.arange(n) + 0.5 - n / 2) * cell for n in cells]), shadow)
        assert met > least, (view, met)


@pytest.fixture(scope="module")
def torus(tmp_path_factory):
    """Pictures of all kinds in both formats."""
    folder = tmp_path_factory.mktemp("torus")
    surfometry(
        "map", "phantom:torus?major=12&minor=5", "--quantity", "gaussian-curvature", "--limit", "0.02",
        "--view", "anterior,superior", "--picture", "surface,slices,histogram,volume",
        "-o", folder / "t.svg", "--png", folder / "t.png", "--dpi", "96",
    )  # fmt: skip
    return folder


KINDS = ["surface", "slices", "histogram", "volume"]


def test_each_kind_is_a_file_with_something_on_it(torus):
    assert {path.name for path in torus.iterdir()} == {f"t_{k}.{e}" for k in KINDS for e in ["png", "svg"]}
    for kind in KINDS:
        image = Image.open(torus / f"t_{kind}.png")
        root = ElementTree.parse(torus / f"t_{kind}.svg").getroot()
        assert image.size == tuple(round(float(root.get(key))) for key in ["width", "height"])
        assert image.info["dpi"] == pytest.approx((96, 96), abs=0.1)
        pixels = np.asarray(image.convert("RGB")).astype(int)
        colored = np.ptp(pixels, axis=2) > 20
        assert 0.05 < colored.mean() < 0.8 and (pixels == 255).all(axis=2).mean() > 0.1, kind


def test_png_shows_the_svgs_rasters_in_their_places(torus):
    drawn = Image.open(torus / "t_surface.png").convert("RGB")
    for panel in panels(torus / "t_surface.svg").values():
        x, y, width, height = panel.box
        part = drawn.resize((int(width), int(height)), Image.Resampling.BICUBIC, (x, y, x + width, y + height))
        raster = Image.fromarray(panel.pixels.astype(np.uint8)).resize(part.size, Image.Resampling.BOX)
        difference = np.abs(np.asarray(part).astype(float) - np.asarray(raster)).max(axis=2)
        # Direction letters are drawn above the raster.
        assert np.mean(difference) < 3 and np.median(difference[np.asarray(raster).min(axis=2) < 238]) < 2


def test_dpi_is_pixels_an_inch(tmp_path):
    sizes = {}
    for dpi in [72, 96, 288]:
        surfometry("map", "phantom:ball?radius=6", "--picture", "histogram", "--png", tmp_path / "h.png", "--dpi", dpi)
        image = Image.open(tmp_path / "h.png")
        sizes[dpi] = np.array(image.size)
        assert image.info["dpi"] == pytest.approx((dpi, dpi), abs=0.1)
    np.testing.assert_allclose(sizes[72] / 0.75, sizes[96], atol=1)
    np.testing.assert_array_equal(sizes[288], 3 * sizes[96])


def check_symmetry(panel):
    """Left and right are alike, but for the diagonals along which the mesh's cells are split."""
    assert overlap(panel.object, panel.object[:, ::-1]) > 0.998
    difference = np.abs(panel.pixels - panel.pixels[:, ::-1]).max(axis=2)
    assert difference.mean() < 1 and np.quantile(difference, 0.99) < 8


@pytest.mark.parametrize("kind", ["surface", "volume"])
def test_a_torus_is_symmetric(torus, kind):
    for panel in panels(torus / f"t_{kind}.svg").values():
        check_symmetry(panel)


def vtk_scale(share):
    """Moreland's diverging map from blue (-1) to red (1)."""
    scale = vtk.vtkColorTransferFunction()
    scale.SetColorSpaceToDiverging()
    scale.AddRGBPoint(-1, 59 / 255, 76 / 255, 192 / 255)
    scale.AddRGBPoint(1, 180 / 255, 4 / 255, 38 / 255)
    return 255 * np.array(scale.GetColor(share))


def test_a_ball_has_the_color_of_its_curvature(tmp_path):
    ball = "phantom:ball?radius=20"
    panel = draw(ball, tmp_path / "b.svg", "--sigma", "4", "--limit", "0.1")["anterior"]
    check_symmetry(panel)
    distance = np.hypot(*np.meshgrid(*panel.offsets(), indexing="ij"))
    # Facing the viewer, so with the scale's own colours.
    middle = panel.pixels[distance < 5].mean(axis=0)
    mean = measure(ball, "--sigma", "4")[0]["average_mean_curvature_per_mm"]
    np.testing.assert_allclose(middle, vtk_scale(mean / 0.1), atol=8)
    assert middle[0] > middle[2] + 50
    # sigma^2 H less than 20 mm, by the picture's own scale bar.
    assert 2 * distance[panel.object].max() == pytest.approx(2 * (20 - 16 / 20), rel=0.01)


def test_a_torus_is_red_outside_and_blue_around_its_hole(torus):
    for kind in ["surface", "volume"]:
        panel = panels(torus / f"t_{kind}.svg")["superior"]
        distance = np.hypot(*np.meshgrid(*panel.offsets(), indexing="ij"))
        redness = panel.pixels[..., 0] - panel.pixels[..., 2]
        inner, outer = (distance > 8) & (distance < 10), (distance > 14) & (distance < 16)
        assert (redness[inner] < 0).all() and (redness[outer] > 0).all(), kind
        assert redness[inner].mean() < -40 and redness[outer].mean() > 40, kind
        assert not panel.object[distance < 5].any()


def test_volume_rendering_covers_what_the_surface_does(tmp_path):
    # A thin band: it shines through as far as it is thick.
    surfometry(
        "map", "phantom:ellipsoid?radii=18,12,9&rotate=20,30,40", "--thickness", "1", "--view", "anterior",
        "--picture", "surface,volume", "-o", tmp_path / "e.svg",
    )  # fmt: skip
    surface, volume = (panels(tmp_path / f"e_{kind}.svg")["anterior"] for kind in ["surface", "volume"])
    assert overlap(surface.object, volume.at(*surface.offsets())) > 0.95


def ball_with_bump():
    """A ball with a smaller one at its right; x, y, z are RAS."""
    x, y, z = np.meshgrid(*[np.arange(n) - 20.0 for n in (50, 41, 41)], indexing="ij")
    return (np.sqrt(x**2 + y**2 + z**2) < 11) | (np.sqrt((x - 13) ** 2 + y**2 + z**2) < 6)


def test_the_right_is_at_the_left_in_the_anterior_view(tmp_path):
    mask, affine = ball_with_bump(), np.diag([0.9, 1.0, 1.1, 1.0])
    options = ["--sigma", "1.5", "--limit", "0.15"]
    names = "anterior,posterior,left,right"
    seen = draw(save_mask(tmp_path / "a.nii", mask, affine), tmp_path / "a.svg", *options, views=names)

    def lean(panel):
        """How far the object's pixels lie to the right of the middle of their own box, mm."""
        columns = panel.object.any(axis=0).nonzero()[0]
        return (panel.object.nonzero()[1].mean() - columns[[0, -1]].mean()) * panel.mm_per_pixel

    # Away from the bump.
    assert lean(seen["anterior"]) > 1 and lean(seen["posterior"]) < -1
    assert abs(lean(seen["left"])) < 0.1 and abs(lean(seen["right"])) < 0.1

    def redness(panel):
        height, width = panel.object.shape
        middle = panel.pixels[height // 2 - 40 : height // 2 + 40, width // 2 - 40 : width // 2 + 40]
        return (middle[..., 0] - middle[..., 2]).mean()

    # From the right the bump is in the middle, and more curved than the ball.
    assert redness(seen["right"]) > redness(seen["left"]) + 30
    assert seen["anterior"].object.shape == seen["posterior"].object.shape
    assert overlap(seen["anterior"].object, seen["posterior"].object[:, ::-1]) > 0.995

    flip = np.diag([-1.0, 1, 1, 1])
    flip[0, 3] = len(mask) - 1
    flipped = draw(save_mask(tmp_path / "b.nii", mask[::-1], affine @ flip), tmp_path / "b.svg", *options, views=names)
    for view, panel in seen.items():
        difference = np.abs(panel.pixels - flipped[view].pixels).max(axis=2)
        assert difference.mean() < 1 and np.quantile(difference, 0.99) < 16, view


AXES = {"permuted": mirrored()[:, [2, 0, 1, 3]], "oblique": oblique()}


@pytest.mark.parametrize("axes", AXES)
def test_silhouettes_are_the_masks_shadows(tmp_path, axes):
    mask = np.pad(lumpy((44, 36, 30), 11), 2)
    source = save_mask(tmp_path / "mask.nii.gz", mask, AXES[axes])
    seen = draw(source, tmp_path / "x.svg", "--sigma", "0.7", "-o", tmp_path / "x.ply", views=",".join(VIEWS))
    check_silhouettes(seen, mask, AXES[axes], trimesh.load_mesh(tmp_path / "x.ply"), 0.87)


# File, label, options, least share of the shadow that is met, most that the volume is off: the blur takes thin parts.
REAL = {
    "femur": ("bone/libhip_m3_left_proximal_femur_1mm.nii.gz", 1, [], 0.95, 0.03),
    "L4": ("bone/verse004_L4.nii.gz", 1, ["--sigma", "1.2"], 0.9, 0.05),
    "talus": ("bone/vhf_left_talus_0.5mm.nii.gz", 1, [], 0.95, 0.02),
    "sacrum": ("bone/totalseg_ct_3mm_62labels.nii.gz", 25, ["--sigma", "3"], 0.8, 0.1),
    "hippocampus": ("brain/freesurfer_subcortical_1mm.nii.gz", 17, ["--sigma", "1"], 0.85, 0.1),
    "liver": ("bone/totalseg_ct_3mm_62labels.nii.gz", 5, [], 0.9, 0.05),
    "trabeculae": ("trabecular/lhdl_3155_lower_largest_padded.nii.gz", 1, [], 0.9, 0.1),
}


@needs_data
@pytest.mark.parametrize("name", REAL)
def test_real_objects(tmp_path, name):
    file, label, options, least, rel = REAL[name]
    source = DATA / file
    image = nib.load(source)
    mask = np.asarray(image.dataobj) == label
    mesh_options = ["--label", label, *options, "-o", tmp_path / "x.ply"]
    seen = draw(source, tmp_path / "x.svg", *mesh_options, views=",".join(VIEWS))
    mesh = trimesh.load_mesh(tmp_path / "x.ply")
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(mask.sum() * abs(np.linalg.det(image.affine[:3, :3])), rel=rel)
    check_silhouettes(seen, mask, image.affine, mesh, least)


@pytest.mark.skipif(not shutil.which("pdftoppm"), reason="poppler is absent")
def test_a_pdf_is_its_png(tmp_path):
    """Poppler draws what resvg drew, and finds the text, hostile titles and signs included."""
    title = "<script>alert(1)</script> (φ) & L4"
    options = ["--title", title, "--size", "120mm", "--dpi", 144, "--view", "anterior,left", "--limit", "0.2"]
    figure, png = tmp_path / "f.pdf", tmp_path / "f.png"
    surfometry("map", "phantom:torus?major=14&minor=6&rotate=60,10,0", *options, "-o", figure, "-o", png)
    text = subprocess.run(["pdftotext", "-layout", figure, "-"], capture_output=True, text=True, check=True).stdout
    for words in [title, "Mean curvature H (mm⁻¹)", "Anterior", "Left", "surfometry", "−0.2"]:
        assert words in " ".join(text.split()), (words, text)
    subprocess.run(["pdftoppm", "-r", "144", "-png", "-singlefile", figure, tmp_path / "drawn"], check=True)
    found, expected = (np.asarray(Image.open(p).convert("RGB")).astype(float) for p in [tmp_path / "drawn.png", png])
    assert expected.shape[1] == round(120 / 25.4 * 144) and np.abs(np.subtract(found.shape, expected.shape)).max() <= 1
    height, width = np.minimum(found.shape, expected.shape)[:2]
    # Poppler's rows count from below, so letters and edges are off by up to half a pixel; elsewhere they are alike.
    smoothed = [ndimage.uniform_filter(p[:height, :width], (7, 7, 1)) for p in [found, expected]]
    difference = np.abs(np.subtract(*smoothed)).max(axis=2)
    assert np.quantile(difference, 0.999) < 40 and np.quantile(difference, 0.95) < 15 and difference.mean() < 1


def test_a_camera_sees_what_a_turned_object_shows(tmp_path):
    """Azimuth 30, elevation 20: the mask turned by numpy, from the front."""
    mask = np.pad(lumpy((40, 34, 28), 5), 2)
    affine = mirrored()
    source = save_mask(tmp_path / "mask.nii.gz", mask, affine)
    surfometry("map", source, "-o", tmp_path / "c.svg", "--camera", "30,20", "--sigma", "0.7")
    elements = list(ElementTree.parse(tmp_path / "c.svg").getroot())
    image = next(e for e in elements if e.tag == SVG + "image")
    bar = [i for i, e in enumerate(elements) if e.tag == SVG + "rect" and e.get("height") == "3.00"][-1]
    panel = Panel(image, float(elements[bar + 1].text.split()[0]) / float(elements[bar].get("width")))
    azimuth, elevation = np.radians([30, 20])
    toward = np.array([-np.sin(azimuth) * np.cos(elevation), np.cos(azimuth) * np.cos(elevation), np.sin(elevation)])
    right = np.cross([0, 0, 1], toward)
    right /= np.linalg.norm(right)
    world = nib.affines.apply_affine(affine, np.argwhere(mask))
    across, up = world @ right, world @ np.cross(toward, right)
    rows, columns = panel.object.nonzero()
    seen = [np.ptp(columns) * panel.mm_per_pixel, np.ptp(rows) * panel.mm_per_pixel]
    # To a voxel: the shadow of voxels' centres is smaller than that of the surface by one.
    np.testing.assert_allclose(seen, [np.ptp(across), np.ptp(up)], atol=1.6)
