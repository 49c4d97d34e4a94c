"""The loop's own process, which makes ticks on their deadlines; `LoopProcess` starts it.

Standard input brings the plan; the argument is the file descriptor of the shared memory. It
compiles, asks for real-time priority, says that it is ready, and ticks until the host says stop or
dies.

Tick k is due k/rate after the loop began, by CLOCK_MONOTONIC. The loop sleeps until a margin before
that and spins through the rest, so that a sleep which ends late by less than the margin costs
nothing; the margin is at most `MOST_SPIN` of a period, so at least half of every period is slept.
Without real-time priority it does not spin: the kernel counts spinning as work, and on a busy
machine lets the loop wait the longer for it (measured at 5 kHz beside five other programs on two
processors: 95 % of ticks made without spinning, 83 % with).

A loop that comes after the next tick was due makes one tick, the latest that is due; the others are
counted as lost. So no burst follows a stop, however long it was.
"""

from __future__ import annotations

import ctypes
import mmap
import os
import pickle
import signal
import sys
import time
from dataclasses import dataclass
from typing import Any

import numba
import numpy as np
from numba import types

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.instruments.device.priority import collect_garbage_first, real_time_granted
from squeezefilm.instruments.session.loop import plan as at
from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.instruments.session.loop import shared
from squeezefilm.instruments.session.loop.plan import LoopPlan, tick_arrays
from squeezefilm.instruments.session.loop.shared import lateness_class, load_acquire, store_release
from squeezefilm.instruments.session.loop.tick import make_tick

# On 64-bit Linux a compiled loop calls `clock_gettime` and `clock_nanosleep` (to a point in time,
# TIMER_ABSTIME) of the C library themselves, by name, so that numba can cache it. Elsewhere, and
# where numba's compiler is off, `COMPILED_CLOCK` is False: the loop is then paced by Python
# (`portable_loop`), whose lateness is that of `time.sleep`, which under load of the same
# process means that it cannot keep 1 kHz. Both clocks are what `time.monotonic_ns` reads on Linux.
_MONOTONIC, _THREAD_CPU_TIME, _ABSOLUTE = 1, 3, 1
_SECOND_NS = 1_000_000_000


def _has_symbols(*names: str) -> bool:
    # Where numba's compiler will look for them: among what this process has loaded.
    library = ctypes.CDLL(None)
    return all(hasattr(library, name) for name in names)


COMPILED_CLOCK: bool = (
    sys.platform == "linux"
    and sys.maxsize > 2**32
    and not numba.config.DISABLE_JIT  # type: ignore[attr-defined]
    and _has_symbols("clock_gettime", "clock_nanosleep", "getppid")
)
"""True where compiled code can read the clock and sleep here."""

_clock_gettime: Any = types.ExternalFunction("clock_gettime", types.intc(types.intc, types.uintp))
_clock_nanosleep: Any = types.ExternalFunction(
    "clock_nanosleep", types.intc(types.intc, types.intc, types.uintp, types.uintp)
)
_getppid: Any = types.ExternalFunction("getppid", types.intc())


def new_timespec() -> si.Array:
    """Room for one `struct timespec`, which the functions here work in: int64, shape (2,)."""
    return np.zeros(2, dtype=np.int64)


@compiled()
def monotonic_ns(timespec: si.Array) -> int:
    """CLOCK_MONOTONIC (ns). Needs `COMPILED_CLOCK`."""
    _clock_gettime(_MONOTONIC, timespec.ctypes.data)
    return int(timespec[0] * _SECOND_NS + timespec[1])


@compiled()
def thread_cpu_ns(timespec: si.Array) -> int:
    """Processor time of the calling thread (ns). Needs `COMPILED_CLOCK`."""
    _clock_gettime(_THREAD_CPU_TIME, timespec.ctypes.data)
    return int(timespec[0] * _SECOND_NS + timespec[1])


@compiled()
def sleep_until_ns(timespec: si.Array, when: int) -> None:
    """Sleep until CLOCK_MONOTONIC is `when` (ns); a signal ends it. Needs `COMPILED_CLOCK`."""
    timespec[0] = when // _SECOND_NS
    timespec[1] = when % _SECOND_NS
    _clock_nanosleep(_MONOTONIC, _ABSOLUTE, timespec.ctypes.data, 0)


