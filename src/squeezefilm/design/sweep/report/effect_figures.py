"""A sweep's main effects, shares of variance and trade-offs drawn."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.kit import style
from squeezefilm.design.sweep.answers import without_units
from squeezefilm.design.sweep.effects import Effects, Varied, varied_values
from squeezefilm.design.sweep.report.words import labelled, name_of, scaled
from squeezefilm.design.sweep.swept import Column, Sweep
from squeezefilm.design.sweep.tradeoffs import non_dominated

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_ANSWERS, MOST_VARIED, MOST_PAIRS = 4, 5, 6
_BINS = 8


def varied_name(one: Varied) -> str:
    """A varied value's name without its unit, words apart."""
    return without_units(one.name).replace("_", " ")


def drawn_columns(found: Sweep) -> list[Column]:
    """The answers that are drawn: those that vary, four at the most."""
    several = [c for c in found.columns if len(np.unique(c.values[np.isfinite(c.values)])) > 1]
    return several[:MOST_ANSWERS]


def means(one: Varied, values: si.FloatArray) -> tuple[si.FloatArray, si.FloatArray]:
    """The mean answer at each step of a varied value, or in each eighth of the points where it
    takes more than sixteen values: places and means."""
    there = np.isfinite(values)
    x, y = one.values[there], values[there]
    steps = np.unique(x)
    if len(steps) <= 2 * _BINS:
        return steps, np.array([y[x == step].mean() for step in steps])
    groups = np.array_split(np.argsort(x, kind="stable"), _BINS)
    return np.array([x[g].mean() for g in groups]), np.array([y[g].mean() for g in groups])


@style.drawn
def effects_figure(found: Sweep) -> Figure:
    """Each answer over each varied value: every point, and the mean over all others."""
    columns, varied = drawn_columns(found), varied_values(found)[:MOST_VARIED]
    if not columns or not varied:
        return style.message_figure("Main effects", "No answer varies.")
    figure = style.new_figure(
        "Main effects: what each value does, the others taken as they come",
        f"points of the sweep; lines: their mean. Display {style.plain(found.title)}",
        1.0 + 2.1 * len(columns),
    )
    grid = figure.subplots(len(columns), len(varied), squeeze=False, sharey="row", sharex="col")
    for row, column in zip(grid, columns, strict=True):
        scale, unit = scaled(column.values, column.unit)
        for axes, one in zip(row, varied, strict=True):
            _effect(axes, one, scale * column.values)
        row[0].set_ylabel(_short(labelled(name_of(column), unit)))
    for axes, one in zip(grid[-1], varied, strict=True):
        symbol = "" if one.words else scaled(one.values, one.unit)[1]
        axes.set_xlabel(_short(labelled(varied_name(one), symbol)))
        if one.words:
            axes.set_xticks(range(len(one.words)), [style.plain(w, 12) for w in one.words])
    return figure


def _effect(axes: Axes, one: Varied, values: si.FloatArray) -> None:
    factor = 1.0 if one.words else scaled(one.values, one.unit)[0]
    axes.plot(factor * one.values, values, ".", ms=3, color=style.MUTED, alpha=0.5)
    x, y = means(one, values)
    axes.plot(factor * x, y, "-o", ms=4, color=style.BLUE)
    if one.logarithmic:
        axes.set_xscale("log")
        style.plain_log(axes.xaxis)


def _short(name: str) -> str:
    """A name in lines of an axis that is narrow."""
    lines, most = [""], 18
    for word in name.replace(".", ". ").split():
        if lines[-1] and len(lines[-1]) + len(word) >= most:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return "\n".join(lines)


def shares_figure(effects: tuple[Effects, ...], varied: tuple[Varied, ...]) -> Figure:
    """Of each answer the share of its variance that each value explains: alone, and with others."""
    return _shares((effects[:MOST_ANSWERS], varied))


@style.drawn
def _shares(drawn: tuple[tuple[Effects, ...], tuple[Varied, ...]]) -> Figure:
    effects, varied = drawn
    exact = all(one.explained is None for one in effects)
    figure = style.new_figure(
        "What decides: shares of the variance over the sweep",
        "analysis of variance of the whole grid"
        if exact
        else "polynomial fit of the points; whiskers: one standard error either way",
        1.2 + 0.5 * len(varied) + 0.4,
    )
    row = figure.subplots(1, len(effects), squeeze=False, sharey=True)[0]
    places = np.arange(len(varied))
    for axes, one in zip(row, effects, strict=True):
        for offset, key, color, label in (
            (-0.18, "first", style.BLUE, "alone"),
            (0.18, "total", style.ORANGE, "with interactions"),
        ):
            axes.barh(
                places + offset,
                [getattr(share, key) for share in one.shares],
                0.34,
                xerr=[getattr(share, f"{key}_error") for share in one.shares],
                color=color,
                ecolor=style.INK,
                label=label,
            )
        axes.set_xlim(0, 1.05)
        axes.set_title(_short(name_of(one.column)), fontsize=10)
        axes.set_yticks(places, [_short(varied_name(v)) for v in varied])
        axes.set_xlabel("share")
    row[0].invert_yaxis()
    style.legend_below(row[0], columns=2, gap=0.3)
    return figure


@style.drawn
def tradeoffs_figure(drawn: tuple[Sweep, tuple[tuple[str, int], ...]]) -> Figure:
    """Each two answers against each other; of those of which less (1) or more (-1) is better, by
    name, the points that no other beats are marked."""
    found, wanted = drawn
    better = dict(wanted)
    columns = [c for c in found.columns if c.name in better] or drawn_columns(found)
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
    grid = figure.subplots(down, across, squeeze=False)
    for axes, (x, y) in zip(grid.ravel(), pairs, strict=False):
        (fx, ux), (fy, uy) = scaled(x.values, x.unit), scaled(y.values, y.unit)
        axes.plot(fx * x.values, fy * y.values, ".", color=style.MUTED, ms=5)
        if better:
            axes.plot(fx * x.values[marked], fy * y.values[marked], "o", color=style.ORANGE, ms=5)
        axes.set_xlabel(_short(labelled(_wish(x, better), ux)))
        axes.set_ylabel(_short(labelled(_wish(y, better), uy)))
    for spare in grid.ravel()[len(pairs) :]:
        spare.set_axis_off()
    return figure


def _wish(column: Column, better: dict[str, int]) -> str:
    words = {1: ", less is better", -1: ", more is better"}
    return name_of(column) + words.get(better.get(column.name, 0), "")
