"""Figures of the vibrating body: how it is built, its mode, its frequency response."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.kit import style
from squeezefilm.core.kit.numbers import HZ, M, V, shown
from squeezefilm.design.plate.solved import half_power

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squeezefilm.design.analysis.analyze import Analysis
    from squeezefilm.physics.chain.prediction import Prediction


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
