"""Power by simulation: against an exact power, at the level under the null, resumable."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats
from tests.known_observers import (
    DirichletParticipants,
    distinction,
    even_errors,
    ordered_observer,
)

from squeezefilm.core.errors import InputError
from squeezefilm.study.identification.power import above_0, distinction_scores, power_curve


def _binomial(counts: np.ndarray) -> float:
    right, trials = int(np.trace(counts.sum(axis=0))), int(counts.sum())
    return float(stats.binom.sf(right - 1, trials, 0.2))


@pytest.mark.slow
def test_power_of_the_binomial_test_is_exact() -> None:
    """With people all alike the right answers are binomial, and power is a sum."""
    people = DirichletParticipants(even_errors(0.35), 1, 1e9)
    found = power_curve(people, _binomial, (4, 8, 16), studies=2000)
    for n, low, high in zip(found.participants, found.low, found.high, strict=True):
        trials = 5 * int(n)
        critical = next(k for k in range(trials + 2) if stats.binom.sf(k - 1, trials, 0.2) < 0.05)
        exact = stats.binom.sf(critical - 1, trials, 0.35)
        # Bounds of 95 % are doubled: three comparisons must hold at once.
        assert low - (high - low) / 2 < exact < high + (high - low) / 2
    assert np.all(np.diff(found.power) > 0)


def test_dirichlet_participants_have_mean_and_overdispersion() -> None:
    simulate = DirichletParticipants(ordered_observer(1.0), 10, 4.0)
    counts = simulate(20_000, np.random.default_rng(0))
    assert counts.sum(axis=1).tolist() == [[10] * 5] * 20_000
    p = ordered_observer(1.0)[1, 1]
    assert counts[:, 1, 1].mean() == pytest.approx(10 * p, abs=0.06)
    beta_binomial = stats.betabinom(10, 4 * p, 4 * (1 - p)).var()
    assert counts[:, 1, 1].var() == pytest.approx(beta_binomial, rel=0.03)


@pytest.mark.slow
@pytest.mark.parametrize("preference", [0.2, 0.7])
def test_stimuli_felt_alike_are_found_different_at_the_level(preference: float) -> None:
    """5 % of 2000 studies, give or take 3 standard errors, whatever answer is preferred."""
    rest = (1 - preference) / 2
    same = np.array([[preference] * 3, [rest] * 3, [rest] * 3])
    found = power_curve(
        DirichletParticipants(same, 4, 1e9), lambda n: distinction(n, 1, 2), (12,),
        studies=2000,
    )  # fmt: skip
    assert found.power[0] == pytest.approx(0.05, abs=3 * np.sqrt(0.05 * 0.95 / 2000) + 0.005)


def test_distinction_by_hand() -> None:
    one, other = np.array([[3, 1], [1, 3]]), np.array([[2, 2], [2, 2]])
    scores = distinction_scores(np.array([one, other]), 0, 1)
    assert scores.tolist() == [1.0, 0.0]
    # t = 0.5/(0.7071/√2) = 1.
    assert above_0(scores) == pytest.approx(0.25)
    assert distinction(np.array([other, other]), 0, 1) == 1.0
    assert distinction(np.array([one, one]), 0, 1) == 0.0


@pytest.mark.slow
def test_how_many_people_for_8_against_10_mm() -> None:
    people = DirichletParticipants(ordered_observer(1.2), 3, 20.0)
    found = power_curve(people, lambda n: distinction(n, 3, 4), studies=300)
    assert found.needed in found.participants
    assert found.needed is not None
    assert found.needed_surely is None or found.needed_surely >= found.needed
    reached = found.power[found.participants >= found.needed]
    assert np.all(reached >= 0.8)
    before = found.power[found.participants < found.needed]
    assert before.size == 0 or before[-1] < 0.8


def test_a_curve_is_the_same_in_pieces() -> None:
    people = DirichletParticipants(ordered_observer(1.0), 2, 10.0)
    said: list[tuple[int, int]] = []
    whole = power_curve(
        people, lambda counts: distinction(counts, 3, 4), (12, 4, 8), studies=50,
        progress=lambda done, of: said.append((done, of)),
    )  # fmt: skip
    part = power_curve(people, lambda counts: distinction(counts, 3, 4), (8,), studies=50)
    assert part.power[0] == whole.power[1]
    assert said == [(1, 3), (2, 3), (3, 3)]


def test_what_cannot_be_simulated_is_refused() -> None:
    people = DirichletParticipants(even_errors(0.4), 1, 10.0)
    with pytest.raises(InputError, match="at least 10 studies"):
        power_curve(people, _binomial, (4,), studies=5)
    with pytest.raises(InputError, match="p value of 0 to 1"):
        power_curve(people, lambda _: 2.0, (4,), studies=10)
    with pytest.raises(InputError, match="two different ones"):
        distinction(people(4, np.random.default_rng(0)), 3, 3)
