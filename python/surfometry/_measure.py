"""What the commands do that make numbers, a function each."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Mapping, Sequence
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core
from ._errors import ParameterError, SurfometryWarning
from ._options import Labels, Length, Names, Threshold, chosen
from ._reading import only, prepared
from ._results import Flag, Measurement, flags_of, warn_of
from ._session import Progress, Request, session

if TYPE_CHECKING:
    import pandas


def measure(
    image: object,
    spacing: float | Sequence[float] | None = None,
    *,
    label: Labels | None = None,
    threshold: Threshold | None = None,
    fill_cavities: bool = False,
    largest_component: bool = False,
    sigma: Length | None = None,
    thickness: Length | None = None,
    epsilon: float | None = None,
    level: float | None = None,
    embedding: str | None = None,
    derivatives: str | None = None,
    quadrature: str | None = None,
    delta: str | None = None,
    clip: str | None = None,
    padding: float | str | None = None,
    paper: bool = False,
    explain: bool = False,
    regions: str | PathLike[str] | None = None,
    interfaces: bool = False,
    names: Names | None = None,
    name: str | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Measurement:
    """Measures one object: volume, area, curvature, topology, with error bars.

    The numbers are those of ``surfometry measure``, to the bit.

    Parameters
    ----------
    image : array or image
        A NumPy array of three axes, of booleans, integers or floats, an image of SimpleITK, itk, nibabel, xarray, napari, MONAI, TorchIO or PyVista, a pair
        (array, meta) of aimio-py, what `read` or `phantom` gave, a path, or the name of a built-in shape. Voxels are
        labels, 0 being background; with ``embedding="given"`` a field, negative inside; with ``embedding="probability"``
        probabilities.
    spacing : float or sequence of three floats, optional
        Distance between voxels in mm **in the order of the array's axes**, whatever these are; of a path in that of
        `read`, (z, y, x). Images that know theirs need none, and this replaces it. A plain array needs one.
    label : int, str, tuple or list, optional
        Which label, by number or by name; a tuple of labels is one object.
    threshold : tuple of two floats or None, optional
        Grey values (low, high) that are the object, both inside, None being no bound: it becomes label 1.
    fill_cavities : bool
        Whether background that a label encloses becomes that label.
    largest_component : bool
        Whether of each label only the largest 26-connected piece is left, before cavities are filled.
    sigma, thickness : float, str or mapping, optional
        Blur and thickness of the band, mm; ``"auto"``; or a mapping from labels to such.
    epsilon : float, optional
        Half-width of the delta in units of the field, in the place of a thickness.
    level : float, optional
        Level of the blurred mask that is the surface, between 0 and 1.
    embedding : {"gaussian", "corrected", "recovering", "probability", "given", ...}, optional
        How an object becomes a field. Without one the blur, and what gives an object back of which that loses detail.
    derivatives, quadrature, delta, clip, padding, paper
        As of the command line, by the same words.
    explain : bool
        Whether it is looked into where blur and band change topology.
    regions : path, optional
        A label image in a file, on any lattice, whose labels are regions: the object's numbers by region as well, in
        `regions` of the result.
    interfaces : bool
        Whether the contacts of the object with other labels and background are measured, in `interfaces` of the result.
    names : mapping or path, optional
        Names of labels, which win over the image's own: from labels to names, or a table in a file, as ``surfometry measure
        --names`` takes it.
    name : str, optional
        What the record calls the image.
    threads : int, optional
        At most one a core that may be used. By default SURFOMETRY_NUM_THREADS, RAYON_NUM_THREADS, or all. The numbers
        do not depend on it.
    progress : bool or callable, optional
        True for a bar of tqdm, or a function called with (text, so much, of so much).

    Returns
    -------
    Measurement
        Lengths in mm; None where a number could not be had, and a flag says why.

    Raises
    ------
    InputError, ParameterError, FileError, UnsupportedTypeError
        Also ValueError, ValueError, OSError and TypeError. An image of several objects is refused.

    Warns
    -----
    SurfometryWarning
        Each flag of the result, once.

    Notes
    -----
    Formulas, and where they are from: docs/quantities.md. How far to trust them: docs/accuracy.md.

    Examples
    --------
    >>> import numpy as np, surfometry
    >>> z, y, x = np.mgrid[-12:13, -20:21, -20:21]
    >>> ball = (2.0 * z) ** 2 + y**2 + x**2 < 15**2
    >>> r = surfometry.measure(ball, spacing=(2, 1, 1))
    >>> round(r.surface_area / (4 * np.pi * 15**2), 2), r.euler_characteristic
    (1.0, 2.0)
    """
    known, options = prepared(image, spacing, chosen(locals()), names, name)
    with session(threads, progress, one_object=label is None) as running:
        records = json.loads(_core.measure(Request(known, options, running)))
    measured = Measurement(only(records))
    warn_of({measured.input: list(measured.flags)}, stacklevel=2)
    return measured


def measure_labels(
    image: object,
    spacing: float | Sequence[float] | None = None,
    *,
    label: Labels | None = None,
    threshold: Threshold | None = None,
    fill_cavities: bool = False,
    largest_component: bool = False,
    sigma: Length | None = None,
    thickness: Length | None = None,
    epsilon: float | None = None,
    level: float | None = None,
    embedding: str | None = None,
    derivatives: str | None = None,
    quadrature: str | None = None,
    delta: str | None = None,
    clip: str | None = None,
    padding: float | str | None = None,
    paper: bool = False,
    explain: bool = False,
    per_component: bool = False,
    names: Names | None = None,
    name: str | None = None,
    as_frame: bool = True,
    threads: int | None = None,
    progress: Progress = None,
) -> Any:
    """Measures every label of an image, or every piece of each.

    Parameters
    ----------
    image, spacing, label, threshold, fill_cavities, largest_component, \
