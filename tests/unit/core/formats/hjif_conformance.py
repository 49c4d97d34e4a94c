"""What the reference software of MPEG haptics asks of a document before it loads it."""

from __future__ import annotations

import math
from typing import Any

_SIGNALS = ("Sine", "Square")
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
}
# Which keys a keyframe may have.
_OF_KEYFRAME: dict[str, _Kind] = {
    "relative_position": int,
    "amplitude_modulation": _NUMBER,
    "frequency_modulation": int,
}


def require_hjif(document: Any) -> None:
    """Fail for a document that the reference software would not load, naming the place.

    Checks the keys it needs, their types, and that every number is finite.
    """
    _needs(document, "experience", "the file")
    for p, perception in enumerate(document["perceptions"]):
        where = f"perceptions[{p}]"
        _needs(perception, "perception", where)
        for c, channel in enumerate(perception["channels"]):
            place = f"{where}.channels[{c}]"
            _needs(channel, "channel", place)
            for b, band in enumerate(channel["bands"]):
                _needs(band, "band", f"{place}.bands[{b}]")
                for e, effect in enumerate(band["effects"]):
                    _effect(effect, f"{place}.bands[{b}].effects[{e}]")


def _effect(effect: Any, where: str) -> None:
    _needs(effect, "effect", where)
    assert effect["base_signal"] in _SIGNALS, where
    for k, keyframe in enumerate(effect["keyframes"]):
        assert isinstance(keyframe, dict), where
        for key, value in keyframe.items():
            _right(value, _OF_KEYFRAME[key], f"{where}.keyframes[{k}].{key}")


def _needs(value: Any, kind: str, where: str) -> None:
    assert isinstance(value, dict), f"{where} is no JSON object"
    for key, wanted in _NEEDED[kind].items():
        assert key in value, f"{where} has no '{key}'"
        _right(value[key], wanted, f"{where}.{key}")


def _right(value: Any, kind: _Kind, where: str) -> None:
    right = isinstance(value, kind) and not isinstance(value, bool)
    if isinstance(value, int | float):
        right = right and math.isfinite(value) and abs(value) < 2**53
    assert right, f"{where} = {value!r}"
