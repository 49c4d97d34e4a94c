"""Sittings: a participant at a station, from the experimenter's preparation to the last answer.

Sittings are kept in one file beside the studies, so that a participant's page finds its own again
after the lab was killed. They hold no name, only the pseudonym of the study's file. Several
programs may use the file: each change is read, made and written under a lock, and what could not
be written has not happened.
"""

from __future__ import annotations

import contextlib
import dataclasses
import json
import os
import re
import secrets
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, RecordError
from squeezefilm.core.hard_limits import OWN_BYTES
from squeezefilm.core.regular_file import read_json
from squeezefilm.core.results import write_whole
from squeezefilm.study.record.erasure import erase_file, overwrite, plain_file, require_plain

try:
    import fcntl
except ImportError:
    # Windows has no such locks: two labs on one folder are not kept apart there.
    _LOCKS = False
else:
    _LOCKS = True

MOST_SITTINGS = 500
FILE = ".sittings.json"
_PATIENCE: si.Second = 5.0
"""Longest wait of a change for another program's."""


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
        self._all()

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
        return _of(self._all(), id)

    def is_open(self, id: str) -> bool:
        """True where there is such a sitting and it has not ended."""
        sitting = self._all().get(id)
        return sitting is not None and not sitting.ended

    def of_study(self, study: str) -> list[Sitting]:
        """The sittings of a study that have not ended."""
        return [one for one in self._all().values() if one.study == study and not one.ended]

    def require_erasable(self) -> None:
        """Refuse what `forget` could not erase. Raises `InputError`."""
        for path in (*self._files(), *self._half_written()):
            require_plain(path)

    def forget(self, participant: str) -> int:
        """Take a participant's sittings out, and overwrite the file they were in. How many.

        Raises:
            InputError: the file is a link, or cannot be written.
            RecordError: the disk refused.
        """
        gone: list[str] = []
        if not self._files():
            return 0
        with contextlib.ExitStack() as closing:
            with self._changing() as kept:
                # The old file stays open, and is overwritten once the new one is in its place.
                # Not so on Windows, which replaces no file that is open.
                files = self._files() if os.name != "nt" else []
                old = [closing.enter_context(plain_file(path, os.O_RDWR)) for path in files]
                gone = [key for key, one in kept.items() if one.participant == participant]
                for key in gone:
                    del kept[key]
            for handle in old:
                overwrite(handle, self.file)
        for path in self._half_written():
            erase_file(path)
        return len(gone)

    def _files(self) -> list[Path]:
        return [self.file] if os.path.lexists(self.file) else []

    def _half_written(self) -> list[Path]:
        """Files left of writes that were killed."""
        if not self.file.parent.is_dir():
            return []
        name = re.compile(rf"\.{re.escape(self.file.name)}\.[a-z0-9_]+")
        return sorted(file for file in self.file.parent.iterdir() if name.fullmatch(file.name))

    def _all(self) -> dict[str, Sitting]:
        """Contents of the file now."""
        try:
            self.file.lstat()
        except FileNotFoundError:
            return {}
        except OSError as error:
            raise InputError(
                f"{self.file} cannot be read: {error.strerror}; move it away"
            ) from error
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
        with _locked(self.file.parent):
            kept = self._all()
            yield kept
            rows = [dataclasses.asdict(sitting) for sitting in kept.values()]
            write_whole(self.file, json.dumps(rows, ensure_ascii=False, indent=1))


def _of(kept: Mapping[str, Sitting], id: str) -> Sitting:
    sitting = kept.get(id)
    if sitting is None:
        raise InputError("this sitting is not known; ask the experimenter to prepare it again")
    return sitting


@contextlib.contextmanager
def _locked(folder: Path) -> Iterator[None]:
    """The folder's lock; Windows has none here, and takes one lab on a folder only.

    Raises `RecordError` where another program keeps it.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if not _LOCKS:
            yield
            return
        handle = os.open(folder, os.O_RDONLY)
    except OSError as error:
        raise RecordError(f"sittings cannot be kept in {folder}: {error.strerror}") from error
    try:
        until = time.monotonic() + _PATIENCE
        while not _taken(handle):
            if time.monotonic() > until:
                raise RecordError(
                    f"another program has kept the sittings in {folder} locked for {_PATIENCE:g} "
                    "s; end it, then try again"
                )
            time.sleep(0.005)
        yield
    finally:
        # Closing gives the lock back.
        os.close(handle)


def _taken(handle: int) -> bool:
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
