"""Rows of a file with answers that cannot be what they say, refused by their line."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median

from squeezefilm.core.errors import ConfigError
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.record.tables import SURFACES, Cell

Numbered = Sequence[tuple[int, Mapping[str, Cell]]]
"""Rows with their line in the file."""
LONGEST_USUAL = 100.0
"""Median response time of somebody (s) above which it is held to be in milliseconds."""
_FACTOR = 300.0
_TIMED = ("display", "phase", *SURFACES, "choice", "estimate", "response_time_s")


def require_plausible_rows(
    path: str | Path,
    design: StudyDesign,
    rows: Numbered,
    known: dict[str, str],
) -> None:
    """Refuse rows that cannot be what they say, with their line.

    `known` has the names of people in other files, and takes up those of this one.

    Raises `ConfigError` for times below 0 or in milliseconds, a pair without the reference, an
    intensity outside its series, a trial that is there twice, rows that were pasted twice, and a
    person without a name or with two ways to write it.
    """
    people: dict[str, list[tuple[int, Mapping[str, Cell]]]] = defaultdict(list)
    for line, row in rows:
        people[str(row["participant_id"])].append((line, row))
        time = _value_of(row, "response_time_s")
        if time < 0 or math.isinf(time):
            raise _refused(path, line, "response_time_s", f"{time:g} s is no response time")
        if design.compares:
            _require_pair(path, line, design, row)
    for who, mine in people.items():
        _require_seconds(path, who, mine)
        _require_once(path, who, mine)
        _require_own_name(path, who, mine[0][0], known)


def _require_own_name(path: str | Path, who: str, line: int, known: dict[str, str]) -> None:
    """Refuse somebody without a name, or with one that is another's but for its writing."""
    seen = "".join(who.casefold().split())
    other = known.setdefault(seen, who)
    if not seen or other != who:
        said = f"'{who}' and '{other}' are written alike; give one person one name"
        raise _refused(path, line, "participant_id", said if seen else "says nobody; write who")


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


def _require_once(path: str | Path, who: str, mine: Numbered) -> None:
    first: dict[tuple[str, ...], int] = {}
    again = []
    trials: dict[tuple[str, str], tuple[int, int]] = {}
    for line, row in mine:
        place = str(row["display"]), str(row["trial"])
        if place in trials and not row["set_aside"]:
            said = f"trial {place[1]} of '{who}' is in line {trials[place][0]} already"
            raise _refused(path, line, "trial", said)
        trials[place] = line, line
        if _value_of(row, "response_time_s") > 0:
            cells = tuple(str(row[name]) for name in _TIMED)
            again += [(first[cells], line)] if cells in first else []
            first.setdefault(cells, line)
    if len(again) >= max(3, 0.1 * len(mine)):
        raise _refused(
            path,
            again[0][1],
            "participant_id",
            f"'{who}' has {len(again)} rows twice, this one in line {again[0][0]} already; was a "
            "part pasted again?",
        )


def _value_of(row: Mapping[str, Cell], key: str) -> float:
    return float(str(row[key]))


def _refused(path: str | Path, line: int, key: str, said: str) -> ConfigError:
    return ConfigError(said, file=path, line=line, key=key)
