"""Checks of timing: of this computer's loop before it plays, of a device's readings (how often, on
which clock), and of its position sensor's rate, delay and silence."""

from __future__ import annotations

import contextlib
import math
import os
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.drive_limits import STOP_RAMP
from squeezefilm.instruments.bench.conversation import KEEP_ALIVE, Conversation
from squeezefilm.instruments.bench.resonance_sweep import peak
from squeezefilm.instruments.device.machine.playing import CLOCK
from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.session.loop.plan import LoopPlan
from squeezefilm.instruments.session.loop.process import LoopProcess
from squeezefilm.instruments.session.loop.shared import Lateness
from squeezefilm.instruments.session.play.plan import REPORT_PERIOD
from squeezefilm.physics.render.motion.estimator import LVDT_10_KHZ, MotionEstimator, SensorModel
from squeezefilm.physics.render.program.lowering import lower
from squeezefilm.physics.render.resonator.envelope import DrivenEnvelope
from squeezefilm.physics.render.texture.levels import Amplitude
from squeezefilm.physics.render.texture.shapes import SquareWave


@dataclass(frozen=True, slots=True)
class CheckResult:
    """A check: its name, whether it passed, what was measured, what is allowed, what to do.

    What passed keeps no advice and no excuse. `doubt` says why one that did not may be the fault of
    nobody; `explained_by` is for how long this computer must have been held up to be the reason
    (s), 0 where nothing excuses it.
    """

    name: str
    passed: bool
    measured: str
    allowed: str
    advice: str = ""
    explained_by: si.Second = 0.0
    doubt: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "passed", bool(self.passed))
        if self.passed:
            object.__setattr__(self, "advice", "")
            object.__setattr__(self, "explained_by", 0.0)

    @property
    def verdict(self) -> str:
        """One word: pass, doubt or FAIL."""
        return "pass" if self.passed else "doubt" if self.doubt else "FAIL"


@dataclass(frozen=True, slots=True)
class DeviceCheck:
    """All checks of one device."""

    drive: str
    results: tuple[CheckResult, ...]

    @property
    def passed(self) -> bool:
        """True where no check failed; some may be in doubt."""
        return all(result.passed or result.doubt for result in self.results)


def in_ms(value: si.Second) -> str:
    """A time (s) in ms, in words."""
    return f"{1e3 * value:.3g} ms"


LEAST_MADE: si.Dimensionless = 0.99
LOOP_SECONDS: si.Second = 3.0


def check_loop(rate: si.Hertz, duration: si.Second = LOOP_SECONDS) -> CheckResult:
    """Run a loop at a rate (Hz) for some seconds, nothing played, and judge it."""
    before = stolen_time()
    lateness = loop_lateness(rate, duration)
    return loop_result(lateness, stolen_time() - before)


def loop_lateness(rate: si.Hertz, duration: si.Second) -> Lateness:
    """Lateness of this computer's loop at a rate (Hz), over some seconds; nothing is played."""
    square = Amplitude(SquareWave(2e-3), low=0.0, high=1e-6)
    plan = LoopPlan(
        program=lower(square, largest_amplitude=1e-6),
        rate=rate,
        envelope=DrivenEnvelope(1e-3, 1e-3, 1e-6),
        amplitude_per_volt=1e-6,
        estimator=MotionEstimator.for_sensor(LVDT_10_KHZ),
    )
    with LoopProcess(plan) as loop:
        end = time.monotonic() + duration
        while time.monotonic() < end:
            moment = loop.time
            x = 0.06 * (moment % 1.0)
            loop.feed(np.array([[moment, x, 0.0, 1.0, np.nan, np.nan]]))
            loop.take_commands()
            loop.take_rows()
            time.sleep(1e-3)
    return loop.report().lateness


def stolen_time() -> si.Second:
    """Time for which a virtual computer's host has taken processors away since it started (s).

    0 where the system does not tell. Source: Linux, proc_stat(5), "steal".
    """
    with contextlib.suppress(OSError, IndexError, ValueError):
        return int(Path("/proc/stat").read_text().split(maxsplit=9)[8]) / os.sysconf("SC_CLK_TCK")
    return 0.0


