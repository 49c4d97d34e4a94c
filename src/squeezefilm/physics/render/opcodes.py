"""The instructions a texture lowers to: numbers, operands, and what each does to the stack.

A lowered texture is one flat array of floats, `[opcode, operands…, opcode, operands…, END]`, run
on a stack of floats by the compiled interpreter (`interpret`), by the page's (`static/
renderer.js`) and by a device's firmware. The numbers below are the wire format: a number is never
used again for another meaning, and `VERSION` rises when any meaning changes.

In the table `s` is the value on top of the stack, `a b` the two on top (b last); x, y, v, t are
the finger's place (m), velocity (m/s) and the time (s).

==  ============  =======================  ========================================================
 n  name          operands                 the stack afterwards
==  ============  =======================  ========================================================
 0  END                                    the one value left is the texture's
 1  CONSTANT      c                        pushes c
 2  ALONG         p q r                    pushes p·x + q·y + r
 3  RADIUS        x0 y0                    pushes √((x−x0)² + (y−y0)²)
 4  TIME                                   pushes t
 5  SPEED                                  pushes |v|
 6  ADD                                    a b → a + b
 7  MULTIPLY                               a b → a·b
 8  LEAST                                  a b → b if b < a, else a
 9  GREATEST                               a b → b if b > a, else a
10  COMPLEMENT                             s → 1 − s
11  BETWEEN       low high                 s → (1 − s)·low + s·high
12  SQUARE        period phase duty        u = s/period + phase; 1 if u − ⌊u⌋ < duty, else 0
13  SINE          period phase             ½ + ½ sin 2π(s/period + phase)
14  GAUSSIAN      centre sigma             exp(−½((s − centre)/sigma)²)
15  HANN          centre width             d = |s − centre|/width; 0 if d ≥ 1, else ½ + ½ cos πd
16  RAMP          start end                u = (s − start)/(end − start) held within 0…1
17  SMOOTH                                 s → s²(3 − 2s)
18  BAND          start end fade           1 within start…end, 0 outside, edges linear over fade
19  BUMP          centre width sign        d = (s − centre)/width; ½ − ½ sign·way·d exp(½(1 − d²))
                                           held within 0…1; way = −1 if v < 0, else 1
20  NOISE         period seed              spline noise of s/period (see `texture.image`)
21  NOISE_FIELD   period seed              pushes spline noise of (x/period, y/period)
22  IMAGE         table rows columns       pushes the table (row after row, the first at the
                  x0 y0 pixel outside      greatest y) read bilinearly; outside: 0 hold, 1 repeat,
                                           2 zero
23  WITHIN        low high                 1 if low < s < high, else 0
24  DECAY         start tau                1 if s < start, else exp(−(s − start)/tau)
25  FADE          rest                     a b → (1 − b)·rest + b·a
26  CROSS         edge fade                a b s → (1 − m)·a + m·b; m = 0 if s < edge else 1, or
                                           linear over fade about the edge
27  ENTER_SCALE   reference low high       f = |v|/reference held within low…high; pushes x, y;
                                           x ← x/f, y ← y/f
28  LEAVE_SCALE                            x y s → s, and x, y are what they were
29  WEIGH         w                        s → w·s
==  ============  =======================  ========================================================
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError

VERSION = 2
"""Version of the instructions and of the program's layout."""
READ_VERSIONS = (1, 2)
"""Versions that are understood; 2 brought the speeds of the inverse, and 1 has none."""

END = 0
CONSTANT = 1
ALONG = 2
RADIUS = 3
TIME = 4
SPEED = 5
ADD = 6
MULTIPLY = 7
LEAST = 8
GREATEST = 9
COMPLEMENT = 10
BETWEEN = 11
SQUARE = 12
SINE = 13
GAUSSIAN = 14
HANN = 15
RAMP = 16
SMOOTH = 17
BAND = 18
BUMP = 19
NOISE = 20
NOISE_FIELD = 21
IMAGE = 22
WITHIN = 23
DECAY = 24
FADE = 25
CROSS = 26
ENTER_SCALE = 27
LEAVE_SCALE = 28
WEIGH = 29

# Operands, values taken from the stack, values put on it; by opcode.
SHAPES: tuple[tuple[int, int, int], ...] = (
    (0, 1, 0), (1, 0, 1), (3, 0, 1), (2, 0, 1), (0, 0, 1), (0, 0, 1),
    (0, 2, 1), (0, 2, 1), (0, 2, 1), (0, 2, 1), (0, 1, 1), (2, 1, 1),
    (3, 1, 1), (2, 1, 1), (2, 1, 1), (2, 1, 1), (2, 1, 1), (0, 1, 1),
    (3, 1, 1), (3, 1, 1), (2, 1, 1), (2, 0, 1), (7, 0, 1), (2, 1, 1),
    (2, 1, 1), (1, 2, 1), (2, 3, 1), (3, 0, 2), (0, 3, 1), (1, 1, 1),
)  # fmt: skip
"""(operands, values popped, values pushed) of every opcode."""

DEEPEST_STACK = 64
LONGEST_CODE = 100_000
LARGEST_TABLES = 4_000_000
"""Limits of a program: values on the stack, numbers of code, numbers of tables."""


@si.checked_numbers
@dataclass(slots=True)
class Assembler:
    """Collects instructions and tables, and watches the stack. Not thread-safe; use it once."""

    code: list[float] = field(default_factory=list)
    tables: list[si.FloatArray] = field(default_factory=list)
    depth: int = 0
    deepest: int = 0
    _table_length: int = 0

    def emit(self, opcode: int, *operands: float) -> None:
        """Append one instruction.

        Raises:
            InputError: a texture too deep or too long to be rendered.
        """
        count, popped, pushed = SHAPES[opcode]
        if len(operands) != count or popped > self.depth:
            raise AssertionError(f"opcode {opcode} was emitted with {operands} at {self.depth}")
        self.code += [float(opcode), *(float(operand) for operand in operands)]
        self.depth += pushed - popped
        self.deepest = max(self.deepest, self.depth)
        if self.deepest > DEEPEST_STACK or len(self.code) > LONGEST_CODE:
            raise InputError(
                f"the texture needs a stack of {self.deepest} values and {len(self.code)} numbers "
                f"of code; at most {DEEPEST_STACK} and {LONGEST_CODE} can be rendered; nest less"
            )

    def table(self, values: si.FloatArray) -> float:
        """Append a table of numbers; returns where it begins among the tables.

        Raises:
            InputError: tables that are too large together.
        """
        start = self._table_length
        flat = np.ascontiguousarray(values, dtype=float).ravel()
        self._table_length += flat.size
        if self._table_length > LARGEST_TABLES:
            raise InputError(
                f"the images of the texture hold {self._table_length} pixels together; at most "
                f"{LARGEST_TABLES} can be rendered"
            )
        self.tables.append(flat)
        return float(start)


MASK = 0xFFFFFFFF
STEP_ALONG = 0x9E3779B1
STEP_ACROSS = 0x85EBCA77
"""Odd numbers that spread neighbouring lattice points of noise over 32 bits."""


def mixed(value: Any) -> Any:
    """A 32-bit number mixed into another: "lowbias32"."""
    value = value & MASK
    value = value ^ (value >> 16)
    value = (value * 0x7FEB352D) & MASK
    value = value ^ (value >> 15)
    value = (value * 0x846CA68B) & MASK
    return value ^ (value >> 16)
