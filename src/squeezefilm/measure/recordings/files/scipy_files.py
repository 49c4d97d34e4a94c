"""Files that SciPy reads: MATLAB files up to version 7, whose variables of one length become
columns by their names, and WAV files of a sound card."""

from __future__ import annotations

import io
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConfigError
from squeezefilm.core.hard_limits import RECORDING_BYTES
from squeezefilm.core.isolated_reading import Read, read_isolated
from squeezefilm.core.regular_file import read_regular
from squeezefilm.measure.recordings.files.raw_table import RawTable


def read_matlab(path: Path) -> RawTable:
    """The table in a MATLAB file: of the variables (also those within structures) the ones of
    the commonest length; ``H real`` and ``H imaginary`` of a complex H, ``data 1``, ``data 2`` of
    the columns of a matrix.

    Raises `ConfigError` for version 7.3 (an HDF5 file), for what cannot be read, and where there is
    no variable of two numbers or more.
    """
    data = read_regular(path, RECORDING_BYTES, "a MATLAB file")
    if b"MATLAB 7.3" in data[:128] or data[:8] == b"\x89HDF\r\n\x1a\n":
        raise ConfigError(
            "is a MATLAB file of version 7.3 (HDF5), which is not read; write it again in MATLAB: "
            f"S = load('{path.name}'); save('{path.name}', '-struct', 'S', '-v7')"
        )
    (there, labels), arrays = read_isolated(_numbers, path.name, data=data, file=path)
    if not arrays:
        held = ", ".join(there) or "none"
        raise ConfigError(f"holds no variable with a row of numbers; it holds: {held}")
    columns = list(zip(labels, arrays, strict=True))
    lengths = [column.size for column in arrays]
    length = max(set(lengths), key=lambda length: (lengths.count(length), length))
    kept = [(name, column) for name, column in columns if column.size == length]
    left = [name for name, column in columns if column.size != length]
    notes = (f"variables of another length were left out: {', '.join(left)}",) if left else ()
    names = tuple(name for name, _ in kept)
    values = np.stack([column for _, column in kept], axis=1)
    return RawTable(path, "MATLAB file", names, values, notes=notes)


def _numbers(data: bytes, name: str) -> Read:
    """Names of all variables and of the columns of numbers, and the columns (read in the child)."""
    variables = _variables(data, name)
    columns = [pair for label, value in variables for pair in _columns(label, value)]
    named = [label for label, _ in variables], [label for label, _ in columns]
    return named, [column for _, column in columns]


def _variables(data: bytes, name: str) -> list[tuple[str, Any]]:
    """The variables by name, those of a structure as its own."""
    from scipy.io import loadmat

    try:
        stream: Any = io.BytesIO(data)
        loaded = loadmat(stream, squeeze_me=True, struct_as_record=True)
    except MemoryError:
        raise
    # Damaged files end in errors of any type, of zlib, of struct, of NumPy.
    except Exception as error:
        why = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ConfigError(
            f"cannot be read as a MATLAB file: {why}; save it again with save('{name}', '-v7')"
        ) from error
    variables = []
    for name, value in loaded.items():
        if not name.startswith("__"):
            variables += _within(name, value)
    return variables


def _within(name: str, value: Any) -> list[tuple[str, Any]]:
    """A variable, or those within a structure, at any depth."""
    fields = getattr(getattr(value, "dtype", None), "names", None)
    if not fields or np.ndim(value):
        return [(name, value)]
    return [pair for field in fields for pair in _within(field, np.squeeze(value[field].item()))]


def _columns(name: str, value: Any) -> list[tuple[str, si.FloatArray]]:
    """The columns of one variable, none of what is no number."""
    array = np.asarray(value)
    if array.dtype.kind not in "iufc" or array.ndim not in (1, 2) or array.size < 2:
        return []
    if array.ndim == 2:
        # Of a few long rows each is a column.
        array = array.T if array.shape[0] < array.shape[1] else array
        parts = [(f"{name} {k + 1}", array[:, k]) for k in range(array.shape[1])]
    else:
        parts = [(name, array)]
    columns = []
    for label, part in parts:
        if np.iscomplexobj(part):
            columns += [(f"{label} real", part.real), (f"{label} imaginary", part.imag)]
        else:
            columns.append((label, part))
    return [(label, np.asarray(part, dtype=float)) for label, part in columns]


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
            "again as PCM of 16 or 24 bit"
        ) from None
    if rate <= 0:
        raise ConfigError(f"has {rate} samples a second; save it again")
    values = samples.reshape(samples.shape[0], -1).astype(float)
    if samples.dtype == np.uint8:
        values = values / 2**7 - 1  # Eight bits alone are without a sign.
    elif samples.dtype.kind == "i":
        values /= 2.0 ** (8 * samples.dtype.itemsize - 1)
    names = ("Time (s)", *(f"Channel {k + 1}" for k in range(values.shape[1])))
    return RawTable(
        file=path,
        format=f"WAV file, {samples.dtype} at {rate} Hz, over full scale",
        names=names,
        values=np.column_stack([np.arange(values.shape[0]) / rate, values]),
        described=(("time", 1, "s"), *(("signal", name, "1") for name in names[1:])),
    )
