"""The states in which a driven plate gives away what it loses, over assumed values as well; its
compiled physics is one for the prediction and for the twin's plant.

Heat leaves both faces of a horizontal plate in still air. With Ra on area over perimeter, L = A/P:

- upwards Nu = (0.65 + 0.36 Ra^(1/6))², 1 ≤ Ra ≤ 1.5e9 (as quoted by A. Jaffer, Free convection
  from rectangular plate, 2011), within a percent of the textbooks' 0.54 Ra^(1/4) at Ra = 1e4;
- downwards Nu = 0.52 Ra^(1/5) of newer textbooks, as quoted from 1e5 on; a display has 1e3 to 1e5,
  where it is extrapolated, and other published laws are up to a third lower;
- neither less than 2/π, what a disc of one temperature conducts into gas at rest (Weber's disc);
- radiation ε σ (T⁴ − T_room⁴) from both.

Properties of air are those at the film's temperature, by power laws through 300 K (handbooks).

Warmth, speed and field change the mode as `changed` says. By the Rayleigh law a ceramic's
coefficient rises in proportion to the amplitude, and its loop's area with the cube (Damjanovic and
Demartin 1996, J. Phys. D 29(7), 2057-2060; Hall 2001, 10.1023/A:1017959111402). For the compliance
one coefficient so gives softening and loss: tan δ = (4/3π) Δs/s and Δf/f = −Δs/2s, hence
Δ(1/Q) = (8/3π) |Δf|/f.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Annotated, Any, NamedTuple

import numpy as np
from scipy.optimize import brentq

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.physics.plate.thermal import Cooling, Thermal, ThermalBody

_GRAVITY = 9.81
_STEFAN_BOLTZMANN = 5.670374e-8
# Of air at 300 K and 1 atm: conductivity (W/(m K)), kinematic viscosity, diffusivity (m²/s).
_CONDUCTIVITY, _VISCOSITY, _DIFFUSIVITY = 0.0263, 15.89e-6, 22.5e-6
_REST = 2.0 / math.pi
_LOSS_PER_SOFTENING = 8.0 / (3.0 * math.pi)
_LEAST = 0.05  # of what a coefficient may leave of a quantity, so that none turns its sign
_STEPS = 400


class Driven(NamedTuple):
    """A cold mode at a voltage: resonance frequency (Hz), quality factor, amplitude (m) and
    mechanical power (W) at that resonance, dielectric power (W) and the ceramic's field (V/m)."""

    frequency: float
    quality: float
    amplitude: float
    mechanical: float
    dielectric: float
    field: float


class Drifts(NamedTuple):
    """Relative changes: of frequency, quality factor and charge coefficient per kelvin; softening
    per peak speed (s/m); rise of the charge coefficient per field (m/V)."""

    frequency: float
    quality: float
    charge: float
    softening: float
    field: float


@compiled()
def conductance(rise: float, cooling: Cooling) -> float:
    """Heat given away per kelvin (W/K) by a plate that is warmer than the room by `rise` (K)."""
    if cooling.fixed > 0.0:
        return float(cooling.fixed)
    above = max(rise, 0.0)
    room = cooling.ambient
    film = room + 0.5 * above
    ratio = film / 300.0
    buoyancy = _GRAVITY * above / film * cooling.length**3
    rayleigh = buoyancy / (_VISCOSITY * _DIFFUSIVITY * ratio**3.5)
    up = max((0.65 + 0.36 * rayleigh ** (1.0 / 6.0)) ** 2, _REST)
    down = max(0.52 * rayleigh**0.2, _REST)
    air = (up + down) * _CONDUCTIVITY * ratio**0.85 / cooling.length
    warm = room + above
    light = 2.0 * cooling.emissivity * _STEFAN_BOLTZMANN * (warm + room) * (warm**2 + room**2)
    return float(cooling.area * (air + light))


@compiled()
def warmed(rise: float, power: float, duration: float, capacity: float, cooling: Cooling) -> float:
    """The warmth (K) a `duration` (s) later at a constant power (W); `capacity` in J/K.

    Exact for a fixed conductance; a computed one is held over the step: first order.
    """
    given = conductance(rise, cooling)
    end = power / given
    return float(end + (rise - end) * math.exp(-duration * given / capacity))


