"""The loop's own process, `python -m squeezefilm.instruments.session.loop.worker FD`, of
`LoopProcess`.

Standard input brings the plan; the file descriptor is the shared memory. It compiles, asks for
real-time priority, says that it is ready, and ticks until the host says stop or dies.
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

from squeezefilm.instruments.device.priority import collect_garbage_first, real_time_granted
from squeezefilm.instruments.session.loop import shared
from squeezefilm.instruments.session.loop.pacing import (
    COMPILED_CLOCK,
    compiled_loop,
    make_due_tick,
    margin_ns,
    new_timespec,
    portable_loop,
    silence,
)
from squeezefilm.instruments.session.loop.plan import LoopPlan, tick_arrays
from squeezefilm.instruments.session.loop.shared import load_acquire, store_release

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
        if load_acquire(control, shared.STOP) != 0 or _orphaned(orders):
            return
        time.sleep(0.5e-3)
    if compiled:
        margin = margin_ns(plan.period, real_time)
        compiled_loop(arrays, memory, timespec, margin, timeout, orders.parent)
    else:
        portable_loop(arrays, memory, timeout, orders.parent)
    store_release(control, shared.PHASE, shared.PHASE_ENDED)


def _orphaned(orders: Orders) -> bool:
    return orders.parent != 0 and os.getppid() != orders.parent


def main() -> None:
    """Read the orders, map the memory, run."""
    # Ctrl-C goes to the whole group; the host stops this process in its own order.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    orders: Orders = pickle.load(sys.stdin.buffer)
    mapped = mmap.mmap(int(sys.argv[1]), shared.shared_size())
    run_loop(orders, shared.shared_views(mapped))


if __name__ == "__main__":
    main()
