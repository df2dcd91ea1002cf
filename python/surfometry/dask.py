"""Volumes in blocks, and cohorts of files, on the workers of Dask.

Dask and Zarr are wanted by nothing else in this package: ``pip install "surfometry[dask]"``.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike, fspath
from pathlib import Path
from typing import Any, TypeAlias
from uuid import uuid4

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._cohort import CohortSummary, cohort_of, resumed
from ._cohort import tabulated as cohort_table
from ._errors import Error, InputError, ParameterError, UnsupportedTypeError
from ._image import names_of, native, spacing_words, unmasked
from ._measure import tabulated
from ._options import Labels, Length, Names, chosen, options_of
from ._reading import only
from ._results import Measurement, warn_of
from ._session import Session, several_objects, threads_of

__all__ = ["cohort", "measure", "measure_labels"]

#: First voxel of a box and one past the last.
_Corners: TypeAlias = tuple[tuple[int, ...], tuple[int, ...]]
# Voxels along an axis that a block has at least, where nothing is said: what lies around it is a moderate share then.
_BLOCK = 256
# Partial sums that a task merges.
_TOGETHER = 16


def measure(
    image: object,
    spacing: float | Sequence[float] | None = None,
    *,
    label: Labels | None = None,
    sigma: Length | None = None,
    thickness: Length | None = None,
    epsilon: float | None = None,
    level: float | None = None,
    embedding: str | None = None,
    derivatives: str | None = None,
    quadrature: str | None = None,
    delta: str | None = None,
    paper: bool = False,
    explain: bool = False,
    name: str | None = None,
    block: Sequence[int] | None = None,
    client: Any = None,
    storage_options: Mapping[str, Any] | None = None,
) -> Measurement:
    """Measures one object of a volume that no worker sees as a whole.

    The numbers are those of `surfometry.measure` of the same voxels, to the bit, topology included, whatever the blocks,
    the chunks and the workers. docs/clusters.md has how it is done, and what it costs.

    Parameters
    ----------
    image, spacing, label, sigma, thickness, epsilon, level, embedding, derivatives, quadrature, delta, paper, explain, name, \
