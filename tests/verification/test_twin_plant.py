"""The twin's plant against closed forms, against prediction, and against scipy's integrator."""

import dataclasses
import math
from dataclasses import replace
from functools import lru_cache
from typing import Literal

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import RegularGridInterpolator
from tests.verification.second_order import carried

from squeezefilm.instruments.twin.envelope_step import (
    Electrical,
    EnvelopeLimits,
    Fingers,
    Resonance,
    envelope_step,
    voltage_given,
)
from squeezefilm.instruments.twin.hand import Hand
from squeezefilm.instruments.twin.plant import Plant
from squeezefilm.instruments.twin.plant_kernel import COLUMNS
from squeezefilm.instruments.twin.settings import (
    FRICTION_LAG,
    PlateDrift,
    TwinAmplifier,
    TwinSettings,
)
from squeezefilm.instruments.twin.working_point import WorkingPoint, working_point
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.contact.finger.fingertip import FingerpadDynamics
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.working_mode import resonance_factor
from squeezefilm.physics.render.motion.stroke import Stroke
from squeezefilm.physics.render.resonator.envelope import envelope_time_constant

STEADY = PlateDrift(temperature_coefficient=0.0)
CALM = TwinSettings(drift=STEADY, truth_period=100e-6, friction_lag=0.0)
"""No drift, and friction at once: what closed forms say."""
VOLTS = 10_000_000


@lru_cache(maxsize=2)
def point(name: str = "winfield2007-tpad") -> WorkingPoint:
    return working_point(load_display(name), CALM)


def carrier(ratio: float = 1.0) -> int:
    return round(point().mode.resonance_frequency * ratio * 1000)


def column(plant: Plant, name: str) -> np.ndarray:
    plant.drain()
    return plant.truth.column(name)


def pressed(force: float = 0.5) -> Hand:
    """A finger that presses within 10 ms and slides at a constant speed."""
    return Hand(Stroke(0.08, 0.5), normal_force=force, begin=0.0, press=10e-3)


@pytest.mark.parametrize("frequency", [25.0, 130.0, 500.0])
def test_friction_lags_the_amplitude_by_20_degrees_where_it_was_measured_to(
    frequency: float,
) -> None:
    """At 130 Hz, which was f0/2Q there; elsewhere by arctan ωτ. The skin adds a little of its own,
    whose speed under the friction changes with it."""
    own, late = (phase_of_friction(lag, frequency) for lag in (0.0, FRICTION_LAG))
    expected = -math.degrees(math.atan(2 * math.pi * frequency * FRICTION_LAG))
    assert late - own == pytest.approx(expected, abs=1.0)
    if frequency == 130.0:
        assert expected == pytest.approx(-20.0, abs=0.5)
        assert -4.0 < own <= 0.0


def phase_of_friction(lag: float, frequency: float) -> float:
    """By how much (degrees) µ′/µ is ahead of the amplitude's fall, for a small wave of level."""
    settings = replace(CALM, friction_lag=lag)
    plant = Plant(point(), settings, pressed())
    count, first = round(0.3 / settings.tick), round(0.1 / settings.tick)
    turn = 2 * math.pi * frequency * settings.tick * np.arange(count)
    for tick in range(count):
        level = round(VOLTS * (1 + 0.1 * math.sin(turn[tick])))
        plant.advance((tick + 1) * settings.tick_us, level, carrier())
    wave = np.exp(-1j * turn[first:])
    amplitude, friction = (
        np.sum((values[first:] - values[first:].mean()) * wave)
        for values in (column(plant, "amplitude_m"), column(plant, "relative_friction"))
    )
    return math.degrees(np.angle(-friction / amplitude))


