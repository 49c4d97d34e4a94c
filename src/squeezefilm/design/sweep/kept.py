"""Answers kept in a file under what was asked, so that a sweep that was stopped goes on, and one
that asks more computes only what is new."""

from __future__ import annotations

import hashlib
import json
import math
from pathlib import Path
from typing import Any

from squeezefilm.core.kept.computed_by import computed_by
from squeezefilm.core.results import config_hash, to_json
from squeezefilm.design.sweep.lines import Lines
from squeezefilm.design.sweep.options import OPTIONS
from squeezefilm.design.sweep.points import Answer, Point
from squeezefilm.design.sweep.verbs import VERBS

FILE = "answers.jsonl"
"""Its name in the folder of a sweep: a line for every answer, appended as it comes."""


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


class Kept:
    """The answers in a folder's file, by address; without a folder, in memory.

    Raises `InputError` where the file cannot be read or written.
    """

    def __init__(self, folder: Path | None) -> None:
        self._lines = None if folder is None else Lines(folder / FILE)
        self._answers: dict[str, Answer] = {}
        if self._lines is not None:
            self._lines.read(self._take)

    def _take(self, read: Any) -> None:
        self._answers[read["address"]] = _answer(read)

    def __len__(self) -> int:
        return len(self._answers)

    def get(self, at: str) -> Answer | None:
        """The answer at an address, None where there is none yet."""
        return self._answers.get(at)

    def add(self, at: str, point: Point, answer: Answer) -> None:
        """Keep an answer; what might be another one another time is kept in memory only."""
        self._answers[at] = answer
        if self._lines is None or not answer.lasting:
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


def _answer(read: dict[str, Any]) -> Answer:
    numbers = {
        str(key): math.nan if value is None else float(value)
        for key, value in read["numbers"].items()
    }
    return Answer(
        numbers,
        tuple(map(str, read["warnings"])),
        str(read["reason"]),
        float(read["seconds"]),
        modes=read["modes"],
    )
