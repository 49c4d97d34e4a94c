"""What `analyze` says of a motor is what its room computes."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

from squeezefilm.actuators.analysis import drawn, motor
from squeezefilm.actuators.analysis.motor import MotorAnalysis, _warnings, analyze_motor
from squeezefilm.actuators.described import load_actuator
from squeezefilm.actuators.motor.assembled import Working
from squeezefilm.actuators.motor.averaged import AveragedMotor, no_load_speed, stall_force
from squeezefilm.actuators.report.motor import motor_rows
from squeezefilm.core.errors import OutOfRangeError

DESCRIBED = load_actuator("biet2008-motor")


SMALL = {"_MAP": 3, "_RESOLVED": 2, "_PERIODS": 150, "_POINTS": 9, "_STEPS": 30}


@pytest.fixture(scope="module")
def whole() -> MotorAnalysis:
    return analyze_motor(DESCRIBED)


@pytest.fixture(scope="module")
def small() -> MotorAnalysis:
    """At few points, in a short time, with few draws."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(drawn, "COUNT", 4)
        for name, size in SMALL.items():
            patch.setattr(motor, name, size)
        return analyze_motor(DESCRIBED)


@pytest.fixture(params=["small", pytest.param("whole", marks=pytest.mark.slow)])
def found(request: pytest.FixtureRequest) -> MotorAnalysis:
    found: MotorAnalysis = request.getfixturevalue(request.param)
    return found


def test_the_ends_of_the_curve_are_stall_and_no_load(found: MotorAnalysis) -> None:
    working = Working(voltage=15.0)
    assert found.stall_force == pytest.approx(stall_force(found.motor, working))
    assert found.no_load_speed == pytest.approx(no_load_speed(found.motor, working))
    assert found.best.efficiency == max(one.efficiency for one in found.curve)
    assert found.best.output == pytest.approx(found.best.force * found.best.speed)
    assert found.best.efficiency == pytest.approx(found.best.output / found.input_power)
    efficiency, preload, _ = found.best_of_map
    assert efficiency > found.best.efficiency
    assert preload in found.map.preload


def test_time_and_mean_agree_and_energy_is_kept(found: MotorAnalysis) -> None:
    assert abs(found.thrust_apart) < 0.02
    averaged = np.interp(
        found.resolved[:, 0], [c.speed for c in found.curve], [c.force for c in found.curve]
    )
    np.testing.assert_allclose(found.resolved[:, 1], averaged, atol=0.03 * found.stall_force)
    assert found.motion.energy_residual < 1e-5
    assert found.tracked is not None
    assert found.tracked.force[-1] == pytest.approx(found.tracked.wanted[-1], rel=0.02)
    assert found.warnings == ()


def test_the_map_goes_through_the_working_point(found: MotorAnalysis) -> None:
    assert found.map.preload[0] < DESCRIBED.motor.cradle.preload < found.map.preload[-1]
    assert found.map.amplitude[0] < found.rest.amplitude < found.map.amplitude[-1]


@pytest.mark.slow
def test_the_stall_force_follows_the_stiffnesses_of_the_contact(whole: MotorAnalysis) -> None:
    shares = {
        value.path.rpartition(".")[2]: share
        for value, share in zip(whole.drawn.drawn, whole.drawn.shares["stall_force_N"], strict=True)
    }
    # At rest the thrust goes with k_t/k_n.
    assert shares["normal_stiffness"] + shares["tangential_stiffness"] > 0.5
    assert shares["damping"] < 0.2


def test_its_json_has_units_in_its_keys(found: MotorAnalysis) -> None:
    told = json.loads(json.dumps(found.summary(), allow_nan=False))
    assert told["stall_force_N"] == found.stall_force
    assert told["kind"] == "motor"
    assert told["voltage_V"] == 15.0
    assert told["averaged_less_resolved_thrust"] == found.thrust_apart
    assert told["thrust_in_time_N"] == found.motion.thrust
    assert told["best"]["efficiency"] == found.best.efficiency
    assert told["best_of_map"]["efficiency"] == np.nanmax(found.map.efficiency)
    for rows, points, key, value in (
        ("speed_force_curve", found.curve, "speed_m_per_s", "speed"),
        ("speed_force_curve", found.curve, "force_N", "force"),
        ("over_frequency", found.tuned, "amplitude_m", "amplitude"),
        ("over_frequency", found.tuned, "force_N", "force"),
    ):
        assert [row[key] for row in told[rows]] == [getattr(point, value) for point in points]
    assert [row["shift_m"] for row in told["over_place_of_the_feet"]] == found.shifts.tolist()
    assert [row["speed_m_per_s"] for row in told["resolved_curve"]] == list(found.resolved[:, 0])
    assert told["velocity_in_the_plane_m_per_s"] is None