@compiled()
def changed(quality: float, rise: float, speed: float, field: float, drifts: Drifts) -> Any:
    """A mode of a cold quality factor under warmth (K), peak speed (m/s) and field (V/m): its
    quality factor, force per volt over the cold one, and frequency over that without speed."""
    soft = min(drifts.softening * speed, 1.0 - _LEAST)
    warm = quality * max(1.0 + drifts.quality * rise, _LEAST)
    now = 1.0 / (1.0 / warm + _LOSS_PER_SOFTENING * soft)
    gain = max(1.0 + drifts.charge * rise, _LEAST) * (1.0 + drifts.field * field)
    return now, gain, 1.0 - soft


@compiled()
def resonance(rise: float, driven: Driven, drifts: Drifts) -> float:
    """The resonance frequency (Hz) of a plate that is warmer by `rise` (K), at a low amplitude."""
    return float(driven.frequency * max(1.0 + drifts.frequency * rise, _LEAST))


@compiled()
def response(frequency: float, rise: float, moved: float, driven: Driven, drifts: Drifts) -> float:
    """The amplitude (m) that a mode takes at a frequency (Hz; 0 follows the resonance) if its
    changes are those of an amplitude `moved` (m)."""
    f0 = resonance(rise, driven, drifts)
    speed = 2.0 * math.pi * f0 * moved
    quality, gain, soft = changed(driven.quality, rise, speed, driven.field, drifts)
    peak = driven.amplitude * gain * quality / driven.quality
    if frequency <= 0.0:
        return float(peak)
    off = quality * ((frequency / (f0 * soft)) ** 2 - 1.0)
    return float(peak / math.sqrt(1.0 + off * off))


@compiled()
def amplitude(frequency: float, rise: float, driven: Driven, drifts: Drifts) -> float:
    """The amplitude (m) at a frequency (Hz; 0 follows the resonance) and a warmth (K): the least
    that agrees with the softening it makes, which is where a plate at rest arrives."""
    if drifts.softening == 0.0:
        return float(response(frequency, rise, 0.0, driven, drifts))
    warm = max(1.0 + drifts.quality * rise, _LEAST)
    _, gain, _ = changed(driven.quality, rise, 0.0, driven.field, drifts)
    top = 1.001 * driven.amplitude * gain * warm
    low, high = 0.0, top
    for number in range(1, _STEPS + 1):
        high = top * number / _STEPS
        if response(frequency, rise, high, driven, drifts) < high:
            break
        low = high
    for _ in range(50):
        middle = 0.5 * (low + high)
        if response(frequency, rise, middle, driven, drifts) < middle:
            high = middle
        else:
            low = middle
    return float(0.5 * (low + high))


@compiled()
def lost(frequency: float, rise: float, driven: Driven, drifts: Drifts) -> Any:
    """Amplitude (m) and the power lost in the plate (W) at a frequency (0: at resonance) and a
    warmth: of its material, which goes with A²/Q at a constant modal stiffness, and dielectric."""
    moved = amplitude(frequency, rise, driven, drifts)
    f0 = resonance(rise, driven, drifts)
    speed = 2.0 * math.pi * f0 * moved
    quality, _, soft = changed(driven.quality, rise, speed, driven.field, drifts)
    pace = (frequency if frequency > 0.0 else f0 * soft) / driven.frequency
    part = 0.0
    if driven.amplitude > 0.0:
        part = driven.mechanical * (moved / driven.amplitude) ** 2 * driven.quality / quality
    return moved, pace * (part + driven.dielectric)


@compiled()
def surpluses(
    rises: si.Array, frequency: float, driven: Driven, drifts: Drifts, cooling: Cooling
) -> si.Array:
    """Power lost in the plate less what it gives away (W), at every warmth of `rises` (K)."""
    out = rises.copy()
    for i in range(rises.size):
        _, power = lost(frequency, rises[i], driven, drifts)
        out[i] = power - conductance(rises[i], cooling) * rises[i]
    return out


