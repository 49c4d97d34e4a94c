"""Which analysis and which report go with each kind of actuator."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

from squeezefilm import quantities as si
from squeezefilm.actuators.described import load_actuator
from squeezefilm.progress import SayProgress
from squeezefilm.report.actuators.page import ActuatorAnalysis


class _Kind(NamedTuple):
    """By name, since each loads what it needs: analysis and its function, report and what prints
    and writes."""

    analysis: str
    analyze: str
    report: str
    show: str
    write: str


# By the dataclass that a description is read into.
_KINDS = {
    "MotorDescription": _Kind("motor", "analyze_motor", "motor", "show_motor", "write_motor"),
    "SkinStretchDescription": _Kind(
        "skin_stretch",
        "analyze_skin_stretch",
        "skin_stretch",
        "show_skin_stretch",
        "write_skin_stretch",
    ),
}


class AnalyzedActuator(NamedTuple):
    """An actuator's analysis, what prints it and what writes its page."""

    found: ActuatorAnalysis
    show: Callable[[Any], None]
    write: Callable[[Any, Path], Path]


def analyze_actuator(
    target: str | Path, voltage: si.Volt | None = None, progress: SayProgress | None = None
) -> AnalyzedActuator:
    """The analysis of a motor or an array, by a preset's name or the path of its file, at a voltage
    (V, zero-to-peak; its own if None). Raises what `load_actuator` and the kind's analysis raise.
    """
    described = load_actuator(target)
    kind = _KINDS[type(described).__name__]
    analysis = import_module(f"squeezefilm.analysis.actuators.{kind.analysis}")
    report = import_module(f"squeezefilm.report.actuators.{kind.report}")
    found = getattr(analysis, kind.analyze)(described, voltage=voltage, progress=progress)
    return AnalyzedActuator(found, getattr(report, kind.show), getattr(report, kind.write))
