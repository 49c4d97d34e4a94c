"""The link against a device that says what the test wants, byte by byte and when."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest

from squeezefilm.core.errors import DeviceError
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Deframer, Fault, Frame, Reason, State
from squeezefilm.instruments.device.wire.link import ATTEMPTS, WORDS, Link, LinkStatistics, refusal

Answers = Callable[[Frame, int], list[m.Message]]


class Device:
    """A stream whose answers come at once; its frames are numbered unless one says otherwise."""

    def __init__(self, answers: Answers | None = None) -> None:
        self.now = 100.0
        self.number = 0
        self.asked: list[Frame] = []
        self.waiting = bytearray()
        self.answers = answers
        self._deframer = Deframer()

    def clock(self) -> float:
        return self.now

    def wait(self, duration: float) -> None:
        self.now += duration

    def read(self) -> bytes:
        data = bytes(self.waiting)
        self.waiting.clear()
        return data

    def write(self, data: bytes) -> None:
        for frame in self._deframer.take(data):
            assert frame is not None
            self.asked.append(frame)
            if self.answers is not None:
                self.say(*self.answers(frame, len(self.asked)))

    def close(self) -> None:
        pass

    def say(self, *messages: m.Message, number: int | None = None) -> None:
        for message in messages:
            self.number = (self.number + 1) & 0xFFFF if number is None else number
            self.waiting += message.frame(self.number).encoded()

    def kinds(self) -> list[int]:
        return [frame.type for frame in self.asked]


def status(answered: int, **changes: int) -> m.Status:
    fields = {
        "answered_sequence": answered, "reason": Reason.ACCEPTED, "state": State.OFF,
        "fault": Fault.NONE, "reserved": 0, "token": 7, "level": 0, "accepted": 0, "refused": 0,
        "damaged": 0, "session": 1, "time": 1_000,
    }  # fmt: skip
    return m.Status(**{**fields, **{name: int(value) for name, value in changes.items()}})


def reading(time: int, **changes: int) -> m.Reading:
    fields = {
        "time": time, "x": 0, "y": 0, "touching": 1, "state": 0, "fault": 0, "flags": 0,
        "level": 0, "pickup": 0, "late_ticks": 0,
    }  # fmt: skip
    return m.Reading(**{**fields, **changes})


def linked(answers: Answers | None = None) -> tuple[Device, Link]:
    device = Device(answers)
    return device, Link(device, device.clock, device.wait)


STOP, ARM, KEEP = m.Stop.TYPE, m.Arm.TYPE, m.KeepAlive.TYPE


def test_an_answer_is_matched_by_the_number_of_what_it_answers() -> None:
    def answers(frame: Frame, _: int) -> list[m.Message]:
        return [status(frame.sequence - 1, token=1), reading(5), status(frame.sequence, token=2)]

    device, link = linked(answers)
    assert link.request(m.Stop()).token == 2
    assert device.kinds() == [STOP]
    # What came beside it waits for `poll`, in its order.
    assert [type(one) for one in link.poll()] == [m.Status, m.Reading, m.Status]
    assert link.poll() == []
    found = link.statistics
    assert (found.sent, found.answered, found.readings, found.repeated) == (1, 1, 1, 0)
    assert found.shortest_round_trip == found.longest_round_trip == 0.0


def test_what_may_be_done_twice_is_sent_again_until_it_is_answered() -> None:
    device, link = linked(lambda frame, n: [status(frame.sequence)] if n == 3 else [])
    began = device.now
    link.request(m.Stop(), timeout=0.8)
    assert device.kinds() == [STOP] * 3
    assert [frame.sequence for frame in device.asked] == [1, 2, 3]
    assert link.statistics.repeated == 2
    assert 0.2 <= device.now - began < 0.21


def test_a_device_that_never_answers_is_given_up_in_time() -> None:
    device, link = linked()
    began = device.now
    with pytest.raises(DeviceError, match=r"not answer Stop within 0\.4 s \(8 sent\)"):
        link.request(m.Stop(), timeout=0.4)
    assert device.kinds() == [STOP] * ATTEMPTS
    assert link.statistics.repeated == ATTEMPTS - 1
    assert 0.4 <= device.now - began < 0.41
    assert math.isnan(link.statistics.mean_round_trip)


@pytest.mark.parametrize(
    ("message", "goal"),
    [(m.Arm(3), State.ARMED), (m.Start(40_000_000), State.PLAYING), (m.ClearFault(1), State.OFF)],
)
def test_what_must_not_be_done_twice_is_asked_after_first(message: Any, goal: State) -> None:
    def answers(frame: Frame, _: int) -> list[m.Message]:
        # The first one worked, and its answer was lost.
        return [status(frame.sequence, state=goal)] if frame.type == KEEP else []

    device, link = linked(answers)
    found = link.request(message)
    assert found.state == goal
    assert device.kinds() == [message.TYPE, KEEP]
    assert link.statistics.repeated == 1


def test_where_it_did_not_arrive_it_is_sent_again() -> None:
    def answers(frame: Frame, n: int) -> list[m.Message]:
        if frame.type == KEEP:
            # The first word on the state is lost too.
            return [] if n == 2 else [status(frame.sequence, state=State.OFF)]
        return [status(frame.sequence, state=State.ARMED)] if n > 3 else []

    device, link = linked(answers)
    assert link.request(m.Arm(3)).state == State.ARMED
    assert device.kinds() == [ARM, KEEP, KEEP, ARM]
    assert link.statistics.repeated == 2


def test_a_frame_that_was_overtaken_is_sent_with_a_new_number() -> None:
    def answers(frame: Frame, n: int) -> list[m.Message]:
        return [status(frame.sequence, reason=Reason.SEQUENCE if n < 3 else Reason.ACCEPTED)]

    device, link = linked(answers)
    assert link.request(m.Stop()).reason == Reason.ACCEPTED
    assert device.kinds() == [STOP] * 3
    device, link = linked(lambda frame, _: [status(frame.sequence, reason=Reason.SEQUENCE)])
    with pytest.raises(DeviceError, match="refused Stop in state OFF: the frame is old"):
        link.request(m.Stop())
    assert link.statistics.refused == ATTEMPTS


def test_a_part_of_a_tile_that_had_arrived_is_no_error_when_it_is_repeated() -> None:
    part = m.TileData(0, (1.0, 2.0))

    def late(frame: Frame, n: int) -> list[m.Message]:
        return [status(frame.sequence, reason=Reason.TILE)] if n == 2 else []

    _, link = linked(late)
    assert link.request(part).reason == Reason.TILE
    for message, answers in (
        # Refused at the first try it is an error, and so is another reason, or another message.
        (part, lambda frame, _: [status(frame.sequence, reason=Reason.TILE)]),
        (part, lambda frame, n: [status(frame.sequence, reason=Reason.VALUE)] if n == 2 else []),
        (m.Stop(), late),
    ):
        _, link = linked(answers)
        with pytest.raises(DeviceError, match="refused"):
            link.request(message)


def test_the_watchdog_is_fed_while_an_answer_is_awaited() -> None:
    device, link = linked(lambda frame, _: [status(frame.sequence)] if frame.type == KEEP else [])
    with pytest.raises(DeviceError):
        link.request(m.Stop(), timeout=0.08)
    # Nothing is known of the device yet: no word for it.
    assert KEEP not in device.kinds()
    link.request(m.KeepAlive())
    count = len(device.asked)
    with pytest.raises(DeviceError):
        link.request(m.Stop(), timeout=0.8)
    # In each of 0.1 s, every 15 ms.
    fed = device.kinds()[count:].count(KEEP)
    assert 8 * 6 <= fed <= 8 * 7


def test_a_keep_alive_is_due_after_silence_only() -> None:
    device, link = linked()
    link.keep_alive(0.015)
    assert device.kinds() == [KEEP]
    device.now += 0.0149
    link.keep_alive(0.015)
    assert device.kinds() == [KEEP]
    device.now += 0.0002
    link.keep_alive(0.015)
    assert device.kinds() == [KEEP] * 2


def test_frames_that_come_twice_are_dropped_and_missing_ones_are_counted() -> None:
    device, link = linked()
    for number in (10, 11, 11, 14, 12, 13, 14, 15):
        device.say(reading(1_000 + number), number=number)
    came = link.poll()
    found = link.statistics
    assert found.doubled == 2
    # 12 and 13 came after 14: they were missed for a moment only, and are too old by then.
    assert (found.missed, found.stale) == (0, 2)
    assert [one.time for one in came if isinstance(one, m.Reading)] == [1010, 1011, 1014, 1015]
    device.say(reading(2_000), number=18)
    link.poll()
    assert link.statistics.missed == 2
    assert link.statistics.readings == 5
    # The same number with other content is another frame.
    device.say(reading(2_001), number=18)
    assert [one.time for one in link.poll()] == [2001]  # type: ignore[union-attr]


def test_numbers_and_clocks_that_wrap_are_newer() -> None:
    device, link = linked()
    device.say(reading(2**32 - 5), number=0xFFFF)
    device.say(reading(5), number=0)
    device.say(reading(5_000), number=1)
    assert [one.time for one in link.poll()] == [2**32 - 5, 5, 5_000]  # type: ignore[union-attr]
    assert link.statistics.missed == 0
    device.say(reading(5_000), number=2)
    assert link.poll() == []
    assert link.statistics.stale == 1


def test_only_so_many_frames_are_remembered() -> None:
    device, link = linked()
    for number in range(257):
        device.say(reading(number + 1), number=number)
    link.poll()
    # Of 257 the first is forgotten: it is no longer known as doubled, but still too old.
    device.say(reading(1), number=0)
    assert link.poll() == []
    assert (link.statistics.doubled, link.statistics.stale) == (0, 1)
    device.say(reading(3), number=2)
    assert link.poll() == []
    assert (link.statistics.doubled, link.statistics.stale) == (1, 1)


@pytest.mark.parametrize(
    ("later", "newest"), [(1, True), (0x7FFF, True), (0x8000, False), (0xFFFF, False)]
)
def test_the_newest_status_is_the_one_that_answers_the_newest_frame(
    later: int, newest: bool
) -> None:
    device, link = linked()
    device.say(status(60_000, token=1), status((60_000 + later) & 0xFFFF, token=2))
    link.poll()
    assert link.status is not None
    assert link.status.token == (2 if newest else 1)


def test_what_is_no_message_is_counted() -> None:
    device, link = linked()
    device.waiting += Frame(0x7F, 1, b"").encoded() + Frame(m.Status.TYPE, 2, b"short").encoded()
    device.waiting += b"\x05noise\x00"
    device.say(reading(1), number=3)
    assert len(link.poll()) == 1
    assert (link.statistics.unknown, link.statistics.damaged) == (2, 1)
    # What was dropped before does not make the count forget.
    link.drop()
    assert link.statistics.damaged == 1


def test_dropping_forgets_what_came_and_what_was_known() -> None:
    device, link = linked(lambda frame, _: [status(frame.sequence, reason=Reason.VALUE)])
    link.send(m.Stop())
    link.poll()
    device.say(reading(5), number=9)
    assert link.refusals
    assert link.device_clock.known
    link.drop()
    assert link.poll() == []
    assert link.status is None
    assert not link.refusals
    assert not link.device_clock.known
    # Neither a number nor a time of before is held against what comes.
    device.say(reading(5), number=9)
    assert len(link.poll()) == 1
    assert link.statistics.missed == link.statistics.doubled == link.statistics.stale == 0


def test_all_that_waits_is_read_when_it_is_dropped() -> None:
    device, link = linked()
    pieces = [b"\x01\x02", b"\x03", b""]
    device.read = lambda: pieces.pop(0) if pieces else b""  # type: ignore[method-assign]
    link.drop()
    assert pieces == []


def test_an_answer_that_does_not_come_within_a_second_is_lost() -> None:
    device, link = linked()
    first, second = link.send(m.Stop()), link.send(m.Stop())
    device.now += 0.6
    third = link.send(m.Stop())
    device.now += 0.4
    link.poll()
    assert link.statistics.lost == 0
    device.now += 1e-3
    device.say(status(second))
    link.poll()
    # The first is lost; the answer to the second came after all, before it was given up.
    assert (link.statistics.lost, link.statistics.answered) == (1, 1)
    device.say(status(first), status(third))
    link.poll()
    # Too late to be timed.
    assert (link.statistics.lost, link.statistics.answered) == (1, 2)
    assert link.statistics.longest_round_trip == pytest.approx(1.001)
    assert link.statistics.shortest_round_trip == pytest.approx(0.401)


def test_a_refusal_is_kept_with_the_name_of_what_was_refused() -> None:
    device, link = linked(lambda frame, _: [status(frame.sequence, reason=Reason.FULL)])
    link.send(m.Position(5))
    link.poll()
    assert [(name, said.reason) for name, said in link.refusals] == [("Position", Reason.FULL)]
    device.say(status(999, reason=Reason.TYPE))
    link.poll()
    assert link.refusals[-1][0] == "a frame"
    assert link.statistics.refused == 2


def test_the_mean_round_trip_is_the_mean() -> None:
    found = LinkStatistics()
    for duration in (0.2, 0.1, 0.6):
        found.count_round_trip(duration)
    assert found.answered == 3
    assert found.mean_round_trip == pytest.approx(0.3)
    assert (found.shortest_round_trip, found.longest_round_trip) == (0.1, 0.6)


def test_a_refusal_says_state_and_reason_also_where_they_are_not_known() -> None:
    assert set(WORDS) == set(Reason)
    for reason, words in WORDS.items():
        found = str(refusal("Arm", status(1, reason=reason, state=State.ARMED)))
        assert found == f"the device refused Arm in state ARMED: {words}"
    found = str(refusal("Arm", status(1, reason=99, state=9)))
    assert found.startswith("the device refused Arm in state 9: reason 99, which this program")
    faulted = status(1, reason=Reason.STATE, state=State.FAULT, fault=Fault.LATE_TICK)
    assert "in state FAULT (late tick):" in str(refusal("Arm", faulted))
    tripped = status(1, reason=Reason.STATE, state=State.FAULT, fault=Fault.TRIPPED)
    assert "in state FAULT (tripped):" in str(refusal("Arm", tripped))
    newer = status(1, reason=Reason.STATE, state=State.FAULT, fault=77)
    assert "in state FAULT:" in str(refusal("Arm", newer))
