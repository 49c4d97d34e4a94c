"""Tables of numbers in text: which sign parts the cells, which one the decimals, where the names
stand.

Nothing here knows what a column means. What can be found out is found out, what contradicts itself
is refused with its line and column.
"""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConfigError
from squeezefilm.core.hard_limits import RECORDING_BYTES
from squeezefilm.core.regular_file import read_regular
from squeezefilm.measure.recordings.described import Described
from squeezefilm.measure.recordings.files.raw_table import (
    RawTable,
    recognised,
    table_lines,
    times_of,
    unit_alone,
    with_meaning,
)

DELIMITERS = {"tab": "\t", "semicolon": ";", "comma": ",", "blank": None}
_WORDS = {"\t": "tabs", ";": "semicolons", ",": "commas", None: "blanks"}
_COMMENTS = ("#", "%", "//", "!")
_THOUSANDS = re.compile(r"[+-]?\d{1,3}(,\d{3})+\.\d*")
_SAMPLE = 400
_SHOWN = 40


@dataclass(frozen=True)
class Notation:
    """Notation of a table: what parts the cells of a line and what the decimals of a number, how
    many cells a line has, and the places of those that hold numbers."""

    delimiter: str | None
    decimal: str
    whole: int = 0
    kept: tuple[int, ...] = ()

    @property
    def cells(self) -> int:
        """How many numbers a row has."""
        return len(self.kept)

    def split(self, line: str) -> list[str]:
        """The cells of a line that hold numbers, without quotation marks; all of them where it has
        another count of cells than the table. Empty ones may end it."""
        if '"' in line and self.delimiter is not None:
            reader = csv.reader([line], delimiter=self.delimiter, skipinitialspace=True)
            try:
                parts = next(reader, [])
            except csv.Error:  # A text longer than any cell is no row.
                parts = [line]
        else:
            parts = line.split(self.delimiter)
        cells = [_unquoted(cell) for cell in parts]
        while len(cells) > self.whole and cells and not cells[-1]:
            cells.pop()
        return [cells[at] for at in self.kept] if len(cells) == self.whole else cells

    def number(self, cell: str) -> float:
        """The number in a cell. Raises `ValueError` for what is none."""
        if "_" in cell or (self.decimal == "," and "." in cell):
            raise ValueError(cell)
        if self.decimal == "," or _THOUSANDS.fullmatch(cell):
            cell = cell.replace(",", "." if self.decimal == "," else "")
        # Fortran's exponent.
        return float(cell.upper().replace("D", "E"))

    def is_row(self, line: str) -> bool:
        """True where a line is a row of numbers, as many as there are columns."""
        cells = self.split(line)
        return len(cells) == self.cells and all(map(self.is_number, cells))

    def is_number(self, cell: str) -> bool:
        """True where a cell holds a number; NaN is one, to be refused with its place."""
        try:
            self.number(cell)
        except ValueError:
            return False
        return True


def _unquoted(cell: str) -> str:
    """A cell without blanks and quotation marks around it; a prime at its end stays."""
    bare = cell.strip()
    return bare[1:-1].strip() if bare[:1] == bare[-1:] and bare[:1] in ("'", '"') else bare


def decoded(path: Path) -> tuple[str, list[str]]:
    """The text of a file with "\\n" at line ends, and what is to be said of its encoding.

    Raises `ConfigError` for a file that cannot be read or holds no text.
    """
    data = read_regular(path, RECORDING_BYTES, "a file with a table of numbers")
    notes = []
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        encoding = "utf-16"
    elif 3 * data[:4096].count(0) > len(data[:4096]):
        # Two bytes a character without a mark: every second one of plain letters is zero.
        encoding = "utf-16-be" if data[:1] == b"\0" else "utf-16-le"
    elif b"\0" in data[:4096]:
        raise ConfigError(
            "holds bytes that no text has; give a text, a Universal File (.uff, .unv) or a MATLAB "
            "file (.mat)"
        )
    else:
        encoding = "utf-8-sig"
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError:
        text = data.decode("latin-1")
        notes.append("the file is no UTF-8 text and was read as Latin-1")
    if "\0" in text:
        line = text.count("\n", 0, text.index("\0")) + 1
        raise ConfigError("holds a NUL, which no text has", line=line)
    return text.replace("\r\n", "\n").replace("\r", "\n"), notes


