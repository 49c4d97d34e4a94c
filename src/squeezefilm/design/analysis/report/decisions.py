"""Rows of what one decides from: intervals, voltages, what is felt, what each value does."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squeezefilm.core import quantities as si
from squeezefilm.core.kit.numbers import M, V, shown
from squeezefilm.physics.perception.felt import FINEST_TRIED

if TYPE_CHECKING:
    from squeezefilm.core.kit.numbers import Row
    from squeezefilm.design.analysis.felt import FeltAt, FeltGratings
    from squeezefilm.design.analysis.sensitivities import (
        DisplaySensitivities,
        DisplaySensitivity,
        Shift,
    )
    from squeezefilm.design.analysis.wanted import Wanted
    from squeezefilm.physics.uncertainty.uncertainty import UncertainFriction

_W = si.Unit("W")
SHOWN = 12


def interval_rows(unsure: UncertainFriction | None) -> list[Row]:
    """The intervals of amplitude and power: quantity, value, remark."""
    if unsure is None or unsure.amplitude_interval is None:
        return []
    low, high = (shown(end, M, 3) for end in unsure.amplitude_interval)
    rows = [("", f"{low} to {high}", f"{100 * unsure.level:.0f} % interval of the amplitude")]
    if unsure.power is not None:
        rows.append(("Power taken", shown(unsure.power, _W, 3), "plate and finger, cold"))
    if unsure.power_interval is not None:
        low, high = (shown(end, _W, 3) for end in unsure.power_interval)
        rows.append(("", f"{low} to {high}", f"{100 * unsure.level:.0f} % interval of the power"))
    return rows


def wanted_rows(wanted: Wanted | None) -> list[Row]:
    """Rows of what a wanted friction takes, as described and over the draws."""
    if wanted is None:
        return []
    label = f"For µ′/µ = {wanted.relative_friction:.3g}"
    if wanted.voltage is None or wanted.vibration_amplitude is None:
        rows = [(label, "not reached", wanted.why_not)]
    else:
        amplitude = f"{shown(wanted.vibration_amplitude, M, 3)}, as described"
        rows = [(label, shown(wanted.voltage, V, 3), amplitude)]
    unsure = wanted.uncertain
    if unsure is None:
        why = wanted.why_no_interval
        return [*rows, ("", "no interval", why)] if why else rows
    low, high = (_volts(end) for end in unsure.interval)
    rows.append(
        (
            "",
            f"{low} to {high}",
            f"{100 * unsure.level:.0f} % interval, median {_volts(unsure.median)}",
        )
    )
    within = f"{100 * (1 - unsure.beyond):.0f} %"
    never = f"; in {100 * unsure.never:.0f} % no voltage does" if unsure.never else ""
    remark = f"of the draws reach it at the drive's {shown(unsure.limit, V)}{never}"
    return [*rows, ("", within, remark)]


def _volts(value: si.Volt | None) -> str:
    return "out of reach" if value is None else shown(value, V, 3)


def felt_rows(felt: FeltGratings | None, speed: si.MetrePerSecond | None = None) -> list[Row]:
    """The finest grating that is felt, by finger speed; at one of them only (m/s) if asked."""
    if felt is None:
        return []
    return [
        (
            f"Finest grating felt at {1e3 * at_speed.speed:g} mm/s",
            _period(at_speed.felt),
            _felt_remark(felt, at_speed),
        )
        for at_speed in felt.at
        if speed in (None, at_speed.speed)
    ]


def _felt_remark(felt: FeltGratings, at_speed: FeltAt) -> str:
    survives = f"; {shown(at_speed.survives, M, 2)} survives the resonator"
    if at_speed.interval is None:
        return f"by the senses of '{felt.observer}'{survives}"
    low, high = (_period(end) for end in at_speed.interval)
    said = "in all draws"
    if low != high:
        said = f"{low} at best and {high} at worst ({si.percent(felt.level)} interval)"
    never = f"; none is felt in {si.percent(at_speed.never)} of the draws" if at_speed.never else ""
    return said + never + survives


def _period(value: si.Metre | None) -> str:
    if value is None:
        return "none"
    if value < 1.001 * FINEST_TRIED:
        return f"{shown(FINEST_TRIED, M, 3)} or finer"
    return shown(value, M, 2)


def sensitivity_rows(sensitivities: DisplaySensitivities) -> list[list[str]]:
    """The values that change the friction or the frequency most: path, from where to where,
    shifts of frequency and amplitude, µ′/µ, and whose range it is."""
    most = sorted(sensitivities.rows, key=_weight, reverse=True)[:SHOWN]
    return [
        [
            row.path,
            " to ".join(_value(end.value, row.unit) for end in (row.low, row.high)),
            _shifts(row.low.frequency_shift, row.high.frequency_shift),
            _shifts(row.low.amplitude_shift, row.high.amplitude_shift),
            _frictions(row.low, row.high),
            "as described" if row.origin == "given" else "assumed",
        ]
        for row in most
    ]


def _weight(sensitivity: DisplaySensitivity) -> float:
    """A change of friction by 0.1 stands beside one of the frequency by 2 %; what could not be
    told stands last."""
    moved = [sensitivity.low.frequency_shift, sensitivity.high.frequency_shift]
    if None in moved:
        return -1.0
    return max(sensitivity.friction_change / 0.1, *(abs(shift or 0.0) / 0.02 for shift in moved))


def _value(value: float, unit: str) -> str:
    return f"{value:.3g}" if unit == "1" else si.format_quantity(value, si.Unit(unit), 3)


def _shifts(low: float | None, high: float | None) -> str:
    if low is None or high is None:
        return "not known"
    if low == high == 0:
        return "–"
    return f"{100 * low:+.2g} %, {100 * high:+.2g} %".replace("-", "−")


def _frictions(low: Shift, high: Shift) -> str:
    each = [
        "–" if end.relative_friction is None else f"{end.relative_friction:.2f}"
        for end in (low, high)
    ]
    return ", ".join(each)
