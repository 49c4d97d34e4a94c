"""Answers that another program recorded, from files with columns of its own names: CSV, or JSON as
jsPsych saves it; one file, or a folder with one for each person or session.

A row is a trial, or an answer that was given many times (`count`). Columns of the names that
`study export` writes need not be told. Rows that cannot be what they say (pasted twice, another
unit) are refused by their line.
"""

from __future__ import annotations

import itertools
import math
import re
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.core.formats.traces import csv_rows, text_of_file
from squeezefilm.core.hard_limits import FOREIGN_TRIALS, TABLE_BYTES, require_within
from squeezefilm.core.regular_file import read_json
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.record.answers import EXPLORED, Answers, answers_of
from squeezefilm.study.record.implausible import Answered, require_plausible_rows
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
_NOT_SET_ASIDE = ("0", "false", "no", "n/a", "none")
# A loop of PsychoPy that is named for what comes before the trials.
_PRACTICE_LOOP = re.compile(r"(?i).*(practi[cs]e|training|warm).*\.this(Trial)?N$")
_MEASURED = (*NUMBERS, MILLISECONDS, COUNT)
SUFFIXES = (".csv", ".tsv", ".json")
"""Ends of the names of files with answers."""
PEOPLE = "participants of another program"


def read_answers(
    path: str | Path,
    design: StudyDesign,
    columns: Mapping[str, str] | None = None,
    values: Mapping[str, str] | None = None,
    decimal_comma: bool = False,
) -> Answers:
    """The answers in a file to a design's questions, or in all files of a folder.

    A file is CSV (comma, semicolon or tab), or JSON with a list of trials. Of a folder all files
    that end in .csv, .tsv or .json are read, in the order of their names; one without a column for
    the participant is of the person whom its name says.
    `columns` maps our names to the file's: "participant_id" (who, wanted), "stimulus" and
    "second_stimulus" (by the design's names), "choice" (one of the design's answers) or "estimate"
    (a number), "response_time_s" or "response_time_ms", "display" (the design's first, if left
    out), "phase" ("main", if left out), "count" (how many trials a row stands for) and others of
    `study export`. A row without an answer is left out: programs write such for what is no trial.
    One of a loop of PsychoPy that is named for practice is practice.
    What is right follows from the stimuli, and from the "intensity" of an "adaptive_series", unless
    "answer" says it.
    Rows are taken to be in each person's order, and so are a person's files. `values` maps the
    file's words for answers and stimuli to the design's, like "left" to "first"; `decimal_comma`
    reads "1,25".

    What cannot be is refused (`require_plausible_rows`): rows pasted twice, times in
    another unit or below 0, a pair without the reference.

    Raises:
        ConfigError: a file that cannot be read, with the line and column of what is not understood.
        InputError: a column that is not there, or no answer at all.
    """
    limit = int(FOREIGN_TRIALS.most)
    rows: list[dict[str, Cell]] = []
    given: dict[str, int] = {}
    known: dict[Answered, str] = {}
    for file in _files(path):
        source = _File(file, design, columns or {}, values or {}, decimal_comma)
        found = _rows(source, given, named=file != Path(path))
        numbered = list(itertools.islice(found, limit + 1 - len(rows)))
        if not numbered:
            raise InputError(
                f"{file} has no row with an answer; is the column of the choice right?"
            )
        people: dict[str, list[tuple[int, dict[str, Cell]]]] = defaultdict(list)
        for line, row in numbered:
            people[str(row["participant_id"])].append((line, row))
        for mine in people.values():
            # Each person's in the order of their trials, however the file is sorted.
            mine.sort(key=lambda pair: int(str(pair[1]["trial"])))
        require_plausible_rows(file, design, people, known)
        rows += [row for mine in people.values() for _, row in mine]
        require_within(FOREIGN_TRIALS, len(rows), enough="give a part of them")
    return answers_of(design, rows, PEOPLE)


def _files(path: str | Path) -> list[Path]:
    """The file itself, or a folder's files of answers."""
    folder = Path(path)
    if not folder.is_dir():
        return [folder]
    files = sorted(file for file in folder.iterdir() if file.suffix.lower() in SUFFIXES)
    if not files:
        raise InputError(f"{path} has no file that ends in {', '.join(SUFFIXES)}")
    return files


