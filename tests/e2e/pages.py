"""Pages of the documentation in parts: what one part writes and names, the next does not see."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
# Each section of a how-to is used by itself; the tasks in Python go on from one to the next.
_WHOLE = "front-door"
_SECTION = re.compile(r"^(?=## )", re.MULTILINE)


class Part(NamedTuple):
    """A page, or a section of a how-to: its name, its page, the line it begins at and its text."""

    name: str
    page: Path
    line: int
    text: str


def parts() -> list[Part]:
    """Parts of the README and of every page that is written by hand, in their order."""
    # Pages of docs/examples are made from programs by the build of the documentation.
    written = sorted(page for page in DOCS.rglob("*.md") if "examples" not in page.parts)
    return [part for page in (ROOT / "README.md", *written) for part in _parts_of(page)]


def _parts_of(page: Path) -> list[Part]:
    text = page.read_text(encoding="utf-8")
    if page.parent.name != "how-to" or page.stem == _WHOLE:
        return [Part(page.stem, page, 0, text)]
    _, *sections = _SECTION.split(text)
    begins = [text.index(section) for section in sections]
    return [
        Part(_slug(section.splitlines()[0]), page, text[:begin].count("\n"), section)
        for begin, section in zip(begins, sections, strict=True)
    ]


def _slug(heading: str) -> str:
    """Anchor of a heading, as the documentation's build makes it."""
    return "-".join(re.findall(r"[a-z0-9]+", heading.lower()))
