"""Figures of a study: confusions, d′, response times, power, thresholds."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core.kit import style
from squeezefilm.study.report.words import model_fit, people_needed, whose
from squeezefilm.study.tasks.findings import PARTS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squeezefilm.study.identification.analysis import IdentificationAnalysis
    from squeezefilm.study.identification.confusion import ConfusionMatrix
    from squeezefilm.study.identification.power import PowerCurve
    from squeezefilm.study.psychometric.fit import PsychometricFit
    from squeezefilm.study.simulated.planned_precision import PlannedPrecision
    from squeezefilm.study.tasks.analyze import StudyAnalysis

_SIDE_BY_SIDE = 56
"""Letters of all names together that fit below a panel."""


def data_of(analysis: StudyAnalysis) -> str:
    """The small print of every figure: whose answers, how many."""
    people = analysis.participants
    return (
        f"{whose(style.plain(analysis.origin, 40))}, {style.plain(analysis.name, 40)}; "
        f"{people} participant{'s' if people != 1 else ''}, {analysis.trials} trials"
    )


def named_ticks(axes: Axes, names: Sequence[str], longest: int = 14) -> None:
    """Names below the ticks 0, 1, …, slanted where they are too long to stand side by side."""
    shown = [style.plain(name, longest) for name in names]
    axes.set_xticks(range(len(shown)), shown)
    if sum(map(len, shown)) > _SIDE_BY_SIDE:
        axes.tick_params(axis="x", labelrotation=20)


@style.drawn
def confusion(analysis: IdentificationAnalysis) -> Figure:
    """The confusion matrix in the paper's layout: rows gratings, columns simulated periods."""
    from matplotlib.colors import LinearSegmentedColormap
    from matplotlib.patches import Rectangle

    matrix = analysis.matrix
    figure, axes = style.new_axes(
        f"{100 * analysis.proportion_correct:.3g} % of the answers are right; {_worst(matrix)}",
        f"{data_of(analysis)}; per cent of each column, trials in brackets",
        1.7 + 0.62 * len(matrix.answers),
    )
    percent = matrix.percent
    shades = LinearSegmentedColormap.from_list("share", [style.PAPER, style.PLUS, "#6fb0d8"])
    axes.imshow(np.nan_to_num(percent), cmap=shades, vmin=0, vmax=100, aspect="auto")
    for (i, j), value in np.ndenumerate(percent):
        count = int(matrix.counts[i, j])
        words = "–" if np.isnan(value) else f"{value:.0f} %\n({count})" if count else "·"
        right = i == j and matrix.is_square
        axes.text(j, i, words, ha="center", va="center", weight="bold" if right else "normal")
        if right:
            corner = j - 0.5, i - 0.5
            axes.add_patch(Rectangle(corner, 1, 1, fill=False, edgecolor=style.MUTED, lw=1.2))
    axes.set_xticks(range(len(matrix.stimuli)), [style.plain(name, 16) for name in matrix.stimuli])
    axes.set_yticks(range(len(matrix.answers)), [style.plain(name, 16) for name in matrix.answers])
    axes.set(xlabel="simulated", ylabel="answered")
    # A table of cells.
    axes.grid(visible=False)
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
    return figure


def _worst(matrix: ConfusionMatrix) -> str:
    """The most frequent confusion, in words."""
    wrong = np.where(np.eye(len(matrix.answers), dtype=bool), -1.0, np.nan_to_num(matrix.percent))
    i, j = np.unravel_index(int(np.argmax(wrong)), wrong.shape)
    if wrong[i, j] <= 0:
        return "nothing is confused"
    return (
        f"{style.plain(matrix.stimuli[j], 16)} is most often taken for "
        f"{style.plain(matrix.answers[i], 16)} ({wrong[i, j]:.0f} %)"
    )


@style.drawn
def sensitivity(analysis: IdentificationAnalysis) -> Figure:
    """Stimuli and criteria on the decision axis, and d′ of neighbours with intervals."""
    fit = analysis.sensitivity
    if fit is None:
        why = (note for note in analysis.notes if note.startswith("d′"))
        return style.message_figure("No d′", next(why, "It was not computed."))
    names = [style.plain(name, 14) for name in analysis.matrix.stimuli]
    weakest = int(np.argmin(fit.d_prime))
    figure = style.new_figure(
        f"Δ′ = {fit.total:.2f} from {names[0]} to {names[-1]}; "
        f"{names[weakest]} and {names[weakest + 1]} lie closest, d′ = {fit.d_prime[weakest]:.2f}",
        f"{data_of(analysis)}; {model_fit(fit)}",
        4.6,
    )
    top, below = figure.subplots(2, 1, height_ratios=[1.25, 1])
    low, high = min(fit.positions.min(), fit.criteria.min()), fit.positions.max()
    x = np.linspace(low - 2.6, max(high, fit.criteria.max()) + 2.6, 500)
    for name, place in zip(names, fit.positions, strict=True):
        curve = np.exp(-0.5 * (x - place) ** 2)
        top.plot(x, curve, color=style.BLUE, lw=1.3)
        top.text(place, 1.04, name, ha="center", va="bottom", fontsize=9.5)
    for k, criterion in enumerate(fit.criteria):
        named = "criteria" if k == 0 else None
        top.axvline(criterion, color=style.ORANGE, lw=1.2, ls=(0, (4, 2)), label=named)
    top.set(xlim=(x[0], x[-1]), ylim=(0, 1.3), xlabel="decision axis (standard deviations)")
    top.set_yticks([])
    top.spines["left"].set_visible(False)
    top.legend(loc="upper right", frameon=False)
    for k, known in enumerate(zip(fit.d_prime, fit.low, fit.high, strict=True)):
        style.estimate(below, k, *known)
    below.axhline(0, **style.ZERO)
    pairs = [f"{a} – {b}" for a, b in itertools.pairwise(names)]
    below.set_xticks(range(len(pairs)), pairs)
    below.set(ylabel="d′ of neighbours", xlim=(-0.5, len(pairs) - 0.5))
    below.set_title(f"{100 * fit.level:g} % intervals: {fit.interval_method}")
    return figure


