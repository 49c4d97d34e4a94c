"""Sittings: a participant at a station, from the experimenter's preparation to the last answer.

Sittings are kept in one file beside the studies, so that a participant's page finds its own again
after the lab was killed. They hold no name, only the pseudonym of the study's file. What could not
be written has not happened.
"""

from __future__ import annotations

import contextlib
import dataclasses
import json
import os
import secrets
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import OWN_BYTES
from squeezefilm.core.regular_file import read_json
from squeezefilm.core.results import write_whole

MOST_SITTINGS = 500
FILE = ".sittings.json"


@dataclass(frozen=True)
class Sitting:
    """A sitting: which study's file, who, with what; `session` once it was consented to."""

    id: str
    study: str
    participant: str
    device: str
    consent_text: str
    conditions: dict[str, Any] = field(default_factory=dict)
    acknowledged: bool = False
    session: str | None = None
    ended: bool = False

    def __post_init__(self) -> None:
        texts = (self.id, self.study, self.participant, self.device, self.consent_text)
        if (
            not all(isinstance(text, str) for text in (*texts, self.session or ""))
            or not isinstance(self.conditions, dict)
            or not all(isinstance(flag, bool) for flag in (self.acknowledged, self.ended))
        ):
            raise InputError(f"'{self.id!r:.40}' is no sitting: a value is of another type")


class Sittings:
    """All sittings of a folder of studies. Not thread-safe: the lab's study thread owns it.

    Raises `InputError` for a file that is damaged.
    """

    def __init__(self, file: Path) -> None:
        self.file = file
        self._read()

    def new(self, **fields: Any) -> Sitting:
        """A sitting with a fresh id; those that the participant still had open are ended."""
        made = Sitting(secrets.token_urlsafe(12), **fields)
        with self._changing() as kept:
            for sitting in kept.values():
                if (sitting.study, sitting.participant) == (made.study, made.participant):
                    kept[sitting.id] = dataclasses.replace(sitting, ended=True)
            while len(kept) >= MOST_SITTINGS:
                ended = (key for key, one in kept.items() if one.ended)
                kept.pop(next(ended, None) or next(iter(kept)))
            kept[made.id] = made
        return made

    def change(self, id: str, **fields: Any) -> Sitting:
        """The sitting with other values, kept."""
        with self._changing() as kept:
            changed = kept[id] = dataclasses.replace(_of(kept, id), **fields)
        return changed

    def get(self, id: str) -> Sitting:
        """The sitting of an id. Raises `InputError` if there is none."""
        return _of(self._read(), id)

    def is_open(self, id: str) -> bool:
        """True where there is such a sitting and it has not ended."""
        sitting = self._read().get(id)
        return sitting is not None and not sitting.ended

    def of_study(self, study: str) -> list[Sitting]:
        """The sittings of a study that have not ended."""
        return [one for one in self._read().values() if one.study == study and not one.ended]

    def forget(self, participant: str) -> int:
        """Take a participant's sittings out. How many. Raises `RecordError` if the disk refused."""
        gone = [key for key, one in self._read().items() if one.participant == participant]
        if gone:
            with self._changing() as kept:
                for key in gone:
                    del kept[key]
        return len(gone)

    def _read(self) -> dict[str, Sitting]:
        if not os.path.lexists(self.file):
            return {}
        try:
            rows = read_json(self.file, OWN_BYTES, "a file of sittings")
            return {row["id"]: Sitting(**row) for row in rows}
        except (ValueError, TypeError, KeyError) as error:
            raise InputError(
                f"{self.file} is damaged ({error!r:.200}); move it away: no answer is lost, they "
                "are in the study's own file"
            ) from error

    @contextlib.contextmanager
    def _changing(self) -> Iterator[dict[str, Sitting]]:
        """The sittings to be changed; what they are then is written, or nothing has changed."""
        kept = self._read()
        yield kept
        rows = [dataclasses.asdict(sitting) for sitting in kept.values()]
        write_whole(self.file, json.dumps(rows, ensure_ascii=False, indent=1))


def _of(kept: Mapping[str, Sitting], id: str) -> Sitting:
    sitting = kept.get(id)
    if sitting is None:
        raise InputError("this sitting is not known; ask the experimenter to prepare it again")
    return sitting
