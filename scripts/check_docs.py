#!/usr/bin/env python3
"""Checks that links between Markdown files lead somewhere, to the section as well, that docs/SUMMARY.md lists every page of the
book once, that every flag has its section in docs/flags.md, and that every test, bench and experiment that a page names is there.

    scripts/check_docs.py --figures     # also lists the sentences with measured figures for which their section names none
"""

import functools
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]


@functools.cache
def anchors(page):
    """What the sections of a page are called in links: GitHub and mdBook make the same of these headings."""
    prose = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    found = set()
    for heading in re.findall(r"^#+ +(.+?) *$", prose, re.MULTILINE):
        name = re.sub(r"[^\w\- ]", "", re.sub(r"\]\([^)]*\)", "", heading).lower()).replace(" ", "-")
        found.add(next(n for n in (name, *(f"{name}-{again}" for again in range(1, 99))) if n not in found))
    return found


def broken_links():
    for page in [*ROOT.glob("*.md"), *ROOT.glob("docs/*.md")]:
        for target, section in re.findall(r"\]\(([^)#\s]*)#?([^)\s]*)\)", page.read_text(encoding="utf-8")):
            linked = page.parent / target if target else page
            if target.startswith(("http:", "https:")):
                continue
            if not linked.exists():
                yield f"{page.relative_to(ROOT)}: {target} does not exist"
            elif section and linked.suffix == ".md" and section not in anchors(linked):
                yield f"{page.relative_to(ROOT)}: {target}#{section}: there is no such section"


def pages_out_of_the_book():
    listed = re.findall(r"\]\(([^)]+)\)", (ROOT / "docs/SUMMARY.md").read_text(encoding="utf-8"))
    there = {page.name for page in ROOT.glob("docs/*.md")} - {"SUMMARY.md"}
    yield from (f"docs/SUMMARY.md: {name} is not listed" for name in sorted(there - set(listed)))
    yield from (f"docs/SUMMARY.md: {name} is listed twice" for name in sorted({n for n in listed if listed.count(n) > 1}))


def flags_without_section():
    source = (ROOT / "crates/surfometry/src/accuracy/flags.rs").read_text(encoding="utf-8")
    variants = re.search(r"pub enum FlagCode \{(.*?)\n\}", source, re.DOTALL).group(1)
    names = re.findall(r"^    (\w+),", variants, re.MULTILINE)
    codes = {re.sub(r"(?<!^)(?=[A-Z])", "-", name).lower() for name in names}
    sections = set(re.findall(r"^## (.+)$", (ROOT / "docs/flags.md").read_text(encoding="utf-8"), re.MULTILINE))
    yield from (f"docs/flags.md: no section `{code}`" for code in sorted(codes - sections))
    yield from (f"docs/flags.md: section `{code}` is no flag" for code in sorted(sections - codes))


# What measures a page's figures: a test, a bench, an experiment or a command of the program.
WITNESS = re.compile(
    r"--test (?P<test>\w+)|(?P<path>(?:experiments|benches|tests|crates)/[\w/.-]*\w)|surfometry validate|\$ surfometry \w+|cargo run [^\n]*surfometry-experiments|cargo bench|`(?P<module>[a-z_]+/[a-z_]+\.rs)`"
)
# A figure that was measured: of errors, times and sizes. Lengths in voxels are settings as often, so they need a verb of error.
FIGURE = re.compile(r"\d ?%|\d(?:\.\d+)? (?:s|ms|seconds|minutes|MiB|GiB)\b|(?:right|off|within|low|large|small|wrong)\b[^.]* \d[\d.]* (?:of a )?voxels?")


def sections(page):
    """Texts between headings; blocks of code belong to theirs."""
    return re.split(r"^(?=#{2,} )", page.read_text(encoding="utf-8"), flags=re.MULTILINE)


def sentences(section):
    prose = re.sub(r"^```.*?^```", "", section, flags=re.MULTILINE | re.DOTALL)
    # A table's row is a sentence.
    rows = [line for line in prose.splitlines() if line.startswith("|")]
    text = " ".join(line.strip() for line in prose.splitlines() if not line.startswith(("|", "#")))
    return [*re.split(r"(?<=[.:;]) (?=[A-Z`*-])", text), *rows]


def pages():
    # The page of the paper's results is written by its program, the changelog is history.
    return [page for page in [ROOT / "README.md", *sorted(ROOT.glob("docs/*.md"))] if page.name != "reproduction.md"]


def missing_witnesses():
    tests = {test.stem for test in ROOT.glob("crates/*/tests/*.rs")}
    for page in pages():
        for match in WITNESS.finditer(page.read_text(encoding="utf-8")):
            test, path, module = match["test"], match["path"], match["module"]
            found = (
                test in tests if test
                else any((ROOT / base / path).exists() or (ROOT / base / f"{path}.rs").exists() for base in ("", "crates/surfometry")) if path
                else any(any(ROOT.glob(f"{base}{module}")) for base in ("", "crates/*/", "crates/*/src/")) if module
                else True
            )
            if not found:
                yield f"{page.relative_to(ROOT)}: `{match[0]}` does not exist"


def unwitnessed_figures():
    for page in pages():
        # What a page's head names measures all of the page.
        head, *rest = sections(page)
        for section in () if WITNESS.search(head) else (head, *rest):
            if not WITNESS.search(section):
                heading = section.splitlines()[0].lstrip("# ") if section.strip() else ""
                yield from (f"{page.relative_to(ROOT)}, {heading}: {s.strip()}" for s in sentences(section) if FIGURE.search(s))


problems = [*broken_links(), *pages_out_of_the_book(), *flags_without_section(), *missing_witnesses()]
print("\n".join(problems) or "docs: links, flags and what measures figures are in order")
unwitnessed = list(unwitnessed_figures())
if "--figures" in sys.argv:
    print("\n".join(unwitnessed))
print(f"docs: {len(unwitnessed)} sentences with figures are on pages and in sections that name nothing that measures them (--figures lists them)")
sys.exit(bool(problems))
