"""The finest grating felt beside the one that survives, with its interval."""

from __future__ import annotations

import pytest

from squeezefilm.design.analysis.felt import EXPLORING_SPEEDS, FeltGratings, felt_gratings
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import load_display
from squeezefilm.physics.render.resonator.envelope import finest_period


@pytest.fixture(scope="module")
def found() -> FeltGratings:
    display = load_display("biet2008-stator")
    felt = felt_gratings(display, predict(display), draws=8)
    assert felt is not None
    return felt


def test_each_speed_has_what_survives_what_is_felt_and_between_what(found: FeltGratings) -> None:
    p = predict("biet2008-stator")
    for one in found.at:
        assert one.survives == pytest.approx(finest_period(one.speed, p.envelope_time_constant))
        assert one.interval is not None
        assert one.felt is not None
        low, _ = one.interval
        assert low is not None
        assert low <= one.felt * 2
        assert one.never is not None
    # A faster finger feels only coarser ones.
    felt = [one.felt for one in found.at]
    assert felt == sorted(felt)  # type: ignore[type-var]
    said = found.summary()
    assert said["draws"] == 8
    assert said["by_speed"][0]["finest_period_survives_m"] == found.at[0].survives


def test_the_speed_that_was_asked_for_stands_by_itself() -> None:
    display = load_display("biet2008-stator")
    found = felt_gratings(display, predict(display, speed=0.15), draws=0)
    assert found is not None
    assert found.here.speed == 0.15
    assert [one.speed for one in found.at] == [*EXPLORING_SPEEDS[:-1], 0.15, EXPLORING_SPEEDS[-1]]
    said = found.summary()
    assert said["finger_speed_m_per_s"] == 0.15
    assert said["finest_period_felt_m"] == found.here.felt
    # Of speeds that are asked for anyway one is the prediction's.
    same = felt_gratings(display, predict(display, speed=EXPLORING_SPEEDS[1]), draws=0)
    assert same is not None
    assert len(same.at) == len(EXPLORING_SPEEDS)


def test_without_draws_or_vibration() -> None:
    display = load_display("biet2008-stator")
    plain = felt_gratings(display, predict(display), draws=0)
    assert plain is not None
    assert (plain.at[0].interval, plain.at[0].never) == (None, None)
    assert plain.why_no_interval == "no draws were asked for"
    assert felt_gratings(display, predict(display, voltage=0.0)) is None
