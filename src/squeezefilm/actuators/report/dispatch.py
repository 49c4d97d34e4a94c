"""The analysis and the report that go with an actuator's kind."""

from __future__ import annotations

from pathlib import Path

from squeezefilm.actuators.analysis import motor, skin_stretch
from squeezefilm.actuators.described import load_actuator
from squeezefilm.actuators.motor.description import MotorDescription
from squeezefilm.actuators.report.motor import MOTOR_ANSWERS, motor_figures, motor_rows
from squeezefilm.actuators.report.page import AnalyzedActuator
from squeezefilm.actuators.report.skin_stretch import (
    SKIN_STRETCH_ANSWERS,
    skin_stretch_figures,
    skin_stretch_rows,
)
from squeezefilm.core import quantities as si
from squeezefilm.core.progress import SayProgress


def analyze_actuator(
    target: str | Path, voltage: si.Volt | None = None, progress: SayProgress | None = None
) -> AnalyzedActuator:
    """Analyse a motor or an array, by a preset's name or the path of its file, at a voltage (V,
    zero-to-peak; its own if None). Raises what `load_actuator` and the kind's analysis raise.
    """
    described = load_actuator(target)
    if isinstance(described, MotorDescription):
        of_motor = motor.analyze_motor(described, voltage=voltage, progress=progress)
        return AnalyzedActuator(of_motor, motor_rows, motor_figures, MOTOR_ANSWERS)
    of_array = skin_stretch.analyze_skin_stretch(described, voltage=voltage, progress=progress)
    return AnalyzedActuator(of_array, skin_stretch_rows, skin_stretch_figures, SKIN_STRETCH_ANSWERS)
