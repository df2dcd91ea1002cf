"""Many files to one table, by a run that goes on where it was killed."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from importlib.util import find_spec
from os import PathLike, fspath
from pathlib import Path

from . import _core
from ._errors import ParameterError
from ._image import spacing_words
from ._options import Labels, Length, Names, Threshold, chosen, options_of
from ._session import Progress, session

_ENDINGS = (".csv", ".json", ".jsonl", ".parquet")
# Of all other columns the cells are numbers.
_TEXTS = (
    "input", "label", "name", "surface", "clip_mode", "parameters_embedding", "parameters_derivatives",
    "parameters_quadrature", "parameters_delta", "parameters_clip", "topology_changes", "recovery_noisy", "flags", "error",
)  # fmt: skip


@dataclass(frozen=True)
class CohortSummary:
    """What came of a cohort.

    Attributes
    ----------
    out : Path
        The table.
    rows : int
        How many objects it has.
    failures : dict
        The files that could not be measured, and why.
    """

    out: Path
    rows: int
    failures: dict[str, str]


@dataclass(frozen=True)
class Cohort:
    """What is asked of the extension module."""

    inputs: list[str]
    out: str
    options: dict[str, str]
    resume: bool


def cohort(
    inputs: Iterable[str | PathLike[str]],
    out: str | PathLike[str],
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
    resume: bool = True,
    threads: int | None = None,
    progress: Progress = None,
) -> CohortSummary:
    """Measures many files, each object a row of one table: ``surfometry measure --resume``.

    What is finished stands in a journal beside the table, a line a file, as soon as it is there. So a run that is killed
    loses at most the files that it was at, and the same call goes on. Files that are in the journal are left out, unless
    they changed since; what failed is tried again.

    Parameters
    ----------
    inputs : iterable of paths
        Files, or names of built-in shapes; each once. The rows stand in their order.
    out : path
        The table: ``.csv``, ``.json``, ``.jsonl``, or ``.parquet``, which takes pandas and pyarrow. It is written when all
        is measured. The journal is ``OUT.journal``, that of Parquet ``OUT.csv.journal``.
    spacing, label, threshold, fill_cavities, largest_component, \
sigma, thickness, epsilon, level, embedding, derivatives, quadrature, delta, clip, padding, paper, explain, \
per_component, names, threads, progress
        As of `measure_labels`. A spacing replaces that of every file. Lengths for labels of their own are refused.
    resume : bool
        Whether a journal that is there is gone on with; else it is begun anew.

    Returns
    -------
    CohortSummary
        How many rows there are, and which files failed. A file that failed is a row, too, with its ``error``.

    Raises
    ------
    ParameterError
        Also for a journal of other choices: another ``out``, or the journal removed, begins anew.
    FileError
        For a table or a journal that cannot be written.

    Examples
    --------
    >>> import surfometry, tempfile
    >>> folder = tempfile.TemporaryDirectory()
    >>> shapes = [f"phantom:ball?radius={r}" for r in (6, 7, 8)] + ["missing.nii"]
    >>> found = surfometry.cohort(shapes, f"{folder.name}/balls.csv")
    >>> found.rows, list(found.failures)
    (3, ['missing.nii'])
    """
    asked = cohort_of(inputs, out, spacing, chosen(locals()) | {"names": names or None}, resume)
    return tabulated(asked, Path(out), threads, progress)


def cohort_of(
    inputs: Iterable[str | PathLike[str]],
    out: str | PathLike[str],
    spacing: float | Sequence[float] | None,
    options: dict[str, object],
    resume: bool,
) -> Cohort:
    """A cohort, checked before anything is measured."""
    if isinstance(inputs, (str, PathLike)):
        message = f"inputs={inputs!r}: one path, where a list is wanted, such as sorted(glob.glob('scans/*.nii.gz'))"
        raise ParameterError(message, field="inputs")
    names = [fspath(name) for name in inputs]
    if not names:
        raise ParameterError("inputs: there is no file to measure", field="inputs")
    table = Path(out)
    if table.suffix.lower() not in _ENDINGS:
        raise ParameterError(f"out={fspath(out)!r}: take a name that ends in one of {', '.join(_ENDINGS)}", field="out")
    if table.exists() and any(Path(name).exists() and table.samefile(name) for name in names):
        raise ParameterError(f"{table}: the table would replace an input; choose another name", fspath(out), "out")
    if _is_parquet(table) and not (find_spec("pandas") and find_spec("pyarrow")):
        raise ImportError("Parquet wants pandas and pyarrow: pip install pandas pyarrow, or take a name that ends in .csv")
    written = f"{table}.csv" if _is_parquet(table) else fspath(out)
    return Cohort(names, written, options_of(spacing=spacing_words(spacing, "zyx"), **options), resume)


def tabulated(
    asked: Cohort, table: Path, threads: int | None, progress: Progress, *, retry: bool = True
) -> CohortSummary:
    """Measures what is to be measured, and writes the table."""
    with session(threads, progress) as running:
        told = json.loads(_core.cohort(asked, running, retry))
    if _is_parquet(table):
        _to_parquet(Path(asked.out), table)
    return CohortSummary(table, told["rows"], {failed["input"]: failed["error"] for failed in told["failures"]})


def _is_parquet(table: Path) -> bool:
    return table.suffix.lower() == ".parquet"


def _to_parquet(csv: Path, table: Path) -> None:
    """The table with the same type of each column, whatever is in it; whole or not at all."""
    import pandas

    names = pandas.read_csv(csv, nrows=0).columns
    types = {name: "string" if name in _TEXTS else "float64" for name in names}
    # An object may be called NA; numbers keep their bits.
    text = pandas.read_csv(csv, dtype="string", keep_default_na=False).replace("", None)
    unfinished = table.with_name(table.name + ".partial")
    text.astype(types).to_parquet(unfinished, index=False)
    os.replace(unfinished, table)
    csv.unlink()


def resumed(asked: Cohort) -> Cohort:
    """The same, whose journal is there."""
    return replace(asked, resume=True)
