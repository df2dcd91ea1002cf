"""Measures for `skimage.measure.regionprops_table`."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._errors import InputError, SurfometryWarning
from ._measure import measure
from ._results import Measurement

_MEASURES = ("volume", "surface_area", "total_mean_curvature", "average_mean_curvature", "euler_characteristic")


def properties(
    spacing: float | Sequence[float], *, measures: Sequence[str] = _MEASURES, **options: Any
) -> tuple[Callable[[NDArray[np.bool_]], float], ...]:
    """Functions to be passed as `extra_properties` of `regionprops` and `regionprops_table`.

    scikit-image hands such functions the mask of one label and no spacing, so that spacing is said here. Each label is
    measured once, whatever the number of measures; `surfometry.measure_labels` reads the image once for all labels, and is
    faster.

    Parameters
    ----------
    spacing : float or sequence of three floats
        mm, in the order of the image's axes: that of `regionprops`.
    measures : sequence of str
        Names of numbers of `surfometry.Measurement`.
    **options
        As of `surfometry.measure`.

    Returns
    -------
    tuple of functions
        Named as the measures. What cannot be had, as of an object of a few voxels, is NaN.

    Examples
    --------
    >>> import surfometry.skimage
    >>> [function.__name__ for function in surfometry.skimage.properties(spacing=(2, 1, 1))][:2]
    ['volume', 'surface_area']
    """
    measured = _Latest(spacing, options)
    return tuple(_property(name, measured) for name in measures)


def _property(name: str, measured: _Latest) -> Callable[[NDArray[np.bool_]], float]:
    def value(mask: NDArray[np.bool_]) -> float:
        measurement = measured.of(mask)
        number = None if measurement is None else getattr(measurement, name)
        return math.nan if number is None else float(number)

    value.__name__ = value.__qualname__ = name
    return value


class _Latest:
    """The measurement of the mask that came last: all measures of a label come one after the other."""

    def __init__(self, spacing: float | Sequence[float], options: dict[str, Any]) -> None:
        self._spacing = spacing
        self._options = options
        self._mask: NDArray[np.bool_] | None = None
        self._measured: Measurement | None = None

    def of(self, mask: NDArray[np.bool_]) -> Measurement | None:
        """Its measurement; None where it cannot be had."""
        if self._mask is None or not np.array_equal(self._mask, mask):
            # A copy: whoever handed it over may write to it.
            self._mask, self._measured = mask.copy(), self._measure(mask)
        return self._measured

    def _measure(self, mask: NDArray[np.bool_]) -> Measurement | None:
        # The label does not touch the edge of the image where it touches that of its box.
        padded = np.pad(mask.astype(bool), 1)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SurfometryWarning)
            try:
                return measure(padded, self._spacing, **self._options)
            except InputError:
                return None
