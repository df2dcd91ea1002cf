"""Surfaces in memory."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._errors import ParameterError
from ._image import Frame
from ._results import Measurement

if TYPE_CHECKING:
    import pyvista
    import trimesh

_NAME = re.compile(r"[A-Za-z0-9_]+")
# From RAS to LPS and back: two axes turn, so triangles face as before.
_TURNED = np.array([-1.0, -1.0, 1.0])
_VECTORS = ("normal", "direction_1", "direction_2")


@dataclass(frozen=True, eq=False, repr=False)
class Surface:
    """The surface phi = 0 as triangles, with geometry at its vertices.

    Attributes
    ----------
    vertices : (N, 3) float64
        Positions x, y, z in mm, in the frame of the image: RAS of files, nibabel, MONAI and TorchIO, LPS of SimpleITK,
        itk and aimio-py, its own of PyVista, xarray and napari. Of a plain array x runs along its last axis.
    faces : (M, 3) uint32
        Triangles; their corners stand counter-clockwise, seen from outside.
    arrays : dict
        Values at the vertices: ``normal``, ``mean_curvature_per_mm``, ``gaussian_curvature_per_mm2``, ``k1_per_mm``,
        ``k2_per_mm``, ``direction_1``, ``direction_2``, ``shape_index``, ``curvedness_per_mm``, and their standard errors
        as ``<name>_standard_error`` where there are any; compared with a later image, also ``distance_mm`` and
        ``mean_curvature_change_per_mm``.
    colors : (N, 3) uint8
        Mean curvature as sRGB, blue below 0, red above.
    measurement : Measurement
        The numbers of the object, in the embedding in which it was mapped.
    curvature : dict
        Curvature over the surface, and its distributions: the record of ``surfometry map``. Under ``against``, how the
        surface of a later image differs; None without one.
    frame : {"RAS", "LPS", "own"}
        The frame of the vertices.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.uint32]
    arrays: dict[str, NDArray[np.float64]]
    colors: NDArray[np.uint8]
    measurement: Measurement
    curvature: dict[str, Any]
    title: str
    frame: Frame = "RAS"

    def __repr__(self) -> str:
        size = f"{len(self.vertices)} vertices, {len(self.faces)} triangles"
        return f"Surface of {self.title}: {size}; arrays {', '.join(self.arrays)}"

    def to_pyvista(self) -> pyvista.PolyData:
        """The surface as `pyvista.PolyData`, with its arrays as point data."""
        import pyvista

        faces: Any = self.faces.astype(np.int64)
        mesh: pyvista.PolyData = pyvista.PolyData.from_regular_faces(self.vertices, faces)
        for name, values in self.arrays.items():
            mesh.point_data[name] = values
        mesh.set_active_scalars("mean_curvature_per_mm")
        return mesh

    def to_trimesh(self) -> trimesh.Trimesh:
        """The surface as `trimesh.Trimesh`, with its arrays as vertex attributes and no vertices merged."""
        import trimesh

        attributes: dict[str, Any] = {name: values for name, values in self.arrays.items() if name != "normal"}
        return trimesh.Trimesh(
            self.vertices,
            self.faces,
            vertex_normals=self.arrays["normal"],
            vertex_colors=self.colors,
            vertex_attributes=attributes,
            process=False,
        )

    def to_napari(self, quantity: str = "mean_curvature_per_mm") -> tuple[tuple[Any, ...], dict[str, Any], str]:
        """The surface as a layer of napari: data, options, kind.

        Vertices are in mm with axes z, y, x, as those of napari's layers; since that mirrors space, the corners of
        triangles change their order too. Coordinates are those of the world: give the layer no scale.

        Parameters
        ----------
        quantity : str
            What colours show; all other scalars are in ``features``.
        """
        if quantity not in self.arrays or quantity in _VECTORS:
            raise ParameterError(f"quantity={quantity}: take one of {', '.join(self._scalars())}", field="quantity")
        data = (self.vertices[:, ::-1], self.faces[:, ::-1].astype(np.int64), self.arrays[quantity])
        limit = float(np.quantile(np.abs(data[2]), 0.98)) if len(data[2]) else 1.0
        options = {
            "name": quantity,
            "features": self._scalars(),
            "colormap": "coolwarm" if data[2].min(initial=0.0) < 0 else "viridis",
            "contrast_limits": (-limit, limit) if data[2].min(initial=0.0) < 0 else (0.0, limit),
            "metadata": {"surfometry": self.title},
        }
        return data, options, "surface"

    def _scalars(self) -> dict[str, NDArray[np.float64]]:
        return {name: values for name, values in self.arrays.items() if values.ndim == 1}

    def save(self, path: str | PathLike[str]) -> list[str]:
        """Writes the surface in the format that the name's ending says, as ``surfometry map -o`` does.

        Coordinates in files are RAS, in mm, whatever the frame here.

        Parameters
        ----------
        path : path
            Ends in .ply, .vtp, .stl, .obj, .glb, .gii or .csv.

        Returns
        -------
        list of str
            The files that were written.

        Raises
        ------
        ParameterError
            For an ending of no known format, and arrays that cannot be written.
        FileError
            Where the file cannot be written.
        """
        self._check()
        return [str(name) for name in _core.write_mesh(path, turned(self) if self.frame == "LPS" else self)]

    def _check(self) -> None:
        for name, values in self.arrays.items():
            vector = values.ndim == 2 and values.shape[1] == 3
            if not _NAME.fullmatch(name) or not (values.ndim == 1 or vector):
                raise ParameterError(
                    f"the array {name!r} of shape {values.shape}: names are letters, digits and _, and a vertex has one "
                    "number or three",
                    field="arrays",
                )


def turned(surface: Surface) -> Surface:
    """The same surface in the other of RAS and LPS."""
    from dataclasses import replace

    arrays = {name: values * _TURNED if name in _VECTORS else values for name, values in surface.arrays.items()}
    frame: Frame = "RAS" if surface.frame == "LPS" else "LPS"
    return replace(surface, vertices=surface.vertices * _TURNED, arrays=arrays, frame=frame)


def surface_of(given: Mapping[str, Any], record: dict[str, Any], frame: Frame) -> Surface:
    """A surface of what the extension module gives, in a frame."""
    of_map = (
        "curvature",
        "quantiles",
        "distributions",
        "vertices_without_normal",
        "region_distributions",
        "samples",
        "against",
        "files",
    )
    curvature = {name: record.pop(name) for name in of_map}
    curvature.pop("files")
    surface = Surface(
        given["vertices"],
        given["faces"],
        given["arrays"],
        given["colors"],
        Measurement(record),
        curvature,
        given["title"],
    )
    return turned(surface) if frame == "LPS" else Surface(**{**vars(surface), "frame": frame})
