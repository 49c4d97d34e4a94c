"""Numbers of a display in the Design area: numbers, curves and shapes, as JSON with units in keys.

Two qualities: `screening` takes a plate as a Timoshenko beam and answers while a slider moves;
`solved` solves it in three dimensions. Each answer says which made it.
"""

from __future__ import annotations

import dataclasses
import warnings
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, Field

from squeezefilm.core import quantities as si
from squeezefilm.core.calibration_record import CalibrationRecord, ComparedAnswer
from squeezefilm.core.errors import InputError, QuantityError, SqueezefilmError
from squeezefilm.core.progress import Pace
from squeezefilm.core.results import stamp, to_json, values_of
from squeezefilm.lab.designing.form import (
    LONGEST_VALUE,
    covered,
    display_of,
    edited,
    form,
    stretched,
)
from squeezefilm.lab.wire import Name, Text
from squeezefilm.lab.worker import tell
from squeezefilm.physics.chain.area_map import active_area
from squeezefilm.physics.chain.friction import where_known
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.electronics import load_of_mode
from squeezefilm.physics.plate.layout import Actuator, AnnularStator, DiscPlate, RectangularPlate
from squeezefilm.physics.plate.solid.working import response_frequencies, solid_mode
from squeezefilm.physics.plausibility.checks import require_plausible
from squeezefilm.physics.uncertainty.uncertainty import friction_bands

STRETCHED = "stretch the ceramics"
"""Word in place of a value."""
QUALITIES = ("screening", "solved")
_BEAM: si.Dimensionless = 0.13
_POINTS = 49
_LEAST_SPAN = 2e-6
_GRID = (84, 42)
_MAP = 64


def opened(text: str) -> dict[str, Any]:
    """A display's text with all that its form shows. Raises as `description.display_of`."""
    display = display_of(text)
    return {
        "text": text,
        "name": display.name,
        "title": display.title,
        "form": form(text),
        "outline": outline(text),
        "covered": covered(display.actuator),
        "calibration": calibration_of(display),
    }


def changed(text: str, path: str, value: str) -> dict[str, Any]:
    """Display as by `opened`, with one value anew, or the side at `path` covered by ceramics where
    it is `STRETCHED`. Raises as `form.edited` and `ceramics.stretched`."""
    if value == STRETCHED:
        path, value, text = "name", display_of(text).name, stretched(text, path)
    return opened(edited(text, path, value))


ValuePath = Annotated[str, Field(max_length=200)]
"""Dotted path of a value of a display."""
TypedValue = Annotated[str, Field(max_length=LONGEST_VALUE)]


class DesignPoint(BaseModel):
    """A display's text at a working point; `path` and `value` are an edit made on the way, so that
    a slider asks once.

    `voltage` and `force` are quantity texts, None for the display's own.
    """

    text: Text
    voltage: Name | None = None
    surface: Name | None = None
    force: Name | None = None
    path: ValuePath | None = None
    value: TypedValue | None = None

    def edited(self) -> str:
        """The text with the edit. Raises as `form.edited`."""
        if self.path is None or self.value is None:
            return self.text
        return edited(self.text, self.path, self.value)


