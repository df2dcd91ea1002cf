"""Results: a record of the command line's JSON, with names to type."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from typing import Any

from ._errors import SurfometryWarning

# The names of numbers in records, and what they are called here: units are mm and its powers throughout.
_NUMBERS = {
    "volume_mm3": "volume",
    "surface_area_mm2": "surface_area",
    "total_mean_curvature_mm": "total_mean_curvature",
    "average_mean_curvature_per_mm": "average_mean_curvature",
    "total_gaussian_curvature": "total_gaussian_curvature",
    "euler_characteristic": "euler_characteristic",
    "total_squared_mean_curvature": "total_squared_mean_curvature",
}
_UNITS = ["mm³", "mm²", "mm", "1/mm", "", "", ""]


@dataclass(frozen=True)
class Flag:
    """A warning: what a number cannot say (docs/flags.md).

    Attributes
    ----------
    code : str
        For machines, such as ``thick-slices``.
    message : str
        For people, with the sizes at hand.
    """

    code: str
    message: str


@dataclass(frozen=True)
class Values:
    """Numbers of a surface; None where one could not be had.

    Attributes
    ----------
    volume : float or None
        mm^3.
    surface_area : float or None
        mm^2.
    total_mean_curvature : float or None
        M, the integral of H over the surface, mm.
    average_mean_curvature : float or None
        M / A, 1/mm.
    total_gaussian_curvature : float or None
        The integral of K.
    euler_characteristic : float or None
        Of the surface: ball 2, torus 0.
    total_squared_mean_curvature : float or None
        The integral of H^2, the bending energy.
    """

    volume: float | None = None
    surface_area: float | None = None
    total_mean_curvature: float | None = None
    average_mean_curvature: float | None = None
    total_gaussian_curvature: float | None = None
    euler_characteristic: float | None = None
    total_squared_mean_curvature: float | None = None

    @classmethod
    def of(cls, record: Mapping[str, Any]) -> Values:
        """The numbers of a record."""
        return cls(**{name: record.get(key) for key, name in _NUMBERS.items()})


@dataclass(frozen=True)
class Topology:
    """Exact Euler characteristics and what they are made of; None where one could not be had.

    All are of the *surface*, twice those of the solid: ball 2, torus 0, shell 4 (docs/quantities.md).

    Attributes
    ----------
    euler_characteristic_mesh : float or None
        V - E + F of phi = 0 as a mesh.
    euler_characteristic_voxels_26, euler_characteristic_voxels_6 : float or None
        Of the voxels' surface, 26-connected and 6-connected.
    components, cavities, handles : int or None
        How many pieces, enclosed holes and tunnels the voxels have, 26-connected.
    euler_characteristic_expected : float or None
        What the band must see: the weighted mean over its levels (docs/quantities.md).
    """

    euler_characteristic_mesh: float | None
    euler_characteristic_voxels_26: float | None
    euler_characteristic_voxels_6: float | None
    components: int | None
    cavities: int | None
    handles: int | None
    euler_characteristic_expected: float | None


@dataclass(frozen=True)
class Region:
    """The part of an object in one region; the parts of an object add up to it.

    Attributes
    ----------
    region : int
        Its label; 0 of what lies in none.
    name : str or None
        Its name, where it has one.
    voxels : int
        The object's voxels there.
    values, standard_error, blurred : Values
        As of the object.
    """

    region: int
    name: str | None
    voxels: int
    values: Values
    standard_error: Values
    blurred: Values


@dataclass(frozen=True)
class Interface:
    """The contact of two labels; the normal points from the first to the second.

    Attributes
    ----------
    labels : tuple
        The two, the lower first; 0 is background.
    names : tuple
        Their names, None where there is none.
    values, standard_error : Values
        Area, integral and mean of H; the others are None.
    curvature_share : float
        Share of the area over which curvature was measured.
    """

    labels: tuple[int | str, ...]
    names: tuple[str | None, ...]
    values: Values
    standard_error: Values
    curvature_share: float


class Measurement:
    """The numbers of one object, of its surface as it was segmented unless ``surface`` says otherwise.

    All lengths are in mm. The record of the command line's JSON is in `to_dict()`, to the bit.
    """

    __slots__ = ("_record",)

    def __init__(self, record: dict[str, Any]) -> None:
        self._record = record

    @property
    def volume(self) -> float | None:
        """V, mm^3."""
        return self._number("volume_mm3")

    @property
    def surface_area(self) -> float | None:
        """A, mm^2."""
        return self._number("surface_area_mm2")

    @property
    def total_mean_curvature(self) -> float | None:
        """M, the integral of H over the surface, mm."""
        return self._number("total_mean_curvature_mm")

    @property
    def average_mean_curvature(self) -> float | None:
        """M / A, 1/mm."""
        return self._number("average_mean_curvature_per_mm")

    @property
    def total_gaussian_curvature(self) -> float | None:
        """The integral of K over the surface."""
        return self._number("total_gaussian_curvature")

    @property
    def euler_characteristic(self) -> float | None:
        """Of the surface: ball 2, torus 0, shell 4."""
        return self._number("euler_characteristic")

    @property
    def total_squared_mean_curvature(self) -> float | None:
        """The integral of H^2, the bending energy; of the blurred and of given surfaces."""
        return self._number("total_squared_mean_curvature")

    def _number(self, key: str) -> float | None:
        value: float | None = self._record[key]
        return value

    @property
    def input(self) -> str:
        """What was measured, as named."""
        return str(self._record["input"])

    @property
    def label(self) -> int | str | None:
        """The label; words such as ``"1+2"`` of united ones; None of a field."""
        label: int | str | None = self._record["label"]
        return label

    @property
    def name(self) -> str | None:
        """The label's name, where there is one."""
        name: str | None = self._record["name"]
        return name

    @property
    def surface(self) -> str:
        """Which surface the numbers are of: ``original``, ``blurred`` or ``given``."""
        return str(self._record["surface"])

    @property
    def standard_error(self) -> Values:
        """Standard errors of the numbers; None where no model holds."""
        return Values.of(self._record["standard_error"])

    @property
    def blurred(self) -> Values:
        """The integrals over phi = 0."""
        return Values.of(self._record["blurred"])

    @property
    def truth(self) -> Values | None:
        """Exact integrals of a built-in shape."""
        truth = self._record["truth"]
        return None if truth is None else Values.of(truth)

    @property
    def topology(self) -> Topology:
        """Exact topology of voxels and mesh."""
        record = self._record["topology"]
        return Topology(**{name: record[name] for name in Topology.__dataclass_fields__})

    @property
    def parameters(self) -> dict[str, Any]:
        """All choices, filled in."""
        return dict(self._record["parameters"])

    @property
    def flags(self) -> tuple[Flag, ...]:
        """What the numbers cannot say."""
        return flags_of(self._record["flags"])

    @property
    def regions(self) -> tuple[Region, ...] | None:
        """The parts of the object by regions; None where there are no regions."""
        parts = self._record.get("regions")
        if parts is None:
            return None
        return tuple(
            Region(
                part["region"],
                part["name"],
                part["voxels"],
                Values.of(part),
                Values.of(part["standard_error"]),
                Values.of(part["blurred"]),
            )
            for part in parts
        )

    @property
    def interfaces(self) -> tuple[Interface, ...] | None:
        """The contacts of the object with other labels and background; None where they were not asked for."""
        found = self._record.get("interfaces")
        if found is None:
            return None
        return tuple(
            Interface(
                tuple(contact["labels"]),
                tuple(contact["names"]),
                Values.of(contact),
                Values.of(contact["standard_error"]),
                contact["curvature_share"],
            )
            for contact in found
        )

    def to_dict(self) -> dict[str, Any]:
        """The record of the command line's JSON (docs/contract.md)."""
        return dict(self._record)

    def __eq__(self, other: object) -> bool:
        """Whether all numbers are the same; how long they took does not count."""
        if not isinstance(other, Measurement):
            return NotImplemented
        return _timeless(self._record) == _timeless(other._record)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[type[Measurement], tuple[dict[str, Any]]]:
        return type(self), (self._record,)

    def _rows(self) -> list[tuple[str, str, str, str]]:
        errors = self.standard_error
        rows = zip(_NUMBERS.items(), _UNITS, strict=True)
        return [
            (name.replace("_", " "), _digits(self._record[key]), _digits(getattr(errors, name)), unit)
            for (key, name), unit in rows
        ]

    def _title(self) -> str:
        label = "" if self.label is None else f", label {self.label}"
        return f"{self.input}{label} ({self.surface} surface)"

    def __repr__(self) -> str:
        rows = [f"  {name:<28} {value:>12} ± {error:<10} {unit}".rstrip() for name, value, error, unit in self._rows()]
        flags = [f"  flag {flag.code}" for flag in self.flags]
        return "\n".join([self._title(), *rows, *flags])

    def _repr_html_(self) -> str:
        cells = "".join(
            f"<tr><th>{name}</th><td>{value}</td><td>± {error}</td><td>{unit}</td></tr>"
            for name, value, error, unit in self._rows()
        )
        flags = "".join(f"<br><b>{escape(flag.code)}</b>: {escape(flag.message)}" for flag in self.flags)
        return f"<table><caption>{escape(self._title())}{flags}</caption>{cells}</table>"


def _digits(value: float | None) -> str:
    return "-" if value is None else f"{value:.5g}"


def _timeless(record: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in record.items() if key not in ("input_sha256", "read_seconds", "seconds")}


def flags_of(flags: list[dict[str, str]]) -> tuple[Flag, ...]:
    """Flags of a record."""
    return tuple(Flag(flag["code"], flag["message"]) for flag in flags)


def warn_of(flags: Mapping[str, list[Flag]], stacklevel: int) -> None:
    """Warns of each flag once, whichever objects raise it."""
    raised: dict[str, tuple[str, list[str]]] = {}
    for object_name, of_object in flags.items():
        for flag in of_object:
            raised.setdefault(flag.code, (flag.message, []))[1].append(object_name)
    for code, (message, objects) in raised.items():
        more = len(objects) - 1
        many = f" (and {more} object{'s' if more > 1 else ''} more)" if more else ""
        warnings.warn(f"{objects[0]}: {code}: {message}{many}", SurfometryWarning, stacklevel=stacklevel + 1)
