"""What stands in the small TOML file beside a recording: its kind, columns, units and
conditions."""

from __future__ import annotations

import dataclasses
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

from squeezefilm import quantities as si
from squeezefilm.config import load_text
from squeezefilm.config.lines import locate
from squeezefilm.config.scan import require_quick_toml
from squeezefilm.errors import ConfigError
from squeezefilm.hard_limits import DESCRIPTION_BYTES, FINGER_SPEED, FORCE, FREQUENCY, PLACE
from squeezefilm.measure.recordings.ceramic_bar import CeramicBar
from squeezefilm.measure.recordings.kinds import Told
from squeezefilm.plate.ring.ceramic_disc import CeramicDisc
from squeezefilm.regular_file import read_regular_text

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


@dataclass(frozen=True)
class ImpedanceColumns:
    """Frequency, and one pair: |Z| with its phase, |Y| with its phase, R with X, or G with B."""

    frequency: Column
    magnitude: Column | None = None
    admittance_magnitude: Column | None = None
    phase: Column | None = None
    resistance: Column | None = None
    reactance: Column | None = None
    conductance: Column | None = None
    susceptance: Column | None = None


@si.checked_numbers
@dataclass(frozen=True, kw_only=True)
class DescribedImpedance(Described):
    """An impedance or admittance against frequency; of a bare ceramic where its shape is told."""

    kind: Literal["impedance"]
    columns: ImpedanceColumns | None = None
    bar: CeramicBar | None = None
    disc: CeramicDisc | None = None
    correct: Literal["phase 180 deg", "phase sign"] | None = None


@dataclass(frozen=True)
class Motion:
    """The motion that was recorded: displacement or velocity, by amplitude and phase (the phase may
    be left out where a line or a grid was scanned), or by its real and imaginary part."""

    displacement: Column | None = None
    velocity: Column | None = None
    phase: Column | None = None
    displacement_imaginary: Column | None = None
    velocity_imaginary: Column | None = None


@dataclass(frozen=True)
class ResponseColumns(Motion):
    """Frequency, motion, and where recorded the drive's voltage and the coherence."""

    frequency: Column | None = None
    voltage: Column | None = None
    coherence: Column | None = None


@si.checked_numbers
@dataclass(frozen=True, kw_only=True)
class DescribedResponse(Described):
    """Motion at one place (`x`, `y`) against frequency; per volt, or with the voltage of the
    drive."""

    kind: Literal["frequency response"]
    columns: ResponseColumns
    voltage: Given | None = None
    x: Annotated[si.Metre, PLACE] | None = None
    y: Annotated[si.Metre, PLACE] | None = None
    correct: Literal["phase 180 deg", "phase sign"] | None = None


@dataclass(frozen=True)
class LineColumns(Motion):
    """Places along a line, and the motion there."""

    position: Column | None = None


@si.checked_numbers
@dataclass(frozen=True, kw_only=True)
class DescribedLine(Described):
    """Motion along a line at one frequency."""

    kind: Literal["line scan"]
    columns: LineColumns
    frequency: Annotated[si.Hertz, FREQUENCY]
    voltage: Given | None = None


@dataclass(frozen=True)
class GridColumns(Motion):
    """Places on the face, and the motion there."""

    x: Column | None = None
    y: Column | None = None


@si.checked_numbers
@dataclass(frozen=True, kw_only=True)
class DescribedGrid(Described):
    """Motion at places on the face at one frequency."""

    kind: Literal["grid scan"]
    columns: GridColumns
    frequency: Annotated[si.Hertz, FREQUENCY]
    voltage: Given | None = None


@dataclass(frozen=True)
class TimeColumns:
    """Time, displacement or velocity, and of raw signals the drive's voltage, all of them as they
    were from moment to moment."""

    time: Column
    displacement: Column | None = None
    velocity: Column | None = None
    voltage: Column | None = None


@si.checked_numbers
@dataclass(frozen=True, kw_only=True)
class DescribedRingDown(Described):
    """Motion against time after the drive was switched off."""

    kind: Literal["ring-down"]
    columns: TimeColumns


