"""MPEG haptics (ISO/IEC 23090-31): a texture as an .hjif file of the Friction modality.

What the format carries of a texture is one line of it: friction over the way along x. A grating of
whole frequency becomes a wave (`VectorialWave`) on a constant (`Curve`), anything else keyframes
joined by straight lines (`Curve`, linear). What is lost is listed in the export.

Units, as assumed here: the standard counts Friction without unit, from −1 to 1, per metre; its
published JSON schema could not be read, so names and checks follow the reference software
(MPEGGroup/HapticReferenceSoftware: required keys, types, semantic checks, evaluation of effects).
A value is a relative friction (1 at rest, 0 frictionless). Positions are whole numbers of
10^``unit_exponent`` m, which is always written: −3 (mm) for waves, whose frequencies are whole
numbers of 1/m (the reference software evaluates waves as position/1000 · frequency), −6 (µm) for
keyframes. ``perception_unit_exponent`` is 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from typing import Annotated, Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.contact.finger.fingertip import EXPLORING_SPEED
from squeezefilm.physics.render.program.renderer import MadeForSpeed
from squeezefilm.physics.render.texture.composition import Composable
from squeezefilm.physics.render.texture.levels import RelativeFriction
from squeezefilm.physics.render.texture.pattern import AlongX
from squeezefilm.physics.render.texture.shapes import SineWave, SquareWave

VERSION, PROFILE, LEVEL, TIMESCALE = "2023", "Main", 1, 1000
MICRO, MILLI = -6, -3
LONGEST: si.Metre = 1.0
"""Way that one export may cover (m)."""

_MOST_KEYFRAMES = 65_535
# Drift of a wave over its extent that may be lost by a frequency of whole 1/m: of a period.
_DRIFT = 1e-3
# Where else a texture is asked, to see whether it changes there: no multiples of likely periods.
_ELSEWHERE_Y = (-0.011_37, 0.002_71, 0.017_93)
_ELSEWHERE_V = (-0.08, 0.021_3, 0.167)
_ELSEWHERE_T = (0.113_7, 0.971_3)

ToFriction = Callable[[si.FloatArray], si.DimensionlessArray]
"""Values of a texture, in its quantity → relative friction (1)."""


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class ReferenceDevice:
    """Description in an export of the display that it was made for.

    `maximum_amplitude` is the greatest relative friction (1, at rest); `maximum_displacement` the
    largest vibration amplitude (m, zero-to-peak); frequencies are of the carrier (Hz).
    """

    name: str
    resonance_frequency: si.Hertz
    maximum_voltage: si.Volt
    maximum_displacement: si.Metre
    maximum_amplitude: si.Dimensionless = 1.0

    def document(self) -> dict[str, Any]:
        """Mapping in the format. Displays work at one frequency: least, largest and resonance."""
        ends = dict.fromkeys(("maximum_frequency", "minimum_frequency"), self.resonance_frequency)
        return {"id": 0, "type": "Piezo", **asdict(self), **ends}


@dataclass(frozen=True, slots=True)
class HjifExport:
    """An export: the document (`json.dumps` it), what was lost, and how near it is.

    `made_for` is the finger's speed at which the display makes this friction, and how far off it is
    at half and double of that where its player knows the place alone; None where nobody said.

    `rms_error` and `largest_error` compare relative friction on the line, as the reference
    software would evaluate the file, with the texture (1). At a step keyframes are 1 µm apart, so
    the largest error may be the step itself.
    """

    document: dict[str, Any]
    lost: tuple[str, ...]
    rms_error: si.Dimensionless
    largest_error: si.Dimensionless
    made_for: MadeForSpeed | None = None


@si.checked_numbers
def hjif_of(
    texture: Composable,
    start: Annotated[si.Metre, si.AtLeast(-10.0), si.AtMost(10.0)],
    end: si.Metre,
    *,
    device: ReferenceDevice,
    title: str = "",
    to_friction: ToFriction | None = None,
    made_for: MadeForSpeed | None = None,
    tolerance: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(0.1)] = 1e-4,
) -> HjifExport:
    """A texture along x from `start` to `end` (m, y = 0) as a document of MPEG haptics.

    Args:
        texture: what to export.
        start, end: of the line, at most 1 m; whole micrometres.
        device: the display.
        title: goes into the description.
        to_friction: the texture's values → relative friction; needed unless that is its quantity.
        made_for: the finger's speed, for a texture that asks for it (without one 80 mm/s), and what
            the friction costs on this display at others; goes into the description.
        tolerance: by which keyframes left out may change the friction (1).

    Raises:
        InputError: a value outside its range, a quantity that is not friction without
            `to_friction`, a friction beyond 0 to 1, or more than 65 535 keyframes.
    """
    si.require("end", end, si.Unit("m"), above=start, at_most=start + LONGEST)
    if to_friction is None and texture.quantity != "relative_friction":
        raise InputError(
            f"a texture of {texture.quantity} is no friction yet; pass to_friction, the display's "
            "law, or write the texture in relative_friction"
        )
    known = to_friction or (lambda values: values)
    speed = EXPLORING_SPEED if made_for is None else made_for.speed

    def friction(
        x: si.FloatArray, y: float = 0.0, v: float = speed, t: float = 0.0
    ) -> si.FloatArray:
        return np.asarray(known(texture(x, y, v, t)), dtype=float)

    lost = _lost(friction, start, end, texture)
    first, last = round(start * 1e6), round(end * 1e6)
    if abs(start * 1e6 - first) > 1e-6 or abs(end * 1e6 - last) > 1e-6:
        lost.append("start and end were rounded to whole micrometres")
    wave = _wave(texture, start, end) if to_friction is None else None
    if wave is not None:
        bands, exponent = wave, MILLI
        lost.append("the grating ends at whole millimetres, outside of its line")
    else:
        bands, exponent = [_keyframes(friction, first, last, tolerance)], MICRO
    words = title or "friction texture"
    if made_for is not None:
        words += f"; {made_for.sentence()}"
        lost.append(f"the file knows places alone: {made_for.sentence()}")
    document = _document(bands, exponent, words, device)
    rms, largest = _errors(document, friction, first * 1e-6, last * 1e-6)
    return HjifExport(document, tuple(lost), rms, largest, made_for)


def _lost(
    friction: Callable[..., si.FloatArray], start: si.Metre, end: si.Metre, texture: Composable
) -> list[str]:
    x = np.linspace(start, end, 2001)
    here = friction(x)
    si.require("relative friction", here, at_least=0.0, at_most=1.0)
    losses = [f"the texture goes on outside of {start:.6g} to {end:.6g} m"]
    for what, others in (
        ("across the line (y)", [friction(x, y=y) for y in _ELSEWHERE_Y]),
        ("with the finger's velocity", [friction(x, v=v) for v in _ELSEWHERE_V]),
        ("with time", [friction(x, t=t) for t in _ELSEWHERE_T]),
    ):
        change = max(float(np.max(np.abs(other - here))) for other in others)
        if change > 1e-9:
            losses.append(f"the friction changes {what}, by up to {change:.3g}; the file does not")
    if texture.quantity != "relative_friction":
        losses.append(
            f"the texture is of {texture.quantity}; the file holds the friction it makes on this "
            "display"
        )
    return losses


def _wave(texture: Composable, start: si.Metre, end: si.Metre) -> list[dict[str, Any]] | None:
    """Bands of a grating that the format has a wave for; None for any other texture."""
    if not isinstance(texture, RelativeFriction):
        return None
    pattern = texture.pattern
    if not isinstance(pattern, SineWave | SquareWave) or not isinstance(pattern.along, AlongX):
        return None
    if isinstance(pattern, SquareWave) and pattern.duty != 0.5:
        return None
    frequency = round(1 / pattern.spatial_period)
    first, last = math.floor(start * 1e3 + 1e-9), math.ceil(end * 1e3 - 1e-9)
    drift = abs(frequency - 1 / pattern.spatial_period) * (last - first) * 1e-3
    if frequency < 1 or drift > _DRIFT:
        return None
    # Waves begin where their effect does.
    cycles = first * 1e-3 / pattern.spatial_period
    phase = math.fmod(pattern.phase + 2 * math.pi * (cycles - math.floor(cycles)), 2 * math.pi)
    mean, swing = 0.5 * (texture.low + texture.high), 0.5 * (texture.high - texture.low)
    signal = "Sine" if isinstance(pattern, SineWave) else "Square"
    ends = (0, last - first)
    level = [_key(place, mean) for place in ends]
    keys = [{**_key(place, swing), "frequency_modulation": frequency} for place in ends]
    return [
        _band("Curve", _effect(first, level), 0),
        _band("VectorialWave", _effect(first, keys, signal, phase), frequency),
    ]


def _key(place: int, value: float) -> dict[str, Any]:
    """A keyframe at a place from its effect's begin on."""
    return {"relative_position": place, "amplitude_modulation": value}


