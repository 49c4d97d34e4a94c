"""Figures of two-interval, same-different and magnitude studies."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from squeezefilm.core.kit import style
from squeezefilm.study.design.tasks.every_task import TASKS
from squeezefilm.study.design.tasks.task import JUDGED
from squeezefilm.study.report.answer_tables import condition_head
from squeezefilm.study.report.figures import data_of, named_ticks
from squeezefilm.study.report.words import estimate_words, most_and_least, scale_of
from squeezefilm.study.tasks.findings import PARTS, through

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squeezefilm.core.quantities import FloatArray
    from squeezefilm.study.psychometric.estimate import Estimate
    from squeezefilm.study.tasks.findings import PersonFunction, TaskAnalysis

_FAINT: dict[str, Any] = {"color": style.METAL, "lw": 0.8, "alpha": 0.7}
_MOST_LINES = 60


def _scale(analysis: TaskAnalysis) -> tuple[float, str]:
    judged = JUDGED[analysis.judged]
    return judged.factor, f"{judged.words} ({judged.unit.strip()})"


@style.drawn
def answers(analysis: TaskAnalysis) -> Figure:
    """Answers against the stimulus: psychometric functions, or the scale of numbers."""
    if not analysis.conditions:
        return style.message_figure(_said(analysis), "Nobody's answers say anything of it.")
    figure, axes = style.new_axes(_said(analysis), data_of(analysis), 4.4)
    model = TASKS[analysis.task].model
    if TASKS[analysis.task].ranks:
        _strengths(axes, analysis)
    elif analysis.is_adaptive and analysis.conditions[0].share is None:
        _runs(axes, analysis)
    elif model is None:
        _magnitudes(axes, analysis)
    elif math.isnan(analysis.conditions[0].value):
        _unlike(axes, analysis)
    elif analysis.is_adaptive:
        _adaptive(axes, analysis)
    else:
        _functions(axes, analysis)
    return figure


def _said(analysis: TaskAnalysis) -> str:
    if TASKS[analysis.task].ranks:
        return most_and_least(analysis).split(";")[0]
    if analysis.pooled is None:
        return f"No {analysis.measure} could be computed"
    words = estimate_words(analysis.pooled, *scale_of(analysis))
    return f"The {analysis.measure} is {words}"


def _functions(axes: Axes, analysis: TaskAnalysis) -> None:
    """Shares of the counted answer by stimulus, and everybody's function where it is a cumulative
    normal."""
    scale, label = _scale(analysis)
    values = [*(condition.value for condition in analysis.conditions), analysis.standard]
    x = np.linspace(min(values), max(values), 161)
    thin = _thin(axes, analysis, scale * x, x)
    _shares(axes, analysis, [scale * condition.value for condition in analysis.conditions])
    axes.axvline(scale * analysis.standard, **style.GUIDE)
    axes.set(xlabel=label)
    axes.set_title(f"{thin}dots: all trials; dotted: the reference")


def _points(axes: Axes, places: Iterable[float], estimates: Iterable[Estimate | None]) -> None:
    """Estimates with their intervals at places."""
    for x, known in zip(places, estimates, strict=True):
        if known is not None:
            style.estimate(axes, x, known.value, known.low, known.high)


def _shares(axes: Axes, analysis: TaskAnalysis, places: Iterable[float]) -> None:
    """Shares of the counted answer (%) at places."""
    axes.set(ylabel=f"{condition_head(analysis)[4].lower()} (%)", ylim=(-2, 103))
    shares = [condition.share for condition in analysis.conditions]
    _points(axes, places, [share and through(share, lambda part: 100 * part) for share in shares])


def _unlike(axes: Axes, analysis: TaskAnalysis) -> None:
    """Surfaces without an amount, side by side by name."""
    _shares(axes, analysis, range(len(analysis.conditions)))
    _named(axes, [condition.name for condition in analysis.conditions])
    axes.set(xlabel="the other surface")
    axes.set_title("all trials, Wilson's intervals")


def _named(axes: Axes, names: list[str]) -> None:
    named_ticks(axes, names, 16)
    axes.set_xlim(-0.5, len(names) - 0.5)


def _thin(axes: Axes, analysis: TaskAnalysis, x: FloatArray, amounts: FloatArray) -> str:
    """Draw each person's function, where it is a cumulative normal; what to say of the lines."""
    if not TASKS[analysis.task].ordered:
        return ""
    for function in list(analysis.functions.values())[:_MOST_LINES]:
        axes.plot(x, 100 * _share(analysis, function, amounts), **_FAINT)
    return "thin: each person's function; "


