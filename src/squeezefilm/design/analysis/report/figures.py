"""The figures of a report in their order, each with its heading and how to read it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.kit import style
from squeezefilm.core.kit.model_looks import look_of
from squeezefilm.core.kit.numbers import HZ, SPEED, M, N, V, printable, shown, span
from squeezefilm.core.kit.page_style import FigureOf
from squeezefilm.design.analysis.curves import LIKE, PAPER_CRITERION, measured_on_like
from squeezefilm.design.plate.solved import half_power
from squeezefilm.measure.fits.friction.friction_scores import rest_friction
from squeezefilm.physics.chain.active_area import CRITERIA, ActiveArea
from squeezefilm.physics.chain.pad_place import place_words

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squeezefilm.core.quantities import FloatArray
    from squeezefilm.design.analysis.analysis import Analysis
    from squeezefilm.design.analysis.curves import FrictionCurve
    from squeezefilm.physics.chain.prediction import Prediction


@style.drawn
def own_friction(analysis: Analysis) -> Figure:
    """Relative friction against amplitude by the prediction's own model, with the band in which it
    lies and what was measured on plates like it."""
    title = f"How far friction falls with the amplitude: {_takes(analysis)}"
    figure, axes = style.new_axes(title, _made(analysis), 4.8)
    _friction(axes, analysis, analysis.own_curves)
    style.legend_below(axes, columns=2)
    return figure


def _takes(analysis: Analysis) -> str:
    """The amplitude at which friction falls to 0.7."""
    needed = analysis.own_curve.amplitude_for_criterion
    return f"for 0.7 it takes {'more than 50 µm' if needed is None else shown(needed, M, 3)}"


def _made(analysis: Analysis) -> str:
    p = analysis.prediction
    return (
        f"{p.model}; {shown(p.normal_force, N)}, {shown(p.speed, SPEED)}; each with the finger on"
    )


def _friction(axes: Axes, analysis: Analysis, curves: Sequence[FrictionCurve]) -> None:
    p, band, here = analysis.prediction, analysis.band, analysis.own_curve
    needed = here.amplitude_for_criterion
    if band is not None:
        name = f"{si.percent(band.level)} of what it may be at an amplitude"
        x = 1e6 * band.amplitude
        axes.fill_between(x, band.low, band.high, color=style.BAND, lw=0, label=name)
    look = look_of(p.model)
    for number, curve in enumerate(curves):
        own = curve.surface == here.surface
        line = {"lw": 2.4} if own else {"lw": 1.2, "ls": style.LINES[1 + number % 3][1]}
        rough = shown(curve.roughness, M, 3)
        name = f"on {style.plain(curve.surface, 20)} (roughness {rough})"
        axes.plot(
            1e6 * curve.amplitude, curve.relative_friction, color=look.color, label=name, **line
        )
    criterion_line(axes)
    working_point(axes, analysis)
    measured = measured_on_like(p)
    dots = {**style.ESTIMATE, "color": style.MUTED, "ms": 3.5, "mew": 0.4, "zorder": 1.5}
    for number, each in enumerate(measured):
        x, y = 1e6 * each.vibration_amplitude, each.friction / rest_friction(each)
        name = f"measured on like plates: {len(measured)} curves, all on glass"
        axes.plot(x, y, **dots, label=None if number else name)
    # A still plate has its whole curve to show.
    reach = max(1.5 * p.vibration_amplitude, min(needed or 0.0, float(here.amplitude[-1])))
    style.friction_axes(axes, 1e6 * (reach or float(here.amplitude[-1])), top=1.06)


def criterion_line(axes: Axes) -> None:
    """Draw a line across at what the paper asks of the friction."""
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


@style.drawn
def frequency_response(analysis: Analysis) -> Figure:
    """Amplitude per volt against frequency, with resonance, half-power band and drive."""
    response, p = analysis.response, analysis.prediction
    f, per_volt = 1e-3 * response.frequency, 1e9 * response.amplitude_per_volt
    top = int(np.argmax(per_volt))
    peak = float(per_volt[top])
    solid = p.mode.solid
    own = p.mode.amplitude_per_volt if solid is None else solid.alone_per_volt
    driven = own > 0.1e-9 * peak
    band = half_power(f, per_volt) if driven else None
    at = shown(p.mode.resonance_frequency, HZ)
    title = f"The ceramics cancel out: they do not drive the mode at {at}"
    if driven:
        wide = "" if band is None else f" is {shown(1e3 * (band[1] - band[0]), HZ, 3)} wide"
        title = f"The resonance at {at}{wide}: the drive must stay on it{_lost_beside(p)}"
    figure, axes = style.new_axes(title, f"{response.model}; without a finger", 4.3)
    if band is not None:
        name = f"half-power band, {band[0]:.2f} to {band[1]:.2f} kHz (above 71 % of the peak)"
        axes.axvspan(*band, color=style.BAND, lw=0, label=name)
    name = f"amplitude per volt, quality factor Q = {p.mode.quality_factor:.3g}"
    axes.plot(f, per_volt, color=style.BLUE, label=name)
    axes.axvline(1e-3 * p.mode.resonance_frequency, **style.LANDMARK, label=f"resonance, {at}")
    if p.voltage is not None and f[0] <= 1e-3 * p.frequency <= f[-1]:
        _mark_drive(axes, p, p.voltage, peak)
    axes.set(xlim=(float(f[0]), float(f[-1])), ylim=(0, 1.08 * peak if peak > 0 else 1))
    axes.set(xlabel="frequency (kHz)", ylabel="amplitude per volt, free (nm/V)")
    if p.voltage:
        style.micrometres_beside(axes, p.voltage, f"amplitude at {shown(p.voltage, V)} (µm)")
    style.legend_below(axes)
    return figure


def _lost_beside(p: Prediction) -> str:
    """Words for what a drive beside the resonance gets of the motion; nothing where it is all.

    Without a finger, which damps the motion wherever the drive is.
    """
    share = 1.0
    if p.voltage:
        share = p.touch.free_amplitude / (p.voltage * p.mode.amplitude_per_volt)
    if share >= 0.99:
        return ""
    return f", but at {shown(p.frequency, HZ)} it gets {si.percent(share)} of the motion"


def _mark_drive(axes: Axes, p: Prediction, voltage: float, peak: float) -> None:
    """The working point; without a voltage (V) the amplitude per volt is the peak's (nm/V)."""
    free = p.touch.free_amplitude
    height = 1e9 * free / voltage if voltage else peak
    name = f"drive: {shown(voltage, V)} at {shown(p.frequency, HZ)}, {shown(free, M, 3)} free"
    if p.vibration_amplitude != free:
        name += f", {shown(p.vibration_amplitude, M, 3)} with the finger on"
    look = {**style.ESTIMATE, "color": style.ORANGE, "ms": 8, "mew": 1.2}
    axes.plot(1e-3 * p.frequency, height, **look, zorder=4, label=name)


