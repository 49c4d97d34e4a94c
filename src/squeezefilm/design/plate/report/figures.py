"""The figures of a solved plate, disc or stator: shape in plan, scan, response, admittance."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.kit import style
from squeezefilm.core.kit.numbers import HZ, M, printable, shown
from squeezefilm.core.kit.page_style import FigureOf
from squeezefilm.design.plate.solved import half_power
from squeezefilm.physics.plate.elements.nodal_lines import zero_crossings

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squeezefilm.core.quantities import FloatArray
    from squeezefilm.design.plate.command import PlateAnalysis
    from squeezefilm.design.plate.ring import RingAnalysis

FILL = {1: style.PLUS, -1: style.MINUS}
"""The colours of ceramics that follow the drive with either sign."""


@style.drawn
def shape(result: RingAnalysis) -> Figure:
    """The mode from above with its nodal lines and circles, beside the poling of the sectors."""
    mode, at = result.annular, result.resonance
    size = 1e9 * result.largest_per_volt
    where = f"nodal lines {shown(mode.half_wavelength or 0.0, M)} apart on the mean circumference"
    if not mode.harmonic:
        radii = ", ".join(shown(float(r), M, 3) for r in result.circles)
        where = f"nodal circle at a radius of {radii}" if radii else "no nodal line"
    figure = style.new_figure(
        f"Mode {result.working.label} at {result.working.frequency / 1e3:.2f} kHz moves up to "
        f"{size:.0f} nm per volt; {where}",
        f"{result.model}, channel driven at resonance",
        5.4,
    )
    left, right = figure.subplots(1, 2, sharex=True, sharey=True)
    r = result.response.radius
    theta = np.linspace(0, 2 * np.pi, max(181, 24 * mode.harmonic) | 1)
    radial = _standing(result.response.motion[at])
    # Turned to where the channel moves it most: cos m(θ − θ0).
    w = 1e9 * radial[:, None] * np.cos(mode.harmonic * theta - _turn(result))[None, :]
    x, y = 1e3 * r[:, None] * np.cos(theta), 1e3 * r[:, None] * np.sin(theta)
    style.motion_field(left, x, y, w, label="per volt (nm/V)", location="bottom", shrink=0.75)
    left.set_title("touched face; nodal lines in black")
    _sectors(right, result)
    outer = 1e3 * max(layer.outer_radius for layer in result.body.section.layers)
    for axes in (left, right):
        axes.set(xlim=(-1.05 * outer, 1.05 * outer), ylim=(-1.05 * outer, 1.05 * outer))
        axes.set(aspect="equal", xlabel="x (mm)")
        axes.grid(visible=False)
    left.set(ylabel="y (mm)")
    return figure


def _standing(motion: np.ndarray) -> np.ndarray:
    """Complex motion turned to the phase of its largest point: what stands there moves along."""
    peak = motion.flat[int(np.argmax(np.abs(motion)))]
    return np.asarray((motion * np.conj(peak) / np.abs(peak)).real)


def _turn(result: RingAnalysis) -> float:
    """mθ0 of the mode that the channel moves."""
    coefficient = result.body.drive.coefficient(result.annular.harmonic)
    return -math.atan2(coefficient.imag, coefficient.real)


def _sectors(axes: Axes, result: RingAnalysis) -> None:
    """The ceramic from above with its poled sectors, over the outline of the body."""
    from matplotlib.patches import Circle, Patch, Wedge

    layers = result.body.section.layers
    outer = 1e3 * max(layer.outer_radius for layer in layers)
    inner = 1e3 * min(layer.inner_radius for layer in layers)
    ceramic = next(layer for layer in layers if layer.solid.piezoelectric)
    edge, width = 1e3 * ceramic.outer_radius, 1e3 * (ceramic.outer_radius - ceramic.inner_radius)
    whole = result.body.drive.angle > 2 * np.pi - 1e-9 and len(result.body.drive.sectors) == 1
    unused: dict[str, Any] = {"facecolor": "none", "edgecolor": style.MUTED}
    if not whole:
        axes.add_patch(Wedge((0, 0), edge, 0, 360, width=width, lw=0.8, **unused))
    for start, end, sign in result.body.drive.sectors:
        draw_sector(axes, edge, width, (math.degrees(start), math.degrees(end)), sign)
        middle, place = (start + end) / 2, 0.0 if whole and inner == 0 else edge - width / 2
        x, y = place * math.cos(middle), place * math.sin(middle)
        axes.text(x, y, "+" if sign > 0 else "−", ha="center", va="center", fontsize=11)
    for radius in {outer, inner} - {0.0}:
        axes.add_patch(Circle((0, 0), radius, fill=False, ec=style.INK, lw=1))
    axes.set_title("ceramic below, seen through the body")
    handles = [
        Patch(facecolor=style.PLUS, edgecolor=style.INK, label="driven, poled up"),
        Patch(facecolor=style.MINUS, edgecolor=style.INK, label="driven, poled down"),
        Patch(**unused, label="not on this channel"),
    ]
    style.legend_below(axes, handles=handles[:1] if whole else handles)


def draw_sector(
    axes: Axes, outer: float, width: float, ends: tuple[float, float], sign: int
) -> None:
    """A sector of one sign: its outer radius and width, in the axes' unit, its ends (degrees)."""
    from matplotlib.patches import Wedge

    axes.add_patch(Wedge((0, 0), outer, *ends, width=width, facecolor=FILL[sign], **style.OUTLINED))