def test_what_a_motor_does_not_do_is_said(
    small: MotorAnalysis, monkeypatch: pytest.MonkeyPatch
) -> None:
    for apart, count in ((0.04, 0), (0.06, 1), (-0.06, 1)):
        with monkeypatch.context() as patch:
            patch.setattr(MotorAnalysis, "thrust_apart", apart)
            said = _warnings(small, "")
        assert len(said) == count
    assert said[0].startswith("At its best load the mean over a period gives ")
    highest = small.motor.highest_voltage
    for share, count in ((0.79, 0), (0.81, 1)):
        said = _warnings(dataclasses.replace(small, voltage=share * highest), "")
        assert len(said) == count
    assert said[0].startswith("The voltage is 81 % of that at which")
    (said,) = _warnings(dataclasses.replace(small, curve=small.curve[:1] + back(small)), "")
    assert said.startswith("It moves against the direction that its cradle names")
    assert _warnings(small, "no force can be commanded") == ["no force can be commanded"]


def back(found: MotorAnalysis) -> tuple[AveragedMotor, ...]:
    return (dataclasses.replace(found.curve[-1], speed=-0.01),)


def test_a_preload_that_stalls_is_refused_before_anything_long() -> None:
    own = DESCRIBED.motor
    pressed = dataclasses.replace(own, cradle=dataclasses.replace(own.cradle, preload=400.0))
    with pytest.raises(OutOfRangeError, match="the motor stalls"):
        analyze_motor(dataclasses.replace(DESCRIBED, motor=pressed))


def test_frequency_and_place_go_through_the_motor_as_it_is(found: MotorAnalysis) -> None:
    at = [one.working.frequency for one in found.tuned]
    assert min(at) < found.motor.resonance_frequency < max(at)
    forces = np.array([one.force for one in found.tuned])
    assert np.interp(found.motor.resonance_frequency, at, forces) == pytest.approx(
        found.stall_force, rel=0.01
    )
    # Below the resonance under the slider the plate hardly moves, and feet stick.
    assert forces[0] < 0.5 * found.stall_force
    pairs = zip(found.shifts.tolist(), found.shifted, strict=True)
    stand = [(shift, one.force) for shift, one in pairs if one is not None]
    assert np.interp(0.0, *zip(*stand, strict=True)) == pytest.approx(found.stall_force, rel=0.1)
    # Half a wave further on the other side of an antinode, they push back.
    assert min(force for _, force in stand) < 0
    assert None in found.shifted


@pytest.mark.slow
def test_a_second_plate_sets_the_slider_free_in_the_plane(whole: MotorAnalysis) -> None:
    assert whole.plane is None
    plate = DESCRIBED.motor.plate
    strips = tuple(
        dataclasses.replace(
            plate.patches[0], x=0.0, y=k * 12.25e-3 + 0.5e-3, length=plate.length,
            width=11.25e-3, polarity=way,
        )
        for k, way in enumerate((1, -1, -1, 1))
    )  # fmt: skip
    other = dataclasses.replace(plate, patches=strips, lines_across="width", nodal_lines=4)
    # Feet on both sides of the middle, at the same distance, would push each other sideways.
    feet = tuple(dataclasses.replace(one, y=one.y + 2e-3) for one in DESCRIBED.motor.feet)
    freed = dataclasses.replace(DESCRIBED.motor, second_plate=other, feet=feet)
    described = dataclasses.replace(DESCRIBED, motor=freed)
    both = analyze_motor(described)
    assert both.plane is not None
    along, sideways = both.summary()["velocity_in_the_plane_m_per_s"]
    assert abs(along) > 1e-3
    assert abs(sideways) > 1e-4
    rows = {row[0]: row[1] for row in motor_rows(both)}
    assert rows["Free in the plane"].count("m/s") == 2
    assert both.plane.energy_residual < 1e-2
    json.dumps(both.summary(), allow_nan=False)
