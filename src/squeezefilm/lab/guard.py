"""Guard before every request: the keys that let a browser in; its host, origin, session and size,
and the headers that go back.

A page that only this computer may use is still reachable by any website that this computer's
browser shows. The Host check stops DNS rebinding, the Origin check foreign pages and cross-site
requests, the cookie everybody else. On the address for tablets an experimenter's cookie opens
nothing: whoever listens there can at most be a participant.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import secrets
import time
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Literal

from starlette.datastructures import Headers, MutableHeaders, QueryParams
from starlette.requests import cookie_parser
from starlette.responses import PlainTextResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import OWN_BYTES
from squeezefilm.core.regular_file import read_json
from squeezefilm.lab.files import write_secret

# Keys: one-time links, sessions with a role, pairing codes. A link works once and is exchanged for
# a cookie that no script can read. Keys belong to one run of the lab; they outlive it only when it
# is killed, so that a page that was open can go on after a restart. Secrets are compared in
# constant time.
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


LARGEST_BODY = 8 * 1024 * 1024
"""Bytes of a request; an image for a texture is the largest thing a page sends."""

SLOWEST_BODY = 10.0
"""Seconds for a request's body, each part of it."""

POLICY = (
    "default-src 'self'; img-src 'self' data: blob:; object-src 'none'; base-uri 'none'; "
    "form-action 'self'; frame-ancestors 'none'"
)

HEADERS: Mapping[str, str] = {
    "content-security-policy": POLICY,
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "permissions-policy": "camera=(), geolocation=(), microphone=(), payment=(), usb=()",
    "cache-control": "no-store",
}

# What a participant's browser may reach; everything else is the experimenter's.
_PARTICIPANT = ("/participant", "/static/", "/pair", "/ws/participant", "/favicon.ico")
# What a tablet needs to type a pairing code, before it has a session; nothing secret is in them.
_PAIRING = ("/pair", "/static/pair.js", "/static/lab.css", "/static/icon.svg")
_SAFE = {"GET", "HEAD"}
_TOO_LARGE = f"A request of more than {LARGEST_BODY} bytes; send less."
_UNPAIRED = (
    "This tablet is not paired, or not any more: open /pair here and type the six digits that the "
    "experimenter's page shows."
)
_WITHOUT_LINK = (
    "This page needs the link that squeezefilm lab printed when it started; each link works once, "
    "for one browser. For another station, ask for a link on the Study page; to come back after "
    "the lab was ended, start it again."
)

CONNECTION = "connection"
"""The name in a scope's state of the `door.Connection` by which a request came."""


@dataclass(frozen=True, slots=True)
class Places:
    """Places at which the lab is served: the hosts it answers to, and whether it is reached by TLS.

    `hosts` are values of the Host header with their port, as a browser sends them. With
    `participants_only` no link and no experimenter's session is good here: a station comes in by
    a pairing code.
    """

    hosts: frozenset[str]
    secure: bool = False
    participants_only: bool = False
    cookie: str = "squeezefilm"

    @property
    def origins(self) -> frozenset[str]:
        """Values of the Origin header that the lab's own pages send."""
        scheme = "https" if self.secure else "http"
        return frozenset(f"{scheme}://{host}" for host in self.hosts)


class _TooLargeError(Exception):
    pass


class _TooSlowError(Exception):
    pass


