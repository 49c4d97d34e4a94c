"""Points in, answers out: what a sweep asks of those who answer (`design.sweep.workers`), and
the file that keeps what they said, so that a sweep that was stopped goes on."""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
import os
import re
import time
import warnings
import zlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from squeezefilm.core.errors import ConfigError, InputError, SqueezefilmWarning
from squeezefilm.core.hard_limits import LINES_BYTES
from squeezefilm.core.kept.computed_by import computed_by
from squeezefilm.core.regular_file import parsed_json, read_regular, require_regular
from squeezefilm.core.results import config_hash, to_json
from squeezefilm.design.sweep.answers import OPTIONS, VERBS, numbers_of
from squeezefilm.design.sweep.tasks import NoAnswer, tried
from squeezefilm.physics.display import Display

SET_ASIDE = ".damaged"
"""Suffix of a file's name for the lines of it that were damaged."""

_CHECK = re.compile(rb',"check":"([0-9a-f]{8})"\}')
_CHECK_SIZE = len(b',"check":"01234567"}')


def _checked_line(values: dict[str, Any]) -> bytes:
    """A JSON object on a line of its own, and in it a checksum of the others of its bytes."""
    text = json.dumps(values, ensure_ascii=False, separators=(",", ":"), allow_nan=False).encode()
    return text[:-1] + b',"check":"%08x"}' % zlib.crc32(text)


def _values_of(line: bytes) -> Any:
    """The values on a line; None for one of another version, without a checksum. Raises
    `ValueError` for a damaged one: of another checksum than it states, or no JSON."""
    stated = _CHECK.fullmatch(line[-_CHECK_SIZE:])
    if stated and int(stated[1], 16) != zlib.crc32(line[:-_CHECK_SIZE] + b"}"):
        raise ValueError("not what was written")
    values = parsed_json(line)
    return values if stated else None


class Lines:
    """A file with a JSON object on each line; several programs may append to one.

    Without a file nothing is kept. Raises `InputError` where the file cannot be read or written,
    and for what is no regular file.
    """

    def __init__(self, file: Path | None) -> None:
        self._file = file

    def read(self, take: Callable[[Any], None]) -> None:
        """Give `take` what is on each line.

        A line of another version (without a checksum, or one that it cannot take) is passed over,
        and so is the half of a line that a program left which was killed. A damaged line is
        blanked, and kept in a file beside this one; a `SqueezefilmWarning` names it.
        """
        if self._file is None:
            return
        try:
            self._file.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(
                f"cannot use {self._file}: {error.strerror}; choose another folder"
            ) from error
        if not os.path.lexists(self._file):
            return
        data = read_regular(self._file, LINES_BYTES, "a file of answers, or move it away")
        begin, damaged = 0, []
        for number, line in enumerate(data.splitlines(keepends=True), 1):
            begin, here = begin + len(line), begin
            content = line.strip()
            if not content or (content.startswith(b"{") and not content.endswith(b"}")):
                continue
            try:
                values = _values_of(content)
            except ValueError:
                damaged.append((number, here, content))
                continue
            # Any fault of a value, where another version meant something else by it.
            with contextlib.suppress(
                ValueError, LookupError, TypeError, AttributeError, ArithmeticError
            ):
                if values is not None:
                    take(values)
        if damaged:
            self._set_aside(self._file, data, damaged)

    @staticmethod
    def _set_aside(at: Path, data: bytes, damaged: list[tuple[int, int, bytes]]) -> None:
        """Keep damaged lines beside the file, and put blanks in their place.

        Other programs append meanwhile: nothing of the file is moved, nor its end touched.
        """
        place = at.with_name(at.name + SET_ASIDE)
        try:
            require_regular(place, "a file of damaged lines")
            with place.open("ab") as beside:
                beside.write(b"".join(line + b"\n" for _, _, line in damaged))
            with at.open("rb+") as file:
                for _, begin, line in damaged:
                    start = data.index(line, begin)
                    file.seek(start)
                    file.write(b" " * len(line))
            kept = f"set aside in {place.name}"
        except (OSError, ConfigError) as error:
            kept = f"skipped (they could not be saved: {error})"
        numbers = [str(number) for number, _, _ in damaged]
        which = ", ".join(numbers[:5]) + (f" and {len(numbers) - 5} more" if numbers[5:] else "")
        warnings.warn(
            f"{at}: damaged lines ({which}) are {kept}; what they held is computed again",
            SqueezefilmWarning,
            stacklevel=2,
        )

    def append(self, values: Iterable[dict[str, Any]]) -> None:
        """Add a line for each value, all in one write, so that lines of several programs do not
        mix; a line that was cut off before ends first, and swallows none of these."""
        lines = [_checked_line(value) for value in values]
        if self._file is None or not lines:
            return
        try:
            with self._file.open("ab") as file:
                file.write(b"\n" + b"\n".join(lines) + b"\n")
        except OSError as error:
            raise InputError(
                f"cannot write {self._file}: {error.strerror}; free space or choose another "
                "folder, and it goes on from there"
            ) from error


