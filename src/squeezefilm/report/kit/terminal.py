"""What the command line prints: progress while it works, tables of what came out."""

from __future__ import annotations

import sys
import tomllib
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from squeezefilm.report.kit.model_rows import MISSED_HEADING, missed_directions
from squeezefilm.report.kit.numbers import dotted, micro, printable

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

        def line(text: str) -> None:
            print(f"  {printable(text)} …", file=sys.stderr, flush=True)

        yield line
        return
    from rich.console import Console
    from rich.text import Text

    with Console(stderr=True).status("starting") as status:
        yield lambda text: status.update(Text(f"{printable(text)} …"))


def plain_console() -> Console:
    """A console on standard output, without colour where that is no terminal."""
    from rich.console import Console

    # A terminal of another encoding shows a question mark for σ; it must not end the run.
    reconfigure = getattr(sys.stdout, "reconfigure", None)
    if reconfigure is not None:
        reconfigure(errors="replace")
    return Console(highlight=False, markup=False, emoji=False)


def table(
    console: Console,
    head: Sequence[str],
    rows: Iterable[Sequence[str]],
    *,
    fixed: Iterable[int] = (),
    styles: Callable[[Sequence[str]], str] | None = None,
) -> None:
    """Print a table; the columns `fixed` are not wrapped. Cells are user's text: no markup."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, show_edge=False, show_header=any(head))
    whole = set(fixed)
    for number, name in enumerate(head):
        table.add_column(name, no_wrap=number in whole, overflow="fold")
    for row in rows:
        cells = ["\n".join(_kept(line) for line in cell.split("\n")) for cell in row]
        table.add_row(*(Text(cell) for cell in cells), style=styles(row) if styles else None)
    console.print(table)


def _kept(line: str) -> str:
    """A printable line with its indent."""
    return " " * (len(line) - len(line.lstrip(" "))) + printable(line)


def heading(console: Console, text: str) -> None:
    """Print a heading."""
    from rich.text import Text

    console.print()
    console.print(Text(printable(text), style="bold"))


def show_rows(
    title: str,
    rows: Iterable[Sequence[str]],
    warnings: Iterable[str] = (),
    *,
    fixed: Iterable[int] = (0,),
) -> Console:
    """Print a heading, rows of quantity, value and remark, and warnings; the console to go on."""
    console = plain_console()
    heading(console, title)
    table(console, ("", "", ""), rows, fixed=fixed)
    for text in warnings:
        console.print(f"! {text}")
    return console


def bullets(console: Console, items: Iterable[tuple[str, str, str]]) -> None:
    """Wrapped sentences, each behind a word that says what kind it is."""
    from rich.table import Table
    from rich.text import Text

    grid = Table.grid(padding=(0, 2))
    grid.add_column(no_wrap=True)
    grid.add_column(overflow="fold")
    for word, text, style in items:
        grid.add_row(Text(printable(word), style=style), Text(printable(text)))
    console.print(grid)


def show_missed(console: Console, model: str) -> None:
    """Print what measurements say and a friction model does not."""
    heading(console, MISSED_HEADING.format(model))
    bullets(console, [("–", text, "yellow") for text in missed_directions(model)])


def preset_list() -> list[dict[str, Any]]:
    """The displays that come with the package: name, title, kind of actuator, values assumed."""
    from squeezefilm import presets
    from squeezefilm.display import load_display

    listing = []
    for name in presets.display_names():
        display = load_display(name)
        evidence = [item.evidence for item in display.provenance.values()]
        listing.append(
            {
                "name": display.name,
                "title": display.title,
                "type": display.actuator.type,
                "values_with_source": len(evidence),
                "values_assumed": evidence.count("assumed"),
            }
        )
    return listing


def show_presets(listing: Sequence[dict[str, Any]]) -> None:
    """Print the list of presets."""
    console = plain_console()
    rows = [
        (one["name"], one["title"], f"{one['values_assumed']} of {one['values_with_source']}")
        for one in listing
    ]
    table(console, ("preset", "what it is", "assumed"), rows, fixed=(0, 2))
    console.print("squeezefilm show NAME lists the values; squeezefilm analyze NAME works them out")


def display_values(target: str) -> list[dict[str, Any]]:
    """Every value that a display's file states: path, text as written, source, evidence.

    Members of lists are counted from 1. `source` and `evidence` are None where the file gives
    none. Raises `ConfigError` for a file that is not right.
    """
    from squeezefilm import presets
    from squeezefilm.display import load_display
    from squeezefilm.hard_limits import DESCRIPTION_BYTES
    from squeezefilm.regular_file import read_regular_text

    load_display(target)  # for its messages: what is listed below can be analysed
    text = read_regular_text(presets.resolve(target), DESCRIPTION_BYTES, "a TOML file")
    # Numbers are kept as they were typed: 0.30 does not become 0.3.
    return list(_written(tomllib.loads(text, parse_float=_Typed), ()))


class _Typed(str):
    """A number of a TOML file as it was typed."""

    __slots__ = ()


def _written(node: Any, path: tuple[str | int, ...]) -> Iterator[dict[str, Any]]:
    if isinstance(node, dict) and not ("value" in node and set(node) <= _KEYS):
        for key, item in node.items():
            yield from _written(item, (*path, key))
    elif isinstance(node, list):
        for index, item in enumerate(node):
            yield from _written(item, (*path, index))
    else:
        table = node if isinstance(node, dict) else {"value": node}
        stated = "source" in table or "evidence" in table
        yield {
            "path": dotted(path),
            "text": str(table["value"]),
            "source": table.get("source"),
            # What `split_provenance` takes a source without a kind of evidence for.
            "evidence": table.get("evidence", "published") if stated else None,
        }


_KEYS = {"value", "source", "evidence"}


def show_values(values: Sequence[dict[str, Any]]) -> None:
    """Print the values of a display by table of its file, with their sources; a star marks what is
    assumed."""
    console = plain_console()
    groups: dict[str, list[tuple[str, str, str]]] = {}
    for item in values:
        group, _, key = item["path"].rpartition(".")
        star = "* " if item["evidence"] == "assumed" else "  "
        groups.setdefault(group, []).append((star + key, micro(item["text"]), _origin(item)))
    for group, rows in groups.items():
        if group:
            heading(console, group)
        table(
            console,
            ("", "", ""),
            rows,
            fixed=(0,),
            styles=lambda row: "yellow" if row[0].startswith("*") else "",
        )
    assumed = sum(item["evidence"] == "assumed" for item in values)
    console.print(f"\n* assumed: {assumed} of {len(values)} values")


def _origin(item: dict[str, Any]) -> str:
    if item["evidence"] is None:
        return ""
    return f"{item['evidence']}: {item['source']}" if item["source"] else str(item["evidence"])
