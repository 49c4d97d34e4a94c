"""What the description of a recording may say of any kind, and how it names columns."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from squeezefilm.core import quantities as si
from squeezefilm.core.hard_limits import FREQUENCY
from squeezefilm.measure.recordings.kinds import Told

MOST_VOLTAGE: si.Volt = 1e4
"""Of a drive: past any amplifier for a plate."""

Convention = Literal["zero-to-peak", "peak-to-peak", "rms"]
"""How the amplitude of a vibration is given; inside, all amplitudes are zero-to-peak."""
CONVENTIONS: Mapping[Convention, float] = {
    "zero-to-peak": 1.0,
    "peak-to-peak": 0.5,
    "rms": 2**0.5,
}
"""What makes each a zero-to-peak amplitude, of a sine."""


@dataclass(frozen=True)
class Column:
    """Which column of the file holds a quantity, and in which unit.

    `column` is its name or its number from 1; `given_as` says how an amplitude is given; `scale`
    is what one recorded unit stands for, "125 mm/s/V", where an instrument's output was recorded.
    """

    column: str | int
    unit: str
    given_as: Convention | None = None
    scale: str | None = None


@si.checked_numbers
@dataclass(frozen=True)
class Given:
    """A voltage that was the same throughout, and how its amplitude is given."""

    amplitude: Annotated[si.Volt, si.Above(0.0), si.AtMost(MOST_VOLTAGE)]
    given_as: Convention


@si.checked_numbers
@dataclass(frozen=True)
class Band:
    """The frequencies of a sweep that are kept, the ends among them."""

    low: Annotated[si.Hertz, FREQUENCY]
    high: Annotated[si.Hertz, FREQUENCY]


@si.checked_numbers
@dataclass(frozen=True, kw_only=True)
class Described:
    """What every description may say. `file` is the data's file, where it has another name;
    `decimal` and `delimiter` are how its numbers are written, `header` the line of the columns'
    names (0 for none), where that is not to be found out; `points` is how many rows there must
    be."""

    file: str = ""
    name: str = ""
    who: str = ""
    when: str = ""
    instrument: str = ""
    licence: str = ""
    source: str = ""
    temperature: Annotated[si.AbsoluteKelvin, si.Above(0.0)] | None = None
    decimal: Literal[".", ","] | None = None
    delimiter: Literal["tab", "comma", "semicolon", "blank"] | None = None
    header: Annotated[int, si.AtLeast(0)] | None = None
    points: Annotated[int, si.AtLeast(1)] | None = None

    def told(self, file: Path) -> Told:
        """What is told of the recording itself."""
        words = {one.name: getattr(self, one.name) for one in dataclasses.fields(Told)}
        return Told(**words | {"file": file.name, "name": self.name or file.stem})
