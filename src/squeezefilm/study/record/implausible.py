"""Rows of a file with answers that cannot be what they say, refused by their line."""

from __future__ import annotations

import itertools
import math
import re
import unicodedata
from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median

from squeezefilm.core.errors import ConfigError
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.record.tables import SURFACES, Cell

Answered = tuple[tuple[str, ...], ...]
"""The answers of a person, row by row."""
Numbered = Sequence[tuple[int, Mapping[str, Cell]]]
"""Rows with their line in the file."""
LONGEST_USUAL = 100.0
"""Median response time of somebody (s) above which it is held to be in milliseconds."""
_FACTOR = 300.0
_FEWEST, _FEWEST_SURFACES = 12, 4
_OFF_SCALE = math.log(30.0)
"""Logarithm of the factor beyond which a number is of another unit."""
_ANSWERED = ("display", "phase", *SURFACES, "choice", "estimate")
_TIMED = (*_ANSWERED, "response_time_s")


def require_plausible_rows(
    path: str | Path,
    design: StudyDesign,
    people: Mapping[str, Numbered],
    known: dict[Answered, str],
) -> None:
    """Refuse rows of `people` that cannot be what they say, with their line.

    `known` has the answers of people in other files, and takes up those of this one.

    Raises `ConfigError` for times below 0, in milliseconds or that are moments, a pair without the
    reference, an intensity outside its series, numbers of another unit than the same person's
    others, a trial that is there twice, a part that was pasted twice, a person without a name or
    with two ways to write it, and two people with the same answers.
    """
    for line, row in itertools.chain(*people.values()):
        time = _value_of(row, "response_time_s")
        if time < 0 or math.isinf(time):
            raise _refused(path, line, "response_time_s", f"{time:g} s is no response time")
        if design.compares:
            _require_pair(path, line, design, row)
    for who, mine in people.items():
        _require_seconds(path, who, mine)
        _require_once(path, who, mine)
        _require_one_scale(path, design, who, mine)
        _require_own_name(path, who, mine[0][0], known)
        _require_own_answers(path, who, mine, known)


def _require_own_name(path: str | Path, who: str, line: int, known: dict[Answered, str]) -> None:
    """Refuse somebody without a name, or with one that is another's but for its writing."""
    seen = unicodedata.normalize("NFKC", who).casefold()
    seen = "".join(sign for sign in seen if sign.isprintable() and not sign.isspace())
    seen = re.sub(r"(?<!\d)0+(?=\d)", "", re.sub(r"\.0+$", "", seen))
    other = known.setdefault((("name", seen),), who)
    if not seen or other != who:
        said = f"'{who}' and '{other}' are written alike; give one person one name"
        raise _refused(path, line, "participant_id", said if seen else "says nobody; write who")


def _require_own_answers(
    path: str | Path, who: str, mine: Numbered, known: dict[Answered, str]
) -> None:
    """Refuse answers that are in another file or another's: twelve rows running.

    Times or numbers tell: where most are the same, as those in whole seconds, nothing is said.
    """
    rows = [tuple(str(row[name]) for name in _TIMED) for _, row in mine]
    told = [(str(row["response_time_s"]), str(row["estimate"])) for _, row in mine]
    for at in range(len(rows) - _FEWEST + 1):
        part = tuple(rows[at : at + _FEWEST])
        if part in known and len(set(told[at : at + _FEWEST])) > _FEWEST // 2:
            said = (
                f"'{who}' has the same answers and times as '{known[part]}', row by row; keep one"
            )
            raise _refused(path, mine[at][0], "participant_id", said)
    for at in range(len(rows) - _FEWEST + 1):
        known[tuple(rows[at : at + _FEWEST])] = who


def _require_pair(
    path: str | Path, line: int, design: StudyDesign, row: Mapping[str, Cell]
) -> None:
    shown = [str(row[key]) for key in SURFACES[: design.described.surfaces]]
    alike = design.task == "same-different" and len(set(shown)) == 1
    if design.described.ranks:
        if len(set(shown)) < len(shown):
            said = f"{' / '.join(shown)} has a surface twice, which is compared with itself"
            raise _refused(path, line, "second_stimulus", said)
        return
    if (design.reference not in shown and not alike) or not all(shown):
        said = f"{' / '.join(shown)} has no reference ('{design.reference}') to be compared with"
        raise _refused(path, line, "second_stimulus", said)
    if row["adaptive_series"]:
        series = design.series(str(row["adaptive_series"]))
        part = _value_of(row, "intensity")
        least = 0.0 if series.in_runs else series.lowest / 2
        if part > 2 * series.highest or 0 < part < least:
            raise _refused(
                path,
                line,
                "intensity",
                f"{part:g} is outside the series '{series.name}' ({series.lowest:g} to "
                f"{series.highest:g}, in parts of the reference: 0.2 is 20 %)",
            )


