"""A host whose device says what the test wants: other sessions, no word of what it is, no rest."""

from __future__ import annotations

import dataclasses
from collections import deque
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.drive_limits import Limits
from squeezefilm.core.errors import DeviceError, InputError
from squeezefilm.instruments.device.host import MOST_READINGS, DeviceHost
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Fault, Reason, State

LIMITS = Limits(60.0, 10_000.0, 30.0, 5.0, 20e3, 60e3, duty=0.8, insulation="glass")
# A firmware that allows exactly these.
INFO = m.Info(
    60_000_000, 10_000, 30_000_000, 5_000, 20_000_000, 60_000_000, 800, 10_000, 100, 1, 1, 512, 1
)


def status(**changes: Any) -> m.Status:
    fields = {
        "answered_sequence": 1, "reason": Reason.ACCEPTED, "state": State.OFF, "fault": Fault.NONE,
        "reserved": 0, "token": 9, "level": 0, "accepted": 0, "refused": 0, "damaged": 0,
        "session": 77, "time": 0,
    }  # fmt: skip
    return m.Status(**{**fields, **{name: int(value) for name, value in changes.items()}})


def reading(time: int) -> m.Reading:
    return m.Reading(time, 0, 0, 1, 0, 0, 0, 0, 0, 0)


class Link:
    """A link whose requests are answered by a function; time is what waiting takes."""

    def __init__(self, info: m.Info | None = INFO, after: int = 1, **said: Any) -> None:
        self.asked: list[m.Message] = []
        self.said, self.info, self.after = said, info, after
        self.levels: list[int] = []
        self.came: list[Any] = []
        self.refusals: deque[tuple[str, m.Status]] = deque()
        self.status: m.Status | None = None
        self.device_clock = SimpleNamespace()
        self.now = 5.0

    def drop(self) -> None:
        self.asked.append(None)  # type: ignore[arg-type]

    def request(self, message: m.Message) -> m.Status:
        self.asked.append(message)
        if isinstance(message, m.AskInfo):
            self.after -= 1
            if self.after == 0 and self.info is not None:
                self.came.append(self.info)
        level = self.levels.pop(0) if isinstance(message, m.KeepAlive) and self.levels else 0
        self.status = status(level=level, **self.said)
        return self.status

    def poll(self) -> list[Any]:
        came, self.came = self.came, []
        return came

    def clock(self) -> float:
        return self.now

    def wait(self, duration: float) -> None:
        self.now += duration

    def kinds(self) -> list[str]:
        return ["drop" if one is None else type(one).__name__ for one in self.asked]


def host_of(link: Link) -> DeviceHost:
    return DeviceHost(link, session=77)  # type: ignore[arg-type]


def test_opening_stops_says_hello_waits_for_zero_and_sets_the_limits() -> None:
    link = Link()
    link.levels = [3, 1, 0]
    host = host_of(link)
    assert host.open(LIMITS) == INFO
    assert link.kinds() == [
        "drop", "Stop", "Hello", "KeepAlive", "KeepAlive", "KeepAlive", "AskInfo", "SetLimits",
    ]  # fmt: skip
    assert link.asked[2] == m.Hello(77)
    assert link.asked[-1] == m.limits_message(LIMITS)


def test_a_device_that_answers_for_another_session_is_anothers() -> None:
    with pytest.raises(DeviceError, match="for session 78 and 77 was opened"):
        host_of(Link(session=78)).open(LIMITS)
    link = Link()
    host = host_of(link)
    host.open(LIMITS)
    assert host.poll() == []
    link.status = status(session=78)
    for call in (host.poll, host.pump):
        with pytest.raises(DeviceError, match="answers for session 78 and not 77"):
            call()


def test_an_output_that_does_not_come_to_rest_is_told_after_its_time() -> None:
    link = Link()
    link.levels = [42_500_000] * 1000
    began = link.now
    with pytest.raises(DeviceError, match=r"still 42\.5 V after 0\.2 s; switch its amplifier off"):
        host_of(link).open(LIMITS)
    assert 0.2 < link.now - began < 0.203


@pytest.mark.parametrize("after", [1, 2, 3])
def test_what_the_device_is_is_asked_three_times(after: int) -> None:
    link = Link(after=after)
    began = link.now
    host_of(link).open(LIMITS)
    assert link.kinds().count("AskInfo") == after
    # Each word is waited for as long as an output's rest.
    assert link.now - began == pytest.approx(0.2 * (after - 1), abs=3e-3 * after)


def test_a_device_that_is_opened_again_is_asked_again() -> None:
    link = Link()
    host = host_of(link)
    host.open(LIMITS)
    link.info, link.after = dataclasses.replace(INFO, firmware_version=2), 2
    assert host.open(LIMITS).firmware_version == 2


def test_a_device_that_does_not_say_what_it_is_is_too_old() -> None:
    link = Link(info=None)
    with pytest.raises(DeviceError, match="does not say what it is"):
        host_of(link).open(LIMITS)
    assert link.kinds().count("AskInfo") == 3


