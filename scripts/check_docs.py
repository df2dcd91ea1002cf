#!/usr/bin/env python3
"""Checks that links between Markdown files lead somewhere and that every flag has its section in docs/flags.md."""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]


def broken_links():
    pages = [*ROOT.glob("*.md"), *ROOT.glob("docs/*.md")]
    for page in pages:
        for target in re.findall(r"\]\(([^)#]+)[^)]*\)", page.read_text(encoding="utf-8")):
            if not target.startswith(("http:", "https:")) and not (page.parent / target).exists():
                yield f"{page.relative_to(ROOT)}: {target} does not exist"


def flags_without_section():
    source = (ROOT / "crates/surfometry/src/accuracy/flags.rs").read_text(encoding="utf-8")
    variants = re.search(r"pub enum FlagCode \{(.*?)\n\}", source, re.DOTALL).group(1)
    names = re.findall(r"^    (\w+),", variants, re.MULTILINE)
    codes = {re.sub(r"(?<!^)(?=[A-Z])", "-", name).lower() for name in names}
    sections = set(re.findall(r"^## (.+)$", (ROOT / "docs/flags.md").read_text(encoding="utf-8"), re.MULTILINE))
    yield from (f"docs/flags.md: no section `{code}`" for code in sorted(codes - sections))
    yield from (f"docs/flags.md: section `{code}` is no flag" for code in sorted(sections - codes))


problems = [*broken_links(), *flags_without_section()]
print("\n".join(problems) or "docs: links and flags are in order")
sys.exit(bool(problems))