@si.checked_numbers
@dataclass(frozen=True, kw_only=True)
class DescribedSignals(Described):
    """Voltage and motion against time."""

    kind: Literal["raw signals"]
    columns: TimeColumns


@si.checked_numbers
@dataclass(frozen=True)
class SweepFile:
    """The file of one sweep, and the voltage of its drive."""

    file: str
    voltage: Given


@si.checked_numbers
@dataclass(frozen=True, kw_only=True)
class DescribedSweeps(Described):
    """Frequency responses at several voltages: one below the other in one file, where a sweep ends
    as the voltage changes or the frequency turns around, or each in a file of its own
    (`sweeps`)."""

    kind: Literal["voltage sweeps"]
    columns: ResponseColumns
    sweeps: tuple[SweepFile, ...] = ()

    def responses(self) -> tuple[DescribedResponse, ...]:
        """The descriptions of the sweeps that have files of their own."""
        common = {one.name: getattr(self, one.name) for one in dataclasses.fields(Described)}
        return tuple(
            DescribedResponse(
                kind="frequency response",
                columns=self.columns,
                voltage=one.voltage,
                **common | {"file": one.file},
            )
            for one in self.sweeps
        )


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
    """Vibration amplitude, µ′/µ and its standard deviation."""

    vibration_amplitude: Column
    relative_friction: Column
    spread: Column


@si.checked_numbers
@dataclass(frozen=True, kw_only=True)
class DescribedCurve(Described):
    """Friction against vibration amplitude; `display` is a preset or a file that describes what it
    was measured on, with surface and finger."""

    kind: Literal["friction curve"]
    columns: CurveColumns
    frequency: Annotated[si.Hertz, FREQUENCY]
    normal_force: Annotated[si.Newton, FORCE]
    speed: Annotated[si.MetrePerSecond, FINGER_SPEED]
    display: str = ""


KINDS: Mapping[str, type[Described]] = {
    "impedance": DescribedImpedance,
    "frequency response": DescribedResponse,
    "line scan": DescribedLine,
    "grid scan": DescribedGrid,
    "ring-down": DescribedRingDown,
    "voltage sweeps": DescribedSweeps,
    "raw signals": DescribedSignals,
    "friction bench": DescribedBench,
    "friction curve": DescribedCurve,
}
"""The kinds of recordings by the word for them."""


@dataclass(frozen=True)
class Description:
    """A description with the text that it was read from, for messages; no `path` and no text where
    a file describes itself."""

    kind: str
    said: Described
    path: Path | None = None
    text: str = field(default="", repr=False)

    def error(self, message: str, key: Sequence[str]) -> ConfigError:
        """An error at a key, with its line."""
        if self.path is None:
            return ConfigError(message)
        line = locate(self.text, key)
        return ConfigError(message, file=self.path, line=line, key=".".join(key) or None)


def load_description(path: str | Path) -> Description:
    """The description in a TOML file, checked key by key.

    Raises `ConfigError`, with file, line and key, for anything that is not right: an unknown kind
    or key (with the one that is near), a quantity without its unit, a key that is missing.
    """
    text = read_regular_text(path, DESCRIPTION_BYTES, "a TOML file that describes a recording")
    require_quick_toml(text, path)
    kind = _kind(text, Path(path))
    said = load_text(KINDS[kind], text, file=path)
    return Description(kind, said, Path(path), text)


def _kind(text: str, path: Path) -> str:
    """The kind that is named, by which all other keys are judged."""
    try:
        kind = tomllib.loads(text).get("kind")
    except (ValueError, RecursionError):
        # The loader says what is wrong with the text, in better words.
        return "impedance"
    allowed = ", ".join(f'"{one}"' for one in KINDS)
    if kind is None:
        raise ConfigError(f"the key 'kind' is missing; it is one of {allowed}", file=path)
    if not isinstance(kind, str) or kind not in KINDS:
        near = si.did_you_mean(str(kind), KINDS)
        raise ConfigError(
            f"kind = {kind!r} is not known.{near} Allowed: {allowed}",
            file=path,
            line=locate(text, ["kind"]),
            key="kind",
        )
    return kind
