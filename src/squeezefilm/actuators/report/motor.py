"""What the terminal and the page show of a motor."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import TYPE_CHECKING

from squeezefilm.actuators.analysis.motor import MotorAnalysis
from squeezefilm.actuators.report import motor_figures
from squeezefilm.actuators.report.effect_rows import EFFECTS, effect_head, effect_rows
from squeezefilm.actuators.report.how_sure import drawn_words, how_sure, with_interval
from squeezefilm.actuators.report.page import assumed_words, write_page
from squeezefilm.core.kit.numbers import HZ, SPEED, M, N, Row, V, W, shown
from squeezefilm.core.kit.page_style import section, text_table
from squeezefilm.core.kit.terminal import bullets, show_rows

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_ANSWERS = {"stall_force_N": "stall force", "no_load_speed_m_per_s": "speed without a load"}


def motor_rows(found: MotorAnalysis) -> list[Row]:
    """The key numbers: quantity, value, remark."""
    motor, best = found.motor, found.best
    mode, described = motor.modes[0].working, motor.motor
    kept = found.rest.amplitude / found.free_amplitude
    efficiency, preload, amplitude = found.best_of_map
    sure = functools.partial(with_interval, found.drawn)
    plane = []
    if found.plane is not None:
        along, sideways = found.plane.final_velocity.tolist()
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
            sure(found.stall_force, "stall_force_N", N),
            "the load that just stops the slider",
        ),
        ("Speed without a load", sure(found.no_load_speed, "no_load_speed_m_per_s", SPEED), ""),
        *plane,
        (
            "Best efficiency",
            f"{100 * best.efficiency:.2g} %",
            f"at {shown(best.speed, SPEED, 3)} against {shown(best.force, N, 3)}: "
            f"{shown(best.output, W, 3)} out of {shown(found.input_power, W, 3)}, of which "
            f"{shown(best.plate_loss, W, 3)} are lost in the plate",
        ),
        (
            "Best of the map",
            f"{100 * efficiency:.2g} %",
            f"under {shown(preload, N, 3)} at {shown(amplitude, M, 3)}, of what was looked at",
        ),
        (
            "The same in time",
            shown(found.motion.thrust, N, 3),
            f"of thrust, where the mean over a period gives {shown(best.thrust, N, 3)}",
        ),
        (
            "Held without a voltage",
            shown(motor.quiescent_force, N, 3),
            f"by friction under a preload of {shown(described.cradle.preload, N, 3)}",
        ),
        (
            "Amplitude",
            shown(found.rest.amplitude, M, 3),
            f"zero to peak, under the slider: {100 * kept:.0f} % of that without it",
        ),
        (
            "Feet in contact",
            f"{100 * found.rest.contact_share:.0f} %",
            "of each period, at rest",
        ),
        (
            "Drive",
            shown(found.voltage, V, 3),
            f"at {shown(mode.resonance_frequency, HZ, 5)}, Q {mode.quality_factor:.3g}; the "
            f"ceramic bears {shown(motor.highest_voltage, V, 3)}",
        ),
    ]


def show_motor(found: MotorAnalysis) -> None:
    """Print a motor: key numbers, warnings, and what is assumed."""
    described = found.described
    title = f"{described.title} [{described.name}]"
    console = show_rows(title, motor_rows(found), found.warnings, fixed=(0, 1))
    bullets(console, [("interval", drawn_words(found.drawn), "")])
    bullets(console, [("assumed", assumed_words(described.provenance), "yellow")])


def write_motor(found: MotorAnalysis, folder: Path) -> Path:
    """Write result.json, the figures and report.html into `folder`; the path of the page. Raises
    `InputError` where the folder cannot be written to."""
    nominal = {name: found.summary()[name] for name in _ANSWERS}
    rows = effect_rows(found.effects, nominal, _ANSWERS)
    moved = f"<p>{EFFECTS}</p>" + text_table(
        "Change of the answers, at the lower value; at the higher one", effect_head(_ANSWERS), rows
    )
    return write_page(
        found,
        folder,
        key_numbers=motor_rows(found),
        figures=_figures(found),
        more=how_sure(found.drawn) + section("What each assumed value does", moved),
    )


def _figures(found: MotorAnalysis) -> dict[str, tuple[str, Figure]]:
    feet = found.motor.feet
    figures = {
        "speed-force": (
            "Speed against force",
            motor_figures.speed_force_figure((found.curve, found.resolved)),
        ),
        "map": (
            "Preload and amplitude",
            motor_figures.map_figure(
                (found.map, found.motor.motor.cradle.preload, found.rest.amplitude)
            ),
        ),
        "frequency-and-place": (
            "Frequency, and the place of the feet",
            motor_figures.tuning_figure(found),
        ),
        "foot": (
            "The way of a foot",
            motor_figures.foot_figure((found.motion, feet.across[0], feet.along[0])),
        ),
    }
    if found.plane is not None:
        figures["plane"] = ("Free in the plane", motor_figures.plane_figure(found.plane))
    if found.tracked is not None:
        figures["force-step"] = (
            "A force that is commanded",
            motor_figures.force_step_figure(found.tracked),
        )
    return figures
