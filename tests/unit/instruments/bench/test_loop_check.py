"""The check of a loop: what it is fed while it runs, and how what it did is judged."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.instruments.bench import timing_checks
from squeezefilm.instruments.bench.timing_checks import check_loop, loop_lateness, loop_result
from squeezefilm.instruments.session.loop.plan import LoopPlan
from squeezefilm.instruments.session.loop.shared import CLASSES, Lateness, lateness_class


def lateness(made: int, lost: int, late_ns: float = 12_000.0) -> Lateness:
    counts = np.zeros(CLASSES, dtype=np.int64)
    counts[lateness_class(late_ns)] = made
    return Lateness(5e3, made, lost, late_ns * 1e-9, counts)


class Loop:
    """A loop that only notes what is asked of it, on a clock that sleeping moves."""

    made: list[Loop]

    def __init__(self, plan: LoopPlan) -> None:
        self.plan, self.now = plan, 0.0
        self.samples: list[Any] = []
        self.taken: list[str] = []
        self.open = False
        Loop.made.append(self)

    def __enter__(self) -> Loop:
        self.open = True
        return self

    def __exit__(self, *_: object) -> None:
        self.open = False

    @property
    def time(self) -> float:
        return self.now

    def feed(self, samples: Any) -> int:
        assert self.open
        self.samples.append(samples)
        return len(samples)

    def take_commands(self) -> None:
        self.taken.append("commands")

    def take_rows(self) -> None:
        self.taken.append("rows")

    def report(self) -> Any:
        # Of the whole run: only after its process has ended.
        assert not self.open
        return SimpleNamespace(lateness=lateness(100, 0))


@pytest.fixture
def loops(monkeypatch: pytest.MonkeyPatch) -> list[Loop]:
    Loop.made = []

    def sleep(duration: float) -> None:
        assert duration == 1e-3
        Loop.made[-1].now += 0.25

    clock = SimpleNamespace(monotonic=lambda: 50.0 + Loop.made[-1].now, sleep=sleep)
    monkeypatch.setattr(timing_checks, "LoopProcess", Loop)
    monkeypatch.setattr(timing_checks, "time", clock)
    return Loop.made


def test_a_loop_is_led_to_and_fro_for_so_long_and_nothing_is_kept(loops: list[Loop]) -> None:
    found = loop_lateness(4e3, 2.5)
    (loop,) = loops
    assert found.made == 100
    assert loop.plan.rate == 4e3
    # Each 0.25 s for 2.5 s.
    assert len(loop.samples) == 10
    assert loop.taken == ["commands", "rows"] * 10
    rows = np.concatenate(loop.samples)
    assert rows.shape == (10, 6)
    moments = 0.25 * np.arange(10)
    np.testing.assert_allclose(rows[:, 0], moments)
    # 60 mm/s along x, from the beginning again each second.
    np.testing.assert_allclose(rows[:, 1], 0.06 * (moments % 1.0))
    assert np.all(rows[:, 2] == 0.0)
    assert np.all(rows[:, 3] == 1.0)
    assert np.all(np.isnan(rows[:, 4:]))


def test_the_plan_is_one_that_a_loop_has_work_with(loops: list[Loop]) -> None:
    loop_lateness(5e3, 0.25)
    plan = loops[0].plan
    assert plan.program.wanted_depends_on == {"x"}
    assert plan.voltage_limit == pytest.approx(1.0)
    assert plan.envelope.amplitude_limit == pytest.approx(1e-6)
    assert plan.compensation == "none"


def test_what_the_computers_host_took_meanwhile_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[float, float]] = []
    stolen = [7.0, 7.25]

    def late(rate: float, duration: float) -> Lateness:
        asked.append((rate, duration))
        return lateness(10_000, 500)

    monkeypatch.setattr(timing_checks, "stolen_time", lambda: stolen.pop(0))
    monkeypatch.setattr(timing_checks, "loop_lateness", late)
    found = check_loop(5e3)
    assert asked == [(5e3, 3.0)]
    assert found == loop_result(lateness(10_000, 500), 0.25)
    assert "its host took 250 ms" in found.measured


def test_a_result_says_what_was_measured_and_what_is_allowed() -> None:
    # 9900 of 10 000 is as few as are allowed.
    found = loop_result(lateness(9_900, 100, 40_000.0), 0.0)
    assert (found.name, found.passed, found.allowed, found.advice) == (
        "loop", True, "at least 99 % made", "",
    )  # fmt: skip
    assert found.measured == ("99.00 % of 10000 ticks at 5000 Hz; late 40 µs median, 40 µs at 99 %")
    missed = loop_result(lateness(9_899, 101), 0.0)
    assert not missed.passed
    assert "real-time priority" in missed.advice
    # One tick too few is 0.2 ms: that much the host may have taken.
    assert "host of this virtual" in loop_result(lateness(9_899, 101), 0.3e-3).advice
    assert "real-time priority" in loop_result(lateness(9_899, 101), 0.1e-3).advice


@pytest.mark.parametrize(
    ("text", "waited"),
    [
        ("some avg10=0.00 avg60=0.00 avg300=0.00 total=2500000\nfull avg10=0 total=9\n", 2.5),
        ("some avg10=0.00", 0.0),
        ("some avg10=0.00 avg60=0.00 avg300=0.00 total=much\n", 0.0),
        (None, 0.0),
    ],
)
def test_the_time_that_programs_waited_is_what_the_system_tells(
    text: str | None, waited: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[str] = []

    class Told:
        def __init__(self, path: str) -> None:
            asked.append(path)

        def read_text(self) -> str:
            if text is None:
                raise FileNotFoundError
            return text

    monkeypatch.setattr(timing_checks, "Path", Told)
    monkeypatch.setattr(timing_checks, "stolen_time", lambda: 0.25)
    assert timing_checks.waited_time() == pytest.approx(waited + 0.25)
    assert asked == ["/proc/pressure/cpu"]