sigma, thickness, epsilon, level, embedding, derivatives, quadrature, delta, clip, padding, paper, \
explain, names, name, threads, progress
        As of `measure`. A list of labels measures these.
    per_component : bool
        Whether each 26-connected piece is an object of its own, the largest first.
    as_frame : bool
        Whether the result is a data frame of pandas, which has to be installed.

    Returns
    -------
    pandas.DataFrame or dict of lists
        The columns of ``surfometry measure --format csv`` (docs/contract.md), a row an object, and before them ``index``,
        which equals ``label``: so a layer of napari takes the table as its features. Units are in the names. A number
        that could not be had is NaN in a frame, None in a dict.

    Raises
    ------
    InputError, ParameterError, FileError, UnsupportedTypeError
        As of `measure`.

    Warns
    -----
    SurfometryWarning
        Each flag once, with the first object that raises it and how many do.
    """
    known, options = prepared(image, spacing, chosen(locals()), names, name)
    with session(threads, progress) as running:
        table = json.loads(_core.measure_columns(Request(known, options, running)))
    return tabulated(table, as_frame)


def tabulated(table: Mapping[str, Any], as_frame: bool) -> Any:
    """Columns and flags of objects as a frame or a dict of lists; each flag is warned of in the name of whoever called."""
    columns: dict[str, list[Any]] = {"index": list(table["columns"]["label"]), **table["columns"]}
    objects = [f"label {label}" for label in columns["label"]]
    flags: dict[str, list[Flag]] = {}
    for of_object, raised in zip(objects, table["flags"], strict=True):
        flags.setdefault(of_object, []).extend(flags_of(raised))
    warn_of(flags, stacklevel=3)
    return _frame(columns) if as_frame else columns


def _frame(columns: dict[str, list[Any]]) -> pandas.DataFrame:
    """Columns with one type each: whole numbers where all are, doubles where some are missing."""
    try:
        import pandas
    except ImportError as error:
        raise ImportError("a data frame wants pandas: pip install pandas, or as_frame=False") from error
    frame: pandas.DataFrame = pandas.DataFrame(columns)
    for name in frame.columns:
        values = columns[name]
        if all(value is None or isinstance(value, (int, float)) and not isinstance(value, bool) for value in values):
            whole = values and all(isinstance(value, int) for value in values)
            frame[name] = np.array(values, dtype=np.int64 if whole else np.float64)
    # The copy joins a hundred columns, which pandas keeps apart and then warns of when one is added.
    joined: pandas.DataFrame = frame.copy()
    return joined


def sweep(
    image: object,
    values: Sequence[float],
    spacing: float | Sequence[float] | None = None,
    *,
    over: str = "sigma",
    label: Labels | None = None,
    threshold: Threshold | None = None,
    fill_cavities: bool = False,
    largest_component: bool = False,
    sigma: Length | None = None,
    thickness: Length | None = None,
    level: float | None = None,
    embedding: str | None = None,
    derivatives: str | None = None,
    quadrature: str | None = None,
    delta: str | None = None,
    clip: str | None = None,
    paper: bool = False,
    names: Names | None = None,
    name: str | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> list[Measurement]:
    """Measures the same objects over values of a parameter, from one reading.

    Parameters
    ----------
    image, spacing, label, threshold, fill_cavities, largest_component, \