_PLACE = style.ESTIMATE | {"ms": 8, "color": style.PAPER, "mec": style.INK, "mew": 1.2}


@style.drawn
def deciding(analysis: Analysis) -> Figure:
    """The friction under the pad by the place of its centre, or where the model has none the
    amplitude of the face; beside it friction against amplitude. A mode without a shape over a face
    has the latter alone."""
    if analysis.active_area is None:
        return own_friction(analysis)
    area = analysis.active_area.area
    made = f"{_made(analysis)}; {area.shape_model} ({area.shape_words})"
    title = f"Where on the face friction falls, and how far: {_takes(analysis)}"
    figure = style.new_figure(title, made, 5.1)
    cells = figure.subplot_mosaic("pa;ll", width_ratios=(1.2, 1), height_ratios=(1, 0.27))
    by_place, by_amplitude, strip = cells.values()
    by_place.set_anchor("S")
    if 1 in area.amplitude.shape:
        _line(by_place, area)
    elif area.relative_friction is None:
        _map(by_place, area, 1e6 * area.amplitude, "amplitude of the face (µm)")
    else:
        _map(by_place, area, area.relative_friction, "relative friction µ′/µ under the pad")
        _places(by_place, area)
    _friction(by_amplitude, analysis, (analysis.own_curve,))
    style.legend_in(strip, by_amplitude, columns=2)
    return figure