@style.drawn
def scan(result: RingAnalysis) -> Figure:
    """The driven shape around the mean circumference and along a radius; without nodal diameters
    along a diameter."""
    m, model = result.annular.harmonic, f"{result.model}, channel driven at resonance"
    radial = 1e9 * _standing(result.response.motion[result.resonance])
    mean = result.scan_radius
    if m:
        title = (
            f"{m} waves stand around the mean circumference of {shown(2 * math.pi * mean, M)}: "
            f"{abs(float(np.interp(mean, result.response.radius, radial))):.0f} nm per volt at "
            "their antinodes"
        )
        figure = style.new_figure(title, model, 5.6)
        above, below = figure.subplots(2, 1)
        _around(above, result, float(np.interp(mean, result.response.radius, radial)))
    else:
        title = (
            f"Along a diameter {result.working.label} moves {abs(radial[0]):.0f} nm per volt in "
            f"the middle and {abs(radial[-1]):.0f} at the rim"
        )
        figure, below = style.new_axes(title, model, 4.2)
    r = 1e3 * result.response.radius
    below.plot(r, radial, color=style.BLUE, label="at the angle of an antinode" if m else None)
    if not m:
        below.plot(-r, radial, color=style.BLUE)
    below.axhline(0, **style.ZERO)
    for number, circle in enumerate(result.circles):
        for side in (1,) if m else (1, -1):
            name = "nodal circle" if number == 0 and side == 1 else None
            dashed = {"color": style.ORANGE, "lw": 1.2, "ls": (0, (4, 2))}
            below.axvline(side * 1e3 * float(circle), **dashed, label=name)
    below.set(xlabel="radius (mm)" if m else "along a diameter (mm)", ylabel="per volt (nm/V)")
    below.set_xlim(r[0] if m else -r[-1], r[-1])
    if below.get_legend_handles_labels()[0]:
        style.legend_below(below, gap=0.3 if m else 0.2)
    return figure


def _around(axes: Axes, result: RingAnalysis, here: float) -> None:
    """The scan around the mean circumference, with the sectors of the channel at its foot."""
    m, mean = result.annular.harmonic, result.scan_radius
    angle = np.linspace(0, 2 * np.pi, max(361, 40 * m) | 1)
    length = 1e3 * mean * angle
    axes.plot(length, here * np.cos(m * angle - _turn(result)), color=style.BLUE)
    axes.axhline(0, **style.ZERO)
    axes.set(xlabel=f"along the circumference at a radius of {shown(mean, M)} (mm)")
    axes.set(ylabel="per volt (nm/V)", xlim=(0, float(length[-1])))
    for start, end, sign in result.body.drive.sectors:
        axes.axvspan(1e3 * mean * start, 1e3 * mean * end, ymax=0.06, color=FILL[sign], lw=0.0)


