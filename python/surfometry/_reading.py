"""Images by their names, built-in shapes, and what a function is given as its image."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from os import PathLike, fspath
from typing import Any

from . import _core
from ._adapters import image_of, readable
from ._errors import InputError, ParameterError
from ._image import Image, names_of, spacing_words
from ._options import Names, options_of
from ._results import flags_of, warn_of
from ._session import several_objects, session


def prepared(
    image: object,
    spacing: float | Sequence[float] | None,
    options: Mapping[str, object],
    names: Names | None = None,
    name: str | None = None,
) -> tuple[str | Image, dict[str, str]]:
    """What is measured, and the words of its options."""
    known = opened(image, spacing, name)
    # A file is as `read` gives it, an array (z, y, x).
    axes = "zyx" if isinstance(known, str) else known.axes
    return known, options_of(spacing=spacing_words(spacing, axes), names=names or None, **options)


def opened(image: object, spacing: float | Sequence[float] | None, name: str | None = None) -> str | Image:
    """The name of a file, or an image whose spacing is known."""
    if isinstance(image, (str, PathLike)):
        if name is not None:
            raise ParameterError("a file has a name: leave name= out")
        return fspath(image)
    known = readable(image_of(image), name)
    if known.affine is None and spacing is None:
        hint = "spacing=, in mm, in the order of the array's axes"
        why, it = (known.unspaced, "the voxel spacing") if known.unspaced else ("it holds no voxel spacing", "it")
        raise InputError(
            f"{known.name}: {why}: say what {it} is ({hint}; spacing=1 where a voxel is the unit)",
            field="spacing",
            hint=hint,
        )
    return known


def only(found: list[Any]) -> Any:
    """What there is of the one object."""
    if len(found) != 1:
        raise several_objects(len(found))
    return found[0]


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