@compiled()
def parent_id() -> int:
    """The process that started this one, or who took it over. Needs `COMPILED_CLOCK`."""
    return int(_getppid())


MARGIN: si.Second = 50e-6
"""Time before a deadline at which the loop wakes, where half a period allows it."""
MOST_SPIN: si.Dimensionless = 0.5
"""The largest share of a period that may be spun through."""
_PARENT_LOOKED_AT_NS = 5_000_000


@compiled()
def due_ns(number: int, period: float) -> int:
    """Time at which a tick is due (ns after tick 0) at a period (s); exact to 1 ns for 10⁶ s."""
    return int(number * period * _SECOND_NS + 0.5)


@compiled()
def make_due_tick(arrays: Any, memory: Any, now: int) -> int:
    """Make the latest tick that is due at `now` (ns after tick 0), and account for it.

    Nothing is made before the next tick is due. Returns how many ticks were made: 0 or 1.
    """
    control, period = memory.control, arrays.settings[at.DT]
    number = control[shared.NEXT]
    late = now - due_ns(number, period)
    if late < 0:
        return 0
    if late > control[shared.LONGEST]:
        control[shared.LONGEST] = late
    lost = 0
    if now >= due_ns(number + 1, period):
        lost = int(late / (period * _SECOND_NS))
        # Rounded to whole nanoseconds the quotient may be one off.
        while now >= due_ns(number + lost + 1, period):
            lost += 1
        while now < due_ns(number + lost, period):
            lost -= 1
        number += lost
        late = now - due_ns(number, period)
        control[shared.LOST] += lost
    memory.histogram[lateness_class(float(late))] += 1
    flags = make_tick(arrays, memory, number, late / _SECOND_NS, lost)
    if flags & column.REFUSED_COMMAND:
        control[shared.REFUSED] += 1
    control[shared.BEAT] = now
    store_release(control, shared.NEXT, number + 1)
    return 1


@compiled()
def silence(arrays: Any, control: si.Array, now: int, timeout: int) -> None:
    """Say to the next tick whether the host muted the loop, or has not been heard for too long."""
    reasons = 0
    if load_acquire(control, shared.MUTE) != 0:
        reasons |= column.MUTED
    if now - load_acquire(control, shared.HOST_BEAT) > timeout:
        reasons |= column.HOST_SILENT
    arrays.memory[at.SILENCED] = float(reasons)


@compiled()
def compiled_loop(
    arrays: Any, memory: Any, timespec: si.Array, margin: int, timeout: int, parent: int
) -> None:
    """Tick until the host says stop or the parent is gone; needs `COMPILED_CLOCK`.

    `margin` and `timeout` are in ns; `parent` is the process whose end ends the loop, 0 for none.
    """
    control, period = memory.control, arrays.settings[at.DT]
    epoch = load_acquire(control, shared.EPOCH)
    begun, looked = thread_cpu_ns(timespec), 0
    while load_acquire(control, shared.STOP) == 0:
        due = due_ns(control[shared.NEXT], period)
        now = monotonic_ns(timespec) - epoch
        if now < due - margin:
            sleep_until_ns(timespec, epoch + due - margin)
            now = monotonic_ns(timespec) - epoch
        # A signal may have ended the sleep early; never spin through more than the margin.
        if due - margin <= now < due:
            woken = now
            while now < due:
                now = monotonic_ns(timespec) - epoch
            control[shared.SPUN] += due - woken
        silence(arrays, control, now, timeout)
        make_due_tick(arrays, memory, now)
        if now - looked > _PARENT_LOOKED_AT_NS:
            looked = now
            control[shared.CPU] = thread_cpu_ns(timespec) - begun
            if parent != 0 and parent_id() != parent:
                break
    control[shared.CPU] = thread_cpu_ns(timespec) - begun


