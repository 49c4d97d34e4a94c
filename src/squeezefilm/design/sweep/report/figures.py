"""A sweep drawn: lines over one axis, maps over two, main effects, trade-offs."""

from __future__ import annotations

import itertools
import textwrap
from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.kit import style
from squeezefilm.design.sweep.report.terminal import (
    labelled,
    mode_of,
    name_of,
    quantity_of,
    read_easily,
    scaled,
    step_words,
)
from squeezefilm.design.sweep.swept import Sweep, SweptColumn, varied_values
from squeezefilm.design.sweep.tradeoffs import non_dominated

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squeezefilm.design.sweep.axes import Axis

MOST_PANELS = 6
_SAID = {"followed": "the solved plate, modes followed by their shapes"}
MOST_LINES = 8
"""Largest number of steps on the second axis that are not drawn as a map."""


@style.drawn
def sweep_figure(sweep: Sweep) -> Figure:
    """A panel for each number that was asked for, six at the most: lines over the first axis that
    has several steps, or, where a second has more than eight, a map of the two."""
    axes = [axis for axis in sweep.axes if len(axis) > 1]
    drawn = [c for c in sweep.columns if np.isfinite(c.values).any()]
    if not axes or not drawn or len(axes) > 2:
        return style.message_figure(
            f"Sweep of {style.plain(sweep.title)}", _nothing_to_draw(sweep, len(axes), len(drawn))
        )
    along, beside = _order(axes)
    panels = _panels(drawn) if beside is None else [[column] for column in drawn]
    panels = panels[:MOST_PANELS]
    over = " and ".join(name_of(axis) for axis in axes)
    lost = len(sweep.reasons) - sweep.answered
    crosses = f"; crosses: {lost} of {len(sweep.reasons)} points without an answer" if lost else ""
    figure = style.new_figure(
        f"{', '.join(map(_panel_name, panels))} over {over}",
        f"that of {' and '.join(_SAID.get(verb, verb) for verb in sweep.verbs)}; display "
        f"{style.plain(sweep.title)}{crosses}",
        1.2 + 3.2 * -(-len(panels) // 2) if len(panels) > 1 else 4.6,
    )
    places = style.panels(figure, len(panels), min(len(panels), 2))
    for place, panel in zip(places, panels, strict=True):
        if beside is not None and len(beside) > MOST_LINES and beside.numbers is not None:
            _map(figure, place, sweep, along, beside, panel[0])
        else:
            _lines(place, sweep, along, beside, panel)
    return figure


def _nothing_to_draw(sweep: Sweep, axes: int, drawn: int) -> str:
    if not drawn:
        return "No point has an answer; the table says why."
    if not axes:
        return "There is one point alone; the table has its numbers."
    names = ", ".join(name_of(axis) for axis in sweep.axes)
    return f"{axes} axes ({names}) are too many for one picture; the table has all numbers."


def _order(axes: list[Axis]) -> tuple[Axis, Axis | None]:
    """The axis to draw along, one of numbers if there is one, and the other."""
    if len(axes) == 1:
        return axes[0], None
    first, second = axes
    swap = first.numbers is None and second.numbers is not None
    return (second, first) if swap else (first, second)


def _panels(drawn: list[SweptColumn]) -> list[list[SweptColumn]]:
    """Columns by what they are of: modes that were followed share a panel."""
    panels: dict[str, list[SweptColumn]] = {}
    for column in drawn:
        own = column.name if mode_of(column) is None else quantity_of(column)
        panels.setdefault(own, []).append(column)
    return list(panels.values())


def _values(sweep: Sweep, along: Axis, beside: Axis | None, column: SweptColumn) -> si.FloatArray:
    """A column over the two axes, shape (along, beside)."""
    grid = column.values.reshape([len(axis) for axis in sweep.axes if len(axis) > 1])
    order = [axis for axis in sweep.axes if len(axis) > 1]
    if beside is None:
        return grid[:, None]
    return grid if order.index(along) == 0 else grid.T


def _lines(
    axes: Axes, sweep: Sweep, along: Axis, beside: Axis | None, panel: list[SweptColumn]
) -> None:
    x = _along(axes, along)
    scale, unit = scaled(np.concatenate([c.values for c in panel]), panel[0].unit)
    # Modes that nothing drives are there, and do not matter.
    quiet = {follow.label for follow in sweep.follows if not follow.driven}
    told, named = 0, False
    for column in panel:
        values = scale * _values(sweep, along, beside, column)
        for number, line in enumerate(values.T):
            color, dashes = style.LINES[told % len(style.LINES)]
            label = mode_of(column)
            if beside is not None:
                label = step_words(beside, number)
            if mode_of(column) in quiet:
                color, dashes = style.MUTED, (0, (1.4, 1.2))
                label = None if named else "not driven"
                named = True
            axes.plot(x, line, color=color, ls=dashes, marker="o", ms=3, label=label)
            told += 1
            lost = np.isnan(line)
            if lost.any() and not lost.all() and len(panel) == 1:
                low = float(np.nanmin(values))
                axes.plot(x[lost], np.full(lost.sum(), low), "x", color=style.MUTED)
    axes.set_ylabel(labelled(_panel_name(panel), unit))
    if told > 1:
        style.legend_below(axes, columns=4, gap=0.22)


def _panel_name(panel: list[SweptColumn]) -> str:
    return f"{quantity_of(panel[0])} of {len(panel)} modes" if len(panel) > 1 else name_of(panel[0])


def _along(axes: Axes, along: Axis) -> si.FloatArray:
    """Label the abscissa; the places of the axis's steps on it."""
    x, symbol = np.arange(len(along), dtype=float), ""
    if along.numbers is not None:
        factor, symbol = scaled(along.numbers, along.units[0])
        x = factor * along.numbers
    else:
        axes.set_xticks(
            range(len(along)),
            [style.plain(step_words(along, k), 18) for k in range(len(along))],
            rotation=30 if len(along) > 3 else 0,
            ha="right" if len(along) > 3 else "center",
        )
    if along.logarithmic:
        axes.set_xscale("log")
    axes.set_xlabel(labelled(name_of(along), symbol))
    return x


def _map(
    figure: Figure, axes: Axes, sweep: Sweep, along: Axis, beside: Axis, column: SweptColumn
) -> None:
    assert beside.numbers is not None
    x = _along(axes, along)
    up, ys = scaled(beside.numbers, beside.units[0])
    y = up * beside.numbers
    scale, unit = scaled(column.values, column.unit)
    values = np.ma.masked_invalid(scale * _values(sweep, along, beside, column).T)
    image = axes.pcolormesh(x, y, values, shading="nearest", cmap="cividis")
    if min(values.shape) > 1 and values.count() > 3 and np.ptp(values.compressed()) > 0:
        lines = axes.contour(x, y, values, 5, colors=style.PAPER, linewidths=0.9)
        axes.clabel(lines, fontsize=8.5, fmt=lambda v: f"{v:.3g}")
    rows, columns = np.nonzero(np.ma.getmaskarray(values))
    axes.plot(x[columns], y[rows], "x", color=style.MUTED)
    figure.colorbar(image, ax=axes, label=labelled(name_of(column), unit))
    if beside.logarithmic:
        axes.set_yscale("log")
    axes.set_ylabel(labelled(name_of(beside), ys))
    axes.grid(visible=False)


_WISHES = {1: ", less is better", -1: ", more is better", 0: ""}
MOST_ANSWERS, MOST_VARIED, MOST_PAIRS = 4, 5, 6
_BINS = 8


def drawn_columns(sweep: Sweep) -> list[SweptColumn]:
    """The answers that are drawn: those that vary, four at the most."""
    several = [c for c in sweep.columns if len(np.unique(c.values[np.isfinite(c.values)])) > 1]
    return several[:MOST_ANSWERS]


def means(value: SweptColumn, values: si.FloatArray) -> tuple[si.FloatArray, si.FloatArray]:
    """The mean answer at each step of a varied value, or in each eighth of the points where it
    takes more than sixteen values: places and means."""
    there = np.isfinite(values)
    x, y = value.values[there], values[there]
    steps = np.unique(x)
    if len(steps) <= 2 * _BINS:
        return steps, np.array([y[x == step].mean() for step in steps])
    groups = np.array_split(np.argsort(x, kind="stable"), _BINS)
    return np.array([x[g].mean() for g in groups]), np.array([y[g].mean() for g in groups])


@style.drawn
def effects_figure(sweep: Sweep) -> Figure:
    """Each answer over each varied value: every point, and the mean over all others."""
    columns, varied = drawn_columns(sweep), varied_values(sweep)[:MOST_VARIED]
    if not columns or not varied:
        return style.message_figure("Main effects", "No answer varies.")
    figure = style.new_figure(
        "Main effects: what each value does, the others taken as they come",
        f"points of the sweep; lines: their mean. Display {style.plain(sweep.title)}",
        1.0 + 2.1 * len(columns),
    )
    grid = figure.subplots(len(columns), len(varied), squeeze=False, sharey="row", sharex="col")
    for row, column in zip(grid, columns, strict=True):
        values, label = read_easily(column)
        for axes, value in zip(row, varied, strict=True):
            _effect(axes, value, values)
        row[0].set_ylabel(_short(label))
    for axes, value in zip(grid[-1], varied, strict=True):
        axes.set_xlabel(_short(read_easily(value)[1]))
        if value.words:
            axes.set_xticks(range(len(value.words)), [style.plain(w, 12) for w in value.words])
    return figure


def _effect(axes: Axes, value: SweptColumn, values: si.FloatArray) -> None:
    factor = scaled(value.values, value.unit)[0]
    axes.plot(factor * value.values, values, ".", ms=3, color=style.MUTED, alpha=0.5)
    x, y = means(value, values)
    axes.plot(factor * x, y, "-o", ms=4, color=style.BLUE)
    if value.logarithmic:
        axes.set_xscale("log")


def _short(name: str) -> str:
    """A name in lines of an axis that is narrow."""
    words = " ".join(name.replace(".", ". ").split())
    return textwrap.fill(words, 18, break_long_words=False, break_on_hyphens=False)


@style.drawn
def tradeoffs_figure(sweep: Sweep, wanted: tuple[tuple[str, int], ...]) -> Figure:
    """Each two answers against each other; of those of which less (1) or more (-1) is better, by
    name, the points that no other beats are marked."""
    better = dict(wanted)
    columns = [c for c in sweep.columns if c.name in better] or drawn_columns(sweep)
    pairs = list(itertools.combinations(columns, 2))[:MOST_PAIRS]
    if not pairs:
        return style.message_figure("Trade-offs", "There are no two answers that vary.")
    # Without wishes nothing is marked.
    signs = [better.get(c.name, 0) for c in columns]
    marked = non_dominated(
        np.column_stack([s * c.values for s, c in zip(signs, columns, strict=True)])
    )
    across = min(len(pairs), 3)
    down = -(-len(pairs) // across)
    figure = style.new_figure(
        "Trade-offs between answers",
        "each point of the sweep"
        + ("; marked: those that no other beats in all that is wanted" if better else ""),
        1.0 + 2.9 * down,
    )
    for axes, (x, y) in zip(style.panels(figure, len(pairs), across), pairs, strict=True):
        across_values, across_label = read_easily(x, _WISHES[better.get(x.name, 0)])
        values, label = read_easily(y, _WISHES[better.get(y.name, 0)])
        axes.plot(across_values, values, ".", color=style.MUTED, ms=5)
        if better:
            axes.plot(across_values[marked], values[marked], "o", color=style.ORANGE, ms=5)
        axes.set_xlabel(_short(across_label))
        axes.set_ylabel(_short(label))
    return figure
