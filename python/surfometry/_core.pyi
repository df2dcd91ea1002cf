"""The extension module. Private: it may change with any version."""

from collections.abc import Callable
from os import PathLike
from typing import Any, Protocol

from numpy import float64, uint8, uint32
from numpy.typing import NDArray

__all__ = [
    "VERSION",
    "grey_image_warning",
    "main",
    "measure",
    "measure_columns",
    "sweep",
    "reference",
    "describe",
    "surface",
    "voxel_maps",
    "write_mesh",
    "read",
    "report",
    "compare",
    "affine_of_directions",
]

VERSION: str

class _Image(Protocol):
    @property
    def voxels(self) -> NDArray[Any]: ...
    @property
    def affine(self) -> list[list[float]] | None: ...
    @property
    def name(self) -> str: ...
    @property
    def label_names(self) -> dict[int, str]: ...

class _Session(Protocol):
    @property
    def threads(self) -> int: ...
    @property
    def progress(self) -> Callable[[str, int, int], None] | None: ...
    @property
    def labels(self) -> Callable[[int], None] | None: ...

class _Request(Protocol):
    @property
    def image(self) -> str | _Image: ...
    @property
    def options(self) -> dict[str, str]: ...
    @property
    def session(self) -> _Session: ...

class _Mesh(Protocol):
    @property
    def vertices(self) -> NDArray[float64]: ...
    @property
    def faces(self) -> NDArray[uint32]: ...
    @property
    def colors(self) -> NDArray[uint8]: ...
    @property
    def arrays(self) -> dict[str, NDArray[float64]]: ...
    @property
    def title(self) -> str: ...

def grey_image_warning(name: str, labels: int) -> str | None: ...
def main(arguments: list[str]) -> int: ...
def measure(request: _Request) -> str: ...
def measure_columns(request: _Request) -> str: ...
def sweep(request: _Request, over: str, values: list[float]) -> str: ...
def reference(request: _Request, methods: list[str]) -> str: ...
def describe(request: _Request) -> str: ...
def surface(request: _Request, curvature_sigma: str | None) -> list[dict[str, Any]]: ...
def voxel_maps(
    request: _Request, curvature_sigma: str | None, quantities: list[str]
) -> list[dict[str, Any]]: ...
def write_mesh(path: str | PathLike[str], mesh: _Mesh) -> list[str]: ...
def read(name: str, options: dict[str, str], session: _Session) -> dict[str, Any]: ...
def report(
    request: _Request,
    curvature_sigma: str | None,
    path: str | PathLike[str],
    title: str | None,
    command: str,
) -> None: ...
def compare(
    method: str,
    standard: str,
    columns: list[str],
    object: str,
    label: str | None,
    names: tuple[str, str] | None,
    bootstrap: int,
) -> str: ...
def affine_of_directions(
    directions: list[list[float]], spacing: list[float], origin: list[float], lps: bool
) -> list[list[float]]: ...
