"""Terminal output of a design search, and of the requirements that there are."""

from __future__ import annotations

from rich.console import Console

from squeezefilm.core import presets
from squeezefilm.core.kit.numbers import printable
from squeezefilm.core.kit.terminal import bullets, heading, plain_console, table
from squeezefilm.design.search.found import DesignSearch
from squeezefilm.design.search.reasons import corner_in_words
from squeezefilm.design.search.report.words import (
    asked_sentences,
    chosen_sentences,
    chosen_words,
    counts_sentence,
    effect_head,
    effect_rows,
    empty_front_sentences,
    front_head,
    front_row,
    limit_sentences,
    many,
    rank_sentences,
    reference_sentences,
    row_of,
)
from squeezefilm.design.search.requirements import load_requirements
from squeezefilm.design.sweep.report.terminal import in_lines
from squeezefilm.design.sweep.swept import counted

_CORNERS, _FRONT = 8, 30


def show_design(search: DesignSearch) -> None:
    """Print a search: what was asked, the front, the plate to build, and why not others."""
    console = plain_console()
    requirements = search.requirements
    heading(console, requirements.title)
    _say(console, asked_sentences(requirements))
    heading(console, "What was found")
    console.print(counts_sentence(search))
    if search.stopped:
        console.print("! The search was stopped: these are the plates found until then.")
    if search.front:
        _show_front(console, search)
    else:
        console.print(
            "No plate meets the requirements. What each limit costs is below: ease the one that "
            "most designs break, or give the shapes more room."
        )
        _say(console, empty_front_sentences(search))
        for reason, count in counted(o.reason for o in search.screened if o.reason)[:3]:
            console.print(f"! {many(count, 'design')} cannot be built: {printable(reason)}")
    if compared := reference_sentences(search):
        heading(console, f"Beside {requirements.compare_with}")
        _say(console, compared)
    heading(console, "What each limit does")
    _say(console, limit_sentences(search))
    if search.corners:
        heading(console, "Where nothing keeps the limits")
        _say(
            console,
            [f"{corner_in_words(corner)}." for corner in search.corners[:_CORNERS]],
        )
        if len(search.corners) > _CORNERS:
            console.print(f"{len(search.corners) - _CORNERS} more stand in the files of --out")
    heading(console, "How good the screening was")
    _say(console, rank_sentences(search))
    heading(console, "What all of this assumes")
    _say(console, [f"{sentence[0].upper()}{sentence[1:]}." for sentence in requirements.assumed])
    console.print(f"{search.computed} answers computed, {search.kept} taken from before")


def _say(console: Console, sentences: list[str]) -> None:
    bullets(console, [("–", sentence, "") for sentence in sentences])


def _show_front(console: Console, search: DesignSearch) -> None:
    requirements = search.requirements
    members = search.front[:_FRONT]
    if len(members) > 1:
        heading(console, "The front: what each plate does")
        head = [in_lines(name) for name in ("name", *front_head(requirements))]
        rows = [[member.name, *front_row(requirements, member)] for member in members]
        if search.reference is not None and not search.reference.reason:
            rows.append(["to compare", *row_of(requirements, search.reference), ""])
        looks = {search.chosen_name: "bold"}
        table(console, head, rows, fixed=(0,), styles=lambda row: looks.get(row[0], ""))
        heading(console, "The front: what was chosen")
        made_of = [
            [member.name, chosen_words(requirements, member.evaluated.design)] for member in members
        ]
        table(console, ("", ""), made_of, fixed=(0,))
        if len(search.front) > len(members):
            console.print(f"{len(search.front) - len(members)} more rows stand in front.csv")
    heading(console, "The plate to build")
    _say(console, chosen_sentences(search))
    assert search.chosen is not None, "there is a front"
    if effects := effect_rows(requirements, search.chosen):
        heading(console, "What one standard deviation more of each tolerance does to it")
        head = [in_lines(name) for name in ("", *effect_head(requirements))]
        table(console, head, effects)


def show_requirements() -> None:
    """Print the requirements that come with the package, and what to do with them."""
    console = plain_console()
    rows = [(name, load_requirements(name).title) for name in presets.names("requirements")]
    table(console, ("requirements", "what they are"), rows, fixed=(0,))
    console.print(
        "squeezefilm design NAME searches for plates that meet them. For your own, write a TOML "
        "file: docs/reference/requirements.md lists every key, and docs/how-to/design.md "
        "begins with one."
    )