@dataclass(frozen=True, eq=False)
class Point:
    """A question: a display and operating options, and the verb that is asked; `samples` is the
    base of an interval's samples, 0 for none."""

    display: Display
    options: Mapping[str, Any]
    verb: str
    samples: int = 0


@dataclass(frozen=True, eq=False)
class Answer:
    """Answer of a verb about a point: its numbers by dotted key, its warnings, what it took (s),
    and where it refused, the reason. `lasting` is an answer that would be the same another time;
    `modes` are those to be followed, with their motions."""

    numbers: Mapping[str, float]
    warnings: tuple[str, ...] = ()
    reason: str = ""
    seconds: float = 0.0
    lasting: bool = True
    modes: Mapping[str, Any] | None = field(default=None, repr=False)


def answer_of(point: Point) -> Answer:
    """The answer to one point, in this process. What is refused or fails is an answer, too."""
    began = time.perf_counter()
    verb = VERBS[point.verb]

    def asked() -> dict[str, Any]:
        display = verb.display(point.display, point.options)
        return verb.answer(display, verb.settings(point.options), point.samples)

    said = tried(asked)
    seconds = time.perf_counter() - began
    if isinstance(said, NoAnswer):
        return Answer({}, reason=said.reason, seconds=seconds, lasting=said.lasting)
    return Answer(
        dict(numbers_of(said)),
        tuple(said.get("warnings", ())),
        seconds=seconds,
        modes=said if "motions" in said else None,
    )


FILE = "answers.jsonl"
"""Name of the file in the folder of a sweep: a line for every answer, appended as it comes."""


def address(point: Point, described: dict[Any, Any] | None = None) -> str:
    """The SHA-256 of all that an answer depends on: the display's values, verb, options (of a file
    what is in it), samples and the code that computes (`computed_by`).

    `described` keeps what many points share: what was made of displays, by their `id`, and of
    files, by option and name. Raises `ConfigError` for a file that cannot be read.
    """
    verb, known = VERBS[point.verb], {} if described is None else described
    whole = verb.display(point.display, point.options)
    if whole is point.display:
        if id(whole) not in known:
            known[id(whole)] = to_json(whole)
        values = known[id(whole)]
    else:
        values = to_json(whole)
    question = {
        "computed_by": computed_by(),
        "verb": point.verb,
        "options": {
            name: _meant(name, value, known) for name, value in verb.settings(point.options).items()
        },
        "samples": point.samples if verb.draws else 0,
        "display": values,
    }
    text = json.dumps(question, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def _meant(name: str, value: Any, known: dict[Any, Any]) -> Any:
    """An option's value; in place of a file's name, which says nothing of a file that was edited,
    the hash of what is read from it."""
    option = OPTIONS[name]
    if not option.of_file:
        return value
    if (name, value) not in known:
        known[name, value] = config_hash(option.argument(value))
    return known[name, value]


class KeptAnswers:
    """The answers in a folder's file, by address; without a folder, in memory.

    Raises `InputError` where the file cannot be read or written.
    """

    def __init__(self, folder: Path | None) -> None:
        self._lines = Lines(folder and folder / FILE)
        self._answers: dict[str, Answer] = {}
        self._lines.read(self._take)

    def _take(self, read: Any) -> None:
        numbers = {
            str(key): math.nan if value is None else float(value)
            for key, value in read["numbers"].items()
        }
        self._answers[read["address"]] = Answer(
            numbers,
            tuple(map(str, read["warnings"])),
            str(read["reason"]),
            float(read["seconds"]),
            modes=read["modes"],
        )

    def __len__(self) -> int:
        return len(self._answers)

    def get(self, at: str) -> Answer | None:
        """The answer at an address, None where there is none yet."""
        return self._answers.get(at)

    def add(self, at: str, point: Point, answer: Answer) -> None:
        """Keep an answer; what might be another one another time is kept in memory only."""
        self._answers[at] = answer
        if not answer.lasting:
            return
        kept = {
            "address": at,
            "verb": point.verb,
            "numbers": to_json(answer.numbers),
            "warnings": answer.warnings,
            "reason": answer.reason,
            "seconds": answer.seconds,
            "modes": answer.modes,
        }
        self._lines.append([kept])
