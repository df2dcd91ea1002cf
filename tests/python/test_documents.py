"""The lines of Python that README.md, the pages and the docstrings show."""

import doctest
import importlib
import pathlib

import numpy as np
import pytest
from pages import blocks, run

import surfometry

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", ROOT / "docs" / "python.md"]
MODULES = [surfometry, importlib.import_module("surfometry.skimage"), importlib.import_module("surfometry._reading")]


def test_pages_show_python():
    """All of them: the lines of clusters.md are run by test_cohorts.py, those of differentiable.md below."""
    showing = {page.name for page in [ROOT / "README.md", *(ROOT / "docs").glob("*.md")] if blocks(page)}
    assert showing == {"README.md", "python.md", "clusters.md", "differentiable.md"}


def test_derivatives_as_the_page_shows_them():
    known = {}
    exec(blocks(ROOT / "docs" / "differentiable.md")[0], known)
    # A ball of 15 mm at a blur of 3.5 mm, the page's 1.75 slices, has lost sigma^2 / R.
    blurred = 4 * np.pi * (15 - 3.5**2 / 15) ** 2
    assert abs(known["found"].surface_area / blurred - 1) < 0.01
    assert known["gradient"].shape == known["p"].shape


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_lines_of_a_page_run(page, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    known = run(page)
    assert known["surface"].measurement.euler_characteristic == 2
    assert len(capsys.readouterr().out.split()) == 3


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.__name__)
def test_docstrings(module):
    found = doctest.testmod(module)
    assert found.attempted > 0 and found.failed == 0


def test_every_public_name_is_documented():
    pages = (ROOT / "docs" / "python.md").read_text()
    for name in surfometry.__all__:
        thing = getattr(surfometry, name)
        assert name == "__version__" or thing.__doc__, name
        assert not callable(thing) or isinstance(thing, type) or f"`{name}`" in pages, name
