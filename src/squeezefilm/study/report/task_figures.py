"""Figures of two-interval, same-different and magnitude studies."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from squeezefilm.core.kit import style
from squeezefilm.study.design.tasks.every_task import TASKS
from squeezefilm.study.report.figures import data_of, named_ticks
from squeezefilm.study.report.words import estimate_words
from squeezefilm.study.tasks.two_interval import QUARTILE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squeezefilm.core.quantities import FloatArray
    from squeezefilm.study.tasks.findings import PersonFunction, TaskAnalysis

_SCALE = {
    "spatial_period": (1e3, "spatial period (mm)"),
    "friction_depth": (1e2, "friction change (%)"),
}
_FAINT: dict[str, Any] = {"color": style.METAL, "lw": 0.8, "alpha": 0.7}
_MOST_LINES = 60


def _scale(analysis: TaskAnalysis) -> tuple[float, str]:
    return _SCALE.get(analysis.judged, (1.0, analysis.judged.replace("_", " ")))


@style.drawn
def answers(analysis: TaskAnalysis) -> Figure:
    """Answers against the stimulus: psychometric functions, or the scale of numbers."""
    figure = style.new_figure(_said(analysis), data_of(analysis), 4.4)
    axes = figure.subplots()
    if analysis.measure == "exponent":
        _magnitudes(axes, analysis)
    elif TASKS[analysis.task].model is not None:
        _differences(axes, analysis)
    elif analysis.is_adaptive:
        _adaptive(axes, analysis)
    else:
        _functions(axes, analysis)
    return figure


def _said(analysis: TaskAnalysis) -> str:
    if analysis.pooled is None:
        return f"No {analysis.measure} could be computed"
    percent = analysis.measure == "Weber fraction"
    words = estimate_words(analysis.pooled, *((100, " %") if percent else ()))
    return f"The {analysis.measure} is {words}"


def _functions(axes: Axes, analysis: TaskAnalysis) -> None:
    scale, label = _scale(analysis)
    values = [condition.value for condition in analysis.conditions]
    x = np.geomspace(min([*values, analysis.standard]), max([*values, analysis.standard]), 161)
    for function in list(analysis.functions.values())[:_MOST_LINES]:
        more = _share(function, np.log(x / analysis.standard))
        axes.plot(scale * x, 100 * more, **_FAINT)
    _shares(axes, analysis, scale)
    axes.axvline(scale * analysis.standard, **style.GUIDE)
    axes.axhline(50, **style.GUIDE)
    axes.set(xlabel=label, ylabel="the comparison has more (%)", ylim=(-2, 103))
    axes.set_title("thin: each person's function; dots: all trials; dotted: the reference")


def _shares(axes: Axes, analysis: TaskAnalysis, scale: float) -> None:
    for condition in analysis.conditions:
        if condition.share is not None:
            x = scale * condition.value
            axes.plot(
                [x, x], [100 * condition.share.low, 100 * condition.share.high], **style.INTERVAL
            )
            axes.plot([x], [100 * condition.share.value], **style.ESTIMATE)


def _differences(axes: Axes, analysis: TaskAnalysis) -> None:
    scale, label = _scale(analysis)
    if math.isnan(analysis.conditions[0].value):
        _unlike(axes, analysis)
        return
    _shares(axes, analysis, scale)
    axes.set(xlabel=f"{label} of the other", ylabel=_counted(analysis), ylim=(-2, 103))
    axes.axvline(scale * analysis.standard, **style.GUIDE)
    axes.set_title("dotted: the reference")


def _counted(analysis: TaskAnalysis) -> str:
    """Label of an axis of answers."""
    counted = TASKS[analysis.task].counted.lower()
    return f"called {counted} (%)" if counted == "different" else f"{counted} (%)"


def _unlike(axes: Axes, analysis: TaskAnalysis) -> None:
    """Surfaces without an amount, side by side by name."""
    for at, condition in enumerate(analysis.conditions):
        if condition.share is not None:
            axes.plot(
                [at, at], [100 * condition.share.low, 100 * condition.share.high], **style.INTERVAL
            )
            axes.plot([at], [100 * condition.share.value], **style.ESTIMATE)
    _named(axes, [condition.name for condition in analysis.conditions])
    axes.set(xlabel="the other surface", ylabel=_counted(analysis), ylim=(-2, 103))
    axes.set_title("all trials, Wilson's intervals")


def _named(axes: Axes, names: list[str]) -> None:
    named_ticks(axes, names, 16)
    axes.set_xlim(-0.5, len(names) - 0.5)


def _share(person: PersonFunction, difference: FloatArray) -> FloatArray:
    """Share of right answers (1) at differences of logarithms, without a bias."""
    from scipy.special import ndtr

    spread = math.log1p(person.weber_fraction) / QUARTILE
    rise = ndtr(difference / spread)
    return np.asarray(0.5 * person.lapse_rate + (1 - person.lapse_rate) * rise)


def _adaptive(axes: Axes, analysis: TaskAnalysis) -> None:
    """Shares correct of everybody's trials in classes of equal size, and everybody's function."""
    places = np.array([condition.value for condition in analysis.conditions])
    x = np.geomspace(places.min() / 1.2, places.max() * 1.2, 161)
    for function in list(analysis.functions.values())[:_MOST_LINES]:
        axes.plot(100 * x, 100 * _share(function, np.log1p(x)), **_FAINT)
    for condition in analysis.conditions:
        if condition.share is not None:
            ends = 100 * condition.share.low, 100 * condition.share.high
            axes.plot([100 * condition.value] * 2, ends, **style.INTERVAL)
            axes.plot([100 * condition.value], [100 * condition.share.value], **style.ESTIMATE)
    axes.set(xscale="log", xlabel="difference from the reference (%)", ylabel="correct (%)")
    axes.set_ylim(40, 103)
    style.plain_log(axes.xaxis)
    axes.set_title("thin: each person's function; dots: eighths of all trials, Wilson's intervals")


def _magnitudes(axes: Axes, analysis: TaskAnalysis) -> None:
    scale, label = _scale(analysis)
    x = np.array([scale * condition.value for condition in analysis.conditions])
    for at, condition in zip(x, analysis.conditions, strict=True):
        magnitude = condition.magnitude
        if magnitude is not None:
            if not math.isnan(magnitude.low):
                axes.plot([at, at], [magnitude.low, magnitude.high], **style.INTERVAL)
            axes.plot([at], [magnitude.value], **style.ESTIMATE)
    if analysis.pooled is not None and x.size:
        middle = float(np.mean(np.log(x)))
        level = float(
            np.mean([math.log(c.magnitude.value) for c in analysis.conditions if c.magnitude])
        )
        line = np.geomspace(x.min(), x.max(), 50)
        law = np.exp(level + analysis.pooled.value * (np.log(line) - middle))
        axes.plot(line, law, color=style.ORANGE, lw=1.4)
    axes.set(xscale="log", yscale="log", xlabel=label, ylabel="number given")
    style.plain_log(axes.xaxis, axes.yaxis)
    axes.set_title("geometric means, people's scales taken out; line: the mean exponent")


@style.drawn
def persons(analysis: TaskAnalysis) -> Figure:
    """Each person's estimate with its interval, and the population's."""
    scale, unit = (100.0, " (%)") if analysis.measure == "Weber fraction" else (1.0, "")
    people = sorted(analysis.persons, key=lambda person: person.estimate.value)
    figure = style.new_figure(
        f"{len(people)} people, one by one: {analysis.measure}",
        f"{data_of(analysis)}; {100 * people[0].estimate.level if people else 95:g} % intervals; "
        "band: the population's mean; hollow: not bounded by the answers alone",
        4.0,
    )
    axes = figure.subplots()
    for at, one in enumerate(people):
        ends = scale * one.estimate.low, scale * one.estimate.high
        axes.plot([at, at], ends, **style.INTERVAL)
        look = {
            **style.ESTIMATE,
            **({"mfc": style.PAPER, "mec": style.BLUE} if one.unbounded else {}),
        }
        axes.plot([at], [scale * one.estimate.value], **look)
    if analysis.pooled is not None:
        low, high = scale * analysis.pooled.low, scale * analysis.pooled.high
        axes.axhspan(low, high, color=style.BAND, zorder=0)
        axes.axhline(scale * analysis.pooled.value, color=style.ORANGE, lw=1.3, zorder=1)
    if unit:
        axes.set_yscale("log")
        style.plain_log(axes.yaxis)
    few = len(people) <= 16
    axes.set_xticks(
        range(len(people)) if few else [],
        [style.plain(person.person, 12) for person in people] if few else [],
        rotation=30,
    )
    axes.set(xlabel="participant, by estimate", ylabel=f"{analysis.measure}{unit}")
    return figure


@style.drawn
def sensitivity(analysis: TaskAnalysis) -> Figure:
    """d′ of each comparison from the reference."""
    scale, label = _scale(analysis)
    known = [condition for condition in analysis.conditions if condition.d_prime is not None]
    unlike = math.isnan(known[0].value)
    scale = 1.0 if unlike else scale
    points = [(at if unlike else c.value, c.d_prime) for at, c in enumerate(known) if c.d_prime]
    best = max(range(len(points)), key=lambda at: points[at][1].value)
    which = style.plain(known[best].name, 30)
    figure = style.new_figure(
        f"Most distinct from the reference: {which}, d′ = {estimate_words(points[best][1])}",
        f"{data_of(analysis)}; means over people, proportions corrected (Hautus 1995)",
        3.8,
    )
    axes = figure.subplots()
    for value, d in points:
        if not math.isnan(d.low):
            axes.plot([scale * value] * 2, [d.low, d.high], **style.INTERVAL)
        axes.plot([scale * value], [d.value], **style.ESTIMATE)
    axes.axhline(0, **style.ZERO)
    if unlike:
        _named(axes, [condition.name for condition in known])
    else:
        axes.axvline(scale * analysis.standard, **style.GUIDE)
    axes.set(xlabel="the other surface" if unlike else label, ylabel="d′")
    return figure
