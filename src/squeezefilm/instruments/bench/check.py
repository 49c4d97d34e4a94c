"""Checks that a device does what the protocol promises: link, timing, limits, watchdog, readings.

Each check drives the device itself and says what it measured, what is allowed and what to do. They
never ask for more than `TEST_VOLTAGE`, so that a device that fails them does no harm.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.drive_limits import Limits
from squeezefilm.core.errors import DeviceError
from squeezefilm.instruments.bench.conversation import Conversation
from squeezefilm.instruments.device.machine.playing import CLOCK
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.states import Fault, Reason, State
from squeezefilm.instruments.session.play.plan import REPORT_PERIOD

TEST_VOLTAGE: si.Volt = 1.0
"""The most that a check may ask of a device."""
ZERO_WITHIN: si.Second = 60e-3
"""Longest time from the last accepted frame to an output at zero, on the device's clock."""
SLOWEST_ROUND_TRIP: si.Second = 25e-3
"""Half of the watchdog's patience: one lost frame must not stop the device."""
_ECHOES = 300
_KEEP_ALIVE: si.Second = 20e-3


@dataclass(frozen=True, slots=True)
class CheckResult:
    """A check: its name, whether it passed, what was measured, what is allowed, what to do.

    `advice` is empty where the check passed.
    """

    name: str
    passed: bool
    measured: str
    allowed: str
    advice: str = ""


@dataclass(frozen=True, slots=True)
class DeviceCheck:
    """All checks of one device."""

    drive: str
    results: tuple[CheckResult, ...]

    @property
    def passed(self) -> bool:
        """True where every check passed."""
        return all(result.passed for result in self.results)


def check_device(
    talk: Conversation,
    frequency: si.Hertz,
    *,
    drive: str,
    window: tuple[si.Hertz, si.Hertz] | None = None,
    loop: Callable[[], CheckResult] | None = None,
    progress: Callable[[str], None] | None = None,
) -> DeviceCheck:
    """Run every check on a device; leaves it OFF, without a fault and without reports.

    Args:
        talk: the conversation; nobody else may use its stream meanwhile.
        frequency: a carrier that its plate may be driven with (Hz).
        drive: what to call it.
        window: frequencies that the limits allow (Hz); 1 % around the frequency without one.
        loop: checks this computer's loop; left out without it.
        progress: is told each step.

    Raises:
        DeviceError: a device that does not answer at all, or does not begin a session.
    """
    tell = progress or (lambda _: None)
    low, high = window or (0.99 * frequency, 1.01 * frequency)
    limits = Limits(TEST_VOLTAGE, 1000 * TEST_VOLTAGE, TEST_VOLTAGE, 10.0, low, high)
    tell("a session on the device")
    _begin(talk, limits)
    results: list[CheckResult] = []
    tell("link and round trip")
    results += link_checks(talk)
    tell("readings")
    results += reading_checks(talk)
    tell("limits")
    results += limit_checks(talk, limits, frequency)
    tell("stop in every state")
    results.append(stop_check(talk, frequency))
    tell("watchdog")
    results += watchdog_checks(talk, frequency)
    if loop is not None:
        tell("the loop of this computer")
        results.append(loop())
    _make_quiet(talk)
    return DeviceCheck(drive, tuple(results))


def link_checks(talk: Conversation, echoes: int = _ECHOES) -> list[CheckResult]:
    """Every frame answered once and undamaged, and how long an answer takes (s)."""
    damaged, trips = talk.damaged, []
    for _ in range(echoes):
        start = talk.clock()
        if talk.ask(m.KeepAlive(), 0.2) is not None:
            trips.append(talk.clock() - start)
    lost, hurt = echoes - len(trips), talk.damaged - damaged
    middle, worst = (
        (float(q) for q in np.quantile(trips, [0.5, 0.99])) if trips else (math.inf, math.inf)
    )
    return [
        _result(
            "link",
            lost == 0 and hurt == 0,
            f"{lost} of {echoes} frames unanswered, {hurt} answers damaged",
            "0 and 0",
            "shorten the cable, lower the baud rate, or use another USB port",
        ),
        _result(
            "round trip",
            worst <= SLOWEST_ROUND_TRIP,
            f"{_ms(middle)} median, {_ms(worst)} at 99 %",
            f"at most {_ms(SLOWEST_ROUND_TRIP)} at 99 %",
            "lower the latency timer of the USB adapter (1 ms), or use one with native USB",
        ),
    ]


