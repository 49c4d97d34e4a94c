"""The analysis and the report that go with an actuator, by the table of its file: of a kind `motor`
the functions `analyze_motor`, `show_motor` and `write_motor` of modules of that name."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

from squeezefilm.actuators.described import KINDS, load_actuator
from squeezefilm.actuators.report.page import ActuatorAnalysis
from squeezefilm.core import quantities as si
from squeezefilm.core.progress import SayProgress


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
    # A kind is named alike wherever it is: as the table of its file.
    kind = next(one for one in KINDS if hasattr(described, one))
    analysis = import_module(f"squeezefilm.actuators.analysis.{kind}")
    report = import_module(f"squeezefilm.actuators.report.{kind}")
    found = getattr(analysis, f"analyze_{kind}")(described, voltage=voltage, progress=progress)
    return AnalyzedActuator(
        found, getattr(report, f"show_{kind}"), getattr(report, f"write_{kind}")
    )
