"""Terminal output: progress while it works, tables of what came out."""

from __future__ import annotations

import sys
from collections.abc import Callable, Container, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from squeezefilm.core.kit.numbers import printable

if TYPE_CHECKING:
    from rich.console import Console


@contextmanager
def progress(enabled: bool) -> Iterator[Callable[[str], None]]:
    """Show on stderr what is going on: a line that vanishes at a terminal, plain lines elsewhere.

    Yields the function to tell each step to.
    """
    if not enabled:
        yield lambda _: None
        return
    if not sys.stderr.isatty():
        yield lambda text: print(f"  {printable(text)} …", file=sys.stderr, flush=True)
        return
    from rich.console import Console
    from rich.text import Text

    with Console(stderr=True).status("starting") as status:
        yield lambda text: status.update(Text(f"{printable(text)} …"))


def _console() -> Console:
    """A console on standard output, without colour where that is no terminal."""
    from rich.console import Console

    # A terminal of another encoding shows a question mark for σ; it must not end the run.
    reconfigure = getattr(sys.stdout, "reconfigure", None)
    if reconfigure is not None:
        reconfigure(errors="replace")
    return Console(highlight=False, markup=False, emoji=False)


def say(text: str, style: str = "") -> None:
    """Print a text, wrapped to the width of the terminal."""
    _console().print(text, style=style)


def table(
    head: Sequence[str],
    rows: Iterable[Sequence[str]],
    *,
    fixed: Container[int] = (),
    styles: Callable[[Sequence[str]], str] | None = None,
) -> None:
    """Print a table; the columns `fixed` are not wrapped. Cells are user's text: no markup."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, show_header=any(head))
    for number, name in enumerate(head):
        table.add_column(name, no_wrap=number in fixed, overflow="fold")
    for row in rows:
        cells = ["\n".join(_kept(line) for line in cell.split("\n")) for cell in row]
        table.add_row(*(Text(cell) for cell in cells), style=styles(row) if styles else None)
    _console().print(table)


def _kept(line: str) -> str:
    """A printable line with its indent."""
    return " " * (len(line) - len(line.lstrip(" "))) + printable(line)


def heading(text: str) -> None:
    """Print a heading, with an empty line above."""
    say(f"\n{printable(text)}", "bold")


def show_rows(
    title: str,
    rows: Iterable[Sequence[str]],
    warnings: Iterable[str] = (),
    *,
    fixed: Container[int] = (0,),
) -> None:
    """Print a heading, rows of quantity, value and remark, and warnings."""
    heading(title)
    table(("", "", ""), rows, fixed=fixed)
    for text in warnings:
        say(f"! {printable(text)}")


def bullets(items: Iterable[tuple[str, str, str]]) -> None:
    """Wrapped sentences, each behind a word that says what kind it is."""
    from rich.table import Table
    from rich.text import Text

    grid = Table.grid(padding=(0, 2))
    grid.add_column(no_wrap=True)
    grid.add_column(overflow="fold")
    for word, text, style in items:
        grid.add_row(Text(printable(word), style=style), Text(printable(text)))
    _console().print(grid)