def _share(analysis: TaskAnalysis, person: PersonFunction, x: FloatArray) -> FloatArray:
    """Share of the counted answer (1) at amounts (SI), in two intervals without a bias."""
    from scipy.special import ndtr

    task, in_parts = TASKS[analysis.task], analysis.measure == "Weber fraction"
    assert task.model is not None
    threshold = math.log1p(person.threshold) if in_parts else person.threshold
    apart = np.log(x / analysis.standard) if in_parts else x - analysis.standard
    bias = person.bias if task.surfaces == 1 else 0.0
    rise = ndtr((apart - bias) * task.model.threshold / threshold)
    return np.asarray(0.5 * person.lapse_rate + (1 - person.lapse_rate) * rise)


def _adaptive(axes: Axes, analysis: TaskAnalysis) -> None:
    """Shares of everybody's trials in classes of equal size, and everybody's function."""
    places = np.array([c.value for c in analysis.conditions])
    is_signed, above = bool(places.min() < 0), places[places > 0]
    x = np.geomspace(above.min() / 1.2, above.max() * 1.2, 161)
    if is_signed:
        x = np.linspace(places.min(), places.max(), 161)
    in_parts = analysis.measure == "Weber fraction"
    amounts = analysis.standard * (1 + x) if in_parts else analysis.standard + x
    thin = _thin(axes, analysis, 100 * x, amounts)
    _shares(axes, analysis, [100 * (place or x[0]) for place in places])
    axes.set(xlabel="difference from the reference (%)")
    if not is_signed:
        axes.set(xscale="log")
    axes.set_title(f"{thin}dots: eighths of all trials, Wilson's intervals")


def _magnitudes(axes: Axes, analysis: TaskAnalysis) -> None:
    scale, label = _scale(analysis)
    x = np.array([scale * condition.value for condition in analysis.conditions])
    _points(axes, x, [condition.magnitude for condition in analysis.conditions])
    if analysis.pooled is not None and x.size:
        middle = float(np.mean(np.log(x)))
        level = float(
            np.mean([math.log(c.magnitude.value) for c in analysis.conditions if c.magnitude])
        )
        line = np.geomspace(x.min(), x.max(), 50)
        law = np.exp(level + analysis.pooled.value * (np.log(line) - middle))
        axes.plot(line, law, color=style.ORANGE, lw=1.4)
    axes.set(xscale="log", yscale="log", xlabel=label, ylabel="number given")
    axes.set_title("geometric means, people's scales taken out; line: the mean exponent")


def _runs(axes: Axes, analysis: TaskAnalysis) -> None:
    """Mean ends of runs from above and from below."""
    scale, unit = scale_of(analysis)
    ends = [c.magnitude and through(c.magnitude, lambda x: scale * x) for c in analysis.conditions]
    _points(axes, range(len(ends)), ends)
    _named(axes, [condition.name for condition in analysis.conditions])
    axes.set(xlabel="runs", ylabel=f"{analysis.measure} ({unit.strip()})")
    axes.set_title("means over people of where runs ended")


def _strengths(axes: Axes, analysis: TaskAnalysis) -> None:
    """Strengths of surfaces that were ordered, by amount, or side by side where they have none."""
    scale, label = _scale(analysis)
    x = [scale * condition.value for condition in analysis.conditions]
    if any(map(math.isnan, x)):
        x, label = list(range(len(x))), "surface"
        _named(axes, [condition.name for condition in analysis.conditions])
    _points(axes, x, [condition.magnitude for condition in analysis.conditions])
    axes.axhline(1.0, **style.GUIDE)
    axes.set(yscale="log", xlabel=label, ylabel="strength")
    axes.set_title("a surface is named with its share of the strengths; dotted: their mean")


@style.drawn
def persons(analysis: TaskAnalysis) -> Figure:
    """Each person's estimate with its interval, and the population's."""
    scale, unit = scale_of(analysis)
    people = sorted(analysis.persons, key=lambda person: person.estimate.value)
    figure, axes = style.new_axes(
        f"{len(people)} people, one by one: {analysis.measure}",
        f"{data_of(analysis)}; {100 * people[0].estimate.level if people else 95:g} % intervals; "
        "band: the population's mean; hollow: not bounded by the answers alone",
        4.0,
    )
    for at, person in enumerate(people):
        known = through(person.estimate, lambda x: scale * x)
        look = {"mfc": style.PAPER, "mec": style.BLUE} if person.unbounded else {}
        style.estimate(axes, at, known.value, known.low, known.high, **look)
    if analysis.pooled is not None:
        low, high = scale * analysis.pooled.low, scale * analysis.pooled.high
        axes.axhspan(low, high, color=style.BAND, zorder=0)
        axes.axhline(scale * analysis.pooled.value, color=style.ORANGE, lw=1.3, zorder=1)
    if analysis.measure in PARTS:
        axes.set_yscale("log")
    few = len(people) <= 16
    axes.set_xticks(
        range(len(people)) if few else [],
        [style.plain(person.person, 12) for person in people] if few else [],
        rotation=30,
    )
    said = f" ({unit.strip()})" if unit else ""
    axes.set(xlabel="participant, by estimate", ylabel=analysis.measure + said)
    return figure
