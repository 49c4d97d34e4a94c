"""A texture lowered to one flat array that every interpreter runs, and the check of such arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, get_args

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.render import opcodes as op
from squeezefilm.physics.render.opcodes import Assembler
from squeezefilm.physics.render.program import layout as at
from squeezefilm.physics.render.program.inverse import FrictionInverse, WaveCompensation
from squeezefilm.physics.render.texture.composition import Composable, Quantity
from squeezefilm.physics.render.texture.levels import LARGEST_AMPLITUDE
from squeezefilm.physics.render.texture.pattern import FARTHEST, METRE

QUANTITIES: tuple[Quantity, ...] = get_args(Quantity)
"""The quantities in the order of their number in a program."""

_LONGEST = 10_000_000
_MOST_TICKS = 1_000_000
# Relative friction begins with 1 at rest; a bound that keeps what is computed with it finite.
_MOST_FRICTION = 2.0


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class Program:
    """A lowered texture with its inverse friction and limits, as one flat array of floats.

    `array` is laid out as `layout` says and passed `checked`; it can't be written to. Send it as
    little-endian 64-bit floats.
    """

    array: si.FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "array", checked(self.array))

    @property
    def quantity(self) -> Quantity:
        """Quantity of the texture's values before they become an amplitude."""
        return QUANTITIES[int(self.array[at.H_QUANTITY])]

    @property
    def largest_amplitude(self) -> si.Metre:
        """The largest amplitude a tick gives out (m, zero-to-peak)."""
        return float(self.array[at.H_LARGEST])

    @property
    def stack(self) -> int:
        """Values the stack needs."""
        return int(self.array[at.H_STACK])

    @property
    def wanted_depends_on(self) -> frozenset[str]:
        """Names of what the texture and the wave may depend on, of "x", "y", "speed", "direction"
        and "time": without the speed by which a wanted friction becomes an amplitude.

        Read off the instructions: what is not named has no influence, what is named may have none.
        """
        names: set[str] = set()
        for code, operands in _instructions(self.array):
            if code == op.ALONG:
                names |= {name for name, by in zip("xy", operands[:2], strict=True) if by != 0.0}
            elif code == op.IMAGE:
                # One row that does not end is the same at every y.
                strip = operands[1] == 1.0 and operands[6] != 2.0
                names |= {"x"} if strip else {"x", "y"}
            else:
                names |= _INFLUENCES.get(code, frozenset())
        if self.array[at.H_WAVE_COUNT]:
            across = self.array[at.H_WAVE_P : at.H_WAVE_Q + 1]
            names |= {name for name, by in zip("xy", across, strict=True) if by != 0.0}
        return frozenset(names)


@si.checked_numbers
def lower(
    texture: Composable,
    *,
    largest_amplitude: Annotated[si.Metre, si.Above(0.0), si.AtMost(LARGEST_AMPLITUDE)]
    | None = None,
    inverse: FrictionInverse | None = None,
    friction_coefficient: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(10.0)] | None = None,
    compensation: WaveCompensation | None = None,
    hold_ticks: Annotated[int, si.AtLeast(0), si.AtMost(_MOST_TICKS)] = 20,
    fade_ticks: Annotated[int, si.AtLeast(1), si.AtMost(_MOST_TICKS)] = 30,
) -> Program:
    """The program of a texture.

    Args:
        texture: what is to be felt.
        largest_amplitude: the display's (m, zero-to-peak); above 0, at most 1 mm. May be left
            out where an inverse gives it.
        inverse: from friction to amplitude; needed for a texture of friction, none for one of
            amplitude.
        friction_coefficient: µ of the surface at rest (1); needed for `friction_reduction` alone.
        compensation: of the standing wave's ripple, if wished.
        hold_ticks: ticks a last good amplitude is held when no good sample comes; 0 or more.
        fade_ticks: ticks over which it is then taken to 0; at least 1. At a thousand ticks a
            second 20 and 30 end at 50 ms, the device's own watchdog.

    Raises:
        InputError: a texture too deep or large, or an argument missing, out of range or not
            belonging to the texture's quantity.
    """
    quantity = texture.quantity
    _require_what_belongs(quantity, inverse, friction_coefficient)
    if largest_amplitude is None:
        if inverse is None:
            raise InputError("a texture of amplitude needs the display's largest_amplitude (m)")
        largest_amplitude = inverse.largest_amplitude
    assembler = Assembler()
    texture._lower(assembler)
    assembler.emit(op.END)
    return Program(
        _assembled(
            assembler,
            header={
                at.H_QUANTITY: QUANTITIES.index(quantity),
                at.H_FRICTION: friction_coefficient or 0.0,
                at.H_LARGEST: largest_amplitude,
                at.H_HOLD: hold_ticks,
                at.H_FADE: fade_ticks,
                at.H_FARTHEST: FARTHEST,
            },
            inverse=inverse,
            compensation=compensation,
        )
    )