@style.drawn
def response(result: RingAnalysis) -> Figure:
    """Amplitude per volt and admittance around the working mode, with its equivalent circuit."""
    swept = result.response
    f = swept.frequencies / 1e3
    figure = style.new_figure(
        f"Resonance at {shown(float(swept.frequencies[swept.resonance]), HZ)}: "
        f"{np.abs(swept.admittance[swept.resonance]) * 1e3:.3g} mS",
        f"{result.model}; {swept.terms} modes of its harmonic, "
        f"{len(swept.harmonics)} harmonics in the admittance",
        6.0,
    )
    above, below = figure.subplots(2, 1, sharex=True)
    above.plot(f, 1e9 * swept.maximum, color=style.BLUE)
    above.set(ylabel="largest amplitude (nm/V)", ylim=(0, None))
    below.semilogy(f, 1e3 * np.abs(swept.admittance), color=style.BLUE, label="|Y|")
    below.semilogy(f, 1e3 * swept.admittance.real, color=style.ORANGE, ls="--", label="Re Y")
    if result.circuit is not None:
        circuit = 1e3 * np.abs(result.circuit.admittance(swept.frequencies))
        resistance = printable(shown(result.circuit.motional_resistance, si.Unit("ohm"), 3))
        name = f"equivalent circuit, R1 = {resistance}"
        below.semilogy(f, circuit, color=style.INK, lw=1.0, ls=(0, (1, 2)), label=name)
    below.set(xlabel="frequency (kHz)", ylabel="admittance (mS)")
    style.legend_below(below, columns=3, gap=0.28)
    return figure


RING_FIGURES = (
    FigureOf("shape", "Mode shape from above", shape, file="mode-plan"),
    FigureOf("scan", "Line scan", scan, file="line-scan"),
    FigureOf("response", "Frequency response", response, file="frequency-response"),
)


def driven_shape(result: PlateAnalysis, x: FloatArray, y: FloatArray) -> FloatArray:
    """w per volt (m/V) over the upper face at resonance, at the instant when its largest point
    stands highest; shape (x, y)."""
    return _standing(result.response.motion(result.resonance, x, y))


@style.drawn
def plan_view(result: PlateAnalysis) -> Figure:
    """The driven shape over the upper face, seen from above, with its nodal lines."""
    plate = result.plate
    x, y = np.linspace(0, plate.length, 166), np.linspace(0, plate.width, 99)
    w = 1e9 * driven_shape(result, x, y)
    reach = float(np.max(np.abs(w)))
    figure, axes = style.new_axes(
        f"Mode {result.working.label} at {result.working.frequency / 1e3:.2f} kHz from above: up "
        f"to {reach:.3g} nm per volt",
        f"{result.modes.model}, all electrodes driven at resonance; nodal lines in black",
        5.2,
    )
    style.motion_field(axes, 1e3 * x, 1e3 * y, w.T, label="w per volt (nm/V)", shrink=0.8)
    axes.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal")
    return figure


@style.drawn
def line_scan(result: PlateAnalysis) -> Figure:
    """The driven shape across its nodal lines, on the middle of the plate and on its edge, as a
    vibrometer that is moved along would see it."""
    plate = result.plate
    lengthwise = result.working_label[0] >= result.working_label[1]
    span, other = (plate.length, plate.width)[:: 1 if lengthwise else -1]
    x, lines = np.linspace(0, span, 333), np.array([0.0, other / 2])
    w = 1e9 * (driven_shape(result, x, lines) if lengthwise else driven_shape(result, lines, x).T)
    volts = result.display.drive.voltage
    title = (
        f"At the antinode {1e9 * result.amplitude_per_volt:.3g} nm per volt, "
        f"{1e9 * result.largest_per_volt:.3g} nm per volt at the largest of the face"
    )
    model = f"{result.modes.model}, all electrodes driven at resonance"
    figure, axes = style.new_axes(title, model, 4.2)
    axes.plot(1e3 * x, w[:, 1], color=style.BLUE, label="centreline")
    axes.plot(1e3 * x, w[:, 0], color=style.ORANGE, ls="--", label="edge")
    axes.axhline(0, **style.ZERO)
    nodes = zero_crossings(x, w[:, 1])
    named = f"{nodes.size} nodes of the centreline"
    axes.plot(1e3 * nodes, 0 * nodes, "o", color=style.INK, ms=4, zorder=3, label=named)
    axes.set(xlabel="x (mm)" if lengthwise else "y (mm)", xlim=(0, 1e3 * span))
    axes.set(ylabel="w per volt (nm/V)")
    if volts:
        style.micrometres_beside(axes, volts, f"w at {volts:g} V (µm)")
    style.legend_below(axes, columns=3, gap=0.2)
    return figure