def _require_seconds(path: str | Path, who: str, mine: Numbered) -> None:
    timed = [(line, time) for line, row in mine if (time := _value_of(row, "response_time_s")) > 0]
    times = [time for _, time in timed]
    if not times:
        return
    usual = median(times)
    for line, time in timed:
        if usual > LONGEST_USUAL or time > max(LONGEST_USUAL, _FACTOR * usual):
            said = (
                f"'{who}' takes {usual:g} s in the median and {time:g} s here; if these are "
                'milliseconds, say so by columns = "response_time_ms=COLUMN"'
            )
            raise _refused(path, line, "response_time_s", said)
    if len(times) >= _FEWEST and all(then > now for now, then in itertools.pairwise(times)):
        said = f"'{who}' takes longer in every row: are these moments in place of durations?"
        raise _refused(path, timed[0][0], "response_time_s", said)


def _require_once(path: str | Path, who: str, mine: Numbered) -> None:
    first: dict[tuple[str, ...], int] = {}
    again = []
    trials: dict[tuple[str, str], int] = {}
    for line, row in mine:
        place = str(row["display"]), str(row["trial"])
        if place in trials and not row["set_aside"]:
            said = f"trial {place[1]} of '{who}' is in line {trials[place]} already"
            raise _refused(path, line, "trial", said)
        trials[place] = line
        if _value_of(row, "response_time_s") > 0:
            cells = tuple(str(row[name]) for name in _TIMED)
            again += [(first[cells], line)] if cells in first else []
            first.setdefault(cells, line)
    keys = [tuple(str(row[name]) for name in _ANSWERED) for _, row in mine]
    half = len(mine) // 2
    pasted = half >= _FEWEST and keys[:half] == keys[half:] and mine[0][0] != mine[half][0]
    if pasted and len(set(keys)) > 1 and not first:
        again = [(mine[0][0], mine[half][0])] * half
    if len(again) >= max(3, 0.1 * len(mine)):
        raise _refused(
            path,
            again[0][1],
            "participant_id",
            f"'{who}' has {len(again)} rows twice, this one in line {again[0][0]} already; was a "
            "part pasted again?",
        )


def _require_one_scale(path: str | Path, design: StudyDesign, who: str, mine: Numbered) -> None:
    """Refuse a number far from the others to its surface, and numbers to a surface that are far
    from the person's power law (through the median of all slopes between two surfaces)."""
    of_surface: dict[str, list[tuple[int, float]]] = defaultdict(list)
    for line, row in mine:
        if (number := _value_of(row, "estimate")) > 0:
            of_surface[str(row["stimulus"])].append((line, math.log(number)))
    if sum(map(len, of_surface.values())) < _FEWEST:
        return
    middles = {name: median(log for _, log in here) for name, here in of_surface.items()}
    for name, here in of_surface.items():
        for line, log in here:
            if len(here) > 2 and abs(log - middles[name]) > _OFF_SCALE:
                ratio = math.exp(log - middles[name])
                said = f"'{who}' gave '{name}' {ratio:.3g} times the usual; is a unit another?"
                raise _refused(path, line, "estimate", said)
    levels = {name: design.level(design.stimulus(name)) for name in middles}
    slopes = [
        (middles[one] - middles[other]) / (levels[one] - levels[other])
        for one, other in itertools.combinations(middles, 2)
        if levels[one] != levels[other]
    ]
    if len(middles) < _FEWEST_SURFACES or not slopes:
        return
    exponent = median(slopes)
    off = {name: middles[name] - exponent * levels[name] for name in middles}
    usual = median(off.values())
    for name, here in of_surface.items():
        if abs(off[name] - usual) > _OFF_SCALE:
            said = (
                f"'{who}' gave '{name}' {math.exp(off[name] - usual):.3g} times what the other "
                "surfaces say; is a unit another?"
            )
            raise _refused(path, here[0][0], "estimate", said)


def _value_of(row: Mapping[str, Cell], key: str) -> float:
    return float(str(row[key]))


def _refused(path: str | Path, line: int, key: str, said: str) -> ConfigError:
    return ConfigError(said, file=path, line=line, key=key)