def columns_of(text: str, quantity: str = "columns") -> dict[str, str]:
    """ "choice=key_resp.keys, participant_id=who" as a mapping. Raises `InputError`."""
    columns: dict[str, str] = {}
    for part in filter(None, (one.strip() for one in text.split(","))):
        name, is_equal, theirs = (word.strip() for word in part.partition("="))
        if not (is_equal and name and theirs):
            raise InputError(
                f"'{part}' says no column and no word; write NAME=COLUMN, like "
                "choice=key_resp.keys, or WORD=ANSWER, like left=first",
                quantity=quantity,
            )
        columns[name] = theirs
    return columns


@dataclass(frozen=True, slots=True, eq=False)
class _File:
    """A file with answers, and how it is read, see `read_answers`."""

    path: Path
    design: StudyDesign
    columns: Mapping[str, str]
    values: Mapping[str, str]
    decimal_comma: bool

    def refused(self, line: int, key: str, said: str) -> ConfigError:
        """An error in a row, and in the file's column for one of ours."""
        return ConfigError(said, file=self.path, line=line, key=self.columns.get(key, key) or None)

    def number(self, line: int, key: str, text: str) -> float:
        """A number in a cell; NaN for none."""
        if text.lower() in ("", "n/a", "na", "nan", "none"):
            return math.nan
        try:
            # Python would read 1_234 as 1234.
            return float(text.replace("_", "no number"))
        except ValueError as error:
            raise self.refused(
                line,
                key,
                f"'{text}' is no number; write one with a point, like 0.0125, or ask for decimal "
                "commas (decimal_comma)",
            ) from error


def _rows(
    file: _File, given: dict[str, int], *, named: bool
) -> Iterator[tuple[int, dict[str, Cell]]]:
    """Rows with their line (in JSON: trial); `given` counts those of each person, whom the file's
    name says where it is `named` for one."""
    names, lines = (_json if file.path.suffix.lower() == ".json" else _csv)(file.path)
    of_file = {"participant_id": file.path.stem} if named else {}
    places = _places(file, names, of_file)
    practised = [at for at, name in enumerate(names) if _PRACTICE_LOOP.match(name)]
    for number, cells in lines:
        words = of_file | {key: unguarded(cells[at].strip()) for key, at in places.items()}
        if not words.get("choice") and not words.get("estimate"):
            continue
        if "phase" not in places and any(cells[at].strip() for at in practised):
            words["phase"] = "practice"
        for key in ("choice", *SURFACES, "answer"):
            if key in words:
                words[key] = file.values.get(words[key], words[key])
        if words.get("choice") == "None" and "None" not in file.design.answers:
            continue  # PsychoPy's word for no key.
        if file.decimal_comma:
            words |= {key: words[key].replace(",", ".") for key in _MEASURED if key in words}
        row = _row(file, number, words)
        for _ in range(_count(file, number, words)):
            who = str(row["participant_id"])
            given[who] = given.get(who, 0) + 1
            yield number, {**row, "trial": given[who] if row["trial"] == "" else row["trial"]}


def _csv(path: Path) -> tuple[list[str], Iterator[tuple[int, list[str]]]]:
    """The names of columns, and each row's line and cells."""
    lines = text_of_file(path).lstrip("\ufeff").splitlines()
    head = lines[0] if lines else ""
    every = csv_rows(lines, path, max(",;\t", key=head.count))
    names = [name.strip() for name in next(every, (0, []))[1]]

    def rows() -> Iterator[tuple[int, list[str]]]:
        for number, cells in every:
            if not any(cell.strip() for cell in cells):
                continue
            if len(cells) < len(names) or any(cell.strip() for cell in cells[len(names) :]):
                raise ConfigError(
                    f"has {len(cells)} cells where the header has {len(names)}",
                    file=path,
                    line=number,
                )
            yield number, cells

    return names, rows()


def _json(path: Path) -> tuple[list[str], Iterator[tuple[int, list[str]]]]:
    """The same of a list of trials; what a trial does not say is empty."""
    trials = read_json(path, TABLE_BYTES, "a list of trials")
    if not isinstance(trials, list) or not all(isinstance(trial, dict) for trial in trials):
        raise ConfigError("holds no list of trials, as jsPsych's data.json() has it", file=path)
    names = list(dict.fromkeys(name for trial in trials for name in trial))

    def cells(trial: dict[str, Any]) -> list[str]:
        return ["" if trial.get(name) is None else str(trial[name]) for name in names]

    return names, ((number, cells(trial)) for number, trial in enumerate(trials, 1))


