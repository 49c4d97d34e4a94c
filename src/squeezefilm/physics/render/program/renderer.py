"""The renderer: one sample of a finger in, one vibration amplitude out; live or over arrays."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.program import layout as at
from squeezefilm.physics.render.program.interpreter import (
    tick,
    tick_march,
    value_march,
)
from squeezefilm.physics.render.program.lowering import Program
from squeezefilm.physics.render.texture.coordinate import finger_arguments


@dataclass(frozen=True, slots=True)
class Counters:
    """Counts of what a renderer met since made or reset; see `layout` for what each counts."""

    ticks: int
    bad_place: int
    bad_time: int
    backwards: int
    repeated: int
    bad_value: int
    stalls: int
    too_sticky: int
    too_slippery: int
    negative: int
    saturated: int

    @property
    def faults(self) -> int:
        """Samples that could not be used, and holds that ran out."""
        return self.bad_place + self.bad_time + self.backwards + self.bad_value + self.stalls

    @property
    def unreachable(self) -> int:
        """Samples whose friction or amplitude the display cannot reach."""
        return self.too_sticky + self.too_slippery + self.negative + self.saturated


def new_state(program: Program) -> si.FloatArray:
    """A fresh state for `interpreter.tick`, its stack included."""
    return np.zeros(at.STATE + program.stack)


def counters_of(state: si.FloatArray) -> Counters:
    """The counters that stand in a state."""
    return Counters(*(int(count) for count in state[at.S_TICKS : at.S_SATURATED + 1]))


class Renderer:
    """A program with its state. Not thread-safe: one renderer belongs to one loop.

    Compiled loops call `interpreter.tick(renderer.program.array, renderer.state, x, y, v, t)`
    themselves; `tick` here is for Python.
    """

    __slots__ = ("program", "state")

    def __init__(self, program: Program) -> None:
        self.program = program
        self.state = new_state(program)

    def tick(self, x: si.Metre, y: si.Metre, v: si.MetrePerSecond, t: si.Second) -> si.Metre:
        """The amplitude (m, zero-to-peak) for one sample; never raises. See `interpreter.tick`."""
        return float(tick(self.program.array, self.state, float(x), float(y), float(v), float(t)))

    def reset(self) -> None:
        """Forget everything: counters, time, the amplitude held."""
        self.state[:] = 0.0

    @property
    def counters(self) -> Counters:
        """Counts so far."""
        return counters_of(self.state)

    @property
    def flags(self) -> int:
        """Flags of the last tick: a sum of the flags in `layout`."""
        return int(self.state[at.S_FLAGS])


@dataclass(frozen=True, slots=True, eq=False)
class Rendered:
    """Amplitudes for a series of samples, as a renderer ticking through them would give.

    Attributes:
        amplitude: (m, zero-to-peak), shape (n,).
        flags: what each tick met, a sum of the flags in `layout`, shape (n,).
        counters: what all of them met.
        program: what made it.
    """

    amplitude: si.MetreArray
    flags: Annotated[NDArray[np.int64], si.Unit("1")]
    counters: Counters
    program: Program


def render(
    program: Program, x: si.MetreLike, y: si.MetreLike, v: si.MetrePerSecondLike, t: si.SecondLike
) -> Rendered:
    """Tick through a series of samples, beginning afresh.

    `x`, `y` (m), `v` (m/s) and `t` (s) broadcast to one axis; they may hold anything a sensor
    might say, not-a-numbers too: what cannot be used is counted.

    Raises:
        InputError: shapes that do not broadcast to one axis.
    """
    samples = _series(x, y, v, t)
    state = new_state(program)
    amplitude = np.empty(samples[0].size)
    flags = np.empty(samples[0].size, dtype=np.int64)
    tick_march(program.array, state, samples, amplitude, flags)
    return Rendered(amplitude, flags, counters_of(state), program)


def evaluate(
    program: Program, x: si.MetreLike, y: si.MetreLike, v: si.MetrePerSecondLike, t: si.SecondLike
) -> si.FloatArray:
    """The texture's values in its quantity, with no memory and no limits, in the broadcast shape.

    The same as calling the texture, through the compiled interpreter.

    Raises:
        InputError: an argument that is not finite, or shapes that do not broadcast.
    """
    finger = finger_arguments(x, y, v, t)
    out = np.empty(finger.x.size)
    value_march(program.array, np.empty(program.stack), _rows(finger), out)
    return out.reshape(finger.x.shape)


def _rows(arrays: Iterable[si.FloatArray]) -> tuple[si.FloatArray, ...]:
    """Arrays as the compiled loops take them; copies, since NumPy warns when compiled code looks at
    the views that broadcasting makes."""
    return tuple(array.copy().ravel() for array in arrays)


def _series(*arguments: Any) -> tuple[si.FloatArray, ...]:
    arrays = [si.real_numbers(*argument) for argument in zip("xyvt", arguments, strict=True)]
    try:
        joint = np.broadcast_arrays(*arrays)
    except ValueError as error:
        raise InputError("x, y, v, t do not broadcast; give equal shapes or scalars") from error
    if joint[0].ndim != 1:
        raise InputError(f"x, y, v, t of shape {joint[0].shape} are no series; give one axis")
    return _rows(joint)
