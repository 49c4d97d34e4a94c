"""WAV with a scale: samples of a physical quantity, and what full scale means, in one file.

A sound file holds numbers from −1 to 1. Here a chunk of the file's own, named ``sqzf``, holds JSON
with the unit and the value of full scale; programs that do not know the chunk skip it. Layout:
RIFF/WAVE with ``fmt `` (1 PCM or 3 IEEE float), ``fact`` for floats, ``sqzf``, ``data``.
"""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.hard_limits import WAVE_BYTES
from squeezefilm.regular_file import parsed_json, read_regular

Encoding = Literal["float32", "int16", "int24"]
ENCODINGS: tuple[Encoding, ...] = get_args(Encoding)

_UNITS = ("m", "V")
_PCM, _FLOAT = 1, 3
_CHUNK = b"sqzf"
# What one byte count of RIFF can hold, with room for the other chunks.
_MOST_BYTES = 2**32 - 2**20
_STEPS = {"int16": 2**15 - 1, "int24": 2**23 - 1}
_WIDTH = {"float32": 4, "int16": 2, "int24": 3}
_LONGEST_NOTE = 1_000_000


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class Waveform:
    """One channel of samples of a physical quantity.

    Attributes:
        samples: in `unit`, shape (n,).
        sample_rate: a whole number (Hz), from 1 to 10 MHz.
        unit: "m" (an amplitude) or "V" (a drive).
        full_scale: the value that a file's ±1 stands for, in `unit`; above 0.
        metadata: kept with the file, as JSON.

    Raises:
        InputError: a value outside its range, or samples beyond full scale (none is clipped).
    """

    samples: si.FloatArray
    sample_rate: Annotated[si.Hertz, si.AtLeast(1.0), si.AtMost(10000000.0)]
    unit: Literal["m", "V"]
    full_scale: Annotated[float, si.Above(0.0)]
    metadata: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        unit = si.Unit(self.unit)
        if self.samples.ndim != 1 or self.samples.size == 0:
            raise InputError(
                f"samples of shape {self.samples.shape} are no sound of one channel; give a list "
                "of at least one"
            )
        si.require(
            "samples", self.samples, unit, at_least=-self.full_scale, at_most=self.full_scale
        )
        if self.sample_rate != round(self.sample_rate):
            raise InputError(
                f"sample_rate = {self.sample_rate!r} Hz cannot be written: a WAV file has a whole "
                "number of samples per second"
            )


def wav_bytes(waveform: Waveform, encoding: Encoding = "float32") -> bytes:
    """The file of a waveform, mono.

    Integers are rounded to the nearest step of full_scale/32767 or full_scale/8388607; floats
    have a relative error below 6e-8.

    Raises:
        InputError: an unknown encoding, or more samples than such a file can hold.
    """
    si.require_one_of("encoding", encoding, ENCODINGS)
    width = _WIDTH[encoding]
    if waveform.samples.size * width > _MOST_BYTES:
        raise InputError(
            f"{waveform.samples.size} samples of {width} bytes do not fit into a WAV file; cut "
            "the stroke or lower the rate"
        )
    share = waveform.samples / waveform.full_scale
    if encoding == "float32":
        data = share.astype("<f4").tobytes()
    else:
        whole = np.rint(share * _STEPS[encoding]).astype("<i4")
        data = whole.view(np.uint8).reshape(-1, 4)[:, :width].tobytes()
    rate = round(waveform.sample_rate)
    tag = _FLOAT if encoding == "float32" else _PCM
    head = struct.pack("<HHIIHH", tag, 1, rate, rate * width, width, 8 * width)
    note = {
        **waveform.metadata,
        "unit": waveform.unit,
        "full_scale": waveform.full_scale,
        "encoding": encoding,
    }
    # ASCII only, so that a byte is a character for whoever looks into the file.
    chunks = _chunk(b"fmt ", head + (struct.pack("<H", 0) if tag == _FLOAT else b""))
    if tag == _FLOAT:
        chunks += _chunk(b"fact", struct.pack("<I", waveform.samples.size))
    chunks += _chunk(_CHUNK, json.dumps(note, allow_nan=False).encode("ascii"))
    chunks += _chunk(b"data", data)
    return b"RIFF" + struct.pack("<I", 4 + len(chunks)) + b"WAVE" + chunks


