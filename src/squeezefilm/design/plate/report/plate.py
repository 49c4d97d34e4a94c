"""The figures of a solved rectangular plate: its mode, a scan, its response, its admittance."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core.kit import style
from squeezefilm.core.kit.page_style import FigureOf
from squeezefilm.design.plate.solved import half_power
from squeezefilm.physics.plate.elements.nodal_lines import zero_crossings

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squeezefilm.core.quantities import FloatArray
    from squeezefilm.design.plate.command import PlateAnalysis


def driven_shape(result: PlateAnalysis, x: FloatArray, y: FloatArray) -> FloatArray:
    """w per volt (m/V) over the upper face at resonance, at the instant when its largest point
    stands highest; shape (x, y)."""
    w = result.response.motion(result.resonance, x, y)
    phase = w.flat[int(np.argmax(np.abs(w)))]
    return np.asarray((w * np.conj(phase) / np.abs(phase)).real)


@style.drawn
def plan_view(result: PlateAnalysis) -> Figure:
    """The driven shape over the upper face, seen from above, with its nodal lines."""
    plate = result.plate
    x, y = np.linspace(0, plate.length, 166), np.linspace(0, plate.width, 99)
    w = 1e9 * driven_shape(result, x, y)
    reach = float(np.max(np.abs(w)))
    figure = style.new_figure(
        f"Mode {result.working.label} at {result.working.frequency / 1e3:.2f} kHz from above: up "
        f"to {reach:.3g} nm per volt",
        f"{result.modes.model}, all electrodes driven at resonance; nodal lines in black",
        5.2,
    )
    axes = figure.subplots()
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
    figure = style.new_figure(title, model, 4.2)
    axes = figure.subplots()
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
    figure = style.new_figure(
        f"Resonance at {f[at]:.2f} kHz: {per_volt[at]:.3g} nm per volt{wide}",
        f"{response.model}, {response.method}; at the antinode",
        4.2,
    )
    axes = figure.subplots()
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


FIGURES = (
    FigureOf("plan", "Mode shape from above", plan_view, file="mode-plan"),
    FigureOf("scan", "Line scan along the plate", line_scan, file="line-scan"),
    FigureOf("response", "Frequency response", frequency_response, file="frequency-response"),
    FigureOf("admittance", "Admittance", admittance),
)
"""The figures of every rectangular plate."""