@style.drawn
def response_times(analysis: StudyAnalysis) -> Figure:
    """Response times by stimulus."""
    times = analysis.response_times
    if not times:
        return style.message_figure("No response times", "No response time was given.")
    slow = max(times, key=lambda item: item.geometric_mean)
    quick = min(times, key=lambda item: item.geometric_mean)
    title = f"{style.plain(slow.name, 16)} takes {slow.geometric_mean:.2g} s"
    if len(times) > 1:
        title = (
            f"{style.plain(slow.name, 16)} takes longest, {slow.geometric_mean:.2g} s; "
            f"{style.plain(quick.name, 16)} shortest, {quick.geometric_mean:.2g} s"
        )
    figure, axes = style.new_axes(
        title,
        f"{data_of(analysis)}; geometric means over people with {100 * slow.level:g} % t intervals",
        4.0,
    )
    for k, item in enumerate(times):
        style.estimate(axes, k, item.geometric_mean, item.low, item.high)
    named_ticks(axes, [item.name for item in times])
    axes.set(ylabel="response time (s)", xlabel="stimulus")
    axes.set_ylim(0, None)
    return figure


def _by_people(axes: Axes, curve: PowerCurve, said: str) -> None:
    """Shares of studies with their bounds against the number of people, and how many are needed."""
    people, share = curve.participants, 100 * curve.power
    axes.plot(people, share, color=style.BLUE, lw=1.3)
    axes.vlines(people, 100 * curve.low, 100 * curve.high, **style.INTERVAL)
    axes.plot(people, share, **style.ESTIMATE)
    axes.axhline(100 * curve.target, color=style.ORANGE, lw=1.1, ls=(0, (4, 2)))
    if curve.needed is not None:
        axes.axvline(curve.needed, color=style.ORANGE, lw=1.1, ls=(0, (1.4, 1.2)))
    axes.set(xlabel="participants", ylabel=said, xlim=(0, None), ylim=(0, 103))


@style.drawn
def power(curve: PowerCurve) -> Figure:
    """Power against the number of people, with the error of the simulation."""
    said, surely = (
        people_needed(curve, f"reach {100 * curve.target:g} % power"),
        curve.needed_surely,
    )
    if surely is not None and surely != curve.needed:
        said += f"; {surely} do beyond the simulation's error"
    figure, axes = style.new_axes(
        said,
        f"simulated studies, {curve.studies} per size; one-sided test at α = {curve.alpha:g}; bars "
        "are 95 % Clopper–Pearson bounds of the simulation",
        4.0,
    )
    _by_people(axes, curve, "studies that find it (%)")
    return figure


@style.drawn
def precision(found: PlannedPrecision) -> Figure:
    """Share of studies that are precise enough against the number of people."""
    curve = found.curve
    wanted = (
        f"± {100 * found.precision:g} %" if found.measure in PARTS else f"± {found.precision:g}"
    )
    said = people_needed(curve, f"give the {found.measure} within {wanted}")
    figure, axes = style.new_axes(
        f"{said} in {100 * curve.target:g} % of studies",
        f"simulated studies, {curve.studies} per size; bars are 95 % Clopper–Pearson bounds of the "
        "simulation; dotted: intervals that hold the value of all people (95 % are promised)",
        4.0,
    )
    _by_people(axes, curve, "studies (%)")
    axes.plot(curve.participants, 100 * found.held, color=style.MUTED, ls=":", lw=1.1)
    axes.axhline(95, **style.GUIDE)
    return figure


@style.drawn
def psychometric_function(fit: PsychometricFit) -> Figure:
    """Share of positive answers against intensity; the area of a point is its number of trials."""
    function, log = fit.function, fit.function.axis == "log"
    low, high = fit.posterior_interval["threshold"]
    title = (
        f"The threshold is {function.threshold:.3g}, with {100 * fit.level:g} % between "
        f"{low:.3g} and {high:.3g}"
    )
    if fit.falls:
        title = "The answers fall with intensity: this rising function does not describe them"
    made = (
        f"{function.shape} function, guess rate {function.guess_rate:.2g}, lapse rate "
        f"{function.lapse_rate:.2g}; {int(fit.trials.sum())} trials; credible interval"
    )
    figure, axes = style.new_axes(title, "; ".join([made, *fit.notes]), 4.4)
    first, last = float(fit.intensity[0]), float(fit.intensity[-1])
    room = 0.0 if log else 0.04 * (last - first)
    ends = first - room, last + room
    x = np.geomspace(*ends, 201) if log else np.linspace(*ends, 201)
    axes.plot(x, 100 * np.asarray(function(x)), color=style.BLUE)
    share = 100 * fit.positive / fit.trials
    area = 20 + 180 * fit.trials / fit.trials.max()
    axes.scatter(fit.intensity, share, s=area, color=style.MUTED, edgecolor=style.PAPER, zorder=3)
    middle = 100 * float(np.asarray(function(function.threshold)))
    axes.plot([low, high], [middle, middle], color=style.ORANGE, lw=2.4, zorder=4)
    style.mark(axes, function.threshold, middle, 7, color=style.ORANGE)
    axes.set(xlabel="intensity", ylabel="positive answers (%)", ylim=(-2, 103))
    if log:
        axes.set_xscale("log")
    return figure
