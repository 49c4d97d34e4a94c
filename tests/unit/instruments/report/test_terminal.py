"""What the terminal shows of a session: numbers where there are some, a dash where not."""

from __future__ import annotations

import dataclasses
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.unit.printed import printed

from squeezefilm.instruments.bench.timing_checks import CheckResult, DeviceCheck
from squeezefilm.instruments.device.wire.frames import Fault, State
from squeezefilm.instruments.report.terminal import (
    line_a_second,
    play_rows,
    play_warnings,
    show_check,
    show_export,
    show_play,
    view_line,
)
from squeezefilm.instruments.session.play.plan import HeldState, PlayView
from squeezefilm.instruments.session.play.usability import Usability
from squeezefilm.instruments.session.record.trace import TraceExport

VIEW = PlayView(
    time=1.25, x=12.34e-3, speed=0.06, wanted=1e-6, amplitude=0.9e-6, level=8.0,
    relative_friction=0.7,
    lag=0.4e-3, lateness=12e-6, state=State.PLAYING, fault=Fault.NONE, readings=5, rows=7,
    flags=("ticks were lost just before this one",),
)  # fmt: skip
UNKNOWN = PlayView(
    time=0.0, x=math.nan, speed=math.nan, wanted=math.nan, amplitude=math.nan,
    relative_friction=math.nan, level=math.nan, lag=math.nan, lateness=math.nan, state=State.FAULT,
    fault=Fault.WATCHDOG, readings=0, rows=0, flags=(),
)  # fmt: skip


def test_a_line_says_all_of_a_moment() -> None:
    assert view_line(VIEW) == (
        "   1.25 s, playing, x   12.34 mm, µ′/µ 0.700, amplitude 0.90 µm, lag 0.400 mm, "
        "late 12 µs, ticks were lost just before this one"
    )
    assert "fault (watchdog), x       – mm" in view_line(UNKNOWN)


def test_what_the_loops_say_is_in_the_line() -> None:
    held = HeldState("locked", 0.1, -0.02, 12.0, 0.4, 30.0)
    view = dataclasses.replace(VIEW, held=held)
    assert f"late 12 µs, {held.words}, ticks were lost" in view_line(view)
    assert "amplitude -2.0 %, reserve 12.0 V, finger 0.40, 30.0 °C" in view_line(view)


def test_a_check_shows_what_failed_and_what_to_do(capsys: pytest.CaptureFixture[str]) -> None:
    check = DeviceCheck(
        "twin",
        (
            CheckResult("link", True, "0 lost", "0"),
            CheckResult("watchdog", False, "never", "60 ms", "do not play on this device"),
        ),
    )
    show_check(check)
    said = capsys.readouterr().out
    assert "! watchdog: do not play on this device" in said
    assert "1 of 2 checks passed" in said


def test_a_moment_is_a_line_at_once_and_again_after_a_second(
    capsys: pytest.CaptureFixture[str],
) -> None:
    from dataclasses import replace

    show = line_a_second()
    for time in (0.5, 1.25, 1.5, 2.4375, 2.5):
        show(replace(VIEW, time=time))
    said = capsys.readouterr()
    assert said.out == ""
    assert [line[:11] for line in said.err.splitlines()] == [
        f"  {time:7.2f} s" for time in (0.5, 1.5, 2.5)
    ]


def test_an_export_says_what_it_holds_and_what_was_lost() -> None:
    done = TraceExport(
        "a.trace", "b.csv", "csv", 12, ("time", "x", "y"), 4, 0, True, ("the end is missing",)
    )
    assert printed(lambda: show_export(done)) == [
        "b.csv: 12 rows of 3 columns, 4 events", "! the end is missing",
    ]  # fmt: skip


def test_checks_are_listed_with_what_was_measured_and_allowed() -> None:
    check = DeviceCheck(
        "twin",
        (
            CheckResult("link", True, "0 lost", "0"),
            CheckResult("clock", True, "1 ms", "2 ms"),
            CheckResult("watchdog", False, "never", "60 ms", "unplug it"),
            CheckResult("speed", False, "slow", "fast", "wait", 0.1, "this computer was busy"),
        ),
    )
    assert printed(lambda: show_check(check)) == [
        "Device on twin", "check measured allowed", "pass link 0 lost 0", "pass clock 1 ms 2 ms",
        "FAIL watchdog never 60 ms", "doubt speed slow fast", "! watchdog: unplug it",
        "! speed: this computer was busy", "2 of 4 checks passed, 1 in doubt",
    ]  # fmt: skip