def _map(axes: Axes, area: ActiveArea, values: FloatArray, label: str) -> None:
    """Values by place (mm), the criteria as lines where they lie within."""
    from matplotlib.image import NonUniformImage
    from matplotlib.ticker import MaxNLocator

    x, y = 1e3 * area.x, 1e3 * area.y
    shown = np.ma.masked_invalid(values.T)
    low, high = float(shown.min()), float(shown.max())
    if high - low < 1e-6 * max(abs(high), 1e-9):
        low, high = low - 0.5e-3, high + 0.5e-3
    # An image: as areas between levels the map of a large plate takes two megabytes.
    ends = (x[0], x[-1], y[0], y[-1])
    filled = NonUniformImage(axes, interpolation="bilinear", extent=ends, cmap="cividis")
    filled.set_data(x, y, shown)
    filled.set_clim(low, high)
    axes.add_image(filled)
    axes.set(xlim=ends[:2], ylim=ends[2:])
    # A scale takes its room where the map leaves some: beside one that is not wide.
    side: Literal["vertical", "horizontal"] = (
        "vertical" if np.ptp(x) < 1.3 * np.ptp(y) else "horizontal"
    )
    scale = axes.figure.colorbar(
        filled, ax=axes, label=label, ticks=MaxNLocator(nbins=5), orientation=side
    )
    if scale.solids is not None:
        scale.solids.set_edgecolor("face")
    axes.grid(visible=False)
    axes.set(aspect="equal", xlabel="x of the finger's centre (mm)", ylabel="y (mm)")


def _places(axes: Axes, area: ActiveArea) -> None:
    """The best and the worst place, and where the criteria lie."""
    assert area.relative_friction is not None, "drawn only where there is a friction"
    assert area.best_place is not None
    assert area.worst_place is not None
    from matplotlib.patches import Rectangle

    shown = np.ma.masked_invalid(area.relative_friction.T)
    within = [criterion for criterion in CRITERIA if shown.min() < criterion < shown.max()]
    if within:
        lines = axes.contour(
            1e3 * area.x, 1e3 * area.y, shown, levels=within, colors=style.PAPER, linewidths=1.4
        )
        axes.clabel(lines, fmt="%.2f", fontsize=9)
    for place, name, marker in (
        (area.best_place, "best place", "o"),
        (area.worst_place, "worst place", "X"),
    ):
        x, y = (1e3 * value for value in place)
        look = _PLACE | {"marker": marker, "label": printable(f"{name}, {place_words(place)}")}
        axes.plot([x], [y], clip_on=False, **look)
    side = 1e3 * area.contact_side
    left, bottom = (1e3 * middle - side / 2 for middle in area.best_place)
    axes.add_patch(
        Rectangle(
            (left, bottom),
            side,
            side,
            facecolor="none",
            edgecolor=style.ORANGE,
            lw=2.0,
            label="the finger's contact",
        )
    )
    # A place can lie anywhere on the map: both are named above it.
    axes.legend(
        loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False, borderaxespad=0.2
    )


def _line(axes: Axes, area: ActiveArea) -> None:
    """An area that is a line: amplitude and friction along it."""
    along_x = area.x.size > 1
    place = 1e3 * (area.x if along_x else area.y)
    axes.plot(place, 1e6 * area.amplitude.ravel(), color=style.BLUE, label="amplitude of the face")
    axes.set(xlabel=f"{'x' if along_x else 'y'} of the finger's centre (mm)")
    axes.set(ylabel="amplitude (µm)", ylim=(0, None), xlim=(float(place[0]), float(place[-1])))
    handles, _ = axes.get_legend_handles_labels()
    if area.relative_friction is not None:
        right = axes.twinx()
        name = "relative friction under the pad"
        right.plot(place, area.relative_friction.ravel(), **style.WANTED, label=name)
        right.set(ylabel="relative friction µ′/µ", ylim=(0, 1.02))
        right.grid(visible=False)
        right.xaxis.set_tick_params(labelbottom=False)
        handles = handles + right.get_legend_handles_labels()[0]
    style.legend_below(axes, handles=handles)


FIGURES: tuple[FigureOf, ...] = (
    FigureOf(
        "friction",
        "Map and curve of friction",
        deciding,
        f"Square: the finger's contact. Band and bar: 90 % of what it may be. {LIKE}",
    ),
    FigureOf(
        "response",
        "Frequency response",
        frequency_response,
        "Vibration amplitude per volt around the working resonance, without a finger. Outside the "
        "half-power band less than 71 % of it is left.",
    ),
)
"""Figures of what one decides from, in the order of the page."""


def drawing(analysis: Analysis, item: FigureOf) -> str:
    """A figure as an SVG element, with its message for those who cannot see it."""
    with style.rc():
        figure = item.draw(analysis)
        message = " ".join(figure.get_suptitle().split())
        return style.svg(figure, item.key, f"{item.heading}. {message}. {item.reading}")
