"""The lines of Python that a page shows, run: of each page in a namespace of its own."""

import pathlib
import re
import sys


def blocks(page):
    """The page's blocks of Python."""
    return re.findall(r"^```python\n(.*?)^```", pathlib.Path(page).read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


def run(page):
    """Runs them in order, and returns what they have defined."""
    known = {}
    for block in blocks(page):
        exec(compile(block, str(page), "exec"), known)
    return known


if __name__ == "__main__":
    for name in sys.argv[1:]:
        assert run(name), f"{name} shows no Python"
