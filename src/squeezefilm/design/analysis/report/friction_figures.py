"""The figure of friction by the verdict's own model, with what other figures share."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squeezefilm.core import quantities as si
from squeezefilm.core.kit import style
from squeezefilm.core.kit.model_looks import look_of
from squeezefilm.core.kit.numbers import SPEED, M, N, shown, span
from squeezefilm.design.analysis.curves import PAPER_CRITERION

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squeezefilm.design.analysis.analyze import Analysis


@style.drawn
def own_friction(analysis: Analysis) -> Figure:
    """Relative friction against amplitude by the prediction's own model, with the band in which it
    lies."""
    p, band, here = analysis.prediction, analysis.band, analysis.own_curve
    unsure, needed = analysis.uncertainty, here.amplitude_for_criterion
    said = f"µ′/µ = {p.relative_friction:.2f}" if unsure is None else unsure.sentence
    takes = "more than 50 µm" if needed is None else shown(needed, M, 3)
    title = (
        f"At {shown(p.vibration_amplitude, M, 3)} on {style.plain(here.surface, 20)} {said}; 0.7 "
        f"takes {takes}"
    )
    small = (
        f"{p.model}; {shown(p.normal_force, N)}, {shown(p.speed, SPEED)}; each with the finger on"
    )
    figure = style.new_figure(title, small, 4.8)
    axes = figure.subplots()
    if band is not None:
        name = f"{si.percent(band.level)} of what the friction may be at an amplitude"
        x = 1e6 * band.amplitude
        axes.fill_between(x, band.low, band.high, color=style.BAND, lw=0, label=name)
    look = look_of(p.model)
    for number, curve in enumerate(analysis.own_curves):
        own = curve.surface == here.surface
        line = {"lw": 2.4} if own else {"lw": 1.2, "ls": style.LINES[1 + number % 3][1]}
        rough = shown(curve.roughness, M, 3)
        name = f"as described, on {style.plain(curve.surface, 20)} (roughness {rough})"
        axes.plot(
            1e6 * curve.amplitude, curve.relative_friction, color=look.color, label=name, **line
        )
    criterion_line(axes)
    working_point(axes, analysis)
    # A still plate has its whole curve to show.
    reach = max(1.5 * p.vibration_amplitude, min(needed or 0.0, float(here.amplitude[-1])))
    style.friction_axes(axes, 1e6 * (reach or float(here.amplitude[-1])), top=1.06)
    style.legend_below(axes, columns=2)
    return figure


def criterion_line(axes: Axes) -> None:
    """What the paper asks of the friction, as a line across."""
    axes.axhline(PAPER_CRITERION, **style.REFERENCE, label="0.7: what the paper asks for")


def working_point(axes: Axes, analysis: Analysis) -> None:
    """Mark this display at its own friction, with its interval where there is one."""
    p, unsure = analysis.prediction, analysis.uncertainty
    at, words = 1e6 * p.vibration_amplitude, f"this display: {p.relative_friction:.2f}"
    if unsure is not None:
        style.interval(axes, at, *unsure.interval)
        words += f" ({span(*unsure.interval)}, {si.percent(unsure.level)} interval)"
    words += f" at {shown(p.vibration_amplitude, M, 3)}"
    style.mark(axes, at, p.relative_friction, 9, words)
