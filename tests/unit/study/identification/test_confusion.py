"""Confusion matrices, proportions and chance: counted right, refused where they must be."""

from __future__ import annotations

import functools
import itertools
import math
from typing import get_args

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from squeezefilm.core.errors import InputError
from squeezefilm.study.identification.confusion import (
    ConfusionMatrix,
    Method,
    expansion,
    participant_counts,
    participant_interval,
    permutation_test,
    proportion_interval,
    resampled_counts,
)

NAMES = ("a", "b", "c")
WILSON, JEFFREYS, CLOPPER_PEARSON = INTERVALS = [
    functools.partial(proportion_interval, method=method) for method in get_args(Method)
]


def test_an_interval_of_another_name_is_refused() -> None:
    with pytest.raises(InputError, match=r"method = 'jeffreys' is not known.*Jeffreys"):
        proportion_interval(3, 10, method="jeffreys")  # type: ignore[arg-type] # it is wrong


def confusion_matrix(stimulus: list, choice: list) -> ConfusionMatrix:
    _, counts = participant_counts(np.zeros(len(stimulus)), stimulus, choice, 3, 3)
    return ConfusionMatrix(counts[0], NAMES, NAMES)


def test_rows_are_answers_and_columns_stimuli() -> None:
    found = confusion_matrix([0, 0, 1, 2], [1, 0, 1, 1])
    assert found.counts.tolist() == [[1, 0, 0], [1, 1, 1], [0, 0, 0]]
    assert found.percent[:, 0].tolist() == [50, 50, 0]
    assert found.proportion_correct == 0.5
    assert found.chance == pytest.approx(1 / 3)


def test_an_empty_column_has_no_percentages() -> None:
    found = confusion_matrix([0, 1], [0, 1])
    assert np.isnan(found.percent[:, 2]).all()
    assert np.nansum(found.percent) == 200


@given(st.lists(st.tuples(st.integers(0, 4), st.integers(0, 2), st.integers(0, 2)), min_size=1))
def test_counts_of_participants_add_up_in_any_order(
    rows: list[tuple[int, int, int]],
) -> None:
    who, stimulus, choice = (np.array(column) for column in zip(*rows, strict=True))
    names, counts = participant_counts(who, stimulus, choice, 3, 3)
    assert counts.sum() == len(rows)
    assert names.tolist() == sorted(set(who.tolist()))
    whole = np.zeros((3, 3), dtype=int)
    for _, j, i in rows:
        whole[i, j] += 1
    assert np.array_equal(counts.sum(axis=0), whole)
    _, again = participant_counts(who[::-1], stimulus[::-1], choice[::-1], 3, 3)
    assert np.array_equal(again, counts)


@pytest.mark.parametrize(
    ("stimulus", "choice", "said"),
    [
        ([0, 3], [0, 0], "stimulus = 3 is out of range; it must be 0 to 2"),
        ([0, 0], [0, -1], "choice = -1"),
        ([0.5, 0], [0, 0], "whole numbers"),
        ([0], [0, 0], "one value a trial"),
        ([], [], "no trial"),
    ],
)
def test_trials_that_cannot_be_are_refused(stimulus: list, choice: list, said: str) -> None:
    with pytest.raises(InputError, match=said):
        confusion_matrix(stimulus, choice)


@pytest.mark.parametrize("counts", [[[1, -1], [0, 0]], [[0.5, 1], [0, 0]], [[0, 0], [0, 0]]])
def test_counts_that_are_none_are_refused(counts: list) -> None:
    with pytest.raises(InputError):
        ConfusionMatrix(np.array(counts), ("a", "b"), ("a", "b"))


def test_no_right_answers_without_pairs() -> None:
    matrix = ConfusionMatrix(np.ones((2, 3), dtype=int), ("a", "b"), NAMES)
    with pytest.raises(InputError, match="do not pair up"):
        _ = matrix.correct


def test_intervals_against_published_values() -> None:
    # Newcombe 1998, 10.1002/(SICI)1097-0258(19980430)17:8<857::AID-SIM777>3.0.CO;2-E, 81 of 263.
    wilson, exact = WILSON(81, 263), CLOPPER_PEARSON(81, 263)
    assert (wilson.low, wilson.high) == pytest.approx((0.2553, 0.3662), abs=5e-5)
    assert (exact.low, exact.high) == pytest.approx((0.2527, 0.3676), abs=5e-5)
    zero = WILSON(0, 20)
    assert (zero.low, zero.high) == pytest.approx((0.0, 0.1611), abs=5e-5)


