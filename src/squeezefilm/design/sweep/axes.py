"""Axes of a sweep: a value of the display or of its operation, and the steps it takes.

actuator.thickness=1 mm..3 mm:9          nine values, evenly spaced, ends included
voltage=1 V..100 V:5:log                 evenly spaced in the logarithm
actuator.glue.thickness=20 um, 50 um     a list; one value alone fixes it
surface=adhesive, bare                   words, where words are wanted

Samples in place of a grid are points drawn in ranges without steps, together one axis.

actuator.thickness=1 mm..3 mm            uniform between the ends
voltage=1 V..100 V:log                   uniform in the logarithm

They are the first points of a scrambled Sobol sequence (Sobol 1967, Owen 1998), which fill the
space more evenly than chance; with the same seed and ranges more samples begin with the same ones.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.core.formats.traces import csv_rows, text_of_file
from squeezefilm.core.hard_limits import SWEEP_POINTS, SWEEP_STEPS, require_within
from squeezefilm.design.sweep.answers import OPTIONS, VerbOption
from squeezefilm.physics.display import Display
from squeezefilm.physics.uncertainty.parameters import number_paths, unit_at

Value = float | str
DISPLAY = "display"
"""The name of the axis along which whole displays differ."""

_LOG = r"(?::\s*(?P<log>log))?\s*"
_STEPS = re.compile(rf"(?P<first>.+?)\.\.(?P<last>.+?):\s*(?P<steps>\d+)\s*{_LOG}")
_RANGE = re.compile(rf"(?P<first>[^:]+?)\.\.(?P<last>[^:]+?)\s*{_LOG}")


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


def axes_of(
    display: Display,
    vary: Mapping[str, Any] | Sequence[str],
    over: str | Path | None = None,
    sample: tuple[int | None, int] = (None, 0),
) -> tuple[Axis, ...]:
    """The axes of a sweep of a display: samples (how many, and their seed) in those of `vary` that
    are ranges without steps, each other name of it, and the rows of a file.

    Raises `InputError` for a name that is varied twice, for samples without a range, and what the
    axes raise.
    """
    named, axes = named_values(vary), list[Axis]()
    count, seed = sample
    if count is not None:
        require_within(SWEEP_POINTS, count, "samples")
        si.require("seed", seed, at_least=0)
        ranges = [
            (what_is_varied(name, display), match)
            for name, values in named
            if (match := _range_in(values))
        ]
        axes.append(_sampled(ranges, count, seed))
        named = [(name, values) for name, values in named if not _range_in(values)]
    axes += [axis_of(name, values, display) for name, values in named]
    if over is not None:
        axes.append(axis_of_file(over, display))
    names = [name for axis in axes for name in axis.names]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"{twice} is varied twice; vary it once", quantity=twice)
    return tuple(axes)


def named_values(vary: Mapping[str, Any] | Sequence[str]) -> list[tuple[str, Any]]:
    """Names with their values, which texts like ``"voltage=1 V..30 V:9"`` may say. Raises
    `InputError` for a text that says not what is varied."""
    if isinstance(vary, Mapping):
        return list(vary.items())
    named = []
    for text in [vary] if isinstance(vary, str) else vary:
        name, _, values = text.partition("=")
        if not name.strip() or not values.strip():
            raise InputError(
                f"vary '{text:.80}' says not what is varied and over which values; write "
                '"actuator.thickness=1 mm..3 mm:9" or "voltage=10 V, 15 V, 20 V"'
            )
        named.append((name.strip(), values.strip()))
    return named


def axis_of(name: str, values: Any, display: Display) -> Axis:
    """The axis of a name over values: a text as in this module's head, or a sequence of numbers
    (SI) and texts.

    `name` is the path of a number in the display (``actuator.patches.*.thickness``: of each) or one
    of the operating options. Raises `InputError` for a name that is not known, with those near it,
    and for a value that is none, of another dimension, or twice the same.
    """
    option, logarithmic = what_is_varied(name, display), False
    if not isinstance(values, str):
        steps = [option.value(value) for value in ([values] if np.ndim(values) == 0 else values)]
    elif option.unit is not None and (spaced := _STEPS.fullmatch(values)):
        logarithmic = spaced["log"] is not None
        steps = [option.number(number) for number in _spaced(option, spaced)]
    else:
        if ".." in values and option.unit is not None:
            raise InputError(
                f"{name}={values} has no number of steps; write it behind a colon, {values}:9, "
                "or draw samples in it with sample 200"
            )
        steps = [option.value(part.strip()) for part in values.split(option.between)]
    require_within(SWEEP_STEPS, len(steps), f"steps of {name}")
    if len(set(steps)) < len(steps):
        raise InputError(
            f"{name} takes a value twice; give each once, or fewer steps", quantity=name
        )
    return Axis((name,), (option.unit,), tuple((value,) for value in steps), logarithmic)


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
    options = [what_is_varied(name, display) for name, _ in heads]
    steps = []
    for line, row in rows[1:]:
        if len(row) != len(heads):
            raise ConfigError(
                f"has {len(row)} cells where the header has {len(heads)}", file=path, line=line
            )
        values = []
        for option, (name, symbol), cell in zip(options, heads, row, strict=True):
            try:
                values.append(option.value(f"{cell.strip()} {symbol}".strip()))
            except InputError as error:
                raise ConfigError(str(error), file=path, line=line, key=name) from error
        steps.append(tuple(values))
    return Axis(
        tuple(name for name, _ in heads), tuple(option.unit for option in options), tuple(steps)
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


def what_is_varied(name: str, display: Display) -> VerbOption:
    """The operating option of a name, or the number of the display at that path, which has no
    bounds here."""
    if name in OPTIONS:
        return OPTIONS[name]
    try:
        unit, whole = unit_at(display, name)
    except InputError as error:
        raise InputError(f"cannot vary '{name}': {_instead(name, display, error)}") from error
    return VerbOption(name, unit, whole=whole)


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


def _spaced(option: VerbOption, asked: re.Match[str]) -> Iterator[float]:
    """The values of a range, its ends as they are written."""
    name, ends = option.name, [asked[end].strip() for end in ("first", "last")]
    first, last = map(option.quantity, ends)
    steps = int(asked["steps"])
    require_within(SWEEP_STEPS, steps, f"steps of {name}")
    if steps < 2 or first == last:
        raise InputError(
            f"{name} from {ends[0]} to {ends[1]} in {steps} steps is no range; give two ends and "
            "at least 2 steps, or one value alone"
        )
    if asked["log"] is None:
        middle = np.linspace(first, last, steps)
    elif min(first, last) > 0:
        middle = np.geomspace(first, last, steps)
    else:
        raise InputError(f"{name} cannot be spaced by its logarithm from {ends[0]}; start above 0")
    # 1.1 mm, and not 1.1000000000000001 mm.
    yield from (first, *(float(f"{value:.12g}") for value in middle[1:-1]), last)


def _range_in(values: Any) -> re.Match[str] | None:
    return _RANGE.fullmatch(values) if isinstance(values, str) else None


def _drawn(option: VerbOption, asked: re.Match[str], shares: si.FloatArray) -> list[float]:
    """The values at shares (0 to 1) of a range."""
    name = option.name
    if option.unit is None:
        raise InputError(f"{name} takes words, which have no range; name them with commas between")
    ends = [asked[end].strip() for end in ("first", "last")]
    low, high = sorted(map(option.quantity, ends))
    if low == high or (asked["log"] and low <= 0):
        raise InputError(
            f"{name} from {ends[0]} to {ends[1]} is no range to draw in; give two ends"
            f"{', above 0 for a logarithm' if asked['log'] else ''}"
        )
    if option.whole:
        drawn = np.floor(low + shares * (high - low + 1))
    elif asked["log"]:
        drawn = low * (high / low) ** shares
    else:
        drawn = low + shares * (high - low)
    return [option.number(float(f"{value:.12g}")) for value in drawn.tolist()]


def _sampled(ranges: Sequence[tuple[VerbOption, re.Match[str]]], count: int, seed: int) -> Axis:
    """The axis of so many samples in ranges, of which there must be one."""
    from scipy.stats import qmc

    if not ranges:
        raise InputError(
            'samples are drawn in ranges, and none is given; give vary = "actuator.thickness='
            '1 mm..3 mm", without a number of steps',
            quantity="sample",
        )
    # Whole powers of two, of which the first are taken: a sequence has no other beginning.
    shares = qmc.Sobol(len(ranges), scramble=True, rng=seed).random_base2(
        math.ceil(math.log2(max(count, 2)))
    )[:count]
    columns = [_drawn(*asked, shares[:, k]) for k, asked in enumerate(ranges)]
    return Axis(
        tuple(option.name for option, _ in ranges),
        tuple(option.unit for option, _ in ranges),
        tuple(zip(*columns, strict=True)),
        sampled=tuple(asked["log"] or "linear" for _, asked in ranges),
    )
