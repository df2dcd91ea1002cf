"""How a call is run: its threads, its progress, and what it asks of the extension module."""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Callable
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

from . import _core
from ._errors import InputError, ParameterError, SurfometryWarning

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ._image import Image

#: ``True`` for a bar of tqdm, or a function that is called with (text, so much, of so much).
Progress: TypeAlias = bool | Callable[[str, int, int], None] | None
_VARIABLES = ("SURFOMETRY_NUM_THREADS", "RAYON_NUM_THREADS")


@dataclass(frozen=True)
class Session:
    """How a call is run."""

    threads: int
    progress: Callable[[str, int, int], None] | None = None
    labels: Callable[[int], None] | None = None


@dataclass(frozen=True)
class Request:
    """What is asked of the extension module."""

    image: str | Image
    options: dict[str, str]
    session: Session


def threads_of(threads: int | None) -> int:
    """As many threads as were asked for, by argument or environment, at most one a core that may be used."""
    cores = _cores()
    if threads is not None:
        return min(_count("threads", threads), cores)
    for variable in _VARIABLES:
        # 0 stands for all, as rayon has it.
        if os.environ.get(variable) not in (None, "", "0"):
            return min(_count(variable, os.environ[variable]), cores)
    return cores


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _count(name: str, value: object) -> int:
    try:
        count = int(value)  # type: ignore[call-overload]
    except (TypeError, ValueError):
        count = 0
    if count < 1:
        raise ParameterError(f"{name}={value!r}: a number of threads is 1 or more", field=name)
    return int(count)


@contextmanager
def session(threads: int | None, progress: Progress, *, one_object: bool = False) -> Iterator[Session]:
    """A session; its bar is closed at the end."""
    listener = _warned_of_many
    if one_object:
        listener = _refused_from_two_on
    count = threads_of(threads)
    if callable(progress):
        yield Session(count, progress, listener)
    elif progress:
        with _Bar() as bar:
            yield Session(count, bar.show, listener)
    else:
        yield Session(count, None, listener)


def _refused_from_two_on(labels: int) -> None:
    if labels > 1:
        raise several_objects(f"at least {labels}")


def several_objects(count: object) -> InputError:
    """What is said where one object was wanted."""
    return InputError(
        f"the image holds {count} objects: choose one with label=, unite some with label=(1, 2), or call measure_labels",
        field="label",
        hint="label=, or measure_labels",
    )


def _warned_of_many(labels: int) -> None:
    message = _core.grey_image_warning("image", labels)
    if message is not None:
        warnings.warn(message, SurfometryWarning, stacklevel=2)


class _Bar:
    """A bar of tqdm, where that is installed: for terminals and notebooks alike."""

    def __init__(self) -> None:
        try:
            from tqdm.auto import tqdm
        except ImportError:
            warnings.warn("progress=True wants tqdm: pip install tqdm", SurfometryWarning, stacklevel=5)
            self._bar: Any = None
        else:
            self._bar = tqdm(leave=False, file=sys.stderr)

    def __enter__(self) -> _Bar:
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()

    def show(self, text: str, done: int, of: int) -> None:
        """Shows that so much is done."""
        if self._bar is not None:
            self._bar.set_description(text, refresh=False)
            self._bar.total = of
            self._bar.n = done
            self._bar.refresh()
