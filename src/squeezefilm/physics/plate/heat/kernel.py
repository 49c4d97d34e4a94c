"""The compiled physics of a warm plate, one for the prediction and for the twin's plant.

Heat leaves both faces of a horizontal plate in still air. With Ra on area over perimeter, L = A/P:

- upwards Nu = (0.65 + 0.36 Ra^(1/6))², 1 ≤ Ra ≤ 1.5e9 (as quoted by A. Jaffer, Free convection
  from rectangular plate, 2011), within a percent of the textbooks' 0.54 Ra^(1/4) at Ra = 1e4;
- downwards Nu = 0.52 Ra^(1/5) of newer textbooks, as quoted from 1e5 on; a display has 1e3 to 1e5,
  where it is extrapolated, and other published laws are up to a third lower;
- neither less than 2/π, what a disc of one temperature conducts into gas at rest (Weber's disc);
- radiation ε σ (T⁴ − T_room⁴) from both.

Properties of air are those at the film's temperature, by power laws through 300 K (handbooks).
Warmth moves the resonance, in proportion, and changes nothing else of the mode.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.physics.plate.heat.thermal import Cooling

_GRAVITY = 9.81
_STEFAN_BOLTZMANN = 5.670374e-8
# Of air at 300 K and 1 atm: conductivity (W/(m K)), kinematic viscosity, diffusivity (m²/s).
_CONDUCTIVITY, _VISCOSITY, _DIFFUSIVITY = 0.0263, 15.89e-6, 22.5e-6
_REST = 2.0 / math.pi
_LEAST = 0.05  # of the resonance frequency, that a coefficient leaves however warm


class Driven(NamedTuple):
    """A cold mode at a voltage: resonance frequency (Hz), quality factor, amplitude (m) and
    mechanical power (W) at that resonance, dielectric power (W)."""

    frequency: float
    quality: float
    amplitude: float
    mechanical: float
    dielectric: float


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
def resonance(rise: float, driven: Driven, coefficient: float) -> float:
    """The resonance frequency (Hz) of a plate that is warmer by `rise` (K), which moves it by a
    `coefficient` (1/K)."""
    return float(driven.frequency * max(1.0 + coefficient * rise, _LEAST))


@compiled()
def lost(frequency: float, rise: float, driven: Driven, coefficient: float) -> Any:
    """Amplitude (m) and the power lost in the plate (W) at a frequency (Hz; 0 follows the
    resonance) and a warmth (K): of its material, which goes with A², and dielectric."""
    f0 = resonance(rise, driven, coefficient)
    pace = (frequency if frequency > 0.0 else f0) / driven.frequency
    off = driven.quality * ((frequency / f0) ** 2 - 1.0) if frequency > 0.0 else 0.0
    share = 1.0 / (1.0 + off * off)
    power = pace * (driven.mechanical * share + driven.dielectric)
    return driven.amplitude * math.sqrt(share), power


@compiled()
def surpluses(
    rises: si.Array, frequency: float, driven: Driven, coefficient: float, cooling: Cooling
) -> si.Array:
    """Power lost in the plate less what it gives away (W), at every warmth of `rises` (K)."""
    out = rises.copy()
    for i in range(rises.size):
        _, power = lost(frequency, rises[i], driven, coefficient)
        out[i] = power - conductance(rises[i], cooling) * rises[i]
    return out


@compiled()
def time_until(wanted: float, step: float, most: int, warm: Any) -> float:
    """Time until the amplitude has fallen to `wanted` (m), from cold (s), in steps `step` (s); −1
    if not within `most` of them. `warm` is frequency, `Driven`, the resonance's coefficient,
    capacity and `Cooling`."""
    frequency, driven, coefficient, capacity, cooling = warm
    rise, before = 0.0, -1.0
    for number in range(most):
        moved, power = lost(frequency, rise, driven, coefficient)
        if moved <= wanted:
            share = 0.0 if number == 0 else (before - wanted) / (before - moved)
            return step * (number - 1.0 + share) if number > 0 else 0.0
        before = moved
        rise = warmed(rise, power, step, capacity, cooling)
    return -1.0
