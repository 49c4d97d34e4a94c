"""The loop in its own process, and the host's side of it: samples in, commands and rows out.

The host feeds finger samples, takes commands for the device and rows for the record; nothing it
does, or Python does to it, holds up a tick. It must be heard at least every `host_timeout`: each
call here counts. Should the loop fall silent (`silence`), the host must stop feeding the device's
watchdog, since the last command would hold for ever.
"""

from __future__ import annotations

import mmap
import os
import pickle
import subprocess
import sys
import tempfile
import time
import warnings
from dataclasses import dataclass
from typing import IO, Self

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, LoopError, SqueezefilmWarning
from squeezefilm.instruments.session.loop import shared
from squeezefilm.instruments.session.loop.plan import LoopPlan
from squeezefilm.instruments.session.loop.rows import COMMAND_TIME, SAMPLE_COLUMNS
from squeezefilm.instruments.session.loop.shared import (
    DROPPED,
    Lateness,
    load_acquire,
    ring_put_all,
    store_release,
    taken,
)
from squeezefilm.instruments.session.loop.worker import Orders

PRIORITY = 50
"""Priority of SCHED_FIFO: above all ordinary work, below what the kernel itself runs at 99."""
_START_LIMIT: si.Second = 180.0
_STOP_LIMIT: si.Second = 2.0
# Until tick 0, so that the worker sees its epoch before it.
_HEAD_START_NS = 5_000_000


@dataclass(frozen=True, slots=True, eq=False)
class LoopReport:
    """Report of a loop, to be stored with its session.

    Attributes:
        lateness: of its ticks.
        real_time_priority: whether it ran under SCHED_FIFO.
        memory_locked: whether its memory was kept from being paged out.
        compiled_clock: whether it was paced by the compiled clock, not by Python.
        processor_share: processor time over time run (1), as the kernel counts it.
        spin_share: time spent spinning to a deadline over time run (1).
        refused_commands: commands that were no numbers within the drive's range.
        dropped_samples, dropped_commands, dropped_rows: lost because a ring was full.
        stale_commands: taken too late to be of use and not handed out.
    """

    lateness: Lateness
    real_time_priority: bool
    memory_locked: bool
    compiled_clock: bool
    processor_share: si.Dimensionless
    spin_share: si.Dimensionless
    refused_commands: int
    dropped_samples: int
    dropped_commands: int
    dropped_rows: int
    stale_commands: int


