"""Answers that another program recorded, from a CSV file with columns of its own names.

A row is a trial, or an answer that was given many times (`count`). Columns of the names that
`study export` writes need not be told.
"""

from __future__ import annotations

import csv
import itertools
import math
from collections.abc import Iterator, Mapping
from pathlib import Path

from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.core.formats.traces import text_of_file
from squeezefilm.core.hard_limits import FOREIGN_TRIALS, require_within
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.record.answers import EXPLORED, Answers, answers_of
from squeezefilm.study.record.implausible import require_plausible_rows
from squeezefilm.study.record.tables import SURFACES, Cell, presented, unguarded

NUMBERS = ("intensity", "estimate", "response_time_s", *EXPLORED)
WORDS = (
    "participant_id",
    "display",
    "trial",
    "phase",
    *SURFACES,
    "adaptive_series",
    "answer",
    "choice",
    "set_aside",
)
COUNT = "count"
MILLISECONDS = "response_time_ms"
_MEASURED = (*NUMBERS, MILLISECONDS, COUNT)
PEOPLE = "participants of another program"


def read_answers(
    path: str | Path,
    design: StudyDesign,
    columns: Mapping[str, str] | None = None,
    values: Mapping[str, str] | None = None,
    decimal_comma: bool = False,
) -> Answers:
    """The answers in a CSV file (comma, semicolon or tab) to a design's questions.

    `columns` maps our names to the file's: "participant_id" (who, wanted), "stimulus" and
    "second_stimulus" (by the design's names), "choice" (one of the design's answers) or "estimate"
    (a number), "response_time_s" or "response_time_ms", "display" (the design's first, if left
    out), "phase" ("main", if left out), "count" (how many trials a row stands for) and others of
    `study export`. A row without an answer is left out: programs write such for what is no trial.
    What is right follows from the stimuli, and from the "intensity" of an "adaptive_series", unless
    "answer" says it.
    Rows are taken to be in each person's order. `values` maps the file's words for answers and
    stimuli to the design's, like "left" to "first"; `decimal_comma` reads "1,25".

    What cannot be is refused (`implausible.require_plausible_rows`): rows pasted twice, times in
    another unit or below 0, a pair without the reference.

    Raises:
        ConfigError: a file that cannot be read, with the line and column of what is not understood.
        InputError: a column that is not there, or no answer at all.
    """
    limit = int(FOREIGN_TRIALS.most)
    how = dict(columns or {}), dict(values or {}), decimal_comma
    numbered = list(itertools.islice(_rows(path, design, *how), limit + 1))
    rows = [row for _, row in numbered]
    if not rows:
        raise InputError(f"{path} has no row with an answer; is the column of the choice right?")
    require_within(FOREIGN_TRIALS, len(rows), enough="give a part of the file")
    require_plausible_rows(path, design, numbered)
    return answers_of(design, rows, PEOPLE)


def columns_of(text: str, quantity: str = "columns") -> dict[str, str]:
    """ "choice=key_resp.keys, participant_id=who" as a mapping. Raises `InputError`."""
    found: dict[str, str] = {}
    for part in filter(None, (one.strip() for one in text.split(","))):
        name, is_equal, theirs = (one.strip() for one in part.partition("="))
        if not (is_equal and name and theirs):
            raise InputError(
                f"'{part}' says no column and no word; write NAME=COLUMN, like "
                "choice=key_resp.keys, or WORD=ANSWER, like left=first",
                quantity=quantity,
            )
        found[name] = theirs
    return found


def _rows(
    path: str | Path,
    design: StudyDesign,
    columns: dict[str, str],
    values: dict[str, str],
    decimal_comma: bool,
) -> Iterator[tuple[int, dict[str, Cell]]]:
    lines = text_of_file(path).lstrip("\ufeff").splitlines()
    head = lines[0] if lines else ""
    delimiter = max(",;\t", key=head.count)
    reader = csv.reader(lines, delimiter=delimiter)
    names = [one.strip() for one in next(reader, [])]
    places = _places(path, design, names, columns)
    given: dict[str, int] = {}
    for number, cells in enumerate(reader, 2):
        if not any(one.strip() for one in cells):
            continue
        if len(cells) < len(names):
            raise ConfigError(
                f"has {len(cells)} cells where the header has {len(names)}", file=path, line=number
            )
        words = {key: unguarded(cells[at].strip()) for key, at in places.items()}
        if not words.get("choice") and not words.get("estimate"):
            continue
        for key in ("choice", *SURFACES, "answer"):
            if key in words:
                words[key] = values.get(words[key], words[key])
        if decimal_comma:
            words |= {key: words[key].replace(",", ".") for key in _MEASURED if key in words}
        row = _row(path, number, design, words, columns)
        for _ in range(_count(path, number, words)):
            who = str(row["participant_id"])
            given[who] = given.get(who, 0) + 1
            yield number, {**row, "trial": row["trial"] or given[who]}


