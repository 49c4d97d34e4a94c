"""Figures of a study beside its confusions: response times, power, thresholds."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core.kit import style
from squeezefilm.study.report.figures import data_of, named_ticks
from squeezefilm.study.tasks.findings import PARTS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squeezefilm.study.identification.power import PowerCurve
    from squeezefilm.study.psychometric.fit import PsychometricFit
    from squeezefilm.study.simulated.planned_precision import PlannedPrecision
    from squeezefilm.study.tasks.analyze import StudyAnalysis


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
    figure = style.new_figure(
        title,
        f"{data_of(analysis)}; geometric means over people with {100 * slow.level:g} % t intervals",
        4.0,
    )
    axes = figure.subplots()
    style.estimates(axes, ((item.geometric_mean, item.low, item.high) for item in times))
    named_ticks(axes, [item.name for item in times])
    axes.set(ylabel="response time (s)", xlabel="stimulus")
    axes.set_ylim(0, None)
    return figure


def _by_people(figure: Figure, curve: PowerCurve, said: str) -> Axes:
    """Shares of studies with their bounds against the number of people, and how many are needed."""
    axes, people, share = figure.subplots(), curve.participants, 100 * curve.power
    axes.plot(people, share, color=style.BLUE, lw=1.3)
    axes.vlines(people, 100 * curve.low, 100 * curve.high, **style.INTERVAL)
    axes.plot(people, share, **style.ESTIMATE)
    axes.axhline(100 * curve.target, color=style.ORANGE, lw=1.1, ls=(0, (4, 2)))
    if curve.needed is not None:
        axes.axvline(curve.needed, color=style.ORANGE, lw=1.1, ls=(0, (1.4, 1.2)))
    axes.set(xlabel="participants", ylabel=said, xlim=(0, None), ylim=(0, 103))
    return axes


@style.drawn
def power(curve: PowerCurve) -> Figure:
    """Power against the number of people, with the error of the simulation."""
    needed, surely = curve.needed, curve.needed_surely
    said = f"{needed} people reach {100 * curve.target:g} % power"
    if needed is None:
        most = int(curve.participants[-1])
        said = f"{most} people do not reach {100 * curve.target:g} % power"
    elif surely is not None and surely != needed:
        said += f"; {surely} do beyond the simulation's error"
    figure = style.new_figure(
        said,
        f"simulated studies, {curve.studies} per size; one-sided test at α = {curve.alpha:g}; bars "
        "are 95 % Clopper–Pearson bounds of the simulation",
        4.0,
    )
    _by_people(figure, curve, "studies that find it (%)")
    return figure


@style.drawn
def precision(found: PlannedPrecision) -> Figure:
    """Share of studies that are precise enough against the number of people."""
    curve = found.curve
    wanted = f"± {100 * found.precision:g} %" if found.measure in PARTS else ""
    wanted = wanted or f"± {found.precision:g}"
    said = f"{curve.needed} people give the {found.measure} within {wanted}"
    if curve.needed is None:
        said = f"{int(curve.participants[-1])} people do not give the {found.measure} to {wanted}"
    figure = style.new_figure(
        f"{said} in {100 * curve.target:g} % of studies",
        f"simulated studies, {curve.studies} per size; bars are 95 % Clopper–Pearson bounds of the "
        "simulation; dotted: intervals that hold the value of all people (95 % are promised)",
        4.0,
    )
    axes = _by_people(figure, curve, "studies (%)")
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
    figure = style.new_figure(title, "; ".join([made, *fit.notes]), 4.4)
    axes = figure.subplots()
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
        style.plain_log(axes.xaxis)
    return figure
