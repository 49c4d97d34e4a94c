"""Runs of the compiled loop over a sensor's samples, its wakes as late as a test says."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.instruments.session.loop import plan as at
from squeezefilm.instruments.session.loop import shared
from squeezefilm.instruments.session.loop.plan import LoopPlan, tick_arrays
from squeezefilm.instruments.session.loop.process import lateness_in, sample_block
from squeezefilm.instruments.session.loop.rows import COLUMNS, COMMAND_COLUMNS, SAMPLE_COLUMNS
from squeezefilm.instruments.session.loop.shared import Lateness, private_views, ring_put, ring_take
from squeezefilm.instruments.session.loop.worker import due_ns, make_due_tick
from squeezefilm.physics.render.motion.estimator import SensorStream


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
        ticks: how many become due.
        delays: by how much the loop wakes late, wake after wake (s); 0 where they end.
    """
    block = sample_block(samples)
    times = np.ascontiguousarray(arrival, dtype=float)
    late = np.zeros(0) if delays is None else np.ascontiguousarray(delays, dtype=float)
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
