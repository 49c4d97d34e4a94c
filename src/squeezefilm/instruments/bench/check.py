"""Checks that a device does what the protocol promises: link, timing, limits, watchdog, readings.

Each check drives the device itself and says what it measured, what is allowed and what to do. They
never ask for more than `TEST_VOLTAGE`, so that a device that fails them does no harm.

A device is judged by its own clock. Where one stopped by itself, or was slow, and this computer
was held up for long enough to be the reason, the check is made again, and in the end is in doubt.
What was accepted, or played, and must not be, is never excused.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.drive_limits import Limits
from squeezefilm.core.errors import DeviceError
from squeezefilm.instruments.bench.conversation import Conversation
from squeezefilm.instruments.bench.timing_checks import (
    CheckResult,
    DeviceCheck,
    in_ms,
    reading_checks,
    sensor_checks,
)
from squeezefilm.instruments.device.machine.playing import CLOCK
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.device.wire.frames import Fault, Reason, State
from squeezefilm.instruments.device.wire.link import ANSWER_LIMIT
from squeezefilm.instruments.session.play.plan import REPORT_PERIOD
from squeezefilm.physics.render.motion.estimator import LVDT_10_KHZ, SensorModel

TEST_VOLTAGE: si.Volt = 1.0
"""The most that a check may ask of a device."""
ZERO_WITHIN: si.Second = 60e-3
"""Longest time from the last accepted frame to an output at zero, on the device's clock."""
SLOWEST_ROUND_TRIP: si.Second = 25e-3
"""Half of the watchdog's patience: one lost frame must not stop the device."""
WATCHED: si.Second = 2.5
_ECHOES = 300
_MOST_LOST = 5
_TRIES = 8


