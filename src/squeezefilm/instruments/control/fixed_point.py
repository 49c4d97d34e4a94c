"""Integer arithmetic that Python, numba and C do alike: rounding, dividing, clamping, a sine.

64-bit integers throughout. Rounding is to the nearest and halves away from zero, so that it is
symmetric and moves no average. The twin of the first part of `firmware/squeezefilm_loops.c`.
"""

from __future__ import annotations

from squeezefilm.core.compiled import compiled

QUARTER = 1 << 30
"""A quarter of a turn, and 1 of a sine."""


@compiled()
def scaled(value: int, bits: int) -> int:
    """`value` / 2^`bits`, to the nearest; `bits` at least 1."""
    half = 1 << (bits - 1)
    return (value + half) >> bits if value >= 0 else -((half - value) >> bits)


@compiled()
def quotient(value: int, divisor: int) -> int:
    """`value` / `divisor` towards zero, as C divides; `divisor` above 0."""
    return value // divisor if value >= 0 else -(-value // divisor)


@compiled()
def clamped(value: int, lowest: int, highest: int) -> int:
    """`value` held between `lowest` and `highest`."""
    return min(max(value, lowest), highest)


@compiled()
def sine(turn: int) -> int:
    """2^30 times the sine of an angle of `turn` / 2^32 turns, within 6e-7 of 1.

    An odd polynomial of degree 7 over a quarter turn, of least largest error (Lawson's iteration).
    """
    part = turn & (QUARTER - 1)
    if turn & QUARTER:
        part = QUARTER - part
    square = (part * part) >> 30
    factor = 85291978 - ((4652625 * square) >> 30)
    factor = ((factor * square) >> 30) - 693522166
    factor = 1686624005 + scaled(factor * square, 30)
    value = (part * factor) >> 30
    return -value if turn & (2 * QUARTER) else value
