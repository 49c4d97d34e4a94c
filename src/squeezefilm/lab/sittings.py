"""Sittings: a participant at a station, from the experimenter's preparation to the last answer.

A sitting is kept in a file of the lab's folder, so that a participant's page finds it again after
the server was killed. It holds no name, only the pseudonym of the study's file.
"""

from __future__ import annotations

import dataclasses
import json
import secrets
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from squeezefilm.errors import InputError
from squeezefilm.results import write_whole

MOST_SITTINGS = 500


@dataclass(frozen=True)
class Sitting:
    """One sitting: which study's file, who, with what; `session` once it was consented to."""

    id: str
    study: str
    participant: str
    device: str
    consent_text: str
    conditions: dict[str, Any] = field(default_factory=dict)
    acknowledged: bool = False
    session: str | None = None
    ended: bool = False


class Sittings:
    """All sittings of a lab's folder. Not thread-safe: the study's thread owns it."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self._all: dict[str, Sitting] = {}
        if file.exists():
            try:
                rows = json.loads(file.read_text(encoding="utf-8"))
                self._all = {row["id"]: Sitting(**row) for row in rows}
            except (ValueError, TypeError, KeyError) as error:
                raise InputError(
                    f"{file} is damaged ({error}); move it away: no answer is lost, they are in "
                    "the study's own file"
                ) from error

    def new(self, **fields: Any) -> Sitting:
        """A sitting with a fresh id."""
        while len(self._all) >= MOST_SITTINGS:
            self._all.pop(next(iter(self._all)))
        return self.keep(Sitting(secrets.token_urlsafe(12), **fields))

    def change(self, id: str, **fields: Any) -> Sitting:
        """The sitting with other values, kept."""
        return self.keep(dataclasses.replace(self.get(id), **fields))

    def keep(self, one: Sitting) -> Sitting:
        """Write a sitting down."""
        self._all[one.id] = one
        self._write()
        return one

    def get(self, id: str) -> Sitting:
        """The sitting of an id. Raises `InputError` if there is none."""
        found = self._all.get(id)
        if found is None:
            raise InputError("this sitting is not known; ask the experimenter to prepare it again")
        return found

    def is_open(self, id: str) -> bool:
        """Whether there is such a sitting and it has not ended."""
        return id in self._all and not self._all[id].ended

    def of_study(self, study: str) -> list[Sitting]:
        """The sittings of a study that have not ended."""
        return [one for one in self._all.values() if one.study == study and not one.ended]

    def forget_participant(self, study: str, participant: str) -> None:
        """Take a participant's sittings out of memory and file."""
        self._all = {
            key: one
            for key, one in self._all.items()
            if (one.study, one.participant) != (study, participant)
        }
        self._write()

    def _write(self) -> None:
        self.file.parent.mkdir(parents=True, exist_ok=True)
        rows = [dataclasses.asdict(one) for one in self._all.values()]
        write_whole(self.file, json.dumps(rows, ensure_ascii=False, indent=1))