@compiled()
def time_until(wanted: float, step: float, most: int, warm: Any) -> float:
    """Time until the amplitude has fallen to `wanted` (m), from cold (s), in steps `step` (s); −1
    if not within `most` of them. `warm` is frequency, `Driven`, `Drifts`, capacity and
    `Cooling`."""
    frequency, driven, drifts, capacity, cooling = warm
    rise, before = 0.0, -1.0
    for number in range(most):
        moved, power = lost(frequency, rise, driven, drifts)
        if moved <= wanted:
            share = 0.0 if number == 0 else (before - wanted) / (before - moved)
            return step * (number - 1.0 + share) if number > 0 else 0.0
        before = moved
        rise = warmed(rise, power, step, capacity, cooling)
    return -1.0


EMISSIVITIES = (0.1, 0.9)
"""Emissivities from bare metal to a film or glass: assumed range of faces of which none is told."""
ASSUMED_EMISSIVITY: si.Dimensionless = 0.5
"""Emissivity of faces of which none is told: the middle of `EMISSIVITIES`."""
COEFFICIENT_SHARES = (0.5, 2.0)
"""Shares of the described temperature coefficient of the resonance: assumed, with no source."""

HOTTEST: si.Kelvin = 2000.0
"""Beyond it no state is looked for."""

_GRID = 1500
_REFERENCE_RISE: si.Kelvin = 20.0
_STEPS_OF_A_TIME_CONSTANT = 2000
_FALLEN = 0.9


@si.checked_numbers
@dataclass(frozen=True)
class HeatSource:
    """A mode as it is driven, cold and without a finger, and what it loses at resonance.

    Args:
        frequency: of the resonance (Hz).
        quality_factor: of the mode (1).
        amplitude: zero-to-peak at resonance (m).
        mechanical_power: lost in materials there (W). What leaves as sound or goes into a finger
            does not warm the plate and is not in it, as far as the quality factor is without it.
        dielectric_power: lost in the ceramic's capacitance there (W).
        quality_of_ceramic: its own quality factor (1); None where it is not known.
        field: in the thinnest driven ceramic (V/m, peak); None where it is not known.
    """

    frequency: Annotated[si.Hertz, si.Above(0.0), si.AtMost(1e9)]
    quality_factor: Annotated[si.Dimensionless, si.Above(0.5), si.AtMost(1e8)]
    amplitude: Annotated[si.Metre, si.AtLeast(0.0)]
    mechanical_power: Annotated[si.Watt, si.AtLeast(0.0)]
    dielectric_power: Annotated[si.Watt, si.AtLeast(0.0)] = 0.0
    quality_of_ceramic: Annotated[si.Dimensionless, si.Above(0.0)] | None = None
    field: Annotated[si.VoltPerMetre, si.AtLeast(0.0)] | None = None


@dataclass(frozen=True)
class WarmState:
    """A state in which the plate gives away what it loses: how much warmer than the room, how far
    its resonance has moved, the amplitude and the power lost in the plate."""

    temperature_rise: si.Kelvin
    resonance_drift: si.Hertz
    amplitude: si.Metre
    power: si.Watt


def cooling_of(thermal: Thermal, body: ThermalBody) -> Cooling:
    """Cooling of a body, by measurement where there is one."""
    measured = thermal.thermal_resistance
    fixed = 0.0 if measured is None else (math.inf if measured == 0 else 1 / measured)
    length = body.face_area / body.perimeter
    emissivity = ASSUMED_EMISSIVITY if thermal.emissivity is None else thermal.emissivity
    return Cooling(fixed, body.face_area, length, emissivity, thermal.ambient_temperature)


def heat_capacity(thermal: Thermal, body: ThermalBody) -> si.JoulePerKelvin:
    """Heat capacity of the body (J/K): of its mass, or what a measured time constant says.

    With a measured time constant and a computed resistance, by the one at a warmth of 20 K.
    """
    if thermal.thermal_time is None:
        return body.heat_capacity
    given = conductance(_REFERENCE_RISE, cooling_of(thermal, body))
    # Held at the room's temperature any capacity is the same.
    return thermal.thermal_time * given if math.isfinite(given) else body.heat_capacity