def reading_checks(talk: Conversation, duration: si.Second = 0.5) -> list[CheckResult]:
    """Readings as often as asked for, on a clock that runs with this one, of a finger sensor."""
    talk.ask(m.Report(round(REPORT_PERIOD * 1e6)))
    start = talk.clock()
    came = [
        (one.time, one.message)
        for one in talk.listen_for(duration, _KEEP_ALIVE)
        if isinstance(one.message, m.Reading)
    ]
    elapsed = talk.clock() - start
    talk.ask(m.Report(0))
    wanted = elapsed / REPORT_PERIOD
    stamps = np.array([reading.time for _, reading in came], dtype=np.int64)
    # The device's clock has 32 bits of microseconds.
    steps = np.diff(stamps) & CLOCK
    backwards = int(np.count_nonzero((steps == 0) | (steps > CLOCK // 2)))
    drift = math.nan
    if len(came) > 30 and not backwards:
        since = np.concatenate([[0], np.cumsum(steps)]) * 1e-6
        heard = np.array([time for time, _ in came])
        # What came soonest of each third: a message can only be late.
        third = len(came) // 3
        delay = heard - since
        first, last = int(np.argmin(delay[:third])), int(np.argmin(delay[-third:])) - third
        drift = float((since[last] - since[first]) / (heard[last] - heard[first])) - 1
    seen = bool(came) and bool(came[-1][1].flags & m.SENSOR_PRESENT)
    return [
        _result(
            "readings",
            abs(len(came) - wanted) <= 0.05 * wanted + 3,
            f"{len(came)} in {elapsed:.3g} s",
            f"{wanted:.0f} within 5 %",
            "the link is too slow for so many: raise the baud rate; or the firmware's tick is late",
        ),
        _result(
            "device clock",
            not backwards and abs(drift) <= 0.02,
            f"{backwards} steps that do not rise, {100 * drift:+.2f} % against this clock",
            "0, within 2 %",
            "the firmware's microsecond clock is not one; see docs/reference/device.md",
        ),
        _result(
            "finger sensor",
            seen,
            "present" if seen else "none",
            "present, for sensor device",
            "without one play with sensor replay:FILE; else connect it and look at the firmware",
        ),
    ]


def limit_checks(talk: Conversation, limits: Limits, frequency: si.Hertz) -> list[CheckResult]:
    """Check that what lies outside the limits is refused whole, and the output stays at zero."""
    first = talk.ask(m.KeepAlive())
    token = 0 if first is None else first.token
    wrong = m.Arm(token ^ 1).payload()
    results = [_refusal(talk, "wrong token", m.Arm.TYPE, wrong, Reason.TOKEN)]
    _arm(talk)
    for name, frequency_mHz in (
        ("frequency above its window", math.ceil(limits.highest_frequency * 1e3) + 1),
        ("frequency below its window", math.floor(limits.lowest_frequency * 1e3) - 1),
    ):
        payload = m.Start(frequency_mHz).payload()
        results.append(_refusal(talk, name, m.Start.TYPE, payload, Reason.VALUE))
    _start(talk, frequency)
    good, over = 0.5 * limits.voltage, 1.01 * limits.voltage
    envelope = m.Envelope.TYPE
    for name, levels in (
        ("voltage above its limit", (good, good, over)),
        ("voltage below zero", (good, -good)),
        ("voltage not a number", (good, math.nan)),
        ("voltage infinite", (good, math.inf)),
    ):
        results.append(_refusal(talk, name, envelope, _envelope(levels), Reason.VALUE))
    stale, old = _envelope((0.5 * TEST_VOLTAGE,)), (talk.sequence - 3) & 0xFFFF
    results += [
        _refusal(talk, "an old sequence number", envelope, stale, Reason.SEQUENCE, old),
        _refusal(talk, "frame of a wrong length", m.Start.TYPE, b"\1\2\3", Reason.LENGTH),
    ]
    talk.ask(m.Stop())
    return results


def stop_check(talk: Conversation, frequency: si.Hertz) -> CheckResult:
    """Stop is taken in OFF, ARMED, PLAYING and FAULT, whatever its sequence number."""
    refused = []

    def stops(where: State) -> None:
        # An old number on purpose: stop must never depend on one.
        number = talk.send(m.Stop(), (talk.sequence - 7) & 0xFFFF)
        status = talk.answer(number)
        if status is None or status.reason != Reason.ACCEPTED:
            refused.append(where.name)

    stops(State.OFF)
    _arm(talk)
    stops(State.ARMED)
    _arm(talk)
    _start(talk, frequency)
    stops(State.PLAYING)
    _arm(talk)
    talk.listen_for(2 * ZERO_WITHIN)
    stops(State.FAULT)
    _clear(talk)
    return _result(
        "stop in every state",
        not refused,
        "refused in " + ", ".join(refused) if refused else "accepted in all four",
        "accepted in all four",
        "do not use this firmware: stop must always work",
    )


def watchdog_checks(talk: Conversation, frequency: si.Hertz) -> list[CheckResult]:
    """Silence takes the output to zero within 60 ms of the last frame, and is latched."""
    talk.ask(m.Report(round(REPORT_PERIOD * 1e6)))
    _arm(talk)
    _start(talk, frequency)
    level = 0.5 * TEST_VOLTAGE
    talk.ask(m.Envelope(1000, (level,)))
    talk.listen_for(2 * _KEEP_ALIVE, _KEEP_ALIVE)
    accepted = talk.ask(m.KeepAlive())
    readings = [
        heard.message
        for heard in talk.listen_for(2.5 * ZERO_WITHIN)
        if isinstance(heard.message, m.Reading)
    ]
    played, zero = False, math.inf
    if accepted is not None:
        played = accepted.level > 0
        for reading in readings:
            since = (reading.time - accepted.time) & CLOCK
            if reading.level == 0 and since <= CLOCK // 2:
                zero = since * 1e-6
                break
    allowed = ZERO_WITHIN + REPORT_PERIOD
    silent = _result(
        "watchdog",
        played and zero <= allowed,
        (f"zero {_ms(zero)} after the last frame" if math.isfinite(zero) else "not at zero")
        if played
        else "the output never rose",
        f"within {_ms(allowed)} on the device's clock, a reading's period included",
        "do not play on this device: its output must fall to zero when the host falls silent",
    )
    wrong = []
    for name, message, reason in (
        ("envelope", m.Envelope(1000, (level,)), Reason.STATE),
        ("start", m.Start(round(frequency * 1e3)), Reason.STATE),
        ("clearing another fault", m.ClearFault(Fault.HEAT), Reason.VALUE),
    ):
        status = talk.ask(message)
        if status is None or status.reason != reason or status.state != State.FAULT:
            wrong.append(name)
    named = talk.ask(m.KeepAlive())
    fault = Fault.NONE if named is None else Fault(named.fault)
    cleared = _clear(talk)
    talk.ask(m.Report(0))
    latched = _result(
        "watchdog latches",
        not wrong and fault is Fault.WATCHDOG and cleared,
        f"fault {fault.name.lower()}"
        + (f"; not refused: {', '.join(wrong)}" if wrong else "; all refused until cleared")
        + ("" if cleared else "; cannot be cleared"),
        "fault watchdog; all refused until cleared",
        "do not play on this device: after a fault only clearing it by name may let it play",
    )
    return [silent, latched]


def _begin(talk: Conversation, limits: Limits) -> None:
    talk.listen()
    if talk.ask(m.Stop(), 1.0) is None:
        raise DeviceError(
            "the device does not answer; check that it is switched on, that the port is its own, "
            "and that it runs the squeezefilm firmware"
        )
    status = talk.ask(m.Hello(0xC0FFEE))
    if status is not None and status.state == State.FAULT:
        _clear(talk)
    talk.ask(m.Report(0))
    talk.listen_for(STOP_TIME)
    status = talk.ask(m.limits_message(limits))
    if status is None or status.reason != Reason.ACCEPTED:
        word = "did not answer" if status is None else f"said {Reason(status.reason).name.lower()}"
        raise DeviceError(
            f"the device {word} to the test's limits of {TEST_VOLTAGE:g} V; its own limits must "
            "allow them and the display's frequency"
        )


STOP_TIME: si.Second = 20e-3
"""Time for an output that is stopping to reach zero."""


def _make_quiet(talk: Conversation) -> None:
    talk.ask(m.Report(0))
    talk.ask(m.Stop())
    talk.listen()


def _clear(talk: Conversation) -> bool:
    status = talk.ask(m.KeepAlive())
    if status is None:
        return False
    status = talk.ask(m.ClearFault(status.fault))
    return status is not None and status.reason == Reason.ACCEPTED and status.state == State.OFF


def _arm(talk: Conversation) -> None:
    talk.listen_for(STOP_TIME)
    status = talk.ask(m.KeepAlive())
    if status is not None:
        talk.ask(m.Arm(status.token))


def _start(talk: Conversation, frequency: si.Hertz) -> None:
    talk.ask(m.Start(round(frequency * 1e3)))


def _envelope(levels: Sequence[float]) -> bytes:
    """An envelope's payload with whatever levels, also those that no host can send."""
    return struct.pack(f"<HB{len(levels)}f", 1000, len(levels), *levels)


def _refusal(
    talk: Conversation,
    name: str,
    kind: int,
    payload: bytes,
    reason: Reason,
    sequence: int | None = None,
) -> CheckResult:
    """Check that a payload of a kind is refused for a reason, and the output stays at zero."""
    status = talk.answer(talk.send_raw(kind, payload, sequence))
    # Time for an output that should not be there to show.
    talk.listen_for(3e-3)
    after = talk.ask(m.KeepAlive())
    level = 0 if after is None else after.level
    said = "no answer" if status is None else Reason(status.reason).name.lower()
    return _result(
        f"refused: {name}",
        status is not None and status.reason == reason and after is not None and level == 0,
        f"{said}; output {level * 1e-6:g} V",
        f"{reason.name.lower()}; output 0 V",
        "do not use this firmware: it must refuse this frame whole",
    )


def _result(name: str, passed: bool, measured: str, allowed: str, advice: str) -> CheckResult:
    return CheckResult(name, bool(passed), measured, allowed, "" if passed else advice)


def _ms(value: si.Second) -> str:
    return f"{1e3 * value:.3g} ms"
