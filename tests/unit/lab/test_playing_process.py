"""A session's own process, within this one: what it tells the server, and how it ends."""

from __future__ import annotations

import math
import os
import signal
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import DeviceError, InputError
from squeezefilm.core.results import to_json
from squeezefilm.instruments.bench import play as bench_play
from squeezefilm.instruments.bench.timing_checks import CheckResult
from squeezefilm.instruments.device.wire.frames import Fault, State
from squeezefilm.instruments.report import page
from squeezefilm.instruments.session.loop.rows import COLUMNS
from squeezefilm.instruments.session.play.plan import PlayView
from squeezefilm.lab import own_process
from squeezefilm.lab.own_process import DeviceSession, check, play

WORK: Any = {
    "display": "d.toml", "texture": "biet2008-square-4mm", "drive": "twin", "mode": "stream",
    "stroke": "s", "sensor": "device", "duration": 2.0, "voltage": 12.0, "compensation": "inverse",
    "out": "folder", "seed": 5,
}  # fmt: skip


class Pipe:
    def __init__(self, *messages: Any) -> None:
        self.said: list[dict[str, Any]] = []
        self.messages = list(messages)
        self.broken = False

    def send(self, message: dict[str, Any]) -> None:
        if self.broken:
            raise OSError
        self.said.append(message)

    def recv(self) -> Any:
        if not self.messages:
            raise EOFError
        return self.messages.pop(0)


Played = Callable[[Callable[..., Any]], Pipe]


@pytest.fixture
def played(monkeypatch: pytest.MonkeyPatch) -> Played:
    """What is said over the pipe by a session that is played so."""

    def session(how: Callable[..., Any]) -> Pipe:
        monkeypatch.setattr(bench_play, "play_texture", how)
        pipe: Any = Pipe()
        play(pipe, **WORK)
        return pipe  # type: ignore[no-any-return]

    return session


def test_a_session_is_played_as_it_was_asked_for_and_written(
    played: Played, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Any] = []
    order: list[Any] = []
    outcome = SimpleNamespace(
        usable=True, said="", ending=SimpleNamespace(name="DURATION", value="time was over")
    )
    result = SimpleNamespace(outcome=outcome, summary=lambda: {"rows": 3})

    def how(*given: Any, **named: Any) -> Any:
        asked.append((given, named))
        return result

    monkeypatch.setattr(signal, "signal", lambda *given: order.append(given))
    monkeypatch.setattr(page, "write_play", lambda *given: order.append(given))
    pipe = played(how)
    ((given, named),) = asked
    for name in ("show", "tap", "progress"):
        assert callable(named.pop(name))
    assert given[0] == "d.toml"
    assert given[1].title
    assert named == {
        "drive": "twin", "sensor": "device", "mode": "stream", "stroke": "s", "duration": 2.0,
        "voltage": 12.0, "compensation": "inverse", "out": Path("folder"), "seed": 5,
    }  # fmt: skip
    # What is left to be written is not cut short.
    assert order == [(signal.SIGINT, signal.SIG_IGN), (result, Path("folder"))]
    ended = {
        "type": "device ended", "failed": False, "ending": "DURATION", "message": "time was over",
        "summary": {"rows": 3}, "folder": "folder",
    }  # fmt: skip
    assert pipe.said == [ended]
    outcome.said, outcome.usable = "it broke", False
    assert played(how).said == [{**ended, "failed": True, "message": "it broke"}]


def test_rows_are_thinned_out_for_the_page_and_carry_null_for_none(played: Played) -> None:
    def how(*_: Any, tap: Any, **__: Any) -> None:
        rows = np.full((7, len(COLUMNS)), math.nan)
        rows[:, 0] = np.arange(7)
        rows[:, 1] = [0.0, 0.9e-3, 1.9e-3, 2.0e-3, 3.9e-3, 4.1e-3, 4.2e-3]
        tap(rows[:2])
        tap(rows[2:3])
        tap(rows[3:])
        raise KeyboardInterrupt

    told = [one for one in played(how).said if one["type"] == "device rows"]
    assert [[row[0] for row in one["rows"]] for one in told] == [[0.0], [3.0, 5.0]]
    assert all(one["columns"] == list(COLUMNS) for one in told)
    assert told[0]["rows"][0][2:] == [None] * (len(COLUMNS) - 2)


def test_what_there_is_to_see_is_told_with_its_units(played: Played) -> None:
    view = PlayView(
        state=State.PLAYING, fault=Fault.NONE, time=1.0, x=2.0, speed=3.0, relative_friction=4.0,
        amplitude=5.0, wanted=6.0, level=7.0, lag=8.0, lateness=9.0, readings=10, rows=11,
        flags=("a", "b"),
    )  # fmt: skip

    def how(*_: Any, show: Any, **__: Any) -> None:
        show(view)
        raise KeyboardInterrupt

    assert played(how).said[0] == {
        "type": "device view", "state": "PLAYING", "fault": "NONE", "time_s": 1.0, "x_m": 2.0,
        "speed_m_per_s": 3.0, "relative_friction": 4.0, "amplitude_m": 5.0, "wanted_m": 6.0,
        "level_V": 7.0, "lag_m": 8.0, "lateness_s": 9.0, "readings": 10, "rows": 11,
        "flags": ["a", "b"], "held": None, "loops": "",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("stages", "message"),
    [
        ([], "stopped before anything was played"),
        (["the twin"], "stopped before anything was played"),
        (
            ["playing", bench_play.JUDGING],
            "stopped during: the record; what was played is recorded in folder, not judged",
        ),
    ],
)
def test_a_session_that_is_stopped_says_what_there_is_of_it(
    played: Played, stages: list[str], message: str
) -> None:
    def how(*_: Any, progress: Any, **__: Any) -> None:
        for stage in stages:
            progress(stage)
        raise KeyboardInterrupt

    said = played(how).said
    assert said == [
        *({"type": "device progress", "text": stage} for stage in stages),
        {"type": "device ended", "failed": False, "message": message},
    ]