@given(st.integers(1, 80), st.floats(0, 1), st.floats(0.5, 0.999))
def test_intervals_hold_the_share_and_mirror(trials: int, share: float, level: float) -> None:
    successes = round(share * trials)
    for interval in INTERVALS:
        found, mirrored = (interval(k, trials, level) for k in (successes, trials - successes))
        assert 0 <= found.low <= successes / trials + 1e-12
        assert successes / trials - 1e-12 <= found.high <= 1
        assert mirrored.low == pytest.approx(1 - found.high, abs=1e-9)
    inner = JEFFREYS(successes, trials, level)
    outer = CLOPPER_PEARSON(successes, trials, level)
    assert outer.low <= inner.low + 1e-12
    assert inner.high <= outer.high + 1e-12


@pytest.mark.slow
@pytest.mark.parametrize("p", [0.2, 0.64, 0.9])
def test_coverage_is_computed_exactly(p: float) -> None:
    weights = stats.binom.pmf(np.arange(61), 60, p)

    def coverage(interval) -> float:  # type: ignore[no-untyped-def]
        return math.fsum(w for k, w in enumerate(weights) if p in interval(k, 60))

    assert coverage(CLOPPER_PEARSON) >= 0.95
    assert 0.92 < coverage(WILSON) < 0.98
    assert 0.92 < coverage(JEFFREYS) < 0.98


def test_permutations_agree_with_all_of_them() -> None:
    # Two trials of each of two stimuli, all right: 2! 2! of 4! orders give that, one in 6.
    assert permutation_test(np.diag([2, 2])[None], 20_000) == pytest.approx(1 / 6, abs=0.01)


def test_a_preference_is_no_skill() -> None:
    always_a = np.array([[[9, 9], [1, 1]]])
    assert permutation_test(always_a, 2000) > 0.5


@pytest.mark.slow
def test_normal_limit_agrees_with_shuffles() -> None:
    random = np.random.default_rng(2)
    counts = random.multinomial(4, [0.26, 0.24, 0.24, 0.26], size=200).reshape(200, 2, 2)
    few = permutation_test(counts, 20_000)
    # One more person, who answers as if by the toss of a coin, changes little.
    many = permutation_test(np.concatenate([counts, np.ones((1, 2, 2), dtype=int)]))
    assert many == pytest.approx(few, abs=0.03)
    assert 0.01 < few < 0.99


def test_moments_of_the_normal_limit_are_exact() -> None:
    """Many copies of one person: the mean and variance over all pairings of his answers."""
    answers, presented = [0, 0, 1, 2, 1], [0, 1, 1, 2, 2]
    right = [
        sum(a == s for a, s in zip(order, presented, strict=True))
        for order in itertools.permutations(answers)
    ]
    one = np.zeros((3, 3), dtype=int)
    np.add.at(one, (answers, presented), 1)
    single = np.array([[[1, 0, 0], [0, 0, 0], [0, 0, 0]]])
    people = np.concatenate([np.tile(one, (300, 1, 1)), np.tile(single, (50, 1, 1))])
    z = (300 * 3 - 0.5 - 300 * np.mean(right)) / math.sqrt(300 * np.var(right))
    # A single trial has a single pairing: it adds to what is found and expected alike.
    assert permutation_test(people) == pytest.approx(stats.norm.sf(z), rel=1e-9)


def test_p_values_of_guessers_are_even() -> None:
    random = np.random.default_rng(4)
    p = [
        permutation_test(random.multinomial(12, [1 / 9] * 9, size=201).reshape(201, 3, 3), 10)
        for _ in range(300)
    ]
    assert stats.kstest(p, "uniform").pvalue > 1e-3


def test_resampled_people_keep_their_trials() -> None:
    counts = np.array([np.diag([3, 0]), np.diag([0, 5])])
    pooled = resampled_counts(counts, 500, 1)
    right = {(int(a), int(b)) for a, b in zip(pooled[:, 0, 0], pooled[:, 1, 1], strict=True)}
    assert right == {(6, 0), (3, 5), (0, 10)}
    with pytest.raises(InputError, match="at least 2"):
        resampled_counts(counts[:1], 10, 0)


def test_few_people_reach_further() -> None:
    assert expansion(3, 0.95) == pytest.approx(math.sqrt(1.5) * 4.302653, rel=1e-6)
    assert expansion(10_000, 0.95) == pytest.approx(1.960, abs=2e-3)


