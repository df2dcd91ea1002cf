#!/usr/bin/env python3
"""Checks a built book: every link leads to a file of its own and to a place in it, every picture is there, and no page loads
anything from a network. Links that a reader follows to the outside are not tried.

    scripts/check_book.py target/book
"""

import html.parser
import pathlib
import sys
import urllib.parse

LOADED = {"img": "src", "script": "src", "link": "href", "iframe": "src"}


class Page(html.parser.HTMLParser):
    """Names of places in a page, and where it leads."""

    def __init__(self, path):
        super().__init__()
        self.places, self.links = set(), []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        self.places.update(found[key] for key in ("id", "name") if found.get(key))
        if tag == "a" and found.get("href"):
            self.links.append((found["href"], False))
        elif found.get(LOADED.get(tag)):
            self.links.append((found[LOADED[tag]], True))


def problems(book):
    pages = {path: Page(path) for path in sorted(book.rglob("*.html"))}
    for path, page in pages.items():
        for link, is_loaded in page.links:
            url = urllib.parse.urlsplit(link)
            if url.scheme == "data":
                continue
            if url.scheme or url.netloc:
                if is_loaded:
                    yield f"{path.relative_to(book)}: loads {link}"
                continue
            target = (path.parent / urllib.parse.unquote(url.path)).resolve() if url.path else path.resolve()
            # What a server shows of a folder.
            target = target / "index.html" if target.is_dir() else target
            if not target.is_file() or not target.is_relative_to(book):
                yield f"{path.relative_to(book)}: {link} is not in the book"
            elif url.fragment and target in pages and urllib.parse.unquote(url.fragment) not in pages[target].places:
                yield f"{path.relative_to(book)}: {link}: there is no such place"


book = pathlib.Path(sys.argv[1]).resolve()
found = list(problems(book))
print("\n".join(found) or f"book: links and pictures of {len(list(book.rglob('*.html')))} pages are there")
sys.exit(bool(found))