@pytest.mark.parametrize(
    ("field", "words"),
    [
        ("voltage", "voltage is 60 V and .* at most 59 V"),
        ("slew", "slew is 10000 V/s and .* at most 9999 V/s"),
        ("continuous_voltage", "continuous_voltage is 30 V and .* at most 29 V"),
        ("heat", r"heat is 5 V2\*s and .* at most 4\.999 V2\*s"),
        ("highest_frequency", "highest_frequency is 60000 Hz and .* at most 59999 Hz"),
        ("duty", r"duty is 0\.8  and .* at most 0\.799"),
        ("duty_window", r"duty_window is 10 s and .* at most 9\.999 s"),
        ("lowest_frequency", "lowest_frequency is 20000 Hz and .* at least 20001 Hz"),
    ],
)
def test_each_limit_beyond_the_firmwares_own_is_named(field: str, words: str) -> None:
    step = {
        "voltage": -1_000_000, "continuous_voltage": -1_000_000, "highest_frequency": -1000,
        "lowest_frequency": 1000,
    }.get(field, -1)  # fmt: skip
    own = dataclasses.replace(INFO, **{field: getattr(INFO, field) + step})
    link = Link(info=own)
    with pytest.raises(DeviceError, match=words):
        host_of(link).open(LIMITS)
    assert "SetLimits" not in link.kinds()


@pytest.mark.parametrize("fault", [Fault.WATCHDOG, Fault.HEAT, 77])
def test_only_a_watchdog_of_an_earlier_session_is_cleared(fault: int) -> None:
    link = Link(state=State.FAULT, fault=fault)
    host = host_of(link)
    if fault == Fault.WATCHDOG:
        host.open(LIMITS)
        assert m.ClearFault(Fault.WATCHDOG) in link.asked
        return
    name = "heat" if fault == Fault.HEAT else "77"
    with pytest.raises(DeviceError, match=f"has the fault '{name}' of an earlier"):
        host.open(LIMITS)
    assert "ClearFault" not in link.kinds()


def test_readings_wait_for_who_asks_and_only_the_newest_are_kept() -> None:
    link = Link()
    host = host_of(link)
    link.came = [reading(1), INFO, reading(2)]
    assert [one.time for one in host.poll()] == [1, 2]
    assert host.info == INFO
    assert host.poll() == []
    link.came = [reading(time) for time in range(MOST_READINGS + 5)]
    assert [one.time for one in host.poll()] == list(range(5, MOST_READINGS + 5))


@pytest.mark.parametrize(
    ("name", "reason", "raises"),
    [
        ("Envelope", Reason.VALUE, True), ("TimedEnvelope", Reason.VALUE, True),
        ("Position", Reason.TILE, True), ("Position", Reason.STATE, False),
        ("Envelope", Reason.SEQUENCE, False), ("TimedEnvelope", Reason.FULL, False),
        ("KeepAlive", Reason.VALUE, False),
    ],
)  # fmt: skip
def test_a_refusal_that_asking_later_does_not_mend_is_raised(
    name: str, reason: Reason, raises: bool
) -> None:
    link = Link()
    host = host_of(link)
    link.refusals.append((name, status(reason=reason)))
    # Of before it was opened nothing is held against it.
    assert host.poll() == []
    host.open(LIMITS)
    link.refusals.append((name, status(reason=reason)))
    if raises:
        with pytest.raises(DeviceError, match=f"refused {name}"):
            host.poll()
    assert host.poll() == []


@pytest.mark.parametrize("count", [1, m.MOST_LEVELS, m.MOST_LEVELS + 1, m.LONGEST_TILE])
def test_a_tile_goes_over_in_frames_that_say_where_they_begin(count: int) -> None:
    link = Link()
    levels = np.linspace(0.0, 10.0, count).astype(np.float32)
    host_of(link).load_tile(-1.5e-3, 25e-6, levels)
    begin, *data = link.asked
    assert begin == m.TileBegin(-1500, 25, count)
    firsts, sent = [], []
    for frame in data:
        assert isinstance(frame, m.TileData)
        first, volts = dataclasses.astuple(frame)
        firsts.append(first)
        sent += volts
    assert firsts == list(range(0, count, m.MOST_LEVELS))
    np.testing.assert_array_equal(sent, levels)


def test_a_tile_of_none_or_too_many_is_refused_whole() -> None:
    link = Link()
    for count in (0, m.LONGEST_TILE + 1):
        with pytest.raises(InputError, match=f"a tile of {count} amplitudes; 1 to 512 fit"):
            host_of(link).load_tile(0.0, 1e-3, np.zeros(count))
    assert link.asked == []


def test_a_device_without_a_fault_has_nothing_to_clear() -> None:
    link = Link()
    host_of(link).clear()
    assert link.kinds() == ["KeepAlive"]
    failed = Link(state=State.FAULT, fault=3)
    failed.levels = [2, 1, 0]
    host_of(failed).clear()
    assert failed.kinds() == [*["KeepAlive"] * 3, "ClearFault"]
    assert failed.asked[-1] == m.ClearFault(3)