def _places(
    path: str | Path, design: StudyDesign, names: list[str], columns: dict[str, str]
) -> dict[str, int]:
    """Where each of our columns is in the file."""
    ours = (*WORDS, *NUMBERS, COUNT, MILLISECONDS)
    for key, theirs in columns.items():
        if key not in ours:
            raise InputError(
                f"there is no '{key}'; columns may be told of {', '.join(ours)}", quantity="columns"
            )
        if theirs not in names:
            raise InputError(
                f"{path} has no column '{theirs}'; it has {', '.join(names) or 'none'}",
                quantity="columns",
            )
    places = {
        key: names.index(columns.get(key, key)) for key in ours if columns.get(key, key) in names
    }
    wanted = ["participant_id", "stimulus", "choice" if design.answers else "estimate"]
    wanted += SURFACES[1 : design.described.surfaces]
    lacking = [key for key in wanted if key not in places]
    if lacking:
        raise InputError(
            f"{path} has no column {', '.join(lacking)}; say which it is by "
            f'columns "{lacking[0]}=…"; it has {", ".join(names) or "none"}',
            quantity="columns",
        )
    return places


def _row(
    path: str | Path,
    line: int,
    design: StudyDesign,
    words: Mapping[str, str],
    columns: Mapping[str, str],
) -> dict[str, Cell]:
    """A row as `study export` would have it."""
    found: dict[str, Cell] = {key: words.get(key, "") for key in WORDS}
    found["display"] = found["display"] or design.displays[0]
    found["phase"] = found["phase"] or "main"
    for key in NUMBERS:
        found[key] = _number(path, line, columns.get(key, key), words.get(key, ""))
    if MILLISECONDS in words:
        time = _number(path, line, columns.get(MILLISECONDS, MILLISECONDS), words[MILLISECONDS])
        found["response_time_s"] = time / 1000
    allowed = {
        "display": design.displays,
        "phase": ("practice", "main", "catch", "familiarisation"),
    }
    if design.answers:
        allowed["choice"] = design.answers
    for key, words_allowed in allowed.items():
        if found[key] not in words_allowed:
            raise ConfigError(
                f"'{found[key]}' is none of: {', '.join(words_allowed)}; values = "
                f'"{found[key] or "WORD"}={words_allowed[0]}" says what it means',
                file=path,
                line=line,
                key=columns.get(key, key),
            )

    def refused(key: str, said: str) -> ConfigError:
        return ConfigError(said, file=path, line=line, key=columns.get(key, key) or None)

    if found["trial"]:
        trial = _number(path, line, columns.get("trial", "trial"), words["trial"])
        if not trial.is_integer():
            raise refused("trial", f"'{words['trial']}' is no whole number")
        found["trial"] = int(trial)
    if not design.answers and not float(str(found["estimate"])) > 0:
        raise refused("estimate", f"'{words['estimate']}' is not above 0, and has no logarithm")
    pair = [str(found[key]) for key in SURFACES if found[key]]
    try:
        surfaces = [presented(design, one, found) for one in pair]
    except InputError as error:
        raise refused(error.quantity or "", str(error)) from error
    if "answer" not in words:
        found["answer"] = design.answer_to(*surfaces)
    return found


def _number(path: str | Path, line: int, column: str, text: str) -> float:
    if text.lower() in ("", "n/a", "na", "nan", "none"):
        return math.nan
    try:
        return float(text)
    except ValueError as error:
        raise ConfigError(
            f"'{text}' is no number; write one with a point, like 0.0125, or ask for decimal "
            "commas (decimal_comma)",
            file=path,
            line=line,
            key=column,
        ) from error


def _count(path: str | Path, line: int, words: Mapping[str, str]) -> int:
    if COUNT not in words:
        return 1
    found = _number(path, line, COUNT, words[COUNT])
    if not (found >= 0 and found == int(found)):
        raise ConfigError(
            f"'{words[COUNT]}' is no count; write 0, 1, 2 …", file=path, line=line, key=COUNT
        )
    return int(found)
