"""What the commands do that show an object: surfaces, maps on voxels, reports."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from os import PathLike, fspath
from pathlib import Path
from typing import Any

from . import _core
from ._errors import InputError, ParameterError
from ._options import Labels, Length, Names, Samples, Threshold, chosen, options_of
from ._reading import only, opened, prepared, read
from ._results import warn_of
from ._session import Progress, Request, session
from ._surface import Surface, surface_of


def surface(
    image: object,
    spacing: float | Sequence[float] | None = None,
    *,
    curvature_sigma: float | str | None = "auto",
    label: Labels | None = None,
    threshold: Threshold | None = None,
    fill_cavities: bool = False,
    largest_component: bool = False,
    sigma: Length | None = None,
    thickness: Length | None = None,
    level: float | None = None,
    embedding: str | None = None,
    derivatives: str | None = None,
    clip: str | None = None,
    padding: float | str | None = None,
    paper: bool = False,
    regions: str | PathLike[str] | None = None,
    sample: Samples | None = None,
    names: Names | None = None,
    name: str | None = None,
    against: object = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Surface:
    """The surface of one object, with curvature at its vertices.

    Parameters
    ----------
    image, spacing, label, threshold, fill_cavities, largest_component, \
sigma, thickness, level, embedding, derivatives, clip, padding, paper, names, name, threads, progress
        As of `measure`.
    curvature_sigma : float, {"auto", "local", "object"} or None
        Blur in mm of the corrected embedding in which curvature is that of the object as segmented, or how it is chosen:
        at each vertex ("auto", "local") or once, which is faster ("object"). None maps the surface as it is measured.
    against : image, path or None
        A later image of the same object, in the same world coordinates, on any grid: the surface then has the array
        ``distance_mm``, the distance to the object of the same label there, positive where that lies outside,
        ``mean_curvature_change_per_mm``, and their standard errors, which are what two masks of one object would differ by;
        ``curvature["against"]`` has means, quantiles and what is beyond noise. Choices, ``spacing`` too, are those of both.
    regions : path, optional
        A label image in a file, on any lattice, whose labels are regions: distributions by region as well, in
        ``curvature["region_distributions"]`` of the result.
    sample : path, sequence of paths or mapping, optional
        Volumes in files, on any lattice, whose values are put on the vertices, linear between voxels: arrays by the names
        of the files, or by the mapping's; how they go with curvature is in ``curvature["samples"]`` of the result.

    Returns
    -------
    Surface
        In the frame of the image, mm.

    Raises
    ------
    InputError, ParameterError, FileError, UnsupportedTypeError
        As of `measure`, and where nothing is left inside.

    Warns
    -----
    SurfometryWarning
        Each flag of its measurement, once.

    Notes
    -----
    Curvature at vertices, its signs and its standard errors: docs/quantities.md. What they are off by: docs/accuracy.md.
    """
    known, options = prepared(image, spacing, chosen(locals()), names, name)
    with session(threads, progress, one_object=label is None) as running:
        later = None if against is None else opened(against, spacing)
        found = _core.surface(Request(known, options, running), _scale(curvature_sigma), later)
    mapped = only(found)
    record = json.loads(mapped["record"])
    if not len(mapped["faces"]):
        raise InputError(
            "nothing is left inside the level set at this sigma and level, so there is no surface; use a smaller sigma, "
            "or a curvature_sigma, which gives thin objects back"
        )
    made = surface_of(mapped, record, "RAS" if isinstance(known, str) else known.frame)
    warn_of({made.measurement.input: list(made.measurement.flags)}, stacklevel=2)
    return made


def _scale(curvature_sigma: float | str | None) -> str | None:
    return options_of(curvature_sigma=curvature_sigma).get("curvature_sigma")


def voxel_maps(
    image: object,
    spacing: float | Sequence[float] | None = None,
    *,
    quantities: str | Sequence[str] = "mean-curvature",
    outside: float = 0.0,
    curvature_sigma: float | str | None = None,
    label: Labels | None = None,
    threshold: Threshold | None = None,
    fill_cavities: bool = False,
    largest_component: bool = False,
    sigma: Length | None = None,
    thickness: Length | None = None,
    level: float | None = None,
    embedding: str | None = None,
    derivatives: str | None = None,
    clip: str | None = None,
    padding: float | str | None = None,
    paper: bool = False,
    names: Names | None = None,
    name: str | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> dict[str, Any]:
    """Maps quantities of one object on the image's own lattice.

    Parameters
    ----------
    image, spacing, label, threshold, fill_cavities, largest_component, \
