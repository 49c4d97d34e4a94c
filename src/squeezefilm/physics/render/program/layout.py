"""Layout of a program and of the state of a renderer: both are flat arrays of floats.

A program is ``[header, code, tables, inverse, wave]``. The numbers of the header::

     0 MAGIC              0x53515A46, "SQZF"
     1 VERSION            of the opcodes and this layout (`opcodes.VERSION`)
     2 LENGTH             of the whole program
     3 CODE               where the code begins
     4 TABLES             where the tables of images begin; operands count from here
     5 STACK              values the stack needs
     6 QUANTITY           0 amplitude (m), 1 relative friction, 2 friction reduction
     7 FRICTION           friction coefficient at rest (quantity 2), else 0
     8 LARGEST            largest amplitude the renderer may ask for (m)
     9 INVERSE            where the inverse friction begins: its amplitudes, then a row of frictions
                          (for each speed, if there are any), then the speeds (m/s)
    10 INVERSE_COUNT      knots of it; 0 for quantity 0
    11 HOLD               ticks a last good amplitude is held when no good sample comes
    12 FADE               ticks over which it is then taken to 0
    13 WAVE               where the wave's factors begin
    14 WAVE_COUNT         factors over one period of the wave; 0 for no compensation
    15 WAVE_PERIOD        half a wavelength (m)
    16…18 WAVE_P, Q, R    the coordinate across the wave is P·x + Q·y + R
    19 FARTHEST           |x|, |y| beyond which a place is a fault (m)
    20 INVERSE_SPEEDS     speeds of it; 0 where friction does not depend on the finger's
    21…23                 0

The state holds counts and memory, then the stack::

     0 LAST_TIME   time of the last good sample (s)
     1 STARTED     1 once a good sample came
     2 HELD        amplitude of the last good sample (m)
     3 IDLE        ticks since then
     4 AMPLITUDE   last amplitude given out (m)
     5 WANTED      last value of the texture, in its quantity
     6 FLAGS       of the last tick, a sum of the flags below
     7 TICKS       counted from here on:
     8 BAD_PLACE   place or velocity not finite or too far               flag 1
     9 BAD_TIME    time not finite                                       flag 2
    10 BACKWARDS   time before that of the last good sample              flag 4
    11 REPEATED    time equal to it: no new sample                       flag 8
    12 BAD_VALUE   the texture's value was not finite                    flag 16
    13 STALLS      times the hold ran out                                flag 32 while it lasts
    14 TOO_STICKY  friction wanted above the surface's at rest           flag 64
    15 TOO_SLIPPERY  friction wanted below what the display reaches      flag 128
    16 NEGATIVE    amplitude wanted below 0                              flag 256
    17 SATURATED   amplitude wanted above LARGEST                        flag 512
"""

from __future__ import annotations

MAGIC = 0x53515A46

H_MAGIC, H_VERSION, H_LENGTH, H_CODE, H_TABLES, H_STACK = 0, 1, 2, 3, 4, 5
H_QUANTITY, H_FRICTION, H_LARGEST, H_INVERSE, H_INVERSE_COUNT = 6, 7, 8, 9, 10
H_HOLD, H_FADE, H_WAVE, H_WAVE_COUNT, H_WAVE_PERIOD = 11, 12, 13, 14, 15
H_WAVE_P, H_WAVE_Q, H_WAVE_R, H_FARTHEST, H_INVERSE_SPEEDS = 16, 17, 18, 19, 20
HEADER = 24
"""Numbers of the header."""

S_LAST_TIME, S_STARTED, S_HELD, S_IDLE, S_AMPLITUDE, S_WANTED, S_FLAGS, S_TICKS = range(8)
S_BAD_PLACE, S_BAD_TIME, S_BACKWARDS, S_REPEATED, S_BAD_VALUE, S_STALLS = range(8, 14)
S_TOO_STICKY, S_TOO_SLIPPERY, S_NEGATIVE, S_SATURATED = range(14, 18)
STATE = 20
"""Numbers of the state before the stack."""

F_BAD_PLACE, F_BAD_TIME, F_BACKWARDS, F_REPEATED, F_BAD_VALUE = 1, 2, 4, 8, 16
F_STALLED, F_TOO_STICKY, F_TOO_SLIPPERY, F_NEGATIVE, F_SATURATED = 32, 64, 128, 256, 512

FASTEST = 1000.0
"""Finger speed (m/s) beyond which a sample is a fault."""

REACH = 1e-9
"""Share by which a value may pass an end of its range through rounding and not count."""
