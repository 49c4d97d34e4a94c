"""Axes of a sweep: a value of the display or of its operation, and the steps it takes.

actuator.thickness=1 mm..3 mm:9          nine values, evenly spaced, ends included
voltage=1 V..100 V:5:log                 evenly spaced in the logarithm
actuator.glue.thickness=20 um, 50 um     a list; one value alone fixes it
surface=adhesive, bare                   words, where words are wanted
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.core.formats.traces import csv_rows, text_of_file
from squeezefilm.core.hard_limits import SWEEP_STEPS, require_within
from squeezefilm.design.sweep.answers import OPTIONS, VerbOption
from squeezefilm.physics.display import Display
from squeezefilm.physics.uncertainty.parameters import number_paths, unit_at

Value = float | str
DISPLAY = "display"
"""The name of the axis along which whole displays differ."""

_RANGE = re.compile(r"(?P<first>.+?)\.\.(?P<last>.+?):\s*(?P<steps>\d+)\s*(?::\s*(?P<log>log))?\s*")


@dataclass(frozen=True)
class Axis:
    """Values that change together: of one name, or of the columns of a file.

    `steps` has a row for each step and in it a value for each of `names`; numbers are SI in
    `units`, words have None there. Of samples, `sampled` says how each name was drawn.
    """

    names: tuple[str, ...]
    units: tuple[si.Unit | None, ...]
    steps: tuple[tuple[Value, ...], ...]
    logarithmic: bool = False
    sampled: tuple[str, ...] = ()

    def __len__(self) -> int:
        return len(self.steps)

    @property
    def columns(self) -> tuple[str, ...]:
        """The names with their units behind them, as a table's columns are called."""
        return tuple(
            name + ("" if unit is None else unit.suffix)
            for name, unit in zip(self.names, self.units, strict=True)
        )

    @property
    def numbers(self) -> si.FloatArray | None:
        """The values (SI) of an axis with one name that takes numbers; None for any other."""
        if len(self.names) != 1 or self.units[0] is None:
            return None
        return np.array([float(row[0]) for row in self.steps])


def axis_of_text(text: str, display: Display) -> Axis:
    """An axis from ``"actuator.thickness=1 mm..3 mm:9"``. Raises as `axis_of`."""
    name, equals, values = text.partition("=")
    if not equals or not name.strip() or not values.strip():
        raise InputError(
            f"vary '{text:.80}' says not what is varied and over which values; write "
            '"actuator.thickness=1 mm..3 mm:9" or "voltage=10 V, 15 V, 20 V"'
        )
    return axis_of(name.strip(), values.strip(), display)


def axis_of(name: str, values: Any, display: Display) -> Axis:
    """The axis of a name over values: a text as in this module's head, or a sequence of numbers
    (SI) and texts.

    `name` is the path of a number in the display (``actuator.patches.*.thickness``: of each) or one
    of the operating options. Raises `InputError` for a name that is not known, with those near it,
    and for a value that is none, of another dimension, or twice the same.
    """
    option, unit, whole = what_is_varied(name, display)
    logarithmic = False
    if isinstance(values, str):
        spaced = _RANGE.fullmatch(values)
        if spaced is not None and unit is not None:
            logarithmic = spaced["log"] is not None
            steps: list[Value] = [
                number if option is None else option.number(number)
                for number in _spaced(name, spaced, unit)
            ]
        else:
            if ".." in values and unit is not None:
                raise InputError(
                    f"{name}={values} has no number of steps; write it behind a colon, {values}:9, "
                    "or draw samples in it with sample 200"
                )
            parts = values.split("," if option is None else option.between)
            steps = [_value(name, part.strip(), option, unit) for part in parts]
    elif np.ndim(values) == 0:
        steps = [_value(name, values, option, unit)]
    else:
        steps = [_value(name, value, option, unit) for value in values]
    require_within(SWEEP_STEPS, len(steps), f"steps of {name}")
    if whole:
        steps = [_whole(name, value) for value in steps]
    if len(set(steps)) < len(steps):
        raise InputError(
            f"{name} takes a value twice; give each once, or fewer steps", quantity=name
        )
    return Axis((name,), (unit,), tuple((value,) for value in steps), logarithmic)


def axis_of_file(path: str | Path, display: Display) -> Axis:
    """The axis of a CSV file: its header names what is varied, each row is one step.

    A cell is a quantity with its unit (``1.5 mm``); where the header ends with a unit in brackets
    (``actuator.thickness [mm]``) cells are plain numbers. Raises `ConfigError` for a file that
    cannot be used, with its line, and what `axis_of` raises.
    """
    rows = list(_rows(path))
    if len(rows) < 2:
        raise ConfigError("has no header and row; write names, and below them values", file=path)
    heads = [_head(cell) for cell in rows[0][1]]
    for line, row in rows[1:]:
        if len(row) != len(heads):
            raise ConfigError(
                f"has {len(row)} cells where the header has {len(heads)}", file=path, line=line
            )
    columns: list[Axis] = []
    for number, (name, symbol) in enumerate(heads):
        cells = [(line, f"{row[number].strip()} {symbol}".strip()) for line, row in rows[1:]]
        columns.append(_column(name, cells, display, path))
    steps = zip(*(column.steps for column in columns), strict=True)
    return Axis(
        tuple(name for name, _ in heads),
        tuple(column.units[0] for column in columns),
        tuple(tuple(value for (value,) in row) for row in steps),
    )


