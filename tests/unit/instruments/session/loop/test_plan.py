"""What a plan refuses, and what it says of its times."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.instruments.session.loop.plan import LoopPlan, tick_arrays
from squeezefilm.physics.render.program.inverse import FrictionTable

PlanOf = Callable[..., LoopPlan]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"rate": 1.0}, "rate = 1 Hz"),
        ({"rate": 1e6}, "rate = 1 MHz"),
        ({"output_delay": -1e-3}, "output_delay"),
        ({"host_timeout": 0.0}, "host_timeout"),
        ({"compensation": "preview"}, "Allowed: none, inverse"),
        ({"amplitude_per_volt": 0.0}, "amplitude_per_volt = 0 m/V"),
    ],
)
def test_a_plan_refuses_what_it_cannot_do(
    plan_of: PlanOf, changes: dict[str, Any], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        plan_of(**changes)


def test_a_friction_curve_must_be_one() -> None:
    with pytest.raises(InputError, match="must rise"):
        FrictionTable(np.array([0.0, 0.0]), np.zeros(1), np.array([[1.0, 0.5]]), 0.0)
    with pytest.raises(InputError, match="relative_friction"):
        FrictionTable(np.array([0.0, 1.0]), np.zeros(1), np.array([[1.2, 0.5]]), 0.0)


def test_the_lead_is_the_middle_of_the_step_or_compensated_its_end(plan_of: PlanOf) -> None:
    assert plan_of(output_delay=1e-3).lead == pytest.approx(1.1e-3)
    assert plan_of(output_delay=1e-3, compensation="inverse").lead == pytest.approx(1.2e-3)


def test_a_plan_that_was_pickled_makes_the_same_arrays(plan_of: PlanOf) -> None:
    plan = plan_of()
    again = pickle.loads(pickle.dumps(plan))
    for one, other in zip(tick_arrays(plan), tick_arrays(again), strict=True):
        assert np.array_equal(one, other, equal_nan=True)
