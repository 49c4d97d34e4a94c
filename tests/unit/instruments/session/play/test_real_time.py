"""A session in real time with its clock, loop, device and record replaced: order and endings."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import DeviceError, InputError, LoopError, RecordError
from squeezefilm.instruments.device.wire.frames import Fault, State
from squeezefilm.instruments.session.loop.plan import LoopPlan
from squeezefilm.instruments.session.loop.shared import CLASSES, Lateness
from squeezefilm.instruments.session.play import real_time
from squeezefilm.instruments.session.play.plan import Ending
from squeezefilm.instruments.session.play.player import FADE
from squeezefilm.instruments.session.play.real_time import PlayOutcome, run_play
from squeezefilm.instruments.session.play.usability import Usability

PlanOf = Callable[..., LoopPlan]
USABLE = Usability(True, 100, 1.0, 2e-3, 0.0, "")
LATENESS = Lateness(5e3, 0, 0, 0.0, np.zeros(CLASSES, dtype=np.int64))


def test_only_time_and_user_end_a_session_without_failure() -> None:
    failed = {one for one in Ending if PlayOutcome(one, "", Path(), 0).failed}
    assert failed == {Ending.FAULT, Ending.LINK, Ending.LOOP}


def test_a_session_that_ended_as_it_should_is_usable_only_if_its_ticks_say_so() -> None:
    held_up = Usability(False, 100, 0.09, 10.0, 0.0, "9 % of 100 ticks were made")
    for ending in Ending:
        fine = PlayOutcome(ending, "", Path(), 0, usability=USABLE)
        assert fine.usable is not fine.failed
        assert not PlayOutcome(ending, "", Path(), 0, usability=held_up).usable
    found = PlayOutcome(Ending.DURATION, "", Path(), 0, usability=held_up)
    assert found.said == "not usable: 9 % of 100 ticks were made"
    assert PlayOutcome(Ending.LINK, "unplugged", Path(), 0, usability=held_up).said == "unplugged"


class Bench:
    """Everything that `run_play` opens, on a clock that sleeping moves; it notes what is done."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, plan: LoopPlan) -> None:
        self.now, self.done = 100.0, []  # type: ignore[var-annotated]
        self.events: dict[str, Any] = {}
        self.steps = 0
        self.at: dict[int, Any] = {}
        self.begins_with: BaseException | None = None
        self.plan: Any = SimpleNamespace(loop=plan, limits="limits", columns=())
        self.plan.device = SimpleNamespace(twin=True)
        self.ending: Ending | None = None
        self.unheld = ""
        self.fault, self.held_up = Fault.NONE, 0.0
        self.state = State.ARMED
        for name, made in {
            "open_stream": lambda drive: SimpleNamespace(close=lambda: self.note(f"close {drive}")),
            "TraceWriter": lambda *_: self, "LoopProcess": lambda _: self.loop(),
            "Link": lambda stream, clock: SimpleNamespace(statistics={"sent": clock()}),
            "DeviceHost": lambda _: SimpleNamespace(stop=lambda: self.note("host stop")),
            "SerialDrive": lambda host, period: "drive",
            "require_safe_drive": lambda *given, **how: self.note(("safe", given, how)),
            "Player": self.player_of, "_compile": lambda: self.note("compiled"),
            "time": SimpleNamespace(sleep=self.sleep, monotonic=lambda: self.now + 1000.0),
        }.items():  # fmt: skip
            monkeypatch.setattr(real_time, name, made)

    def note(self, what: Any) -> None:
        self.done.append(what)

    def sleep(self, duration: float) -> None:
        assert duration == 1e-3
        self.now += duration

    # The record.
    acknowledged = 12

    def __enter__(self) -> Bench:
        return self

    def __exit__(self, *_: object) -> None:
        self.note("record closed")

    def event(self, kind: str, fields: Any) -> None:
        self.events[kind] = fields

    def loop(self) -> Any:
        bench = self

        class Loop:
            @property
            def time(self) -> float:
                return bench.now

            def __enter__(self) -> None:
                bench.note("loop start")

            def __exit__(self, *_: object) -> None:
                bench.note("loop stop")

            def report(self) -> Any:
                return SimpleNamespace(lateness=LATENESS)

        return Loop()

    def player_of(self, *given: Any) -> Any:
        self.given, self.clock = given, given[4]
        return self

    # The player.
    def begin(self) -> None:
        self.note("begin")
        if self.begins_with is not None:
            raise self.begins_with

    def step(self) -> None:
        self.steps += 1
        happens = self.at.get(self.steps)
        if isinstance(happens, BaseException):
            raise happens
        if happens is not None:
            happens()

    def view(self) -> str:
        return f"view after {self.steps}"

    def fade(self) -> None:
        self.note(("fade", self.steps))

    def end(self, ending: Ending, wait: Any, message: str) -> None:
        assert wait == self.sleep
        self.note(("end", ending, message))

    def drain(self) -> None:
        self.note("drain")

    def judge(self) -> Usability:
        self.note("judged")
        return USABLE

    def run(self, **how: Any) -> PlayOutcome:
        said = {"duration": 0.05, **how}
        return run_play(self.plan, "serial:one", Path("trace"), {"a": 1}, **said)


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch, plan_of: PlanOf) -> Bench:
    monkeypatch.setattr(real_time, "to_json", lambda found: dict(vars(found)) if hasattr(
        found, "lateness") else found)  # fmt: skip
    return Bench(monkeypatch, plan_of())