sigma, thickness, level, embedding, derivatives, quadrature, delta, clip, paper, names, name, threads, \
progress
        As of `measure`; what is swept is left out.
    values : sequence of floats
        mm, or the level itself.
    over : {"sigma", "thickness", "level"}
        What is swept.

    Returns
    -------
    list of Measurement
        Object by object, each over the values; what is swept stands in their `parameters`.

    Raises
    ------
    InputError, ParameterError, FileError, UnsupportedTypeError
        As of `measure`, and where the swept parameter is given as well.

    Warns
    -----
    SurfometryWarning
        Values that make no sense for an object; the others are measured.
    """
    if locals().get(over) is not None:
        raise ParameterError("the same length is swept and given: leave the option out", field=over)
    known, options = prepared(image, spacing, chosen(locals()), names, name)
    with session(threads, progress) as running:
        request = Request(known, options, running)
        found = json.loads(_core.sweep(request, over, [float(value) for value in values]))
    _warn_of_failures(found["failures"])
    return [Measurement(record) for record in found["results"]]


def _warn_of_failures(failures: list[dict[str, str]]) -> None:
    import warnings

    for failure in failures:
        warnings.warn(f"{failure['input']}: {failure['error']}", SurfometryWarning, stacklevel=3)


def reference(
    image: object,
    spacing: float | Sequence[float] | None = None,
    *,
    methods: Sequence[str] = (),
    label: Labels | None = None,
    threshold: Threshold | None = None,
    fill_cavities: bool = False,
    largest_component: bool = False,
    names: Names | None = None,
    name: str | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> list[dict[str, Any]]:
    """Measures objects by classical methods: counted voxels, triangulation, Crofton and others.

    Parameters
    ----------
    image, spacing, label, threshold, fill_cavities, largest_component, names, name, threads, progress
        As of `measure`.
    methods : sequence of str
        Names as of ``surfometry reference --method``; all by default.

    Returns
    -------
    list of dict
        Records of ``surfometry reference --format json`` (docs/contract.md), object by object.

    Raises
    ------
    InputError, ParameterError, FileError, UnsupportedTypeError
        As of `measure`, and for a method of no known name.

    Notes
    -----
    The methods, where they are from, and what they are off by: docs/reference_methods.md.
    """
    known, options = prepared(image, spacing, chosen(locals()), names, name)
    with session(threads, progress) as running:
        records: list[dict[str, Any]] = json.loads(_core.reference(Request(known, options, running), list(methods)))
    return records


def compare(
    method: str | PathLike[str] | pandas.DataFrame,
    standard: str | PathLike[str] | pandas.DataFrame,
    *,
    columns: Sequence[str] = (),
    object: str = "input",
    label: str | None = None,
    names: tuple[str, str] | None = None,
    bootstrap: int = 2000,
) -> dict[str, Any]:
    """Compares two tables of the same objects: regression, Bland-Altman, concordance, Euler characteristics.

    Parameters
    ----------
    method, standard : path or DataFrame
        Tables that ``surfometry`` wrote, tables of other programs, folders of tables, or frames of `measure_labels`.
    columns : sequence of str
        What is compared: a column of both, or ``METHOD:STANDARD``.
    object : str
        The column that names the objects' inputs, or ``METHOD:STANDARD``.
    label : str, optional
        The column that has the objects' labels, ``label`` unless told, or ``METHOD:STANDARD``.
    names : pair of str, optional
        What the two are called.
    bootstrap : int
        Samples, at least 100.

    Returns
    -------
    dict
        The document of ``surfometry compare -o FILE.json`` (docs/agreement.md).

    Raises
    ------
    InputError, FileError, ParameterError
        For tables that cannot be read or have nothing in common.
    """
    with tempfile.TemporaryDirectory() as folder:
        ours, theirs = _table(method, Path(folder) / "method.csv"), _table(standard, Path(folder) / "standard.csv")
        document: dict[str, Any] = json.loads(_core.compare(ours, theirs, list(columns), object, label, names, bootstrap))
    return document


def _table(table: Any, path: Path) -> str:
    """The table's file: a frame is written to one."""
    if not hasattr(table, "to_csv"):
        return str(fspath(table))
    table.drop(columns="index", errors="ignore").to_csv(path, index=False)
    return str(path)