class LoopProcess:
    """A plan running in a process of its own, on Linux and other systems with POSIX processes.

    Use it as a context manager, or call `start` and `stop`. One thread may feed, one take commands,
    one take rows and any mute; each of the three must stay with one thread at a time.

    Args:
        plan: what to do.
        priority: of SCHED_FIFO to ask for, 1 to 99; None to ask for none. Where it is refused the
            loop runs without, and `start` warns.
        compiled_clock: False paces the loop by Python even where it could be compiled.

    Raises:
        InputError: a priority outside 1 to 99.
    """

    def __init__(
        self,
        plan: LoopPlan,
        *,
        priority: int | None = PRIORITY,
        compiled_clock: bool = True,
    ) -> None:
        if priority is not None and not 1 <= priority <= 99:
            raise InputError(
                f"priority = {priority} cannot be used: it must be 1 to 99, or None",
                quantity="priority",
            )
        self.plan = plan
        self._orders = Orders(plan, priority, os.getpid(), compiled_clock)
        self._begun: tuple[subprocess.Popen[bytes], shared.Shared] | None = None
        self._said: IO[bytes] | None = None
        self._last_words = ""
        self._epoch = 0
        self._stale = 0
        self._report: LoopReport | None = None

    # --- life ---

    def start(self) -> None:
        """Start the process, wait until it is compiled and ready, and let tick 0 come.

        Warns (`SqueezefilmWarning`) where real-time priority was refused or the clock is Python's.

        Raises:
            LoopError: a system without POSIX processes, a loop started before, or a process that
                died or did not get ready within three minutes.
        """
        if os.name != "posix":
            raise LoopError(
                "the loop needs a process that shares memory by file descriptor, which this "
                "system has not; use Linux (or macOS, with poorer timing)"
            )
        if self._begun is not None:
            raise LoopError("this loop was started before; make a new LoopProcess")
        descriptor = _anonymous_file(shared.shared_size())
        try:
            memory = shared.shared_views(mmap.mmap(descriptor, shared.shared_size()))
            self._said = tempfile.TemporaryFile()  # noqa: SIM115 - `stop` closes it
            process = subprocess.Popen(
                [
                    sys.executable,
                    "-c",
                    "from squeezefilm.instruments.session.loop.worker import main; main()",
                    str(descriptor),
                ],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=self._said,
                pass_fds=(descriptor,),
                # Ctrl-C is for the host, which stops the device first and then this.
                start_new_session=True,
            )
        finally:
            os.close(descriptor)
        self._begun = process, memory
        try:
            self._give_orders()
            self._wait_until_ready()
            self._warn(memory.control)
        except BaseException:
            self.stop()
            raise
        self._epoch = time.monotonic_ns() + _HEAD_START_NS
        self._beat()
        store_release(memory.control, shared.EPOCH, self._epoch)

    def _give_orders(self) -> None:
        process, _ = self._running()
        assert process.stdin is not None
        try:
            with process.stdin as pipe:
                pickle.dump(self._orders, pipe)
        except BrokenPipeError:
            raise self._death() from None

    def _wait_until_ready(self) -> None:
        control = self._running()[1].control
        deadline = time.monotonic() + _START_LIMIT
        while load_acquire(control, shared.PHASE) != shared.PHASE_READY:
            self.check()
            if time.monotonic() > deadline:
                raise LoopError(
                    f"the loop's process was not ready after {_START_LIMIT:g} s; the machine may "
                    "be overloaded: try again"
                )
            time.sleep(1e-3)

    def stop(self) -> LoopReport:
        """End the loop and say what it did; commands and rows can still be taken.

        It sends nothing to the device: stop that first. May be called again, and after a loop died.

        Raises:
            LoopError: a loop that was never started.
        """
        if self._report is None:
            process, memory = self._running()
            store_release(memory.control, shared.STOP, 1)
            try:
                process.wait(_STOP_LIMIT)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
            self._report = self.report()
            self._hear_last_words()
        return self._report

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def check(self) -> None:
        """Raise `LoopError` if the loop's process died; nothing if it runs or was stopped."""
        process, _ = self._running()
        if self._report is None and process.poll() is not None:
            raise self._death()

    # --- work ---

    def feed(self, samples: si.FloatArray) -> int:
        """Give finger samples, shape (n, 6) as in `rows.SAMPLE_COLUMNS`; returns how many fitted.

        Their times are on this loop's clock, see `time`. Does not wait.

        Raises:
            InputError: samples of another shape.
            LoopError: a loop that was never started, or died.
        """
        block = sample_block(samples)
        memory = self._touch()
        return int(ring_put_all(memory.sample_counters, memory.samples, block))

    def take_commands(self) -> si.FloatArray:
        """The commands since the last call, shape (n, 4) as in `rows.COMMAND_COLUMNS`.

        Those whose output time passed longer ago than the plan's host timeout are counted and left
        out: a host that was held up must not play them. Does not wait.

        Raises:
            LoopError: a loop that was never started, or died.
        """
        memory = self._touch()
        commands = taken(memory.command_counters, memory.commands)
        fresh = commands[:, COMMAND_TIME] >= self.time - self.plan.host_timeout
        self._stale += int(np.count_nonzero(~fresh))
        return commands[fresh]

    def take_rows(self) -> si.FloatArray:
        """The rows since the last call, shape (n, 14) as in `rows.COLUMNS`. Does not wait.

        Also after the loop ended or died: what it wrote is kept. Raises `LoopError` for a loop
        that was never started.
        """
        _, memory = self._running()
        self._beat()
        return taken(memory.row_counters, memory.rows)

    def mute(self, muted: bool = True) -> None:
        """Play nothing from the next tick on, or play again.

        Raises `LoopError` for a loop that was never started, or died.
        """
        store_release(self._touch().control, shared.MUTE, int(muted))

    # --- state ---

    @property
    def time(self) -> si.Second:
        """Time now on the loop's clock: seconds after tick 0 was due. 0 before `start`."""
        return (time.monotonic_ns() - self._epoch) * 1e-9 if self._epoch else 0.0

    @property
    def silence(self) -> si.Second:
        """Time since the loop made its last tick (s); above some periods it hangs."""
        _, memory = self._running()
        # Read before the time: a tick between the two would make the silence negative.
        last_tick = int(memory.control[shared.BEAT]) * 1e-9
        return self.time - last_tick

    def report(self) -> LoopReport:
        """Report of the loop up to now.

        Raises `LoopError` for a loop that was never started.
        """
        _, memory = self._running()
        control = memory.control
        run = max(int(control[shared.BEAT]), 1)
        return LoopReport(
            lateness=lateness_in(self.plan, memory),
            real_time_priority=bool(control[shared.REALTIME]),
            memory_locked=bool(control[shared.LOCKED]),
            compiled_clock=int(control[shared.PACING]) == shared.PACING_COMPILED,
            processor_share=int(control[shared.CPU]) / run,
            spin_share=int(control[shared.SPUN]) / run,
            refused_commands=int(control[shared.REFUSED]),
            dropped_samples=int(memory.sample_counters[DROPPED]),
            dropped_commands=int(memory.command_counters[DROPPED]),
            dropped_rows=int(memory.row_counters[DROPPED]),
            stale_commands=self._stale,
        )

    def _running(self) -> tuple[subprocess.Popen[bytes], shared.Shared]:
        if self._begun is None:
            raise LoopError(
                "this loop was not started; call start() first, or use it in a with statement"
            )
        return self._begun

    def _touch(self) -> shared.Shared:
        """The memory of a loop that lives; tells it that the host does too."""
        self.check()
        self._beat()
        return self._running()[1]

    def _beat(self) -> None:
        _, memory = self._running()
        store_release(memory.control, shared.HOST_BEAT, time.monotonic_ns() - self._epoch)

    def _death(self) -> LoopError:
        """The error that says how the loop's process died."""
        process, _ = self._running()
        code = process.wait()
        self._hear_last_words()
        how = f"was killed by signal {-code}" if code < 0 else f"ended with exit code {code}"
        return LoopError(
            f"the loop's process {how}; the device stops by its own watchdog. What it wrote is "
            f"kept; start a new loop.{self._last_words}"
        )

    def _hear_last_words(self) -> None:
        if self._said is not None:
            self._said.seek(0)
            last = self._said.read()[-2000:].decode(errors="replace").strip()
            self._last_words = f" It said: {last}" if last else ""
            self._said.close()
            self._said = None

    def _warn(self, control: np.ndarray[tuple[int], np.dtype[np.int64]]) -> None:
        if self._orders.priority is not None and not control[shared.REALTIME]:
            warnings.warn(
                "the loop runs without real-time priority, which this system did not grant: under "
                "load ticks will be lost. Allow it with an rtprio limit of at least "
                f"{self._orders.priority} for your user (on Linux in /etc/security/limits.conf), "
                "or pass priority=None to do without",
                SqueezefilmWarning,
                stacklevel=3,
            )
        if self._orders.compiled_clock and control[shared.PACING] == shared.PACING_PORTABLE:
            warnings.warn(
                "the loop is paced by Python, since its compiled clock needs 64-bit Linux: expect "
                "milliseconds of lateness and lost ticks above some hundred hertz",
                SqueezefilmWarning,
                stacklevel=3,
            )