def drifts_of(thermal: Thermal) -> Drifts:
    """The coefficients as compiled code takes them."""
    return Drifts(
        thermal.temperature_coefficient,
        thermal.quality_temperature_coefficient,
        thermal.charge_temperature_coefficient,
        thermal.rayleigh_softening,
        thermal.rayleigh_charge,
    )


class WarmCase:
    """A plate at one voltage, as compiled code takes it."""

    def __init__(
        self, source: HeatSource, thermal: Thermal, body: ThermalBody, drifts: Drifts
    ) -> None:
        self.driven = Driven(
            float(source.frequency),
            float(source.quality_factor),
            float(source.amplitude),
            float(source.mechanical_power),
            float(source.dielectric_power),
            float(source.field or 0.0),
        )
        self.drifts, self.cooling = drifts, Cooling(*map(float, cooling_of(thermal, body)))
        self.capacity = float(heat_capacity(thermal, body))

    def states(self, frequency: float) -> tuple[WarmState, ...]:
        """The stable states at a frequency (0: at resonance), the one reached from cold first."""
        if math.isinf(self.cooling.fixed):
            return (self._state(frequency, 0.0),)
        top = 10.0
        # Beyond where the plate cools at its resonance no other drive keeps it warm.
        for drive in (frequency, 0.0):
            while top < HOTTEST and self._surplus(drive, top) > 0:
                top = min(1.5 * top, HOTTEST)
        grid = top * np.linspace(0, 1, _GRID) ** 2
        left = surpluses(grid, frequency, self.driven, self.drifts, self.cooling)
        stable = np.flatnonzero((left[:-1] > 0) & (left[1:] <= 0))
        if left[0] <= 0:
            return (self._state(frequency, 0.0),)
        roots = [
            brentq(lambda rise: self._surplus(frequency, rise), grid[at], grid[at + 1], xtol=1e-9)
            for at in stable
        ]
        if left[-1] > 0:
            roots.append(top)
        return tuple(self._state(frequency, float(root)) for root in roots)

    def time_to_fall(self, frequency: float, cold: si.Metre, time: si.Second) -> si.Second | None:
        """Time at which a tenth of the cold amplitude is gone (s)."""
        if not (cold > 0 and time > 0):
            return None
        warm = (float(frequency), self.driven, self.drifts, self.capacity, self.cooling)
        steps = 20 * _STEPS_OF_A_TIME_CONSTANT
        time_taken = time_until(_FALLEN * cold, time / _STEPS_OF_A_TIME_CONSTANT, steps, warm)
        return None if time_taken < 0 else float(time_taken)

    def _surplus(self, frequency: float, rise: float) -> float:
        rises = np.array([rise])
        return float(surpluses(rises, frequency, self.driven, self.drifts, self.cooling)[0])

    def _state(self, frequency: float, rise: si.Kelvin) -> WarmState:
        moved, power = lost(frequency, rise, self.driven, self.drifts)
        drift = resonance(rise, self.driven, self.drifts) - self.driven.frequency
        return WarmState(rise, drift, moved, power)


def warmth_ranges(
    source: HeatSource, thermal: Thermal, body: ThermalBody
) -> tuple[tuple[si.Kelvin, si.Kelvin] | None, tuple[si.Hertz, si.Hertz]]:
    """The least and the most that the tracked state is warm and has drifted over assumed ranges;
    no range of the warmth with a measured resistance or a known emissivity."""
    is_known = thermal.thermal_resistance is not None or thermal.emissivity is not None
    nominal, states = drifts_of(thermal), []
    for emissivity in (thermal.emissivity,) if is_known else EMISSIVITIES:
        changed = replace(thermal, emissivity=emissivity)
        for share in COEFFICIENT_SHARES:
            shifted = nominal._replace(frequency=share * nominal.frequency)
            states.append(WarmCase(source, changed, body, shifted).states(0.0)[0])
    rises, drifts = (
        sorted(getattr(state, name) for state in states)
        for name in ("temperature_rise", "resonance_drift")
    )
    return None if is_known else (rises[0], rises[-1]), (drifts[0], drifts[-1])
