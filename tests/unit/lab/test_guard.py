"""Who may talk to the lab: hosts, origins, sessions, roles, sizes, files."""

import json

import pytest
from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

from squeezefilm.lab.guard import (
    CODE_LIFE,
    LARGEST_BODY,
    LINK_LIFE,
    POLICY,
    SESSION_LIFE,
    Keys,
    Places,
)
from squeezefilm.lab.server import Lab, application, static_file

HOST = "127.0.0.1:8631"
ORIGIN = f"http://{HOST}"
WS = f"ws://{HOST}/ws"


class Clock:
    def __init__(self) -> None:
        self.now = 1e9

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def lab(tmp_path):
    return Lab(tmp_path, Keys(clock=Clock()), Places(frozenset({HOST, "localhost:8631"})))


@pytest.fixture
def stranger(lab):
    return TestClient(application(lab), base_url=ORIGIN, follow_redirects=False)


@pytest.fixture
def page(lab, stranger):
    entered = stranger.get(f"/?token={lab.keys.new_link()}")
    assert entered.status_code == 303
    return stranger


def test_a_link_lets_one_browser_in_once(lab, stranger):
    token = lab.keys.new_link()
    assert stranger.get("/").status_code == 401
    entered = stranger.get(f"/?token={token}")
    assert (entered.status_code, entered.headers["location"]) == (303, "/")
    cookie = entered.headers["set-cookie"].lower()
    assert "httponly" in cookie
    assert "samesite=strict" in cookie
    assert stranger.get("/").status_code == 200
    replayed = TestClient(application(lab), base_url=ORIGIN, follow_redirects=False)
    assert replayed.get(f"/?token={token}").status_code == 401
    assert replayed.get("/").status_code == 401


def test_a_link_grows_old_and_so_does_a_session(lab, stranger):
    late = lab.keys.new_link()
    lab.keys.clock.now += LINK_LIFE + 1
    assert stranger.get(f"/?token={late}").status_code == 401
    stranger.get(f"/?token={lab.keys.new_link()}")
    assert stranger.get("/").status_code == 200
    lab.keys.clock.now += SESSION_LIFE + 1
    assert stranger.get("/").status_code == 401


@pytest.mark.parametrize(
    "host", ["evil.example", "127.0.0.1:80", "127.0.0.1", "", "evil.example:8631", "[::1]:8631"]
)
def test_another_host_is_refused_even_with_the_cookie(page, host):
    assert page.get("/", headers={"host": host}).status_code == 421


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "https://127.0.0.1:8631", ""])
def test_another_origin_is_refused_for_every_method(page, origin):
    for method in ("GET", "POST", "HEAD", "PUT", "DELETE"):
        answer = page.request(method, "/another-station", headers={"origin": origin})
        assert answer.status_code == 403, method


def test_a_change_needs_an_origin(page):
    assert page.post("/another-station").status_code == 403
    assert page.post("/another-station", headers={"origin": ORIGIN}).status_code == 200


def test_a_cross_site_fetch_without_origin_is_refused(page):
    assert page.get("/static/lab.css", headers={"sec-fetch-site": "cross-site"}).status_code == 403
    typed = {"sec-fetch-site": "none", "sec-fetch-mode": "navigate"}
    assert page.get("/", headers=typed).status_code == 200


@pytest.mark.parametrize("headers", [{}, {"origin": "http://evil.example"}, {"origin": "null"}])
def test_a_foreign_websocket_is_refused(page, headers):
    with pytest.raises(WebSocketDisconnect), page.websocket_connect(WS, headers=headers):
        pass


def test_a_websocket_without_session_is_refused(stranger):
    own = {"origin": ORIGIN}
    with pytest.raises(WebSocketDisconnect), stranger.websocket_connect(WS, headers=own):
        pass


def test_the_own_page_talks_and_is_answered_in_words(page):
    with page.websocket_connect(WS, headers={"origin": ORIGIN}) as socket:
        for text, words in [
            ('{"id": 1, "type": "no such thing"}', "not known"),
            ("[]", "object"),
            ("{", "Expecting"),
            ('{"id": NaN, "type": "x"}', "NaN"),
            ("[" * 5000, ""),
        ]:
            socket.send_text(text)
            answer = socket.receive_json()
            assert answer["type"] == "error"
            assert words in answer["message"]


def test_a_participant_reaches_only_the_participants_page(lab, stranger):
    stranger.get(f"/?token={lab.keys.new_link('participant')}")
    assert stranger.get("/participant").status_code == 200
    assert stranger.get("/").status_code == 403
    assert stranger.post("/another-station", headers={"origin": ORIGIN}).status_code == 403
    own = {"origin": ORIGIN}
    with pytest.raises(WebSocketDisconnect), stranger.websocket_connect(WS, headers=own):
        pass


