"""What the descriptions of friction say: strokes, curves, and what was published of many people."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from squeezefilm.core import quantities as si
from squeezefilm.core.hard_limits import FINGER_SPEED, FORCE, FREQUENCY
from squeezefilm.measure.recordings.described import Column, Described


@dataclass(frozen=True)
class BenchColumns:
    """Time, both forces, place, and the vibration: its amplitude or the voltage of its drive."""

    time: Column
    normal_force: Column
    tangential_force: Column
    position: Column
    vibration_amplitude: Column | None = None
    voltage: Column | None = None


@si.checked_numbers
@dataclass(frozen=True, kw_only=True)
class DescribedBench(Described):
    """Strokes of a finger or probe; `frequency` is the vibration's."""

    kind: Literal["friction bench"]
    columns: BenchColumns
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

    kind: Literal["friction curve"]
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

    kind: Literal["friction decays"]
    columns: DecayColumns
    frequency: Annotated[si.Hertz, FREQUENCY]
    normal_force: Annotated[si.Newton, FORCE] | None = None
    speed: Annotated[si.MetrePerSecond, FINGER_SPEED] | None = None
    display: str = ""


@dataclass(frozen=True)
class TouchColumns:
    """What a fingertip adds to a vibration: a damping and a moving mass."""

    damping: Column
    mass: Column


@si.checked_numbers
@dataclass(frozen=True, kw_only=True)
class DescribedTouches(Described):
    """Impedances of fingertips that press and do not slide, one row a touch."""

    kind: Literal["fingertip impedances"]
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

    kind: Literal["detection thresholds"]
    columns: DetectionColumns
    normal_force: Annotated[si.Newton, FORCE]
    speed: Annotated[si.MetrePerSecond, FINGER_SPEED]
    people: Annotated[int, si.AtLeast(1)]