@style.drawn
def frequency_response(result: PlateAnalysis) -> Figure:
    """The antinode's amplitude per volt against frequency around the working mode."""
    response, at = result.response, result.resonance
    f, per_volt = response.frequencies / 1e3, 1e9 * response.amplitude_at(*result.mode.lobe)
    # Where a neighbour moves more, the highest point is not this mode's.
    band = half_power(f, per_volt) if at == int(np.argmax(per_volt)) else None
    wide = "" if band is None else f", {1e3 * (band[1] - band[0]):.3g} Hz wide at half power"
    figure, axes = style.new_axes(
        f"Resonance at {f[at]:.2f} kHz: {per_volt[at]:.3g} nm per volt{wide}",
        f"{response.model}, {response.method}; at the antinode",
        4.2,
    )
    if band is not None:
        axes.axvspan(*band, color=style.BAND, lw=0, label="half-power band")
    axes.plot(f, per_volt, color=style.BLUE, label="solved plate, all modes")
    own = result.working.frequency / 1e3
    named = f"mode {result.working.label} extrapolated, {own:.2f} kHz"
    axes.axvline(own, **style.LANDMARK, label=named)
    axes.set(xlabel="frequency (kHz)", ylabel="amplitude at the antinode (nm/V)")
    axes.set(ylim=(0, None), xlim=(f[0], f[-1]))
    style.legend_below(axes, columns=3, gap=0.2)
    return figure


@style.drawn
def admittance(result: PlateAnalysis) -> Figure:
    """Admittance around the working mode, its parts, and its circle."""
    response = result.response
    f, Y = response.frequencies / 1e3, 1e3 * response.admittance
    top = int(np.argmax(Y.real))
    figure = style.new_figure(
        f"Admittance: {np.abs(Y[top]):.3g} mS at {f[top]:.2f} kHz, where its real part is largest",
        f"{response.method}; truncation {response.truncation_error:.1g} of the admittance",
        4.6,
    )
    left, right = figure.subplots(1, 2, width_ratios=[1.5, 1])
    left.plot(f, np.abs(Y), color=style.BLUE, label="|Y|")
    left.plot(f, Y.real, color=style.ORANGE, ls="--", label="Re Y (conductance)")
    left.plot(f, Y.imag, color=style.GREEN, ls=style.LINES[2][1], label="Im Y (susceptance)")
    left.axhline(0, **style.ZERO)
    left.set(xlabel="frequency (kHz)", ylabel="admittance (mS)", xlim=(f[0], f[-1]))
    style.legend_below(left, columns=3, gap=0.18)
    right.plot(Y.real, Y.imag, color=style.BLUE)
    right.plot(Y.real[top], Y.imag[top], "o", color=style.ORANGE, ms=6, label=f"{f[top]:.2f} kHz")
    right.set(xlabel="Re Y (mS)", ylabel="Im Y (mS)", aspect="equal", xlim=(0, None))
    right.margins(0.08)
    style.legend_below(right, gap=0.18)
    return figure


PLATE_FIGURES = (
    FigureOf("plan", "Mode shape from above", plan_view, file="mode-plan"),
    FigureOf("scan", "Line scan along the plate", line_scan, file="line-scan"),
    FigureOf("response", "Frequency response", frequency_response, file="frequency-response"),
    FigureOf("admittance", "Admittance", admittance),
)
"""The figures of every rectangular plate."""
