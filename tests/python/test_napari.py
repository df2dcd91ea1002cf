"""The widget for napari: on layers as napari has them, and in napari itself where that is installed (scripts/napari)."""

import os
import time
from typing import get_args

import numpy as np
import pytest
from conftest import ORIGIN, SPACING, NapariLayer, oblique_directions, turned_body

import surfometry
import surfometry.napari as plugin


def two_labels():
    """The body in two halves, labels 4 and 8."""
    body = 4 * turned_body().astype(np.int32)
    body[:, :, 18:] *= 2
    return body


def layer_of(data, **place):
    """A layer as napari has it."""
    layer = NapariLayer(**place)
    layer.data, layer.selected_label = data, 8
    return layer


def centre_of(layer, label=8):
    """Where a label's voxels lie in the world of the layer."""
    return np.array(layer.data_to_world(np.argwhere(layer.data == label).mean(axis=0)))


def enclosed(vertices, faces):
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


def check_surface(layer, data, millimetres):
    """It lies over the label, of its size, and faces outward: in the layer's own world and units."""
    vertices, faces, values = data
    voxel = np.prod(SPACING)
    radius = np.cbrt(voxel * (layer.data == 8).sum()) / millimetres
    assert np.abs(vertices.mean(axis=0) - centre_of(layer)).max() < 0.05 * radius
    assert enclosed(vertices, faces) * millimetres**3 == pytest.approx(voxel * (layer.data == 8).sum(), rel=0.05)
    assert np.median(values) > 0


@pytest.mark.parametrize("unit, scale", [("pixel", 1.0), ("micrometer", 1000.0)])
def test_a_surface_lies_over_its_label(unit, scale):
    layer = layer_of(two_labels(), unit=unit, scale=scale)
    data, options, kind = plugin.surface_over(layer, 8)
    check_surface(layer, data, 1 / scale)
    assert kind == "surface" and options["units"] == (unit,) * 3
    assert options["name"] == "labels 8: H, 1/mm"
    assert np.array_equal(data[2], surfometry.surface(layer, label=8).arrays["mean_curvature_per_mm"])


def test_features_are_those_of_measure_labels():
    layer = layer_of(two_labels())
    expected = surfometry.measure_labels(layer)
    found = plugin.measured(layer, "auto", None, all_columns=True)
    assert found.surface is None and list(found.features.columns) == list(expected.columns)
    shown = plugin.measured(layer, "auto", None, all_columns=False).features
    assert list(shown["index"]) == list(shown["label"]) == [4, 8]
    assert len(shown.columns) < 15
    assert all((shown[name].dropna() == expected[name].dropna()).all() for name in shown.columns)
    blurred = plugin.measured(layer, "2.5", None, all_columns=True).features
    assert list(blurred["parameters_sigma_mm"]) == [2.5, 2.5]


def test_a_selected_label_that_is_not_there_has_no_surface():
    layer = layer_of(two_labels())
    layer.selected_label = 5
    found = plugin.measured(layer, "auto", "k1_per_mm", all_columns=False)
    assert found.surface is None and "no label 5" in found.problem and len(found.features) == 2


def test_every_colour_is_an_array_of_surfaces():
    layer = layer_of(two_labels())
    made = surfometry.surface(layer, label=8)
    for colour in get_args(plugin.Quantity):
        (_, _, values), options, _ = plugin.surface_over(layer, 8, colour)
        assert np.array_equal(values, made.arrays[colour]) and options["name"].startswith("labels 8: ")


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_the_manifest_is_valid():
    npe2 = pytest.importorskip("npe2")
    manifest = npe2.PluginManifest.from_distribution("surfometry")
    manifest.validate_imports()
    (command,) = manifest.contributions.commands
    assert command.python_name == "surfometry.napari:measure_layer"
    assert [item.command for item in manifest.contributions.menus["napari/layers/measure"]] == [command.id]
    assert [widget.command for widget in manifest.contributions.widgets] == [command.id]


@pytest.fixture(scope="module")
def window():
    """napari without a display, where it is installed: one window, as a user has; its bars of progress outlive windows."""
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    napari = pytest.importorskip("napari", reason="napari is not installed here; scripts/napari runs these tests in it")
    viewer = napari.Viewer(show=False)
    yield viewer
    viewer.close()


@pytest.fixture
def viewer(window):
    yield window
    window.window.remove_dock_widget("all")
    window.layers.clear()


def add_labels(viewer, affine, scale=1000.0):
    return viewer.add_labels(
        two_labels(),
        name="scan",
        scale=np.array(SPACING) * scale,
        translate=ORIGIN[::-1] * scale,
        affine=affine,
        units=("um",) * 3,
    )


def widget_of(viewer):
    """The widget as the menu opens it."""
    _, widget = viewer.window.add_plugin_dock_widget("surfometry", "Measure surfaces")
    return widget


def finished(worker):
    """Waits for a thread of napari's; what it said, returned or raised."""
    from qtpy.QtTest import QTest

    said = []
    worker.returned.connect(said.append)
    worker.errored.connect(said.append)
    deadline = time.monotonic() + 60
    while not said and time.monotonic() < deadline:
        QTest.qWait(20)
    # What else is connected to the worker's end runs as well.
    QTest.qWait(100)
    return said[0]


def test_in_napari(viewer):
    affine = np.eye(4)
    affine[:3, :3] = oblique_directions()[::-1, ::-1]
    labels = add_labels(viewer, affine)
    labels.selected_label = 8
    worker = widget_of(viewer)()
    assert len(viewer.layers) == 1, "measuring waits in the viewer's own thread"
    finished(worker)
    assert list(labels.features["index"]) == list(labels.features["label"]) == [4, 8]
    surface = viewer.layers[-1]
    check_surface(labels, surface.data, 1e-3)
    assert tuple(map(str, surface.units)) == ("micrometer",) * 3 and np.allclose(surface.affine.affine_matrix, np.eye(4))
    assert surface.name == "scan 8: H, 1/mm" and len(surface.features) == len(surface.data[0])
    assert surface.contrast_limits[0] == -surface.contrast_limits[1]


def test_napari_shows_the_numbers_of_the_label_under_the_pointer(viewer):
    labels = add_labels(viewer, None)
    finished(widget_of(viewer)(surface_of_selected_label=False))
    assert len(viewer.layers) == 1
    row = labels.features[labels.features["label"] == 8].iloc[0]
    shown = " ".join(labels._get_properties(tuple(centre_of(labels)), world=True))
    assert "label: 8" in shown and f"volume_mm3: {row['volume_mm3']:.3g}" in shown


def test_measured_again_a_surface_takes_its_own_place(viewer):
    labels = add_labels(viewer, None)
    labels.selected_label = 4
    widget = widget_of(viewer)
    for sigma in ("auto", "2"):
        finished(widget(sigma=sigma))
    assert [layer.name for layer in viewer.layers] == ["scan", "scan 4: H, 1/mm"]


def test_napari_shows_errors(viewer):
    from napari.utils.notifications import notification_manager

    labels = add_labels(viewer, None)
    with notification_manager:
        assert isinstance(finished(widget_of(viewer)(sigma="wide")), surfometry.ParameterError)
    assert any("wide" in shown.message for shown in notification_manager.records)
    assert labels.features.empty and len(viewer.layers) == 1
