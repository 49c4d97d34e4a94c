"""A compiled tick of the loop: samples in, one command and one row out; no Python, no memory.

The steps are those of `physics.render.fidelity.rendered_stroke`, by the same compiled functions:
the estimator takes what has arrived, the finger is predicted to the moment the command is meant
for, the texture asked there, its amplitude compensated and turned into volts. Nothing raises; what
is wrong becomes a flag and a command of zero.
"""

from __future__ import annotations

import math
from typing import Any

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.instruments.session.loop import plan as at
from squeezefilm.instruments.session.loop import rows as column
from squeezefilm.instruments.session.loop.shared import DROPPED, SAMPLES, ring_put, ring_take
from squeezefilm.physics.render.motion import kernel as motion_kernel
from squeezefilm.physics.render.motion.kernel import motion_at, motion_step
from squeezefilm.physics.render.program import layout
from squeezefilm.physics.render.program.interpreter import tick as rendered_amplitude
from squeezefilm.physics.render.resonator import kernel as compensation_kernel
from squeezefilm.physics.render.resonator.kernel import compensated_step, envelope_step


@compiled(error_model="numpy")
def interpolated(places: si.Array, values: si.Array, place: float) -> float:
    """The value at a place, linear between knots that rise; held beyond the ends, NaN without."""
    last = places.size - 1
    if last < 1 or math.isnan(place):
        return math.nan
    if place >= places[last]:
        return float(values[last])
    low, high = 0, last
    while high - low > 1:
        middle = (low + high) >> 1
        if places[middle] <= place:
            low = middle
        else:
            high = middle
    share = (place - places[low]) / (places[high] - places[low])
    return float(values[low] + max(share, 0.0) * (values[high] - values[low]))


@compiled(error_model="numpy")
def _friction(arrays: Any, amplitude: float, speed: float) -> float:
    """Relative friction of an amplitude (m) under a finger at a speed (m/s), linear between the
    table's; held beyond. NaN without a table, and without a speed where friction depends on it."""
    speeds, amplitudes, known = arrays.friction_speed, arrays.friction_amplitude, arrays.friction
    last = speeds.size - 1
    if last == 0:
        return float(interpolated(amplitudes, known[0], amplitude))
    if math.isnan(speed):
        return math.nan
    high = 1
    while high < last and speeds[high] <= speed:
        high += 1
    share = (speed - speeds[high - 1]) / (speeds[high] - speeds[high - 1])
    share = min(max(share, 0.0), 1.0)
    below = interpolated(amplitudes, known[high - 1], amplitude)
    return float((1.0 - share) * below + share * interpolated(amplitudes, known[high], amplitude))


@compiled(error_model="numpy")
def _listen(arrays: Any, sample: si.Array) -> int:
    """Take one finger sample into the estimators; returns flags."""
    memory = arrays.memory
    level, amplitude = sample[column.SAMPLE_LEVEL], sample[column.SAMPLE_AMPLITUDE]
    if math.isfinite(level):
        memory[at.REPORTED_LEVEL] = level
    if math.isfinite(amplitude):
        memory[at.REPORTED_AMPLITUDE] = amplitude
    stamp = sample[column.SAMPLE_TIME]
    x, y = sample[column.SAMPLE_X], sample[column.SAMPLE_Y]
    # Before all else, and not a number counts as lifted: a sensor need not say where nothing is.
    if not sample[column.SAMPLE_TOUCHING] > 0.0:
        # What a finger did before it lifted says nothing of how it comes back.
        memory[at.TOUCHING] = 0.0
        arrays.motion_x[motion_kernel.ALIVE] = 0.0
        arrays.motion_y[motion_kernel.ALIVE] = 0.0
        return 0
    if not math.isfinite(x + y):
        # Half a place is none: both axes count it.
        x, y = math.nan, math.nan
    code = motion_step(arrays.motion_x, arrays.motion_parameters, stamp, x)
    other = motion_step(arrays.motion_y, arrays.motion_parameters, stamp, y)
    if code <= motion_kernel.STEP_STARTED and other <= motion_kernel.STEP_STARTED:
        memory[at.TOUCHING] = 1.0
        memory[at.STAMP] = stamp
        return 0
    return column.REJECTED_SAMPLE


@compiled(error_model="numpy")
def _pass_lost_ticks(arrays: Any, lost: int) -> None:
    """Carry the envelope past lost ticks: it followed the last command, or the drive stopped."""
    state, envelope, settings = arrays.compensator, arrays.envelope, arrays.settings
    place = compensation_kernel.AMPLITUDE
    if lost * settings[at.DT] > settings[at.LONGEST_GAP]:
        state[place] = 0.0
        return
    held, amplitude = arrays.memory[at.COMMAND], state[place]
    rises = held > amplitude
    keep = envelope[compensation_kernel.KEEP_RISE if rises else compensation_kernel.KEEP_FALL]
    state[place] = held + (amplitude - held) * keep**lost


