"""The loop on a simulated clock: the same compiled tick, as fast as it computes, deterministic."""

from __future__ import annotations

from typing import Any

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.instruments.session.loop import plan as at
from squeezefilm.instruments.session.loop import shared
from squeezefilm.instruments.session.loop.plan import LoopPlan, tick_arrays
from squeezefilm.instruments.session.loop.process import lateness_in, sample_block
from squeezefilm.instruments.session.loop.rows import MUTED
from squeezefilm.instruments.session.loop.shared import Lateness, private_views, ring_put_all, taken
from squeezefilm.instruments.session.loop.worker import due_ns, make_due_tick


@compiled()
def _advance(arrays: Any, memory: Any, until: int) -> None:
    """Make every tick that is due before `until` (ns after tick 0), each on time."""
    control, period = memory.control, arrays.settings[at.DT]
    while True:
        due = due_ns(control[shared.NEXT], period)
        if due >= until:
            return
        make_due_tick(arrays, memory, due)


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