def sample_block(samples: si.FloatArray) -> si.FloatArray:
    """Samples as the rings take them. Raises `InputError` for a shape other than (n, 6)."""
    block = np.ascontiguousarray(samples, dtype=float)
    if block.ndim != 2 or block.shape[1] != len(SAMPLE_COLUMNS):
        raise InputError(
            f"samples of shape {block.shape} cannot be taken; give rows of "
            f"{', '.join(SAMPLE_COLUMNS)}"
        )
    return block


def lateness_in(plan: LoopPlan, memory: shared.Shared) -> Lateness:
    """The lateness that stands in a loop's memory; while it runs, as of some recent tick."""
    counts = memory.histogram.copy()
    return Lateness(
        rate=plan.rate,
        made=int(counts.sum()),
        lost=int(memory.control[shared.LOST]),
        longest=int(memory.control[shared.LONGEST]) * 1e-9,
        counts=counts,
    )


def _anonymous_file(size: int) -> int:
    """A descriptor of a file without a name, which goes when its last user does."""
    if sys.platform == "linux":
        descriptor = os.memfd_create("squeezefilm-loop")
    else:
        with tempfile.TemporaryFile() as file:
            descriptor = os.dup(file.fileno())
    os.ftruncate(descriptor, size)
    return descriptor
