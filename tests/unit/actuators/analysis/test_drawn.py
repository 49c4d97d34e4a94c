"""All uncertain values drawn together: known laws come back, what cannot work is counted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pytest

from squeezefilm.actuators.analysis import motor
from squeezefilm.actuators.analysis.drawn import COUNT, Usual, drawn_answers
from squeezefilm.actuators.described import load_actuator
from squeezefilm.actuators.motor.assembled import Working, assembled
from squeezefilm.actuators.motor.averaged import no_load_speed, stall_force
from squeezefilm.actuators.motor.description import MotorDescription
from squeezefilm.core import quantities as si
from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.distributions import Uniform
from squeezefilm.core.errors import OutOfRangeError
from squeezefilm.core.progress import CountProgress
from squeezefilm.physics.uncertainty.parameters import with_values


@si.checked_numbers
@dataclass(frozen=True)
class Spring:
    """A spring under a force."""

    stiffness: si.NewtonPerMetre
    force: si.Newton


@dataclass(frozen=True)
class Described:
    """What a file describes."""

    spring: Spring


SPRING = Described(Spring(100.0, 2.0))
USUAL = {
    "spring.stiffness": Usual(0.5, 1.5, "a guess"),
    "spring.force": Usual(0.0, 9.0, "not asked for, the file has a range"),
}
GIVEN = {"spring.force": Provenance("a balance", "measured", Uniform(1.0, 3.0))}


def stretch(one: Described) -> Mapping[str, float]:
    return {"force": one.spring.force, "stiffness": one.spring.stiffness}


def test_ends_are_the_quantiles_of_what_was_drawn() -> None:
    told: list[tuple[int, int]] = []
    progress: CountProgress = lambda done, of: told.append((done, of))  # noqa: E731
    found = drawn_answers(SPRING, GIVEN, USUAL, stretch, progress=progress)
    assert told[-1] == (COUNT, COUNT)
    assert found.refused == 0
    assert found.intervals["stiffness"] == pytest.approx((55, 100, 145), rel=0.03)
    assert found.intervals["force"] == pytest.approx((1.1, 2.0, 2.9), rel=0.03)
    assert [one.origin for one in found.drawn] == ["assumed", "given"]
    # The stiffness follows itself alone, and the other value has nothing to do with it.
    assert found.shares["stiffness"] == pytest.approx((1.0, 0.0), abs=0.06)
    assert found.shares["force"] == pytest.approx((0.0, 1.0), abs=0.06)
    assert drawn_answers(SPRING, GIVEN, USUAL, stretch).intervals == found.intervals


def test_what_cannot_work_is_counted_and_named() -> None:
    def fragile(one: Described) -> Mapping[str, float]:
        if one.spring.force > 2.5:
            raise OutOfRangeError(f"force is {one.spring.force:g} N: the spring breaks")
        return stretch(one)

    found = drawn_answers(SPRING, GIVEN, USUAL, fragile)
    assert found.refused == pytest.approx(COUNT / 4, abs=2)
    assert found.reason == "force"
    assert found.intervals["force"][2] < 2.5

    def broken(one: Described) -> Mapping[str, float]:
        if one.spring.force > 1.5:
            raise OutOfRangeError("it breaks")
        return stretch(one)

    assert drawn_answers(SPRING, GIVEN, USUAL, broken).intervals == {}


@pytest.mark.slow
def test_losses_scale_a_drawn_motor_as_its_plate_solved_anew() -> None:
    described = load_actuator("biet2008-motor")
    assert isinstance(described, MotorDescription)
    solved = assembled(described.motor)
    lossy = with_values(described, {"motor.plate.quality_factor": 45.0})
    scaled = motor._drawn(described, solved, lossy, 15.0)
    anew, working = assembled(lossy.motor), Working(voltage=15.0)
    # Other modes add a little to the amplitude at the resonance.
    assert scaled["stall_force_N"] == pytest.approx(stall_force(anew, working), rel=0.02)
    speed = no_load_speed(anew, working)
    assert scaled["no_load_speed_m_per_s"] == pytest.approx(speed, rel=0.02)
    assert all(np.isfinite(value) for value in scaled.values())
