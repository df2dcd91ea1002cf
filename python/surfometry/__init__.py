"""Measures the surfaces of segmented 3-D objects: volume, area, mean and Gaussian curvature, Euler characteristic.

Lengths are in mm. ``spacing`` is in the order of an array's axes; see docs/python.md for axes, units and errors.

>>> import surfometry
>>> surfometry.measure(surfometry.phantom("torus", major=10, minor=4)).topology.handles
1
"""

from ._core import VERSION as __version__
from ._cohort import CohortSummary, cohort
from ._errors import (
    Error,
    FileError,
    InputError,
    InternalError,
    ParameterError,
    SurfometryWarning,
    UnsupportedTypeError,
)
from ._image import Image
from ._maps import report, surface, voxel_maps
from ._measure import compare, measure, measure_labels, reference, sweep
from ._reading import phantom, read
from ._results import Flag, Interface, Measurement, Region, Topology, Values
from ._surface import Surface

__all__ = [
    "CohortSummary",
    "Error",
    "FileError",
    "Flag",
    "Image",
    "InputError",
    "Interface",
    "InternalError",
    "Measurement",
    "ParameterError",
    "Region",
    "Surface",
    "SurfometryWarning",
    "Topology",
    "UnsupportedTypeError",
    "Values",
    "__version__",
    "cohort",
    "compare",
    "measure",
    "measure_labels",
    "phantom",
    "read",
    "reference",
    "report",
    "surface",
    "sweep",
    "voxel_maps",
]
