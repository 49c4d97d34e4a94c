"""Rows of what a driven plate does beside moving: it gets warm, and it sounds."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squeezefilm.core import quantities as si
from squeezefilm.core.kit.numbers import HZ, M, Row, S, shown, signed
from squeezefilm.physics.plate.heat_states import COEFFICIENT_SHARES, EMISSIVITIES

if TYPE_CHECKING:
    from squeezefilm.physics.plate.sound import SoundField
    from squeezefilm.physics.plate.warming import Warming

KELVIN = si.Unit("K")


def heat_rows(heat: Warming | None) -> list[Row]:
    """Temperature, drift and amplitude of the warm plate: quantity, value, remark."""
    if heat is None:
        return [("Temperature rise", "not known", "nor is the power that the plate loses")]
    follows, stays = heat.tracked, heat.fixed
    at = f"at a fixed {shown(heat.frequency, HZ)}"
    fallen = (
        "a tenth is never gone"
        if heat.time_to_fall is None
        else f"a tenth is gone after {shown(heat.time_to_fall, S, 2)}"
    )
    rises, drifts = "", ""
    if heat.rise_range is not None:
        low, high = EMISSIVITIES
        between = _between(heat.rise_range, KELVIN)
        rises = f"assumed {between} (emissivity {low:g} to {high:g}); "
    if heat.drift_range is not None:
        low, high = COEFFICIENT_SHARES
        between = _between(heat.drift_range, HZ)
        too = ", too" if rises else ""
        drifts = f"assumed {between} (temperature coefficient {low:g} to {high:g} times{too}); "
    resistance = si.format_quantity(heat.thermal_resistance, si.Unit("K/W"), 3)
    return [
        (
            "Temperature rise",
            signed(follows.temperature_rise, KELVIN),
            f"{rises}if the drive follows; {signed(stays.temperature_rise, KELVIN)} if fixed",
        ),
        (
            "Drift of the resonance",
            signed(follows.resonance_drift, HZ),
            f"{drifts}{signed(stays.resonance_drift, HZ)} if fixed; half-bandwidth "
            f"{shown(heat.half_bandwidth, HZ, 3)}",
        ),
        (
            "Amplitude warm",
            shown(follows.amplitude, M, 3),
            "if the drive follows the resonance, without a finger",
        ),
        (
            "",
            shown(stays.amplitude, M, 3),
            f"{at}, of {shown(heat.cold_amplitude, M, 3)} cold; {fallen}",
        ),
        (
            "Thermal resistance",
            resistance,
            f"time constant {shown(heat.thermal_time, S, 2)}; assumed: " + "; ".join(heat.assumed),
        ),
    ]


def _between(ends: tuple[float, float], unit: si.Unit) -> str:
    """A range as people read it, signs shown."""
    low, high = (signed(end, unit) for end in ends)
    same_unit = low.split()[-1] == high.split()[-1]
    return f"{low.split()[0] if same_unit else low} to {high}"


def sound_rows(sound: SoundField, direction: str) -> list[Row]:
    """Sound pressure levels by distance; `direction` says where they are loudest."""
    guidance = sound.guidance
    limit = "no guidance" if guidance is None else f"guidance {guidance.level_dB:.0f} dB"
    return [
        (
            f"Sound at {distance:g} m",
            f"{level:.0f} dB",
            f"{direction}; {limit}" if number == 0 else "",
        )
        for number, (distance, level) in enumerate(
            zip(sound.distances, sound.sound_pressure_level_dB, strict=True)
        )
    ]