def designed(point: DesignPoint, quality: str) -> dict[str, Any]:
    """The text, the numbers, curves and shape of a display at a working point. Keys carry units.

    Raises:
        InputError: a text that is no display, an edit that cannot be made, or a working point it
            does not have.
    """
    text = point.edited()
    display = display_of(text)
    require_plausible(display)
    if quality == "solved" and isinstance(display.actuator, RectangularPlate):
        # What takes the time, told while it is solved; it is kept for what is asked of it below.
        solid_mode(display.actuator, pace=Pace(tell=tell))
    p = predicted(display, quality, point)
    mode = p.mode
    span = max(2.0 * p.vibration_amplitude, _LEAST_SPAN)
    amplitude = np.linspace(0.0, span, _POINTS)
    frequency = response_frequencies(mode.resonance_frequency, mode.quality_factor, 121)
    # Fitting a stator takes seconds: not while a value is dragged.
    load = None
    if quality == "solved":
        load = load_of_mode(display.actuator, mode, p.voltage, p.frequency)
    return {
        **p.summary(),
        "text": text,
        "quality": quality,
        "name": display.name,
        "title": display.title,
        "surfaces": [surface.name for surface in display.surfaces],
        "free_amplitude_m": p.touch.free_amplitude,
        "vibration_model": p.amplitude_model,
        "friction_model": p.model,
        "friction_curve": {
            "amplitude_m": amplitude.tolist(),
            "relative_friction": to_json(p.law.curve(amplitude)),
            "paper2008": to_json(where_known(p.law.by("paper2008").curve, amplitude)),
        },
        "response": {
            "frequency_Hz": frequency.tolist(),
            "amplitude_per_volt_m_per_V": to_json(mode.response(frequency)),
        },
        "since_screening": _since_screening(display, p, point) if quality == "solved" else "",
        "active_area": _area(display, p),
        "line": _line(p, display.actuator),
        "shape": _shape(p),
        "drive_electronics": to_json(load),
        "provenance": stamp(display),
    }


def _since_screening(display: Display, p: Prediction, point: DesignPoint) -> str:
    """Reason why a solved plate is another than it was screened; "" where it differs by no more
    than a beam's frequency does on 95 random plates (`_BEAM`)."""
    if not isinstance(display.actuator, RectangularPlate):
        return ""
    try:
        beam = predicted(display, "screening", point)
    except SqueezefilmError:
        return ""
    metre, hertz = si.Unit("m"), si.Unit("Hz")
    before, after = (
        f"{si.format_quantity(prediction.vibration_amplitude, metre, 3)} at "
        f"{si.format_quantity(prediction.mode.resonance_frequency, hertz, 3)}"
        for prediction in (beam, p)
    )
    shares = (
        beam.vibration_amplitude / p.vibration_amplitude,
        beam.mode.resonance_frequency / p.mode.resonance_frequency,
    )
    if all(abs(share - 1.0) <= _BEAM for share in shares):
        return ""
    return (
        f"The screening gave {before}; the full solution gives {after}; use the full solution. The "
        "screening treats the plate as a uniform beam, which is right to "
        f"{si.percent(_BEAM)}, and misses bending across the width and nearby modes."
    )


def banded(point: DesignPoint, quality: str, samples: int = 64) -> dict[str, Any]:
    """The friction curve's band on every third amplitude that `designed` draws it on.

    Raises as `designed`.
    """
    display = display_of(point.edited())
    p = predicted(display, quality, point)
    amplitude = np.linspace(0.0, max(2.0 * p.vibration_amplitude, _LEAST_SPAN), _POINTS)
    band: dict[str, Any] = to_json(
        friction_bands(display, p, amplitude[::3], samples=samples, progress=tell)[0]
    )
    return band


def predicted(display: Display, quality: str, point: DesignPoint) -> Prediction:
    """The prediction of a display at a working point's voltage, surface and force, by the theory
    of a quality.

    Raises `InputError` as `designed` does.
    """
    si.require_one_of("quality", quality, QUALITIES)
    plate = isinstance(display.actuator, RectangularPlate)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return predict(
            display,
            voltage=None
            if point.voltage is None
            else si.parse_quantity(point.voltage, si.Unit("V")),
            normal_force=None
            if point.force is None
            else si.parse_quantity(point.force, si.Unit("N")),
            surface=point.surface,
            theory=("timoshenko" if quality == "screening" else "solid") if plate else None,
        )


