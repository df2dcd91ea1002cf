#!/usr/bin/env python3
"""Writes docs/python_api.md of the docstrings: target/oracles/bin/python scripts/python_api.py

tests/python/test_api.py fails where the page is not that of the package, or a docstring does not say all of its parameters.
"""

import importlib
import inspect
import pathlib
import re
import textwrap

import docstring_parser

import surfometry

ROOT = pathlib.Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "python_api.md"
# What is public beside the names of the package itself.
SUBMODULES = {"surfometry.skimage": ["properties"], "surfometry.napari": ["measure_layer", "surface_over"]}
HEAD = """# Python: reference

Written by `scripts/python_api.py` of the docstrings. [From Python](python.md) says what is common to all functions: axes and
spacing, what is copied, threads, errors. Lengths are in mm. The numbers' formulas, with where they are from and where
they stop being valid, are in [quantities](quantities.md), those of classical methods in [reference methods](reference_methods.md),
columns and records in the [contract](contract.md). Names of options are the command line's.
"""


def public():
    """Functions, classes and exceptions by the names they are called by, in this order."""
    own = {name: getattr(surfometry, name) for name in surfometry.__all__ if not name.startswith("_")}
    others = {
        f"{module.removeprefix('surfometry.')}.{name}": getattr(importlib.import_module(module), name)
        for module, names in SUBMODULES.items()
        for name in names
    }
    kinds = (inspect.isfunction, lambda thing: inspect.isclass(thing) and not issubclass(thing, Warning | Exception), inspect.isclass)
    ordered = {name: thing for is_kind in kinds for name, thing in sorted(own.items()) if is_kind(thing)}
    return {**ordered, **others}


def documented(thing):
    """Names of parameters that a docstring has."""
    parsed = docstring_parser.parse(thing.__doc__, docstring_parser.Style.NUMPYDOC)
    # Names with stars are as the signature writes them.
    names = [name for entry in parsed.params if entry.args[0] == "param" for name in entry.arg_name.split(",")]
    return [name.strip().lstrip("*") for name in names]


def words(text):
    """Prose as Markdown: code in single backticks, names of the reference as links, a paragraph a line."""
    text = re.sub(r"\s*\n\s*", " ", (text or "").strip())
    text = re.sub(r"``([^`]+)``", r"§\1§", text)
    text = re.sub(r"(?<!\[)`([^`]+)`", lambda name: link(name[1]), text)
    text = re.sub(r"\bdocs/(\w+)\.md", r"[\1](\1.md)", text)
    return text.replace("§", "`")


def link(name):
    known = name.removeprefix("surfometry.")
    return f"[`{name}`](#{known.replace('.', '').lower()})" if known in NAMES else f"`{name}`"


def cell(text):
    return words(text).replace("|", "\\|")


def table(heading, rows):
    """A table of names, types and what they are."""
    lines = [f"| {heading} | type | |", "|---|---|---|"]
    return "\n".join([*lines, *(f"| {name} | {kind} | {what} |" for name, kind, what in rows)]) if rows else ""


def entries(parsed, kind):
    return [
        (", ".join(f"`{name.strip()}`" for name in entry.arg_name.split(",")), cell(entry.type_name), cell(entry.description))
        for entry in parsed.params
        if entry.args[0] == kind
    ]


def section(parsed, key, heading):
    """What a docstring says under one of its headings."""
    said = [entry for entry in parsed.meta if entry.args[0] == key]
    lines = []
    for entry in said:
        name = getattr(entry, "type_name", None)
        lines.append(f"{link(name) + ': ' if name else ''}{words(entry.description)}")
    return f"**{heading}** " + "; ".join(lines) if said else ""


def signature(name, thing):
    """How it is called, without the types, which the table has."""
    if not inspect.isfunction(thing):
        return ""
    bare = [parameter.replace(annotation=inspect.Parameter.empty) for parameter in inspect.signature(thing).parameters.values()]
    called = f"surfometry.{name}{inspect.Signature(bare)}"
    return "```text\n" + textwrap.fill(called, 110, subsequent_indent="    ", break_on_hyphens=False) + "\n```"


def examples(parsed):
    # What a line shows stands below it, and is the description of the parser's.
    lines = [part for entry in parsed.examples for part in (entry.snippet, entry.description) if part]
    return "```pycon\n" + "\n".join(lines) + "\n```" if lines else ""


def members(thing):
    """Properties and methods of a class."""
    if not inspect.isclass(thing):
        return ""
    rows = []
    for name, member in vars(thing).items():
        function = member.fget if isinstance(member, property) else member
        if name.startswith("_") or not (inspect.isfunction(function) and function.__doc__):
            continue
        kind = str(inspect.signature(function).return_annotation)
        shown = f"`{name}`" if isinstance(member, property) else f"`{name}{bare_arguments(function)}`"
        rows.append((shown, cell(kind), cell(docstring_parser.parse(function.__doc__).short_description)))
    return table("property or method", rows)


def bare_arguments(function):
    parameters = list(inspect.signature(function).parameters.values())[1:]
    return str(inspect.Signature([parameter.replace(annotation=inspect.Parameter.empty) for parameter in parameters]))


def bases(thing):
    """The exceptions of Python's own that one of ours is as well."""
    if not (inspect.isclass(thing) and issubclass(thing, BaseException)):
        return ""
    return "Also " + ", ".join(link(base.__name__) for base in thing.__bases__) + "."


def entry(name, thing):
    """All that is said of one name."""
    parsed = docstring_parser.parse(thing.__doc__, docstring_parser.Style.NUMPYDOC)
    source = pathlib.Path(inspect.getsourcefile(thing)).name
    parts = [
        f"## {name}",
        signature(name, thing),
        words(parsed.short_description),
        *(words(paragraph) for paragraph in (parsed.long_description or "").split("\n\n")),
        bases(thing),
        table("parameter", entries(parsed, "param")),
        table("attribute", entries(parsed, "attribute")),
        members(thing),
        section(parsed, "returns", "Returns"),
        section(parsed, "raises", "Raises"),
        section(parsed, "warns", "Warns"),
        section(parsed, "notes", "Notes"),
        examples(parsed),
        f"Source: [{source}](../python/surfometry/{source})",
    ]
    return "\n\n".join(part for part in parts if part)


NAMES = public()


def page():
    """The whole page."""
    contents = ", ".join(link(name) for name in NAMES)
    return "\n\n".join([HEAD.strip(), contents, *(entry(name, thing) for name, thing in NAMES.items())]) + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    print(PAGE.relative_to(ROOT))