def check_device(
    talk: Conversation,
    frequency: si.Hertz,
    *,
    drive: str,
    window: tuple[si.Hertz, si.Hertz] | None = None,
    sensor: SensorModel = LVDT_10_KHZ,
    watch: si.Second = WATCHED,
    truth: Callable[[si.SecondArray], si.MetreArray] | None = None,
    loop: Callable[[], CheckResult] | None = None,
    progress: Callable[[str], None] | None = None,
) -> DeviceCheck:
    """Run every check on a device; leaves it OFF, without a fault and without reports.

    Args:
        talk: the conversation; nobody else may use its stream meanwhile.
        frequency: a carrier that its plate may be driven with (Hz).
        drive: what to call it.
        window: frequencies that the limits allow (Hz); 1 % around the frequency without one.
        sensor, watch, truth: what a session believes of its position sensor, for how long that is
            watched (s), and where the finger is (`sensor_checks`).
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
    looks: dict[str, Callable[[], list[CheckResult]]] = {
        "link and round trip": lambda: link_checks(talk),
        "readings": lambda: reading_checks(talk),
        "limits": lambda: limit_checks(talk, limits, frequency),
        "stop in every state": lambda: [stop_check(talk, frequency)],
        "watchdog": lambda: watchdog_checks(talk, frequency),
    }
    for what, look in looks.items():
        tell(what)
        results += _undisturbed(talk, look)
        if results[-1].name == "finger sensor" and results[-1].passed:
            tell("its sensor: stroke it, and lift the finger, again and again")
            results += _undisturbed(
                talk,
                lambda: sensor_checks(
                    talk, frequency, 0.5 * TEST_VOLTAGE, sensor, duration=watch, truth=truth
                ),
            )
    if loop is not None:
        tell("the loop of this computer")
        results.append(loop())
    _make_ready(talk)
    return DeviceCheck(drive, tuple(results))


def _undisturbed(talk: Conversation, look: Callable[[], list[CheckResult]]) -> list[CheckResult]:
    """Results of `look`, again while what failed is explained by a computer that was held up."""
    results: list[CheckResult] = []
    for _ in range(_TRIES):
        _make_ready(talk)
        talk.watch()
        results, held = look(), talk.held_up
        why = (
            f"this computer, or a device that runs on it, was held up for {in_ms(held)} meanwhile, "
            "which may be the reason; check again with nothing else running"
        )
        results = [
            replace(result, doubt=why) if 0 < result.explained_by <= held else result
            for result in results
        ]
        if all(result.passed or result.doubt != why for result in results):
            break
    return results


def link_checks(talk: Conversation, echoes: int = _ECHOES) -> list[CheckResult]:
    """Every frame answered once and undamaged, and how long an answer takes (s)."""
    damaged, sent = talk.damaged, 0
    trips: list[si.Second] = []
    while sent < echoes and sent - len(trips) < _MOST_LOST:
        start, sent = talk.clock(), sent + 1
        if talk.ask(m.KeepAlive(), ANSWER_LIMIT) is not None:
            trips.append(talk.clock() - start)
    lost, hurt = sent - len(trips), talk.damaged - damaged
    middle, worst = (
        (float(q) for q in np.quantile(trips, [0.5, 0.99])) if trips else (math.inf, math.inf)
    )
    return [
        CheckResult(
            "link",
            lost == 0 and hurt == 0,
            f"{lost} of {sent} frames unanswered, {hurt} answers damaged",
            "0 and 0",
            "shorten the cable, lower the baud rate, or use another USB port",
        ),
        CheckResult(
            "round trip",
            worst <= SLOWEST_ROUND_TRIP,
            f"{in_ms(middle)} median, {in_ms(worst)} at 99 %",
            f"at most {in_ms(SLOWEST_ROUND_TRIP)} at 99 %",
            "lower the latency timer of the USB adapter (1 ms), or use one with native USB",
            sum(max(trip - SLOWEST_ROUND_TRIP, 0.0) for trip in trips),
        ),
    ]


def limit_checks(talk: Conversation, limits: Limits, frequency: si.Hertz) -> list[CheckResult]:
    """Check that what lies outside the limits is refused whole, and the output stays at zero."""
    first = talk.ask(m.KeepAlive())
    token = 0 if first is None else first.token
    wrong = m.Arm(token ^ 1).payload()
    results = [_refusal(talk, "wrong token", m.Arm.TYPE, wrong, Reason.TOKEN)]
    talk.arm()
    for name, frequency_mHz in (
        ("frequency above its window", math.ceil(limits.highest_frequency * 1e3) + 1),
        ("frequency below its window", math.floor(limits.lowest_frequency * 1e3) - 1),
    ):
        payload = m.Start(frequency_mHz).payload()
        results.append(_refusal(talk, name, m.Start.TYPE, payload, Reason.VALUE))
    talk.start(frequency)
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
    talk.ask(m.Report(round(REPORT_PERIOD * 1e6)))

    def stops(where: State) -> None:
        # An old number on purpose: stop must never depend on one.
        number = talk.send(m.Stop(), (talk.sequence - 7) & 0xFFFF)
        status = talk.answer(number)
        if status is None or status.reason != Reason.ACCEPTED:
            refused.append(where.name)

    stops(State.OFF)
    talk.arm()
    stops(State.ARMED)
    talk.arm()
    talk.start(frequency)
    stops(State.PLAYING)
    talk.arm()
    talk.readings(lambda reading: reading.state == State.FAULT)
    stops(State.FAULT)
    talk.clear()
    talk.ask(m.Report(0))
    return CheckResult(
        "stop in every state",
        not refused,
        "refused in " + ", ".join(refused) if refused else "accepted in all four",
        "accepted in all four",
        "do not use this firmware: stop must always work",
    )


def watchdog_checks(talk: Conversation, frequency: si.Hertz) -> list[CheckResult]:
    """Silence takes the output to zero within 60 ms of the last frame, and is latched."""
    talk.ask(m.Report(round(REPORT_PERIOD * 1e6)))
    talk.arm()
    talk.start(frequency)
    level = 0.5 * TEST_VOLTAGE
    talk.ask(m.Envelope(1000, (level,)))
    accepted = talk.ask_until(lambda status: status.level > 0 or status.state == State.FAULT)
    played, zero = False, math.inf
    if accepted is not None:
        played, last = accepted.level > 0, accepted.time

        def since(reading: m.Reading) -> si.Second:
            # A reading from before the last frame was accepted wraps to half an hour and more.
            after = (reading.time - last) & CLOCK
            return after * 1e-6 if after <= CLOCK // 2 else -1.0

        after = talk.readings(
            lambda reading: (
                since(reading) > 2.5 * ZERO_WITHIN or (reading.level == 0 and since(reading) >= 0)
            )
        )
        if after and after[-1].level == 0:
            zero = since(after[-1])
    allowed = ZERO_WITHIN + REPORT_PERIOD
    if not played:
        explained = talk.excuse(accepted)
    else:
        explained = zero - allowed if talk.waited and math.isfinite(zero) else 0.0
    silent = CheckResult(
        "watchdog",
        played and zero <= allowed,
        (f"zero {in_ms(zero)} after the last frame" if math.isfinite(zero) else "not at zero")
        if played
        else "the output never rose",
        f"within {in_ms(allowed)} on the device's clock, a reading's period included",
        "do not play on this device: its output must fall to zero when the host falls silent",
        explained,
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
    explained = talk.excuse(named) if fault is Fault.LATE_TICK else 0.0
    cleared = talk.clear()
    talk.ask(m.Report(0))
    latched = CheckResult(
        "watchdog latches",
        not wrong and fault is Fault.WATCHDOG and cleared,
        f"fault {fault.name.lower()}"
        + (f"; not refused: {', '.join(wrong)}" if wrong else "; all refused until cleared")
        + ("" if cleared else "; cannot be cleared"),
        "fault watchdog; all refused until cleared",
        "do not play on this device: after a fault only clearing it by name may let it play",
        explained,
    )
    return [silent, latched]


def _begin(talk: Conversation, limits: Limits) -> None:
    talk.listen()
    if talk.ask(m.Stop(), 1.0) is None:
        raise DeviceError(
            "the device does not answer; check that it is switched on, that the port is its own, "
            "and that it runs the squeezefilm firmware"
        )
    talk.ask(m.Hello(0xC0FFEE))
    _make_ready(talk)
    status = talk.ask(m.limits_message(limits))
    if status is None or status.reason != Reason.ACCEPTED:
        word = "did not answer" if status is None else f"said {Reason(status.reason).name.lower()}"
        raise DeviceError(
            f"the device {word} to the test's limits of {TEST_VOLTAGE:g} V; its own limits must "
            "allow them and the display's frequency"
        )


def _make_ready(talk: Conversation) -> None:
    """Leave the device OFF, at zero, without a fault and without reports."""
    talk.ask(m.Report(0))
    talk.ask(m.Stop())
    status = talk.ask_until(lambda status: status.level == 0)
    if status is not None and status.state == State.FAULT:
        talk.clear()


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
    said_at = 0 if status is None else status.time
    # Time for an output that should not be there to show.
    after = talk.ask_until(lambda later: (later.time - said_at) & CLOCK >= 3_000)
    level = 0 if after is None else after.level
    said = "no answer" if status is None else Reason(status.reason).name.lower()
    return CheckResult(
        f"refused: {name}",
        status is not None and status.reason == reason and after is not None and level == 0,
        f"{said}; output {level * 1e-6:g} V",
        f"{reason.name.lower()}; output 0 V",
        "do not use this firmware: it must refuse this frame whole",
        talk.excuse(status) if level == 0 else 0.0,
    )
