"""Heat and time on of an output, counted in integers: sums by hand, ends, safe rounding."""

from __future__ import annotations

import pytest

from squeezefilm.instruments.device.machine.limits import MICROVOLTS, MOST, Loads

VOLT = 1_000_000


def test_heat_is_the_square_above_the_rating_times_time() -> None:
    loads = Loads()
    # 3 V for 5 us at a rating of 2 V: (3000² − 2000²) mV² · 5 us.
    loads.count(3 * VOLT, 5, 2 * VOLT, 0)
    assert loads.heat == 25_000_000
    loads.count(3 * VOLT, 2, 2 * VOLT, 0)
    assert loads.heat == 35_000_000
    # Below its rating it cools: 2 V² for 1 us, then to nothing and not beyond.
    loads.count(0, 1, 2 * VOLT, 0)
    assert loads.heat == 31_000_000
    loads.count(0, 1000, 2 * VOLT, 0)
    assert loads.heat == 0


def test_time_on_leaks_by_the_duty() -> None:
    loads = Loads()
    loads.count(1, 10, 0, 250)
    assert loads.used == 7_500
    loads.count(VOLT, 10, VOLT, 1000)
    assert loads.used == 7_500
    loads.count(0, 20, 0, 250)
    assert loads.used == 2_500
    loads.count(0, 11, 0, 250)
    assert loads.used == 0


@pytest.mark.parametrize(
    ("level", "continuous", "rate"),
    [
        (2000, 0, 4), (2001, 0, 9), (1999, 0, 4), (1001, 0, 4), (1000, 0, 1), (1, 0, 1),
        # The rating down: 2.999 mV count as 2.
        (3000, 2999, 5), (3000, 3000, 0), (3001, 3999, 7),
    ],
)  # fmt: skip
def test_levels_are_rounded_up_and_ratings_down(level: int, continuous: int, rate: int) -> None:
    loads = Loads()
    loads.count(level, 7, continuous, 0)
    assert loads.heat == 7 * rate
    assert MICROVOLTS == 1000


def test_sums_saturate_and_can_fall_again() -> None:
    loads = Loads()
    for _ in range(2):
        loads.count(1000 * VOLT, 2**40, 0, 0)
        loads.count(1000 * VOLT, 2**62, 0, 999)
        assert (loads.heat, loads.used) == (MOST, MOST)
    assert MOST == 2**62
    loads.count(0, 1, 3 * VOLT, 1)
    assert (loads.heat, loads.used) == (MOST - 9_000_000, MOST - 1)


def test_a_pause_counts_as_much_in_one_piece_as_in_many() -> None:
    one, many = Loads(10**9, 10**6), Loads(10**9, 10**6)
    one.count(0, 600, VOLT, 100)
    for _ in range(600):
        many.count(0, 1, VOLT, 100)
    assert one == many
    assert (one.heat, one.used) == (10**9 - 600 * 10**6, 10**6 - 60_000)
    one.count(VOLT, 0, 0, 0)
    assert one == many
