"""Keys to the lab: one-time links, sessions with a role, pairing codes.

A link works once and is exchanged for a cookie that no script can read. Keys belong to one run of
the lab; they outlive it only when it is killed, so that a page that was open can go on after a
restart. Secrets are compared in constant time.
"""

from __future__ import annotations

import contextlib
import json
import os
import secrets
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Literal

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import OWN_BYTES
from squeezefilm.core.regular_file import read_json
from squeezefilm.lab.files import write_secret

Role = Literal["experimenter", "participant"]

LINK_LIFE: si.Second = 600.0
SESSION_LIFE: si.Second = 12 * 3600.0
CODE_LIFE: si.Second = 120.0
MOST_SESSIONS = 64
MOST_WRONG_CODES = 5
"""Wrong codes after which pairing is closed until the experimenter opens it again."""


@dataclass(frozen=True, slots=True)
class Session:
    """A browser that was let in: its secret, its role, its station's name, until when (UTC s)."""

    secret: str
    role: Role
    station: str
    until: si.Second


@dataclass(frozen=True, slots=True)
class _Link:
    role: Role
    station: str
    home: str
    until: si.Second


@dataclass(slots=True)
class Keys:
    """All links, sessions and codes of one lab. Not thread-safe: the server's loop owns it.

    `file` keeps sessions over a crash, readable by its owner only, as long as there is room for
    it; `clock` gives UTC in seconds.
    """

    file: Path | None = None
    clock: Callable[[], float] = time.time
    _links: dict[str, _Link] = field(default_factory=dict)
    _sessions: dict[str, Session] = field(default_factory=dict)
    _code: tuple[str, str, float] | None = None
    _wrong: int = 0
    _stations: int = 0

    def __post_init__(self) -> None:
        if self.file is None or not os.path.lexists(self.file):
            return
        try:
            rows = read_json(self.file, OWN_BYTES, "the lab's keys")
            kept = [Session(**row) for row in rows]
            self._sessions = {key.secret: key for key in kept if key.until > self.clock()}
        except (ValueError, TypeError) as error:
            raise InputError(
                f"{self.file} is not readable as the lab's keys ({error}); delete it and open the "
                "new link that the lab prints"
            ) from error
        self._stations = len(self._sessions)

    def new_link(self, role: Role = "experimenter", home: str | None = None) -> str:
        """A token that lets one browser in, once, within ten minutes; it begins at `home`."""
        token = secrets.token_urlsafe(32)
        self._stations += 1
        station = f"station {self._stations}"
        home = home or ("/participant" if role == "participant" else "/")
        self._links[token] = _Link(role, station, home, self.clock() + LINK_LIFE)
        return token

    def use_link(self, token: str) -> tuple[Session, str] | None:
        """The session that a link opens, and where it begins; None for one that is unknown, used
        or too old."""
        link = self._links.pop(token, None)
        if link is None or link.until < self.clock():
            return None
        return self._open(link.role, link.station), link.home

    def new_code(self, home: str = "/participant") -> str:
        """Six digits that pair one tablet as a participant station, once, within two minutes; it
        begins at `home`. A code that was not used yet is dropped."""
        self._code = (f"{secrets.randbelow(10**6):06d}", home, self.clock() + CODE_LIFE)
        self._wrong = 0
        return self._code[0]

    def use_code(self, code: str) -> tuple[Session, str] | None:
        """The participant's session that a pairing code opens, and where it begins; None where
        the code is wrong or over.

        After five wrong ones the code is dropped: six digits cannot be guessed in five tries.
        """
        if self._code is None or self._code[2] < self.clock():
            return None
        if not secrets.compare_digest(self._code[0].encode(), code.encode()):
            self._wrong += 1
            if self._wrong >= MOST_WRONG_CODES:
                self._code = None
            return None
        home = self._code[1]
        self._code = None
        self._stations += 1
        return self._open("participant", f"station {self._stations}"), home

    def session(self, secret: str | None) -> Session | None:
        """The session of a cookie's value; None where there is none or it is over."""
        if not secret:
            return None
        for known, session in self._sessions.items():
            if secrets.compare_digest(known.encode(), secret.encode()):
                return session if session.until > self.clock() else None
        return None

    def forget(self) -> None:
        """End every session and delete the file: a clean exit leaves no key."""
        self._links.clear()
        self._sessions.clear()
        if self.file is not None:
            self.file.unlink(missing_ok=True)

    def _open(self, role: Role, station: str) -> Session:
        now = self.clock()
        self._sessions = {k: s for k, s in self._sessions.items() if s.until > now}
        while len(self._sessions) >= MOST_SESSIONS:
            self._sessions.pop(next(iter(self._sessions)))
        session = Session(secrets.token_urlsafe(32), role, station, now + SESSION_LIFE)
        self._sessions[session.secret] = session
        if self.file is not None:
            text = json.dumps([asdict(known) for known in self._sessions.values()])
            # The file only lets pages go on after a crash: on a full disk nobody is turned away.
            with contextlib.suppress(OSError):
                write_secret(self.file, text.encode())
        return session
