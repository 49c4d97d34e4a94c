"""What Design shows of a calibrated display: on what it was calibrated, and every measured number
beside the model, as its file remembers them. Nothing is computed anew."""

from __future__ import annotations

from typing import Any

from squeezefilm.core import quantities as si
from squeezefilm.core.calibration_record import CalibrationRecord, ComparedAnswer
from squeezefilm.core.errors import QuantityError
from squeezefilm.core.results import to_json
from squeezefilm.physics.display import Display

_FREQUENCY, _AMPLITUDE = "resonance frequency", "amplitude per volt"


def calibration_of(display: Display) -> dict[str, Any] | None:
    """The record of a display's calibration for the page; None where it is not calibrated.

    Beside the record's own fields: `sentence`, and what is drawn into the two charts, all of it
    measured. `responses` are resonances with their amplitude per volt, of each recording that has
    both; `frictions` are µ′/µ at vibration amplitudes. Each number is [measured, low, high], the
    ends of the calibrated model's interval (null without one).
    """
    record = display.calibration
    if record is None:
        return None
    found: dict[str, Any] = to_json(record)
    return found | {
        "sentence": record.sentence,
        "responses": _responses(record),
        "frictions": [
            {
                "vibration_amplitude_m": one.vibration_amplitude,
                "relative_friction": _between(one.relative_friction, one),
                "standard_error": one.error * one.relative_friction,
            }
            for one in record.compared
            if one.relative_friction is not None and one.vibration_amplitude is not None
        ],
    }


def _responses(record: CalibrationRecord) -> list[dict[str, Any]]:
    by_recording: dict[str, dict[str, ComparedAnswer]] = {}
    for one in record.compared:
        by_recording.setdefault(one.recording, {})[one.said] = one
    found = []
    for name, answers in by_recording.items():
        if not {_FREQUENCY, _AMPLITUDE} <= set(answers):
            continue
        try:
            point = {
                "recording": name,
                "frequency_Hz": _quantity(answers[_FREQUENCY], "Hz"),
                "amplitude_per_volt_m_per_V": _quantity(answers[_AMPLITUDE], "m/V"),
            }
        except QuantityError:
            continue  # words that somebody changed are shown as they are, and no point is drawn
        found.append(point)
    return found


def _quantity(one: ComparedAnswer, unit: str) -> list[float | None]:
    return _between(si.parse_quantity(one.measured, si.Unit(unit)), one)


def _between(measured: float, one: ComparedAnswer) -> list[float | None]:
    low, high = (one.after[0], one.after[2]) if one.after else (None, None)
    ends = [None if end is None else measured * end for end in (low, high)]
    return [measured, *ends]
