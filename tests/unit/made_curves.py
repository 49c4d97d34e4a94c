"""An analysis with curves written down by hand, and the words and lines of what is drawn of it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from squeezefilm.design.analysis.curves import FrictionCurve

AMPLITUDE = "vibration amplitude, zero-to-peak (µm)"
GRID = np.linspace(0, 10e-6, 11)
POINT = SimpleNamespace(
    normal_force=0.5, speed=0.08, vibration_amplitude=2e-6, relative_friction=0.8125,
    model="paper2008",
    surface=SimpleNamespace(name="polished"), frequency=40e3,
    mode=SimpleNamespace(half_wavelength=10e-3),
    law=SimpleNamespace(
        by=lambda model: SimpleNamespace(at=lambda amplitude: {"paper2008": 0.25}[model])
    ),
)  # fmt: skip


def curve(surface: str, model: str, slope: float, **reached: float | None) -> FrictionCurve:
    return FrictionCurve(
        surface=surface, roughness=1.5e-6, amplitude=GRID,
        relative_friction=np.clip(1 - slope * GRID / 10e-6, 0, 1), model=model,
        amplitude_for_criterion=reached.get("criterion"),
        zero_friction_amplitude=reached.get("zero"),
    )  # fmt: skip


CURVES = (
    curve("polished", "paper2008", 1.25, criterion=2.4e-6, zero=8e-6),
    curve("rough", "paper2008", 0.5, criterion=6e-6, zero=20e-6),
    curve("polished", "partial-levitation", 0.1),
)


def made(**changes: Any) -> Any:
    parts: dict[str, Any] = {
        "prediction": POINT, "friction_curves": CURVES,
        "own_curve": CURVES[0], "own_curves": CURVES[:2], "uncertainty": None, "band": None,
    }  # fmt: skip
    return SimpleNamespace(**{**parts, **changes})


def point(**changes: Any) -> Any:
    return SimpleNamespace(**{**vars(POINT), **changes})