def _rows(path: str | Path) -> Iterator[tuple[int, list[str]]]:
    """The rows of a CSV file, each with its line in the file; empty lines and those that begin with
    # are none."""
    every = enumerate(text_of_file(path).lstrip("\ufeff").splitlines(), 1)
    lines = [(at, text) for at, text in every if text.strip() and not text.startswith("#")]
    for number, row in csv_rows([text for _, text in lines], path):
        yield lines[number - 1][0], row


def _head(cell: str) -> tuple[str, str]:
    match = re.fullmatch(r"\s*(.+?)\s*(?:\[(.+)\])?\s*", cell)
    return (match[1], (match[2] or "").strip()) if match else (cell, "")


def _column(
    name: str, cells: Sequence[tuple[int, str]], display: Display, path: str | Path
) -> Axis:
    """A column of a file, each cell with its line; the same value may stand there more than
    once."""
    option, unit, whole = what_is_varied(name, display)
    steps = []
    for line, cell in cells:
        try:
            value = _value(name, cell, option, unit)
            steps.append((_whole(name, value) if whole else value,))
        except InputError as error:
            raise ConfigError(str(error), file=path, line=line, key=name) from error
    return Axis((name,), (unit,), tuple(steps))


def what_is_varied(name: str, display: Display) -> tuple[VerbOption | None, si.Unit | None, bool]:
    """The operating option of a name, if it is one; the unit of its numbers; whether they are
    whole."""
    if name in OPTIONS:
        option = OPTIONS[name]
        return option, option.unit, False
    try:
        unit, whole = unit_at(display, name)
    except InputError as error:
        raise InputError(f"cannot vary '{name}': {_instead(name, display, error)}") from error
    return None, unit, whole


def _instead(name: str, display: Display, error: InputError) -> str:
    """Advice on what may be varied in place of a name that is not known."""
    if "." in name:
        return str(error)
    paths = (re.sub(r"\.\d+\.", ".*.", path) for path in number_paths(display))
    same = dict.fromkeys(path for path in paths if path.rpartition(".")[2] == name)
    if same:
        return f"say of what, {' or '.join(same)}"
    return (
        f"it is no operating option.{si.did_you_mean(name, OPTIONS)} These are: "
        f"{', '.join(OPTIONS)}. Of the display write a path, like actuator.thickness; squeezefilm "
        "show lists its values"
    )


def _spaced(name: str, asked: re.Match[str], unit: si.Unit) -> Iterator[float]:
    """The values of a range, its ends as they are written."""
    first, last = (quantity_of_text(name, asked[end].strip(), unit) for end in ("first", "last"))
    steps = int(asked["steps"])
    require_within(SWEEP_STEPS, steps, f"steps of {name}")
    if steps < 2 or first == last:
        raise InputError(
            f"{name} from {asked['first'].strip()} to {asked['last'].strip()} in {steps} steps is "
            "no range; give two ends and at least 2 steps, or one value alone"
        )
    if asked["log"] is None:
        middle = np.linspace(first, last, steps)
    elif min(first, last) > 0:
        middle = np.geomspace(first, last, steps)
    else:
        raise InputError(
            f"{name} cannot be spaced by its logarithm from {asked['first'].strip()}; start above 0"
        )
    # 1.1 mm, and not 1.1000000000000001 mm.
    yield from (first, *(float(f"{value:.12g}") for value in middle[1:-1]), last)


def _value(name: str, given: Any, option: VerbOption | None, unit: si.Unit | None) -> Value:
    if unit is None:
        assert option is not None
        return option.word(given)
    if isinstance(given, str):
        number = quantity_of_text(name, given, unit)
        return number if option is None else option.number(number)
    if isinstance(given, bool) or not isinstance(given, int | float | np.number):
        raise InputError(f"{name} = {given!r:.60} is no number and no text; write a quantity")
    if not np.isfinite(given):
        raise InputError(f"{name} = {given!r} is not finite; write a finite number")
    return float(given) if option is None else option.number(float(given))


def quantity_of_text(name: str, text: str, unit: si.Unit) -> float:
    """The number (SI) of a text for a name. Raises `InputError` for what is none of its unit."""
    try:
        return si.parse_quantity(text, unit)
    except InputError as error:
        raise InputError(f"{name}: {error}", quantity=name) from error


def _whole(name: str, value: Value) -> int:
    if not float(value).is_integer():
        raise InputError(f"{name} = {value} must be a whole number; choose steps that are")
    return int(value)


def axes_of(
    display: Display, vary: Mapping[str, Any] | Sequence[str], over: str | Path | None
) -> tuple[Axis, ...]:
    """The axes of a sweep of a display: each name of `vary`, and the rows of a file.

    Raises `InputError` for a name that is varied twice, and what the axes raise.
    """
    if isinstance(vary, str):
        vary = [vary]
    axes = (
        [axis_of(name, values, display) for name, values in vary.items()]
        if isinstance(vary, Mapping)
        else [axis_of_text(text, display) for text in vary]
    )
    if over is not None:
        axes.append(axis_of_file(over, display))
    require_each_once(axes)
    return tuple(axes)


def require_each_once(axes: Sequence[Axis]) -> None:
    """Refuse a name that is varied twice. Raises `InputError`."""
    names = [name for axis in axes for name in axis.names]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"{twice} is varied twice; vary it once", quantity=twice)