def _keyframes(
    friction: Callable[..., si.FloatArray], first: int, last: int, tolerance: float
) -> dict[str, Any]:
    places = np.arange(first, last + 1)
    values = friction(places * 1e-6)
    kept = _thinned(values, tolerance)
    if kept.size > _MOST_KEYFRAMES:
        raise InputError(
            f"the texture needs {kept.size} keyframes and the format counts up to "
            f"{_MOST_KEYFRAMES}; export a shorter line, or allow a larger tolerance"
        )
    keyframes = [_key(int(places[k] - first), float(values[k])) for k in kept]
    return _band("Curve", _effect(first, keyframes), 0)


def _thinned(values: si.FloatArray, tolerance: float) -> np.ndarray[Any, np.dtype[np.int64]]:
    """Samples to keep so that straight lines between them miss none by more than `tolerance`
    (Ramer, Douglas and Peucker, with the distance taken along the value)."""
    keep = np.zeros(values.size, dtype=bool)
    keep[[0, -1]] = True
    todo = [(0, values.size - 1)]
    while todo:
        a, b = todo.pop()
        if b - a < 2:
            continue
        line = values[a] + (values[b] - values[a]) * np.arange(b - a + 1) / (b - a)
        miss = np.abs(values[a : b + 1] - line)
        k = int(np.argmax(miss))
        if miss[k] > tolerance:
            keep[a + k] = True
            todo += [(a, a + k), (a + k, b)]
    return np.flatnonzero(keep)