def read_text_table(path: Path, said: Described | None = None) -> RawTable:
    """The table in a text file, written as `said` tells, or as can be found out.

    Raises `ConfigError`, with line and column, for a row with another count of cells than the
    others, and for a cell that is no finite number.
    """
    text, notes = decoded(path)
    instrument = recognised(text)
    lines = table_lines(text.split("\n"), instrument)
    times = None if instrument is None else times_of(text, instrument)
    numbered = [
        (number, line)
        for number, line in enumerate(lines, 1)
        if line.strip() and not line.lstrip().startswith(_COMMENTS)
    ]
    single = instrument is not None and instrument.single
    notation = _notation(numbered, said, 1 if single else 2)
    first = next(k for k, (_, line) in enumerate(numbered) if notation.is_row(line))
    rows, doubts = _first_table(numbered[first:], {line for _, line in numbered[:first]}, notation)
    values = values_in(rows, notation)
    if instrument is not None and len(instrument.names) >= notation.cells:
        header_line, names = None, instrument.names[: notation.cells]
    else:
        header_line, names = _names(lines, rows[0][0], notation, said)
    if instrument is not None and times is not None:
        count = values[:, 0] if instrument.counted else np.arange(values.shape[0])
        values = values[:, 1:] if instrument.counted else values
        names = ("Time (s)", *(names[1:] if instrument.counted else names))
        values = np.column_stack([times[0] + times[1] * count, values])
    before = [number for number, _ in numbered[:first] if number != header_line]
    if before:
        notes.append(f"{len(before)} lines before the table were not read as numbers")
    point = "a comma" if notation.decimal == "," else "a point"
    others = [str(at + 1) for at in range(notation.whole) if at not in notation.kept]
    if others:
        notes.append(f"cells that hold no numbers were left out: {', '.join(others)} of each line")
    table = RawTable(
        file=path,
        format=f"text, {_WORDS[notation.delimiter]} between the columns, decimals after {point}",
        names=names,
        values=values,
        lines=np.array([number for number, _ in rows]),
        header_line=header_line,
        notes=tuple(notes),
        doubts=(*doubts, *_perhaps_cut(text, rows)),
    )
    return with_meaning(table, instrument)


def _notation(numbered: Sequence[tuple[int, str]], said: Described | None, least: int) -> Notation:
    """The notation in which most lines hold at least so many numbers at the same places, counted
    half where other cells stand among them; of equals the first."""
    sample = [line for _, line in numbered[:_SAMPLE]] + [line for _, line in numbered[-20:]]
    delimiter = None if said is None else said.delimiter
    decimal = None if said is None else said.decimal
    wanted = DELIMITERS if delimiter is None else {delimiter: DELIMITERS[delimiter]}
    best, most = None, 0.0
    for parted_by in wanted.values():
        for point in (".", ",") if decimal is None else (decimal,):
            trial = Notation(parted_by, point)
            counts: Counter[Notation] = Counter()
            for line in sample:
                # Where a comma parts both, quotation marks must.
                if parted_by == point and '"' not in line:
                    continue
                cells = list(trial.split(line))
                kept = [at for at, cell in enumerate(cells) if trial.is_number(cell)]
                if len(kept) >= least:
                    counts[Notation(parted_by, point, len(cells), tuple(kept))] += 1
            for notation, count in counts.items():
                weight = count if notation.whole == notation.cells else count / 2
                if weight > most:
                    best, most = notation, weight
    if best is None:
        told = "" if delimiter is None and decimal is None else " as delimiter and decimal tell"
        at = numbered[0][0] if numbered else None
        raise ConfigError(
            f"holds no line with two numbers or more{told}; give a table of numbers, a row a line",
            line=at,
        )
    return best


def values_in(rows: Sequence[tuple[int, str]], notation: Notation) -> si.FloatArray:
    """The numbers of all rows, shape (rows, columns)."""
    values = np.empty((len(rows), notation.cells))
    for k, (number, line) in enumerate(rows):
        cells = notation.split(line)
        if len(cells) != notation.cells:
            raise ConfigError(
                _miscounted(cells, notation, last=k == len(rows) - 1),
                line=number,
                column=min(len(cells), notation.cells + 1),
            )
        for column, cell in enumerate(cells):
            try:
                values[k, column] = notation.number(cell)
            except ValueError:
                raise ConfigError(
                    _no_number(cell, notation), line=number, column=notation.kept[column] + 1
                ) from None
    return values


def _miscounted(cells: Sequence[str], notation: Notation, *, last: bool) -> str:
    said = f"has {len(cells)} cells where the rows before have {notation.cells}"
    if last and len(cells) < notation.cells:
        return f"{said}: the file ends within a row; copy it again, or delete the row"
    return f"{said}; mend the row or delete it"


def _no_number(cell: str, notation: Notation) -> str:
    shown = cell if len(cell) <= _SHOWN else f"{cell[:_SHOWN]}…"
    if "∞" in cell:
        return "the instrument was over its range here; record with a larger one"
    if not cell:
        return "the cell is empty; leave the whole row out where nothing was measured"
    other = "," if notation.decimal == "." else "."
    if re.fullmatch(rf"[+-]?\d+[{other}]\d+([eE][+-]?\d+)?", cell):
        return (
            f"'{shown}' has its decimals after '{other}', and other rows after "
            f"'{notation.decimal}'; write all of them alike"
        )
    return f"'{shown}' is no number; mend it, or delete the row"


