"""The guard as an application sees it: bodies in parts, connections, cookies, headers."""

from __future__ import annotations

import asyncio
from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.lab import guard as guard_module
from squeezefilm.lab.guard import CONNECTION, HEADERS, LARGEST_BODY, Guard, Keys, Places, Session

HOST = "127.0.0.1:8631"
ORIGIN = f"http://{HOST}"


class Application:
    """Takes whole bodies, and notes what it was asked."""

    def __init__(self) -> None:
        self.scopes: list[Any] = []
        self.bodies: list[bytes] = []
        self.after: Any = None

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        self.scopes.append(scope)
        body, more = b"", True
        while more:
            message = await receive()
            body += message.get("body", b"")
            more = message.get("more_body", False)
        self.bodies.append(body)
        self.after = await receive()
        given = [(b"cache-control", b"own")]
        await send({"type": "http.response.start", "status": 200, "headers": given})
        await send({"type": "http.response.body", "body": b"done"})


@pytest.fixture
def app() -> Application:
    return Application()


def guarded(app: Application, keys: Keys | None = None, **places: Any) -> Guard:
    return Guard(app, keys or Keys(), Places(frozenset({HOST}), **places))


def scope_of(
    path: str = "/", method: str = "POST", session: Session | None = None, **changes: Any
) -> dict[str, Any]:
    headers = {"host": HOST, "origin": ORIGIN}
    if session is not None:
        headers["cookie"] = f"other=1; squeezefilm={session.secret}; more=2"
    headers.update(changes.pop("headers", {}))
    pairs = [(name.encode(), value.encode()) for name, value in headers.items() if value]
    return {
        "type": "http", "method": method, "path": path, "query_string": b"", "headers": pairs,
        **changes,
    }  # fmt: skip


def asked(guard: Guard, scope: Any, *parts: bytes, stalls: bool = False) -> list[Any]:
    """What is sent for a request whose body comes in parts."""
    messages = [
        {"type": "http.request", "body": part, "more_body": stalls or k < len(parts) - 1}
        for k, part in enumerate(parts)
    ]
    sent: list[Any] = []

    async def receive() -> Any:
        if messages:
            return messages.pop(0)
        if stalls:
            await asyncio.Event().wait()
        return {"type": "http.disconnect"}

    async def send(message: Any) -> None:
        sent.append(message)

    asyncio.run(guard(scope, receive, send))
    return sent


def entered(keys: Keys, role: Any = "experimenter") -> Session:
    found = keys.use_link(keys.new_link(role))
    assert found is not None
    return found[0]


def test_a_request_that_may_pass_comes_whole_with_its_session(app: Application) -> None:
    guard = guarded(app)
    session = entered(guard.keys)
    sent = asked(guard, scope_of(session=session), b"a", b"bc", b"d")
    assert app.bodies == [b"abcd"]
    assert app.after == {"type": "http.disconnect"}
    assert app.scopes[0]["lab_session"] == session
    headers = dict(sent[0]["headers"])
    # An application's own word stands; the others are added.
    assert headers.pop(b"cache-control") == b"own"
    expected = {name.encode(): value.encode() for name, value in HEADERS.items()}
    del expected[b"cache-control"]
    assert headers == expected
    assert sent[1]["body"] == b"done"
    assert guard.refusals == {}


