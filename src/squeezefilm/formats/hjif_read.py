"""MPEG haptics read back: the friction of an .hjif file along its way, and a texture of it.

Evaluated as the reference software does it: keyframes of `Curve` bands joined linearly or by
smooth cubics, waves of `VectorialWave` bands with their amplitude linear between keyframes. Effects
of other bands are left out and listed. See `hjif` for the units assumed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.config.scan import require_quick_json
from squeezefilm.errors import InputError
from squeezefilm.hard_limits import HJIF_BYTES
from squeezefilm.regular_file import parsed_json, read_regular_text
from squeezefilm.render.texture.image import LARGEST_PIXEL, MOST_PIXELS, Image
from squeezefilm.render.texture.levels import RelativeFriction
from squeezefilm.render.texture.pattern import Pattern
from squeezefilm.render.texture.shapes import SineWave, SquareWave

_COARSE: si.Metre = 10e-6
_SIGNALS = ("Sine", "Square", "Triangle", "SawToothUp", "SawToothDown")
_Kind = type | tuple[type, ...]
_NUMBER = (int, float)
# Which keys an object must have, each with its type.
_NEEDED: dict[str, dict[str, _Kind]] = {
    "experience": {
        "version": str,
        "profile": str,
        "level": int,
        "date": str,
        "description": str,
        "timescale": int,
        "avatars": list,
        "perceptions": list,
        "syncs": list,
    },
    "perception": {
        "id": int,
        "avatar_id": int,
        "description": str,
        "perception_modality": str,
        "channels": list,
        "effect_library": list,
    },
    "channel": {
        "id": int,
        "description": str,
        "gain": _NUMBER,
        "mixing_coefficient": _NUMBER,
        "body_part_mask": int,
        "bands": list,
    },
    "band": {
        "band_type": str,
        "lower_frequency_limit": int,
        "upper_frequency_limit": int,
        "effects": list,
    },
    "effect": {
        "effect_type": str,
        "position": int,
        "phase": _NUMBER,
        "base_signal": str,
        "keyframes": list,
    },
    "reference": {"effect_type": str, "position": int, "id": int},
    "keyframe": {},
}
# Which keys a keyframe may have.
_OF_KEYFRAME: dict[str, _Kind] = {
    "relative_position": int,
    "amplitude_modulation": _NUMBER,
    "frequency_modulation": int,
}


@dataclass(frozen=True, slots=True)
class HjifImport:
    """A texture of a file: friction along x from `start` to `end` (m), and what was left out."""

    texture: RelativeFriction
    start: si.Metre
    end: si.Metre
    lost: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _Line:
    """The effects of a file's first friction channel: each with its band, and the scale."""

    unit: si.Metre
    scale: float
    effects: tuple[tuple[dict[str, Any], dict[str, Any]], ...]
    lost: tuple[str, ...]


def read_hjif(path: str | Path) -> HjifImport:
    """The texture in an .hjif file. Raises `InputError` for a file that is none, saying where."""
    text = read_regular_text(path, HJIF_BYTES, "an HJIF file")
    try:
        require_quick_json(text)
        document = parsed_json(text)
    except ValueError as error:
        raise InputError(f"{path} is no JSON that can be read, so no HJIF: {error}") from error
    try:
        return texture_of_hjif(document)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def require_hjif(document: Any) -> None:
    """Refuse a document that the reference software would not load, naming the place.

    Checked are the keys it needs, their types, and that every number is finite. Raises
    `InputError`.
    """
    _needs(document, "experience", "the file")
    for p, perception in enumerate(document["perceptions"]):
        where = f"perceptions[{p}]"
        _needs(perception, "perception", where)
        for e, effect in enumerate(perception["effect_library"]):
            _effect(effect, f"{where}.effect_library[{e}]")
        for c, channel in enumerate(perception["channels"]):
            place = f"{where}.channels[{c}]"
            _needs(channel, "channel", place)
            for b, band in enumerate(channel["bands"]):
                _needs(band, "band", f"{place}.bands[{b}]")
                for e, effect in enumerate(band["effects"]):
                    _effect(effect, f"{place}.bands[{b}].effects[{e}]")


def _effect(effect: Any, where: str) -> None:
    if isinstance(effect, dict) and effect.get("effect_type") == "Reference":
        _needs(effect, "reference", where)
        return
    _needs(effect, "effect", where)
    if effect["base_signal"] not in _SIGNALS:
        raise InputError(f"{where}.base_signal = {effect['base_signal']!r} is not known")
    for k, keyframe in enumerate(effect["keyframes"]):
        _needs(keyframe, "keyframe", f"{where}.keyframes[{k}]")
        for key, kind in _OF_KEYFRAME.items():
            if key in keyframe:
                _right(keyframe[key], kind, f"{where}.keyframes[{k}].{key}")


def _needs(value: Any, kind: str, where: str) -> None:
    if not isinstance(value, dict):
        raise InputError(f"{where} is no JSON object, so the file is no HJIF")
    for key, wanted in _NEEDED[kind].items():
        if key not in value:
            raise InputError(f"{where} has no '{key}', which HJIF needs")
        _right(value[key], wanted, f"{where}.{key}")