FADING = round(FADE / 1e-3)


def test_a_session_plays_fades_ends_and_is_recorded_to_its_last_row(bench: Bench) -> None:
    before = signal.getsignal(signal.SIGINT)
    found = bench.run()
    assert found == PlayOutcome(Ending.DURATION, "", Path("trace"), 12, bench.now + 1000.0, USABLE)
    assert bench.done == [
        ("safe", ("drive", "limits", "own hand"), {}), "compiled",
        "loop start", "begin", ("fade", pytest.approx(50, abs=1)),
        ("end", Ending.DURATION, ""), "loop stop", "drain", "judged", "record closed",
        "close serial:one",
    ]  # fmt: skip
    # Through the fade it steps on.
    assert bench.steps == pytest.approx(50 + FADING, abs=2)
    assert bench.events["loop"] == {"lateness": LATENESS.to_json()}
    assert bench.events["link"] == {"sent": pytest.approx(100.0)}
    assert signal.getsignal(signal.SIGINT) is before


def test_what_is_seen_is_shown_ten_times_a_second(bench: Bench) -> None:
    shown: list[str] = []
    bench.run(duration=0.45, show=shown.append)
    assert shown[0] == "view after 1"
    steps = np.array([int(one.split()[-1]) for one in shown])
    assert steps == pytest.approx([1, 101, 201, 301, 401], abs=2)


def test_a_change_of_the_devices_state_is_shown_at_once(bench: Bench) -> None:
    shown: list[str] = []

    def plays() -> None:
        bench.state = State.PLAYING

    bench.at[37] = plays
    bench.run(duration=0.2, show=shown.append)
    steps = [int(one.split()[-1]) for one in shown]
    assert steps[:2] == [1, 37]
    # And from there ten times a second again.
    assert steps[2] == pytest.approx(137, abs=2)


@pytest.mark.parametrize("by", ["until", "signal"])
def test_who_interrupts_lets_it_fade_first(bench: Bench, by: str) -> None:
    stopped: list[bool] = []
    if by == "until":
        bench.at[5] = lambda: stopped.append(True)
        found = bench.run(duration=10.0, until=lambda: bool(stopped))
    else:
        bench.at[5] = lambda: signal.raise_signal(signal.SIGTERM)
        found = bench.run(duration=10.0)
    assert found.ending is Ending.INTERRUPTED
    assert ("fade", 5) in bench.done
    assert bench.steps == pytest.approx(5 + FADING, abs=1)


def test_a_fault_ends_at_once_and_says_why(bench: Bench) -> None:
    def faulted() -> None:
        bench.ending, bench.fault = Ending.FAULT, Fault.DUTY

    bench.at[3] = faulted
    found = bench.run()
    assert (found.ending, found.failed) == (Ending.FAULT, True)
    assert "duty limit" in found.message
    assert bench.steps == 3
    assert not any(isinstance(one, tuple) and one[0] == "fade" for one in bench.done)
    assert ("end", Ending.FAULT, found.message) in bench.done


