"""Finger motions from files and from words: CSV of places over time, and "60 mm/s over 4 cm".

A CSV has the columns ``time_s``, ``x_m`` and, for a motion in the plane, ``y_m``. In words::

    60 mm/s over 4 cm                     there
    60 mm/s over 4 cm, 3 passes           there, back and there again
    60 mm/s over 4 cm, 2 turns            the same, counted by its turns
    60 mm/s over 4 cm, from 5 mm          begins at x = 5 mm
    60 mm/s over 4 cm, at 30 deg, y 2 mm  slanted, from y = 2 mm on
    4 cm in 0.5 s, 2 passes               each pass of least jerk
"""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import ReadBy
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.core.formats.traces import table_from_csv, text_of_file
from squeezefilm.core.hard_limits import FINGER_SPEED
from squeezefilm.physics.render.motion.stroke import FingerPath, MinimumJerkStroke, Stroke

Motion = Stroke | MinimumJerkStroke | FingerPath
"""Motion of a finger, however it was said."""

_COLUMNS = ("time_s", "x_m", "y_m")
_EXAMPLE = "60 mm/s over 4 cm, 3 passes"


def motion_from(text_or_path: str | Path) -> Motion:
    """The motion in a CSV file, or said in words.

    Raises:
        ConfigError: a file that cannot be used, with the line at fault.
        InputError: words that are no stroke.
    """
    text = str(text_or_path)
    if isinstance(text_or_path, Path) or text.lower().endswith(".csv"):
        return read_trajectory(text)
    return stroke_from_text(text)


NamedMotion = Annotated[Motion, ReadBy(motion_from)]
"""A motion, or in its place words for it or the path of a CSV file (see `reads_text`)."""


def read_trajectory(path: str | Path) -> FingerPath:
    """The motion in a CSV file; motion along x where it has no ``y_m``.

    Raises:
        ConfigError: an unknown or missing column, a value that is missing, no number or not
            finite, times that do not rise, places too far or too far apart, each with its line.
    """
    table = table_from_csv(path)

    def wrong(message: str, row: int = -1, key: str | None = None) -> ConfigError:
        # The names of the columns stand in the line before the first row of numbers.
        first = 3 if text_of_file(path).startswith("#") else 2
        return ConfigError(message, file=path, line=first + row, key=key)

    for name in table.columns:
        if name not in _COLUMNS:
            raise wrong(
                f"the column '{name}' is not known.{si.did_you_mean(name, _COLUMNS)} Allowed: "
                "time_s, x_m and, in the plane, y_m"
            )
    for name in _COLUMNS[:2]:
        if name not in table.columns:
            raise wrong(
                f"the column '{name}' is missing; a motion has time_s and x_m, in the plane y_m"
            )
    for name, column in table.columns.items():
        if np.any(bad := ~np.isfinite(column)):
            raise wrong(
                "is no number; a motion has one at every time: leave the whole line out if the "
                "finger was not seen",
                int(np.argmax(bad)),
                name,
            )
    time, x = table.column("time_s"), table.column("x_m")
    y = table.columns["y_m"] if "y_m" in table.columns else np.zeros(x.size)
    if time.size < 2:
        raise ConfigError("has fewer than two samples, no motion", file=path)
    if np.any(still := np.diff(time) <= 0.0):
        k = int(np.argmax(still)) + 1
        raise wrong(
            f"{time[k]:.9g} s does not come after {time[k - 1]:.9g} s; times must rise from line "
            "to line",
            k,
            "time_s",
        )
    speed = np.hypot(np.diff(x), np.diff(y)) / np.diff(time)
    if np.any(fast := speed > FINGER_SPEED.most):
        k = int(np.argmax(fast))
        raise wrong(
            f"the finger would move at {speed[k]:.4g} m/s, and at most "
            f"{FINGER_SPEED.most:g} m/s are believed; check the units (time_s in seconds, x_m in "
            "metres)",
            k + 1,
        )
    try:
        return FingerPath(time, x, y)
    except InputError as error:
        raise ConfigError(str(error), file=path) from error


def stroke_from_text(text: str) -> Motion:
    """The motion said in words; see the module. Raises `InputError` for other words."""
    head, *clauses = (part.strip() for part in text.split(","))
    over, within = (
        re.fullmatch(r"(.+?)\s+over\s+(.+)", head),
        re.fullmatch(r"(.+?)\s+in\s+(.+)", head),
    )
    if over is None and within is None:
        raise InputError(
            f'\'{text}\' is no stroke; write one like "{_EXAMPLE}" or "4 cm in 0.5 s", or give a '
            "CSV file with time_s, x_m"
        )
    passes, start, y, angle = 1, 0.0, 0.0, 0.0
    for clause in clauses:
        count = re.fullmatch(r"(\d{1,6})\s+(pass|passes|turn|turns)", clause)
        word, _, rest = clause.partition(" ")
        if count is not None:
            passes = int(count[1]) + (1 if count[2].startswith("turn") else 0)
        elif word == "from":
            start = _quantity(rest, "m", text)
        elif word == "y":
            y = _quantity(rest, "m", text)
        elif word == "at":
            angle = _quantity(rest, "rad", text)
        else:
            raise InputError(
                f"'{clause}' in the stroke '{text}' is not known; allowed are '3 passes', "
                "'2 turns', 'from 5 mm', 'y 2 mm' and 'at 30 deg'"
            )
    if over is not None:
        stroke = Stroke(
            _quantity(over[1], "m/s", text), _quantity(over[2], "m", text), passes, start
        )
        return stroke if angle == 0.0 and y == 0.0 else _slanted(stroke, y, angle)
    assert within is not None
    if angle or y:
        raise InputError(
            f"the stroke '{text}' of least jerk runs along x; leave 'at' and 'y' out, or write it "
            "with a speed"
        )
    return MinimumJerkStroke(
        _quantity(within[1], "m", text), _quantity(within[2], "s", text), passes, start
    )


def _slanted(stroke: Stroke, y: si.Metre, angle: float) -> FingerPath:
    turns = np.arange(stroke.passes + 1)
    along = np.where(turns % 2 == 1, 1.0, 0.0) * np.float64(stroke.length)
    return FingerPath(
        turns * np.float64(stroke.pass_duration),
        stroke.start + along * math.cos(angle),
        y + along * math.sin(angle),
    )


def _quantity(words: str, unit: str, text: str) -> float:
    try:
        return si.parse_quantity(words.strip(), si.Unit(unit))
    except InputError as error:
        raise InputError(f"the stroke '{text}': {error}") from error