def _right(value: Any, kind: _Kind, where: str) -> None:
    if isinstance(value, bool) or not isinstance(value, kind):
        raise InputError(f"{where} = {value!r} is of the wrong type for HJIF")
    if isinstance(value, int | float) and not (math.isfinite(value) and abs(value) < 2**53):
        raise InputError(f"{where} = {value!r} is no number that HJIF can hold")


def texture_of_hjif(document: Any) -> HjifImport:
    """The texture in a document of MPEG haptics.

    A grating that is one wave on a constant becomes a `SineWave` or `SquareWave`, anything else an
    `Image` of one row, exact where its keyframes fit on an even grid of at most 1 048 576.

    Raises:
        InputError: a document that is no HJIF, has no Friction, says no unit, or goes below 0.
    """
    line = _line(document)
    start, end = _extent(line)
    wave = _as_wave(line)
    if wave is not None:
        return HjifImport(wave, start, end, line.lost)
    steps = [
        round(effect["position"] + key.get("relative_position", 0))
        for _, effect in line.effects
        for key in effect["keyframes"]
    ]
    curves = all(band["band_type"] == "Curve" for band, _ in line.effects)
    smooth = any(band.get("curve_type") != "Linear" for band, _ in line.effects)
    step = math.gcd(*(one - steps[0] for one in steps)) * line.unit
    lost = list(line.lost)
    # Keyframes lie on the finer grid as well.
    step /= max(1, math.ceil(step / LARGEST_PIXEL))
    if not curves or smooth:
        step = min(step, _COARSE)
        lost.append(f"waves and cubics were sampled every {step * 1e6:.4g} µm")
    if (end - start) / step + 1 > MOST_PIXELS or step < 1e-6:
        step = max(1e-6, (end - start) / (MOST_PIXELS - 1))
        lost.append(f"keyframes lie closer than an image can hold; sampled every {step:.3g} m")
    count = max(2, round((end - start) / step) + 1)
    places = start + step * np.arange(count)
    values = _along(line, np.minimum(places, end))
    low, high = float(values.min()), float(values.max())
    if low < 0.0:
        raise InputError(f"the file's friction goes down to {low:.4g}; a friction is at least 0")
    if high > 1.0:
        raise InputError(
            f"the file's friction goes up to {high:.4g}; relative friction is 1 at rest, and no "
            "vibration makes more: scale the file's gain down"
        )
    spread = high - low
    shares = np.clip((values - low) / spread, 0.0, 1.0) if spread > 0 else np.zeros(count)
    image = Image.from_array(shares[None, :], step, left=start - 0.5 * step, bottom=-0.5 * step)
    return HjifImport(RelativeFriction(image, low, high), start, end, tuple(lost))


@si.checked_numbers
def friction_along(document: Any, x: si.MetreArray) -> si.DimensionlessArray:
    """The friction of a document at places along its way (1), in the shape of `x` (m).

    0 outside of its effects. Raises `InputError` as `texture_of_hjif` does.
    """
    return _along(_line(document), np.asarray(x, dtype=float))


def _line(document: Any) -> _Line:
    require_hjif(document)
    lost: list[str] = []
    found = None
    for number, perception in enumerate(document["perceptions"]):
        if perception["perception_modality"] != "Friction":
            lost.append(f"perception {number} is {perception['perception_modality']}, no Friction")
        elif found is None:
            found = perception
        else:
            lost.append(f"perception {number} is a second Friction; the first is read")
    if found is None or not found["channels"]:
        raise InputError("the file has no Friction with a channel; nothing of it can be felt here")
    lost += [f"channel {n} was left out" for n in range(1, len(found["channels"]))]
    exponent = found.get("unit_exponent")
    if isinstance(exponent, bool) or not isinstance(exponent, int) or not -9 <= exponent <= 0:
        raise InputError(
            f"unit_exponent = {exponent!r} of the Friction does not say what its positions are in; "
            "write -3 for mm or -6 for µm"
        )
    power = found.get("perception_unit_exponent", 0)
    if isinstance(power, bool) or not isinstance(power, int) or not -9 <= power <= 9:
        raise InputError(f"perception_unit_exponent = {power!r} cannot be used; give -9 to 9")
    channel = found["channels"][0]
    library = {effect.get("id"): effect for effect in found["effect_library"]}
    effects = tuple(_effects(channel, library, lost))
    if not effects:
        raise InputError("the Friction has no effect that can be read (curves and waves are)")
    scale = float(channel["gain"]) * 10.0**power
    return _Line(10.0**exponent, scale, effects, tuple(lost))