def _require_what_belongs(
    quantity: Quantity, inverse: FrictionInverse | None, friction_coefficient: float | None
) -> None:
    """Refuse what a texture of this quantity lacks, and what it has no use for."""
    frictional = quantity != "amplitude"
    if frictional and inverse is None:
        raise InputError(
            f"a texture of {quantity} needs the display's friction curve to become an amplitude; "
            "pass inverse=FrictionInverse.from_function(…)"
        )
    if not frictional and inverse is not None:
        raise InputError("a texture of amplitude needs no inverse friction; leave inverse out")
    if (quantity == "friction_reduction") != (friction_coefficient is not None):
        raise InputError(
            f"a texture of {quantity} "
            + (
                "needs the surface's friction coefficient at rest; pass friction_coefficient"
                if friction_coefficient is None
                else "takes no friction_coefficient; leave it out"
            )
        )


def _assembled(
    assembler: Assembler,
    header: dict[int, float],
    inverse: FrictionInverse | None,
    compensation: WaveCompensation | None,
) -> si.FloatArray:
    code = np.array(assembler.code, dtype=float)
    tables = np.concatenate([np.empty(0), *assembler.tables])
    curve = np.empty(0)
    if inverse is not None:
        speeds = inverse.speed if inverse.speed.size > 1 else np.empty(0)
        curve = np.concatenate([inverse.amplitude, inverse.relative_friction.ravel(), speeds])
    factors = np.empty(0)
    head = np.zeros(at.HEADER)
    if compensation is not None:
        factors = np.array(compensation.factors, dtype=float)
        origin, along = np.zeros(1), np.ones(1)
        head[at.H_WAVE_P] = float(compensation.along.at(along, origin)[0])
        head[at.H_WAVE_Q] = float(compensation.along.at(origin, along)[0])
        head[at.H_WAVE_PERIOD] = compensation.half_wavelength
    for place, value in header.items():
        head[place] = value
    parts = [head, code, tables, curve, factors]
    starts = np.cumsum([0, *(part.size for part in parts)])
    head[at.H_MAGIC], head[at.H_VERSION] = at.MAGIC, op.VERSION
    head[at.H_LENGTH] = starts[5]
    head[at.H_CODE], head[at.H_TABLES] = starts[1], starts[2]
    head[at.H_INVERSE] = starts[3]
    if inverse is not None:
        head[at.H_INVERSE_COUNT] = inverse.amplitude.size
        head[at.H_INVERSE_SPEEDS] = inverse.speed.size if inverse.speed.size > 1 else 0
    head[at.H_WAVE], head[at.H_WAVE_COUNT] = starts[4], factors.size
    head[at.H_STACK] = max(assembler.deepest, 1)
    return np.concatenate(parts)


