"""Parts of a report, said once and shown alike as Markdown, on a page and at a terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

from squeezefilm.core.kit import page_style, terminal
from squeezefilm.core.kit.folder import markdown_table

Table = tuple[Sequence[str], Sequence[Sequence[str]]]
"""Head and rows of plain texts."""


class Part(NamedTuple):
    """A heading, sentences, and then tables; plain texts."""

    heading: str
    sentences: Sequence[str] = ()
    tables: Sequence[Table] = ()


def markdown_lines(parts: Iterable[Part]) -> list[str]:
    """The parts as lines of Markdown; a bar in a cell would end it, and is escaped."""
    lines: list[str] = []
    for part in parts:
        lines += [f"## {part.heading}", ""]
        if part.sentences:
            lines += [*(f"* {sentence}" for sentence in part.sentences), ""]
        for head, rows in part.tables:
            cells = [[cell.replace("|", "\\|") for cell in row] for row in rows]
            lines += [*markdown_table((head, cells)), ""]
    return lines


def page_section(part: Part) -> str:
    """A part as HTML: a section of a page."""
    said = page_style.bullets(part.sentences) if part.sentences else ""
    tables = (page_style.text_table(part.heading, head, rows) for head, rows in part.tables)
    return page_style.section(page_style.as_html(part.heading), said + "".join(tables))


def show_parts(parts: Iterable[Part], styles: Callable[[Sequence[str]], str] | None = None) -> None:
    """Print the parts; `styles` says how a table's row looks."""
    console = terminal.plain_console()
    for part in parts:
        terminal.heading(console, part.heading)
        terminal.bullets(console, [("", sentence, "") for sentence in part.sentences])
        for head, rows in part.tables:
            terminal.table(console, head, rows, styles=styles)
