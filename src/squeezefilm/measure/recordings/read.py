"""`read_recording` and `check_recording`: a file of a bench, with its description beside it."""

from __future__ import annotations

import dataclasses
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, cast

from squeezefilm.core.config import load_text
from squeezefilm.core.errors import ConfigError, InputError, errors_of
from squeezefilm.core.regular_file import read_toml_text
from squeezefilm.core.results import Result, to_json, values_of, write_whole
from squeezefilm.measure.recordings.assembled import assembled
from squeezefilm.measure.recordings.circuits_read import fixture_description, without_fixture
from squeezefilm.measure.recordings.described import Described
from squeezefilm.measure.recordings.description import (
    KINDS,
    DescribedImpedance,
    DescribedSweeps,
    Description,
    load_description,
)
from squeezefilm.measure.recordings.doubts import doubts_of
from squeezefilm.measure.recordings.files.analysers import (
    TOUCHSTONE,
    is_4294a,
    read_4294a,
    read_touchstone,
)
from squeezefilm.measure.recordings.files.raw_table import RawTable
from squeezefilm.measure.recordings.files.scipy_files import read_matlab, read_wav
from squeezefilm.measure.recordings.files.text_table import read_text_table
from squeezefilm.measure.recordings.files.universal import SUFFIXES, read_universal
from squeezefilm.measure.recordings.kinds import FrequencyResponse, Recording, VoltageSweeps
from squeezefilm.measure.recordings.quantities_read import Reading


@dataclass(frozen=True)
class Proposal:
    """A description in TOML of a recording of this `kind`; `to_confirm` is what the file does not
    say itself, empty where it says all."""

    kind: str
    text: str
    to_confirm: str


_FOR_INSTANCE = """
kind = "impedance"
[columns]
frequency = { column = 1, unit = "Hz" }
magnitude = { column = 2, unit = "ohm" }
phase = { column = 3, unit = "deg" }
"""


def proposed(table: RawTable) -> Proposal:
    """The description that a table proposes, filled in. Raises `ConfigError` where its columns'
    names say nothing.

    A frequency with a pair that makes an impedance is one; times with one signal are proposed as a
    ring-down, with more as raw signals of which the first is the drive.
    """
    held = list(table.described)
    quantities = [quantity for quantity, _, _ in held]
    if "frequency" in quantities:
        kind, to_confirm = "impedance", "" if table.sure else "that the columns hold this"
        if "gain" in quantities:
            to_confirm = "the resistor that the gain was taken over: write its value"
    elif quantities[:1] == ["time"] and len(held) > 1:
        drive, *moved = held[1:]
        kind, to_confirm = "ring-down", "that this is a ring-down, and which column holds it"
        held = [held[0], ("signal", *drive[1:])]
        if moved:
            kind = "raw signals"
            to_confirm = (
                "which column is the drive and which the motion, and what one unit of its signal "
                "stands for: write its scale"
            )
            held = [held[0], ("voltage", *drive[1:]), ("displacement", *moved[0][1:])]
    else:
        known = ", ".join(f'"{known}"' for known in KINDS)
        besides = f"(kinds: {known}; columns of the file: {table.columns_in_words})"
        raise _undescribed(table.file, _FOR_INSTANCE, besides)
    lines = [
        f"kind = {_quoted(kind)}",
        f"name = {_quoted(table.file.stem)}",
        f"instrument = {_quoted(table.format.split(',')[0])}",
    ]
    lines += ['shunt = "… ohm"'] if "gain" in quantities else []
    names = [table.names[table.index(column) or 0] for _, column, _ in held]
    # Of the second of a pair: "-Im(Z)", "-phase".
    turned = names[-1][:1] in ("-", "−") and kind == "impedance"
    lines += ['correct = "phase sign"'] if turned else []
    lines.append("\n[columns]")
    for quantity, column, unit in held:
        over = "" if unit == "1" else "/V"
        scale = f', scale = "… nm{over}"' if quantity == "displacement" else ""
        scale = ', scale = "… V"' if quantity == "voltage" and not over else scale
        said = _quoted(column) if isinstance(column, str) else str(column)
        lines.append(f"{quantity} = {{ column = {said}, unit = {_quoted(unit)}{scale} }}")
    return Proposal(kind, "\n".join([*lines, ""]), to_confirm)


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


_TEXTS = (".csv", ".txt", ".tsv", ".dat")
_SCANS = ("line scan", "grid scan")