def test_a_body_that_grows_too_large_is_refused_and_counted(app: Application) -> None:
    guard = guarded(app)
    session = entered(guard.keys)
    whole = b"x" * (LARGEST_BODY // 2)
    asked(guard, scope_of(session=session), whole, whole)
    assert len(app.bodies[0]) == LARGEST_BODY
    sent = asked(guard, scope_of(session=session), whole, whole, b"x")
    assert sent[0]["status"] == 413
    assert f"more than {LARGEST_BODY} bytes" in sent[1]["body"].decode()
    assert guard.refusals == {"size": 1}
    said = scope_of(session=session, headers={"content-length": str(LARGEST_BODY)})
    assert asked(guard, said, b"")[0]["status"] == 200
    for length in (str(LARGEST_BODY + 1), "-1", "ten", "1_0"):
        said = scope_of(session=session, headers={"content-length": length})
        assert asked(guard, said, b"")[0]["status"] == 413
    assert guard.refusals == {"size": 5}


def test_a_body_that_stalls_is_given_up(app: Application, monkeypatch: pytest.MonkeyPatch) -> None:
    # It never goes on: however short the wait, only the wait can end it.
    monkeypatch.setattr(guard_module, "SLOWEST_BODY", 0.01)
    guard = guarded(app)
    sent = asked(guard, scope_of(session=entered(guard.keys)), b"a", stalls=True)
    assert sent[0]["status"] == 408
    assert "not whole within 0.01 s" in sent[1]["body"].decode()
    assert guard.refusals == {"slow": 1}
    assert app.bodies == []


def test_a_connection_is_no_stranger_once_its_session_is_known(app: Application) -> None:
    guard = guarded(app)
    connection = SimpleNamespace(is_stranger=True)
    state = {CONNECTION: connection}
    asked(guard, scope_of(state=state), b"")
    assert connection.is_stranger
    asked(guard, scope_of(state=state, session=entered(guard.keys)), b"")
    assert not connection.is_stranger


def test_a_tablet_that_pairs_stays_a_stranger(app: Application) -> None:
    guard = guarded(app, participants_only=True)
    connection = SimpleNamespace(is_stranger=True)
    scope = scope_of("/pair", "GET", state={CONNECTION: connection})
    assert asked(guard, scope, b"")[0]["status"] == 200
    assert connection.is_stranger
    assert app.scopes[0]["lab_session"] is None


def test_what_is_neither_request_nor_websocket_is_the_applications(app: Application) -> None:
    guard = guarded(app)
    asked(guard, {"type": "lifespan"}, b"")
    assert [one["type"] for one in app.scopes] == ["lifespan"]


@pytest.mark.parametrize("text", ["squeezefilm", "a=b", "\x01=;", "squeezefilm=", "[]=1"])
def test_a_cookie_that_is_none_is_nobodys_session(app: Application, text: str) -> None:
    guard = guarded(app)
    sent = asked(guard, scope_of("/static/x", "GET", headers={"cookie": text}), b"")
    assert sent[0]["status"] == 401
    assert "needs the link" in sent[1]["body"].decode()
    assert guard.refusals == {"session": 1}


@pytest.mark.parametrize(
    ("changes", "reason", "status"),
    [
        ({"host": "evil.example"}, "host", 421),
        ({"host": ""}, "host", 421),
        ({"host": HOST.upper()}, None, 200),
        ({"origin": "http://evil.example"}, "origin", 403),
        ({"origin": ""}, "origin", 403),
        ({"sec-fetch-site": "cross-site"}, "site", 403),
        ({"sec-fetch-site": "same-site"}, "site", 403),
        ({"sec-fetch-site": "same-origin"}, None, 200),
        ({"sec-fetch-site": "none"}, None, 200),
        # Only following a link may come from elsewhere, not sending a form.
        ({"sec-fetch-site": "cross-site", "sec-fetch-mode": "navigate"}, "site", 403),
    ],
)
def test_what_a_change_must_say(
    app: Application, changes: dict[str, str], reason: str | None, status: int
) -> None:
    guard = guarded(app)
    scope = scope_of("/x", session=entered(guard.keys), headers=changes)
    assert asked(guard, scope, b"")[0]["status"] == status
    assert guard.refusals == ({} if reason is None else {reason: 1})
    assert len(app.scopes) == (reason is None)


def test_who_only_reads_need_not_say_an_origin_and_may_follow_a_link(app: Application) -> None:
    guard = guarded(app)
    session = entered(guard.keys)
    link = {"origin": "", "sec-fetch-site": "cross-site", "sec-fetch-mode": "navigate"}
    for method, headers in (("GET", {"origin": ""}), ("HEAD", {"origin": ""}), ("GET", link)):
        scope = scope_of("/x", method, session=session, headers=headers)
        assert asked(guard, scope, b"")[0]["status"] == 200
    picture = {"origin": "", "sec-fetch-site": "cross-site", "sec-fetch-mode": "no-cors"}
    assert asked(guard, scope_of("/x", "GET", headers=picture), b"")[0]["status"] == 403


def test_a_header_that_comes_twice_is_refused(app: Application) -> None:
    guard = guarded(app)
    for name, value in ((b"host", HOST.encode()), (b"origin", ORIGIN.encode())):
        scope = scope_of("/x", session=entered(guard.keys))
        scope["headers"].append((name, value))
        asked(guard, scope, b"")
    assert guard.refusals == {"host": 1, "origin": 1}


def test_a_websocket_that_is_refused_is_closed_before_its_handshake(app: Application) -> None:
    guard = guarded(app)
    scope = scope_of("/ws", type="websocket")
    del scope["method"]
    sent = asked(guard, scope, b"")
    assert sent == [{"type": "websocket.close", "code": 1008, "reason": "refused"}]
    assert guard.refusals == {"session": 1}


def link_of(guard: Guard, role: Any, session: Session | None) -> list[Any]:
    token = guard.keys.new_link(role)
    scope = scope_of("/", "GET", session=session, query_string=f"token={token}".encode())
    return asked(guard, scope, b"")


@pytest.mark.parametrize(
    ("link", "browser", "becomes"),
    [
        ("experimenter", None, True),
        ("participant", None, True),
        ("experimenter", "experimenter", True),
        ("experimenter", "participant", True),
        ("participant", "participant", True),
        ("participant", "experimenter", False),
    ],
)
def test_an_experimenter_who_opens_a_stations_link_stays_the_experimenter(
    app: Application, link: str, browser: str | None, becomes: bool
) -> None:
    guard = guarded(app)
    sent = link_of(guard, link, entered(guard.keys, browser) if browser else None)
    headers = dict(sent[0]["headers"])
    assert sent[0]["status"] == 303
    assert headers[b"location"] == (b"/participant" if link == "participant" else b"/")
    assert (b"set-cookie" in headers) == becomes


def test_a_link_that_is_over_is_said_and_counted(app: Application) -> None:
    guard = guarded(app)
    scope = scope_of("/", "GET", query_string=b"token=used")
    sent = asked(guard, scope, b"")
    assert sent[0]["status"] == 401
    assert "used already" in sent[1]["body"].decode()
    assert guard.refusals == {"link": 1}


@pytest.mark.parametrize(
    ("path", "status"),
    [
        ("/participant", 200), ("/participant/more", 200), ("/static/a.js", 200), ("/pair", 200),
        ("/ws/participant", 200), ("/favicon.ico", 200), ("/", 403), ("/another-station", 403),
        ("/static", 403), ("/ws", 403), ("/part", 403),
    ],
)  # fmt: skip
def test_a_participant_reaches_these_paths_only(app: Application, path: str, status: int) -> None:
    guard = guarded(app)
    session = entered(guard.keys, "participant")
    assert asked(guard, scope_of(path, session=session), b"")[0]["status"] == status
    assert guard.refusals == ({} if status == 200 else {"role": 1})