block, client, storage_options
        As of `measure_labels`.

    Returns
    -------
    Measurement
        As of `surfometry.measure`.

    Raises
    ------
    InputError, ParameterError, FileError, UnsupportedTypeError
        As of `measure_labels`; a volume of several objects is refused.
    """
    volume = _volume_of(image, name, storage_options)
    run = _Run.of(volume, spacing, chosen(locals()), {}, block, client)
    records = run.records()
    if label is None and len(records) > 1:
        raise several_objects(len(records))
    measured = Measurement(only(records))
    warn_of({measured.input: list(measured.flags)}, stacklevel=2)
    return measured


def measure_labels(
    image: object,
    spacing: float | Sequence[float] | None = None,
    *,
    label: Labels | None = None,
    sigma: Length | None = None,
    thickness: Length | None = None,
    epsilon: float | None = None,
    level: float | None = None,
    embedding: str | None = None,
    derivatives: str | None = None,
    quadrature: str | None = None,
    delta: str | None = None,
    paper: bool = False,
    explain: bool = False,
    names: Mapping[int, str] | None = None,
    name: str | None = None,
    as_frame: bool = True,
    block: Sequence[int] | None = None,
    client: Any = None,
    storage_options: Mapping[str, Any] | None = None,
) -> Any:
    """Measures every label of a volume that no worker sees as a whole.

    Parameters
    ----------
    image : path, URL, zarr.Array or dask.array.Array
        Labels, 0 being background, on three axes (z, y, x); axes of one element in front of them are dropped. Of a path or
        a Zarr array each task reads its own block and what lies around it. A Dask array is computed block by block, and
        what lies around a block as often as it is wanted: it is the slower way.
    spacing : float or sequence of three floats
        Distance between voxels in mm, in the order of the axes.
    label, sigma, thickness, epsilon, level, embedding, derivatives, quadrature, delta, paper, explain, names, name
        As of `surfometry.measure_labels`. What needs an object as a whole is refused: ``embedding="recovering"``,
        ``"probability"`` and ``"given"``, and lengths for labels of their own. Where the defaults measure an object again
        as a whole, because the blur loses detail of it, a task reads the box around it.
    as_frame : bool
        Whether the result is a data frame of pandas.
    block : sequence of three ints, optional
        Voxels of a block along each axis. By default whole chunks, 256 voxels or more. No number depends on it.
    client : distributed.Client, optional
        By default the one that is there; without one the blocks are measured here, one after the other, by all threads.
        A task of a client's takes one thread.
    storage_options : mapping, optional
        Of fsspec, for a URL.

    Returns
    -------
    pandas.DataFrame or dict of lists
        As of `surfometry.measure_labels`.

    Raises
    ------
    InputError
        For voxels that are no labels, and choices that need objects as wholes.
    ParameterError, UnsupportedTypeError
        For arguments that make no sense, and for what is neither a path nor an array of Zarr or Dask.
    """
    volume = _volume_of(image, name, storage_options)
    run = _Run.of(volume, spacing, chosen(locals()), names_of(names), block, client)
    return tabulated(json.loads(_core.columns_of(json.dumps(run.records()))), as_frame)


def cohort(
    inputs: Iterable[str | PathLike[str]],
    out: str | PathLike[str],
    spacing: float | Sequence[float] | None = None,
    *,
    label: Labels | None = None,
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
    client: Any = None,
) -> CohortSummary:
    """Measures many files on the workers of a client, each object a row of one table: `surfometry.cohort` on a cluster.

    The journal is written where this is called, as results come; so the same call goes on after a kill, also without a
    client. A file at which workers die again and again is a row that says so.

    Parameters
    ----------
    inputs, out, spacing, label, sigma, thickness, epsilon, level, embedding, derivatives, quadrature, delta, clip, padding, \