@pytest.mark.slow
def test_the_amplitude_closes_in_exponentially_and_rings_down() -> None:
    mode = point().mode
    tau = float(envelope_time_constant(mode.quality_factor, carrier() * 1e-3))
    plant = Plant(point(), CALM)
    plant.advance(10_000, VOLTS, carrier())
    t, a = column(plant, "time_s"), column(plant, "amplitude_m")
    full = mode.amplitude_per_volt * 10
    # The carrier is a whole number of mHz, so the tuning is off by less than 1e-7.
    np.testing.assert_allclose(a, full * (1 - np.exp(-t / tau)), rtol=1e-6)
    plant.advance(12_000, 0, carrier())
    np.testing.assert_allclose(plant.amplitude, a[-1] * math.exp(-2e-3 / tau), rtol=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [0.97, 0.995, 1.0, 1.003, 1.04])
def test_a_detuned_carrier_has_the_amplitude_and_phase_of_the_mode(ratio: float) -> None:
    mode = point().mode
    plant = Plant(point(), CALM)
    plant.advance(60_000, VOLTS, carrier(ratio))
    x = carrier(ratio) * 1e-3 / mode.resonance_frequency
    exact = resonance_factor(carrier(ratio) * 1e-3, mode.resonance_frequency, mode.quality_factor)
    np.testing.assert_allclose(plant.amplitude, exact * 10 * mode.amplitude_per_volt, rtol=1e-9)
    # x(t) = Re(−i z e^{iωt}) lags the drive by arg(1 − x² + i/Q): 90° at resonance.
    lag = math.atan2(1 / mode.quality_factor, 1 - x**2)
    assert math.pi / 2 - np.angle(plant.envelope) == pytest.approx(lag, abs=1e-9)


