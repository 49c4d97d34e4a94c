"""Recordings of a sound card: WAV files."""

from __future__ import annotations

import io
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from squeezefilm.core.errors import ConfigError
from squeezefilm.core.hard_limits import RECORDING_BYTES
from squeezefilm.core.regular_file import read_regular
from squeezefilm.measure.recordings.files.raw_table import RawTable


def read_wav(path: Path) -> RawTable:
    """The channels of a WAV file over time: PCM of 8, 16, 24 or 32 bit from −1 to 1 of full scale,
    floats as they are.

    Raises `ConfigError` for a file that is cut short, of another coding, or no WAV file.
    """
    from scipy.io import wavfile

    stream: Any = io.BytesIO(read_regular(path, RECORDING_BYTES, "a WAV file"))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", wavfile.WavFileWarning)
            warnings.filterwarnings("error", "Reached EOF", wavfile.WavFileWarning)
            rate, samples = wavfile.read(stream)
    # Damaged heads end in errors of any type, of struct, of NumPy.
    except Exception as error:
        raise ConfigError(
            f"is cut short, or no WAV file of PCM or floats ({error or 'it ends early'}); save it "
            "again as PCM of 16 or 24 bit",
            file=path,
        ) from None
    if rate <= 0:
        raise ConfigError(f"has {rate} samples a second; save it again", file=path)
    values = samples.reshape(samples.shape[0], -1).astype(float)
    if samples.dtype == np.uint8:
        values = values / 2**7 - 1  # Eight bits alone are without a sign.
    elif samples.dtype.kind == "i":
        values /= 2.0 ** (8 * samples.dtype.itemsize - 1)
    names = ("Time (s)", *(f"Channel {k + 1}" for k in range(values.shape[1])))
    table = RawTable(
        file=path,
        format=f"WAV file, {samples.dtype} at {rate} Hz, over full scale",
        names=names,
        values=np.column_stack([np.arange(values.shape[0]) / rate, values]),
        described=(("time", 1, "s"), *(("signal", name, "1") for name in names[1:])),
    )
    table.require_finite()
    return table