@dataclass(frozen=True, eq=False, repr=False)
class RecordingCheck(Result):
    """A file as it was read: the recording, and in words how it was taken.

    `facts` are pairs of what and how (range, column, unit, how an amplitude was given), `doubts`
    sentences about what may be wrong; nothing doubtful was corrected. `file` is the data's, and
    `description` the TOML file's (None where the data describe themselves).
    """

    recording: Recording
    kind: str
    file: Path
    description: Path | None
    points: int
    facts: tuple[tuple[str, str], ...]
    doubts: tuple[str, ...]
    _shown: ClassVar[str] = "kind file points"

    def summary(self) -> dict[str, Any]:
        """Numbers as plain JSON values: how the file was read, and not its numbers."""
        return {
            **values_of(self, "kind file description points doubts recording.told"),
            "facts": [{"what": what, "how": how} for what, how in self.facts],
        }


@dataclass(frozen=True)
class Refused:
    """A file of a folder that could not be read, and why."""

    file: Path
    why: str


@dataclass(frozen=True, eq=False)
class FolderCheck:
    """All recordings of a folder, those that were read and those that were refused."""

    checks: tuple[RecordingCheck, ...]
    refused: tuple[Refused, ...]

    def summary(self) -> dict[str, Any]:
        """Numbers as plain JSON values."""
        return {
            "recordings": [check.summary() for check in self.checks],
            "refused": to_json(self.refused),
        }


def read_recording(path: str | Path, described: str | Path | None = None) -> Recording:
    """The recording in a file of a bench, in SI units and zero-to-peak amplitudes.

    `path` is the data's file (text, Touchstone, Universal File, MATLAB up to version 7, WAV) or the
    TOML file that describes it; `described` names that file where it does not stand beside the data
    under the same name. An export of a known instrument needs
    none where its columns' names say all. See ``docs/reference/measured-data.md`` for the keys.

    Raises:
        ConfigError: a file or a description that cannot be used, with file, line and column or key;
            nothing is guessed about units, nor about how an amplitude is given.
    """
    return check_recording(path, described).recording


def check_recording(path: str | Path, described: str | Path | None = None) -> RecordingCheck:
    """Read as `read_recording` does, and tell how it was taken and what is doubtful of it. Raises
    as it does."""
    file, description = _found(Path(path), None if described is None else Path(described))
    recording, readings = _read(file, description)
    facts = [("kind", description.said.kind)]
    for reading in readings:
        table = reading.table
        if len(readings) > 1:
            facts.append(("file", table.file.name))
        facts += [("read as", table.format)]
        facts.append(("points", f"{table.values.shape[0]} rows of {table.values.shape[1]} columns"))
        facts += reading.facts
        facts += [("of the file", note) for note in table.notes]
    told = recording.told
    facts += told.facts
    if told.temperature is not None:
        facts.append(("temperature", f"{told.temperature:.4g} K"))
    return RecordingCheck(
        recording=recording,
        kind=description.said.kind,
        file=file,
        description=description.path,
        points=sum(reading.table.values.shape[0] for reading in readings),
        facts=tuple(facts),
        doubts=(
            *(doubt for reading in readings for doubt in reading.doubts),
            *doubts_of(recording),
        ),
    )


def _read(file: Path, description: Description) -> tuple[Recording, list[Reading]]:
    """The recording of a description, and how each of its files was taken."""
    said = description.said
    if not isinstance(said, DescribedSweeps) or not said.sweeps:
        recording, reading = assembled(description, _table(file, description))
        if isinstance(said, DescribedImpedance) and (said.open or said.short):
            plain = fixture_description(description)
            swept = {
                key: assembled(plain, _table(file.parent / name, plain))[0]
                for key, name in (("open", said.open), ("short", said.short))
                if name
            }
            recording = without_fixture(recording, swept, description)
            files = " and ".join(filter(None, (said.open, said.short)))
            reading.facts.append(("without its fixture", f"by {files}"))
        return recording, [reading]
    parts: list[tuple[FrequencyResponse, Reading]] = []
    for response in said.responses():
        sweep = dataclasses.replace(description, said=response)
        sweep_read, reading = assembled(sweep, _table(file.parent / response.file, sweep))
        parts.append((cast(FrequencyResponse, sweep_read), reading))
    readings = [reading for _, reading in parts]
    down = [any(how.startswith("swept downwards") for _, how in read.facts) for read in readings]
    directions = tuple("down" if fell else "up" for fell in down)
    return VoltageSweeps(tuple(sweep for sweep, _ in parts), directions, said.told(file)), readings


