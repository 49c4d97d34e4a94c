"""Rows and figures of a motor, for the terminal and the page."""

from __future__ import annotations

import functools
from operator import attrgetter
from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.actuators.analysis.drawn import with_interval
from squeezefilm.actuators.analysis.motor import MotorAnalysis
from squeezefilm.core.kit import style
from squeezefilm.core.kit.numbers import HZ, SPEED, M, N, Row, V, W, shown
from squeezefilm.core.kit.page_style import FigureOf

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOTOR_ANSWERS = {"stall_force_N": "stall force", "no_load_speed_m_per_s": "speed without a load"}


def motor_rows(analysis: MotorAnalysis) -> list[Row]:
    """The key numbers: quantity, value, remark."""
    motor, best = analysis.motor, analysis.best
    mode, described = motor.modes[0].working, motor.motor
    kept = analysis.rest.amplitude / analysis.free_amplitude
    efficiency, preload, amplitude = analysis.best_of_map
    sure = functools.partial(with_interval, analysis.drawn)
    plane = []
    if analysis.plane is not None:
        along, sideways = analysis.plane.final_velocity.tolist()
        plane = [
            (
                "Free in the plane",
                f"{shown(along, SPEED, 3)}, {shown(sideways, SPEED, 3)}",
                "along and sideways, both plates at the voltage, without a load, in time",
            )
        ]
    return [
        (
            "Stall force",
            sure(analysis.stall_force, "stall_force_N", N),
            "the load that just stops the slider",
        ),
        ("Speed without a load", sure(analysis.no_load_speed, "no_load_speed_m_per_s", SPEED), ""),
        *plane,
        (
            "Best efficiency",
            f"{100 * best.efficiency:.2g} %",
            f"at {shown(best.speed, SPEED, 3)} against {shown(best.force, N, 3)}: "
            f"{shown(best.output, W, 3)} out of {shown(analysis.input_power, W, 3)}, of which "
            f"{shown(best.plate_loss, W, 3)} are lost in the plate",
        ),
        (
            "Best of the map",
            f"{100 * efficiency:.2g} %",
            f"under {shown(preload, N, 3)} at {shown(amplitude, M, 3)}, of what was looked at",
        ),
        (
            "The same in time",
            shown(analysis.motion.thrust, N, 3),
            f"of thrust, where the mean over a period gives {shown(best.thrust, N, 3)}",
        ),
        (
            "Held without a voltage",
            shown(motor.quiescent_force, N, 3),
            f"by friction under a preload of {shown(described.cradle.preload, N, 3)}",
        ),
        (
            "Amplitude",
            shown(analysis.rest.amplitude, M, 3),
            f"zero to peak, under the slider: {100 * kept:.0f} % of that without it",
        ),
        (
            "Feet in contact",
            f"{100 * analysis.rest.contact_share:.0f} %",
            "of each period, at rest",
        ),
        (
            "Drive",
            shown(analysis.voltage, V, 3),
            f"at {shown(mode.resonance_frequency, HZ, 5)}, Q {mode.quality_factor:.3g}; the "
            f"ceramic bears {shown(motor.highest_voltage, V, 3)}",
        ),
    ]


@style.drawn
def speed_force_figure(analysis: MotorAnalysis) -> Figure:
    """Speed and efficiency over the force, from rest to no load: the averaged motor, and the speeds
    and forces of the one resolved in time."""
    curve, resolved = analysis.curve, analysis.resolved
    figure = style.new_figure(
        f"Stalls at {curve[0].force:.3g} N, runs {1e3 * curve[-1].speed:.3g} mm/s without a load",
        "line: averaged; crosses: resolved in time, the slider moved at that speed",
        4.0,
    )
    left, right = figure.subplots(1, 2)
    force = [point.force for point in curve]
    left.plot(force, [1e3 * point.speed for point in curve], color=style.BLUE)
    left.plot(resolved[:, 1], 1e3 * resolved[:, 0], "x", color=style.ORANGE, ms=8)
    left.set(xlabel="force on the load (N)", ylabel="speed (mm/s)")
    right.plot(force, [100 * point.efficiency for point in curve], color=style.BLUE)
    right.set(xlabel="force on the load (N)", ylabel="efficiency (%)")
    return figure


