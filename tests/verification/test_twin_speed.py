"""The twin's skin under friction that depends on its own speed, against `slide` and at rest."""

import dataclasses
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from squeezefilm.instruments.twin import plant_kernel as k
from squeezefilm.instruments.twin.hand import Hand, hand_from
from squeezefilm.instruments.twin.plant import Plant
from squeezefilm.instruments.twin.settings import PlateDrift, TwinSettings
from squeezefilm.instruments.twin.working_point import WorkingPoint, working_point
from squeezefilm.physics.chain.friction import TABLE_SPEEDS, friction_law
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.contact.sliding.march import DryFriction, Sliding, SpeedFriction, slide
from squeezefilm.physics.display import load_display
from squeezefilm.physics.render.motion.stroke import FingerPath, Stroke

CALM = TwinSettings(
    friction_lag=0.0,
    drift=PlateDrift(temperature_coefficient=0.0),
    tick=50e-6,
    steps_per_tick=1,
    truth_period=50e-6,
)
FORCE = 0.5
LEVELS = (15_000_000, 0, 5_000_000, 20_000_000)


@lru_cache(maxsize=1)
def point() -> WorkingPoint:
    return working_point(load_display("winfield2007-tpad"), CALM)


def carrier() -> int:
    return round(point().mode.resonance_frequency * 1000)


def played(
    of: WorkingPoint, settings: TwinSettings, begin: int, end: int
) -> tuple[Plant, dict[str, np.ndarray], float]:
    """A hand's stroke over levels that change every 4 ms: the truth from `begin` (us) on, and the
    skin's speed there."""
    plant = Plant(of, settings, hand_from("20 mm in 0.25 s", normal_force=FORCE, begin=0.0))
    speed, now, number = 0.0, 0, 0
    while now < end:
        plant.advance(now + 4_000, LEVELS[number % 4], carrier())
        now, number = now + 4_000, number + 1
        if now == begin:
            speed = float(plant._s[k.SKIN_V])
    plant.drain()
    rows = plant.truth.rows
    rows = rows[rows[:, 0] > begin * 1e-6 - 1e-9]
    return plant, dict(zip(k.COLUMNS, rows.T, strict=True)), speed


def dragged(truth: dict[str, np.ndarray], friction: SpeedFriction, speed: float) -> Sliding:
    """The same bone over the same friction, by `slide`."""
    display = point().display
    bone, skin = truth["x_m"], truth["skin_x_m"]
    step = float(truth["time_s"][1] - truth["time_s"][0])
    return slide(
        bone, step, friction, truth["normal_force_N"], display.finger.fingerpad,
        initial_stretch=skin[0] - bone[0], initial_speed=speed,
    )  # fmt: skip


def coefficient() -> float:
    display = point().display
    surface = display.surface()
    return display.finger.friction_coefficient(
        surface.friction_coefficient, surface.roughness, FORCE
    )


@pytest.mark.nightly
def test_a_stroke_is_what_slide_makes_of_the_same_bone_and_amplitude() -> None:
    plant, truth, speed = played(point(), CALM, 100_000, 400_000)
    assert np.all(truth["normal_force_N"] == FORCE)
    mode, display = point().mode, point().display
    # The law's own table, finer than the twin's and not the twin's.
    law = friction_law(
        display,
        mode.half_wavelength,
        mode.resonance_frequency,
        normal_force=FORCE,
        place=predict(display).law.place,
    ).table(point().highest_amplitude, 257)
    rows = coefficient() * law(truth["amplitude_m"], law.speed[:, None]).T
    found = dragged(truth, SpeedFriction(law.speed, rows), speed)
    force, skin = truth["tangential_force_N"], truth["skin_x_m"]
    assert np.ptp(skin) > 14e-3
    assert np.ptp(force) > 0.3
    # What is left is the tables': straight between 129 amplitudes, or 257.
    np.testing.assert_allclose(skin, found.skin_position, atol=0.5e-6)
    assert np.sqrt(np.mean((force - found.friction_force) ** 2)) < 2e-4 * np.ptp(force)
    # The friction that it shows is that at the skin's own speed.
    pace = np.abs(found.skin_speed)
    told = [np.interp(one, law.speed, row) for one, row in zip(pace, rows, strict=True)]
    off = np.abs(truth["relative_friction"] - np.array(told) / coefficient())[pace > 1e-3]
    assert np.sqrt(np.mean(off**2)) < 2e-4
    assert off.max() < 2e-3
    assert np.ptp(pace) > 0.1
    assert plant.counts.failed == plant.counts.beyond == 0


def test_with_the_same_table_both_marches_close_in_with_the_step() -> None:
    row = int(np.flatnonzero(point().forces == FORCE)[0])
    table = RegularGridInterpolator(
        (point().speeds, point().amplitudes), point().relative_friction[row]
    )
    errors = []
    for tick in (100, 50, 25):
        settings = replace(CALM, tick=tick * 1e-6, truth_period=tick * 1e-6)
        _, truth, speed = played(point(), settings, 100_000, 240_000)
        rows = table(tuple(np.meshgrid(point().speeds, truth["amplitude_m"])))
        found = dragged(truth, SpeedFriction(point().speeds, coefficient() * rows), speed)
        errors.append(np.abs(truth["skin_x_m"] - found.skin_position).max())
    # They differ in the bone's speeds within a step alone, which `slide` makes of its places.
    assert errors[1] < 1e-10
    assert np.all(np.diff(np.log2(errors)) < -2), errors


