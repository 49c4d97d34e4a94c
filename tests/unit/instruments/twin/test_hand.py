"""The hand between the places it keeps: exact along straight motions, with its ramps of force."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.instruments.twin.hand import Hand, hand_from, wanted
from squeezefilm.physics.render.motion.stroke import FingerPath, Stroke

# No whole number of samples, so that the last one is shorter than the others.
LENGTH = 10_070
LINE = FingerPath(np.array([0.0, LENGTH * 1e-6]), np.array([0.01, 0.05]), np.array([0.03, 0.01]))


def followed(hand: Hand, tick: int = 100) -> Callable[[int], tuple[float, float, float]]:
    places, plan = hand.path(tick)
    return lambda time: wanted(time, places, plan)


def line_at(share: float) -> tuple[float, float]:
    return 0.01 + 0.04 * share, 0.03 - 0.02 * share


def test_the_plan_says_what_the_hand_does_in_microseconds() -> None:
    hand = Hand(LINE, begin=0.2, lift=0.004, press=0.0005)
    places, plan = hand.path(100)
    assert plan.tolist() == [200_000, LENGTH, 4_000, 500, 100, 1]
    assert plan.dtype == np.int64
    # One place for each begun 100 us, and the first.
    assert places.shape == (2, 102)
    np.testing.assert_allclose(places[:, 0], (0.01, 0.03), atol=1e-15)
    np.testing.assert_allclose(places[:, -1], (0.05, 0.01), atol=1e-15)
    np.testing.assert_allclose(places[:, 1], line_at(100 / LENGTH), atol=1e-12)
    assert Hand(LINE).path(100)[1].tolist() == [100_000, LENGTH, 0, 50_000, 100, 1]
    there_and_back = Hand(Stroke(0.1, 0.02, passes=2))
    assert there_and_back.path(100)[1].tolist()[1:] == [400_000, 0, 50_000, 100, 0]
    # A stroke is along x.
    assert np.all(there_and_back.path(100)[0][1] == 0.0)


def test_it_is_on_the_line_at_every_microsecond() -> None:
    at = followed(Hand(LINE, begin=0.0))
    for time in (0, 1, 37, 99, 100, 101, 5_050, 10_000, 10_001, 10_033, LENGTH - 1, LENGTH):
        assert at(time)[:2] == pytest.approx(line_at(time / LENGTH), abs=1e-12), time
        back = at(2 * LENGTH - time)
        assert back[:2] == pytest.approx(line_at(time / LENGTH), abs=1e-12), time
    # And there again, in the third pass.
    assert at(2 * LENGTH + 37)[:2] == pytest.approx(line_at(37 / LENGTH), abs=1e-12)


def test_before_it_begins_it_stays_in_the_air_where_it_will_begin() -> None:
    at = followed(Hand(LINE, begin=0.2, press=0.001))
    for time in (0, 199_999):
        assert at(time) == (pytest.approx(0.01), pytest.approx(0.03), 0.0)
    assert at(200_250)[2] == pytest.approx(0.25)
    assert at(201_000)[2] == at(230_000)[2] == 1.0


def test_it_lifts_at_the_end_of_each_repeat_and_presses_anew() -> None:
    at = followed(Hand(LINE, begin=0.0, lift=0.005, press=0.001))
    cycle = LENGTH + 5_000
    for begun in (0, cycle, 2 * cycle):
        assert at(begun + 400)[2] == pytest.approx(0.4)
        assert at(begun + LENGTH // 2)[2] == 1.0
        assert at(begun + LENGTH - 300)[2] == pytest.approx(0.3)
        for up in (LENGTH, LENGTH + 1, cycle - 1):
            assert at(begun + up)[2] == 0.0
    # In the air it waits where the pass ended; the second pass goes back.
    assert at(LENGTH + 2_500)[:2] == pytest.approx((0.05, 0.01))
    assert at(cycle + LENGTH + 2_500)[:2] == pytest.approx((0.01, 0.03))


def test_without_a_lift_it_presses_once_only() -> None:
    at = followed(Hand(LINE, begin=0.0, press=0.001))
    assert [at(k * LENGTH + 10)[2] for k in (1, 2)] == [1.0, 1.0]


def test_a_closed_way_is_gone_round_and_an_open_one_back() -> None:
    time = np.array([0.0, 5e-3, 10e-3])
    nearly = FingerPath(time, np.array([0.0, 0.01, 2e-6]), np.zeros(3))
    closed = FingerPath(time, np.array([0.0, 0.01, 5e-7]), np.zeros(3))
    across = FingerPath(time, np.array([0.0, 0.01, 0.0]), np.array([0.0, 0.0, 0.02]))
    assert [Hand(one).path(100)[1][5] for one in (nearly, closed, across)] == [1, 0, 1]
    at = followed(Hand(closed, begin=0.0))
    assert at(10_000 + 2_500)[0] == pytest.approx(0.005)


def test_a_hand_in_words_takes_the_other_arguments() -> None:
    hand = hand_from("80 mm/s over 60 mm", normal_force=0.7, begin=0.3)
    assert (hand.normal_force, hand.begin) == (0.7, 0.3)
    assert hand.motion.duration == pytest.approx(0.75)
    day = FingerPath(np.array([0.0, 86_401.0]), np.array([0.0, 0.1]), np.zeros(2))
    with pytest.raises(InputError, match="the motion's duration"):
        Hand(day)