def test_a_fault_while_it_fades_is_one_too(bench: Bench) -> None:
    def faulted() -> None:
        bench.ending, bench.fault = Ending.FAULT, Fault.HEAT

    bench.at[60] = faulted
    found = bench.run()
    assert found.ending is Ending.FAULT
    assert "heat limit" in found.message
    assert bench.steps == 60


@pytest.mark.parametrize("step", [4, 60])
@pytest.mark.parametrize(
    ("error", "ending"),
    [(DeviceError("it is gone"), Ending.LINK), (LoopError("it hangs"), Ending.LOOP)],
)
def test_what_breaks_is_told_and_the_device_is_ended(
    bench: Bench, error: Exception, ending: Ending, step: int
) -> None:
    bench.at[step] = error
    found = bench.run()
    assert (found.ending, found.message) == (ending, str(error))
    assert ("end", ending, str(error)) in bench.done
    assert bench.done[-5:] == [
        "loop stop", "drain", "judged", "record closed", "close serial:one",
    ]  # fmt: skip


@pytest.mark.parametrize("where", ["begin", "step"])
def test_what_nobody_expected_stops_the_device_and_the_loop(bench: Bench, where: str) -> None:
    error = RecordError("the disk is full")
    if where == "begin":
        bench.begins_with = error
    else:
        bench.at[2] = error
    with pytest.raises(RecordError):
        bench.run()
    assert bench.done[-4:] == ["host stop", "loop stop", "record closed", "close serial:one"]


def test_an_unsafe_drive_is_refused_before_the_loop_starts(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(*given: Any, **how: Any) -> None:
        assert (given[2], how) == ("study", {})
        raise InputError("it is not safe")

    monkeypatch.setattr(real_time, "require_safe_drive", refused)
    with pytest.raises(InputError):
        bench.run(use="study")
    assert bench.done == ["record closed", "close serial:one"]


def test_another_sensor_is_given_the_loops_clock(bench: Bench) -> None:
    clocks: list[Any] = []

    def made(clock: Any) -> str:
        clocks.append(clock())
        return "eyes"

    tap: Any = object()
    bench.run(sensor=made, tap=tap)
    assert clocks == [100.0]
    plan, _, _, writer, clock, eyes, tapped = bench.given
    assert (plan, writer, eyes, tapped) == (bench.plan, bench, "eyes", tap)
    assert clock() == bench.now
    bench.run()
    assert bench.given[5:] == (None, None)


def test_priority_is_asked_for_and_given_back_unless_it_is_a_twin(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    granted = [True, False]
    mine = SimpleNamespace(
        SCHED_OTHER=0, sched_getscheduler=lambda _: 0, sched_param=lambda number: number,
        sched_setscheduler=lambda *given: bench.note(("given back", given)),
    )  # fmt: skip
    monkeypatch.setattr(real_time, "os", mine)

    def asked(priority: int) -> bool:
        bench.note(("priority", priority))
        return granted.pop(0)

    monkeypatch.setattr(real_time, "real_time_granted", asked)
    bench.run()
    assert granted == [True, False]
    bench.plan.device.twin = False
    for given_back in (1, 0):
        bench.done.clear()
        bench.run()
        names = [one[0] if isinstance(one, tuple) else one for one in bench.done]
        assert names.count("priority") == 1
        assert names.index("loop start") < names.index("priority") < names.index("begin")
        assert names.count("given back") == given_back
        # This process, ordinary, without priority.
        assert not given_back or ("given back", (0, 0, 0)) in bench.done
    # Who has another order already keeps it.
    mine.sched_getscheduler = lambda _: 1
    bench.run()
    assert granted == []


def test_a_thread_that_is_not_the_first_hears_no_signals(bench: Bench) -> None:
    before = signal.getsignal(signal.SIGINT)
    endings: list[Ending] = []
    thread = threading.Thread(target=lambda: endings.append(bench.run().ending))
    thread.start()
    thread.join()
    assert endings == [Ending.DURATION]
    assert signal.getsignal(signal.SIGINT) is before
