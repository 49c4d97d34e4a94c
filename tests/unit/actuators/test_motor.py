"""The standing-wave motor in time and in the mean, beside what can be said in closed form."""

import math
from dataclasses import replace
from functools import cache
from itertools import pairwise, product
from typing import Any, get_type_hints

import numpy as np
import pytest

from squeezefilm.actuators.described import load_actuator
from squeezefilm.actuators.motor import average_kernel, kernel
from squeezefilm.actuators.motor.assembled import (
    AssembledMotor,
    Feet,
    Slider,
    Stator,
    Working,
    assembled,
    face_mode,
)
from squeezefilm.actuators.motor.averaged import (
    AveragedMotor,
    averaged,
    no_load_speed,
    stall_force,
)
from squeezefilm.actuators.motor.curves import motor_map, over_foot_position, speed_force_curve
from squeezefilm.actuators.motor.description import (
    Cradle,
    Foot,
    FootContact,
    Motor,
    MotorDescription,
)
from squeezefilm.actuators.motor.in_time import STEPS, MotorMotion, resting, simulate
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import GeometryError, InputError, OutOfRangeError, UnreachableError
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import RectangularPlate, turned

PRELOAD = 20.0
WORKING = Working(amplitude=1e-6)


@cache
def plate() -> RectangularPlate:
    found = load_display("biet2008-plate").actuator
    assert isinstance(found, RectangularPlate)
    return found


@cache
def motor(
    beside: float = 0.25,
    friction: float = 0.3,
    damping: float = 0.3,
    inclination: float = 0.0,
    guide: float = 0.0,
) -> AssembledMotor:
    """Three feet under one slider, each `beside` its antinode by that share of half a wave."""
    mode = face_mode(plate(), "timoshenko").working
    assert mode.line is not None
    nodes = mode.line.nodal_positions
    middle = (nodes[1:] + nodes[:-1]) / 2
    feet = tuple(
        Foot(float(middle[i] + beside * mode.half_wavelength), 0.0245, inclination)
        for i in (0, 2, 4)
    )
    contact = FootContact(2e7, 1.6e7, friction, damping)
    described = Motor(plate(), feet, contact, Cradle(PRELOAD, friction=guide), 0.05, 15.0)
    return assembled(described, "timoshenko")


def test_a_face_moves_along_as_its_slope_says() -> None:
    mode = face_mode(plate(), "timoshenko")
    beam = mode.working.beam
    assert beam is not None
    h = beam.section.neutral_axis
    slope = np.gradient(mode.across, mode.position)
    # Shear lets the section turn less than the slope, by less than a fifth on this plate.
    middle = slice(50, -50)
    ratio = np.sum(mode.along[middle] * slope[middle]) / np.sum(slope[middle] ** 2) / -h
    assert 0.8 < ratio < 1.0
    other = face_mode(turned(plate()), "timoshenko")
    assert other.along_width
    np.testing.assert_allclose(other.along, mode.along, atol=1e-12)


