"""Arguments as the words that the command line has for them: one vocabulary, no default of its own."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from os import PathLike, fspath
from typing import TypeAlias

from ._errors import ParameterError

#: A label, by number or by name, or labels that are one object.
LabelKey: TypeAlias = int | str | tuple[int | str, ...]
#: Labels: one, several (each an object), united ones in a tuple, or words such as ``"1,2+3"``.
Labels: TypeAlias = LabelKey | Sequence[LabelKey]
#: The grey values that are the object, (low, high), both inside; None is no bound. Or words, ``"226.."``.
Threshold: TypeAlias = str | tuple[float | None, float | None]
#: A length in mm, ``"auto"``, or lengths of labels of their own; those of all others under ``"all"``.
Length: TypeAlias = float | str | Mapping[LabelKey, float | str]

#: A volume that is put on a surface, in a file; several; or names of arrays and such.
Samples: TypeAlias = str | PathLike[str] | Sequence[str | PathLike[str]] | Mapping[str, str | PathLike[str]]

#: Names of labels, or a table of them in a file.
Names: TypeAlias = Mapping[int, str] | str | PathLike[str]


def options_of(**arguments: object) -> dict[str, str]:
    """Names and words of all arguments that say something."""
    said = {name: value for name, value in arguments.items() if value is not None and value is not False}
    return {name: _WORDS.get(name, _plain)(name, value) for name, value in said.items()}


def chosen(local: Mapping[str, object]) -> dict[str, object]:
    """The arguments that choose how objects are measured, under the names of the command line's options."""
    names = (
        "label", "sigma", "thickness", "epsilon", "level", "embedding", "derivatives", "quadrature", "delta", "clip",
        "padding", "paper", "explain", "per_component", "threshold", "fill_cavities", "largest_component", "regions",
        "interfaces", "sample",
    )  # fmt: skip
    return {name: local[name] for name in names if name in local}


def _plain(name: str, value: object) -> str:
    if isinstance(value, str):
        return value
    if value is True:
        return "true"
    try:
        return repr(float(value))  # type: ignore[arg-type]
    except (TypeError, ValueError) as error:
        raise ParameterError(f"{name}={value!r}: neither a number nor a word", field=name) from error


def _label(name: str, value: object) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, Iterable):
        return "+".join(_label(name, part) for part in value)
    try:
        whole = int(value)  # type: ignore[call-overload]
        if whole == value:
            return str(whole)
    except (TypeError, ValueError):
        pass
    raise ParameterError(f"{name}={value!r}: a label is a whole number", field=name)


def _labels(name: str, value: object) -> str:
    if isinstance(value, Iterable) and not isinstance(value, (str, tuple)):
        return ",".join(_label(name, part) for part in value)
    return _label(name, value)


def _length(name: str, value: object) -> str:
    if not isinstance(value, Mapping):
        return _plain(name, value)
    words = [
        _plain(name, length) if label == "all" else f"{_label(name, label)}={_plain(name, length)}"
        for label, length in value.items()
    ]
    return ",".join(words)


def _triple(name: str, value: object) -> str:
    assert isinstance(value, Iterable)
    return ",".join(_plain(name, part) for part in value)


def _range(name: str, value: object) -> str:
    if isinstance(value, str):
        return value
    ends: tuple[object, ...] = ()
    try:
        ends = tuple(value)  # type: ignore[arg-type]
        _, _ = ends
    except (TypeError, ValueError) as error:
        raise ParameterError(
            f"{name}={value!r}: give two grey values, (low, high), both inside; None is no bound", field=name
        ) from error
    return "..".join("" if end is None else _plain(name, end) for end in ends)


def _names(name: str, value: object) -> str:
    if isinstance(value, Mapping):
        return json.dumps({str(label): str(called) for label, called in value.items()})
    assert isinstance(value, (str, PathLike))
    return fspath(value)


def _file(name: str, value: object) -> str:
    if not isinstance(value, (str, PathLike)):
        raise ParameterError(f"{name}: give the path of an image, not a {type(value).__name__}", field=name)
    return fspath(value)


def _samples(name: str, value: object) -> str:
    if isinstance(value, Mapping):
        return "\n".join(f"{called}={_file(name, volume)}" for called, volume in value.items())
    several = value if isinstance(value, Iterable) and not isinstance(value, (str, PathLike)) else [value]
    return "\n".join(_file(name, volume) for volume in several)


_WORDS = {
    "regions": _file, "sample": _samples, "threshold": _range, "label": _labels, "names": _names, "sigma": _length,
    "thickness": _length, "spacing": _triple,
}  # fmt: skip
