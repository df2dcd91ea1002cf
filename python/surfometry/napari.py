"""Measures a labels layer of napari: numbers of all labels as its features, and the surface of the one that is selected.

napari finds the widget by `napari.yaml`, under Layers > Measure; nothing of napari is imported before it runs.
"""

# No annotations of `__future__`: magicgui makes the widget of them, and looks no names of this module up.
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from ._adapters import napari_units
from ._maps import surface
from ._measure import measure_labels

if TYPE_CHECKING:
    import napari
    import napari.layers
    import napari.qt.threading
    import pandas

#: What the colours of a surface may show.
Quantity: TypeAlias = Literal[
    "mean_curvature_per_mm",
    "gaussian_curvature_per_mm2",
    "k1_per_mm",
    "k2_per_mm",
    "shape_index",
    "curvedness_per_mm",
]
# Short enough for napari's list of layers.
_SYMBOLS: dict[str, str] = {
    "mean_curvature_per_mm": "H, 1/mm",
    "gaussian_curvature_per_mm2": "K, 1/mm²",
    "k1_per_mm": "k1, 1/mm",
    "k2_per_mm": "k2, 1/mm",
    "shape_index": "shape index",
    "curvedness_per_mm": "curvedness, 1/mm",
}
_MAIN = (
    "volume_mm3",
    "surface_area_mm2",
    "total_mean_curvature_mm",
    "average_mean_curvature_per_mm",
    "euler_characteristic",
)
# napari shows all features of the label under the pointer in one line: these fit.
_SHOWN = ("index", "label", "name", *_MAIN, *(f"standard_error_{name}" for name in _MAIN), "flags")


@dataclass(frozen=True)
class Measured:
    """What was found of a layer: its features, and a layer for the viewer, or why there is none."""

    features: "pandas.DataFrame"
    surface: tuple[Any, dict[str, Any], str] | None = None
    problem: str | None = None


def measure_layer(
    viewer: "napari.Viewer",
    labels: "napari.layers.Labels",
    sigma: str = "auto",
    surface_of_selected_label: bool = True,
    colour: Quantity = "mean_curvature_per_mm",
    all_columns: bool = False,
) -> "napari.qt.threading.FunctionWorker":
    """Measures all labels of a layer in a thread, and shows what is found when it is done.

    Parameters
    ----------
    viewer : napari.Viewer
        Where the surface is added.
    labels : napari.layers.Labels
        Three axes, z, y, x. Its scale, affine and units say where voxels lie; a layer in pixels is measured with its
        scale as mm.
    sigma : str
        Blur of all labels in mm, or ``"auto"``.
    surface_of_selected_label : bool
        Whether the surface of the label that is selected in the layer is added, over the labels.
    colour : str
        What its colours show, in the unit of its name; all other quantities are in the surface's features.
    all_columns : bool
        Whether the features are all columns of `measure_labels`, or those that napari's status bar has room for.

    Returns
    -------
    napari.qt.threading.FunctionWorker
        The thread at work. Its errors are shown by napari.
    """
    from napari.qt.threading import create_worker

    worker = create_worker(
        measured,
        labels,
        sigma,
        colour if surface_of_selected_label else None,
        all_columns,
        _start_thread=False,
        _progress={"desc": f"measuring {labels.name}"},
    )
    worker.returned.connect(_shown(viewer, labels))
    worker.start()
    return worker


def measured(layer: Any, sigma: str, colour: Quantity | None, all_columns: bool) -> Measured:
    """The numbers of a layer's labels, and the surface of its selected label; shows nothing.

    Parameters
    ----------
    layer : napari.layers.Labels
        As of `measure_layer`, also `sigma` and `all_columns`.
    colour : str or None
        As of `measure_layer`; without one no surface is made.

    Raises
    ------
    InputError, ParameterError
        As of `measure_labels`.
    """
    table = measure_labels(layer, sigma=sigma)
    features = table if all_columns else table[list(_SHOWN)].dropna(axis="columns", how="all")
    if colour is None:
        return Measured(features)
    label = int(layer.selected_label)
    if label not in set(table["label"]):
        return Measured(features, problem=f"{layer.name} has no label {label}: select one whose surface is wanted")
    return Measured(features, surface_over(layer, label, colour, sigma))


def surface_over(
    layer: Any, label: int, colour: Quantity = "mean_curvature_per_mm", sigma: str = "auto"
) -> tuple[Any, dict[str, Any], str]:
    """The surface of a label as a layer that lies over the labels, whatever their scale, affine and units.

    Parameters
    ----------
    layer : napari.layers.Labels
        The labels.
    label : int
        Which.
    colour, sigma
        As of `measure_layer`.

    Returns
    -------
    (data, options, "surface")
        As `Viewer.add_layer` takes it from a plugin; vertices z, y, x in the world of the labels, in their units.
    """
    (vertices, faces, values), options, kind = surface(layer, label=label, sigma=sigma).to_napari(colour)
    units = napari_units(layer)
    options["name"] = f"{layer.name} {label}: {_SYMBOLS[colour]}"
    if getattr(layer, "units", None) is not None:
        options["units"] = tuple(layer.units)[-3:]
    return (vertices / units, faces, values), options, kind


def _shown(viewer: Any, layer: Any) -> Callable[[Measured], None]:
    """Shows what was found: in the thread of the viewer."""

    def show(found: Measured) -> None:
        from napari.layers import Layer
        from napari.utils.notifications import show_info

        layer.features = found.features
        if found.problem is not None:
            show_info(found.problem)
        if found.surface is not None:
            made = Layer.create(*found.surface)
            # Measured again, it takes the place of the one that was there.
            if made.name in viewer.layers:
                viewer.layers.remove(made.name)
            viewer.add_layer(made)

    return show
