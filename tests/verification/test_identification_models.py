"""d′ of ordered stimuli and response times recover what made the data."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats
from tests.known_observers import even_errors, ordered_observer

from squeezefilm.core.errors import InputError
from squeezefilm.study.identification.condition_means import response_time_summary
from squeezefilm.study.identification.sensitivity import ordered_sensitivity


def _draw(probabilities: np.ndarray, trials: int, random: np.random.Generator) -> np.ndarray:
    return np.stack([random.multinomial(trials, p) for p in probabilities.T], axis=-1)


# --- d′ ------------------------------------------------------------------------------------------


def test_d_prime_of_two_stimuli_is_the_difference_of_z() -> None:
    found = ordered_sensitivity(np.array([[80, 30], [20, 70]]))
    hit, false = stats.norm.ppf(0.8), stats.norm.ppf(0.3)
    assert found.d_prime == pytest.approx([hit - false], abs=1e-6)
    assert found.criteria == pytest.approx([hit], abs=1e-6)
    assert found.degrees_of_freedom == 0
    assert math.isnan(found.p_value)
    # Gourevitch & Galanter 1967: variance of d′ from those of two proportions.
    error = math.sqrt(
        sum(p * (1 - p) / 100 / stats.norm.pdf(stats.norm.ppf(p)) ** 2 for p in (0.8, 0.3))
    )
    assert found.standard_error == pytest.approx([error], rel=1e-5)


def test_positions_and_criteria_are_recovered_from_exact_shares() -> None:
    positions, criteria = np.array([0.0, 0.7, 2.1, 2.6]), np.array([-0.4, 1.5, 2.2])
    edges = np.concatenate([[-np.inf], criteria, [np.inf]])
    shares = np.diff(stats.norm.cdf(edges[:, None] - positions), axis=0)
    found = ordered_sensitivity(np.rint(1e8 * shares).astype(np.int64))
    assert found.positions == pytest.approx(positions, abs=1e-5)
    assert found.criteria == pytest.approx(criteria, abs=1e-5)
    assert found.total == pytest.approx(2.6, abs=1e-5)
    assert found.probabilities == pytest.approx(shares, abs=1e-6)
    assert not found.corrected


def test_stimuli_that_feel_the_same_have_no_d_prime() -> None:
    found = ordered_sensitivity(np.tile([[10], [30], [20]], (1, 3)))
    assert found.d_prime == pytest.approx([0, 0], abs=1e-8)
    assert found.deviance == pytest.approx(0, abs=1e-8)


def test_d_prime_may_be_negative() -> None:
    assert ordered_sensitivity(np.array([[20, 70], [80, 30]])).d_prime[0] < 0


def test_never_confused_stimuli_are_corrected_and_said_to_be() -> None:
    found = ordered_sensitivity(12 * np.eye(5, dtype=int))
    assert found.corrected
    assert np.all(np.isfinite(found.d_prime))
    assert math.isnan(found.deviance)
    # The log-linear rule by hand for two stimuli: one trial each, spread over two answers.
    two = ordered_sensitivity(np.diag([12, 12]))
    assert two.d_prime == pytest.approx([2 * stats.norm.ppf(12.5 / 13)], abs=1e-6)


def test_errors_without_order_do_not_fit_one_axis() -> None:
    counts = np.rint(400 * even_errors(0.6)).astype(np.int64)
    assert ordered_sensitivity(counts).p_value < 1e-6
    fits = _draw(ordered_observer(1.2), 200, np.random.default_rng(5))
    assert ordered_sensitivity(fits).p_value > 0.01


def test_a_stimulus_without_trials_is_refused() -> None:
    with pytest.raises(InputError, match="every stimulus"):
        ordered_sensitivity(np.array([[3, 0], [2, 0]]))
    with pytest.raises(InputError, match="one and the same"):
        ordered_sensitivity(np.array([[3, 3], [0, 0]]))


def test_an_answer_never_given_is_corrected() -> None:
    # Its criteria fall together: without the correction the information matrix is singular.
    found = ordered_sensitivity(np.array([[1, 1, 0], [0, 0, 0], [0, 1, 1]]))
    assert found.corrected
    assert np.all(np.isfinite(found.standard_error))


def _coverage(spacing: float, trials: int, runs: int) -> float:
    random = np.random.default_rng(5)
    inside = 0.0
    for _ in range(runs):
        found = ordered_sensitivity(_draw(ordered_observer(spacing), trials, random))
        inside += float(np.mean((found.low <= spacing) & (spacing <= found.high)))
    return inside / runs


@pytest.mark.slow
def test_intervals_of_d_prime_cover() -> None:
    # Four d′ a run that are little correlated: a binomial error of 0.6 % at 300 runs.
    assert 0.92 < _coverage(1.5, 60, 300) < 0.975


@pytest.mark.campaign
@pytest.mark.parametrize(("spacing", "trials"), [(1.0, 24), (1.0, 60), (1.5, 24), (1.5, 60),
                                                 (2.0, 60), (2.0, 120)])  # fmt: skip
def test_intervals_of_d_prime_of_2000_observers_cover(spacing: float, trials: int) -> None:
    """Of 2000 observers with so many trials a stimulus, 93.5 to 96.5 % of the intervals hold."""
    assert 0.935 < _coverage(spacing, trials, 2000) < 0.965


@pytest.mark.campaign
@pytest.mark.parametrize(("people", "spacing"), [(12, 1.0), (24, 1.5)])
def test_participant_intervals_of_d_prime_cover(people: int, spacing: float) -> None:
    """People alike with 25 trials each: 93 to 97 % of the bootstrap intervals hold."""
    random = np.random.default_rng(6)
    inside = 0.0
    for seed in range(400):
        counts = np.stack(
            [random.multinomial(5, p, size=people) for p in ordered_observer(spacing).T], axis=-1
        )
        found = ordered_sensitivity(counts, resamples=400, seed=seed)
        assert found.interval_method.startswith("participant")
        inside += float(np.mean((found.low <= spacing) & (spacing <= found.high))) / 400
    assert 0.93 < inside < 0.97


# --- response times ------------------------------------------------------------------------------


def test_summaries_of_times() -> None:
    times = [1.0, 4.0, 2.0, 8.0, float("nan"), 3.0]
    found = response_time_summary([0, 0, 1, 1, 1, 0], [0, 0, 0, 0, 0, 1], times, ("a", "b"))
    a, b = found
    assert (a.trials, a.participants) == (4, 2)
    assert a.geometric_mean == pytest.approx(math.sqrt(2 * 4))
    half = stats.t.isf(0.025, 1) * math.log(2) / 2
    assert math.log(a.high / a.geometric_mean) == pytest.approx(half)
    assert b.participants == 1
    assert math.isnan(b.low)
    with pytest.raises(InputError, match="above 0"):
        response_time_summary([0], [0], [0.0], ("a",))
