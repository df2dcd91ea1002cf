"""What the commands do, a function each."""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Mapping, Sequence
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core
from ._adapters import image_of, readable
from ._errors import InputError, ParameterError, SurfometryWarning
from ._image import Image, names_of, spacing_words
from ._options import Labels, Length, Names, Samples, Threshold, chosen, options_of
from ._results import Flag, Measurement, flags_of, warn_of
from ._session import Progress, Request, several_objects, session
from ._surface import Surface, surface_of

if TYPE_CHECKING:
    import pandas


def _prepared(
    image: object,
    spacing: float | Sequence[float] | None,
    options: Mapping[str, object],
    names: Names | None = None,
    name: str | None = None,
) -> tuple[str | Image, dict[str, str]]:
    """What is measured, and the words of its options."""
    known = _opened(image, spacing, name)
    # A file is as `read` gives it, an array (z, y, x).
    axes = "zyx" if isinstance(known, str) else known.axes
    return known, options_of(spacing=spacing_words(spacing, axes), names=names or None, **options)


def _opened(image: object, spacing: float | Sequence[float] | None, name: str | None = None) -> str | Image:
    """The name of a file, or an image whose spacing is known."""
    if isinstance(image, (str, PathLike)):
        if name is not None:
            raise ParameterError("a file has a name: leave name= out")
        return fspath(image)
    known = readable(image_of(image), name)
    if known.affine is None and spacing is None:
        hint = "spacing=, in mm, in the order of the array's axes"
        raise InputError(
            f"{known.name}: it holds no voxel spacing: say what it is ({hint}; spacing=1 where a voxel is the unit)",
            field="spacing",
            hint=hint,
        )
    return known


def only(found: list[Any]) -> Any:
    """What there is of the one object."""
    if len(found) != 1:
        raise several_objects(len(found))
    return found[0]


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
    known, options = _prepared(image, spacing, chosen(locals()), names, name)
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
    known, options = _prepared(image, spacing, chosen(locals()), names, name)
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
    known, options = _prepared(image, spacing, chosen(locals()), names, name)
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
    known, options = _prepared(image, spacing, chosen(locals()), names, name)
    with session(threads, progress) as running:
        records: list[dict[str, Any]] = json.loads(_core.reference(Request(known, options, running), list(methods)))
    return records


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
    known, options = _prepared(image, spacing, chosen(locals()), names, name)
    with session(threads, progress, one_object=label is None) as running:
        later = None if against is None else _opened(against, spacing)
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
    known, options = _prepared(image, spacing, chosen(locals()), names, name)
    with session(threads, progress, one_object=label is None) as running:
        filling = f"{outside:g}"
        found = _core.voxel_maps(Request(known, options, running), _scale(curvature_sigma), asked, filling)
    maps = only(found)
    if isinstance(known, str):
        # Its place in the world, not its voxels: those are measured already.
        known = read(known, spacing, threads=threads)
    return {quantity: known.given_back(array) for quantity, array in maps["arrays"].items()}


def read(
    name: str | PathLike[str], spacing: float | Sequence[float] | None = None, *, threads: int | None = None
) -> Image:
    """Reads an image in a file, a closed mesh as voxels, or a built-in shape.

    Parameters
    ----------
    name : path or str
        A file of any format that ``surfometry measure`` takes, or ``phantom:NAME?key=value&...``.
    spacing : float or sequence of three floats, optional
        mm, in the order (z, y, x): replaces the file's, or supplies what it lacks; of a mesh that of the voxels.
    threads : int, optional
        As of `measure`.

    Returns
    -------
    Image
        With `array` (z, y, x) of the type that the file stores, `spacing` (z, y, x), `affine`, `label_names`; all
        functions take it.

    Raises
    ------
    FileError, InputError
        Also OSError and ValueError.
    """
    with session(threads, None) as running:
        options = options_of(spacing=spacing_words(spacing, "zyx"))
        given = _core.read(fspath(name), options, running)
    truth = json.loads(given["truth"])
    warn_of({fspath(name): list(flags_of(json.loads(given["flags"])))}, stacklevel=2)

    def like(array: Any) -> Image:
        return Image(array, "zyx", given["affine"], fspath(name), frame="RAS")

    label_names = names_of(given["label_names"])
    return Image(given["voxels"], "zyx", given["affine"], fspath(name), label_names, "RAS", truth, like)


def phantom(name: str, spacing: float | Sequence[float] | None = None, **keys: float | str | Sequence[float]) -> Image:
    """A built-in shape with known truth.

    Parameters
    ----------
    name : str
        ``ball``, ``torus``, ``femur`` and others (docs/contract.md), with or without ``phantom:`` and keys behind ``?``.
    spacing : float or sequence of three floats, optional
        mm, in the order (z, y, x).
    **keys
        ``radius``, ``major``, ``rotate=(a, b, c)`` and others, as of the command line: vectors are x first there.

    Returns
    -------
    Image
        Labels as uint8, and `truth`: the exact integrals by the names of records.

    Raises
    ------
    InputError
        For a name or key that is not known.

    Examples
    --------
    >>> import surfometry
    >>> ball = surfometry.phantom("ball", radius=8, spacing=(2, 1, 1))
    >>> ball.spacing
    (2.0, 1.0, 1.0)
    """
    joined = "&".join(f"{key}={_key_words(value)}" for key, value in keys.items())
    spec = name if name.startswith("phantom:") else f"phantom:{name}"
    if joined:
        spec += ("&" if "?" in spec else "?") + joined
    return read(spec, spacing)


def _key_words(value: float | str | Sequence[float]) -> str:
    if isinstance(value, (str, int)):
        return str(value)
    if isinstance(value, Sequence):
        return ",".join(repr(float(part)) for part in value)
    return repr(float(value))


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
        As of `surface`.

    Raises
    ------
    InputError, ParameterError, FileError, UnsupportedTypeError
        As of `measure`, where the page would replace the image, and where it cannot be written.
    """
    known, options = _prepared(image, spacing, chosen(locals()), names, name)
    if isinstance(known, str) and Path(known).exists() and Path(output).exists() and Path(known).samefile(output):
        raise ParameterError(f"{output}: the page would replace the input; choose another name", path=fspath(output))
    command = f"surfometry.report of {known if isinstance(known, str) else known.name} in Python {sys.version.split()[0]}"
    with session(threads, progress) as running:
        request = Request(known, options, running)
        _core.report(request, _scale(curvature_sigma), output, title, date, command)