def _area(display: Display, p: Prediction) -> dict[str, Any] | None:
    """The range of friction over the active area and a small map, row by row in y.

    None for a plate that is not solved: a beam's is alike all across, which no plate is.
    """
    solved = p.mode.solid is not None or not isinstance(display.actuator, RectangularPlate)
    area = active_area(display, p.mode, p.law, p.drive) if solved else None
    if area is None:
        return None
    shown = {**area.summary(), "said": area.sentence, "map": None}
    if area.relative_friction is not None:
        every = [max(-(-size // _MAP), 1) for size in area.relative_friction.shape]
        thin = area.relative_friction[:: every[0], :: every[1]].T
        shown["map"] = {
            "columns": thin.shape[1],
            "rows": thin.shape[0],
            "relative_friction": to_json(np.round(thin.ravel(), 4)),
        }
    return shown


def _shape(p: Prediction) -> dict[str, Any] | None:
    """The mode over the upper face, row by row, 1 at its highest point; None unless solved."""
    solid = p.mode.solid
    if solid is None:
        return None
    plate = solid.modes.plate
    x, y = np.linspace(0, plate.length, _GRID[0]), np.linspace(0, plate.width, _GRID[1])
    field = solid.modes.field(solid.index, x, y, plate.thickness)[:, :, 2]
    largest = float(np.abs(field).max())
    return {
        "columns": _GRID[0],
        "rows": _GRID[1],
        "deflection": np.round(field.T.ravel() / largest, 4).tolist(),
    }


def _line(p: Prediction, actuator: Actuator) -> dict[str, Any] | None:
    """The mode along or across the plate, a diameter, or the mean circumference: 1 at the working
    lobe. `along` is the plate's axis that the positions are on."""
    line = p.mode.line
    if line is not None:
        across = actuator.lines_across == "width"
        return {
            "along": "y" if across else "x",
            "position_m": line.position[::4].tolist(),
            "deflection": line.deflection[::4].tolist(),
            "nodal_positions_m": line.nodal_positions.tolist(),
        }
    if not isinstance(actuator, AnnularStator):
        return None
    along = np.linspace(0.0, np.pi * actuator.mean_diameter, 241)
    quarter = actuator.wavelength / 4
    nodes = np.arange(quarter, along[-1], 2 * quarter)
    return {
        "along": "x",
        "position_m": along.tolist(),
        "deflection": np.cos(2 * np.pi * along / actuator.wavelength).tolist(),
        "nodal_positions_m": nodes.tolist(),
    }


def outline(text: str) -> dict[str, Any]:
    """Measures (m) for plan and side view: the body, its strips, where they are."""
    actuator = display_of(text).actuator
    if isinstance(actuator, RectangularPlate):
        return {
            "kind": "plate",
            **values_of(actuator, "length width thickness patches"),
        }
    if isinstance(actuator, DiscPlate):
        return {"kind": "disc", "diameter_m": actuator.diameter}
    if isinstance(actuator, AnnularStator):
        return {
            "kind": "ring",
            "diameter_m": actuator.mean_diameter,
            "radial_width_m": actuator.radial_width,
        }
    raise InputError(f"an actuator of type '{actuator.type}' cannot be drawn")


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
    values: dict[str, Any] = to_json(dataclasses.replace(record, answers=()))
    return values | {
        "sentence": record.sentence,
        "responses": _responses(record),
        "frictions": [
            {
                "vibration_amplitude_m": point.vibration_amplitude,
                "relative_friction": _between(point.relative_friction, point),
                "standard_error": point.error * point.relative_friction,
            }
            for point in record.compared
            if point.relative_friction is not None and point.vibration_amplitude is not None
        ],
    }


def _responses(record: CalibrationRecord) -> list[dict[str, Any]]:
    by_recording: dict[str, dict[str, ComparedAnswer]] = {}
    for answer in record.compared:
        by_recording.setdefault(answer.recording, {})[answer.said] = answer
    responses = []
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
        responses.append(point)
    return responses


def _quantity(answer: ComparedAnswer, unit: str) -> list[float | None]:
    return _between(si.parse_quantity(answer.measured, si.Unit(unit)), answer)


def _between(measured: float, answer: ComparedAnswer) -> list[float | None]:
    low, high = (answer.after[0], answer.after[2]) if answer.after else (None, None)
    ends = [None if end is None else measured * end for end in (low, high)]
    return [measured, *ends]
