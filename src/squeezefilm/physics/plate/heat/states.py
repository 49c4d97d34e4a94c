"""The states in which a driven plate gives away what it loses, over assumed values as well.

Equations and sources: `squeezefilm.physics.plate.heat.kernel`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from scipy.optimize import brentq

from squeezefilm.core import quantities as si
from squeezefilm.physics.plate.heat.kernel import (
    Driven,
    conductance,
    lost,
    resonance,
    surpluses,
    time_until,
)
from squeezefilm.physics.plate.heat.thermal import Cooling, Thermal, ThermalBody

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


class WarmCase:
    """A plate at one voltage, as compiled code takes it."""

    def __init__(self, source: HeatSource, thermal: Thermal, body: ThermalBody) -> None:
        self.driven = Driven(
            float(source.frequency),
            float(source.quality_factor),
            float(source.amplitude),
            float(source.mechanical_power),
            float(source.dielectric_power),
        )
        self.coefficient = float(thermal.temperature_coefficient)
        self.cooling = Cooling(*map(float, cooling_of(thermal, body)))
        self.capacity = float(heat_capacity(thermal, body))

    def states(self, frequency: float) -> tuple[WarmState, ...]:
        """The stable states at a frequency (0: at resonance), the one reached from cold first."""
        if math.isinf(self.cooling.fixed):
            return (self._state(frequency, 0.0),)
        top = 10.0
        while top < HOTTEST and self._surplus(frequency, top) > 0:
            top = min(1.5 * top, HOTTEST)
        # Beyond where the plate cools at its resonance no other drive keeps it warm.
        while top < HOTTEST and self._surplus(0.0, top) > 0:
            top = min(1.5 * top, HOTTEST)
        grid = top * np.linspace(0, 1, _GRID) ** 2
        left = surpluses(grid, frequency, self.driven, self.coefficient, self.cooling)
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
        warm = (float(frequency), self.driven, self.coefficient, self.capacity, self.cooling)
        steps = 20 * _STEPS_OF_A_TIME_CONSTANT
        time_taken = time_until(_FALLEN * cold, time / _STEPS_OF_A_TIME_CONSTANT, steps, warm)
        return None if time_taken < 0 else float(time_taken)

    def _surplus(self, frequency: float, rise: float) -> float:
        rises = np.array([rise])
        left = surpluses(rises, frequency, self.driven, self.coefficient, self.cooling)
        return float(left[0])

    def _state(self, frequency: float, rise: si.Kelvin) -> WarmState:
        moved, power = lost(frequency, rise, self.driven, self.coefficient)
        drift = resonance(rise, self.driven, self.coefficient) - self.driven.frequency
        return WarmState(rise, drift, moved, power)


def warmth_ranges(
    source: HeatSource, thermal: Thermal, body: ThermalBody
) -> tuple[tuple[si.Kelvin, si.Kelvin] | None, tuple[si.Hertz, si.Hertz]]:
    """The least and the most that the tracked state is warm and has drifted over assumed ranges;
    no range of the warmth with a measured resistance or a known emissivity."""
    is_known = thermal.thermal_resistance is not None or thermal.emissivity is not None
    states = []
    for emissivity in (thermal.emissivity,) if is_known else EMISSIVITIES:
        for share in COEFFICIENT_SHARES:
            case = WarmCase(source, replace(thermal, emissivity=emissivity), body)
            case.coefficient *= share
            states.append(case.states(0.0)[0])
    rises, drifts = (
        sorted(getattr(state, name) for state in states)
        for name in ("temperature_rise", "resonance_drift")
    )
    return None if is_known else (rises[0], rises[-1]), (drifts[0], drifts[-1])
