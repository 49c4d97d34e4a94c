"""WAV with a scale: samples of a physical quantity, and what full scale means, in one file.

A sound file holds numbers from −1 to 1. Here a chunk of the file's own, named ``sqzf``, holds JSON
with the unit and the value of full scale; programs that do not know the chunk skip it. Layout:
RIFF/WAVE with ``fmt `` (1 PCM or 3 IEEE float), ``fact`` for floats, ``sqzf``, ``data``.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal, get_args

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError

Encoding = Literal["float32", "int16", "int24"]
ENCODINGS: tuple[Encoding, ...] = get_args(Encoding)

_PCM, _FLOAT = 1, 3
_CHUNK = b"sqzf"
# What one byte count of RIFF can hold, with room for the other chunks.
_MOST_BYTES = 2**32 - 2**20
_STEPS = {"int16": 2**15 - 1, "int24": 2**23 - 1}
_WIDTH = {"float32": 4, "int16": 2, "int24": 3}


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class Waveform:
    """A channel of samples of a physical quantity.

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