def _effect(
    position: int, keyframes: list[dict[str, Any]], signal: str = "Sine", phase: float = 0.0
) -> dict[str, Any]:
    return {
        "effect_type": "Basis",
        "position": position,
        "phase": phase,
        "base_signal": signal,
        "keyframes": keyframes,
    }


def _band(kind: str, effect: dict[str, Any], frequency: int) -> dict[str, Any]:
    curve = {"curve_type": "Linear"} if kind == "Curve" else {}
    return {
        "band_type": kind,
        **curve,
        "lower_frequency_limit": 0,
        "upper_frequency_limit": max(frequency, 1),
        "effects": [effect],
    }


def _document(
    bands: list[dict[str, Any]], exponent: int, words: str, device: ReferenceDevice
) -> dict[str, Any]:
    return {
        "version": VERSION,
        "profile": PROFILE,
        "level": LEVEL,
        "date": datetime.now(UTC).date().isoformat(),
        "description": f"{words}; relative friction along x, by squeezefilm",
        "timescale": TIMESCALE,
        "avatars": [],
        "perceptions": [
            {
                "id": 0,
                "avatar_id": 0,
                "description": words,
                "perception_modality": "Friction",
                "unit_exponent": exponent,
                "perception_unit_exponent": 0,
                "reference_devices": [device.document()],
                "effect_library": [],
                "channels": [
                    {
                        "id": 0,
                        "description": "along x",
                        "gain": 1.0,
                        "mixing_coefficient": 1.0,
                        "body_part_mask": 0,
                        "reference_device_id": 0,
                        "direction": {"X": 127, "Y": 0, "Z": 0},
                        "bands": bands,
                    }
                ],
            }
        ],
        "syncs": [],
    }


def _errors(
    document: dict[str, Any], friction: Callable[..., si.FloatArray], start: si.Metre, end: si.Metre
) -> tuple[float, float]:
    # Irrational steps, so that samples don't fall on keyframes or edges in any regular way.
    count = 20_011
    inside: si.MetreArray = start + (end - start) * np.mod(np.arange(1, count) * 0.6180339887, 1.0)
    miss = np.abs(friction_along(document, inside) - friction(inside))
    return float(np.sqrt(np.mean(miss**2))), float(np.max(miss))


@si.checked_numbers
def friction_along(document: Mapping[str, Any], x: si.MetreArray) -> si.DimensionlessArray:
    """Friction (1) of a document that `hjif_of` wrote, at places `x` (m), in the shape of `x`.

    Evaluated as the reference software does: the keyframes of a `Curve` band joined by straight
    lines, a `VectorialWave` with its amplitude linear between keyframes; 0 outside of the effects.
    """
    (perception,) = document["perceptions"]
    unit = 10.0 ** perception["unit_exponent"]
    total = np.zeros(np.shape(x))
    for band in perception["channels"][0]["bands"]:
        (effect,) = band["effects"]
        keyframes = effect["keyframes"]
        way = np.asarray(x) / unit - effect["position"]
        places = [key["relative_position"] for key in keyframes]
        level = np.interp(way, places, [key["amplitude_modulation"] for key in keyframes])
        if band["band_type"] == "VectorialWave":
            frequency = keyframes[0]["frequency_modulation"]
            cycles = way * unit * frequency + effect["phase"] / (2 * math.pi)
            sine = effect["base_signal"] == "Sine"
            square = np.where(np.mod(cycles, 1.0) < 0.5, 1.0, -1.0)
            level *= np.sin(2 * math.pi * cycles) if sine else square
        # Ends that a division by the unit moved by a rounding error still belong to the effect.
        total += np.where((way >= -1e-6) & (way <= places[-1] + 1e-6), level, 0.0)
    return total