def test_a_detuned_start_beats_as_a_resonator_of_the_second_order_does() -> None:
    # The envelope leaves out terms of 1/Q; Q is 50 here.
    mode, rate = point().mode, 2.56e6
    ratio = 1.02
    trace = carried(
        np.ones(8), 640, carrier(ratio) * 1e-3, mode.quality_factor,
        resonance=mode.resonance_frequency, rate=rate,
    )  # fmt: skip
    plant = Plant(point(), CALM)
    plant.advance(2_000, 1_000_000, carrier(ratio))
    mine = column(plant, "amplitude_m") / mode.amplitude_per_volt
    at = (np.arange(1, mine.size + 1) * 256)[: trace.amplitude.size // 256]
    at = at[at < trace.amplitude.size]
    theirs = trace.amplitude[at]
    assert np.max(np.abs(mine[: at.size] - theirs)) < 2 / mode.quality_factor * np.max(theirs)
    assert mine.max() > 1.05 * mine[-1]  # it does beat


def test_the_resonance_drifts_as_told_and_takes_the_amplitude_with_it() -> None:
    drift = PlateDrift(offset=0.01, ageing=1e-7, temperature_coefficient=-1e-4, ambient_swing=2.0,
                       ambient_period=80.0, thermal_resistance=0.0)  # fmt: skip
    plant = Plant(point(), replace(CALM, drift=drift))
    plant.advance(20_000_000, VOLTS, carrier())
    f0 = point().mode.resonance_frequency
    assert plant.resonance_frequency == pytest.approx(f0 * (1 + 0.01 + 2e-6 - 2e-4), rel=1e-12)
    expected = resonance_factor(
        carrier() * 1e-3, plant.resonance_frequency, point().mode.quality_factor
    )
    assert plant.amplitude == pytest.approx(
        expected * 10 * point().mode.amplitude_per_volt, rel=1e-5
    )


def test_what_the_plate_takes_is_what_its_loss_takes_and_warms_it() -> None:
    drift = PlateDrift(temperature_coefficient=-1e-9, ambient_swing=0.0, thermal_resistance=12.0,
                       thermal_time=2.0)  # fmt: skip
    amplifier = TwinAmplifier(loss_tangent=0.0)
    plant = Plant(point(), replace(CALM, drift=drift, amplifier=amplifier))
    plant.advance(4_000_000, VOLTS, carrier())
    mode = point().mode
    omega = 2 * math.pi * mode.resonance_frequency
    assert mode.modal_mass is not None
    power = 0.5 * mode.modal_mass * omega**3 / mode.quality_factor * plant.amplitude**2
    in_phase = omega * point().force_factor * plant.envelope.real
    assert 0.5 * plant.voltage * in_phase == pytest.approx(power, rel=1e-6)
    warm = -1e9 * (plant.resonance_frequency / mode.resonance_frequency - 1)
    assert plant.temperature_rise == pytest.approx(warm, rel=1e-6)
    assert warm == pytest.approx(12.0 * power * (1 - math.exp(-2)), rel=2e-3)


def test_the_amplifier_keeps_to_its_current_and_slew_rate() -> None:
    amplifier = TwinAmplifier(highest_current=0.02)
    plant = Plant(point(), replace(CALM, amplifier=amplifier))
    plant.advance(200_000, 20_000_000, carrier())
    assert column(plant, "current_A")[-100:] == pytest.approx(0.02, rel=1e-6)
    assert plant.voltage < 20
    slow = TwinAmplifier(slew_rate=1e6)
    plant = Plant(point(), replace(CALM, amplifier=slow))
    plant.advance(20_000, 20_000_000, carrier())
    assert plant.voltage == pytest.approx(1e6 / (2 * math.pi * carrier() * 1e-3))
    given = voltage_given(9.0, 0j, 1e5, Electrical(1e-8, 0.0, 0.0), EnvelopeLimits(5.0, 1.0, 1e9))
    assert given == 5.0


@pytest.mark.parametrize("force", [0.2, 0.5, 1.0])
@pytest.mark.parametrize("volts", [2.0, 15.0])
def test_a_finger_takes_and_feels_what_prediction_says(force: float, volts: float) -> None:
    plant = Plant(point(), CALM, pressed(force))
    plant.advance(600_000, round(volts * 1e6), carrier())
    # The twin's pad lies where the display's own voltage and force have their best place.
    display = load_display("winfield2007-tpad")
    lies = predict(display).law.place
    assert lies is not None
    told = predict(display, voltage=volts, normal_force=force, place=(lies.x, lies.y))
    assert told.touch.kept < 0.98
    # The twin's tables are read on straight lines; where the finger lets go they are off by 8e-4.
    assert plant.amplitude == pytest.approx(told.vibration_amplitude, rel=1e-3)
    assert column(plant, "relative_friction")[-1] == pytest.approx(told.relative_friction, abs=1e-3)
    assert plant.tangential_force == pytest.approx(told.tangential_force, abs=2e-3 * force)


def _oracle(plant: Plant, level: float, speed: float, span: float) -> np.ndarray:
    """The state after `span` of sliding, by scipy, from where a plant is now.

    z, bone and skin; the tables are read by NumPy, everything else is written anew.
    """
    p, s = plant.point, plant.settings
    mode, pad, arm = p.mode, p.display.finger.fingerpad, s.arm
    row = int(np.flatnonzero(p.forces == 0.5)[0])
    grid, load = p.amplitudes, p.load[row]
    law = RegularGridInterpolator((p.speeds, grid), p.relative_friction[row])
    w0 = 2 * math.pi * mode.resonance_frequency
    w = 2 * math.pi * carrier() * 1e-3
    u = mode.amplitude_per_volt * level
    mu = p.display.surface().friction_coefficient
    state, began = plant._s, plant.now * 1e-6

    def rates(t: float, y: np.ndarray) -> list[float]:
        z, (xb, vb, xs, vs) = complex(y[0], y[1]), y[2:]
        delta = complex(np.interp(abs(z), grid, load.real), np.interp(abs(z), grid, load.imag))
        Q = mode.quality_factor
        tuned = 1 + Q * delta.imag + 1j * Q * ((w / w0) ** 2 - 1 - delta.real)
        dz = (u - tuned * z) * w0 / (2 * Q)
        pull = pad.stiffness * (xb - xs) + pad.damping * (vb - vs)
        assert vs > 0  # it slides all the time
        drag = mu * 0.5 * float(law((vs, abs(z))))
        led = arm.stiffness * (speed * t - xb) + arm.damping * (speed - vb)
        return [dz.real, dz.imag, vb, (led - pull) / arm.mass, vs, (pull - drag) / pad.mass]

    start = [plant.envelope.real, plant.envelope.imag, *(state[i] for i in (5, 6, 9, 10))]
    done = solve_ivp(rates, (began, began + span), start, "DOP853", rtol=1e-11, atol=1e-16,
                     max_step=1e-4)  # fmt: skip
    assert done.success
    return np.asarray(done.y[:, -1])


@pytest.mark.slow
def test_finger_film_and_plate_together_agree_with_scipy_to_second_order() -> None:
    speed, errors = 0.08, []
    for parts in (1, 2, 4):
        settings = replace(CALM, tick=200e-6, truth_period=200e-6, steps_per_tick=parts)
        hand = Hand(Stroke(speed, 1.0), begin=0.0, press=10e-3)
        plant = Plant(point(), settings, hand)
        plant.advance(500_000, 5_000_000, carrier())
        # From the same place, so that the comparison is of the step alone.
        expected = _oracle(plant, 15.0, speed, 4e-3)
        plant.advance(504_000, 15_000_000, carrier())
        s = plant._s
        mine = np.array([plant.envelope.real, plant.envelope.imag, s[5], s[6], s[9], s[10]])
        errors.append(np.abs(mine - expected))
    fine = errors[2]  # 50 µs, what a twin does by default
    assert max(fine[0], fine[1]) < 1e-9
    assert max(fine[2], fine[4]) < 0.1e-6
    assert max(fine[3], fine[5]) < 0.1e-3
    # The envelope as a whole: a phase that hardly errs may change the sign of its error between.
    whole = [np.array([np.hypot(*one[:2]), *one[2:]]) for one in errors]
    order = np.log2(whole[0] / whole[2]) / 2
    assert np.all(order > 1.75), order


def test_the_envelope_step_is_exact_whatever_its_length_without_a_finger() -> None:
    load = np.zeros((2, 3), dtype=complex)
    fingers = Fingers(np.array([0.1, 1.0]), load, 1.0)
    z, many = 0.3 + 0.1j, 0.3 + 0.1j
    arguments = (Resonance(1.01, 60.0, 5e-4), 0.0, fingers)
    for _ in range(1000):
        many = envelope_step(many, 0.7, 2e-6, *arguments)
    assert envelope_step(z, 0.7, 2e-3, *arguments) == pytest.approx(many, rel=1e-12)


@pytest.mark.parametrize(("moisture", "factor"), [("normal", 1.0), ("moist", 1.8)])
def test_friction_drags_the_finger_back_and_its_work_is_lost(
    moisture: Literal["normal", "moist"], factor: float
) -> None:
    display = point().display
    finger = dataclasses.replace(display.finger, moisture=moisture)
    display = dataclasses.replace(display, finger=finger)
    hand = Hand(Stroke(0.08, 0.2), begin=0.0)
    plant = Plant(dataclasses.replace(point(), display=display), CALM, hand)
    plant.advance(1_500_000, 0, carrier())
    arm = CALM.arm
    force = plant.tangential_force
    x = column(plant, "x_m")[-1]
    # Steady sliding: the spring carries friction, the damper moves along with the hand.
    assert 0.08 * 1.5 - x == pytest.approx(force / arm.stiffness, rel=1e-3)
    base = display.surface().friction_coefficient
    assert force == pytest.approx(factor * base * 0.5, rel=1e-9)
    skin = column(plant, "skin_x_m")[-1]
    assert x - skin == pytest.approx(force / FingerpadDynamics().stiffness, rel=1e-3)
    # A pad at rest stays at rest: friction holds it, and does not creep.
    still = Plant(point(), CALM, Hand(Stroke(1e-9, 1e-9), begin=0.0))
    still.advance(1_000_000, 0, carrier())
    assert np.ptp(column(still, "skin_x_m")) < 1e-9
    assert column(plant, "time_s").size == 15_000
    assert len(COLUMNS) == plant.truth.rows.shape[1]


@pytest.mark.slow
def test_a_constant_that_is_no_number_is_not_played_on() -> None:
    unknown = dataclasses.replace(point(), force_factor=math.nan)
    with pytest.raises(RuntimeError, match=r"constants \[6\] are not numbers"):
        Plant(unknown, CALM)