def check_folder(folder: str | Path) -> FolderCheck:
    """`check_recording` for all recordings of a folder: what a TOML file with a kind describes, and
    what describes itself. Files that cannot be read are among the `refused`.

    Raises `InputError` for what is no folder, or one without any recording.
    """
    root = Path(folder)
    if not root.is_dir():
        raise InputError(f"{root} is no folder; give one with recordings in it")
    checks, refused, read = [], [], set()
    descriptions = [entry for entry in sorted(root.glob("*.toml")) if _has_kind(entry)]
    themselves = [entry for entry in sorted(root.iterdir()) if _says_itself(entry)]
    for path in [*descriptions, *themselves]:
        if path in read:
            continue
        try:
            check = check_recording(path)
        except ConfigError as error:
            refused.append(Refused(path, str(error)))
            continue
        read.add(check.file)
        checks.append(check)
    if not checks and not refused:
        kinds = ", ".join(f'"{entry}"' for entry in KINDS)
        raise InputError(
            f"{root} holds no recording: none of its TOML files has a kind ({kinds}); write one "
            "beside each file of data"
        )
    return FolderCheck(tuple(checks), tuple(refused))


def _says_itself(path: Path) -> bool:
    """True where a file is of an instrument that says what it holds, and needs no description."""
    if not path.is_file() or path.with_suffix(".toml").exists():
        return False
    suffix = path.suffix.lower()
    if suffix not in _TEXTS and not TOUCHSTONE.fullmatch(suffix) and not is_4294a(path):
        return False
    try:
        return not propose_description(path).to_confirm
    except ConfigError:
        return False


def _has_kind(path: Path) -> bool:
    """True where a TOML file describes a recording; a display in the same folder does not."""
    try:
        text = read_toml_text(path)
    except ConfigError:
        return False
    return any(line.split("=")[0].strip() == "kind" for line in text.split("\n"))


def _found(path: Path, described: Path | None) -> tuple[Path, Description]:
    """The data's file and what describes it."""
    if path.suffix.lower() == ".toml":
        description = load_description(path)
        return _data_of(path, description.said), description
    if described is None and path.with_suffix(".toml").is_file():
        described = path.with_suffix(".toml")
    if described is not None:
        return path, load_description(described)
    table = _table(path, Description(Described(kind="")))
    proposal = proposed(table)
    if proposal.to_confirm:
        columns = table.columns_in_words
        kept = f"`squeezefilm measure check {path.name} --write` writes this"
        raise _undescribed(
            path,
            proposal.text,
            f"(confirm {proposal.to_confirm}; columns of the file: {columns}; {kept})",
        )
    return path, Description(load_text(KINDS[proposal.kind], proposal.text))


def propose_description(path: str | Path) -> Proposal:
    """The description that a file's instrument and columns propose, filled in.

    Raises `ConfigError` for a file that cannot be read, or of which neither says what it holds.
    """
    return proposed(_table(Path(path), Description(Described(kind=""))))


def write_description(path: str | Path) -> Path:
    """Write the proposed description beside a file and answer with its path.

    Raises `ConfigError` as `propose_description` does, and `InputError` where one is there.
    """
    beside = Path(path).with_suffix(".toml")
    if beside.exists():
        raise InputError(f"{beside.name} is there already; delete it to have another proposed")
    write_whole(beside, propose_description(path).text)
    return beside


def _data_of(path: Path, said: Described) -> Path:
    """The file that a description names, or the one beside it under the same name; of sweeps with
    files of their own the description's."""
    if isinstance(said, DescribedSweeps) and said.sweeps:
        return path
    if said.file:
        return path.parent / said.file
    beside = sorted(
        candidate for candidate in path.parent.glob(f"{path.stem}.*") if candidate.suffix != ".toml"
    )
    if len(beside) == 1:
        return beside[0]
    there = ", ".join(candidate.name for candidate in beside) or "none"
    raise ConfigError(
        f"one file of data of the same name must stand beside it, and there are: {there}; name it "
        'with file = "…"',
        file=path,
    )


def _table(file: Path, description: Description) -> RawTable:
    """The table in a file, by what the file is."""
    suffix = file.suffix.lower()
    with errors_of(file):
        if suffix in SUFFIXES:
            at = getattr(description.said, "frequency", None)
            return read_universal(file, at if description.said.kind in _SCANS else None)
        if suffix == ".mat":
            return read_matlab(file)
        if suffix in (".xls", ".xlsx", ".ods"):
            raise ConfigError("is a spreadsheet; save its table as CSV")
        if TOUCHSTONE.fullmatch(suffix):
            return read_touchstone(file)
        if suffix == ".wav":
            return read_wav(file)
        if is_4294a(file):
            return read_4294a(file)
        return read_text_table(file, description.said)


def _undescribed(path: Path, text: str, besides: str) -> ConfigError:
    """Error that tells what to write where nothing says what the columns of a file are."""
    shown = "\n".join(f"  {line}" for line in text.strip().split("\n"))
    return ConfigError(
        f"nothing says for sure what its columns hold; write {path.with_suffix('.toml').name} "
        f"beside it, for instance\n{shown}\n{besides}",
        file=path,
    )