paper, explain, per_component, names, resume
        As of `surfometry.cohort`. The workers must see the files under the same names.
    client : distributed.Client, optional
        By default the one that is there. A file takes one thread.

    Returns
    -------
    CohortSummary
        As of `surfometry.cohort`.

    Raises
    ------
    ParameterError, FileError
        As of `surfometry.cohort`; without a client.
    """
    asked = cohort_of(inputs, out, spacing, chosen(locals()) | {"names": names or None}, resume)
    found = _client(client)
    if found is None:
        raise ParameterError("there is no client: make a distributed.Client, or call surfometry.cohort", field="client")
    journal = _core.CohortJournal(asked)
    _journalled(journal, found, asked.options)
    journal.end()
    return cohort_table(resumed(asked), Path(out), 1, None, retry=False)


def _journalled(journal: _core.CohortJournal, client: Any, options: dict[str, str]) -> None:
    """Measures what is pending; each line is written as it comes."""
    from distributed import as_completed

    names = journal.pending()
    futures = client.map(_core.measured_line, names, options=options, session=Session(1), pure=False)
    name_of = dict(zip((future.key for future in futures), names, strict=True))
    for future in as_completed(futures):
        error = future.exception()
        if error is None:
            journal.add(future.result())
        else:
            words = str(error) if isinstance(error, Error) else f"its workers died or failed: {error}"
            journal.add_failure(name_of[future.key], words)
        # What is written is held nowhere else.
        future.release()


@dataclass(frozen=True)
class _Volume:
    """An array of three axes behind axes of one element."""

    voxels: Any
    name: str

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(int(n) for n in self.voxels.shape[-3:])

    @property
    def chunks(self) -> tuple[int, ...]:
        """Largest chunk along each axis."""
        chunks = self.voxels.chunks[-3:]
        return tuple(int(np.max(sizes)) for sizes in chunks)

    def box(self, lower: Sequence[int], upper: Sequence[int]) -> Any:
        front: list[Any] = [0] * (len(self.voxels.shape) - 3)
        place = tuple(front + [slice(a, b) for a, b in zip(lower, upper, strict=True)])
        return self.voxels[place]


def _volume_of(image: object, name: str | None, storage_options: Mapping[str, Any] | None) -> _Volume:
    if isinstance(image, (str, PathLike)):
        voxels, known = _opened(fspath(image), storage_options), fspath(image)
    else:
        voxels, known = image, "array"
    if not all(hasattr(voxels, wanted) for wanted in ("shape", "chunks", "dtype", "ndim")):
        raise UnsupportedTypeError(
            f"{type(image).__module__}.{type(image).__qualname__} has no chunks: pass a path, a zarr.Array or a dask array; "
            "surfometry.measure takes what fits in memory",
            field="image",
        )
    if voxels.ndim < 3 or any(n != 1 for n in voxels.shape[:-3]):
        shape = tuple(voxels.shape)
        raise InputError(f"{known}: an array of shape {shape}: take one 3-D image of it", path=None, field="image")
    return _Volume(voxels, name or known)


def _opened(url: str, storage_options: Mapping[str, Any] | None) -> Any:
    import zarr

    try:
        # Workers may be at home in other folders.
        place = url if "://" in url else str(Path(url).resolve())
        opened = zarr.open(place, mode="r", storage_options=dict(storage_options) if storage_options else None)
    except (FileNotFoundError, ValueError) as error:
        raise InputError(f"{url}: no Zarr array can be opened there: {error}", path=url) from error
    if isinstance(opened, zarr.Group):
        arrays = ", ".join(sorted(name for name, _ in opened.arrays())) or "none at its top"
        raise InputError(f"{url}: a group of arrays ({arrays}): name one, as {url}/NAME", path=url)
    return opened


@dataclass(frozen=True)
class _Spec:
    """What every task knows: the volume, and how it is measured. Which block is meant is a number."""

    volume: _Volume
    #: Of the volume; that of a Dask array is not here, for its tasks are given what they need.
    shape: tuple[int, ...]
    block: tuple[int, ...]
    options: dict[str, str]
    name: str
    label_names: dict[int, str]
    threads: int

    def blocks(self) -> _core.Blocks:
        return _core.Blocks(list(self.shape[::-1]), None, self.name, self.label_names, self.options)

    @property
    def lattice(self) -> tuple[int, ...]:
        """Blocks along each axis."""
        return tuple(-(-n // size) for n, size in zip(self.shape, self.block, strict=True))

    def corners(self, number: int) -> _Corners:
        """Of a block."""
        place = np.unravel_index(number, self.lattice)
        lower = tuple(int(k) * size for k, size in zip(place, self.block, strict=True))
        upper = tuple(min(a + size, n) for a, size, n in zip(lower, self.block, self.shape, strict=True))
        return lower, upper

    def needed(self, blocks: _core.Blocks, number: int) -> _Corners | None:
        """The voxels around a block that its sums depend on; None where none belong to it."""
        lower, upper = _turned(blocks.needed(*_turned(self.corners(number))))
        return None if any(a >= b for a, b in zip(lower, upper, strict=True)) else (lower, upper)

    def session(self) -> Session:
        return Session(self.threads)


def _turned(corners: Any) -> tuple[Any, ...]:
    """x first to z first, and back."""
    return tuple(list(corner)[::-1] for corner in corners)


def _plain(values: Any) -> NDArray[Any]:
    return unmasked(values) if isinstance(values, np.ma.MaskedArray) else np.asarray(values)


def _part(blocks: _core.Blocks, corners: _Corners, slabs: Iterable[Any]) -> _core.Part:
    part = blocks.part(*_turned(corners))
    for slab in slabs:
        voxels: NDArray[Any] = _plain(slab)
        part.push(native(voxels))
    return part


def _slabs(volume: _Volume, corners: _Corners) -> Iterator[Any]:
    """A box, a layer of chunks at a time: each chunk is read once, and no more than a layer is in memory."""
    lower, upper = corners
    deep = volume.chunks[0]
    for first in range(lower[0] // deep * deep, upper[0], deep):
        z0, z1 = max(first, lower[0]), min(first + deep, upper[0])
        yield volume.box((z0, *lower[1:]), (z1, *upper[1:]))


def _partial(spec: _Spec, number: int, voxels: Any = None) -> bytes:
    """What a block adds; of its voxels and those around it, or read here."""
    blocks = spec.blocks()
    needed = spec.needed(blocks, number)
    part = None
    if needed is not None:
        part = _part(blocks, needed, _slabs(spec.volume, needed) if voxels is None else [voxels])
    lower, upper = _turned(spec.corners(number))
    return blocks.partial(part, lower, upper, spec.session())


def _looked_again(spec: _Spec, records: str, corners: _Corners, voxels: Any = None) -> str:
    """Records of objects that lie in a box, known as wholes."""
    blocks = spec.blocks()
    slabs = _slabs(spec.volume, corners) if voxels is None else [voxels]
    return blocks.looked_again(records, _part(blocks, corners, slabs), spec.session())


@dataclass(frozen=True)
class _Run:
    """A volume, and who computes."""

    volume: _Volume
    spec: _Spec
    get: Callable[[dict[Any, Any], list[Any]], Any]

    @classmethod
    def of(
        cls,
        volume: _Volume,
        spacing: float | Sequence[float] | None,
        options: dict[str, object],
        names: dict[int, str],
        block: Sequence[int] | None,
        client: Any,
    ) -> _Run:
        if spacing is None:
            raise InputError(
                f"{volume.name}: say how far its voxels are apart: spacing=, in mm, in the order of the array's axes",
                field="spacing",
            )
        words = options_of(spacing=spacing_words(spacing, "zyx"), **options)
        found = _client(client)
        size = _block_of(volume, block)
        kept = _Volume(None, volume.name) if _is_lazy(volume) else volume
        threads = threads_of(None) if found is None else 1
        spec = _Spec(kept, volume.shape, size, words, volume.name, names, threads)
        # What cannot be measured in blocks is told before a task starts.
        spec.blocks()
        return cls(volume, spec, _getter(found))

    def records(self) -> list[dict[str, Any]]:
        """Records of all objects; those that are to be looked at as wholes, were."""
        blocks = self.spec.blocks()
        found = json.loads(blocks.records(self._whole(blocks), self.spec.session()))
        records: list[dict[str, Any]] = found["records"]
        wanted = np.flatnonzero(found["wants_whole"])
        for numbers, again in self._looked_again(records, wanted):
            for number, record in zip(numbers, again, strict=True):
                records[number] = record
        return records

    def _whole(self, blocks: _core.Blocks) -> bytes:
        """The sum of all blocks, by a tree of merges."""
        count = math.prod(self.spec.lattice)
        tasks = ((number, self._given(self.spec.needed(blocks, number))) for number in range(count))
        graph, keys = self._graph(_partial, tasks)
        while len(keys) > 1:
            keys = _merges(graph, keys)
        return bytes(self.get(graph, keys)[0])

    def _looked_again(self, records: list[dict[str, Any]], wanted: NDArray[Any]) -> Iterator[tuple[list[int], list[Any]]]:
        groups = list(_neighbours(self.spec, records, wanted))
        if not groups:
            return
        tasks = ((json.dumps([records[n] for n in numbers]), corners, self._given(corners)) for numbers, corners in groups)
        graph, keys = self._graph(_looked_again, tasks)
        for (numbers, _), again in zip(groups, self.get(graph, keys), strict=True):
            yield numbers, json.loads(again)

    def _given(self, corners: _Corners | None) -> Any:
        """What a task is given of a Dask array; nothing where it reads by itself."""
        return self.volume.box(*corners) if corners is not None and _is_lazy(self.volume) else None

    def _graph(self, function: Callable[..., Any], tasks: Iterable[tuple[Any, ...]]) -> tuple[dict[Any, Any], list[Any]]:
        """A task each; what all know is a key that they share."""
        from dask._task_spec import DataNode, Task, TaskRef

        token = f"surfometry{function.__name__}-{uuid4().hex[:8]}"
        shared = f"{token}-spec"
        # One object in all tasks, so that it is sent once.
        known = TaskRef(shared)
        graph: dict[Any, Any] = {shared: DataNode(shared, self.spec)}
        keys: list[Any] = []
        for number, (*arguments, given) in enumerate(tasks):
            key = (token, number)
            if given is not None:
                arguments.append(_computed(graph, given))
            graph[key] = Task(key, function, known, *arguments)
            keys.append(key)
        return graph, keys


def _computed(graph: dict[Any, Any], array: Any) -> Any:
    """A reference to a Dask array's values, whose tasks are added."""
    from dask import delayed
    from dask._task_spec import TaskRef

    values = delayed(_plain)(array)
    graph.update(values.__dask_graph__())
    return TaskRef(values.key)