@si.checked_numbers
def checked(array: si.FloatArray) -> si.FloatArray:
    """A program's array, copied and made read-only, if an interpreter can run it safely.

    What is checked: that it is of a version known, whole and finite, that its parts lie one after
    another within it, that every opcode is known, that the stack holds, that tables are where
    instructions look for them, that the inverse is monotone, its speeds rise and no factor is 0.

    Raises:
        InputError: an array that is no program.
    """
    program: Any = np.array(array, dtype=float)
    if program.ndim != 1 or not at.HEADER < program.size <= _LONGEST:
        raise InputError(f"an array of shape {program.shape} is no program")
    if program[at.H_MAGIC] != at.MAGIC or program[at.H_VERSION] not in op.READ_VERSIONS:
        raise InputError(
            f"the array is no program of version {op.VERSION}: it begins with "
            f"{program[at.H_MAGIC]:.17g}, {program[at.H_VERSION]:.17g}"
        )
    if program[at.H_LENGTH] != program.size:
        raise _broken(f"is {program.size} long and should be {program[at.H_LENGTH]:g}")
    whole = (
        at.H_CODE, at.H_TABLES, at.H_STACK, at.H_QUANTITY, at.H_INVERSE, at.H_INVERSE_COUNT,
        at.H_HOLD, at.H_FADE, at.H_WAVE, at.H_WAVE_COUNT, at.H_INVERSE_SPEEDS,
    )  # fmt: skip
    if any(program[place] != int(program[place]) or program[place] < 0 for place in whole):
        raise _broken("has a header whose counts are no whole numbers")
    code, tables, inverse, wave = (
        int(program[place]) for place in (at.H_CODE, at.H_TABLES, at.H_INVERSE, at.H_WAVE)
    )
    ordered = at.HEADER == code < tables <= inverse <= wave
    if (
        not ordered
        or inverse + _inverse_size(program) != wave
        or wave + program[at.H_WAVE_COUNT] != program.size
    ):
        raise _broken("has parts that do not follow one another")
    _check_header(program, inverse, wave)
    _check_code(program, tables, inverse)
    program.setflags(write=False)
    safe: si.FloatArray = program
    return safe


def _check_header(program: si.FloatArray, inverse: int, wave: int) -> None:
    quantity, count = int(program[at.H_QUANTITY]), int(program[at.H_INVERSE_COUNT])
    spare = program[at.H_INVERSE_SPEEDS] > 0.0 and count == 0
    if quantity > 2 or (count == 0) != (quantity == 0) or count == 1 or spare:
        raise _broken("has an unknown quantity, or an inverse that does not belong to it")
    if quantity == 2 and program[at.H_FRICTION] <= 0.0:
        raise _broken("reduces a friction coefficient that is not above 0")
    si.require("largest amplitude", program[at.H_LARGEST], METRE, above=0.0, at_most=1e-3)
    si.require("farthest place", program[at.H_FARTHEST], METRE, above=0.0, at_most=FARTHEST)
    si.require("stack", program[at.H_STACK], at_least=1.0, at_most=float(op.DEEPEST_STACK))
    si.require("fade ticks", program[at.H_FADE], at_least=1.0)
    if count:
        _check_inverse(program[inverse:wave], count, int(program[at.H_INVERSE_SPEEDS]))
    if program[at.H_WAVE_COUNT]:
        # These bounds keep the place within the wave a number that has an index.
        si.require("wave period", program[at.H_WAVE_PERIOD], METRE, at_least=1e-6, at_most=FARTHEST)
        direction = program[at.H_WAVE_P : at.H_WAVE_Q + 1]
        si.require("wave direction", direction, at_least=-1.0, at_most=1.0)
        si.require("wave start", program[at.H_WAVE_R], METRE, at_least=-FARTHEST, at_most=FARTHEST)
        si.require("wave factors", program[wave:], above=0.0, at_most=1.0)


def _inverse_size(program: si.FloatArray) -> float:
    """Numbers of the inverse that a header announces, as floats so that none is too large."""
    count, speeds = program[at.H_INVERSE_COUNT], program[at.H_INVERSE_SPEEDS]
    return float(count * (1.0 + max(speeds, 1.0)) + speeds)


def _check_inverse(part: si.FloatArray, count: int, speeds: int) -> None:
    rows = max(speeds, 1)
    amplitude, speed = part[:count], part[count * (1 + rows) :]
    friction = part[count : count * (1 + rows)].reshape(rows, count)
    rise = np.diff(friction, axis=1)
    # Where small amplitudes change nothing at a high speed, rows are flat; one alone has no reason.
    monotone = np.all(rise <= 0.0) if speeds else np.all(rise < 0.0)
    if np.any(np.diff(amplitude) <= 0.0) or not monotone:
        raise _broken("has an inverse that is not monotone")
    if amplitude[0] < 0.0:
        raise _broken("has an inverse with a negative amplitude")
    si.require("inverse friction", friction, at_least=0.0, at_most=_MOST_FRICTION)
    if speeds:
        si.require("inverse speed", speed, si.Unit("m/s"), at_least=0.0, at_most=at.FASTEST)
        if speeds == 1 or np.any(np.diff(speed) <= 0.0):
            raise _broken("has speeds of the inverse that do not rise")


