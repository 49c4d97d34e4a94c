"""What is perceived on one trial: how often, and how blurred."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from scipy.special import ndtr

from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.physics.perception.percepts import perceived
from squeezefilm.physics.perception.senses import Candidates

OBSERVER = dataclasses.replace(load_observer(), detection_criterion=1.0)
COUNT = 40_000


def seen(period: list[float], d_prime: list[float], skill: float = 1.0):  # type: ignore[no-untyped-def]
    random = np.random.default_rng(1)
    shape = (COUNT, len(period))
    surface = Candidates(np.broadcast_to(period, shape), np.broadcast_to(d_prime, shape))
    return perceived(
        surface,
        OBSERVER,
        np.full(COUNT, skill),
        np.full(COUNT, 0.1),
        random.standard_normal(shape),
        random.standard_normal(COUNT),
    )


@pytest.mark.parametrize("skill", [1.0, 2.0])
def test_one_rhythm_is_felt_as_often_as_its_evidence_passes_the_criterion(skill: float) -> None:
    found = seen([4e-3], [2.0], skill)
    assert found.felt.mean() == pytest.approx(ndtr(1.0 / skill), abs=0.01)
    assert found.strength.mean() == pytest.approx(2.0, abs=0.03)
    wide = 0.1 * skill * math.sqrt(1 + 1 / 4)
    assert found.log_period[found.felt].std() == pytest.approx(wide, rel=0.02)


def test_the_clearer_of_two_is_perceived_more_often() -> None:
    found = seen([4e-3, 2e-3], [3.0, 1.0])
    nearer = np.abs(found.log_period - math.log(4e-3)) < math.log(math.sqrt(2))
    assert nearer.mean() == pytest.approx(ndtr(2.0 / math.sqrt(2)), abs=0.02)


def test_nothing_is_felt_where_there_is_nothing() -> None:
    assert not seen([4e-3], [-np.inf]).felt.any()
