"""Exceptions and the warning: each is also what the standard library calls such a fault."""

from __future__ import annotations


class Error(Exception):
    """Base of everything that surfometry raises.

    Attributes
    ----------
    path : str or None
        The file at fault, where there is one.
    field : str or None
        The argument at fault, where there is one.
    hint : str or None
        What helps, where that is known.
    """

    path: str | None
    field: str | None
    hint: str | None

    def __init__(
        self, message: str, path: str | None = None, field: str | None = None, hint: str | None = None
    ) -> None:
        super().__init__(message)
        self.path = path
        self.field = field
        self.hint = hint

    def __str__(self) -> str:
        return str(self.args[0])

    def __reduce__(self) -> tuple[type[Error], tuple[str, str | None, str | None, str | None]]:
        return type(self), (str(self), self.path, self.field, self.hint)


class InputError(Error, ValueError):
    """An image that cannot be measured."""


class ParameterError(Error, ValueError):
    """An argument that makes no sense, by itself or beside others."""


class FileError(Error, OSError):
    """A file that cannot be read or written."""


class UnsupportedTypeError(Error, TypeError):
    """Something that is no image, or an image of no numbers."""


class InternalError(Error, RuntimeError):
    """A fault of surfometry's own: please report it."""


class SurfometryWarning(UserWarning):
    """What a number cannot say: the flags of a result (docs/flags.md), and what could not be had beside."""
