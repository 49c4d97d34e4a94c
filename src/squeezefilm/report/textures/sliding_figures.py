"""Figures of a sliding finger: its tangential force, where it sticks, how its skin vibrates."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.report.kit import style
from squeezefilm.report.kit.numbers import HZ, M, N, shown

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squeezefilm.chain.stroke_force import StrokeForce
    from squeezefilm.contact.sliding.skin_vibration import SkinVibration

_PERIODS_SHOWN = 6
_MOST_POINTS = 4000
# Densities so far below the highest are the window's own floor.
_FLOOR = 3e-5


@style.drawn
def tangential_force(force: StrokeForce) -> Figure:
    """The tangential force of a stroke over a grating, with sticking shaded, and skin spectrum.

    Raises:
        InputError: a texture without a spatial period, or a stroke too short for a spectrum.
    """
    vibration = force.vibration()
    motion, stroke = force.motion, force.trace.stroke
    frequency = shown(vibration.fundamental, HZ, 3)
    settled = motion.time >= force.settled
    swing = float(np.ptp(motion.bone_force[settled & (motion.time <= stroke.pass_duration)]))
    figure = style.new_figure(
        f"At {1e3 * stroke.speed:g} mm/s the tangential force swings by {shown(swing, N, 2)}, and "
        f"the grating shakes the skin by "
        f"{shown(float(vibration.displacement_amplitude[0]), M, 2)} at {frequency}",
        f"{motion.model}; pad {motion.fingerpad.stiffness:g} N/m, {motion.fingerpad.damping:g} "
        f"N·s/m, {1e3 * motion.fingerpad.mass:g} g (unverified defaults unless given); "
        f"µ = {force.friction_coefficient:g}, normal force {shown(force.normal_force, N, 3)}; "
        f"texture by {force.trace.model}",
        6.6,
    )
    top, bottom = figure.subplots(2, 1, height_ratios=[1.15, 1])
    _draw_force(top, force, force.settled + _PERIODS_SHOWN / vibration.fundamental)
    _draw_spectrum(bottom, vibration)
    return figure


def _draw_force(axes: Axes, force: StrokeForce, end: float) -> None:
    motion = force.motion
    shown_part = np.flatnonzero(motion.time <= end)
    shown_part = shown_part[:: max(1, shown_part.size // _MOST_POINTS)]
    t = 1e3 * motion.time[shown_part]
    axes.fill_between(
        t,
        0,
        1,
        where=motion.sticking[shown_part].tolist(),
        step="post",
        color=style.SKIN,
        lw=0,
        transform=axes.get_xaxis_transform(),
        label="skin sticks",
    )
    axes.plot(
        t,
        motion.friction_force[shown_part],
        color=style.ORANGE,
        lw=1.5,
        ls=(0, (6, 1.6)),
        label="at the surface",
    )
    axes.plot(t, motion.bone_force[shown_part], color=style.BLUE, label="at the bone")
    axes.set(xlabel="time (ms)", ylabel="tangential force (N)", xlim=(0, t[-1]))
    axes.set_title(f"start of the stroke and {_PERIODS_SHOWN} periods")
    style.legend_below(axes, 3, 0.2)


def _draw_spectrum(axes: Axes, vibration: SkinVibration) -> None:
    seen = slice(1, None)  # the first bin is what is left of the drift
    density = 1e6 * np.sqrt(vibration.displacement_psd[seen])
    axes.loglog(vibration.frequency[seen], density, color=style.BLUE, lw=1.4)
    top = float(density.max())
    for k, line in enumerate(vibration.harmonic_frequency):
        amplitude = shown(float(vibration.displacement_amplitude[k]), M, 2)
        axes.axvline(line, color=style.MUTED, lw=0.8, ls=(0, (1.4, 1.2)))
        axes.text(
            1.01 * line,
            2.4 * top,
            amplitude,
            color=style.MUTED,
            fontsize=9,
            rotation=35,
            ha="left",
            va="bottom",
        )
    low, high = 0.4 * vibration.fundamental, 20 * vibration.fundamental
    axes.set(
        xlabel="frequency (Hz)",
        ylabel="skin displacement (µm/√Hz)",
        xlim=(low, high),
        ylim=(_FLOOR * top, 2 * top),
    )
    rungs = np.outer(10.0 ** np.arange(-1, 6), [1, 2, 5]).ravel()
    axes.set_xticks(rungs[(rungs > low) & (rungs < high)])
    style.plain_log(axes.xaxis)
    style.plain_log(axes.yaxis)
    axes.set_title(
        "skin relative to the bone; dotted: the grating's frequency, harmonics, their amplitudes",
        pad=34,
    )
