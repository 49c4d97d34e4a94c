"""A sound of this program as another program reads it from a WAV file."""

from __future__ import annotations

import io
import json
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from scipy.io import wavfile


@dataclass(frozen=True)
class Sound:
    """A sound file: samples in the unit that its note names, their rate, and the note."""

    samples: np.ndarray[Any, np.dtype[np.float64]]
    rate: int
    note: dict[str, Any]


def read_sound(data: bytes) -> Sound:
    """The sound in the bytes of a WAV file, scaled as the chunk ``sqzf`` says."""
    with pytest.warns(wavfile.WavFileWarning, match="not understood"):
        rate, raw = wavfile.read(io.BytesIO(data))
    begin = data.index(b"sqzf") + 8
    note = json.loads(data[begin : begin + int.from_bytes(data[begin - 4 : begin], "little")])
    # scipy puts 24 bits into the upper ones of 32.
    steps = {"float32": 1.0, "int16": 2.0**15 - 1, "int24": 256 * (2.0**23 - 1)}[note["encoding"]]
    return Sound(note["full_scale"] * (raw.astype(float) / steps), rate, note)
