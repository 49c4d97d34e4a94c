"""Rows of a working point that several verbs show: place, heat, sound, the finger's speed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squeezefilm import quantities as si
from squeezefilm.chain.active_area import CRITERIA, percent
from squeezefilm.chain.pad_place import place_words
from squeezefilm.report.kit.numbers import HZ, SPEED, M, S, shown, signed

if TYPE_CHECKING:
    from squeezefilm.analysis.area_odds import JudgedArea
    from squeezefilm.chain.prediction import Prediction
    from squeezefilm.plate.heat.warming import Warming
    from squeezefilm.plate.sound import SoundField

Row = tuple[str, str, str]
KELVIN = si.Unit("K")


def place_rows(p: Prediction, judged: JudgedArea | None) -> list[Row]:
    """Where the friction is meant, and what it is over the active area: quantity, value, remark."""
    where = place_words(p.place)
    said = p.place_said.replace(f"{where}, ", "").replace(f", {where}", "")
    rows = [("Place of the finger", where, said)]
    area = None if judged is None else judged.area
    if area is None or area.best_place is None or area.worst_place is None:
        return [
            *rows,
            ("µ′/µ over the active area", "not known", "" if area is None else area.why_not),
        ]
    places = f"at {place_words(area.best_place)} and {place_words(area.worst_place)}"
    shares = ", ".join(f"{percent(area.share_below(one))} below {one:.2f}" for one in CRITERIA)
    return [
        *rows,
        (
            "µ′/µ over the active area",
            f"{area.best:.2f} to {area.worst:.2f}",
            f"{places}; median {area.median:.2f}; {shares}",
        ),
    ]


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
    resistance = si.format_quantity(heat.thermal_resistance, si.Unit("K/W"), 3)
    return [
        (
            "Temperature rise",
            signed(follows.temperature_rise, KELVIN),
            f"if the drive follows; {signed(stays.temperature_rise, KELVIN)} if fixed",
        ),
        (
            "Drift of the resonance",
            signed(follows.resonance_drift, HZ),
            f"{signed(stays.resonance_drift, HZ)} if fixed; half-bandwidth "
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


def speed_row(p: Prediction) -> Row:
    """The finger's speed that the friction is for: quantity, value, remark."""
    return "Finger speed", shown(p.speed, SPEED), "of sliding"


def reduction_row(p: Prediction) -> Row:
    """What vibration takes away of the friction."""
    reduction, coefficient = f"{p.friction_reduction:.3f}", f"{p.friction_coefficient:.3g}"
    return "Friction reduction µ − µ′", reduction, f"of µ = {coefficient}"