def _instructions(program: si.FloatArray) -> list[tuple[int, si.FloatArray]]:
    """The instructions of a program, END last."""
    place, end = int(program[at.H_CODE]), int(program[at.H_TABLES])
    instructions = []
    while place < end:
        number = program[place]
        if number != int(number) or not 0 <= number < len(op.SHAPES):
            raise _broken(f"has the unknown opcode {number:g} at {place}")
        code = int(number)
        count = op.SHAPES[code][0]
        if place + 1 + count > end:
            raise _broken(f"ends within the instruction at {place}")
        instructions.append((code, program[place + 1 : place + 1 + count]))
        place += 1 + count
        if code == op.END:
            break
    if not instructions or instructions[-1][0] != op.END or place != end:
        raise _broken("does not end with its last instruction")
    return instructions


# What an instruction brings in besides the stack; ALONG and IMAGE depend on their operands.
_INFLUENCES: dict[int, frozenset[str]] = {
    op.RADIUS: frozenset("xy"),
    op.TIME: frozenset({"time"}),
    op.SPEED: frozenset({"speed"}),
    op.BUMP: frozenset({"direction"}),
    op.NOISE_FIELD: frozenset("xy"),
    op.ENTER_SCALE: frozenset({"speed"}),
}

# Operands that divide, and so must not be 0 or below.
_DIVISORS = {
    op.SQUARE: (0,), op.SINE: (0,), op.GAUSSIAN: (1,), op.HANN: (1,), op.BUMP: (1,),
    op.NOISE: (0,), op.NOISE_FIELD: (0,), op.IMAGE: (5,), op.DECAY: (1,),
    op.ENTER_SCALE: (0, 1, 2),
}  # fmt: skip


def _check_code(program: si.FloatArray, tables: int, inverse: int) -> None:
    stack = 0
    scales: list[int] = []
    for code, operands in _instructions(program):
        _, popped, pushed = op.SHAPES[code]
        # A scaled pattern must not reach below the place that is put back after it.
        floor = scales[-1] if scales else 0
        if code == op.LEAVE_SCALE:
            if not scales or stack != scales.pop() + 1:
                raise _broken("leaves a scale that it did not enter")
            floor = 0
        if stack - popped < floor:
            raise _broken("takes more from the stack than is there")
        stack += pushed - popped
        if stack > program[at.H_STACK]:
            raise _broken("needs a larger stack than it says")
        if code == op.ENTER_SCALE:
            scales.append(stack)
        for place in _DIVISORS.get(code, ()):
            if not operands[place] > 0.0:
                raise _broken(f"divides by {operands[place]:g} in an instruction {code}")
        if code == op.RAMP and operands[0] == operands[1]:
            raise _broken("has a ramp of no length")
        if code in (op.NOISE, op.NOISE_FIELD):
            seed = operands[1]
            if seed != int(seed) or not 0 <= seed < 2**32:
                raise _broken(f"has the seed {seed:g}, no 32-bit number")
        if code == op.IMAGE:
            _check_image(operands, inverse - tables)
    if stack != 0 or scales:
        raise _broken("does not leave one value")


def _check_image(operands: si.FloatArray, available: int) -> None:
    start, rows, columns, outside = (operands[place] for place in (0, 1, 2, 6))
    whole = all(number == int(number) for number in (start, rows, columns, outside))
    if not whole or start < 0 or rows < 1 or columns < 1 or outside not in (0, 1, 2):
        raise _broken("has an image without a shape")
    if start + rows * columns > available:
        raise _broken("has an image that reaches past the tables")


def _broken(what: str) -> InputError:
    return InputError(f"the program {what}; it was damaged, or made by something else: lower again")