def waited_time() -> si.Second:
    """Time for which some program of this computer has waited for a processor since it started,
    and what its host took from it (s); 0 where the system does not tell.

    Source: Linux, Documentation/accounting/psi.rst, the total of "some".
    """
    with contextlib.suppress(OSError, IndexError, ValueError):
        some = Path("/proc/pressure/cpu").read_text().split(maxsplit=5)[4]
        return int(some.removeprefix("total=")) * 1e-6 + stolen_time()
    return stolen_time()


def loop_result(lateness: Lateness, stolen: si.Second) -> CheckResult:
    """Judge a loop by its ticks; `stolen` (s) is what the computer's host took meanwhile.

    Ticks that were lost are lost, whoever was to blame; where it may have been the host, that is
    said, since nothing on this computer would help then.
    """
    passed = lateness.share_made >= LEAST_MADE
    measured = (
        f"{100 * lateness.share_made:.2f} % of {lateness.made + lateness.lost} ticks at "
        f"{lateness.rate:g} Hz; late {1e6 * lateness.quantile(0.5):.3g} µs median, "
        f"{1e6 * lateness.quantile(0.99):.3g} µs at 99 %"
    )
    if stolen > 0:
        measured += f"; its host took {1e3 * stolen:.0f} ms from this virtual computer meanwhile"
    missing = (LEAST_MADE - lateness.share_made) * (lateness.made + lateness.lost) / lateness.rate
    advice = (
        "the host of this virtual computer may have lost them; play on a computer of one's own"
        if stolen >= missing
        else "allow real-time priority (rtprio), close other programs, or play at a lower rate"
    )
    allowed = f"at least {100 * LEAST_MADE:g} % made"
    return CheckResult("loop", passed, measured, allowed, advice)


DELAY_WITHIN: si.Second = 1e-3
"""By how much a sensor's delay may differ from what a session believes: 0.08 mm at 80 mm/s."""
_RATE_WITHIN = 0.05
_LEAST_WAY: si.Metre = 5e-3
_SPEED_OVER: si.Second = 50e-3
_DELAYS: si.FloatArray = np.arange(-20e-3, 150e-3, 0.5e-3)


