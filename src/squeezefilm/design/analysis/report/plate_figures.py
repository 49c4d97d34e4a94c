"""Figures of the vibrating body: how it is built, its mode, its frequency response."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.kit import style
from squeezefilm.core.kit.numbers import HZ, M, V, shown
from squeezefilm.design.analysis.report.layout_figures import drive_strip
from squeezefilm.design.plate.solved import half_power
from squeezefilm.physics.plate.layout import AnnularStator, RectangularPlate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squeezefilm.core.quantities import FloatArray
    from squeezefilm.design.analysis.analyze import Analysis
    from squeezefilm.physics.chain.prediction import Prediction
    from squeezefilm.physics.plate.working_mode import ModeLine, WorkingMode

# More labels than this cannot be told apart on one axis.
_MOST_LABELS = 26


@style.drawn
def mode_shape(analysis: Analysis) -> Figure:
    """The working mode at the working amplitude, with its nodal lines."""
    mode = analysis.prediction.mode
    size = 1e6 * analysis.prediction.vibration_amplitude
    x, w, nodes, title, along = (
        _around_the_ring(analysis) if mode.line is None else _along_the_line(mode, mode.line)
    )
    figure = style.new_figure(title, mode.model, 4.4)
    axes = figure.subplots()
    unit = f"deflection at {shown(analysis.prediction.vibration_amplitude, M, 3)} (µm)"
    # A drive that cancels out leaves rounding errors, no picometre of motion.
    if size < 1e-6:
        size, unit = 1.0, "relative deflection"
    y = size * w
    reach = float(np.max(np.abs(y)))
    for node in nodes:
        axes.axvline(float(node), **style.GUIDE)
    axes.fill_between(x, y, -y, color=style.BAND, lw=0)
    axes.plot(x, y, color=style.BLUE, label="one extreme of the vibration")
    axes.plot(x, -y, color=style.BLUE, lw=1.1, ls=(0, (4, 2)), label="half a period later")
    axes.axhline(0, color=style.INK, lw=0.8)
    bottom = -1.2 * reach
    plate = analysis.display.actuator
    if isinstance(plate, RectangularPlate) and plate.lines_across == "length":
        bottom = drive_strip(axes, plate, reach)
    if len(nodes) >= 4:
        _half_wave_arrow(axes, nodes, 1.14 * reach, mode.half_wavelength)
    margin = 0.01 * float(x[-1])
    axes.set(xlim=(float(x[0]) - margin, float(x[-1]) + margin), ylim=(bottom, 1.45 * reach))
    axes.set(xlabel=along, ylabel=unit)
    axes.grid(visible=False)
    # The strip of ceramics has no deflection to read.
    axes.set_yticks([tick for tick in axes.get_yticks() if abs(tick) <= reach])
    _label_nodes(axes, nodes)
    style.legend_below(axes)
    return figure


class _Drawn(NamedTuple):
    """A mode along a line: places (mm), deflection (1), nodes (mm), the title, the axis' label."""

    place: FloatArray
    deflection: FloatArray
    nodes: FloatArray
    title: str
    along: str


def _along_the_line(mode: WorkingMode, line: ModeLine) -> _Drawn:
    """The mode of a plate or a disc, from end to end."""
    w, nodes = line.deflection, 1e3 * line.nodal_positions
    ends = float(np.max(np.abs([w[0], w[-1]])))
    title = (
        f"{mode.label}: {len(nodes)} nodal lines, λ/2 = "
        f"{shown(mode.half_wavelength, M)}; the free ends move {ends:.2f} times as far as "
        "the lobes between"
    )
    return _Drawn(1e3 * line.position, w, nodes, title, "position across the nodal lines (mm)")


def _around_the_ring(analysis: Analysis) -> _Drawn:
    """The mode of a stator along its mean circumference, three waves of it at most."""
    actuator, half = analysis.display.actuator, analysis.prediction.mode.half_wavelength
    assert isinstance(actuator, AnnularStator), "only a stator has no line along a plate"
    waves = round(2 * math.pi * (actuator.mean_diameter / 2) / (2 * half))
    seen = min(3, waves)
    x = np.linspace(0, 2e3 * half * seen, 1201)
    w, nodes = np.sin(np.pi * x / (1e3 * half)), 1e3 * half * np.arange(2 * seen + 1, dtype=float)
    title = (
        f"{seen} of the {waves} waves around the ring: a nodal line every "
        f"{shown(half, M)}, where the surface stands still"
    )
    along = f"position along the mean circumference (mm), {seen} of {waves} waves"
    return _Drawn(x, w, nodes, title, along)


def _label_nodes(axes: Axes, nodes: FloatArray) -> None:
    """Where the nodal lines are (mm), above the axes; of very many only some."""
    above = axes.secondary_xaxis("top")
    every = math.ceil(len(nodes) / _MOST_LABELS)
    marked = nodes[::every]
    turned = 90 if len(marked) > 14 else 0
    above.set_xticks(marked, [f"{node:.1f}".replace("-", "−") for node in marked], rotation=turned)
    above.set_xlabel("nodal lines at (mm)" + ("" if every == 1 else f", one in {every}"))


def _half_wave_arrow(axes: Axes, nodes: FloatArray, height: float, half: float) -> None:
    middle = len(nodes) // 2
    left, right = float(nodes[middle - 1]), float(nodes[middle])
    axes.annotate(
        "",
        (left, height),
        (right, height),
        arrowprops={"arrowstyle": "<->", "color": style.INK, "lw": 1, "shrinkA": 0, "shrinkB": 0},
    )
    axes.annotate(
        f"λ/2 = {shown(half, M, 4)} in the mean",
        ((left + right) / 2, height),
        (0, 4),
        textcoords="offset points",
        ha="center",
        va="bottom",
        fontsize=9.5,
        bbox={"facecolor": style.PAPER, "edgecolor": "none", "pad": 1.2},
    )


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
    figure = style.new_figure(title, f"{response.model}; without a finger", 4.3)
    axes = figure.subplots()
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
    """What a drive beside the resonance gets of the motion, in words; nothing where it is all.

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