LATE = {
    "made": 990, "lost": 10, "p50_s": 20e-6, "p99_s": 80e-6, "p99_9_s": 300e-6, "longest_s": 2e-3,
}  # fmt: skip


def judged(lag: float = 0.25e-3, **changes: Any) -> Any:
    values: dict[str, Any] = {
        "spatial_frequency": np.array([500.0, 1000.0]), "contrast_kept": np.array([0.81, np.nan]),
        "swing_kept": np.array([0.92, 0.5]), "rms_error": 0.0312, "wanted_swing": 0.4,
        "lag": lag, "lag_time": lag / 0.08, "mean_speed": 0.08,
    }  # fmt: skip
    return SimpleNamespace(
        way=SimpleNamespace(source="the pickup"), unjudged=None,
        fidelity=SimpleNamespace(**{**values, **changes}),
    )  # fmt: skip


def played(**changes: Any) -> Any:
    """A session of two seconds from the start of its record, and its twin's truth."""
    rows = np.zeros((3, 4))
    rows[:, 1] = [5.0, 6.0, 7.0]
    plan = SimpleNamespace(
        mode="stream", frequency=40e3, tile=None,
        loop=SimpleNamespace(
            rate=1e3, compensation="inverse",
            voltage_limit=16.0,
        ),
    )  # fmt: skip
    values: dict[str, Any] = {
        "setup": SimpleNamespace(
            plan=plan, name="grating", assumed_limits=(),
            display=SimpleNamespace(title="A plate", name="plate", whose_finger="person 3's"),
            prediction=SimpleNamespace(warnings=()),
        ),
        "trace": SimpleNamespace(rows=rows, damage=SimpleNamespace(sentences=())),
        "by_record": judged(), "by_truth": None, "position_error": None, "lag": None,
        "loop": lambda: {"lateness": LATE}, "link": lambda: {}, "end": lambda: {},
        "flags": {}, "device_events": (),
    }  # fmt: skip
    known = {**values, **changes}
    return SimpleNamespace(**known, last=lambda kind: known[kind]())


def result(**changes: Any) -> Any:
    outcome = SimpleNamespace(
        ending=SimpleNamespace(value="completed"), message="all was played", failed=False,
        usable=True, usability=Usability(True, 2000, 0.995, 12e-3, 0.001, ""),
    )  # fmt: skip
    return SimpleNamespace(session=played(**changes), outcome=outcome)


def test_a_session_that_cannot_be_used_says_why() -> None:
    found = result()
    found.outcome.usable = False
    found.outcome.usability = Usability(False, 9, 0.1, 10.0, 0.0, "10 % of 9 ticks were made")
    assert play_rows(found)[1] == ("Usable", "NO", "10 % of 9 ticks were made")
    # One that failed has said why it ended.
    found.outcome.failed = True
    assert play_rows(found)[1] == ("Usable", "NO", "")


def test_a_session_is_told_line_by_line() -> None:
    found = play_rows(
        result(
            by_truth=judged(-0.1e-3), position_error=50e-6,
            lag=SimpleNamespace(median=1.234e-3, p99=2.5e-3),
            link=lambda: {
                "lost": 2, "sent": 500, "damaged": 1, "refused": 3, "mean_round_trip_s": 1.5e-3,
                "longest_round_trip_s": 9e-3,
            },
            end=lambda: {"readings": 77, "late_commands": 4, "device_late_ticks": 5},
        )
    )  # fmt: skip
    assert found == [
        ("Ended", "completed", "all was played"),
        ("Usable", "yes", "99.5 % of 2000 ticks made, longest gap 12 ms, 0.1 % too late"),
        ("Played", "2 s", "mode stream, 1 kHz, compensation inverse, up to 16 V at 40 kHz"),
        ("Finger", "", "person 3's"),
        # Nothing is said of a period that the texture has nothing at.
        ("Record: contrast at 2 mm", "81 %", "in its place; 92 % of that wave anywhere"),
        ("Record: friction error", "0.031", "RMS of µ′/µ, swing wanted 0.40; by the pickup"),
        ("Record: lag", "0.250 mm", "behind the finger, 3.1 ms at 80 mm/s"),
        ("Truth: contrast at 2 mm", "81 %", "in its place; 92 % of that wave anywhere"),
        ("Truth: friction error", "0.031", "RMS of µ′/µ, swing wanted 0.40; by the pickup"),
        ("Truth: lag", "-0.100 mm", "ahead of the finger, 1.2 ms at 80 mm/s"),
        ("Position error", "50 µm", "of the estimate, RMS, truth"),
        ("Way predicted", "1.23 mm", "from newest sample to its command at the plate; 2.50 mm at "
         "99 %"),
        ("Ticks lost", "1.000 %", "10 of 1000; late 20 µs median, 80 µs at 99 %, 0.3 ms at 99.9 %, "
         "2 ms at most"),
        ("Link", "2 lost", "of 500 frames; 1 damaged, 3 refused; round trip 1.5 ms on average, "
         "9 ms at most"),
        ("Device", "77 readings", "4 commands too late to send, 5 late ticks of its own"),
    ]  # fmt: skip


