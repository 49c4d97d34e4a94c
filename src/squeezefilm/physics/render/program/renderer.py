"""The renderer: one sample of a finger in, one amplitude out; live, over arrays, for a speed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.interpret import samples_of, values_of
from squeezefilm.physics.render.program import layout as at
from squeezefilm.physics.render.program.interpreter import tick, tick_march
from squeezefilm.physics.render.program.lowering import Program


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

    The same as calling the texture.

    Raises:
        InputError: an argument that is not finite, or shapes that do not broadcast.
    """
    starts = int(program.array[at.H_CODE]), int(program.array[at.H_TABLES])
    return values_of(program.array, starts, program.stack, (x, y, v, t))


def _series(*arguments: Any) -> tuple[si.FloatArray, ...]:
    arrays = [si.real_numbers(*argument) for argument in zip("xyvt", arguments, strict=True)]
    try:
        joint = np.broadcast_arrays(*arrays)
    except ValueError as error:
        raise InputError("x, y, v, t do not broadcast; give equal shapes or scalars") from error
    if joint[0].ndim != 1:
        raise InputError(f"x, y, v, t of shape {joint[0].shape} are no series; give one axis")
    return samples_of(joint)


# The friction that an amplitude makes depends on how fast the finger slides, and only a loop that
# knows the speed can follow it. This says what it costs not to.
_SPEED = si.Unit("m/s")


@si.checked_numbers
@dataclass(frozen=True, slots=True)
class MadeForSpeed:
    """The finger's speed for which amplitudes over places were chosen, and the error at others.

    Attributes:
        speed: it (m/s), above 0.
        error_at_half, error_at_double: by how much relative friction is off where it is most (1,
            with its sign; 0 where friction does not depend on the speed), under a finger at half
            and at double that speed.
    """

    speed: Annotated[si.MetrePerSecond, si.Above(0.0)]
    error_at_half: si.Dimensionless
    error_at_double: si.Dimensionless

    @classmethod
    @si.checked_numbers
    def of(
        cls,
        law: Callable[[si.MetreArray, si.MetrePerSecondArray], si.DimensionlessArray],
        amplitude: si.MetreArray,
        speed: Annotated[si.MetrePerSecond, si.Above(0.0)],
    ) -> MadeForSpeed:
        """Cost by a law from vibration amplitudes (m) and speeds (m/s) to µ′/µ (1), each of shape
        (n,): of amplitudes over places (m) that were chosen for a speed (m/s, above 0).

        Raises `InputError` for a law that returns another shape.
        """
        a = np.asarray(amplitude, dtype=float)
        rows = [
            si.returned("law", law(a, np.full(a.shape, v)), a, "one value per amplitude")
            for v in (0.5 * speed, speed, 2.0 * speed)
        ]
        half, double = (_largest(row - rows[1]) for row in (rows[0], rows[2]))
        return cls(speed, half, double)

    def summary(self) -> dict[str, Any]:
        """The numbers, with units in their keys."""
        return {
            "made_for_speed_m_per_s": self.speed,
            "friction_error_at_half_speed": self.error_at_half,
            "friction_error_at_double_speed": self.error_at_double,
        }

    def sentence(self) -> str:
        """Sentence for people and for a file's description."""
        made = f"made for a finger at {si.format_quantity(self.speed, _SPEED)}"
        if self.error_at_half == 0.0 and self.error_at_double == 0.0:
            return f"{made}; by this model friction does not depend on the speed"
        return (
            f"{made}; at half that speed relative friction is off by up to "
            f"{self.error_at_half:+.2g}, at double by up to {self.error_at_double:+.2g}"
        )


def _largest(difference: si.FloatArray) -> float:
    return float(difference.flat[int(np.argmax(np.abs(difference)))])
