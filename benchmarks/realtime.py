"""How many ticks a real-time loop makes and how late, compiled and in Python, alone and under load.

Run `python benchmarks/realtime.py` (some 90 s; `--seconds` sets the length of each case). At 1, 5
and 10 kHz: the compiled loop in its own process, alone and while its host runs a busy Python
thread; the compiled loop in a thread beside a busy Python thread; the same compiled tick paced by
Python; and the whole loop interpreted, as one would write it in plain Python. A tick estimates the
finger, renders a grating and compensates it. All loops are the package's own, from one source:
plain Python is the same code with numba's compiler off, and gives the same commands, which is
checked first.
"""

from __future__ import annotations

import os

# One core for all that is timed; has to be set before NumPy loads its linear algebra.
os.environ["OMP_NUM_THREADS"] = "1"

import argparse
import json
import math
import subprocess
import sys
import threading
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tests.loop_runs import run_ticks

from squeezefilm.instruments.session.loop import shared
from squeezefilm.instruments.session.loop.plan import LoopPlan
from squeezefilm.instruments.session.loop.process import PRIORITY, LoopProcess, lateness_in
from squeezefilm.instruments.session.loop.shared import Lateness, ring_put_all, store_release, taken
from squeezefilm.instruments.session.loop.worker import Orders, run_loop
from squeezefilm.physics.render.motion.estimator import LVDT_10_KHZ, MotionEstimator
from squeezefilm.physics.render.program.lowering import lower
from squeezefilm.physics.render.resonator.envelope import DrivenEnvelope
from squeezefilm.physics.render.texture.levels import Amplitude
from squeezefilm.physics.render.texture.shapes import SquareWave

RATES = (1e3, 5e3, 10e3)

SPEED, LIMIT = 0.06, 1e-6


def plan_at(rate: float) -> LoopPlan:
    """A square grating of 2 mm, compensated within 100 V."""
    return LoopPlan(
        program=lower(Amplitude(SquareWave(2e-3), 0.1e-6, 0.8e-6), largest_amplitude=LIMIT),
        rate=rate,
        envelope=DrivenEnvelope(0.5e-3, 0.5e-3, LIMIT),
        amplitude_per_volt=LIMIT / 100.0,
        estimator=MotionEstimator.for_sensor(LVDT_10_KHZ),
        compensation="inverse",
        # The host's own lateness under load is not what is measured here.
        host_timeout=10.0,
    )


def finger(now: float) -> np.ndarray:
    """One sample of a finger that moves at a constant speed."""
    return np.array([[now, SPEED * now, 0.0, 1.0, math.nan, math.nan]])


def tick_cost(ticks: int) -> tuple[float, float]:
    """Time of one tick on a simulated clock (s), and the sum of its commands, to compare."""
    stamps = np.arange(ticks) / 5e3
    samples = np.concatenate([finger(one) for one in stamps])
    run_ticks(plan_at(5e3), samples[:10], stamps[:10], 10)
    start = time.process_time()
    run = run_ticks(plan_at(5e3), samples, stamps, ticks)
    return (time.process_time() - start) / ticks, float(np.sum(run.commands[:, 2]))


def keep_busy(stop: threading.Event) -> None:
    """What any Python program may do beside: plain computing that holds the interpreter's lock."""
    total = 0
    while not stop.is_set():
        for k in range(20_000):
            total += k * k % 7


def with_busy_thread(busy: bool, run: Callable[[], None]) -> None:
    """Run something, with a busy Python thread beside it or without."""
    stop = threading.Event()
    thread = threading.Thread(target=keep_busy, args=(stop,))
    if busy:
        thread.start()
    run()
    stop.set()
    if busy:
        thread.join()


def figures(lateness: Lateness, processor_share: float, granted: bool) -> dict[str, Any]:
    """What a case says of itself."""
    return {
        "lateness": lateness.to_json(),
        "processor_share": processor_share,
        "real_time": granted,
    }