@pytest.mark.slow
def final_speed(motion: MotorMotion) -> float:
    """Mean over the last tenth of the periods (m/s)."""
    return float(np.mean(motion.period_speed[-(motion.period_speed.size // 10) :]))


def test_a_solved_plate_moves_along_as_its_own_slope_says() -> None:
    solid = face_mode(plate(), "solid")
    beam = face_mode(plate(), "timoshenko").working.beam
    assert beam is not None
    inside = np.linspace(0.015, 0.068, 401)
    across, along = solid.at(inside)
    slope = np.gradient(across, inside)
    ratio = np.sum(along * slope) / np.sum(slope**2) / -beam.section.neutral_axis
    # Shear, and gaps between ceramics, where the neutral plane lies higher.
    assert 0.6 < ratio < 1.05
    assert np.corrcoef(along, slope)[0, 1] < -0.95


def test_the_march_is_of_fourth_order_through_its_contacts() -> None:
    # Feet meet and leave the slider, stick and slip, some ten times a period each.
    fine = simulate(motor(), WORKING, speed=0.02, periods=5, steps=1024)
    assert 0.2 < fine.contact_share < 0.9
    steps = np.array([16, 32, 64, 128])
    errors = [
        abs(
            simulate(motor(), WORKING, speed=0.02, periods=5, steps=n).period_thrust[-1]
            - fine.period_thrust[-1]
        )
        for n in steps.tolist()
    ]
    orders = -np.diff(np.log(errors)) / np.log(2)
    assert np.all(orders > 3.5)


def test_a_slider_that_stays_on_its_feet_moves_as_a_mass_on_springs() -> None:
    there = motor(damping=0.0)
    one = np.ones_like(there.feet.across)
    alike = replace(there, feet=there.feet._replace(across=0.7 * one, along=0.0 * one))
    amplitude, mass, stiffness = 1e-8, 0.05, 3 * 2e7
    working = Working(amplitude=amplitude)
    stator = alike.stator(working)
    march, slider = resting(alike, working, stator, None)
    own, driven = np.sqrt(stiffness / mass), float(stator.omega[0])
    swing = 0.7 * amplitude * own**2 / (own**2 - driven**2)
    step = 2 * np.pi / driven / STEPS
    for n in range(20 * STEPS):
        assert kernel.march_steps(n * step, step, 1, (stator, alike.feet, slider, march)) == 1
        time, height = (n + 1) * step, march.state[2 * stator.mass.size]
        expected = -PRELOAD / stiffness + swing * (np.cos(driven * time) - np.cos(own * time))
        assert height == pytest.approx(expected, abs=1e-5 * abs(swing))
    np.testing.assert_allclose(march.shares, 20 * STEPS * step)


def test_along_the_width_is_as_along_the_length() -> None:
    there = motor()
    feet = tuple(replace(foot, x=foot.y, y=foot.x) for foot in there.motor.feet)
    cradle = replace(there.motor.cradle, direction=np.pi / 2)
    wide = replace(there.motor, plate=turned(plate()), feet=feet, cradle=cradle)
    across = assembled(wide, "timoshenko")
    one = simulate(there, WORKING, speed=0.01, periods=20).period_thrust
    other = simulate(across, WORKING, speed=0.01, periods=20).period_thrust
    np.testing.assert_allclose(other, one, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("free", [True, False])
def test_energy_is_kept_to_rounding(free: bool) -> None:
    working = Working(voltage=15.0) if free else WORKING
    asked = {"guide": 0.1} if free else {}
    found = simulate(
        motor(**asked),
        working,
        speed=None if free else 0.02,
        periods=10,
        steps=2048,
    )
    assert found.energy_residual < 1e-11
    works = found.works
    assert np.all(works[kernel.MODAL_LOSS : kernel.GUIDE_LOSS + 1] >= 0)
    assert works[kernel.FRICTION] > 0
    assert works[kernel.CONTACT_LOSS] > 0
    # It falls as the fourth power of the step.
    rough = simulate(
        motor(**asked),
        working,
        speed=None if free else 0.02,
        periods=10,
        steps=64,
    )
    assert found.energy_residual < 1e-3 * rough.energy_residual


@pytest.mark.parametrize("working", [WORKING, Working(voltage=15.0)])
def test_no_thrust_without_asymmetry(working: Working) -> None:
    upright = motor(beside=0.0)
    # A beam's antinode is where its section does not turn, between the nodes but for the ends.
    feet = upright.feet._replace(along=np.zeros_like(upright.feet.along))
    symmetric = replace(upright, feet=feet)
    in_time = simulate(symmetric, working, periods=200)
    assert abs(in_time.thrust) < 1e-12 * PRELOAD
    assert abs(final_speed(in_time)) < 1e-12
    assert abs(averaged(symmetric, WORKING).thrust) < 1e-12 * PRELOAD
    assert no_load_speed(symmetric, WORKING) == 0.0


def test_mirrored_feet_thrust_the_other_way() -> None:
    there = motor()
    mirrored = replace(there, feet=there.feet._replace(along=-there.feet.along))
    assert averaged(mirrored, WORKING).thrust == pytest.approx(-averaged(there, WORKING).thrust)
    assert no_load_speed(mirrored, WORKING) == pytest.approx(-no_load_speed(there, WORKING))
    one = simulate(there, WORKING, periods=60).period_speed
    other = simulate(mirrored, WORKING, periods=60).period_speed
    np.testing.assert_allclose(one, -other, rtol=1e-6)


def test_feet_that_stick_thrust_as_the_closed_form_says() -> None:
    there = motor(friction=2.0, damping=0.0)
    one = np.ones_like(there.feet.across)
    alike = replace(there, feet=there.feet._replace(across=0.7 * one, along=0.2 * one))
    expected = PRELOAD * (1.6e7 / 2e7) * 0.2 / 0.7
    for amplitude in (1e-6, 2e-6):
        found = averaged(alike, Working(amplitude=amplitude))
        assert found.contact_share < 1
        assert found.thrust == pytest.approx(expected, rel=1e-4)
    in_time = simulate(alike, WORKING, speed=0.0, periods=400)
    # The slider moves up and down within a contact, which the closed form leaves out.
    assert in_time.thrust == pytest.approx(expected, rel=0.03)


def test_feet_that_slip_thrust_as_the_integral_of_coulombs_law() -> None:
    # Slip while the foot is pressed in, sticking back to the other limit, slip out:
    # F/k = µδ up, µδp − r(δp − δ) until δ = δp (r − µ)/(r + µ), then −µδ.
    there = motor(friction=0.1, damping=0.0)
    one = np.ones_like(there.feet.across)
    across, along, mu = 0.7, 0.2, 0.1
    alike = replace(there, feet=there.feet._replace(across=across * one, along=along * one))
    found = averaged(alike, WORKING, samples=4096)
    theta = np.linspace(-np.pi, np.pi, 200_001)
    depth = np.maximum(across * 1e-6 * np.cos(theta) - found.height, 0)
    peak, r = depth.max(), (1.6e7 / 2e7) * along / across
    back = np.maximum(mu * peak - r * (peak - depth), -mu * depth)
    force = np.where(theta < 0, mu * depth, back)
    expected = 3 * 2e7 * np.mean(force[:-1])
    assert found.thrust == pytest.approx(expected, rel=2e-3)
    assert 3 * 2e7 * np.mean(depth[:-1]) == pytest.approx(PRELOAD, rel=1e-5)


def test_a_leg_that_leans_thrusts_from_the_antinode() -> None:
    leaning = motor(beside=0.0, inclination=0.2)
    straight = leaning.feet._replace(along=np.zeros_like(leaning.feet.along))
    found = averaged(replace(leaning, feet=straight), WORKING)
    there = simulate(replace(leaning, feet=straight), WORKING, speed=0.0, periods=400)
    assert abs(found.thrust) > 0.02 * PRELOAD
    assert there.thrust == pytest.approx(found.thrust, rel=0.03)
    with pytest.raises(OutOfRangeError, match=r"jams: its stiffness along"):
        FootContact(1e8, 1e5, 0.9).stiffnesses(0.1)


def both_models(
    preload: float, amplitude: float, periods: int
) -> tuple[AveragedMotor, MotorMotion]:
    """The mean and the motion in time of a slider that is moved at 10 mm/s."""
    working = Working(amplitude=amplitude, preload=preload)
    return (
        averaged(motor(), working, speed=0.01),
        simulate(motor(), working, speed=0.01, periods=periods),
    )


@pytest.mark.slow
def test_the_mean_agrees_with_time_where_the_slider_does_not_jump() -> None:
    for preload, amplitude in product((10.0, 20.0), (0.5e-6, 1e-6)):
        mean, in_time = both_models(preload, amplitude, periods=300)
        assert abs(mean.thrust - in_time.thrust) < 0.03 * 0.3 * preload
        assert abs(mean.contact_share - in_time.contact_share) < 0.05


def test_the_mean_fails_where_the_slider_jumps() -> None:
    """At 2 N the slider flies for periods: fewer and harder contacts, and a thrust that differs."""
    mean, in_time = both_models(2.0, 2e-6, periods=600)
    assert in_time.contact_share < 0.5 * mean.contact_share
    assert abs(mean.thrust - in_time.thrust) > 0.1 * 0.3 * 2.0


@pytest.mark.slow
def test_a_free_slider_ends_at_the_no_load_speed() -> None:
    working = Working(voltage=15.0)
    in_time = simulate(motor(), working, periods=1500)
    expected = no_load_speed(motor(), working)
    assert final_speed(in_time) == pytest.approx(expected, rel=0.05)
    assert in_time.period_amplitude[-1] == pytest.approx(
        averaged(motor(), working).amplitude, rel=0.02
    )


def test_the_speed_force_curve_falls_from_stall_to_no_load() -> None:
    curve = speed_force_curve(motor(), WORKING, 6)
    forces = [one.force for one in curve]
    assert forces[0] == stall_force(motor(), WORKING)
    assert all(a > b for a, b in pairwise(forces))
    assert abs(forces[-1]) < 1e-4 * forces[0]
    assert all(0 <= one.efficiency < 1 for one in curve)


def test_a_guide_takes_its_friction_off_and_holds_what_is_weaker() -> None:
    eased, held = motor(), motor(guide=1.0)
    assert stall_force(held, WORKING) == pytest.approx(stall_force(eased, WORKING) - 1.0)
    assert 0 < no_load_speed(held, WORKING) < no_load_speed(eased, WORKING)
    assert held.quiescent_force == pytest.approx(0.3 * PRELOAD + 1.0)
    stuck = motor(guide=7.0)
    with pytest.raises(OutOfRangeError, match=r"not above the guide's friction, 7 N: the motor st"):
        stall_force(stuck, WORKING)
    # Within a period the thrust passes the guide's friction for a moment, and the slider creeps;
    # a guide that is stronger than every peak holds it altogether.
    crept = final_speed(simulate(stuck, WORKING, periods=100))
    assert 0 < crept < 0.02 * no_load_speed(eased, WORKING)
    assert final_speed(simulate(motor(guide=60.0), WORKING, periods=100)) == 0.0


def test_a_map_knows_where_the_motor_stalls() -> None:
    told: list[tuple[int, int]] = []
    found = motor_map(
        motor(),
        np.array([5.0, 60.0]),
        np.array([0.5e-6, 2e-6]),
        progress=lambda done, of: told.append((done, of)),
    )
    assert told == [(1, 4), (2, 4), (3, 4), (4, 4)]
    assert np.isnan(found.stall_force).tolist() == [[False, False], [True, False]]
    assert found.no_load_speed[0, 1] > found.no_load_speed[0, 0] > 0


def test_feet_press_the_resonance_up() -> None:
    there = motor()
    frequencies = there.resonance_frequency * np.array([1.0, 1.01, 1.06])
    amplitudes = [
        averaged(there, Working(voltage=5.0, frequency=f)).amplitude for f in frequencies.tolist()
    ]
    assert amplitudes[1] > amplitudes[0] > amplitudes[2]


def test_feet_along_the_wave_thrust_both_ways() -> None:
    half = face_mode(plate(), "timoshenko").working.half_wavelength
    shifts = np.array([-0.5, -0.25, 0.25]) * half
    found = over_foot_position(motor(0.0).motor, WORKING, shifts, "timoshenko")
    assert found[0] is None
    assert found[1] is not None
    assert found[2] is not None
    assert found[1].thrust * found[2].thrust < 0


def test_two_modes_thrust_in_the_plane() -> None:
    motion = motor()
    feet = tuple(replace(foot, y=0.0245 + 0.002) for foot in motion.motor.feet)
    other = replace(plate(), lines_across="width", nodal_lines=5)
    described = replace(motion.motor, feet=feet, second_plate=other)
    both = assembled(described, "timoshenko")
    assert both.feet.across.shape == (3, 2)
    # The first mode moves along the length alone, the second along the width.
    assert not both.feet.along[:, 1].any()
    assert not both.sideways[:, 0].any()
    alone = averaged(both, WORKING)
    assert alone.sideways_thrust == 0.0
    one = averaged(assembled(replace(described, second_plate=None), "timoshenko"), WORKING)
    assert alone.thrust == pytest.approx(one.thrust, rel=1e-12)
    together = averaged(both, replace(WORKING, second=1.0))
    assert together.thrust != 0.0
    assert together.sideways_thrust != 0.0
    assert np.hypot(together.thrust, together.sideways_thrust) <= 0.3 * PRELOAD
    across = replace(described, cradle=replace(described.cradle, direction=np.pi / 2))
    turned_guide = averaged(assembled(across, "timoshenko"), replace(WORKING, second=1.0))
    assert turned_guide.thrust == pytest.approx(together.sideways_thrust, rel=1e-6)
    assert turned_guide.sideways_thrust == pytest.approx(-together.thrust, rel=1e-6)
    with pytest.raises(InputError, match="no second_plate"):
        averaged(motor(), replace(WORKING, second=1.0))


def test_the_kernel_of_the_mean_is_of_second_order_in_its_instants() -> None:
    there = motor(friction=2.0, damping=0.0)
    stator = there.stator(WORKING)
    means = [np.zeros(average_kernel.MEANS) for _ in range(3)]
    for n, found in zip((64, 128, 4096), means, strict=True):
        swing = average_kernel.Swing(0.0, 0.0, n, 1, 1)
        average_kernel.average_contact(stator, there.feet, there.sideways, 2e-7, swing, found)
    errors = [abs(found[2] / means[2][2] - 1) for found in means[:2]]
    assert errors[0] < 5e-3
    assert errors[1] < 2e-3


def test_the_mean_loss_in_the_feet_is_that_of_each_foots_depth_and_speed() -> None:
    there = motor(beside=0.2)
    stator, feet, height = there.stator(WORKING), there.feet, 2e-7
    found = np.zeros(average_kernel.MEANS)
    swing = average_kernel.Swing(0.0, 0.0, 256, 1, 1)
    average_kernel.average_contact(stator, feet, there.sideways, height, swing, found)
    angle = np.outer(stator.omega / stator.omega[0], 2 * np.pi * np.arange(256) / 256)
    angle += stator.phase[:, None]
    depth = feet.across @ (stator.amplitude[:, None] * np.cos(angle)) - height
    speed = feet.across @ ((stator.amplitude * stator.omega)[:, None] * np.sin(angle))
    lost = (feet.chi * feet.k_nn)[:, None] * speed**2 * np.maximum(depth, 0.0)
    assert found[5] == pytest.approx(lost.sum(axis=0).mean(), rel=1e-9)


def test_what_cannot_work_is_refused_in_words() -> None:
    there = motor()
    with pytest.raises(OutOfRangeError, match=r"900 V; from 333\.3 V on .* loses its poling"):
        averaged(there, Working(voltage=900.0))
    with pytest.raises(InputError, match=r"speed = .* at most 1 km/s"):
        averaged(there, WORKING, speed=1e308)
    with pytest.raises(
        OutOfRangeError, match=r"over a nodal line .* between a node and an antinode"
    ):
        motor(beside=0.5)
    with pytest.raises(OutOfRangeError, match=r"never leave the slider .* with less than"):
        stall_force(there, Working(amplitude=0.3e-6, preload=50.0))
    with pytest.raises(OutOfRangeError, match=r"their product is 1.* must stay below 1"):
        simulate(motor(damping=9.0), WORKING)
    with pytest.raises(InputError, match="give one of the two"):
        Working()
    with pytest.raises(InputError, match="nothing vibrates, and the slider is held by up to 6 N"):
        averaged(there, Working(voltage=0.0))
    with pytest.raises(UnreachableError, match="moves the plate less than"):
        averaged(there, Working(voltage=0.01, frequency=1.5 * there.resonance_frequency))
    with pytest.raises(GeometryError, match="foot 1 stands beside the plate: at 2 m"):
        replace(there.motor, feet=(Foot(2.0, 0.0),))
    with pytest.raises(GeometryError, match="at least one foot"):
        replace(there.motor, feet=())
    with pytest.raises(InputError, match="same length and width"):
        replace(there.motor, second_plate=replace(plate(), width=0.05))


@pytest.mark.slow
def test_the_preset_runs_and_says_what_it_does() -> None:
    described = load_actuator("biet2008-motor")
    assert isinstance(described, MotorDescription)
    ready = assembled(described.motor)
    working = Working(voltage=described.motor.voltage)
    rest = averaged(ready, working)
    assert 0.3 < rest.contact_share < 1
    assert 0 < stall_force(ready, working) < ready.quiescent_force
    assert 0.005 < no_load_speed(ready, working) < 0.2
    moved = simulate(ready, working, periods=1500)
    assert final_speed(moved) == pytest.approx(no_load_speed(ready, working), rel=0.1)


@pytest.mark.slow
def test_the_trends_that_the_paper_tells() -> None:
    """Its conclusion: intermittent contact varies with the preload and with the wave's amplitude,
    and the tangential results with the contact. No number is given there to compare with."""
    there = motor()
    by_preload = [averaged(there, replace(WORKING, preload=P)).contact_share for P in (5, 10, 20)]
    assert by_preload == sorted(by_preload)
    by_amplitude = [averaged(there, Working(amplitude=a)).contact_share for a in (5e-7, 1e-6, 2e-6)]
    assert by_amplitude == sorted(by_amplitude, reverse=True)
    speeds = [no_load_speed(there, Working(amplitude=a)) for a in (5e-7, 1e-6, 2e-6)]
    assert speeds == sorted(speeds)


@pytest.mark.parametrize("kind", [Stator, Feet, Slider])
def test_parts_made_by_hand_hold_no_number_that_is_none(kind: Any) -> None:
    hints = get_type_hints(kind)
    good = {name: np.ones(2) if hint == si.FloatArray else hint(1) for name, hint in hints.items()}
    assert kind(**good)._asdict().keys() == good.keys()
    for name, hint in hints.items():
        if hint is bool:
            continue
        bad = math.nan if hint is float else np.array([1.0, math.nan])
        with pytest.raises(InputError, match=f"{name} = nan"):
            kind(**good | {name: bad})
        if hint is not float:
            with pytest.raises(InputError, match=f"{name} = inf"):
                kind(**good | {name: (1.0, math.inf)})
