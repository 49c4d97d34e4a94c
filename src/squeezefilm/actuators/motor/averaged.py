"""The averaged motor: thrust at a speed, from the share of contact and of slip in a period.

The slider's inertia keeps its height and its speed over a period. For legs that stand upright and
stick throughout every contact, and χ = 0, the mean thrust at rest is

    F = P (k_t/k_n) Σ a_i / Σ b_i   with feet alike,  a = motion along, b = motion across the face,

whatever the amplitude, as long as (k_t/k_n) |a/b| ≤ µ and the feet leave the slider in each period.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from scipy.optimize import brentq

from squeezefilm.actuators.motor.assembled import AssembledMotor, Stator, Working
from squeezefilm.actuators.motor.average_kernel import MEANS, Swing, average_contact
from squeezefilm.actuators.motor.in_time import require_no_pull
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError, InputError, OutOfRangeError, UnreachableError

SAMPLES: int = 256
"""Instants of a period: thrust within some 0.5 % of the preload times µ."""
# Far beyond any slider, and far below what overflows.
SliderSpeed = Annotated[si.MetrePerSecond, si.AtLeast(-1000.0), si.AtMost(1000.0)]
# Two modes beat: so many periods of the first are averaged.
_BEATING = 64
_SCAN = 40
_ROUNDS, _SETTLED = 40, 1e-5
_N, _M = si.Unit("N"), si.Unit("m")


@dataclass(frozen=True)
class AveragedMotor:
    """A motor's means over time at one speed of its slider.

    Attributes:
        working: how it was driven.
        speed, sideways_speed: of the slider along the guide and across it in the plane (m/s).
        thrust, sideways_thrust: of the feet on the slider (N), the guide's friction not taken off.
        force: what is left for a load along the guide (N), against the motion.
        amplitude, second_amplitude: of the modes (m); the second 0 without one.
        height: of the slider over the resting face (m).
        contact_share: of the time, mean of the feet (1).
        slip_share: of the contact (1).
        plate_loss, contact_loss, friction_loss, output: mean powers (W).
        efficiency: output over all that (1); 0 where the load drives the motor.
    """

    working: Working
    speed: si.MetrePerSecond
    sideways_speed: si.MetrePerSecond
    thrust: si.Newton
    sideways_thrust: si.Newton
    force: si.Newton
    amplitude: si.Metre
    second_amplitude: si.Metre
    height: si.Metre
    contact_share: si.Dimensionless
    slip_share: si.Dimensionless
    plate_loss: si.Watt
    contact_loss: si.Watt
    friction_loss: si.Watt
    output: si.Watt
    model: str = "averaged: height and speed constant over a period, feet without mass"

    @property
    def input_power(self) -> si.Watt:
        """Input of the drive (W): output, losses of plate, contacts and guide."""
        lost = self.plate_loss + self.contact_loss + self.friction_loss
        return lost + (self.thrust - self.force) * self.speed + self.output

    @property
    def efficiency(self) -> si.Dimensionless:
        """Output over input, 0 where the load drives the motor (1)."""
        return max(0.0, self.output / self.input_power) if self.output > 0 else 0.0


@si.checked_numbers
def averaged(
    motor: AssembledMotor,
    working: Working,
    *,
    speed: SliderSpeed = 0.0,
    sideways_speed: SliderSpeed = 0.0,
    samples: Annotated[int, si.AtLeast(16), si.AtMost(100_000)] = SAMPLES,
) -> AveragedMotor:
    """A motor in the mean over a period, its slider at a speed along and sideways (m/s).

    Valid while the slider's own resonance on its feet lies far below the vibration, and the slider
    does not jump for more than one period: `simulate` does not assume that. Two modes beat: their
    difference frequency too must lie far above that resonance, or the slider follows the beat, and
    the thrust is that of `simulate_plane`. A mode that no drive moves stays at rest. With a voltage
    the amplitude of each mode is where the drive's force balances mode and feet at its frequency,
    the largest one where there are several; that takes some hundred times as long.

    Raises what `AssembledMotor.stator` and `require_no_pull` raise.
    """
    stator = motor.stator(working, held=True)
    if working.voltage is not None:
        stator = _balanced(motor, working, stator, (speed, sideways_speed))
    require_no_pull(motor, stator)
    height, means = _means(motor, working, stator, (speed, sideways_speed), samples)
    guide = motor.motor.cradle.friction
    thrust = float(means[0])
    force = thrust - guide * np.sign(speed if speed != 0 else thrust)
    if speed == 0 and abs(thrust) <= guide:
        force = 0.0
    moved = np.abs(stator.amplitude)
    damping = stator.damping * (1 + stator.rise * moved)
    loss = float(np.sum(0.5 * damping * (stator.omega * moved) ** 2))
    return AveragedMotor(
        working,
        speed,
        sideways_speed,
        thrust,
        float(means[1]),
        float(force),
        float(stator.amplitude[0]),
        float(stator.amplitude[1]) if len(motor.modes) > 1 else 0.0,
        height,
        float(means[3]),
        float(means[4]),
        loss,
        float(means[5]),
        float(means[6]),
        float(force * speed + means[1] * sideways_speed),
    )


def _means(
    motor: AssembledMotor,
    working: Working,
    stator: Stator,
    speeds: tuple[float, float],
    samples: int,
) -> tuple[float, si.FloatArray]:
    """The height (m) at which the feet carry the preload in the mean, and the `MEANS` there."""
    feet, means = motor.feet, np.zeros(MEANS)
    beats = stator.mass.size > 1 and stator.amplitude[1] != 0
    swing = Swing(*speeds, samples, 2, _BEATING if beats else 1)
    preload = motor.slider(working, imposed=True).preload

    def excess(height: float) -> float:
        average_contact(stator, feet, motor.sideways, height, swing, means)
        return float(means[2] - preload)

    highest = float(np.max(np.abs(feet.across) @ np.abs(stator.amplitude)))
    # What a leaning leg has left where friction pulls it aside.
    weakest = float(np.min(feet.k_nn - feet.k_nt**2 / feet.k_tt))
    lowest = -highest - 4.0 * preload / weakest
    height = float(brentq(excess, lowest, highest, xtol=1e-14 * (highest + 1e-12)))
    excess(height)
    return height, means


def _balanced(
    motor: AssembledMotor, working: Working, stator: Stator, speeds: tuple[float, float]
) -> Stator:
    """The stator held at the amplitudes at which drive, modes and feet are in balance."""
    if stator.force[0] == 0:
        raise InputError(
            "voltage is 0 V: nothing vibrates, and the slider is held by up to "
            f"{si.format_quantity(motor.quiescent_force, _N)}; give a voltage or an amplitude",
            quantity="voltage",
        )
    driven = np.flatnonzero(stator.force)
    held = stator._replace(amplitude=np.zeros(stator.mass.size))
    for _ in range(_ROUNDS):
        before = held.amplitude
        for j in driven.tolist():
            held = _in_balance(motor, working, held, j, speeds)
        # One mode by itself is found at once; two move the slider for each other.
        if driven.size == 1 or np.allclose(held.amplitude, before, rtol=_SETTLED, atol=0):
            return held
    raise ConvergenceError(
        f"the amplitudes of the two modes did not settle in {_ROUNDS} rounds; hold them at an "
        "amplitude, or resolve the motor in time",
        iterations=_ROUNDS,
    )


def _in_balance(
    motor: AssembledMotor,
    working: Working,
    stator: Stator,
    j: int,
    speeds: tuple[float, float],
    *,
    free: bool = False,
) -> Stator:
    """The stator with mode `j` at the amplitude at which its drive is in balance with the feet (or
    without them), the other mode being held."""
    M, K, C, w = (
        float(values[j]) for values in (stator.mass, stator.stiffness, stator.damping, stator.omega)
    )
    force, way = abs(float(stator.force[j])), float(np.sign(stator.force[j]))

    def held(amplitude: float) -> Stator:
        there = stator.amplitude.copy()
        there[j] = way * amplitude
        return stator._replace(amplitude=there)

    def excess(amplitude: float) -> float:
        means = np.zeros(MEANS)
        if not free:
            _, means = _means(motor, working, held(amplitude), speeds, 128)
        # The first harmonic of `spring_at`, and `damping_at`.
        bent = 8 / (3 * np.pi) * stator.bend[j] * amplitude + 0.75 * stator.cube[j] * amplitude**2
        real = (K * (1 + bent) - M * w**2) * amplitude - way * means[7 + 2 * j]
        lossy = C * (1 + stator.rise[j] * amplitude) * w * amplitude + way * means[8 + 2 * j]
        return float(np.hypot(real, lossy) - force)

    most = force / (C * w)
    tried = np.linspace(most, most / _SCAN, _SCAN)
    above = most
    for amplitude in tried:
        if excess(amplitude) < 0:
            at = amplitude if above == amplitude else brentq(excess, amplitude, above, rtol=1e-6)
            return held(float(at))
        above = amplitude
    raise UnreachableError(
        f"{si.format_quantity(float(working.voltage or 0.0), si.Unit('V'))} moves the plate less "
        f"than {si.format_quantity(most / _SCAN, _M)} under this preload at this frequency; drive "
        "it nearer to its resonance, harder, or press it less",
        quantity="voltage",
    )


@si.checked_numbers
def free_amplitude(motor: AssembledMotor, working: Working) -> si.Metre:
    """The amplitude (m) of the first mode without a slider at a voltage, its nonlinearity counted:
    the largest one where there are several.

    Raises `UnreachableError` for a drive far beside the resonance, and what `AssembledMotor.stator`
    raises.
    """
    if working.voltage is None:
        assert working.amplitude is not None
        return working.amplitude
    if working.voltage == 0:
        return 0.0
    stator = motor.stator(working, held=True)
    return float(_in_balance(motor, working, stator, 0, (0.0, 0.0), free=True).amplitude[0])


@si.checked_numbers
def stall_force(motor: AssembledMotor, working: Working) -> si.Newton:
    """The force (N) that just stops the slider, along the guide, its friction taken off.

    Raises `OutOfRangeError` for a preload under which no foot leaves the slider, or a guide that
    holds it: it stalls without any load.
    """
    rest = averaged(motor, working)
    require_moving(motor, rest)
    return rest.force


def require_moving(motor: AssembledMotor, rest: AveragedMotor) -> None:
    """Refuse a motor that stalls without a load. Raises `OutOfRangeError`."""
    preload = motor.slider(rest.working, imposed=True).preload
    reach = float(np.sum(motor.feet.k_nn * np.max(np.abs(motor.feet.across), axis=1)))
    if rest.contact_share >= 1:
        raise OutOfRangeError(
            f"preload is {si.format_quantity(preload, _N)}: the feet never leave the slider at an "
            f"amplitude of {si.format_quantity(rest.amplitude, _M)}, stick to it, and the motor "
            f"stalls; press it with less than {si.format_quantity(reach * rest.amplitude, _N)}, or "
            "vibrate more",
            quantity="preload",
        )
    if rest.force == 0.0 and motor.motor.cradle.friction > 0:
        raise OutOfRangeError(
            f"the thrust at rest, {si.format_quantity(rest.thrust, _N)}, is not above the guide's "
            f"friction, {si.format_quantity(motor.motor.cradle.friction, _N)}: the motor stalls "
            "without a load; vibrate more, put the feet further from the antinode, or ease the "
            "guide",
            quantity="friction",
        )


@si.checked_numbers
def no_load_speed(motor: AssembledMotor, working: Working) -> si.MetrePerSecond:
    """The speed (m/s) at which nothing is left for a load; negative against the guide's direction.

    0 for a motor without asymmetry. Raises as `stall_force`.
    """
    rest = averaged(motor, working)
    require_moving(motor, rest)
    if abs(rest.thrust) < 1e-9 * motor.slider(working, imposed=True).preload:
        return 0.0
    stator = motor.stator(working, held=True)
    held = working
    if working.voltage is not None:
        # The loaded amplitude hardly depends on the speed: it is kept at that of rest.
        held = replace(working, voltage=None, amplitude=rest.amplitude)
    fastest = float(np.max(np.abs(motor.feet.along) @ (stator.omega * rest.amplitude)))
    way = float(np.sign(rest.thrust))

    def left(speed: float) -> float:
        return way * averaged(motor, held, speed=way * speed).force

    far = fastest if fastest > 0 else float(stator.omega[0] * rest.amplitude)
    while left(far) > 0:
        far *= 2
    tiny = 1e-6 * far
    if left(tiny) <= 0:
        return 0.0
    return way * float(brentq(left, tiny, far, xtol=1e-7 * far))
