"""The clearest rhythm of a run is the first candidate that anything speaks for."""

import math
from typing import Any

import numpy as np
import pytest

from squeezefilm.physics.perception.path_percepts import RunPercept
from squeezefilm.physics.perception.senses import Candidates


@pytest.mark.parametrize(
    ("d_prime", "period", "evidence"),
    [((2.0, -np.inf), 3e-3, 2.0), ((-0.5, -1.0), 3e-3, 0.0), ((-np.inf, -np.inf), math.nan, 0.0)],
)
def test_the_clearest_rhythm_is_the_first(
    d_prime: tuple[float, float], period: float, evidence: float
) -> None:
    candidates = Candidates(np.array([3e-3, 5e-3]), np.array(d_prime))
    percept: Any = type("Percept", (), {"candidates": candidates})
    run = RunPercept(percept, 1, 0.05, 0.1, 0.2, 0.2)
    assert run.clearest_period == pytest.approx(period, nan_ok=True)
    assert run.clearest_d_prime == evidence
