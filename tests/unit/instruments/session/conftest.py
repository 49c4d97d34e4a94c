"""A plan that can be played at once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from squeezefilm.instruments.session.loop.plan import LoopPlan
from squeezefilm.physics.render.motion.estimator import LVDT_10_KHZ, MotionEstimator
from squeezefilm.physics.render.program.inverse import FrictionTable
from squeezefilm.physics.render.program.lowering import lower
from squeezefilm.physics.render.resonator.envelope import DrivenEnvelope
from squeezefilm.physics.render.texture.levels import Amplitude
from squeezefilm.physics.render.texture.shapes import SquareWave


@pytest.fixture
def plan_of() -> Callable[..., LoopPlan]:
    """A plan for a square grating of 2 mm, any field replaced."""

    def made(**changes: Any) -> LoopPlan:
        fields: dict[str, Any] = {
            "program": lower(Amplitude(SquareWave(2e-3), 0.1e-6, 0.8e-6), largest_amplitude=2e-6),
            "rate": 5e3,
            "envelope": DrivenEnvelope(0.5e-3, 0.7e-3, 1e-6),
            "amplitude_per_volt": 1e-8,
            "estimator": MotionEstimator.for_sensor(LVDT_10_KHZ),
            "relative_friction": FrictionTable(
                np.array([0.0, 2e-6]), np.zeros(1), np.array([[1.0, 0.0]]), 0.0
            ),
        }
        return LoopPlan(**{**fields, **changes})

    return made
