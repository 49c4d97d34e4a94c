"""Information transfer: exact cases, known biases, and the bias that is promised."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy import stats
from tests.known_observers import (
    REFERENCE_MATRICES,
    DirichletParticipants,
    even_errors,
    ordered_observer,
    transfer_of,
)

from squeezefilm.core.errors import InputError
from squeezefilm.study.identification.confusion import (
    recentred_interval,
    resampled_counts,
)
from squeezefilm.study.identification.sensitivity import information_transfer, jackknife

TABLES = arrays(np.int64, (4, 3), elements=st.integers(0, 9)).filter(
    lambda n: bool(np.all(n.sum(axis=0) > 1))
)


def test_transfer_of_exact_matrices() -> None:
    assert transfer_of(np.eye(5)) == pytest.approx(math.log2(5))
    assert transfer_of(even_errors(0.2)) == pytest.approx(0, abs=1e-15)
    # A binary symmetric channel: 1 − H(0.9).
    h = -(0.9 * math.log2(0.9) + 0.1 * math.log2(0.1))
    assert transfer_of(even_errors(0.9, 2)) == pytest.approx(1 - h)
    # Evenly spread errors: log2 k − H(p) − (1 − p) log2(k − 1).
    h = -(0.7 * math.log2(0.7) + 0.3 * math.log2(0.3))
    assert transfer_of(even_errors(0.7)) == pytest.approx(math.log2(5) - h - 0.3 * 2)


def test_the_five_matrices_go_from_guessing_to_near_perfect() -> None:
    right = [np.trace(matrix) / 5 for matrix in REFERENCE_MATRICES.values()]
    assert right == pytest.approx([0.2, 0.506, 0.746, 0.893, 0.964], abs=5e-4)
    assert all(np.allclose(m.sum(axis=0), 1) for m in REFERENCE_MATRICES.values())
    # Neighbours one unit apart, cut midway: the first stimulus is named rightly with Φ(1/2).
    assert ordered_observer(1.0)[0, 0] == pytest.approx(stats.norm.cdf(0.5))


def test_the_estimate_is_right_with_many_trials() -> None:
    for matrix in REFERENCE_MATRICES.values():
        counts = np.rint(2e6 * matrix).astype(np.int64)
        true = transfer_of(counts / counts.sum(axis=0))
        assert float(jackknife(counts)) == pytest.approx(true, abs=1e-4)


@settings(settings.get_profile("dear"))
@given(TABLES, st.permutations(range(4)), st.permutations(range(3)))
def test_names_do_not_matter(n: np.ndarray, rows: list[int], columns: list[int]) -> None:
    one, other = jackknife(n), jackknife(n[np.ix_(rows, columns)])
    assert float(one) == pytest.approx(float(other), abs=1e-9)


@settings(settings.get_profile("dear"))
@given(TABLES)
def test_jackknife_is_the_one_by_hand(n: np.ndarray) -> None:
    """Leave out each trial in turn, the stimuli's shares kept."""
    share = n.sum(axis=0) / n.sum()

    def transfer(table: np.ndarray) -> float:
        p = table / table.sum(axis=0)
        answer = p @ share
        log = np.log2(np.where(p > 0, p, 1) / np.where(answer > 0, answer, 1)[:, None])
        return float((share * p * np.where(p > 0, log, 0)).sum())

    whole = transfer(n)
    found = whole
    for i, j in itertools.product(range(4), range(3)):
        if n[i, j]:
            less = n.copy()
            less[i, j] -= 1
            many = n[:, j].sum()
            found += (many - 1) / many * n[i, j] * (whole - transfer(less))
    assert float(jackknife(n)) == pytest.approx(found, abs=1e-9)


def test_jackknife_has_no_value_for_a_single_trial() -> None:
    n = np.array([[1, 4], [0, 4]])
    assert math.isnan(float(jackknife(n)))
    found = information_transfer(np.array([n, n[::-1] * 0 + np.eye(2, dtype=int)]))
    assert math.isfinite(found.estimate)
    assert math.isnan(information_transfer(n).estimate)


def test_the_estimate_works_on_stacks() -> None:
    random = np.random.default_rng(8)
    stack = random.multinomial(40, [1 / 9] * 9, size=(2, 5)).reshape(2, 5, 3, 3)
    found = jackknife(stack)
    assert found.shape == (2, 5)
    assert found[1, 3] == pytest.approx(float(jackknife(stack[1, 3])), abs=1e-12)


def _bias(runs: int, seed: int, surely: float) -> float:
    """The largest bias (bit) on the five matrices at 60 trials, less or more standard errors."""
    random, found = np.random.default_rng(seed), []
    for matrix in REFERENCE_MATRICES.values():
        counts = np.stack([random.multinomial(12, p, size=runs) for p in matrix.T], axis=-1)
        error = jackknife(counts) - transfer_of(matrix)
        found.append(abs(error.mean()) + surely * error.std(ddof=1) / math.sqrt(runs))
    return float(max(found))


def test_bias_of_the_estimate_is_small() -> None:
    """At most 0.05 bit on each of the five matrices at 60 trials, up to two standard errors."""
    assert _bias(1000, 2, -2.0) <= 0.05


@pytest.mark.campaign
def test_bias_of_the_estimate_is_small_beyond_doubt() -> None:
    assert _bias(40_000, 3, 2.0) <= 0.05


@pytest.mark.campaign
@pytest.mark.parametrize("spacing", [1.0, 2.0, 3.0])
def test_participant_intervals_cover(spacing: float) -> None:
    """24 people with 20 trials each, who differ: between 92 and 97 % of 1000 intervals hold."""
    true, random = transfer_of(ordered_observer(spacing)), np.random.default_rng(11)
    people = DirichletParticipants(ordered_observer(spacing), 4, 20.0)
    inside = 0
    for seed in range(1000):
        counts = people(24, random)
        value = float(jackknife(counts.sum(axis=0)))
        again = jackknife(resampled_counts(counts, 300, seed))
        inside += true in recentred_interval(value, again, 24)
    assert 0.92 < inside / 1000 < 0.97


def test_bounds_of_an_interval_are_possible() -> None:
    random = np.random.default_rng(3)
    counts = DirichletParticipants(even_errors(0.2), 2, 10.0)(8, random)
    found = information_transfer(counts, resamples=200)
    assert found.greatest == pytest.approx(math.log2(5))
    assert found.interval is not None
    assert 0 <= found.interval.low <= found.interval.high <= found.greatest


def test_no_trial_is_refused() -> None:
    with pytest.raises(InputError, match="no matrix"):
        information_transfer(np.zeros((2, 2), dtype=int))