def reading_checks(talk: Conversation, duration: si.Second = 0.5) -> list[CheckResult]:
    """Readings as often as asked for by the device's clock, which runs with this one, of a finger
    sensor."""
    talk.ask(m.Report(round(REPORT_PERIOD * 1e6)))
    came = [
        (heard.time, heard.message)
        for heard in talk.listen_for(duration, KEEP_ALIVE)
        if isinstance(heard.message, m.Reading)
    ]
    talk.ask(m.Report(0))
    stamps = np.array([reading.time for _, reading in came], dtype=np.int64)
    # The device's clock has 32 bits of microseconds.
    steps = np.diff(stamps) & CLOCK
    backwards = int(np.count_nonzero((steps == 0) | (steps > CLOCK // 2)))
    elapsed = int(steps.sum()) * 1e-6
    # By the device's clock between the first and the last, and by this one where too few came.
    wanted = elapsed / REPORT_PERIOD + 1 if len(came) > 1 else duration / REPORT_PERIOD
    missing = max(wanted - len(came), 0.0) * REPORT_PERIOD
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
        CheckResult(
            "readings",
            abs(len(came) - wanted) <= 0.05 * wanted + 3,
            f"{len(came)} in {elapsed:.3g} s of its clock",
            f"{wanted:.0f} within 5 %",
            "the link is too slow for so many: raise the baud rate; or the firmware's tick is late",
            missing if talk.waited else 0.0,
        ),
        CheckResult(
            "device clock",
            not backwards and abs(drift) <= 0.02,
            f"{backwards} steps that do not rise, {100 * drift:+.2f} % against this clock",
            "0, within 2 %",
            "the firmware's microsecond clock is not one; see docs/reference/device.md",
            max(-drift, 0.0) * duration if talk.waited and not backwards else 0.0,
        ),
        CheckResult(
            "finger sensor",
            seen,
            "present" if seen else "none",
            "present, for sensor device",
            "without one play with sensor replay:FILE; else connect it and look at the firmware",
        ),
    ]


@dataclass(frozen=True, slots=True, eq=False)
class _Watched:
    """Readings of a sensor while the device followed it, arrays of shape (readings,): times by the
    device's clock (s), places (m), whether it was touched, the output (V), and where it was moved
    at more than half of its greatest speed. `excuse` is that of a device that stopped (s)."""

    time: si.SecondArray
    place: si.MetreArray
    touched: NDArray[np.bool_]
    level: si.FloatArray
    excuse: si.Second

    @property
    def moved(self) -> NDArray[np.bool_]:
        places = np.interp(
            self.time[:, None] + _SPEED_OVER * np.array([-0.5, 0.5]), self.time, self.place
        )
        way = np.abs(np.diff(places)[:, 0])
        fast: NDArray[np.bool_] = self.touched & (way > 0.5 * way[self.touched].max(initial=0.0))
        return fast


def sensor_checks(
    talk: Conversation,
    frequency: si.Hertz,
    volts: si.Volt,
    sensor: SensorModel,
    *,
    duration: si.Second,
    truth: Callable[[si.SecondArray], si.MetreArray] | None = None,
) -> list[CheckResult]:
    """Rate, delay and silence of a device's position sensor that is stroked, and lifted, meanwhile.

    Args:
        talk: the conversation, with a device that is OFF.
        frequency: the carrier (Hz).
        volts: played wherever the sensor is touched (V).
        sensor: what a session believes of it.
        duration: for which it is watched (s).
        truth: where the finger was (m) at times of the device's clock (s); None where nobody
            knows, and then neither is the delay.
    """
    seen = _watched(talk, frequency, volts, duration)
    if seen is None or np.ptp(seen.place[seen.touched]) < _LEAST_WAY:
        return [
            CheckResult(
                "sensor rate",
                False,
                "nothing moved",
                f"{1e3 * _LEAST_WAY:g} mm of way and more",
                "stroke the sensor with a finger during the check",
                doubt="a sensor that is not stroked shows neither rate nor delay",
            )
        ]
    here = talk.waited is not None
    results = [_rate(seen, sensor, here=here), _silence(seen, sensor, here=here)]
    return results if truth is None else [*results, _delay(seen, sensor, truth)]


def _watched(
    talk: Conversation, frequency: si.Hertz, volts: si.Volt, duration: si.Second
) -> _Watched | None:
    """Readings of the sensor; None where it was not touched."""
    talk.arm()
    talk.start(frequency)
    # Wherever a place can be.
    talk.ask(m.TileBegin(-(1 << 31), (1 << 31) - 1, 3))
    talk.ask(m.TileData(0, (volts, volts, volts)))
    talk.ask(m.Follow())
    talk.ask(m.Report(round(REPORT_PERIOD * 1e6)))
    heard = talk.listen_for(duration, KEEP_ALIVE)
    talk.ask(m.Report(0))
    talk.ask(m.Stop())
    came = [told.message for told in heard if isinstance(told.message, m.Reading)]
    if not any(reading.touching for reading in came):
        return None
    stamps = np.array([reading.time for reading in came], dtype=np.int64)
    steps = np.diff(stamps, prepend=stamps[:1]) & CLOCK
    return _Watched(
        (stamps[0] + np.cumsum(steps)) * 1e-6,
        np.array([reading.x for reading in came]) * 1e-6,
        np.array([reading.touching for reading in came]) > 0,
        np.array([reading.level for reading in came]) * 1e-6,
        talk.excuse(came[-1]),
    )


def _rate(seen: _Watched, sensor: SensorModel, *, here: bool) -> CheckResult:
    """New places a second while it is moved, at most one a reading."""
    new = np.flatnonzero(np.diff(seen.place) != 0) + 1
    steps, quick = np.diff(seen.time[new]), seen.moved[new]
    steps = steps[quick[:-1] & quick[1:] & (steps < _SPEED_OVER + 6 / sensor.rate)]
    rate = 1 / float(steps.mean()) if steps.size else math.nan
    wanted = min(sensor.rate * (1 - sensor.loss), 1 / REPORT_PERIOD)
    scatter, longest = (float(steps.std()), float(steps.max())) if steps.size else (math.nan,) * 2
    return CheckResult(
        "sensor rate",
        abs(rate - wanted) <= _RATE_WITHIN * wanted,
        f"{rate:.4g} Hz; {in_ms(scatter)} of scatter, {in_ms(longest)} at most between two places",
        f"{wanted:.4g} Hz within {100 * _RATE_WITHIN:g} %, as of {sensor.name}",
        "name the sensor that there is (--sensor), or look at what keeps it from converting",
        float(steps.sum()) * (1 - rate / wanted) if here and rate < wanted else 0.0,
    )


def _silence(seen: _Watched, sensor: SensorModel, *, here: bool) -> CheckResult:
    """The output falls with the touch, and no sensor is still for longer than a session waits."""
    stall = MotionEstimator.for_sensor(sensor).stall
    lifts = np.flatnonzero(seen.touched[:-1] & ~seen.touched[1:]) + 1
    last = 0.0
    for lift in lifts:
        end = np.append(np.flatnonzero(seen.touched[lift:]) + lift, seen.time.size)[0]
        loud = np.flatnonzero(seen.level[lift:end] > 0)
        last = max(last, seen.time[lift + loud[-1]] - seen.time[lift] if loud.size else 0.0)
    # Times of news: of a place, of a touch, and the last.
    news = np.concatenate([[True], (np.diff(seen.place) != 0) | np.diff(seen.touched), [True]])
    marks = np.minimum(np.flatnonzero(news), seen.time.size - 1)
    rests = np.diff(seen.time[marks])[seen.touched[marks[:-1]]].max(initial=0.0)
    loudest = float(seen.level[seen.touched].max(initial=0.0))
    allowed = STOP_RAMP + REPORT_PERIOD
    good = loudest > 0 and last <= allowed and rests <= stall
    result = CheckResult(
        "sensor silence",
        good and lifts.size > 0,
        f"{loudest:g} V while it is touched; zero {in_ms(last)} after it was not, seen "
        f"{lifts.size} times; touched and still for {in_ms(rests)}",
        f"zero within {in_ms(allowed)}, and a sensor that falls silent says that nothing touches "
        f"(still for at most {in_ms(stall)})",
        "the board must show a lifted finger, a broken wire, a sensor that hangs as not touched",
        seen.excuse or (last - allowed if here and loudest > 0 and rests <= stall else 0.0),
    )
    if good and not lifts.size:
        why = "the finger was not lifted meanwhile, so that silence was not seen; lift it"
        return replace(result, advice=why, explained_by=0.0, doubt=why)
    return result


def _delay(
    seen: _Watched, sensor: SensorModel, truth: Callable[[si.SecondArray], si.MetreArray]
) -> CheckResult:
    """Delay of the places shown behind the true ones: the shift of least squares."""
    when, place = seen.time[seen.moved], seen.place[seen.moved]
    times = np.arange(when[0] - _DELAYS[-1], when[-1] - _DELAYS[0] + 1e-3, 1e-3)
    true = truth(times)
    apart = [
        float(np.mean((place - np.interp(when - delay, times, true)) ** 2)) for delay in _DELAYS
    ]
    delay, _ = peak(_DELAYS, -np.array(apart))
    # What is shown is on average half a sample older than when it came.
    wanted = sensor.latency + 0.5 / sensor.rate
    return CheckResult(
        "sensor delay",
        abs(delay - wanted) <= DELAY_WITHIN,
        f"{in_ms(delay)} behind the finger",
        f"{in_ms(wanted)} within {in_ms(DELAY_WITHIN)}: latency and half a sample of {sensor.name}",
        "name the sensor that there is (--sensor), or look at what holds its places back",
    )