@style.drawn
def force_step_figure(analysis: MotorAnalysis) -> Figure:
    """A commanded force and what came of it, and the voltage that the law took."""
    tracked = analysis.tracked
    assert tracked is not None, "no force was commanded"
    error = 100 * (tracked.force[-1] / tracked.wanted[-1] - 1)
    figure = style.new_figure(
        f"The force law ends {abs(error):.2g} % from the force that is wanted",
        "the slider moved at the best load's speed; each point a mean over one step of the law",
        4.0,
    )
    left, right = figure.subplots(1, 2)
    # At first the plate swings up and the law finds its way; that is no answer to a step.
    seen = slice(tracked.time.size // 3, None)
    time = 1e3 * tracked.time[seen]
    left.step(time, tracked.wanted[seen], where="pre", color="black", label="wanted")
    left.plot(time, tracked.force[seen], color=style.BLUE, label="in time")
    left.set(xlabel="time (ms)", ylabel="force (N)")
    style.legend_below(left, columns=2)
    right.step(time, tracked.voltage[seen], where="pre", color=style.ORANGE)
    right.set(xlabel="time (ms)", ylabel="voltage (V)")
    return figure


@style.drawn
def map_figure(analysis: MotorAnalysis) -> Figure:
    """Stall force, no-load speed and efficiency over preload and amplitude, white where it stalls;
    a mark at the preload and amplitude that the motor has."""
    grid, preload = analysis.map, analysis.motor.motor.cradle.preload
    figure = style.new_figure(
        "Preload and amplitude",
        "averaged model; white: the feet never leave, the motor stalls; mark: the motor as it is",
        3.6,
    )
    x, y = 1e6 * grid.amplitude, grid.preload
    for axes, values, label in zip(
        figure.subplots(1, 3, sharey=True),
        (grid.stall_force, 1e3 * grid.no_load_speed, 100 * grid.efficiency),
        ("stall force (N)", "no-load speed (mm/s)", "best efficiency (%)"),
        strict=True,
    ):
        drawn = axes.pcolormesh(x, y, np.ma.masked_invalid(values), shading="nearest")
        figure.colorbar(drawn, ax=axes)
        axes.set_title(label, fontsize="medium")
        style.mark(axes, 1e6 * analysis.rest.amplitude, preload, 6)
        axes.set(xlabel="amplitude (µm)", yscale="log")
    figure.axes[0].set_ylabel("preload (N)")
    return figure


@style.drawn
def plane_figure(analysis: MotorAnalysis) -> Figure:
    """The way and the velocity of a slider that is free in the plane, from rest on."""
    motion = analysis.plane
    assert motion is not None, "it was not asked for"
    along, sideways = motion.final_velocity.tolist()
    figure = style.new_figure(
        f"Free in the plane it ends at {1e3 * along:.3g} mm/s along and {1e3 * sideways:.3g} mm/s "
        "sideways",
        motion.model,
        4.0,
    )
    left, right = figure.subplots(1, 2)
    path = 1e6 * motion.path
    left.plot(path[:, 0], path[:, 1], color=style.BLUE, lw=1)
    left.plot(*path[-1], "o", color=style.ORANGE)
    left.set(xlabel="along (µm)", ylabel="sideways (µm)")
    for k, (name, colour) in enumerate((("along", style.BLUE), ("sideways", style.ORANGE))):
        velocity = 1e3 * motion.period_velocity[:, k]
        right.plot(1e3 * motion.time, velocity, color=colour, lw=1, label=name)
    right.set(xlabel="time (ms)", ylabel="velocity (mm/s)")
    style.legend_below(right, columns=2)
    return figure


@style.drawn
def tuning_figure(analysis: MotorAnalysis) -> Figure:
    """The force at rest over the frequency of the drive (with the resonance without a slider), and
    over the shift of all feet along the wave."""
    motors, resonance = analysis.tuned, analysis.motor.resonance_frequency
    shifts, shifted = analysis.shifts, analysis.shifted
    figure = style.new_figure(
        "The force at rest by the frequency of the drive, and by the place of the feet",
        "averaged; left at the voltage, right at the amplitude that the motor has; gaps: nodes",
        4.0,
    )
    left, right = figure.subplots(1, 2)
    at = [1e-3 * (motor.working.frequency or resonance) for motor in motors]
    left.plot(at, [motor.force for motor in motors], color=style.BLUE)
    left.axvline(1e-3 * resonance, color=style.ORANGE, lw=1, label="resonance without a slider")
    left.set(xlabel="frequency (kHz)", ylabel="force at rest (N)")
    style.legend_below(left)
    forces = [np.nan if motor is None else motor.force for motor in shifted]
    right.plot(1e3 * shifts, forces, color=style.BLUE)
    right.axvline(0.0, color=style.ORANGE, lw=1, label="where they stand")
    right.set(xlabel="shift of the feet along the wave (mm)", ylabel="force at rest (N)")
    style.legend_below(right)
    return figure


MOTOR_FIGURES = (
    FigureOf("speed-force", "Speed against force", speed_force_figure),
    FigureOf("map", "Preload and amplitude", map_figure),
    FigureOf("frequency-and-place", "Frequency, and the place of the feet", tuning_figure),
    FigureOf("plane", "Free in the plane", plane_figure, has=attrgetter("plane")),
    FigureOf(
        "force-step",
        "A force that is commanded",
        force_step_figure,
        has=attrgetter("tracked"),
    ),
)
"""The figures of all that was computed, in the order of the page."""