def test_what_a_session_does_not_know_is_a_dash() -> None:
    by_record = SimpleNamespace(way=None, fidelity=None, unjudged="it stood still")
    empty = SimpleNamespace(rows=np.zeros((0, 4)))
    found = play_rows(result(by_record=by_record, trace=empty, loop=dict, link=lambda: {"sent": 9}))
    assert [row[:2] for row in found] == [
        ("Ended", "completed"), ("Usable", "yes"), ("Played", "0 s"), ("Finger", ""),
        ("Record: contrast, lag", "–"), ("Loop", "–"), ("Link", "0 lost"),
    ]  # fmt: skip
    assert found[4][2] == "it stood still"
    assert found[5][2] == "it could not say how late it was"
    assert found[6][2] == ("of 9 frames; 0 damaged, 0 refused; round trip – on average, – at most")
    found = play_rows(result(end=lambda: {"state": "idle"}, by_record=judged(math.nan)))
    assert found[-1] == (
        "Device", "0 readings", "0 commands too late to send, 0 late ticks of its own",
    )  # fmt: skip
    assert not any(name == "Record: lag" for name, *_ in found)
    by_record.unjudged = None
    assert play_rows(result(by_record=by_record))[4] == ("Record: contrast, lag", "–", "")


def test_no_lag_is_behind_and_nothing_due_is_nothing_lost() -> None:
    found = {name: rest for name, *rest in play_rows(result(by_record=judged(0.0)))}
    assert found["Record: lag"][1].startswith("behind the finger, 0 s at")
    none = {**LATE, "made": 0, "lost": 0, "p50_s": None}
    found = {name: rest for name, *rest in play_rows(result(loop=lambda: {"lateness": none}))}
    assert found["Ticks lost"] == ["0.000 %", "0 of 0; late – median, 80 µs at 99 %, 0.3 ms at "
                                   "99.9 %, 2 ms at most"]  # fmt: skip


@pytest.mark.parametrize(("granted", "word"), [(True, "with"), (False, "WITHOUT")])
def test_a_loop_in_its_own_process_says_how_it_ran(granted: bool, word: str) -> None:
    loop = {
        "lateness": LATE, "real_time_priority": granted, "processor_share": 0.43,
        "dropped_commands": 1, "dropped_rows": 2, "stale_commands": 3,
    }  # fmt: skip
    rows = {name: rest for name, *rest in play_rows(result(loop=lambda: loop))}
    assert rows["Loop process"] == [
        "43 %",
        f"of a processor, {word} real-time priority; 1 commands and 2 rows dropped, 3 stale",
    ]


def test_what_is_doubtful_is_said_once_each() -> None:
    session = played(
        flags={"it was late": 4},
        device_events=(
            {"fault": "watchdog", "time_s": 1.25}, {"fault": "none"}, {"time_s": 3.0},
            {"fault": "link"},
        ),
    )  # fmt: skip
    session.setup.assumed_limits = ("voltage", "frequency")
    session.setup.prediction.warnings = ("mind \x1b[31m this",)
    session.trace.damage.sentences = ("the end is missing",)
    assert play_warnings(session) == [
        "the display's drive does not give voltage, frequency; the device was given assumed limits",
        "4 ticks: it was late", "the device faulted at 1.250 s: watchdog",
        "the device faulted at 0.000 s: link", "the end is missing", "mind [31m this",
    ]  # fmt: skip
    assert play_warnings(played()) == []


def test_a_session_is_shown_under_its_names() -> None:
    found = result(flags={"it was late": 4})
    lines = printed(lambda: show_play(found))
    assert lines[0] == "grating on A plate [plate]"
    assert lines[1:-1] == [" ".join(filter(None, row)) for row in play_rows(found)]
    assert lines[-1] == "! 4 ticks: it was late"
