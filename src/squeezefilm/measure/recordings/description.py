"""Description of a recording in the small TOML file beside it: its kind, columns, units and
conditions."""

from __future__ import annotations

import dataclasses
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

from squeezefilm.core import quantities as si
from squeezefilm.core.config import load_text
from squeezefilm.core.config.syntax import locate, require_quick_toml
from squeezefilm.core.errors import ConfigError
from squeezefilm.core.hard_limits import DESCRIPTION_BYTES, FREQUENCY, PLACE, RESISTANCE
from squeezefilm.core.regular_file import read_regular_text
from squeezefilm.measure.recordings.described import (
    Band,
    Column,
    Described,
    DescribedBench,
    DescribedCurve,
    DescribedDecays,
    DescribedDetection,
    DescribedTouches,
    Given,
)
from squeezefilm.measure.recordings.kinds import CeramicBar
from squeezefilm.physics.plate.ring.ceramic_disc import CeramicDisc


@dataclass(frozen=True)
class ImpedanceColumns:
    """Frequency, and one of the pairs that make an impedance (`circuits_read.IMPEDANCES`), or the
    drive's voltage and that over a shunt with the phase between them."""

    frequency: Column
    magnitude: Column | None = None
    admittance_magnitude: Column | None = None
    phase: Column | None = None
    resistance: Column | None = None
    reactance: Column | None = None
    conductance: Column | None = None
    susceptance: Column | None = None
    series_capacitance: Column | None = None
    parallel_capacitance: Column | None = None
    series_inductance: Column | None = None
    parallel_inductance: Column | None = None
    parallel_resistance: Column | None = None
    quality_factor: Column | None = None
    dissipation_factor: Column | None = None
    reflection: Column | None = None
    reflection_imaginary: Column | None = None
    transmission: Column | None = None
    transmission_imaginary: Column | None = None
    gain: Column | None = None
    voltage: Column | None = None
    shunt_voltage: Column | None = None


@si.checked_numbers
@dataclass(frozen=True, kw_only=True)
class DescribedImpedance(Described):
    """An impedance or admittance against frequency; of a bare ceramic where its shape is told.

    `reference` is the impedance that waves are told against, `shunt` the resistor between the
    device and ground over which a gain was taken, `compensated` whether the leads were, `band` the
    frequencies that are kept. `open` and `short` are files of the same columns, taken with nothing
    in the fixture and with its ends joined.
    """

    columns: ImpedanceColumns | None = None
    bar: CeramicBar | None = None
    disc: CeramicDisc | None = None
    correct: Literal["phase 180 deg", "phase sign"] | None = None
    reference: Annotated[si.Ohm, RESISTANCE] | None = None
    shunt: Annotated[si.Ohm, RESISTANCE] | None = None
    compensated: bool | None = None
    open: str = ""
    short: str = ""
    band: Band | None = None


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

    columns: ResponseColumns
    voltage: Given | None = None
    x: Annotated[si.Metre, PLACE] | None = None
    y: Annotated[si.Metre, PLACE] | None = None
    correct: Literal["phase 180 deg", "phase sign"] | None = None
    band: Band | None = None


@dataclass(frozen=True)
class LineColumns(Motion):
    """Places along a line, and the motion there."""

    position: Column | None = None


@si.checked_numbers
@dataclass(frozen=True, kw_only=True)
class DescribedLine(Described):
    """Motion along a line at one frequency."""

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


@dataclass(frozen=True)
class RingDownColumns(TimeColumns):
    """Time, and a motion or any `signal` that follows it."""

    signal: Column | None = None


@si.checked_numbers
@dataclass(frozen=True, kw_only=True)
class DescribedRingDown(Described):
    """Motion against time after the drive was switched off, or a signal that follows it."""

    columns: RingDownColumns


@si.checked_numbers
@dataclass(frozen=True, kw_only=True)
class DescribedSignals(Described):
    """Voltage and motion against time."""

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

    columns: ResponseColumns
    sweeps: tuple[SweepFile, ...] = ()

    def responses(self) -> tuple[DescribedResponse, ...]:
        """The descriptions of the sweeps that have files of their own."""
        common = {entry.name: getattr(self, entry.name) for entry in dataclasses.fields(Described)}
        common["kind"] = "frequency response"
        return tuple(
            DescribedResponse(
                columns=self.columns,
                voltage=entry.voltage,
                **common | {"file": entry.file},
            )
            for entry in self.sweeps
        )


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
    "friction decays": DescribedDecays,
    "fingertip impedances": DescribedTouches,
    "detection thresholds": DescribedDetection,
}
"""The kinds of recordings by the word for them."""


@dataclass(frozen=True)
class Description:
    """A description with the text that it was read from, for messages; no `path` and no text where
    a file describes itself."""

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
    return Description(said, Path(path), text)


def _kind(text: str, path: Path) -> str:
    """The kind that is named, by which all other keys are judged."""
    try:
        kind = tomllib.loads(text).get("kind")
    except (ValueError, RecursionError):
        # The loader says what is wrong with the text, in better words.
        return "impedance"
    allowed = ", ".join(f'"{known}"' for known in KINDS)
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