def test_people_who_differ_widen_the_interval() -> None:
    alike = np.tile(np.array([[5, 5], [5, 5]]), (12, 1, 1))
    split = np.array([np.diag([10, 10])] * 6 + [np.diag([10, 10])[::-1]] * 6)
    narrow, wide = participant_interval(alike), participant_interval(split)
    assert narrow.high - narrow.low == 0
    assert wide.high - wide.low > 0.5
    assert participant_interval(split, seed=3) == participant_interval(split, seed=3)


def test_counts_that_do_not_fit_their_names_are_refused() -> None:
    with pytest.raises(InputError, match=r"\(2, 2\) do not fit 3 answers \(rows\) and 2 stimuli"):
        ConfusionMatrix(np.eye(2, dtype=int), NAMES, ("a", "b"))
    for wrong in (np.array([["x", "y"], ["z", "w"]]), np.array([[1.0, np.inf], [0.0, 1.0]])):
        with pytest.raises(InputError, match="some are not numbers"):
            ConfusionMatrix(wrong, ("a", "b"), ("a", "b"))
    with pytest.raises(InputError, match=r"from 0 up; 0\.5 is among them"):
        ConfusionMatrix(np.array([[1.0, 0.5], [2.5, 1.0]]), ("a", "b"), ("a", "b"))


def test_the_first_number_out_of_range_is_named() -> None:
    with pytest.raises(InputError, match="stimulus = -2 is out of range"):
        confusion_matrix([0, -2, 3], [0, 0, 0])
    with pytest.raises(InputError, match="choice = 3 is out of range; it must be 0 to 2"):
        confusion_matrix([0, 1, 2], [0, 3, -1])
    # Nought is a number like others.
    with pytest.raises(InputError, match="choice = 7"):
        confusion_matrix([0, 0], [0, 7])
    assert confusion_matrix([2], [0]).counts[0, 2] == 1


@pytest.mark.parametrize("interval", INTERVALS)
def test_one_trial_has_an_interval_and_none_has_not(interval) -> None:  # type: ignore[no-untyped-def]
    assert interval(0, 1).low == 0.0
    assert interval(1, 1).high == 1.0
    assert 0 < interval(0, 1).high < 1
    for successes, trials in ((0, 0), (-1, 3), (4, 3)):
        with pytest.raises(InputError, match=r"(successes|trials) = .* cannot be used"):
            interval(successes, trials)
    for level in (0.0, 1.0):
        with pytest.raises(InputError, match="level"):
            interval(1, 2, level)


def test_matrices_of_people_are_square_and_shuffled_at_least_once() -> None:
    for wrong in (np.ones((2, 2, 3), dtype=int), np.eye(2, dtype=int)):
        for test in (participant_interval, permutation_test):
            with pytest.raises(InputError, match="no square matrices of participants"):
                test(wrong)
    with pytest.raises(InputError, match="permutations = 0"):
        permutation_test(np.diag([2, 2])[None], 0)
    # The data count as one of the permutations.
    assert permutation_test(np.diag([9, 9])[None], 1) in (0.5, 1.0)
    # With one answer to everything all permutations are alike, and so is the normal limit.
    always = np.array([[[3, 3], [0, 0]]])
    assert permutation_test(always, 20) == 1.0
    assert permutation_test(np.tile(always, (201, 1, 1))) == 1.0
    for level in (0.0, 1.0):
        with pytest.raises(InputError, match="level"):
            participant_interval(np.tile(always, (3, 1, 1)), level)


def test_resamples_are_as_many_as_asked_for() -> None:
    counts = np.array([np.diag([3, 0]), np.diag([0, 5]), np.diag([1, 1])])
    whole = resampled_counts(counts, 7, 4)
    assert whole.shape == (7, 2, 2)
    # Who are all alike stay so.
    many = resampled_counts(np.tile(np.diag([1, 2]), (300, 1, 1)), 5, 1)
    assert np.array_equal(many, np.tile(np.diag([300, 600]), (5, 1, 1)))
    assert len(resampled_counts(counts, 1, 4)) == 1
    assert np.array_equal(resampled_counts(counts, 1, 4)[0], whole[0])
    with pytest.raises(InputError, match="resamples = 0"):
        resampled_counts(counts, 0, 4)
    with pytest.raises(InputError, match="fewer than 2 participants"):
        resampled_counts(np.eye(2, dtype=int), 3, 4)
