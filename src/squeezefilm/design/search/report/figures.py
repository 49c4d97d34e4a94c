"""A design search in the terminal, and the figure of its page: plates and their front."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from squeezefilm.core import presets
from squeezefilm.core import quantities as si
from squeezefilm.core.kit import style
from squeezefilm.core.kit.numbers import printable
from squeezefilm.core.kit.page_style import FigureOf
from squeezefilm.core.kit.terminal import bullets, heading, say, table
from squeezefilm.design.search.criteria import criterion_of
from squeezefilm.design.search.found import DesignSearch
from squeezefilm.design.search.limits import corner_in_words
from squeezefilm.design.search.report.words import (
    asked_sentences,
    chosen_sentences,
    chosen_words,
    counts_sentence,
    effect_table,
    empty_front_sentences,
    front_head,
    front_row,
    front_words,
    limit_sentences,
    many,
    rank_sentences,
    reference_sentences,
    row_of,
)
from squeezefilm.design.search.requirements import load_requirements
from squeezefilm.design.search.worth_solving import objectives_of
from squeezefilm.design.sweep.report.terminal import in_lines, labelled, scaled
from squeezefilm.design.sweep.swept import counted

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squeezefilm.design.search.candidate import Evaluated

MARKED = "plate-"
"""Beginning of the id of the mark of a plate of the front, which its name ends."""
ROW = "#row-"
"""Beginning of the link from that mark to the plate's row in the table."""
# More points than these are a grey area and a large file.
_MOST_POINTS = 1500
_CORNERS, _FRONT = 8, 30
_SOLVED = "three-dimensional solves of plates as drawn, quality factor assumed"
# An axis on which the largest is more than so many times the smallest is logarithmic.
_WIDE = 12.0
_BROKEN: dict[str, Any] = {"color": style.MUTED, "ls": "", "marker": "x", "ms": 4, "mew": 0.8}
_SOLVED_LOOK = style.ESTIMATE | {"ms": 5, "mec": style.BLUE, "mfc": style.PAPER}
_COMPARED = style.ESTIMATE | {"color": style.ORANGE, "marker": "s", "ms": 8}
_RING = style.ESTIMATE | {"ms": 13, "mfc": "none", "mec": style.INK, "mew": 1.5}
_CLOUD: dict[str, Any] = {"color": style.MUTED, "ls": "", "marker": ".", "ms": 5, "alpha": 0.45}