def test_every_answer_carries_the_policy(page, stranger):
    for path in ("/", "/static/lab.css", "/static/none.css"):
        headers = page.get(path).headers
        assert headers["content-security-policy"] == POLICY
        assert headers["x-content-type-options"] == "nosniff"
        assert headers["cache-control"] == "no-store"
    refused = stranger.get("/", headers={"host": "evil.example"})
    assert refused.headers["content-security-policy"] == POLICY
    assert POLICY.startswith("default-src 'self'")
    assert "unsafe" not in POLICY


def test_too_large_a_body_is_refused_said_or_not(page):
    headers = {"origin": ORIGIN}
    large = b"x" * (LARGEST_BODY + 1)
    assert page.post("/another-station", headers=headers, content=large).status_code == 413

    def parts():
        yield from (b"x" * 65536 for _ in range(LARGEST_BODY // 65536 + 2))

    # No handler reads this body, so nothing of it is kept; it must be answered all the same.
    answer = page.post("/another-station", headers=headers, content=parts())
    assert answer.status_code in (200, 413)


@pytest.mark.parametrize(
    "path",
    [
        "../server.py",
        "..%2fserver.py",
        "%2e%2e/server.py",
        "....//server.py",
        "/etc/passwd",
        "vendor/../../server.py",
        "lab.css%00.js",
        "",
        "vendor",
        "lab.css/",
        "x" * 5000,
    ],
)
def test_paths_that_climb_are_no_files(page, path):
    assert page.get(f"/static/{path}").status_code in (404, 307)


def test_a_link_in_the_folder_is_no_file(tmp_path):
    (tmp_path / "secret.txt").write_text("secret")
    served = tmp_path / "served"
    served.mkdir()
    (served / "own.txt").write_text("own")
    (served / "out.txt").symlink_to(tmp_path / "secret.txt")
    (served / "in.txt").symlink_to(served / "own.txt")
    (served / "up").symlink_to(tmp_path, target_is_directory=True)
    assert static_file(served, "own.txt").status_code == 200
    for name in ("out.txt", "in.txt", "up/secret.txt", "../secret.txt", "up/served/own.txt"):
        assert static_file(served, name).status_code == 404, name


def test_a_pairing_code_works_once_and_cannot_be_guessed():
    clock = Clock()
    keys = Keys(clock=clock)
    code = keys.new_code()
    assert keys.use_code("x") is None
    entered = keys.use_code(code)
    assert entered is not None
    assert entered[0].role == "participant"
    assert (entered[0].station, entered[1]) == ("station 1", "/participant")
    assert keys.use_code(code) is None
    # After four wrong ones the right one still opens, another station.
    code = keys.new_code("/tablet")
    assert [keys.use_code("y") for _ in range(4)] == [None] * 4
    entered = keys.use_code(code)
    assert entered is not None
    assert (entered[0].station, entered[1]) == ("station 2", "/tablet")
    code = keys.new_code()
    wrong = f"{(int(code) + 1) % 10**6:06d}"
    assert [keys.use_code(wrong) for _ in range(5)] == [None] * 5
    assert keys.use_code(code) is None
    code = keys.new_code()
    clock.now += CODE_LIFE + 1
    assert keys.use_code(code) is None


def test_sessions_outlive_a_crash_and_no_clean_end(tmp_path):
    file = tmp_path / "keys"
    keys = Keys(file)
    session, _ = keys.use_link(keys.new_link())
    assert file.stat().st_mode & 0o777 == 0o600
    again = Keys(file)
    assert again.session(session.secret) == session
    again.forget()
    assert not file.exists()
    assert again.session(session.secret) is None
    assert Keys(file).session(session.secret) is None


def test_sessions_that_are_over_are_not_kept(tmp_path):
    clock = Clock()
    keys = Keys(tmp_path / "keys", clock)
    over, _ = keys.use_link(keys.new_link())
    clock.now += SESSION_LIFE + 1
    assert keys.session(over.secret) is None
    now, _ = keys.use_link(keys.new_link())
    assert [one["secret"] for one in json.loads((tmp_path / "keys").read_text())] == [now.secret]
    assert keys.session(now.secret) == now


def test_a_full_disk_burns_no_link(tmp_path, monkeypatch):
    import errno
    import os

    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    keys = Keys(tmp_path / "keys")
    first, _ = keys.use_link(keys.new_link())
    link, code = keys.new_link("participant"), keys.new_code()
    with monkeypatch.context() as patched:
        patched.setattr(os, "open", full)
        for entered in (keys.use_link(link), keys.use_code(code)):
            session, _ = entered
            assert keys.session(session.secret) == session
    assert keys.use_link(link) is None
    assert sorted(one.name for one in tmp_path.iterdir()) == ["keys"]
    # What could not be kept is kept as soon as there is room.
    assert Keys(tmp_path / "keys").session(session.secret) is None
    keys.use_link(keys.new_link())
    assert Keys(tmp_path / "keys").session(session.secret) == session
    assert Keys(tmp_path / "keys").session(first.secret) == first
