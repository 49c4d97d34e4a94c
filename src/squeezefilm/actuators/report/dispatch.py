"""The analysis and the report that go with an actuator's kind."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from squeezefilm.actuators.analysis import motor, skin_stretch
from squeezefilm.actuators.described import load_actuator
from squeezefilm.actuators.motor.description import MotorDescription
from squeezefilm.actuators.report.motor import show_motor, write_motor
from squeezefilm.actuators.report.skin_stretch import show_skin_stretch, write_skin_stretch
from squeezefilm.core import quantities as si
from squeezefilm.core.progress import SayProgress


class AnalyzedActuator(NamedTuple):
    """An actuator's analysis, what prints it and what writes its page."""

    analysis: motor.MotorAnalysis | skin_stretch.SkinStretchAnalysis
    show: Callable[[Any], None]
    write: Callable[[Any, Path], Path]


def analyze_actuator(
    target: str | Path, voltage: si.Volt | None = None, progress: SayProgress | None = None
) -> AnalyzedActuator:
    """Analyse a motor or an array, by a preset's name or the path of its file, at a voltage (V,
    zero-to-peak; its own if None). Raises what `load_actuator` and the kind's analysis raise.
    """
    described = load_actuator(target)
    if isinstance(described, MotorDescription):
        of_motor = motor.analyze_motor(described, voltage=voltage, progress=progress)
        return AnalyzedActuator(of_motor, show_motor, write_motor)
    of_array = skin_stretch.analyze_skin_stretch(described, voltage=voltage, progress=progress)
    return AnalyzedActuator(of_array, show_skin_stretch, write_skin_stretch)
