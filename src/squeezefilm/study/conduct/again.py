"""Trials that come again: spoiled ones, a block that was left for too long, more practice.

Nothing is changed or removed. A trial that is to be asked again is *set aside* with its answer, and
a copy of it is planned with a number after all others; trials come block by block, in the order of
their numbers, so that the copy comes at the end of its block.
"""

from __future__ import annotations

import sqlite3
import uuid
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from typing import Any

from squeezefilm.core.progress import about
from squeezefilm.study.conduct.study_device import TrialMotion
from squeezefilm.study.design.rules import TrialRules
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.record.store import Row, StudyStore, insert, utc_now

COUNTED = "NOT EXISTS (SELECT 1 FROM set_aside a WHERE a.trial = t.uuid)"
"""True of a trial `t` that was not set aside."""


def spoiled_by(design: StudyDesign, explorations: Iterable[TrialMotion]) -> str:
    """Reason why the exploration of an answer does not count: a surface that was not played as
    planned, or one of the design's rules that is broken; empty where it counts, and where nothing
    was recorded of it."""
    rules = design.rules or TrialRules()
    for exploration in explorations:
        if exploration.unusable:
            return f"the surface was not played as planned: {exploration.unusable}"
        broken = rules.broken(
            exploration.path_length,
            exploration.mean_speed,
            exploration.mean_normal_force,
            exploration.touch,
        )
        if broken:
            return broken
    return ""


def set_aside(write: sqlite3.Connection, trials: Sequence[Row], session: str, reason: str) -> None:
    """Set trials aside and plan each again, in a transaction that is open."""
    for planned, again in zip(trials, _copied(write, trials), strict=True):
        row = {
            "trial": planned["uuid"],
            "session": session,
            "reason": reason,
            "again": again,
            "made_utc": utc_now(),
        }
        insert(write, "set_aside", row)


def _copied(write: sqlite3.Connection, trials: Sequence[Row]) -> list[str]:
    """Copies of trials with new identifiers, numbered after all others of their participant."""
    if not trials:
        return []
    who = trials[0]["participant"]
    query = "SELECT max(number) FROM trial WHERE participant = ?"
    [last] = write.execute(query, [who]).fetchone()
    columns = [row[1] for row in write.execute("PRAGMA table_info(trial)")]
    copies = []
    for count, planned in enumerate(trials):
        row: dict[str, Any] = {name: planned[name] for name in columns}
        row |= {"uuid": str(uuid.uuid4()), "number": last + count + 1}
        # The rest was before the first of the block; a copy has it only where it begins again.
        row["pause_s"] = planned["pause_s"] if count == 0 and len(trials) > 1 else 0.0
        insert(write, "trial", row)
        copies.append(row["uuid"])
    return copies


def practise_again(store: StudyStore, write: sqlite3.Connection, who: str, display: str) -> str:
    """Plan another round of practice where the last one was below the criterion. Returns what to
    say, an empty text where there is nothing. In a transaction that is open.

    A round that was not reached after `practice_rounds` is said, and the study goes on.
    """
    design = store.design
    if not design.practice_criterion:
        return ""
    # Columns of the trial alone, and whether the answer was right.
    rows = store.rows(
        "SELECT t.*, r.correct FROM trial t LEFT JOIN response r ON r.trial = t.uuid "
        f"WHERE t.participant = ? AND t.display = ? AND t.phase = 'practice' AND {COUNTED} "
        "ORDER BY t.number",
        [who, display],
    )
    if any(row["correct"] is None for row in rows):
        return ""
    last = rows[-design.practice :]
    share = sum(row["correct"] for row in last) / len(last)
    rounds = len(rows) // design.practice
    wanted = f"{100 * share:.0f} % of the practice was right; {100 * design.practice_criterion:g} %"
    if share >= design.practice_criterion:
        return ""
    if rounds >= design.practice_rounds:
        return f"{wanted} are wanted, and were not reached in {rounds} rounds; the study goes on"
    _copied(write, last)
    return f"{wanted} are wanted: practice again, round {rounds + 1} of {design.practice_rounds}"


def restart_block(store: StudyStore, who: str, session: str, row: Row) -> None:
    """Begin a block again that was left for longer than the design allows.

    `row` is the participant's next trial. All of the block's trials are set aside, answers and
    all, and planned again in their order.
    """
    limit = store.design.resume_within
    if not limit or not row["block"]:
        return
    block = store.rows(
        "SELECT t.*, r.ended_utc FROM trial t LEFT JOIN response r ON r.trial = t.uuid "
        f"WHERE t.participant = ? AND t.display = ? AND t.block = ? AND {COUNTED} "
        "ORDER BY t.number",
        [who, row["display"], row["block"]],
    )
    ended = [one["ended_utc"] for one in block if one["ended_utc"] is not None]
    if not ended:
        return
    last = max(datetime.fromisoformat(time) for time in ended)
    gone = (datetime.now(UTC) - last).total_seconds()
    if gone <= limit:
        return
    allowed = about(limit).removeprefix("about ")
    reason = f"the block was left for {about(gone)}, and may be for {allowed}; it begins again"
    with store.transaction() as write:
        set_aside(write, block, session, reason)


def why_begun_again(store: StudyStore, session: str) -> str:
    """Reason why a session began with a block of before, for the experimenter; empty without."""
    rows = store.rows(
        "SELECT a.reason, count(r.trial) AS answers FROM set_aside a LEFT JOIN response r "
        "ON r.trial = a.trial WHERE a.session = ? GROUP BY a.reason",
        [session],
    )
    return "; ".join(f"{row['reason']}: {row['answers']} answers are set aside" for row in rows)