class Guard:
    """The application before the application; it leaves the session in ``scope["lab_session"]``."""

    def __init__(self, app: ASGIApp, keys: Keys, places: Places) -> None:
        self.app = app
        self.keys = keys
        self.places = places
        # How many requests were refused, by reason.
        self.refusals: Counter[str] = Counter()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer or refuse one request or websocket."""
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return None
        headers = Headers(scope=scope)

        async def refuse(reason: str, status: int, text: str) -> None:
            self.refusals[reason] += 1
            await self._answer(PlainTextResponse(text, status), scope, receive, send)

        refused = self._refused(scope, headers)
        if refused is not None:
            return await refuse(*refused)
        entered = self._entering(scope, headers)
        if entered is not None:
            return await self._answer(entered, scope, receive, send)
        session = self._session(headers)
        path = str(scope["path"])
        if session is None and not (self.places.participants_only and path in _PAIRING):
            return await refuse(
                "session", 401, _UNPAIRED if self.places.participants_only else _WITHOUT_LINK
            )
        if (
            session is not None
            and session.role == "participant"
            and not path.startswith(_PARTICIPANT)
        ):
            text = "This station is paired for participants; that page is the experimenter's."
            return await refuse("role", 403, text)
        scope["lab_session"] = session
        connection = scope.get("state", {}).get(CONNECTION)
        if connection is not None and session is not None:
            connection.is_stranger = False
        try:
            await self.app(scope, _bounded(receive), self._with_headers(send))
        except _TooLargeError:
            await refuse("size", 413, _TOO_LARGE)
        except _TooSlowError:
            text = f"The request was not whole within {SLOWEST_BODY:g} s; send it again."
            await refuse("slow", 408, text)

    def set_cookie(self, response: Response, session: Session) -> None:
        """Give a browser its session."""
        response.set_cookie(
            self.places.cookie,
            session.secret,
            httponly=True,
            samesite="strict",
            secure=self.places.secure,
            path="/",
        )

    def _refused(self, scope: Scope, headers: Headers) -> tuple[str, int, str] | None:
        hosts = headers.getlist("host")
        if len(hosts) != 1 or hosts[0].lower() not in self.places.hosts:
            return "host", 421, "This server answers only to the address it printed."
        origins = headers.getlist("origin")
        known = all(origin.lower() in self.places.origins for origin in origins)
        if not known or len(origins) > 1:
            return "origin", 403, "A page from elsewhere asked for this; that is refused."
        must_say = scope["type"] == "websocket" or scope["method"] not in _SAFE
        if must_say and not origins:
            return "origin", 403, "A request that changes something must come from the lab's page."
        site = headers.get("sec-fetch-site", "none")
        navigating = headers.get("sec-fetch-mode") == "navigate" and scope.get("method") == "GET"
        if site not in ("same-origin", "none") and not navigating:
            return "site", 403, "A page from elsewhere asked for this; that is refused."
        length = headers.get("content-length", "0")
        if not length.isdigit() or int(length) > LARGEST_BODY:
            return "size", 413, _TOO_LARGE
        return None

    def _session(self, headers: Headers) -> Session | None:
        session = self.keys.session(
            cookie_parser(headers.get("cookie", "")).get(self.places.cookie)
        )
        if session is not None and self.places.participants_only and session.role != "participant":
            self.refusals["role"] += 1
            return None
        return session

    def _entering(self, scope: Scope, headers: Headers) -> Response | None:
        if scope["type"] != "http" or scope["path"] != "/" or scope["method"] != "GET":
            return None
        if self.places.participants_only:
            return RedirectResponse("/pair", 303)
        token = QueryParams(scope["query_string"]).get("token")
        if not token:
            return None
        entered = self.keys.use_link(token)
        if entered is None:
            self.refusals["link"] += 1
            return PlainTextResponse(
                "This link was used already, or is older than ten minutes. Each link lets one "
                "browser in, once.",
                401,
            )
        session, home = entered
        response = RedirectResponse(home, 303)
        known = self._session(headers)
        # An experimenter who opens a station's link in the own browser stays the experimenter.
        if known is None or session.role == "experimenter" or known.role == "participant":
            self.set_cookie(response, session)
        return response

    async def _answer(self, response: Response, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "websocket":
            # A close before the handshake is a refusal by status 403.
            await receive()
            await send({"type": "websocket.close", "code": 1008, "reason": "refused"})
            return
        await response(scope, receive, self._with_headers(send))

    def _with_headers(self, send: Send) -> Send:
        async def forward(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in HEADERS.items():
                    headers.setdefault(name, value)
            await send(message)

        return forward


def _bounded(receive: Receive) -> Receive:
    seen, whole = 0, False

    async def bounded() -> Message:
        nonlocal seen, whole
        if whole:
            # Only a disconnection or a websocket's next message can come now: no deadline.
            return await receive()
        try:
            message = await asyncio.wait_for(receive(), SLOWEST_BODY)
        except TimeoutError:
            raise _TooSlowError from None
        whole = message["type"] != "http.request" or not message.get("more_body", False)
        if message["type"] == "http.request":
            seen += len(message.get("body", b""))
            if seen > LARGEST_BODY:
                raise _TooLargeError
        return message

    return bounded
