"""Recordings of a sound card: WAV files."""

from __future__ import annotations

import io
import wave
from pathlib import Path

import numpy as np

from squeezefilm.core.errors import ConfigError
from squeezefilm.core.hard_limits import RECORDING_BYTES
from squeezefilm.core.regular_file import read_regular
from squeezefilm.measure.recordings.files.raw_table import RawTable


def read_wav(path: Path) -> RawTable:
    """The channels of a WAV file (PCM of 8, 16, 24 or 32 bit) from −1 to 1 of full scale over time.

    Raises `ConfigError` for a file that is cut short, of floats, or no WAV file.
    """
    content = read_regular(path, RECORDING_BYTES, "a WAV file")
    try:
        with wave.open(io.BytesIO(content), "rb") as sound:
            width, channels, rate = sound.getsampwidth(), sound.getnchannels(), sound.getframerate()
            said, data = sound.getnframes(), sound.readframes(sound.getnframes())
    except (wave.Error, EOFError) as error:
        raise ConfigError(
            f"is no WAV file of whole numbers ({error or 'it ends early'}); save it as PCM of 16 "
            "or 24 bit",
            file=path,
        ) from None
    if len(data) != said * width * channels or rate <= 0:
        raise ConfigError("is cut short: its head tells of more samples; save it again", file=path)
    wide = np.zeros((said * channels, 4), dtype=np.uint8)
    wide[:, 4 - width :] = np.frombuffer(data, dtype=np.uint8).reshape(-1, width)
    if width == 1:
        # Eight bits alone are without a sign.
        wide[:, 3] ^= 0x80
    values = wide.view("<i4").reshape(said, channels) / 2.0**31
    names = ("Time (s)", *(f"Channel {k}" for k in range(1, channels + 1)))
    table = RawTable(
        file=path,
        format=f"WAV file, {8 * width} bit at {rate} Hz, over full scale",
        names=names,
        values=np.column_stack([np.arange(said) / rate, values]),
        described=(("time", 1, "s"), *(("signal", name, "1") for name in names[1:])),
    )
    table.require_finite()
    return table
