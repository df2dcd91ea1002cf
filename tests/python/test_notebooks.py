"""The notebooks of docs/notebooks run, and show what is kept in them."""

import nbformat
import pytest
from notebooks import FOLDER, executed, pictures, words

PAGES = sorted(FOLDER.glob("*.ipynb"))


def test_there_are_notebooks():
    assert [page.stem for page in PAGES] == ["chunks", "cohort", "curvature", "first_measurement"]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_notebook_shows_what_is_kept_in_it(page):
    kept, now = nbformat.read(page, as_version=4), executed(page)
    assert words(now) == words(kept), "run scripts/notebooks, and look at what has changed"
    assert pictures(now) == pictures(kept) >= 1