def _places(file: _File, names: list[str], known: Mapping[str, str]) -> dict[str, int]:
    """Places of our columns in the file, but for what is `known` without one."""
    path, design, columns = file.path, file.design, file.columns
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
    for name in (columns.get(key, key) for key in ours):
        if names.count(name) > 1:
            said = f"{path} has {names.count(name)} columns '{name}'; keep one"
            raise InputError(said, quantity="columns")
    places = {
        key: names.index(columns.get(key, key)) for key in ours if columns.get(key, key) in names
    }
    if {"response_time_s", MILLISECONDS} <= places.keys():
        said = f"{path} has response_time_s and {MILLISECONDS}; keep one of the two columns"
        raise InputError(said, quantity="columns")
    wanted = ["participant_id", "stimulus", "choice" if design.answers else "estimate"]
    wanted += SURFACES[1 : design.described.surfaces]
    lacking = [key for key in wanted if key not in places and key not in known]
    if lacking:
        raise InputError(
            f"{path} has no column {', '.join(lacking)}; say which it is by "
            f'columns "{lacking[0]}=…"; it has {", ".join(names) or "none"}',
            quantity="columns",
        )
    return places


def _row(file: _File, line: int, words: Mapping[str, str]) -> dict[str, Cell]:
    """A row as `study export` would have it."""
    design, number = file.design, partial(file.number, line)
    found: dict[str, Cell] = {key: words.get(key, "") for key in WORDS}
    found["display"] = found["display"] or design.displays[0]
    found["phase"] = found["phase"] or "main"
    found |= {key: number(key, words.get(key, "")) for key in NUMBERS}
    if MILLISECONDS in words:
        found["response_time_s"] = number(MILLISECONDS, words[MILLISECONDS]) / 1000
    allowed = {
        "display": design.displays,
        "phase": ("practice", "main", "catch", "familiarisation"),
    }
    if design.answers:
        allowed["choice"] = design.answers
        if words.get("answer"):
            allowed["answer"] = design.answers
    for key, words_allowed in allowed.items():
        if found[key] not in words_allowed:
            said = f"'{found[key]}' is none of: {', '.join(words_allowed)}; values = "
            said += f'"{found[key] or "WORD"}={words_allowed[0]}" says what it means'
            raise file.refused(line, key, said)
    if str(found["set_aside"]).lower() in _NOT_SET_ASIDE:
        found["set_aside"] = ""
    if found["trial"]:
        trial = number("trial", words["trial"])
        if not trial.is_integer():
            raise file.refused(line, "trial", f"'{words['trial']}' is no whole number")
        found["trial"] = int(trial)
    if not design.answers and not float(str(found["estimate"])) > 0:
        said = f"'{words['estimate']}' is not above 0, and has no logarithm"
        raise file.refused(line, "estimate", said)
    pair = [str(found[key]) for key in SURFACES if found[key]]
    if not pair:
        said = "is empty; a row with an answer says what was presented"
        raise file.refused(line, SURFACES[0], said)
    try:
        surfaces = [presented(design, name, found) for name in pair]
    except InputError as error:
        raise file.refused(line, error.quantity or "", str(error)) from error
    right = design.answer_to(*surfaces)
    if words.get("answer") and right not in ("", words["answer"]) and found["phase"] != "catch":
        said = f"'{words['answer']}' is not right here, where '{right}' is; are columns exchanged?"
        raise file.refused(line, "answer", said)
    found["answer"] = words.get("answer", right)
    return found


def _count(file: _File, line: int, words: Mapping[str, str]) -> int:
    if COUNT not in words:
        return 1
    count = file.number(line, COUNT, words[COUNT])
    if not (count >= 0 and count.is_integer()):
        raise file.refused(line, COUNT, f"'{words[COUNT]}' is no count; write 0, 1, 2 …")
    # Here already, for no list of so many is made.
    require_within(FOREIGN_TRIALS, max(count, 1.0), enough="give a part of the file")
    return int(count)
