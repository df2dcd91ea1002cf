"""The page of the Python reference is that of the docstrings, and these say all that is public."""

import importlib.util
import inspect

import docstring_parser
import pytest
from conftest import ROOT

spec = importlib.util.spec_from_file_location("python_api", ROOT / "scripts" / "python_api.py")
python_api = importlib.util.module_from_spec(spec)
spec.loader.exec_module(python_api)
FUNCTIONS = {name: thing for name, thing in python_api.NAMES.items() if inspect.isfunction(thing)}


def test_the_page_is_that_of_the_docstrings():
    assert python_api.PAGE.read_text(encoding="utf-8") == python_api.page(), "run scripts/python_api.py"


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_docstring_says_all_parameters_in_any_order(name):
    function = FUNCTIONS[name]
    assert sorted(python_api.documented(function)) == sorted(inspect.signature(function).parameters)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_docstring_says_what_comes_back_and_what_is_raised(name):
    function = FUNCTIONS[name]
    sections = {entry.args[0] for entry in docstring_parser.parse(function.__doc__, docstring_parser.Style.NUMPYDOC).meta}
    assert inspect.signature(function).return_annotation in (None, "None") or "returns" in sections
    assert "raises" in sections or name.startswith(("napari.", "skimage."))
