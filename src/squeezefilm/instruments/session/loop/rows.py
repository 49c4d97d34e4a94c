"""Rows that the loop takes in and writes down: columns of its rings, and the flags of a tick.

All rows are 64-bit floats. Times are seconds since the loop began (its tick 0), on the clock of
`worker`; whole numbers in them are exact to 2^53.
"""

from __future__ import annotations

SAMPLE_COLUMNS = ("sample_time_s", "x_m", "y_m", "touching", "device_level_V", "amplitude_m")
"""A finger sample in: when it was taken and where the finger was; not-a-number where a device
reports no output level or no vibration amplitude (by its pickup) with it."""
SAMPLE_TIME, SAMPLE_X, SAMPLE_Y, SAMPLE_TOUCHING, SAMPLE_LEVEL, SAMPLE_AMPLITUDE = range(6)

COMMAND_COLUMNS = ("tick", "output_time_s", "amplitude_m", "command_V")
"""A command out: amplitude and voltage (zero-to-peak) to hold from the output time on, until the
next one's. Negative in inverted phase, which only a plan that may brake gives."""
COMMAND_TICK, COMMAND_TIME, COMMAND_AMPLITUDE, COMMAND_VOLTAGE = range(4)

COLUMNS = (
    "tick",
    "time_s",
    "sample_time_s",
    "x_m",
    "y_m",
    "speed_m_per_s",
    "wanted_amplitude_m",
    "command_V",
    "device_level_V",
    "amplitude_m",
    "relative_friction",
    "lag_m",
    "lateness_s",
    "flags",
)
"""A row of the record, one per tick made:

- `tick`: its number; numbers left out were lost. `time_s`: when it was due, tick/rate.
- `sample_time_s`: of the newest sample that the estimate rests on; NaN before the first.
- `x_m`, `y_m`, `speed_m_per_s`: the finger as estimated for `time_s`; speed along its path.
- `wanted_amplitude_m`: of the texture, where the finger is expected when the command acts.
- `command_V`: commanded for the step that begins at `time_s` (plus the plan's output delay).
- `device_level_V`, `amplitude_m`: as the device last reported them; NaN if it never did.
- `relative_friction`: at `amplitude_m`, or without a pickup at the amplitude that the envelope's
  model has at `time_s`; NaN without a friction curve.
- `lag_m`: how far the finger goes, at `speed_m_per_s`, between the newest sample and the moment the
  command is meant for, lateness included. A loop that did not predict would be behind by so much.
- `lateness_s`: from when the tick was due to when it was made; always less than a period.
- `flags`: a sum of the flags below.
"""
TICK, TIME, ROW_SAMPLE_TIME, X, Y, SPEED, WANTED = range(7)
VOLTAGE, LEVEL, AMPLITUDE, FRICTION, LAG, LATENESS, FLAGS = range(7, 14)

# The first ten are the renderer's own (`physics.render.program.layout`): 1 bad place … 512
# saturated.
NEW_SAMPLE = 1 << 10
REJECTED_SAMPLE = 1 << 11
NO_FRESH_SAMPLE = 1 << 12
NOT_TOUCHING = 1 << 13
AT_TOP = 1 << 14
AT_BOTTOM = 1 << 15
AFTER_LOST_TICKS = 1 << 16
REFUSED_COMMAND = 1 << 17
COMMAND_DROPPED = 1 << 18
ROW_DROPPED = 1 << 19
MUTED = 1 << 20
HOST_SILENT = 1 << 21

FLAG_MEANINGS: dict[int, str] = {
    1: "the finger's place or speed is no place on a display",
    2: "the time is not finite",
    4: "time ran backwards",
    8: "the time of the last tick again",
    16: "the texture has no finite value here",
    32: "no good sample for so long that the renderer's hold ran out",
    64: "more friction wanted than at rest",
    128: "less friction wanted than the display reaches",
    256: "an amplitude below zero wanted",
    512: "a larger amplitude wanted than the display reaches",
    NEW_SAMPLE: "at least one finger sample came",
    REJECTED_SAMPLE: "a finger sample was not used: not finite, an outlier, old, or twice",
    NO_FRESH_SAMPLE: "the finger's place is not known, nothing is played",
    NOT_TOUCHING: "the finger does not touch, nothing is played",
    AT_TOP: "the command met the largest amplitude",
    AT_BOTTOM: "the command met the least amplitude: the plate cannot fall faster",
    AFTER_LOST_TICKS: "ticks were lost just before this one",
    REFUSED_COMMAND: "the command was no number within the drive's range; zero was sent",
    COMMAND_DROPPED: "nobody took the commands; this one is lost",
    ROW_DROPPED: "nobody took the rows; at least one before this is lost",
    MUTED: "the host muted the loop",
    HOST_SILENT: "the host did not touch the loop for longer than its timeout",
}
"""Meaning of each flag, for people."""


def flag_meanings(flags: float) -> list[str]:
    """Meanings of the flags of a row, in words; empty for 0."""
    value = int(flags)
    return [meaning for flag, meaning in FLAG_MEANINGS.items() if value & flag]
