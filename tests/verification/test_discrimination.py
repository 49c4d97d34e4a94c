"""d′ against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.special import ndtr, ndtri
from tests.task_models import differencing_rate

from squeezefilm.core.errors import InputError
from squeezefilm.study.psychometric.discrimination import (
    corrected_proportion,
    differencing_d_prime,
    sensitivity,
    two_interval_d_prime,
    yes_no_d_prime,
)


@pytest.mark.parametrize("correct", [0.55, 0.76, 0.95])
def test_two_interval_d_prime_is_root_two_z(correct: float) -> None:
    closed = math.sqrt(2) * float(ndtri(correct))
    assert two_interval_d_prime(correct, 1 - correct) == pytest.approx(closed)


def test_yes_no_moves_the_criterion_and_keeps_d_prime() -> None:
    for c in (-0.5, 0.0, 0.8):
        found = yes_no_d_prime(float(ndtr(0.7 - c)), float(ndtr(-0.7 - c)))
        assert found == pytest.approx(1.4)


@pytest.mark.parametrize("d_prime", [0.3, 1.0, 2.5])
@pytest.mark.parametrize("criterion", [0.4, 1.5])
def test_differencing_undoes_its_rates(d_prime: float, criterion: float) -> None:
    rates = (differencing_rate(d, criterion) for d in (d_prime, 0.0))
    found = differencing_d_prime(*rates)
    assert found == pytest.approx(d_prime, abs=1e-9)


def test_the_differencing_model_is_what_percepts_do() -> None:
    # Percepts drawn, decisions made: the observer of the model, not its formula.
    random = np.random.default_rng(1)
    n, d = 400_000, 1.6
    noise = random.standard_normal((2, 2, n))
    # Differencing: pairs (s, s) and (s, s + d), "different" where |difference| > k.
    k = 1.1
    far = np.abs(noise[0, 0] - noise[0, 1] - d) > k
    near = np.abs(noise[1, 0] - noise[1, 1]) > k
    found = differencing_d_prime(float(far.mean()), float(near.mean()))
    assert found == pytest.approx(d, abs=0.02)


def test_hits_no_more_than_false_alarms_have_no_d_prime() -> None:
    assert differencing_d_prime(0.3, 0.3) == 0


def test_counts_of_all_or_none_have_a_finite_d_prime() -> None:
    assert corrected_proportion(20, 20) == pytest.approx(20.5 / 21)
    found = sensitivity(20, 20, 0, 20, "yes-no", seed=1)
    assert math.isfinite(found.high)
    assert found.low < found.value < found.high
    with pytest.raises(InputError, match="hit_rate = 1"):
        yes_no_d_prime(1.0, 0.2)


@pytest.mark.slow
def test_intervals_of_d_prime_cover() -> None:
    random, held = np.random.default_rng(2), 0
    hit, false = float(ndtr(0.9)), float(ndtr(-0.5))
    runs = 200
    for seed in range(runs):
        found = sensitivity(
            int(random.binomial(60, hit)), 60, int(random.binomial(60, false)), 60,
            "yes-no", draws=399, seed=seed,
        )  # fmt: skip
        held += found.low <= 1.4 <= found.high
    assert held / runs == pytest.approx(0.95, abs=4 * math.sqrt(0.95 * 0.05 / runs))
