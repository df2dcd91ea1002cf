"""Arrays of every type, order and alignment, and words for those that cannot be measured."""

import tracemalloc

import numpy as np
import pytest
from conftest import SPACING, numbers, turned_body

import surfometry

INTEGERS = ["u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "?", "p", "P", "q", "l"]
FLOATS = ["f2", "f4", "f8", "g"]


@pytest.fixture(scope="module")
def expected():
    return numbers(surfometry.measure(turned_body(), SPACING))


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("kind", INTEGERS + FLOATS)
def test_every_type_and_byte_order(expected, kind, order):
    array = turned_body().astype(np.dtype(kind).newbyteorder(order))
    assert numbers(surfometry.measure(array, SPACING)) == expected


def memory_mapped(array, tmp_path):
    np.save(tmp_path / "array.npy", array)
    return np.load(tmp_path / "array.npy", mmap_mode="r")


def misaligned(array, _):
    wide = array.astype("f4")
    buffer = np.zeros(wide.nbytes + 1, dtype="u1")
    view = buffer[1:].view("f4").reshape(wide.shape)
    view[...] = wide
    assert not view.flags.aligned
    return view


def read_only(array, _):
    array = array.copy()
    array.flags.writeable = False
    return array


LAYOUTS = {
    "fortran": lambda array, _: np.asfortranarray(array),
    "transposed": lambda array, _: np.ascontiguousarray(array.transpose(1, 2, 0)).transpose(2, 0, 1),
    "negative strides": lambda array, _: array[::-1, :, ::-1].copy()[::-1, :, ::-1],
    "strided": lambda array, _: np.repeat(array, 2, axis=1)[:, ::2],
    "read-only": read_only,
    "memory-mapped": memory_mapped,
    "misaligned": misaligned,
    "masked, nothing masked": lambda array, _: np.ma.array(array, mask=False),
    "a batch of one channel": lambda array, _: array[None, None],
    "nested lists": lambda array, _: array.tolist(),
    "what has __array__": lambda array, _: type("Lazy", (), {"__array__": lambda self, *a, **k: array})(),
}


@pytest.mark.parametrize("layout", LAYOUTS.values(), ids=LAYOUTS.keys())
def test_numbers_do_not_depend_on_where_voxels_lie(expected, tmp_path, layout):
    assert numbers(surfometry.measure(layout(turned_body(), tmp_path), SPACING)) == expected


def test_spacing_is_in_the_order_of_the_axes():
    body = turned_body()
    v = [surfometry.measure(body, SPACING), surfometry.measure(body.transpose(2, 0, 1), (0.7, 1.3, 0.9))]
    assert v[0].volume == pytest.approx(v[1].volume, rel=1e-12)
    assert v[0].surface_area == pytest.approx(v[1].surface_area, rel=2e-3)
    assert v[0].to_dict()["grid"]["spacing_mm"] == list(SPACING[::-1])
    wrong = surfometry.measure(body, SPACING[::-1])
    assert abs(wrong.surface_area / v[0].surface_area - 1) > 0.005


REFUSED = {
    "no spacing": (lambda a: a, None, surfometry.InputError, "spacing"),
    "an empty axis": (lambda a: a[:, :0], 1, surfometry.InputError, "without voxels"),
    "two axes": (lambda a: a[0], 1, surfometry.InputError, "3-D"),
    "two channels": (lambda a: np.stack([a, a]), 1, surfometry.InputError, "one at a time"),
    "masked": (lambda a: np.ma.array(a, mask=a == 0), 1, surfometry.InputError, "filled"),
    "complex": (lambda a: a.astype(complex), 1, surfometry.UnsupportedTypeError, "complex128"),
    "text": (lambda a: a.astype(str), 1, surfometry.UnsupportedTypeError, "type"),
    "an object": (lambda a: object(), 1, surfometry.UnsupportedTypeError, "no image"),
    "fractions": (lambda a: a * 0.5, 1, surfometry.InputError, "given"),
    "not a number": (lambda a: np.where(a, np.nan, 0.0), 1, surfometry.InputError, "label image|nan|NaN"),
    "nothing": (lambda a: a * 0, 1, surfometry.InputError, "no foreground"),
    "several labels": (lambda a: a + (np.arange(38) > 20) * a, 1, surfometry.InputError, "measure_labels"),
    "two spacings": (lambda a: a, (1, 2), surfometry.ParameterError, "three numbers"),
    "no length": (lambda a: a, (1, 2, 0), surfometry.ParameterError, "positive"),
    "an unknown label": (lambda a: a, 1, surfometry.InputError, "no label 9"),
}


@pytest.mark.parametrize("made, spacing, error, words", REFUSED.values(), ids=REFUSED.keys())
def test_refusals(request, made, spacing, error, words):
    label = 9 if "unknown" in request.node.callspec.id else None
    with pytest.raises(error, match=words):
        surfometry.measure(made(turned_body()), spacing, label=label)


def test_one_label_of_several():
    two = turned_body() * np.where(np.arange(38) > 20, 2, 1)
    parts = [surfometry.measure(two, SPACING, label=label).to_dict()["voxels"]["count"] for label in (1, 2, (1, 2))]
    assert parts[0] + parts[1] == parts[2] == np.count_nonzero(two)
    assert surfometry.surface(two, SPACING, label=2).measurement.label == 2


def test_large_arrays_are_not_copied():
    # 192 MiB as one byte a voxel: what is made beside the array is small against it.
    array = np.zeros((512, 640, 600), dtype=bool)
    array[100:110, 100:120, 100:130] = True
    before = peak_memory()
    surfometry.measure(array, 1)
    grown = peak_memory() - before
    assert grown < 96, f"{grown} MiB beside an array of {array.nbytes >> 20}"
    tracemalloc.start()
    surfometry.measure(array, 1)
    assert tracemalloc.get_traced_memory()[1] < 2**20
    tracemalloc.stop()


def peak_memory():
    """The most memory that the process held so far, MiB."""
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss >> 10
