"""When a device reports: every period, in phase, without a burst after a pause."""

from __future__ import annotations

import pytest

from squeezefilm.instruments.device.machine.playing import LONGEST_REPORT, SHORTEST_REPORT, Reports
from squeezefilm.instruments.device.wire.frames import Reason

TURN = 2**32


def test_none_until_they_begin_and_none_after_a_period_of_zero() -> None:
    reports = Reports()
    assert not reports.take(0)
    assert reports.begin(100, 1000) is Reason.ACCEPTED
    assert reports.begin(200, 0) is Reason.ACCEPTED
    assert reports.period == 0
    assert not any(reports.take(now) for now in (200, 1100, 1200, 5000))


@pytest.mark.parametrize("period", [SHORTEST_REPORT, LONGEST_REPORT])
def test_the_first_is_due_a_period_after_the_beginning(period: int) -> None:
    reports = Reports()
    assert reports.begin(50, period) is Reason.ACCEPTED
    assert reports.due == 50 + period
    assert not reports.take(50 + period - 1)
    assert reports.take(50 + period)
    assert not reports.take(50 + period)
    assert reports.due == 50 + 2 * period


@pytest.mark.parametrize("period", [1, 199, 1_000_000_001, -1000])
def test_other_periods_are_refused_and_change_nothing(period: int) -> None:
    reports = Reports()
    reports.begin(0, 1000)
    assert reports.begin(10, period) is Reason.VALUE
    assert (reports.period, reports.due) == (1000, 1000)


@pytest.mark.parametrize(
    ("now", "due"), [(1000, 2000), (1999, 2000), (2000, 3000), (2001, 3000), (7400, 8000)]
)
def test_a_missed_one_is_not_made_up_and_the_phase_is_kept(now: int, due: int) -> None:
    reports = Reports()
    reports.begin(0, 1000)
    assert reports.take(now)
    assert not reports.take(now)
    assert reports.due == due


def test_they_go_on_where_the_clock_wraps() -> None:
    reports = Reports()
    reports.begin(TURN - 1500, 1000)
    assert reports.due == TURN - 500
    assert reports.take(TURN - 500)
    assert reports.due == 500
    assert not reports.take(TURN - 1)
    assert not reports.take(499)
    assert reports.take(500)
    # Begun so that the first is due only after the wrap.
    reports.begin(TURN - 1, 1000)
    assert reports.due == 999
    assert reports.take(2500)
    assert reports.due == 2999


def test_as_many_as_periods_pass() -> None:
    reports = Reports()
    reports.begin(0, 250)
    assert sum(reports.take(now) for now in range(10, 10_010, 10)) == 10_000 // 250
