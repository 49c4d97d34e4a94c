"""Keys of a description that any kind of recording may have, names of columns, and the descriptions
of friction: strokes, curves, and what was published of many people."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from squeezefilm.core import quantities as si
from squeezefilm.core.hard_limits import FINGER_SPEED, FORCE, FREQUENCY
from squeezefilm.measure.recordings.kinds import Told

MOST_VOLTAGE: si.Volt = 1e4
"""Largest voltage of a drive: past any amplifier for a plate."""

Convention = Literal["zero-to-peak", "peak-to-peak", "rms"]
"""Convention of a vibration's amplitude as given; inside, all are zero-to-peak."""
CONVENTIONS: Mapping[Convention, float] = {
    "zero-to-peak": 1.0,
    "peak-to-peak": 0.5,
    "rms": 2**0.5,
}
"""Factor that makes each a zero-to-peak amplitude, of a sine."""


@dataclass(frozen=True)
class Column:
    """Column of the file that holds a quantity, and in which unit.

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
class Described(Told):
    """Keys that every description may have. `kind` is one of `KINDS`, empty where a file describes
    itself; `file` is the data's file, where it has another name; `decimal` and `delimiter` are how
    its numbers are written, `header` the line of the columns' names (0 for none), where that is not
    to be found out; `points` is how many rows there must be."""

    kind: str
    decimal: Literal[".", ","] | None = None
    delimiter: Literal["tab", "comma", "semicolon", "blank"] | None = None
    header: Annotated[int, si.AtLeast(0)] | None = None
    points: Annotated[int, si.AtLeast(1)] | None = None

    def told(self, file: Path) -> Told:
        """Words on the recording itself."""
        words = {entry.name: getattr(self, entry.name) for entry in dataclasses.fields(Told)}
        return Told(**words | {"file": file.name, "name": self.name or file.stem})


@dataclass(frozen=True)
class BenchColumns:
    """Time, both forces, place where it was recorded, and the vibration: its amplitude or the
    voltage of its drive."""

    time: Column
    normal_force: Column
    tangential_force: Column
    position: Column | None = None
    vibration_amplitude: Column | None = None
    voltage: Column | None = None


@si.checked_numbers
@dataclass(frozen=True, kw_only=True)
class DescribedBench(Described):
    """Strokes of a finger or probe; `frequency` is the vibration's, `speed` that of a finger whose
    place was not recorded."""

    columns: BenchColumns
    speed: Annotated[si.MetrePerSecond, FINGER_SPEED] | None = None
    frequency: Annotated[si.Hertz, FREQUENCY] | None = None
    amplitude_per_volt: Annotated[si.MetrePerVolt, si.Above(0.0)] | None = None


@dataclass(frozen=True)
class CurveColumns:
    """Vibration amplitude and friction: a force, a coefficient, or µ′/µ. Where known its standard
    deviation, in the unit of the friction. A condition that was not the same throughout has a
    column in place of its key."""

    vibration_amplitude: Column
    friction_force: Column | None = None
    friction_coefficient: Column | None = None
    relative_friction: Column | None = None
    spread: Column | None = None
    frequency: Column | None = None
    normal_force: Column | None = None
    speed: Column | None = None


@si.checked_numbers
@dataclass(frozen=True, kw_only=True)
class DescribedCurve(Described):
    """Friction against vibration amplitude; `display` is a preset or a file that describes what it
    was measured on, with surface and finger. `finger`, `surface` and `moisture` say in words what
    touched what; curves of one `finger` and one `source` count once. `reading_error` is that of
    numbers read off a figure, as a share of the largest friction."""

    columns: CurveColumns
    frequency: Annotated[si.Hertz, FREQUENCY] | None = None
    normal_force: Annotated[si.Newton, FORCE] | None = None
    speed: Annotated[si.MetrePerSecond, FINGER_SPEED] | None = None
    display: str = ""
    finger: str = ""
    surface: str = ""
    moisture: str = ""
    reading_error: Annotated[si.Dimensionless, si.AtLeast(0.0), si.Below(1.0)] = 0.0


@dataclass(frozen=True)
class DecayColumns:
    """The amplitude over which friction decays, and the friction coefficient at rest."""

    decay_amplitude: Column
    friction_coefficient: Column


@si.checked_numbers
@dataclass(frozen=True, kw_only=True)
class DescribedDecays(Described):
    """Friction curves of which a fit alone was published: µ = µ0 exp(−a²/2τ²), one row a stroke."""

    columns: DecayColumns
    frequency: Annotated[si.Hertz, FREQUENCY]
    normal_force: Annotated[si.Newton, FORCE] | None = None
    speed: Annotated[si.MetrePerSecond, FINGER_SPEED] | None = None
    display: str = ""


@dataclass(frozen=True)
class TouchColumns:
    """Columns of what a fingertip adds to a vibration: a damping and a moving mass."""

    damping: Column
    mass: Column


@si.checked_numbers
@dataclass(frozen=True, kw_only=True)
class DescribedTouches(Described):
    """Impedances of fingertips that press and do not slide, one row a touch."""

    columns: TouchColumns
    frequency: Annotated[si.Hertz, FREQUENCY]
    normal_force: Annotated[si.Newton, FORCE]
    display: str = ""


@dataclass(frozen=True)
class DetectionColumns:
    """Spatial periods, and the least amplitude of the friction coefficient that is detected."""

    spatial_period: Column
    friction_coefficient: Column


@si.checked_numbers
@dataclass(frozen=True, kw_only=True)
class DescribedDetection(Described):
    """Medians over so many `people` of the least modulation of friction that is detected, one row
    a spatial period."""

    columns: DetectionColumns
    normal_force: Annotated[si.Newton, FORCE]
    speed: Annotated[si.MetrePerSecond, FINGER_SPEED]
    people: Annotated[int, si.AtLeast(1)]