@style.drawn
def front(search: DesignSearch) -> Figure:
    """The objectives of all feasible designs against each other, pair by pair, with the front, the
    plate to build and the display to compare with."""
    names = search.requirements.objectives
    pairs = list(itertools.combinations(range(len(names)), 2))
    feasible = [candidate for candidate in search.screened if candidate.is_feasible]
    # Every so many where there are more than can be told apart.
    rows = _rows(search, feasible[:: 1 + len(feasible) // (_MOST_POINTS + 1)])
    if not rows.size and not search.front:
        return style.message_figure(
            "No design meets the requirements", "What each limit costs is told on the page."
        )
    figure = style.new_figure(_front_title(search), _SOLVED, 5.2)
    # Two objectives have room for the whole cloud, and beside it for what matters of it.
    close = [(0, 1, False), (0, 1, True)] if search.front else [(0, 1, False)]
    panels = close if len(pairs) == 1 else [(*pair, False) for pair in pairs]
    cells: list[Any] = [[f"{k}" for k in range(len(panels))], ["legend"] * len(panels)]
    *places, strip = figure.subplot_mosaic(cells, height_ratios=[1, 0.14]).values()
    for axes, (first, second, zoomed) in zip(places, panels, strict=True):
        _front_axes(axes, search, rows, first, second, zoomed=zoomed)
    style.legend_in(strip, places[0], columns=3)
    return figure


def _front_title(search: DesignSearch) -> str:
    goals = [criterion_of(name) for name in search.requirements.objectives]
    if not search.front:
        return "No solved plate keeps all limits; what is shown was screened only"
    spans = []
    for k, goal in enumerate(goals):
        low, high = (
            goal.shown(end)
            for end in (float(search.objectives[:, k].min()), float(search.objectives[:, k].max()))
        )
        spans.append(f"{goal.said} {low}" if low == high else f"{goal.said} from {low} to {high}")
    verb = "is" if search.plates_on_front == 1 else "are"
    return f"{front_words(search)} {verb} the front: {', '.join(spans)}"


def _front_axes(
    axes: Axes,
    search: DesignSearch,
    screened: si.FloatArray,
    first: int,
    second: int,
    *,
    zoomed: bool,
) -> None:
    """Two objectives against each other; `zoomed` on the front and what it is compared with."""
    names = search.requirements.objectives
    goals = [criterion_of(names[k]) for k in (first, second)]
    solved = _rows(search, [solution for solution in search.solved if solution.is_feasible])
    broken = _rows(search, [solution for solution in search.solved if solution.broken])
    reference = _rows(search, [] if search.reference is None else [search.reference])
    most = [search.objectives, reference] + ([] if zoomed else [screened, solved])
    within = np.concatenate(most)[:, [first, second]]
    scales = []
    for k, goal in enumerate(goals):
        factor, symbol = scaled(within[:, k], goal.unit)
        scales.append(factor)
        _axis(axes, "xy"[k], within[:, k] * factor, labelled(goal.said, symbol))

    def at(rows: si.FloatArray) -> tuple[si.FloatArray, si.FloatArray]:
        return rows[:, first] * scales[0], rows[:, second] * scales[1]

    axes.plot(*at(screened), **_CLOUD, label="screened, keeps all limits")
    if broken.size:
        axes.plot(*at(broken), **_BROKEN, label="solved, breaks a limit")
    if solved.size:
        axes.plot(*at(solved), **_SOLVED_LOOK, label="solved, keeps all limits")
    if search.front and len(names) == 2:
        axes.plot(*at(search.objectives), color=style.BLUE, lw=1.2, zorder=3)
    for number, (member, x, y) in enumerate(
        zip(search.front, *(values.tolist() for values in at(search.objectives)), strict=True)
    ):
        mark = axes.scatter([x], [y], s=62, color=style.BLUE, edgecolor=style.PAPER, zorder=4)
        mark.set_urls([f"{ROW}{member.name}"])
        mark.set_gid(f"{MARKED}{member.name}-{first}{second}{int(zoomed)}")
        if number == 0:
            mark.set_label("the front")
    if search.chosen is not None:
        here = search.objectives[[member is search.chosen for member in search.front]]
        axes.plot(*at(here), **_RING, zorder=5, label="the plate to build")
    if reference.size:
        name = style.plain(search.requirements.compare_with)
        axes.plot(*at(reference), **_COMPARED, zorder=5, label=f"{name}, to compare")
    if zoomed:
        axes.set_title("the front, from near")


def _axis(axes: Axes, which: str, values: si.FloatArray, label: str) -> None:
    """Name an axis and end it with room for marks around the values."""
    low, high = float(values.min()), float(values.max())
    if high > _WIDE * low > 0:
        room = (high / low) ** 0.08
        scale, ends = "log", (low / room, high * room)
    else:
        room = 0.08 * (high - low) or 0.1 * abs(high) or 1.0
        scale, ends = "linear", (low - room, high + room)
    axes.set(**{f"{which}label": label, f"{which}scale": scale, f"{which}lim": ends})


def _rows(search: DesignSearch, designs: Sequence[Evaluated]) -> si.FloatArray:
    """The finite objectives of designs (SI), shape (designs, objectives)."""
    rows = objectives_of(search.requirements, designs)
    finite: si.FloatArray = rows[np.isfinite(rows).all(axis=1)]
    return finite


FIGURES = (
    FigureOf(
        "front",
        "The front",
        front,
        "Better is to the left and below. Grey points were screened only; rings were solved in "
        "three dimensions; the blue points are beaten by no other. Point at one for its numbers, "
        "follow it to its row in the table.",
        has=lambda search: search.front or any(each.is_feasible for each in search.screened),
    ),
)


def show_design(search: DesignSearch) -> None:
    """Print a search: what was asked, the front, the plate to build, and why not others."""
    requirements = search.requirements
    _say(requirements.title, asked_sentences(requirements))
    heading("What was found")
    say(counts_sentence(search))
    if search.stopped:
        say("! The search was stopped: these are the plates found until then.")
    if search.front:
        _show_front(search)
    else:
        say(
            "No plate meets the requirements. What each limit costs is below: ease the one that "
            "most designs break, or give the shapes more room."
        )
        bullets([("–", sentence, "") for sentence in empty_front_sentences(search)])
        for reason, count in counted(o.reason for o in search.screened if o.reason)[:3]:
            say(f"! {many(count, 'design')} cannot be built: {printable(reason)}")
    if compared := reference_sentences(search):
        _say(f"Beside {requirements.compare_with}", compared)
    _say("What each limit does", limit_sentences(search))
    if search.corners:
        corners = [f"{corner_in_words(corner)}." for corner in search.corners[:_CORNERS]]
        _say("Where nothing keeps the limits", corners)
        if len(search.corners) > _CORNERS:
            say(f"{len(search.corners) - _CORNERS} more stand in the files of --out")
    _say("How good the screening was", rank_sentences(search))
    assumed = [f"{sentence[0].upper()}{sentence[1:]}." for sentence in requirements.assumed]
    _say("What all of this assumes", assumed)
    say(f"{search.computed} answers computed, {search.kept} taken from before")


def _say(title: str, sentences: list[str]) -> None:
    heading(title)
    bullets([("–", sentence, "") for sentence in sentences])


def _show_front(search: DesignSearch) -> None:
    requirements = search.requirements
    members = search.front[:_FRONT]
    if len(members) > 1:
        heading("The front: what each plate does")
        head = [in_lines(name) for name in ("name", *front_head(requirements))]
        rows = [[member.name, *front_row(requirements, member)] for member in members]
        if search.reference is not None and not search.reference.reason:
            rows.append(["to compare", *row_of(requirements, search.reference), ""])
        looks = {search.chosen_name: "bold"}
        table(head, rows, fixed=(0,), styles=lambda row: looks.get(row[0], ""))
        heading("The front: what was chosen")
        made_of = [
            [member.name, chosen_words(requirements, member.evaluated.design)] for member in members
        ]
        table(("", ""), made_of, fixed=(0,))
        if len(search.front) > len(members):
            say(f"{len(search.front) - len(members)} more rows stand in front.csv")
    _say("The plate to build", chosen_sentences(search))
    assert search.chosen is not None, "there is a front"
    head, effects = effect_table(requirements, search.chosen)
    if effects:
        heading("What one standard deviation more of each tolerance does to it")
        table(["", *map(in_lines, head)], effects)


def show_requirements() -> None:
    """Print the requirements that come with the package, and what to do with them."""
    rows = [(name, load_requirements(name).title) for name in presets.names("requirements")]
    table(("requirements", "what they are"), rows, fixed=(0,))
    say(
        "squeezefilm design NAME searches for plates that meet them. For your own, write a TOML "
        "file: docs/reference/requirements.md lists every key, and docs/how-to/design.md "
        "begins with one."
    )
