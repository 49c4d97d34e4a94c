"""The loop on a simulated clock: the same compiled tick, as fast as it computes, deterministic."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import SIMULATED_TICKS, require_within
from squeezefilm.instruments.session.loop import plan as at
from squeezefilm.instruments.session.loop import shared
from squeezefilm.instruments.session.loop.lateness import Lateness
from squeezefilm.instruments.session.loop.pacing import due_ns, make_due_tick
from squeezefilm.instruments.session.loop.plan import LoopPlan, tick_arrays
from squeezefilm.instruments.session.loop.ring import (
    ring_put,
    ring_put_all,
    ring_take,
    ring_waiting,
)
from squeezefilm.instruments.session.loop.rows import (
    COLUMNS,
    COMMAND_COLUMNS,
    MUTED,
    SAMPLE_COLUMNS,
)
from squeezefilm.instruments.session.loop.shared import private_views
from squeezefilm.physics.render.motion.sensor import SensorStream


@compiled()
def _advance(arrays: Any, memory: Any, until: int) -> None:
    """Make every tick that is due before `until` (ns after tick 0), each on time."""
    control, period = memory.control, arrays.settings[at.DT]
    while True:
        due = due_ns(control[shared.NEXT], period)
        if due >= until:
            return
        make_due_tick(arrays, memory, due)


@compiled()
def _march(
    arrays: Any,
    memory: Any,
    samples: si.Array,
    arrival: si.Array,
    delays: si.Array,
    ticks: int,
    rows: si.Array,
    commands: si.Array,
) -> int:
    """Wake for tick after tick, each time `delays` (s) late, until `ticks` were due."""
    control, period = memory.control, arrays.settings[at.DT]
    now, heard, made, wakes = 0, 0, 0, 0
    while control[shared.NEXT] < ticks:
        number = control[shared.NEXT]
        due = due_ns(number, period)
        delay = delays[wakes] if wakes < delays.size else 0.0
        # Where the end falls into a delay, the last tick is made as late as it can be.
        now = min(max(now, due) + int(delay * 1e9 + 0.5), due_ns(ticks, period) - 1)
        wakes += 1
        # Added to the tick's own time, so that on time the comparison is the offline renderer's.
        seen = number * period + (now - due) * 1e-9
        while heard < arrival.size and arrival[heard] <= seen:
            ring_put(memory.sample_counters, memory.samples, samples[heard])
            heard += 1
        make_due_tick(arrays, memory, now)
        ring_take(memory.row_counters, memory.rows, rows[made : made + 1])
        ring_take(memory.command_counters, memory.commands, commands[made : made + 1])
        made += 1
    return made


class SimulatedLoop:
    """A loop whose clock is moved by its owner; what `LoopProcess` offers, without a process.

    Feed samples, advance, take commands and rows. Not thread-safe. The same calls give the same
    rows, bit for bit.
    """

    def __init__(self, plan: LoopPlan) -> None:
        self.plan = plan
        self._arrays = tick_arrays(plan)
        self._memory = private_views()

    @property
    def time(self) -> si.Second:
        """Time at which the next tick is due (s)."""
        return int(self._memory.control[shared.NEXT]) * self.plan.period

    def feed(self, samples: si.FloatArray) -> int:
        """Give finger samples, shape (n, 6) as in `SAMPLE_COLUMNS`; returns how many fitted.

        Raises `InputError` for another shape.
        """
        block = sample_block(samples)
        return int(ring_put_all(self._memory.sample_counters, self._memory.samples, block))

    def advance(self, until: si.Second) -> None:
        """Make every tick that is due before a time (s), each on time.

        Raises `InputError` for a time that is not finite.
        """
        si.require("until", until, si.Unit("s"), at_most=1e6)
        _advance(self._arrays, self._memory, round(until * 1e9))

    def make_tick(self, delay: si.Second = 0.0) -> None:
        """Make the next tick, late by `delay` (s); a delay of a period or more loses ticks.

        Raises `InputError` for a delay below 0.
        """
        si.require("delay", delay, si.Unit("s"), at_least=0.0, at_most=1e6)
        number = int(self._memory.control[shared.NEXT])
        due = due_ns(number, self.plan.period)
        make_due_tick(self._arrays, self._memory, due + round(delay * 1e9))

    def mute(self, muted: bool = True) -> None:
        """Play nothing from the next tick on, or play again."""
        self._arrays.memory[at.SILENCED] = float(MUTED if muted else 0)

    def take_commands(self) -> si.FloatArray:
        """The commands made since the last call, shape (n, 4) as in `COMMAND_COLUMNS`."""
        return taken(self._memory.command_counters, self._memory.commands)

    def take_rows(self) -> si.FloatArray:
        """The rows made since the last call, shape (n, 14) as in `COLUMNS`."""
        return taken(self._memory.row_counters, self._memory.rows)

    @property
    def lateness(self) -> Lateness:
        """Lateness of the ticks so far."""
        return lateness_in(self.plan, self._memory)


@dataclass(frozen=True, slots=True, eq=False)
class SimulatedRun:
    """Run of a loop on a simulated clock.

    Attributes:
        plan: the input.
        rows: one per tick made, shape (made, 14), see `rows.COLUMNS`.
        commands: one per tick made, shape (made, 4), see `rows.COMMAND_COLUMNS`.
        lateness: of the ticks, by the delays given.
    """

    plan: LoopPlan
    rows: si.FloatArray
    commands: si.FloatArray
    lateness: Lateness


def run_ticks(
    plan: LoopPlan,
    samples: si.FloatArray,
    arrival: si.SecondArray,
    ticks: int,
    delays: si.SecondArray | None = None,
) -> SimulatedRun:
    """Run the loop over samples, until so many ticks were due.

    Args:
        plan: what the loop shall do. Its host timeout counts for gaps of ticks only.
        samples: of the finger, shape (n, 6), see `rows.SAMPLE_COLUMNS`.
        arrival: when each sample was there to be taken (s), never falling, shape (n,).
        ticks: how many become due; 1 to 20 million.
        delays: by how much the loop wakes late, wake after wake (s); 0 where they end.

    Raises:
        InputError: samples, times or counts of another shape or outside their range.
    """
    block = sample_block(samples)
    times = np.ascontiguousarray(arrival, dtype=float)
    late = np.zeros(0) if delays is None else np.ascontiguousarray(delays, dtype=float)
    si.require("arrival", times, si.Unit("s"))
    si.require("delays", late, si.Unit("s"), at_least=0.0, at_most=1e6)
    if times.shape != (block.shape[0],) or bool(np.any(np.diff(times) < 0.0)):
        raise InputError(
            f"arrival of shape {times.shape} does not fit {block.shape[0]} samples; give one time "
            "for each, none before the one ahead of it"
        )
    if not isinstance(ticks, int):
        raise InputError(f"ticks = {ticks!r} cannot be used: it must be a whole number")
    require_within(SIMULATED_TICKS, ticks, "ticks")
    arrays, memory = tick_arrays(plan), private_views()
    rows = np.empty((ticks, len(COLUMNS)))
    commands = np.empty((ticks, len(COMMAND_COLUMNS)))
    made = _march(arrays, memory, block, times, late, ticks, rows, commands)
    return SimulatedRun(plan, rows[:made], commands[:made], lateness_in(plan, memory))


def stream_samples(stream: SensorStream, y: si.MetreArray | float = 0.0) -> si.FloatArray:
    """A sensor's stream along x as samples of a finger that touches, shape (n, 6).

    `y` (m) is held or given for each sample. Their arrival is `stream.arrival`.
    """
    samples = np.full((stream.stamp.size, len(SAMPLE_COLUMNS)), math.nan)
    samples[:, 0], samples[:, 1], samples[:, 2] = stream.stamp, stream.position, y
    samples[:, 3] = 1.0
    return samples


def sample_block(samples: si.FloatArray) -> si.FloatArray:
    """Samples as the rings take them. Raises `InputError` for a shape other than (n, 6)."""
    block = np.ascontiguousarray(samples, dtype=float)
    if block.ndim != 2 or block.shape[1] != len(SAMPLE_COLUMNS):
        raise InputError(
            f"samples of shape {block.shape} cannot be taken; give rows of "
            f"{', '.join(SAMPLE_COLUMNS)}"
        )
    return block


def taken(counters: si.Array, rows: si.Array) -> si.FloatArray:
    """All rows that wait in a ring."""
    out = np.empty((ring_waiting(counters), rows.shape[1]))
    return out[: ring_take(counters, rows, out)]


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
