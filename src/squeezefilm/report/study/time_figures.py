"""Figures of a study beside its confusions: response times, exploration, power."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.report.kit import style
from squeezefilm.report.study.figures import data_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squeezefilm.study.identification.analysis import IdentificationAnalysis
    from squeezefilm.study.identification.exploration import ConditionMean
    from squeezefilm.study.identification.power import PowerCurve


@style.drawn
def response_times(analysis: IdentificationAnalysis) -> Figure:
    """Response times by stimulus, and the ex-Gaussian of all."""
    found = analysis.response_times
    if not found:
        return style.message_figure("No response times", "No response time was given.")
    slow = max(found, key=lambda item: item.geometric_mean)
    quick = min(found, key=lambda item: item.geometric_mean)
    figure = style.new_figure(
        f"{style.plain(slow.name, 16)} takes longest, {slow.geometric_mean:.2g} s; "
        f"{style.plain(quick.name, 16)} shortest, {quick.geometric_mean:.2g} s",
        f"{data_of(analysis)}; geometric means over people with {100 * slow.level:g} % t intervals",
        4.0,
    )
    left, right = figure.subplots(1, 2, width_ratios=[1.5, 1])
    for x, item in enumerate(found):
        left.plot([x, x], [item.low, item.high], color=style.MUTED, lw=1.4)
        left.plot([x], [item.geometric_mean], "o", color=style.BLUE, ms=7, mec=style.PAPER)
    left.set_xticks(range(len(found)), [style.plain(item.name, 14) for item in found])
    left.set(ylabel="response time (s)", xlabel="stimulus")
    left.set_ylim(0, None)
    left.set_title("each stimulus")
    fit = analysis.ex_gaussian
    if fit is None:
        right.set_axis_off()
        right.text(0, 0.5, "no ex-Gaussian: too few times", transform=right.transAxes)
        return figure
    from squeezefilm.study.identification.response_times import ex_gaussian_density

    end = fit.mean + 3 * fit.spread + 5 * fit.tail
    t = np.linspace(0, end, 400)
    right.plot(t, ex_gaussian_density(t, fit), color=style.BLUE)
    right.fill_between(t, 0, ex_gaussian_density(t, fit), color=style.BAND)
    right.axvline(fit.mean + fit.tail, color=style.ORANGE, lw=1.2, ls=(0, (4, 2)))
    right.set(xlabel="response time (s)", ylabel="density (1/s)", xlim=(0, end), ylim=(0, None))
    right.set_title(f"all: μ {fit.mean:.2g} s, σ {fit.spread:.2g} s, τ {fit.tail:.2g} s")
    return figure


@style.drawn
def exploration(analysis: IdentificationAnalysis) -> Figure:
    """Each quantity of exploration by stimulus, means over people with intervals."""
    found = {key: rows for key, rows in analysis.exploration.items() if rows}
    if not found:
        return style.message_figure("No exploration", "No trace of a finger was given.")
    level = next(iter(found.values()))[0].level
    figure = style.new_figure(
        "How people explored, by stimulus",
        f"{data_of(analysis)}; means over people with {100 * level:g} % t intervals",
        3.9,
    )
    panels = np.atleast_1d(figure.subplots(1, len(found)))
    for axes, (key, rows) in zip(panels, found.items(), strict=True):
        _draw_means(axes, key, rows)
    return figure


def _draw_means(axes: Axes, key: str, rows: tuple[ConditionMean, ...]) -> None:
    for x, item in enumerate(rows):
        axes.plot([x, x], [item.low, item.high], color=style.MUTED, lw=1.4)
        axes.plot([x], [item.mean], "o", color=style.BLUE, ms=7, mec=style.PAPER)
    axes.set_xticks(range(len(rows)), [style.plain(item.name, 8) for item in rows], rotation=30)
    axes.set_ylim(0, None)
    axes.set_title(key_words(key))


def key_words(key: str) -> str:
    """A key with its unit as a person reads it: mean_speed_m_per_s → mean speed (m/s)."""
    for suffix, unit in (
        ("_m_per_s", "m/s"),
        ("_mm_per_s", "mm/s"),
        ("_m", "m"),
        ("_mm", "mm"),
        ("_N", "N"),
        ("_s", "s"),
    ):
        if key.endswith(suffix):
            return f"{style.plain(key[: -len(suffix)].replace('_', ' '), 28)} ({unit})"
    return style.plain(key.replace("_", " "), 28)


@style.drawn
def power(curve: PowerCurve) -> Figure:
    """Power against the number of people, with the error of the simulation."""
    needed, surely = curve.needed, curve.needed_surely
    said = (
        f"{int(curve.participants[-1])} people do not reach {100 * curve.target:g} % power"
        if needed is None
        else f"{needed} people reach {100 * curve.target:g} % power"
        + (
            ""
            if surely is None or surely == needed
            else f"; {surely} do beyond the simulation's error"
        )
    )
    figure = style.new_figure(
        said,
        f"simulated studies, {curve.studies} per size; one-sided test at α = {curve.alpha:g}; bars "
        "are 95 % Clopper–Pearson bounds of the simulation",
        4.0,
    )
    axes = figure.subplots()
    axes.plot(curve.participants, 100 * curve.power, color=style.BLUE, lw=1.3)
    for n, low, high in zip(curve.participants, curve.low, curve.high, strict=True):
        axes.plot([n, n], [100 * low, 100 * high], color=style.MUTED, lw=1.4)
    axes.plot(curve.participants, 100 * curve.power, "o", color=style.BLUE, ms=6, mec=style.PAPER)
    axes.axhline(100 * curve.target, color=style.ORANGE, lw=1.1, ls=(0, (4, 2)))
    if needed is not None:
        axes.axvline(needed, color=style.ORANGE, lw=1.1, ls=(0, (1.4, 1.2)))
    axes.set(
        xlabel="participants", ylabel="studies that find it (%)", ylim=(0, 103), xlim=(0, None)
    )
    return figure
