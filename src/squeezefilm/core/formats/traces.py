"""Samples in files that say their units: tables as CSV and Parquet, one channel as WAV.

A table has units in the names of its columns, and its origin is kept with the file.

CSV is UTF-8 with a comma, one header line, and before it one comment line ``# {JSON}`` with the
metadata, in whose texts commas and semicolons are escaped, so that no spreadsheet finds a formula
behind one; numbers are written so that they read back as the same float, a missing one is empty.
Parquet keeps the metadata under the key ``squeezefilm`` of the schema and needs pyarrow (the extra
``squeezefilm[study]``); it is written for other programs, and none of this one reads it.
"""

from __future__ import annotations

import csv
import io
import json
import math
import re
import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConfigError, InputError, optional
from squeezefilm.core.hard_limits import TABLE_BYTES
from squeezefilm.core.regular_file import parsed_json, read_regular_text

_NAME = re.compile(r"[a-z][A-Za-z0-9_.]*")
_JSON_TEXT = re.compile(r'"(?:[^"\\]|\\.)*"')
_KEY = b"squeezefilm"


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """Columns of equal length by name (`position_m`, …), and where they are from.

    Numbers are floats; NaN stands for none, infinities are refused.

    Raises:
        InputError: no column, columns of different lengths, or a name that is no identifier.
    """

    columns: Mapping[str, si.FloatArray]
    metadata: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.columns:
            raise InputError("a table needs at least one column")
        si.require_alike(**self.columns)
        for name, column in self.columns.items():
            if not _NAME.fullmatch(name):
                raise InputError(f"'{name}' is no name for a column; write it like position_m")
            if np.any(np.isinf(column)):
                raise InputError(f"the column '{name}' holds an infinity, which no table keeps")

    def column(self, name: str) -> si.FloatArray:
        """The column of that name. Raises `InputError` if there is none."""
        if name not in self.columns:
            raise InputError(f"there is no column '{name}'; there are {', '.join(self.columns)}")
        return self.columns[name]


def csv_text(table: Table) -> str:
    """The CSV text of a table; `table_from_csv` reads an equal table back."""
    stream = io.StringIO()
    stream.write(f"# {_one_cell(json.dumps(dict(table.metadata), allow_nan=False))}\n")
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(table.columns)
    lists = [np.asarray(column, dtype=float).tolist() for column in table.columns.values()]
    for row in zip(*lists, strict=True):
        writer.writerow(["" if math.isnan(value) else repr(value) for value in row])
    return stream.getvalue()


def _one_cell(text: str) -> str:
    """JSON of which no text is cut into cells, the second of which might begin like a formula."""
    return _JSON_TEXT.sub(
        lambda match: match.group().replace(",", "\\u002c").replace(";", "\\u003b"), text
    )


def table_from_csv(path: str | Path) -> Table:
    """The table in a CSV file.

    Raises:
        ConfigError: a file that cannot be read, with the line of what is no number or has another
            count of cells than the header.
    """
    text = text_of_file(path)
    metadata: dict[str, Any] = {}
    lines = text.rstrip().splitlines()
    start = 0
    if lines and lines[0].startswith("#"):
        start = 1
        try:
            metadata = parsed_json(lines[0][1:])
        except ValueError:
            metadata = {"comment": lines[0][1:].strip()}
        if not isinstance(metadata, dict):
            metadata = {"comment": metadata}
    if len(lines) <= start:
        raise ConfigError("has no header line", file=path)
    rows = csv_rows(lines[start:], path)
    names = [name.strip() for name in next(rows)[1]]
    if len(set(names)) < len(names):
        raise ConfigError("names a column twice", file=path, line=start + 1)
    values = [_numbers(row, names, path, start + number) for number, row in rows]
    array = np.array(values, dtype=float).reshape(len(values), len(names))
    try:
        return Table({name: array[:, k].copy() for k, name in enumerate(names)}, metadata)
    except InputError as error:
        raise ConfigError(str(error), file=path, line=start + 1) from error


def csv_rows(
    lines: Sequence[str], path: str | Path, delimiter: str = ","
) -> Iterator[tuple[int, list[str]]]:
    """The cells of each row with the number of its last line. Raises `ConfigError` for no CSV."""
    reader = csv.reader(lines, delimiter=delimiter)
    try:
        for row in reader:
            yield reader.line_num, row
    except csv.Error as error:
        raise ConfigError(f"is no CSV: {error}", file=path, line=reader.line_num) from error


def _numbers(row: list[str], names: list[str], path: str | Path, line: int) -> list[float]:
    if len(row) != len(names):
        raise ConfigError(
            f"has {len(row)} cells where the header has {len(names)}", file=path, line=line
        )
    try:
        return [float(cell) for cell in row]
    except ValueError:
        pass  # A cell is empty, or no number: which one is looked up.
    numbers = []
    for name, cell in zip(names, row, strict=True):
        try:
            numbers.append(float(cell) if cell.strip() else math.nan)
        except ValueError as error:
            raise ConfigError(
                f"'{cell}' is no number; write one with a point, like 0.0125",
                file=path,
                line=line,
                key=name,
            ) from error
    return numbers


def text_of_file(path: str | Path) -> str:
    """The UTF-8 text of a file. Raises `ConfigError` for one that cannot be read so."""
    return read_regular_text(path, TABLE_BYTES, "a CSV file")


def parquet_bytes(table: Table) -> bytes:
    """The Parquet file of a table, columns as 64-bit floats.

    Raises:
        InputError: where pyarrow is not installed.
    """
    columns = {
        name: np.asarray(column, dtype=float).tolist() for name, column in table.columns.items()
    }
    return parquet_of_columns(columns, table.metadata)


def parquet_of_columns(columns: Mapping[str, Sequence[Any]], metadata: Mapping[str, Any]) -> bytes:
    """The Parquet file of columns of one length by name, of numbers or of texts; None is null.

    Raises:
        InputError: where pyarrow is not installed.
    """
    with optional("study", "Parquet (not CSV)"):
        import pyarrow
        from pyarrow import parquet
    arrays = [pyarrow.array(column) for column in columns.values()]
    note = json.dumps(dict(metadata), allow_nan=False).encode()
    held = pyarrow.table(arrays, names=list(columns)).replace_schema_metadata({_KEY: note})
    stream = io.BytesIO()
    parquet.write_table(held, stream)
    return stream.getvalue()


# A sound file holds numbers from −1 to 1. Here a chunk of the file's own, named ``sqzf``, holds
# JSON with the unit and the value of full scale; programs that do not know the chunk skip it.
# Layout: RIFF/WAVE with ``fmt `` (1 PCM or 3 IEEE float), ``fact`` for floats, ``sqzf``, ``data``.
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
