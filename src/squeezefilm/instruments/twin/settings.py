"""Assumptions of a twin about plate, amplifier, hand, sensor and pickup; readable from a TOML file.

Every table has an `evidence`. Nothing here was measured on a device: the defaults are assumed, and
say so. Write the source of your own numbers there.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Literal

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.contact.sliding.march import DryFriction
from squeezefilm.physics.plate.thermal import LOSS_TANGENT, Thermal
from squeezefilm.physics.render.motion.estimator import TOUCH_PANEL_240_HZ, SensorModel

PerSecond = Annotated[float, si.Unit("1/s")]
ASSUMED = "assumed"
# Frozen, so that all settings may share it.
_COULOMB = DryFriction()
FRICTION_LAG: si.Second = 0.45e-3
"""By which friction follows the amplitude: 20° at 130 Hz, the half-bandwidth f0/2Q of the plate
that it was measured on (glass, 39 kHz; EuroHaptics 2018). Of others it is assumed."""

PickupKind = Literal["motional_current", "sensing_patch", "none"]


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class PlateDrift:
    """Departure of a plate's resonance from the predicted one, f0 (1 + offset + …).

    Args:
        offset: relative, from the start (1): tolerance of the making.
        ageing: relative, per time (1/s).
        ambient_swing, ambient_period: the room's temperature goes to and fro by that much (K) as
            a sine of that period (s).
        temperature_coefficient, thermal_resistance, thermal_time: in place of what the display
            says and its geometry gives (`physics.plate.thermal.Thermal`): 1/K, K/W, s. At a
            resistance of 0 the plate keeps the room's temperature.
        quality_factor_ratio: Q over the predicted one (1); above 0. The drive's force per volt
            stays, so the amplitude at resonance changes with it.
        evidence: where the numbers are from.

    Raises:
        InputError: a value outside its range.
    """

    offset: Annotated[si.Dimensionless, si.Above(-0.5), si.Below(0.5)] = 0.0
    ageing: Annotated[PerSecond, si.AtLeast(-1e-06), si.AtMost(1e-06)] = 0.0
    ambient_swing: Annotated[si.Kelvin, si.AtLeast(0.0), si.AtMost(50.0)] = 1.0
    ambient_period: Annotated[si.Second, si.AtLeast(1.0), si.AtMost(1000000.0)] = 3600.0
    temperature_coefficient: Annotated[si.PerKelvin, si.Above(-1e-2), si.Below(1e-2)] | None = None
    thermal_resistance: Annotated[si.KelvinPerWatt, si.AtLeast(0.0)] | None = None
    thermal_time: Annotated[si.Second, si.Above(0.0)] | None = None
    quality_factor_ratio: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(10.0)] = 1.0
    evidence: str = ASSUMED

    def on(self, thermal: Thermal) -> Thermal:
        """Warmth that a display states, replaced by what is given here."""
        names = ("temperature_coefficient", "thermal_resistance", "thermal_time")
        given = {name: getattr(self, name) for name in names if getattr(self, name) is not None}
        return replace(thermal, **given)


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class TwinAmplifier:
    """Limits of an amplifier at the plate's capacitance and motional branch.

    Args:
        gain: voltage on the plate over the voltage asked for (1); above 0.
        highest_voltage: peak (V); above 0.
        highest_current: peak (A); above 0.
        slew_rate: of the output wave (V/s); above 0. A carrier of f keeps V ≤ slew_rate/(2πf).
        capacitance: of the plate held still (F); None takes that of a rectangular plate's
            ceramics, and 20 nF where no layout says.
        loss_tangent: of that capacitance (1); at least 0.
        evidence: where the numbers are from.

    Raises:
        InputError: a value outside its range.
    """

    gain: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(1000.0)] = 1.0
    highest_voltage: Annotated[si.Volt, si.Above(0.0)] = 400.0
    highest_current: Annotated[si.Ampere, si.Above(0.0)] = 2.0
    slew_rate: Annotated[si.VoltPerSecond, si.Above(0.0)] = 1e8
    capacitance: Annotated[si.Farad, si.Above(0.0)] | None = None
    loss_tangent: Annotated[si.Dimensionless, si.AtLeast(0.0)] = LOSS_TANGENT
    evidence: str = ASSUMED


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class TwinArm:
    """The arm that leads the finger: mass, spring and damper between finger and wanted place.

    Args:
        mass: of finger and what of the hand moves with it (kg); above 0.
        stiffness, damping: of the arm (N/m, N·s/m); above 0, at least 0.
        evidence: where the numbers are from.

    Raises:
        InputError: a value outside its range.
    """

    mass: Annotated[si.Kilogram, si.Above(0.0)] = 0.1
    stiffness: Annotated[si.NewtonPerMetre, si.Above(0.0)] = 500.0
    damping: Annotated[si.NewtonSecondPerMetre, si.AtLeast(0.0)] = 12.0
    evidence: str = ASSUMED


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class PickupModel:
    """Model of the pickup by which the device hears the vibration.

    Args:
        kind: the motional current over a shunt, a sensing patch, or none.
        shunt: that the current passes (Ω); above 0.
        sensitivity: of a sensing patch, volts per metre of vibration amplitude (V/m); above 0.
        feedthrough: share of the current through the capacitance that its compensation leaves in
            the motional current's signal (1); at least 0.
        noise: standard deviation of each quadrature of a reading (V); at least 0.
        evidence: where the numbers are from.

    Raises:
        InputError: a value outside its range, or another kind.
    """

    kind: PickupKind = "motional_current"
    shunt: Annotated[si.Ohm, si.Above(0.0)] = 10.0
    sensitivity: Annotated[si.VoltPerMetre, si.Above(0.0)] = 5e5
    feedthrough: Annotated[si.Dimensionless, si.AtLeast(0.0)] = 0.0
    noise: Annotated[si.Volt, si.AtLeast(0.0)] = 1e-3
    evidence: str = ASSUMED


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class TwinSettings:
    """Everything a twin assumes beyond the display's own description.

    Args:
        seed: of every noise, and of the device's tokens.
        tick: of the device (s): whole µs, 10 µs to 1 ms.
        steps_per_tick: equal parts of a tick in which plant and hand are stepped; at least 1.
        truth_period: between rows of the truth (s): a whole number of ticks.
        highest_amplitude_ratio: friction and load are tabulated up to this multiple of what the
            display's own voltage gives without a finger (1); above 0. Beyond it the last values
            hold, and are counted.
        drift, amplifier, arm, sensor, pickup: see there.
        dry: static friction and its dependence on speed and load.
        friction_lag: time constant with which friction follows the amplitude (s); 0 for at once.

    Raises:
        InputError: a value outside its range.
    """

    seed: Annotated[int, si.AtLeast(0), si.Below(2**53)] = 1
    tick: Annotated[si.Second, si.AtLeast(1e-05), si.AtMost(0.001)] = 100e-6
    steps_per_tick: Annotated[int, si.AtLeast(1), si.AtMost(100)] = 2
    truth_period: Annotated[si.Second, si.AtLeast("tick")] = 1e-3
    highest_amplitude_ratio: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(100.0)] = 2.0
    drift: PlateDrift = PlateDrift()
    amplifier: TwinAmplifier = TwinAmplifier()
    arm: TwinArm = TwinArm()
    sensor: SensorModel = TOUCH_PANEL_240_HZ
    pickup: PickupModel = PickupModel()
    dry: DryFriction = _COULOMB
    friction_lag: Annotated[si.Second, si.AtLeast(0.0), si.AtMost(0.1)] = FRICTION_LAG

    def __post_init__(self) -> None:
        if not _whole(self.tick * 1e6):
            raise InputError(f"tick = {self.tick:g} s must be a whole number of microseconds")
        if self.tick_us % self.steps_per_tick:
            raise InputError(
                f"steps_per_tick = {self.steps_per_tick} does not divide a tick of "
                f"{self.tick_us} us into whole microseconds; take one that does"
            )
        if not _whole(self.truth_period / self.tick):
            raise InputError(
                f"truth_period = {self.truth_period:g} s is no whole number of ticks of "
                f"{self.tick:g} s; take one"
            )

    @property
    def tick_us(self) -> int:
        """The device's tick in µs."""
        return round(self.tick * 1e6)


def _whole(number: float) -> bool:
    return abs(number - round(number)) < 1e-6


def load_settings(path: str | Path) -> TwinSettings:
    """Settings from a TOML file; what it leaves out is assumed. Raises `ConfigError`."""
    from squeezefilm.core import config

    return config.load(TwinSettings, path)