def _merges(graph: dict[Any, Any], keys: list[Any]) -> list[Any]:
    """The next level of the tree."""
    from dask._task_spec import List, Task, TaskRef

    name = f"surfometry-merged-{uuid4().hex[:8]}"
    made = [(name, first // _TOGETHER) for first in range(0, len(keys), _TOGETHER)]
    for key in made:
        some = keys[key[1] * _TOGETHER : (key[1] + 1) * _TOGETHER]
        graph[key] = Task(key, _core.merged, List(*(TaskRef(one) for one in some)))
    return made


def _neighbours(
    spec: _Spec, records: list[dict[str, Any]], wanted: NDArray[Any]
) -> Iterator[tuple[list[int], _Corners]]:
    """Objects that begin in one block, and the box around them; those that are larger than a block by themselves."""
    groups: dict[Any, list[int]] = {}
    boxes = {int(number): _box_of(records[number]) for number in wanted}
    for number, (lower, upper) in boxes.items():
        is_large = any(b - a > size for a, b, size in zip(lower, upper, spec.block, strict=True))
        place = tuple(a // size for a, size in zip(lower, spec.block, strict=True))
        groups.setdefault(number if is_large else place, []).append(number)
    for numbers in groups.values():
        lowers, uppers = zip(*(boxes[number] for number in numbers), strict=True)
        yield numbers, (tuple(map(min, zip(*lowers, strict=True))), tuple(map(max, zip(*uppers, strict=True))))


def _box_of(record: dict[str, Any]) -> _Corners:
    first, last = record["voxels"]["bounding_box"]
    return tuple(first[::-1]), tuple(n + 1 for n in last[::-1])


def _block_of(volume: _Volume, block: Sequence[int] | None) -> tuple[int, ...]:
    if block is None:
        return tuple(min(-(-_BLOCK // c) * c, n) for c, n in zip(volume.chunks, volume.shape, strict=True))
    sizes = tuple(int(size) for size in np.broadcast_to(np.asarray(block), 3))
    if min(sizes) < 1:
        raise ParameterError(f"block={block!r}: three numbers of voxels, in the order of the axes", field="block")
    return sizes


def _is_lazy(volume: _Volume) -> bool:
    return hasattr(volume.voxels, "__dask_graph__")


def _client(client: Any) -> Any:
    """The client, or the one that is there."""
    distributed = sys.modules.get("distributed")
    if client is not None or distributed is None:
        return client
    try:
        return distributed.default_client()
    except ValueError:
        return None


def _getter(client: Any) -> Callable[[dict[Any, Any], list[Any]], Any]:
    if client is None:
        from dask import get

        return lambda graph, keys: get(graph, keys)
    from dask.highlevelgraph import HighLevelGraph

    # As a layer: of a plain graph each task is sent with a token of its own, which is half of it.
    return lambda graph, keys: client.get(HighLevelGraph({"surfometry": graph}, {"surfometry": set()}), keys)