sigma, thickness, level, embedding, derivatives, clip, padding, paper, names, name, threads, progress
        As of `measure`.
    quantities : str or sequence of str
        Of ``mean-curvature``, ``gaussian-curvature``, ``delta``, ``phi``, ``band``.
    outside : {0, nan}
        What maps of curvature have outside the band: 0, which viewers take for nothing, or ``math.nan``, which no mean
        takes for a value.
    curvature_sigma : float, {"auto", "local", "object"} or None
        As of `surface`.

    Returns
    -------
    dict
        Maps by the quantity's name with its unit, such as ``mean_curvature_per_mm``: float32, of the same kind as the
        image and in the same place. Of a path they are of the kind that `read` gives.

    Raises
    ------
    InputError, ParameterError, FileError, UnsupportedTypeError
        As of `measure`, and for a quantity of no known name.
    """
    asked = [quantities] if isinstance(quantities, str) else list(quantities)
    known, options = prepared(image, spacing, chosen(locals()), names, name)
    with session(threads, progress, one_object=label is None) as running:
        filling = f"{outside:g}"
        found = _core.voxel_maps(Request(known, options, running), _scale(curvature_sigma), asked, filling)
    maps = only(found)
    if isinstance(known, str):
        # Its place in the world, not its voxels: those are measured already.
        known = read(known, spacing, threads=threads)
    return {quantity: known.given_back(array) for quantity, array in maps["arrays"].items()}


def report(
    image: object,
    output: str | PathLike[str],
    spacing: float | Sequence[float] | None = None,
    *,
    title: str | None = None,
    date: str | None = None,
    curvature_sigma: float | str | None = None,
    label: Labels | None = None,
    threshold: Threshold | None = None,
    fill_cavities: bool = False,
    largest_component: bool = False,
    sigma: Length | None = None,
    thickness: Length | None = None,
    level: float | None = None,
    embedding: str | None = None,
    derivatives: str | None = None,
    clip: str | None = None,
    padding: float | str | None = None,
    paper: bool = False,
    names: Names | None = None,
    name: str | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> None:
    """Writes one HTML page: numbers with error bars, the surface to turn, distributions, slices, topology, method.

    Of an image of several objects it has a table to sort, search and filter, all of them in one scene, and a page
    for each. The same image makes the same page. For display large surfaces have fewer triangles; numbers are
    those of the whole surface.

    Parameters
    ----------
    image, spacing, label, threshold, fill_cavities, largest_component, \
sigma, thickness, level, embedding, derivatives, clip, padding, paper, names, name, threads, \
progress
        As of `measure`; each object gets a section.
    output : path
        The page, written whole or not at all.
    title : str, optional
        Its heading.
    date : str, optional
        When the page was made, as it is to say. Without it a page tells no time, unless the environment has
        SOURCE_DATE_EPOCH.
    curvature_sigma : float, {"auto", "local", "object"} or None
        As of `surface`; None is "auto" for eight objects or fewer, where no sigma, embedding or other choice of the
        field is given.

    Raises
    ------
    InputError, ParameterError, FileError, UnsupportedTypeError
        As of `measure`, where the page would replace the image, and where it cannot be written.
    """
    known, options = prepared(image, spacing, chosen(locals()), names, name)
    if isinstance(known, str) and Path(known).exists() and Path(output).exists() and Path(known).samefile(output):
        raise ParameterError(f"{output}: the page would replace the input; choose another name", path=fspath(output))
    command = f"surfometry.report of {known if isinstance(known, str) else known.name} in Python {sys.version.split()[0]}"
    with session(threads, progress) as running:
        request = Request(known, options, running)
        _core.report(request, _scale(curvature_sigma), output, title, date, command)
