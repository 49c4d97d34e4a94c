"""d′ of ordered stimuli: its intervals, its test, and what has none."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats
from tests.known_observers import ordered_observer

from squeezefilm.core.errors import InputError
from squeezefilm.study.identification.sensitivity import ordered_sensitivity

COUNTS = np.array([[40, 11, 2], [9, 30, 12], [3, 12, 41]])


def test_one_matrix_has_normal_intervals_of_its_level() -> None:
    found = ordered_sensitivity(COUNTS, level=0.9)
    z = stats.norm.ppf(0.95)
    assert found.low == pytest.approx(found.d_prime - z * found.standard_error)
    assert found.high == pytest.approx(found.d_prime + z * found.standard_error)
    assert (found.level, found.interval_method) == (0.9, "Fisher information")
    assert found.total == pytest.approx(found.d_prime.sum())
    assert found.d_prime == pytest.approx(np.diff(found.positions))
    # A person's own matrix is the same as one of a stack.
    stacked = ordered_sensitivity(COUNTS[None], level=0.9)
    assert stacked.low == pytest.approx(found.low)
    assert stacked.interval_method == "Fisher information"


def test_the_deviance_is_twice_what_the_shares_are_likelier() -> None:
    found = ordered_sensitivity(COUNTS)
    share = COUNTS / COUNTS.sum(axis=0)
    saturated = float((COUNTS * np.log(share)).sum())
    own = float((COUNTS * np.log(found.probabilities)).sum())
    assert found.log_likelihood == pytest.approx(own)
    assert found.deviance == pytest.approx(2 * (saturated - own), abs=1e-9)
    # Three columns of two free shares, less two criteria and two positions.
    assert found.degrees_of_freedom == 2
    assert found.p_value == pytest.approx(stats.chi2.sf(found.deviance, 2))
    assert found.probabilities.sum(axis=0) == pytest.approx([1, 1, 1])


def test_the_fit_is_the_likeliest() -> None:
    found = ordered_sensitivity(COUNTS)

    def likelihood(criteria: np.ndarray, positions: np.ndarray) -> float:
        edges = np.concatenate([[-np.inf], criteria, [np.inf]])
        return float((COUNTS * np.log(np.diff(stats.norm.cdf(edges[:, None] - positions),
                                              axis=0))).sum())  # fmt: skip

    top = likelihood(found.criteria, found.positions)
    assert top == pytest.approx(found.log_likelihood)
    for at in range(2):
        for step in (-1e-2, 1e-2):
            moved = step * np.eye(3)[at + 1]
            assert likelihood(found.criteria, found.positions + moved) < top
            assert likelihood(found.criteria + step * np.eye(2)[at], found.positions) < top


def test_the_stimuli_turned_round_turn_the_axis() -> None:
    one, other = ordered_sensitivity(COUNTS), ordered_sensitivity(COUNTS[::-1, ::-1])
    assert other.d_prime == pytest.approx(one.d_prime[::-1], abs=1e-6)
    assert other.standard_error == pytest.approx(one.standard_error[::-1], rel=1e-5)
    assert other.deviance == pytest.approx(one.deviance, abs=1e-8)


def test_people_are_resampled_and_their_interval_lies_around_the_estimate() -> None:
    random = np.random.default_rng(2)
    people = np.stack(
        [random.multinomial(12, p, size=8) for p in ordered_observer(1.2)[:, :3].T], axis=-1
    )
    found = ordered_sensitivity(people, resamples=60, seed=1)
    assert found.interval_method == "participant bootstrap, recentred"
    assert found.d_prime == pytest.approx(ordered_sensitivity(people.sum(axis=0)).d_prime)
    assert np.all(found.low < found.d_prime)
    assert np.all(found.d_prime < found.high)
    again = ordered_sensitivity(people, resamples=60, seed=1)
    assert np.array_equal(found.low, again.low)
    assert not np.array_equal(found.low, ordered_sensitivity(people, resamples=60, seed=2).low)


def test_people_who_never_confuse_have_corrected_resamples_too() -> None:
    # With these few a resample may have no confusion of two stimuli that the whole has.
    people = np.array([np.diag([3, 3, 3])] * 3 + [[[2, 0, 0], [1, 2, 1], [0, 1, 2]]])
    found = ordered_sensitivity(people, resamples=40, seed=3)
    assert np.all(np.isfinite(found.low))
    assert np.all(np.isfinite(found.high))
    whole = ordered_sensitivity(np.array([np.diag([3, 3])] * 4), resamples=20)
    assert whole.corrected
    assert math.isnan(whole.p_value)
    # Everybody is alike: the resamples are all the same, and the interval has no width.
    assert whole.low == pytest.approx(whole.d_prime)
    assert whole.high == pytest.approx(whole.d_prime)


@pytest.mark.parametrize(
    ("counts", "says"),
    [
        ([[3, 4]], "1 answers to 2 stimuli have no d′"),
        ([[3], [4]], "2 answers to 1 stimuli have no d′"),
        ([[3, 0], [2, 0]], "trials of every stimulus"),
        ([[3, 3], [0, 0]], "one and the same"),
    ],
)
def test_counts_without_a_d_prime_are_refused(counts: list[list[int]], says: str) -> None:
    with pytest.raises(InputError, match=says):
        ordered_sensitivity(counts)


@pytest.mark.parametrize("level", [0.0, 1.0])
def test_a_level_is_between_none_and_all(level: float) -> None:
    with pytest.raises(InputError, match="level"):
        ordered_sensitivity(COUNTS, level=level)
