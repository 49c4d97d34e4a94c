"""Results of checks; the check that this computer makes a loop's ticks, made before it plays."""

from __future__ import annotations

import contextlib
import os
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.instruments.session.loop.plan import LoopPlan
from squeezefilm.instruments.session.loop.process import LoopProcess
from squeezefilm.instruments.session.loop.shared import Lateness
from squeezefilm.physics.render.motion.estimator import LVDT_10_KHZ, MotionEstimator
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