def _effects(
    channel: dict[str, Any], library: dict[Any, dict[str, Any]], lost: list[str]
) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    for band in channel["bands"]:
        for effect in band["effects"]:
            whole = effect
            if effect["effect_type"] == "Reference":
                if effect["id"] not in library or "keyframes" not in library[effect["id"]]:
                    raise InputError(f"the effect {effect['id']} is not in the library")
                whole = {**library[effect["id"]], "position": effect["position"]}
            kind, curve = band["band_type"], band.get("curve_type", "Linear")
            if kind not in ("Curve", "VectorialWave") or curve not in ("Linear", "Cubic"):
                lost.append(f"an effect of a {kind} band ({curve}) was left out")
            elif kind == "VectorialWave" and len(_frequencies(whole)) != 1:
                lost.append("a wave whose frequency changes was left out")
            elif not any("amplitude_modulation" in key for key in whole["keyframes"]):
                lost.append("an effect without amplitudes was left out")
            else:
                yield band, whole


def _extent(line: _Line) -> tuple[si.Metre, si.Metre]:
    first = min(effect["position"] for _, effect in line.effects)
    last = max(effect["position"] + _length(effect) for _, effect in line.effects)
    start, end = first * line.unit, last * line.unit
    if not end > start:
        raise InputError("the effects of the file have no extent; a texture needs a way")
    if not -10.0 <= start < end <= 10.0:
        raise InputError(f"the file goes from {start:.4g} to {end:.4g} m; ±10 m are allowed")
    return start, end


def _length(effect: dict[str, Any]) -> int:
    """How far an effect reaches from its position on."""
    places: list[int] = [key.get("relative_position", 0) for key in effect["keyframes"]]
    return max(places)


def _frequencies(effect: dict[str, Any]) -> set[int]:
    """The frequencies that a wave has in its keyframes (1/m)."""
    keys = effect["keyframes"]
    return {key["frequency_modulation"] for key in keys if "frequency_modulation" in key}


def _keys(effect: dict[str, Any]) -> tuple[si.FloatArray, si.FloatArray]:
    keys = [key for key in effect["keyframes"] if "amplitude_modulation" in key]
    places = np.array([float(key.get("relative_position", 0)) for key in keys])
    values = np.array([float(key["amplitude_modulation"]) for key in keys])
    order = np.argsort(places, kind="stable")
    return places[order], values[order]


def _along(line: _Line, x: si.MetreArray) -> si.DimensionlessArray:
    total = np.zeros(x.shape)
    for band, effect in line.effects:
        way = x / line.unit - effect["position"]
        places, values = _keys(effect)
        # Ends that a division by the unit moved by a rounding error still belong to the effect.
        inside = (way >= -1e-6) & (way <= _length(effect) + 1e-6)
        level = np.interp(way, places, values)
        if band["band_type"] == "Curve":
            if band.get("curve_type", "Linear") == "Cubic" and places.size > 1:
                level = _cubic(way, places, values)
        else:
            (frequency,) = _frequencies(effect)
            cycles = way * line.unit * frequency + effect["phase"] / (2 * math.pi)
            level = level * _signal(effect["base_signal"], cycles)
        total = total + np.where(inside, level, 0.0)
    return line.scale * total


def _cubic(way: si.FloatArray, places: si.FloatArray, values: si.FloatArray) -> si.FloatArray:
    k = np.clip(np.searchsorted(places, way, side="right") - 1, 0, places.size - 2)
    width = np.where(places[k + 1] > places[k], places[k + 1] - places[k], 1.0)
    s = np.clip((way - places[k]) / width, 0.0, 1.0)
    return np.asarray(values[k] + (values[k + 1] - values[k]) * s * s * (3 - 2 * s))


def _signal(name: str, cycles: si.FloatArray) -> si.FloatArray:
    share = cycles - np.floor(cycles)
    if name == "Sine":
        return np.sin(2 * math.pi * cycles)
    if name == "Square":
        return np.where(share < 0.5, 1.0, -1.0)
    if name == "Triangle":
        return 1 - 4 * np.abs(np.mod(share + 0.25, 1.0) - 0.5)
    rise = 2 * (cycles - np.floor(cycles + 0.5))
    return rise if name == "SawToothUp" else -rise


def _as_wave(line: _Line) -> RelativeFriction | None:
    """A grating, where the file is one wave of constant swing on a constant."""
    if len(line.effects) != 2:
        return None
    kinds = {band["band_type"]: effect for band, effect in line.effects}
    if set(kinds) != {"Curve", "VectorialWave"}:
        return None
    wave, level = kinds["VectorialWave"], kinds["Curve"]
    (_, swings), (_, means) = _keys(wave), _keys(level)
    signal = wave["base_signal"]
    frequency = wave["keyframes"][0].get("frequency_modulation", 0)
    same = wave["position"] == level["position"]
    steady = np.ptp(swings) == 0.0 and np.ptp(means) == 0.0
    if not (same and steady and frequency > 0 and signal in ("Sine", "Square")):
        return None
    mean, swing = line.scale * float(means[0]), line.scale * float(swings[0])
    if not 0.0 <= mean - swing <= mean + swing <= 1.0:
        return None
    start = wave["position"] * line.unit
    phase = float(wave["phase"]) - 2 * math.pi * math.fmod(start * frequency, 1.0)
    phase = math.fmod(phase, 2 * math.pi)
    pattern: Pattern = (SineWave if signal == "Sine" else SquareWave)(1 / frequency, phase=phase)
    return RelativeFriction(pattern, mean - swing, mean + swing)