@compiled(error_model="numpy")
def _commanded(arrays: Any, wanted: float, silent: bool) -> tuple[float, int]:
    """The amplitude to command for one that is wanted (m), and flags."""
    state, envelope = arrays.compensator, arrays.envelope
    if silent:
        return compensated_step(state, envelope, math.nan)[0], 0
    if arrays.settings[at.INVERSE] != 0.0:
        command, code = compensated_step(state, envelope, wanted)
        if code == compensation_kernel.TOPPED:
            return command, column.AT_TOP
        return command, column.AT_BOTTOM if code == compensation_kernel.BOTTOMED else 0
    top, place = envelope[compensation_kernel.TOP], compensation_kernel.AMPLITUDE
    command = min(wanted, top)
    state[place] = envelope_step(
        state[place],
        command,
        envelope[compensation_kernel.KEEP_RISE],
        envelope[compensation_kernel.KEEP_FALL],
    )
    return command, column.AT_TOP if wanted > top else 0


@compiled(error_model="numpy")
def _wanted(arrays: Any, meant: float) -> tuple[float, bool, int]:
    """The amplitude wanted at the moment a command is meant for (m), whether the output is to be
    silent, and flags."""
    memory, parameters = arrays.memory, arrays.motion_parameters
    x, vx, _, _, code_x = motion_at(arrays.motion_x, parameters, meant)
    y, vy, _, _, code_y = motion_at(arrays.motion_y, parameters, meant)
    if memory[at.SILENCED] != 0.0:
        return 0.0, True, int(memory[at.SILENCED])
    if memory[at.TOUCHING] == 0.0:
        return 0.0, False, column.NOT_TOUCHING
    if code_x != motion_kernel.FRESH or code_y != motion_kernel.FRESH:
        return 0.0, False, column.NO_FRESH_SAMPLE
    speed = math.hypot(vx, vy)
    wanted = rendered_amplitude(arrays.program, arrays.render_state, x, y, speed, meant)
    return wanted, False, int(arrays.render_state[layout.S_FLAGS])


@compiled(error_model="numpy")
def _driven(arrays: Any, command: float) -> tuple[float, float, int]:
    """The command that may be given (m), its voltage (V), and flags."""
    top, bottom = (
        arrays.envelope[compensation_kernel.TOP],
        arrays.envelope[compensation_kernel.BOTTOM],
    )
    # Written so that it refuses a NaN too.
    if bottom <= command <= top:
        return command, command / arrays.settings[at.PER_VOLT], 0
    arrays.compensator[compensation_kernel.AMPLITUDE] = 0.0
    return 0.0, 0.0, column.REFUSED_COMMAND


@compiled(error_model="numpy")
def make_tick(arrays: Any, shared: Any, number: int, lateness: float, lost: int) -> int:
    """Make the tick of a number, `lateness` (s) after it was due, with `lost` ones just before.

    `arrays` are `plan.TickArrays`, `shared` is `shared.Shared`. Returns the flags of its row.
    """
    settings, memory, row = arrays.settings, arrays.memory, arrays.row
    time = number * settings[at.DT]
    flags = column.AFTER_LOST_TICKS if lost > 0 else 0
    if lost > 0:
        _pass_lost_ticks(arrays, lost)
    heard = 0
    while heard < SAMPLES and ring_take(shared.sample_counters, shared.samples, arrays.sample):
        flags |= column.NEW_SAMPLE | _listen(arrays, arrays.sample[0])
        heard += 1

    parameters = arrays.motion_parameters
    x, vx, _, _, _ = motion_at(arrays.motion_x, parameters, time)
    y, vy, _, _, _ = motion_at(arrays.motion_y, parameters, time)
    meant = time + settings[at.LEAD]
    wanted, silent, why = _wanted(arrays, meant)

    amplitude = abs(arrays.compensator[compensation_kernel.AMPLITUDE])
    if math.isfinite(memory[at.REPORTED_AMPLITUDE]):
        amplitude = memory[at.REPORTED_AMPLITUDE]
    command, met = _commanded(arrays, wanted, silent)
    command, volts, refused = _driven(arrays, command)
    flags |= why | met | refused
    memory[at.COMMAND] = command

    out = arrays.command
    out[column.COMMAND_TICK] = number
    out[column.COMMAND_TIME] = time + settings[at.OUTPUT_DELAY]
    out[column.COMMAND_AMPLITUDE] = command
    out[column.COMMAND_VOLTAGE] = volts
    if not ring_put(shared.command_counters, shared.commands, out):
        flags |= column.COMMAND_DROPPED

    speed = math.hypot(vx, vy)
    if arrays.motion_x[motion_kernel.ALIVE] == 0.0:
        x, y, speed = math.nan, math.nan, math.nan
    row[column.TICK] = number
    row[column.TIME] = time
    row[column.ROW_SAMPLE_TIME] = memory[at.STAMP]
    row[column.X] = x
    row[column.Y] = y
    row[column.SPEED] = speed
    row[column.WANTED] = wanted
    row[column.VOLTAGE] = volts
    row[column.LEVEL] = memory[at.REPORTED_LEVEL]
    row[column.AMPLITUDE] = memory[at.REPORTED_AMPLITUDE]
    row[column.FRICTION] = _friction(arrays, amplitude, speed)
    row[column.LAG] = speed * (meant + lateness - memory[at.STAMP])
    row[column.LATENESS] = lateness
    row[column.FLAGS] = flags
    dropped = shared.row_counters[DROPPED]
    if memory[at.ROWS_DROPPED] != dropped:
        memory[at.ROWS_DROPPED] = dropped
        row[column.FLAGS] = flags | column.ROW_DROPPED
    ring_put(shared.row_counters, shared.rows, row)
    return flags