def test_a_session_that_fails_says_why(played: Played) -> None:
    def how(*_: Any, **__: Any) -> None:
        raise DeviceError("it is unplugged")

    assert played(how).said == [
        {"type": "device ended", "failed": True, "message": "it is unplugged"}
    ]


def test_a_check_tells_each_step_and_each_result(monkeypatch: pytest.MonkeyPatch) -> None:
    one = CheckResult(name="link", passed=True, measured="1", allowed="2")
    two = CheckResult(name="stop", passed=False, measured="3", allowed="4", advice="mend it")

    def done(drive: str, display: str, *, progress: Any) -> Any:
        progress(f"{drive} of {display}")
        return SimpleNamespace(passed=False, results=[one, two])

    monkeypatch.setattr(bench_play, "check_drive", done)
    pipe: Any = Pipe()
    check(pipe, "twin", "one")
    assert pipe.said == [
        {"type": "device progress", "text": "twin of one"},
        {"type": "device checked", "passed": False, "results": to_json([one, two])},
        {"type": "device ended", "failed": False, "message": "checked"},
    ]


@pytest.mark.parametrize(
    ("error", "failed", "message"),
    [(KeyboardInterrupt(), False, "the check was stopped"), (DeviceError("gone"), True, "gone")],
)
def test_a_check_that_does_not_end_says_so(
    monkeypatch: pytest.MonkeyPatch, error: BaseException, failed: bool, message: str
) -> None:
    def broken(*_: Any, **__: Any) -> None:
        raise error

    monkeypatch.setattr(bench_play, "check_drive", broken)
    pipe: Any = Pipe()
    check(pipe, "twin", "one")
    assert pipe.said == [{"type": "device ended", "failed": failed, "message": message}]


def test_where_the_server_is_gone_the_session_stops_as_by_ctrl_c(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    killed: list[Any] = []
    monkeypatch.setattr(os, "kill", lambda *given: killed.append(given))
    pipe: Any = Pipe()
    tell = own_process.telling(pipe)
    tell({"type": "a"})
    assert (pipe.said, killed) == ([{"type": "a"}], [])
    pipe.broken = True
    tell({"type": "b"})
    assert killed == [(os.getpid(), signal.SIGINT)]


class Process:
    def __init__(self, alive: bool = True, obeys: bool = True) -> None:
        self.alive, self.obeys, self.pid = alive, obeys, 4242
        self.done: list[Any] = []

    def is_alive(self) -> bool:
        return self.alive

    def join(self, limit: float | None = None) -> None:
        self.done.append(("join", limit))
        self.alive = self.alive and not self.obeys

    def kill(self) -> None:
        self.done.append("kill")


ENDED = {"type": "device ended", "failed": False, "message": "time was over"}


@pytest.mark.parametrize(
    ("messages", "stopped", "told"),
    [
        ([{"type": "a"}, ENDED, {"type": "b"}], False, [{"type": "a"}, {"type": "b"}, ENDED]),
        ([ENDED], True, [ENDED]),
        (
            [{"type": "a"}], True,
            [{"type": "a"}, {"type": "device ended", "failed": False,
              "message": "stopped before anything was played"}],
        ),
        (
            [], False,
            [{"type": "device ended", "failed": True,
              "message": "the process that played ended without a word; the device stops by its "
              "own watchdog"}],
        ),
    ],
)  # fmt: skip
def test_the_end_is_told_once_and_after_the_process_is_gone(
    messages: list[Any], stopped: bool, told: list[Any]
) -> None:
    heard: list[Any] = []
    process = Process()
    session = DeviceSession(lambda one: heard.append((one, process.alive)))
    session._stopped = stopped
    session._read(Pipe(*messages), process)  # type: ignore[arg-type]
    assert [one for one, _ in heard] == told
    assert heard[-1][1] is False
    assert all(alive for _, alive in heard[:-1])


def test_a_session_is_stopped_by_ctrl_c_and_killed_where_it_does_not_end(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    killed: list[Any] = []
    monkeypatch.setattr(os, "kill", lambda *given: killed.append(given))
    session = DeviceSession(lambda _: None)
    session.stop()
    session.close()
    assert (killed, session.running) == ([], False)
    for obeys in (True, False):
        process = session._process = Process(obeys=obeys)
        assert session.running
        with pytest.raises(InputError, match="in use by this lab already"):
            session.start(play)
        session.close()
        assert process.done == [("join", 5.0)] + ([] if obeys else ["kill"])
    assert killed == [(4242, signal.SIGINT)] * 2
    assert session._stopped


def test_a_session_that_ended_just_before_it_is_stopped_is_no_fault(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def is_gone(*_: object) -> None:
        raise ProcessLookupError

    monkeypatch.setattr(os, "kill", is_gone)
    session = DeviceSession(lambda _: None)
    process = session._process = Process(obeys=True)
    session.close()
    assert process.done == [("join", 5.0)]