def resting(of: WorkingPoint, level: int) -> Plant:
    """A finger that slid 5 mm, and rests for 0.4 s on a plate at a level (uV)."""
    times = np.array([0.0, 0.1, 5.0])
    path = FingerPath(times, np.array([0.0, 5e-3, 5e-3]), np.zeros(3))
    plant = Plant(of, CALM, Hand(path, normal_force=FORCE, begin=0.0))
    plant.advance(500_000, level, carrier())
    assert plant.counts.failed == 0
    return plant


def stretched(plant: Plant, by: float, level: int, steps: int) -> np.ndarray:
    """How far (m) the skin is from where it was, step by step, after it was put aside by that."""
    rest = float(plant._s[k.SKIN_X])
    plant._s[k.SKIN_X] += by
    found = [by]
    for _ in range(steps):
        plant.advance(plant.now + 50, level, carrier())
        found.append(float(plant._s[k.SKIN_X]) - rest)
    assert plant.counts.failed == 0
    return np.array(found)


def test_at_rest_a_skin_that_nothing_holds_creeps_back_as_its_friction_lets_it() -> None:
    level = 15_000_000
    # As by a law whose friction vanishes toward rest.
    falling = np.minimum(point().speeds / point().speeds[20], 1.0)[:, None]
    loose = replace(point(), relative_friction=point().relative_friction * falling)
    plant = resting(loose, level)
    # Nothing pulls at it, and it does not chatter.
    assert abs(plant.tangential_force) < 1e-6
    # Below the first speed of the table friction is one more damper.
    first = RegularGridInterpolator((loose.speeds, loose.amplitudes), loose.relative_friction[4])
    rise = coefficient() * FORCE * float(first((point().speeds[1], plant.amplitude)))
    pad, damper = point().display.finger.fingerpad, rise / point().speeds[1]
    fast, slow = np.sort(np.roots([pad.mass, pad.damping + damper, pad.stiffness]).real)
    by, times = 0.1e-6, np.arange(41) * 50e-6
    expected = by * (slow * np.exp(fast * times) - fast * np.exp(slow * times)) / (slow - fast)
    found = stretched(plant, by, level, 40)
    # The bone gives way to the pull, by less than a hundredth of it.
    np.testing.assert_allclose(found, expected, atol=5e-3 * by)
    assert plant.truth.column("relative_friction")[-1] < 1e-3


def test_at_rest_a_skin_that_is_held_stays_to_the_last_digit() -> None:
    # By a plate that is off, and by one that vibrates.
    of = point()
    display = of.display
    for level in (0, 5_000_000):
        plant = resting(of, level)
        least = np.interp(plant.amplitude, of.amplitudes, of.relative_friction[4, 0])
        assert least > 0.05
        limit = coefficient() * FORCE * least
        by = 0.1 * limit / display.finger.fingerpad.stiffness
        by = -by if plant.tangential_force > 0 else by
        assert np.ptp(stretched(plant, by, level, 40)[1:]) == 0.0


def test_friction_without_vibration_is_the_fingers_at_the_force_it_presses_with() -> None:
    display = point().display
    finger = dataclasses.replace(display.finger, shear_strength=2e4)
    display, surface = dataclasses.replace(display, finger=finger), display.surface()
    of = dataclasses.replace(point(), display=display)
    told = []
    for force in (0.2, 2.5):
        plant = Plant(of, CALM, Hand(Stroke(0.05, 0.1), normal_force=force, begin=0.0))
        plant.advance(1_000_000, 0, 0)
        told.append(
            finger.friction_coefficient(surface.friction_coefficient, surface.roughness, force)
        )
        assert plant.tangential_force == pytest.approx(told[-1] * force, rel=1e-9)
    assert told[1] < 0.999 * told[0]


def test_a_law_that_knows_no_speed_is_the_same_at_all() -> None:
    settings = replace(CALM, dry=DryFriction(static_ratio=1.5))
    known = point().relative_friction[:, -1:]
    alone = dataclasses.replace(point(), speeds=np.zeros(1), relative_friction=known)
    alike = dataclasses.replace(
        point(), speeds=np.array([0.0, 0.3, 2.0]), relative_friction=np.repeat(known, 3, axis=1)
    )
    forces = []
    for law in (alone, alike):
        hand = hand_from("20 mm in 0.25 s", normal_force=FORCE, begin=0.0)
        plant = Plant(law, settings, hand)
        plant.advance(100_000, LEVELS[0], carrier())
        forces.append(plant.tangential_force)
    assert forces[0] == pytest.approx(forces[1], rel=1e-9)
    assert forces[0] > 0.05
    assert TABLE_SPEEDS.size == point().speeds.size