def _names(
    lines: Sequence[str], first: int, notation: Notation, said: Described | None
) -> tuple[int | None, tuple[str, ...]]:
    """The line of the columns' names, told or the last one above the numbers that fits, and
    they."""
    nameless = ("",) * notation.cells
    told = None if said is None else said.header
    if told == 0:
        return None, nameless
    if told is not None:
        if not 1 <= told < first:
            raise ConfigError(
                f"header = {told}, and the first row of numbers stands in line {first}; tell a "
                "line before it, or 0 for none"
            )
        cells = _header_cells(lines[told - 1], notation)
        if len(cells) != notation.cells:
            raise ConfigError(
                f"the line of the header has {len(cells)} cells, and the rows have "
                f"{notation.cells}",
                line=told,
            )
        return told, tuple(cells)
    above = [number for number in range(first - 1, 0, -1) if lines[number - 1].strip()]
    if not above:
        return None, nameless
    cells = _header_cells(lines[above[0] - 1], notation)
    if notation.delimiter == "," and 2 * len(cells) == notation.cells and len(cells) > 1:
        raise ConfigError(
            f"has {notation.cells} cells where the header above has {len(cells)}: decimals after a "
            "comma and commas between the columns cannot be told apart; export it with semicolons "
            "or tabs, or with decimal points",
            line=first,
            column=len(cells) + 1,
        )
    if len(cells) != notation.cells:
        return None, nameless
    if any(map(notation.is_number, cells)):
        other = next(cell for cell in cells if not notation.is_number(cell))
        raise ConfigError(
            f"'{other}' stands beside a number, above the first row of numbers: mend the row if it "
            f"is one, or write header = {above[0]} if it holds the columns' names (0 for a file "
            "without)",
            line=above[0],
            column=cells.index(other) + 1,
        )
    if all(cell == "#" or unit_alone(cell) for cell in cells) and len(above) > 1:
        upper = _header_cells(lines[above[1] - 1], notation)
        if len(upper) == notation.cells:
            joined = (f"{a} ({b.strip('()[] ')})" for a, b in zip(upper, cells, strict=True))
            return above[0], tuple(joined)
    return above[0], tuple(cells)


def _header_cells(line: str, notation: Notation) -> list[str]:
    """The names in a line, which may stand between quotation marks, or behind a comment's sign."""
    # As it is first: a sign alone may be the name of a column that counts.
    for bare in (line.strip(" "), line.strip(), line.strip().lstrip("".join(_COMMENTS)).strip()):
        cells = _names_in(bare, notation)
        while len(cells) > notation.whole and not cells[-1]:
            cells.pop()
        if len(cells) == notation.whole:
            cells[0] = _unquoted(cells[0].lstrip("".join(_COMMENTS))) or cells[0]
            return [cells[at] for at in notation.kept]
    return cells


def _names_in(bare: str, notation: Notation) -> list[str]:
    if notation.delimiter is None:
        # Names may hold single blanks where they are quoted, or where two blanks part them.
        parts = re.findall(r'"([^"]*)"', bare) or re.split(r"\t+|\s{2,}", bare)
        return parts if len(parts) == notation.whole else bare.split()
    try:
        return [_unquoted(cell) for cell in next(csv.reader([bare], delimiter=notation.delimiter))]
    except (csv.Error, StopIteration):
        return []


def _first_table(
    rows: Sequence[tuple[int, str]], above: Set[str], notation: Notation
) -> tuple[Sequence[tuple[int, str]], list[str]]:
    """The rows without words below them, up to a line that stood above them already, with a doubt
    that says so."""
    for k, (number, line) in enumerate(rows):
        if line in above:
            return rows[:k], [f"a second table begins in line {number}: the first was read"]
    while not any(map(notation.is_number, (cells := notation.split(rows[-1][1])))) and (
        len(cells) != notation.cells
    ):
        rows = rows[:-1]
    return rows, []


def _perhaps_cut(text: str, rows: Sequence[tuple[int, str]]) -> Iterator[str]:
    """A doubt where the last row has no end and is shorter than all others."""
    if text.endswith("\n") or len(rows) < 3:
        return
    last = len(rows[-1][1])
    if last >= min(len(line) for _, line in rows[:-1]):
        return
    yield (
        f"the last row (line {rows[-1][0]}) is shorter than all others and its line has no end: if "
        "the file was cut short there, its last number lacks digits"
    )