def portable_loop(arrays: Any, memory: Any, timeout: int, parent: int) -> None:
    """The same loop paced by Python's clock and sleep, for where the compiled clock is missing.

    It does not spin. Its lateness is that of `time.sleep`, and of whatever else Python does in
    this process; the ticks themselves are the same.
    """
    control, period = memory.control, arrays.settings[at.DT]
    epoch = int(control[shared.EPOCH])
    begun, looked = time.thread_time_ns(), 0
    while load_acquire(control, shared.STOP) == 0:
        now = time.monotonic_ns() - epoch
        early = due_ns(int(control[shared.NEXT]), period) - now
        if early > 0:
            time.sleep(early / _SECOND_NS)
            now = time.monotonic_ns() - epoch
        silence(arrays, control, now, timeout)
        make_due_tick(arrays, memory, now)
        if now - looked > _PARENT_LOOKED_AT_NS:
            looked = now
            control[shared.CPU] = time.thread_time_ns() - begun
            if parent != 0 and os.getppid() != parent:
                break
    control[shared.CPU] = time.thread_time_ns() - begun


def margin_ns(period: si.Second, real_time: bool) -> int:
    """Time before a deadline at which a loop of this period (s) wakes (ns); 0 without priority."""
    return int(min(MARGIN, MOST_SPIN * period) * _SECOND_NS) if real_time else 0


# Linux: <sys/prctl.h> and <sys/mman.h>.
_PR_SET_TIMERSLACK = 29
_MCL_CURRENT, _MCL_ONFAULT = 1, 4


@dataclass(frozen=True, slots=True)
class Orders:
    """Orders to a worker: the plan, the priority to ask for, its parent, and the clock to use.

    `priority` is SCHED_FIFO's (1 to 99), or None to ask for none. `compiled_clock` may be False
    to pace the loop by Python where the compiled clock would do.
    """

    plan: LoopPlan
    priority: int | None
    parent: int
    compiled_clock: bool


def memory_locked() -> bool:
    """Keep in memory what is used of this process; whether that was allowed. Linux only.

    Also asks the kernel not to lump this thread's wake-ups with others' (timer slack).
    """
    if sys.platform != "linux":
        return False
    library = ctypes.CDLL(None, use_errno=True)
    library.prctl(_PR_SET_TIMERSLACK, ctypes.c_ulong(1), 0, 0, 0)
    return bool(library.mlockall(_MCL_CURRENT | _MCL_ONFAULT) == 0)


def run_loop(orders: Orders, memory: shared.Shared) -> None:
    """Run the loop in this thread, releasing Python's lock where its clock is compiled.

    Returns when the host said stop, or when the parent is gone.
    """
    plan, control = orders.plan, memory.control
    timespec = new_timespec()
    timeout = round(plan.host_timeout * 1e9)
    compiled = orders.compiled_clock and COMPILED_CLOCK
    # Compile, or load what was compiled, on memory and states of its own.
    rehearsal = shared.private_views()
    if compiled:
        rehearsal.control[shared.STOP] = 1
        compiled_loop(tick_arrays(plan), rehearsal, timespec, 0, timeout, 0)
    else:
        silence(tick_arrays(plan), rehearsal.control, 0, timeout)
        make_due_tick(tick_arrays(plan), rehearsal, 0)
    arrays = tick_arrays(plan)
    collect_garbage_first()
    control[shared.PACING] = shared.PACING_COMPILED if compiled else shared.PACING_PORTABLE
    control[shared.LOCKED] = int(memory_locked())
    real_time = orders.priority is not None and real_time_granted(orders.priority)
    control[shared.REALTIME] = int(real_time)
    store_release(control, shared.PHASE, shared.PHASE_READY)
    while load_acquire(control, shared.EPOCH) == 0:
        if load_acquire(control, shared.STOP) != 0 or orders.parent not in (0, os.getppid()):
            return
        time.sleep(0.5e-3)
    if compiled:
        margin = margin_ns(plan.period, real_time)
        compiled_loop(arrays, memory, timespec, margin, timeout, orders.parent)
    else:
        portable_loop(arrays, memory, timeout, orders.parent)
    store_release(control, shared.PHASE, shared.PHASE_ENDED)


def main() -> None:
    """Read the orders, map the memory, run."""
    # Ctrl-C goes to the whole group; the host stops this process in its own order.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    orders: Orders = pickle.load(sys.stdin.buffer)
    mapped = mmap.mmap(int(sys.argv[1]), shared.shared_size())
    run_loop(orders, shared.shared_views(mapped))