def own_process(rate: float, seconds: float, busy: bool, priority: int | None) -> dict[str, Any]:
    """The compiled loop as the package runs it, the busy thread in its host."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        loop = LoopProcess(plan_at(rate), priority=priority)
        loop.start()

    def lead() -> None:
        while loop.time < seconds:
            loop.feed(finger(loop.time))
            loop.take_commands()
            loop.take_rows()
            time.sleep(1e-3)

    with_busy_thread(busy, lead)
    report = loop.stop()
    return figures(report.lateness, report.processor_share, report.real_time_priority)


def in_thread(
    rate: float, seconds: float, busy: bool, priority: int | None, compiled_clock: bool
) -> dict[str, Any]:
    """A loop in a thread of this process, the busy thread beside it."""
    plan, memory = plan_at(rate), shared.private_views()
    control = memory.control
    orders = Orders(plan, priority, 0, compiled_clock)
    thread = threading.Thread(target=run_loop, args=(orders, memory))
    thread.start()
    while control[shared.PHASE] != shared.PHASE_READY:
        time.sleep(1e-3)
    epoch = time.monotonic_ns() + 5_000_000
    store_release(control, shared.EPOCH, epoch)

    def lead() -> None:
        while (now := (time.monotonic_ns() - epoch) * 1e-9) < seconds:
            ring_put_all(memory.sample_counters, memory.samples, finger(now))
            store_release(control, shared.HOST_BEAT, round(now * 1e9))
            taken(memory.command_counters, memory.commands)
            taken(memory.row_counters, memory.rows)
            time.sleep(1e-3)

    with_busy_thread(busy, lead)
    store_release(control, shared.STOP, 1)
    thread.join()
    share = int(control[shared.CPU]) / max(int(control[shared.BEAT]), 1)
    return figures(lateness_in(plan, memory), share, bool(control[shared.REALTIME]))


def elsewhere(case: str, *numbers: float, interpreted: bool) -> dict[str, Any]:
    """A case in a fresh process, so that neither its threads nor numba's switch reach this one."""
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1" if interpreted else "0"}
    command = [sys.executable, __file__, "--case", case, *(str(one) for one in numbers)]
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, check=True)
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def run_case(case: str, numbers: list[str]) -> dict[str, Any]:
    """What the fresh process does."""
    if case == "tick":
        seconds, total = tick_cost(int(float(numbers[0])))
        return {"seconds": seconds, "total": total}
    rate, seconds, busy, priority, compiled_clock = (float(one) for one in numbers)
    return in_thread(rate, seconds, bool(busy), int(priority) or None, bool(compiled_clock))


def row(name: str, rate: float, found: dict[str, Any], made: dict[float, float]) -> None:
    """Print one line of the table; `made` holds the compiled loop's ticks to compare with."""
    late, share = found["lateness"], found["processor_share"]
    count, due = late["made"], late["made"] + late["lost"]
    against = made.setdefault(rate, count / due)
    microseconds = " ".join(
        f"{1e6 * late[key]:9.1f}" for key in ("p50_s", "p99_s", "p99_9_s", "longest_s")
    )
    print(
        f"{rate / 1e3:5g} {name:<49} {100 * count / due:7.2f} {due - count:6d} {microseconds} "
        f"{100 * share:5.1f} {'yes' if found['real_time'] else 'no':>4} "
        f"{count / due / against:6.3f}",
        flush=True,
    )


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--seconds", type=float, default=3.0, help="length of each case")
    parser.add_argument("--no-priority", action="store_true", help="ask for no real-time priority")
    parser.add_argument("--case", nargs="+", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.case:
        print(json.dumps(run_case(given.case[0], given.case[1:])))
        return
    seconds, priority = given.seconds, None if given.no_priority else PRIORITY

    compiled, _ = tick_cost(200_000)
    few = 4_000
    _, few_total = tick_cost(few)
    plain = elsewhere("tick", few, interpreted=True)
    apart = abs(plain["total"] - few_total) / few_total
    print(
        f"One tick, compiled: {1e6 * compiled:.2f} us; interpreted: "
        f"{1e6 * plain['seconds']:.0f} us, {plain['seconds'] / compiled:.0f} times as long "
        f"(commands apart {apart:.1g})\n"
    )
    print(
        f"{os.cpu_count()} processors, {seconds:g} s a case; load before: "
        f"{', '.join(f'{one:.2f}' for one in os.getloadavg())}\n"
        "  kHz loop                                              made %   lost    p50 us    p99 us"
        "  p99.9 us    max us  CPU % FIFO  ratio"
    )
    made: dict[float, float] = {}
    kept: dict[float, dict[str, Any]] = {}
    for rate in RATES:
        numbers = (rate, seconds)
        kept[rate] = own_process(rate, seconds, False, priority)
        row("compiled, own process, alone", rate, kept[rate], made)
        row("compiled, own process, busy thread in the host", rate,
            own_process(rate, seconds, True, priority), made)  # fmt: skip
        row("compiled, in a thread beside a busy thread", rate,
            elsewhere("loop", *numbers, 1, priority or 0, 1, interpreted=False), made)  # fmt: skip
        for name, interpreted in (("compiled tick paced by Python", False), ("plain Python", True)):
            for busy, beside in ((0, "alone"), (1, "beside a busy thread")):
                found = elsewhere("loop", *numbers, busy, priority or 0, 0, interpreted=interpreted)
                row(f"{name}, {beside}", rate, found, made)
    top = RATES[-1]
    share = kept[top]["processor_share"]
    print(
        "\nratio: ticks made, against the compiled loop alone. What limits the compiled loop is "
        f"not the tick,\n{1e6 * compiled:.1f} us of {1e6 / top:.0f} us at {top / 1e3:g} kHz, but "
        "the wake-up: with priority it sleeps until 50 us before a\ntick and spins through the "
        f"rest ({100 * share:.0f} % of a core at {top / 1e3:g} kHz). Ticks are lost where the "
        "kernel,\nbusy for somebody else, or the host of a virtual machine lets it wait for "
        "longer. What\nlimits Python is its one lock, which a busy thread keeps for 5 ms at a time."
    )


if __name__ == "__main__":
    main()
