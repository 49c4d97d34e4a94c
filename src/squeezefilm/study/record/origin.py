"""Whose answers a study's file holds: people's, simulated ones, both, or none."""

from __future__ import annotations

import json

from squeezefilm.study.record.store import StudyStore

SIMULATED = "simulated participants"
SIMULATED_NOTE = "simulated participant"
"""The note of a session that no person sat in."""


def origin_of(store: StudyStore) -> str:
    """What to label results with: people, simulated, both mixed, or nobody."""
    notes = [json.loads(row["conditions"]) for row in store.rows("SELECT conditions FROM session")]
    simulated = [one.get("note") == SIMULATED_NOTE for one in notes]
    if not simulated:
        return "nobody"
    if all(simulated):
        return SIMULATED
    return "people and simulated participants, mixed" if any(simulated) else "people"
