"""Data for rendering in the Feel area: a program, the display's friction, its envelope.

The page runs the same program as a device's loop, by the JavaScript port of the interpreter;
`parity` gives it samples with the compiled interpreter's answers, so that it can show that both
agree.
"""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any, Literal

import numpy as np
from pydantic import BaseModel

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.results import stamp, to_json
from squeezefilm.lab.designing.form import display_of
from squeezefilm.lab.designing.numbers import DesignPoint, predicted
from squeezefilm.lab.wire import Name, Text
from squeezefilm.physics.chain.played_texture import FingerMotion, lowered, require_on_display
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.chain.standing_wave import (
    factor_of_law,
    resonance_with_finger,
    wave_factors,
)
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.layout import DiscPlate
from squeezefilm.physics.render.program.inverse import LOWEST_SPEED
from squeezefilm.physics.render.program.lowering import Program
from squeezefilm.physics.render.program.renderer import render
from squeezefilm.physics.texture_files.image_file import picture_from
from squeezefilm.physics.texture_files.texture_file import (
    TextureFile,
    load_texture,
    texture_from_text,
)
from squeezefilm.physics.texture_files.trajectories import motion_from

_KNOTS = 257
_LEAST_REDUCTION = 1e-6  # of friction, far below what anybody feels
_SKIN = ("mass", "stiffness", "damping")


class TextureOnDisplay(BaseModel):
    """A texture, a preset's name or a TOML text, on a display's TOML text, of which the quality
    (see `numbers`) is asked for."""

    display: Text
    texture: Text | None = None
    preset: Name | None = None
    quality: Literal["screening", "solved"] = "screening"


def _ready(
    asked: TextureOnDisplay, folder: Path
) -> tuple[Display, TextureFile, Prediction, Program]:
    """The display, the texture, and the program that it is for the display's prediction."""
    if asked.preset is not None and asked.texture is None:
        texture = load_texture(asked.preset)
    elif asked.texture is not None and asked.preset is None:
        texture = texture_from_text(asked.texture, folder=folder)
    else:
        raise InputError("say which texture: a preset or a text, one of them")
    display = display_of(asked.display)
    p = predicted(display, asked.quality, DesignPoint(text=asked.display))
    if p.vibration_amplitude <= 0.0 or p.relative_friction > 1.0 - _LEAST_REDUCTION:
        raise InputError(
            f"display '{display.name}' changes no friction at {p.voltage or 0.0:g} V, so it "
            "renders no texture; give it a voltage in the Design area"
        )
    return display, texture, p, lowered(texture, p, p.inverse)


def title_of(text: str, folder: Path) -> str:
    """The title of a texture's text, whose pictures lie in `folder`.

    Raises `ConfigError` as `texture_from_text` does.
    """
    return texture_from_text(text, folder=folder).title


def pixels_of(data: bytes, name: str) -> tuple[int, int, str]:
    """Rows and columns of a picture's bytes, and what `picture_from` warns of.

    Raises `InputError` as `picture_from` does.
    """
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        rows, columns = picture_from(data, name).shape
    return rows, columns, "; ".join(str(warning.message) for warning in said)


def feel(asked: TextureOnDisplay, folder: Path) -> dict[str, Any]:
    """Program, friction (a row for each speed), envelope, wave and skin of a texture on a display;
    the texture's pictures lie in `folder`.

    Raises:
        InputError: a display or a texture that cannot be used, or a display that does not vibrate.
    """
    display, texture, p, program = _ready(asked, folder)
    friction, largest = p.friction, p.vibration_amplitude
    amplitude = np.linspace(0.0, largest, _KNOTS)
    quality_factor, resonance = resonance_with_finger(p)
    actuator = display.actuator
    width, height = actuator.extent
    wave = None
    if not isinstance(actuator, DiscPlate):
        factors = wave_factors(display, p)
        along = np.linspace(0.0, 2 * p.mode.half_wavelength, 129)
        across = actuator.lines_across == "width"
        share = factors.factor(0.0, along) if across else factors.factor(along, 0.0)
        wave = {
            "period_m": 2 * p.mode.half_wavelength,
            "factor": (share / factor_of_law(p, factors)).tolist(),
            "along": "y" if across else "x",
        }
    pad = display.finger.fingerpad
    return {
        "title": texture.title or f"a texture of {texture.texture.quantity}",
        "quantity": texture.texture.quantity,
        "program": program.array.tolist(),
        "amplitude_m": amplitude.tolist(),
        "finger_speed_m_per_s": friction.speed.tolist(),
        "nominal_finger_speed_m_per_s": friction.nominal_speed,
        "lowest_finger_speed_m_per_s": LOWEST_SPEED,
        "relative_friction": friction(amplitude, friction.speed[:, None]).tolist(),
        "friction_coefficient": p.friction_coefficient,
        "normal_force_N": p.normal_force,
        "envelope_time_constant_s": float(quality_factor / (np.pi * resonance)),
        "resonance_frequency_Hz": float(resonance),
        "half_wavelength_m": p.mode.half_wavelength,
        "largest_amplitude_m": largest,
        "voltage_V": p.voltage,
        "contact_length_m": display.finger.contact_length,
        "width_m": width,
        "height_m": height,
        "wave": wave,
        "skin": {name: getattr(pad, name) for name in _SKIN},
        "vibration_model": p.amplitude_model,
        "friction_model": p.model,
        "display": display.name,
        "provenance": stamp((display, texture)),
    }


def parity(asked: TextureOnDisplay, folder: Path, ticks: int = 2000) -> dict[str, Any]:
    """A random walk of samples with the amplitudes (m) that the compiled interpreter gives."""
    display, _, _, program = _ready(asked, folder)
    width, height = display.actuator.extent
    rng = np.random.default_rng(20261121)
    t = np.cumsum(rng.uniform(1e-4, 4e-3, ticks))
    v = 0.3 * rng.standard_normal(ticks)
    x = width * rng.random(ticks)
    y = height * rng.random(ticks)
    # Some samples that a sensor should never send.
    x[rng.integers(0, ticks, 5)] = np.nan
    done = render(program, x, y, v, t)
    return {
        "display": display.name,
        "x_m": to_json(x),
        "y_m": y.tolist(),
        "v_m_per_s": v.tolist(),
        "t_s": t.tolist(),
        "amplitude_m": done.amplitude.tolist(),
    }


LONGEST: si.Second = 86_400.0
"""Longest time of one session."""


def require_playable(
    text: str, drive: str, duration: str, voltage: str | None, stroke: str
) -> tuple[si.Second, si.Volt | None]:
    """The duration (s) and the most voltage (V; None: the display's own) that were typed.

    `text` is a display's, `drive` "twin" or a port, `stroke` what a twin's finger does, in words.
    Raises `InputError` for what is no such quantity, a voltage above the display's limits, or a
    finger that leaves the display; `ConfigError` for a text that is no display.
    """
    lasts = si.parse_quantity(duration, si.Unit("s"))
    most = None if voltage is None else si.parse_quantity(voltage, si.Unit("V"))
    si.require("duration", lasts, si.Unit("s"), above=0.0, at_most=LONGEST)
    if most is not None:
        si.require("voltage", most, si.Unit("V"), above=0.0)
    display = display_of(text)
    p = predicted(display, "screening", DesignPoint(text=text, voltage=voltage))
    if p.voltage is not None:
        display.limits(p.frequency, p.voltage, twin=drive == "twin")
    if drive == "twin":
        require_on_display(display.actuator, FingerMotion.of(motion_from(stroke), 1e3))
    return lasts, most