def _chunk(name: bytes, body: bytes) -> bytes:
    return name + struct.pack("<I", len(body)) + body + b"\0" * (len(body) % 2)


def read_wav(path: str | Path) -> Waveform:
    """The waveform in a file written by `wav_bytes`. Raises `InputError` for any other file."""
    return waveform_from(read_regular(path, WAVE_BYTES, "a WAV file"), str(path))


def waveform_from(data: bytes, name: str = "the file") -> Waveform:
    """The waveform in the bytes of a file; `name` is what messages call it.

    Raises:
        InputError: bytes that are no such file, are cut short, or have no scale.
    """
    if data[:4] != b"RIFF" or data[8:12] != b"WAVE":
        raise InputError(f"{name} is no WAV file; give one that squeezefilm wrote")
    chunks: dict[bytes, bytes] = {}
    place = 12
    while place + 8 <= len(data):
        size = int.from_bytes(data[place + 4 : place + 8], "little")
        if place + 8 + size > len(data):
            raise InputError(f"{name} is cut short at byte {place}; copy it again")
        chunks.setdefault(data[place : place + 4], data[place + 8 : place + 8 + size])
        place += 8 + size + size % 2
    if b"fmt " not in chunks or b"data" not in chunks or len(chunks[b"fmt "]) < 16:
        raise InputError(f"{name} has no format or no samples; it is no whole WAV file")
    tag, channels, rate, _, width, bits = struct.unpack("<HHIIHH", chunks[b"fmt "][:16])
    encoding = {(_FLOAT, 32): "float32", (_PCM, 16): "int16", (_PCM, 24): "int24"}.get((tag, bits))
    if channels != 1 or encoding is None or width != _WIDTH[encoding]:
        raise InputError(
            f"{name} has {channels} channels of {bits} bits (format {tag}); squeezefilm writes one "
            f"channel of {', '.join(ENCODINGS)}"
        )
    return _scaled(chunks, encoding, float(rate), name)


def _scaled(chunks: Mapping[bytes, bytes], encoding: str, rate: float, name: str) -> Waveform:
    try:
        note = parsed_json(chunks.get(_CHUNK, b"")[:_LONGEST_NOTE])
        unit, full_scale = note.pop("unit"), float(note.pop("full_scale"))
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(
            f"{name} does not say what full scale is (no chunk 'sqzf'); only files that "
            "squeezefilm wrote have a unit"
        ) from error
    if unit not in _UNITS or not (math.isfinite(full_scale) and full_scale > 0):
        raise InputError(f"{name} has a full scale of {full_scale!r} {unit!r}, which is no scale")
    note.pop("encoding", None)
    raw, width = chunks[b"data"], _WIDTH[encoding]
    if not raw or len(raw) % width:
        raise InputError(f"{name} has {len(raw)} bytes of samples, no whole number of them")
    if encoding == "float32":
        share = np.frombuffer(raw, dtype="<f4").astype(float)
    else:
        bytes_ = np.frombuffer(raw, dtype=np.uint8).reshape(-1, width)
        whole = np.zeros((bytes_.shape[0], 4), dtype=np.uint8)
        # Filled from above: the sign bit ends up where a 32-bit integer has its own.
        whole[:, 4 - width :] = bytes_
        share = (whole.view("<i4").ravel() >> (8 * (4 - width))) / _STEPS[encoding]
    # A float rounded to 32 bits may pass full scale by a rounding error.
    share = np.where(np.abs(share) <= 1 + 1e-7, np.clip(share, -1.0, 1.0), share)
    return Waveform(full_scale * share, rate, unit, full_scale, note)
