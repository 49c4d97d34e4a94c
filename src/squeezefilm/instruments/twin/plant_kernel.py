"""The compiled plant: amplifier, plate, film and friction, skin, finger and arm, and the sensor.

It advances to a time on a grid of steps counted in whole µs, so that no phase is lost over hours
and the outcome does not depend on the pieces in which time is advanced. In each step

1. the amplifier gives what its limits allow,
2. the plate's envelope is stepped in closed form, with the mode as warmth, speed and field leave
   it, by the same functions as the prediction (`physics.plate.heat_states`),
3. the arm leads the finger, a mass on spring and damper, in closed form under the skin's pull,
   which is extrapolated to the middle of the step (second order),
4. the skin follows by the compiled marches of `physics.contact.sliding`, under the friction of the
   law behind the amplitude by a time constant: over its own sliding speed where the law depends on
   that, the rows at the start and the end of the step between which it is a line,
5. the sensor takes its samples, and the truth gets a row where one is due.

Motion is along x for the skin; along y the arm leads without friction.

Noise is by number: the n-th value of a stream is a function of seed, stream and n alone, so that it
does not depend on how often or in which pieces time is advanced. The mixing is that of splitmix64
(Steele, Lea and Flood 2014, 10.1145/2714064.2660195).
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.instruments.twin.envelope_step import (
    Electrical,
    EnvelopeLimits,
    Fingers,
    FrictionTables,
    Resonance,
    at_speed,
    drawn_current,
    envelope_step,
    row_between,
    table_place,
    voltage_given,
)
from squeezefilm.instruments.twin.hand import wanted
from squeezefilm.physics.contact.sliding.kernel import Track, slide_march
from squeezefilm.physics.contact.sliding.pieces import BoneDrive, Rows
from squeezefilm.physics.contact.sliding.skin_path import Forces, LumpedSkin, slide_by, transition
from squeezefilm.physics.plate.heat_states import Drifts, changed, warmed
from squeezefilm.physics.plate.thermal import Cooling

# The state, float64: plate; finger; skin and friction; output; what the sensor shows.
Z_RE, Z_IM, WARMTH, RESONANCE, LOST = range(5)
X, VX, Y, VY = range(5, 9)
SKIN_X, SKIN_V, PULL, PULL_BEFORE, BEFORE, FRICTION, FORCE = range(9, 16)
VOLTAGE, CURRENT_A, RELATIVE, SEEN_X, SEEN_Y = range(16, 21)
CHARGE = 21  # the charge coefficient over the cold one
FELT = 22  # the amplitude that friction has followed (m)
STATE = 23
# The counts, int64; times in µs.
NOW, SEEN_TAKEN, SEEN_TOUCHING, SAMPLE, HEAD, TAIL, ARRIVED, ROWS = range(8)
BEYOND, FAILED, LOST_SAMPLES, CARRIER = range(8, 12)
COUNTS = 12
# The constants, float64: steps; plate; its drift; amplifier; arm and skin; friction; sensor.
C_STEP, C_ROW, C_SEED, C_F0, C_Q, C_PER_VOLT, C_FACTOR = range(7)
C_OFFSET, C_AGEING, C_COEFFICIENT, C_SWING, C_PERIOD = range(7, 12)
C_QUALITY_DRIFT, C_CHARGE_DRIFT, C_SOFTENING, C_FIELD_DRIFT, C_CAPACITY = range(12, 17)
C_COOLING, C_FACE, C_FACE_LENGTH, C_EMISSIVITY, C_ROOM = range(17, 22)  # fields of `Cooling`
C_GAIN, C_RAIL, C_CURRENT, C_SLEW, C_C0, C_LOSS = range(22, 28)
C_MASS, C_STIFFNESS, C_DAMPING, C_PAD_MASS, C_PAD_DAMPING, C_PAD_STIFFNESS = range(28, 34)
C_SUBSTEPS, C_STATIC, C_EXPONENT, C_REFERENCE, C_FORCE = range(34, 39)
C_RATE, C_LATENCY, C_JITTER, C_NOISE, C_QUANTUM, C_SHARE_LOST = range(39, 45)
C_LAG = 45  # s
CONSTANTS = 46
COLUMNS = (
    "time_s",
    "x_m",
    "y_m",
    "speed_m_per_s",
    "level_V",
    "frequency_Hz",
    "amplitude_m",
    "relative_friction",
    "tangential_force_N",
    "normal_force_N",
    "voltage_V",
    "current_A",
    "resonance_Hz",
    "skin_x_m",
)
"""Columns of the truth."""

THERMAL = 10_000  # µs between looks at the temperature
_NOISE_X, _NOISE_Y, _DELAY, _LOSS = 1, 2, 3, 4
_STEP = np.uint64(0x9E3779B97F4A7C15)
_FIRST = np.uint64(0xBF58476D1CE4E5B9)
_SECOND = np.uint64(0x94D049BB133111EB)
_THIRTY, _SEVEN, _ONE = np.uint64(30), np.uint64(27), np.uint64(31)
_DROPPED = np.uint64(11)
_TWO_53 = 2.0**-53
_LEAST = 1e-15  # m


@compiled()
def mixed(number: Any) -> Any:
    """A 64-bit number with its bits mixed."""
    z = np.uint64(number) + _STEP
    z = (z ^ (z >> _THIRTY)) * _FIRST
    z = (z ^ (z >> _SEVEN)) * _SECOND
    return z ^ (z >> _ONE)


@compiled()
def uniform(seed: int, stream: int, number: int) -> float:
    """The `number`-th uniform value of a stream, above 0 and below 1."""
    z = mixed(mixed(np.uint64(seed)) ^ mixed(np.uint64(stream) + _FIRST))
    z = mixed(z ^ mixed(np.uint64(number) + _SECOND))
    return (float(z >> _DROPPED) + 0.5) * _TWO_53


@compiled()
def gaussian(seed: int, stream: int, number: int) -> float:
    """The `number`-th standard normal value of a stream (Box and Muller)."""
    radius = math.sqrt(-2.0 * math.log(uniform(seed, 2 * stream, number)))
    return radius * math.cos(2.0 * math.pi * uniform(seed, 2 * stream + 1, number))


class HandPath(NamedTuple):
    """The hand's places and its plan, as `hand.wanted` takes them."""

    places: si.Array
    plan: si.Array


class Contact(NamedTuple):
    """Contact of skin and surface over one step, kept so that no step allocates it.

    `tables` are what its friction is read from. `limit` (2,) is the friction force (N) for each of
    a row's units, at the start and the end of the step, and `rows` (2, k) µ′/µ over the skin's
    speeds.
    """

    tables: FrictionTables
    bone: si.Array
    speed_in: si.Array
    speed_out: si.Array
    limit: si.Array
    rows: si.Array
    track: Track


class PlantState(NamedTuple):
    """State, counts and constants, at the places that are named above, and the skin's contact."""

    state: si.Array
    counts: si.Array
    constants: si.Array
    contact: Contact


def untouched(tables: FrictionTables) -> Contact:
    """The contact of a surface that nothing has touched yet, under friction of these tables."""
    place, speed, friction, pull = np.zeros(2), np.zeros(2), np.zeros(2), np.zeros(2)
    stuck, work, account = np.zeros(2, dtype=np.bool_), np.zeros((3, 2)), np.zeros(3)
    track = Track(place, speed, friction, pull, stuck, work, account)
    bone, limit, speed_in, speed_out = np.zeros(2), np.zeros(2), np.zeros(1), np.zeros(1)
    rows = np.zeros((2, tables.speed.size))
    return Contact(tables, bone, speed_in, speed_out, limit, rows, track)


@compiled()
def resonance(time: int, warmth: float, c: si.Array) -> float:
    """The plate's resonance frequency (Hz) at a time (µs) and a self-heating (K)."""
    period = np.int64(c[C_PERIOD])
    turn = 2.0 * math.pi * ((time % period) / period)
    kelvin = warmth + c[C_SWING] * math.sin(turn)
    shift = c[C_OFFSET] + c[C_AGEING] * (time * 1e-6) + c[C_COEFFICIENT] * kelvin
    return float(c[C_F0] * (1.0 + shift))


@compiled()
def _sense(
    t0: int, h_us: int, x0: float, y0: float, plant: PlantState, ring: si.Array, touching: bool
) -> None:
    s, n, c, _ = plant
    seed = int(c[C_SEED])
    while True:
        k = n[SAMPLE]
        taken = np.int64(k * 1e6 / c[C_RATE])
        if taken > t0 + h_us:
            break
        n[SAMPLE] = k + 1
        if uniform(seed, _LOSS, k) < c[C_SHARE_LOST]:
            n[LOST_SAMPLES] += 1
            continue
        share = (taken - t0) / h_us
        x = x0 + share * (s[X] - x0) + c[C_NOISE] * gaussian(seed, _NOISE_X, k)
        y = y0 + share * (s[Y] - y0) + c[C_NOISE] * gaussian(seed, _NOISE_Y, k)
        if c[C_QUANTUM] > 0.0:
            x = c[C_QUANTUM] * np.round(x / c[C_QUANTUM])
            y = c[C_QUANTUM] * np.round(y / c[C_QUANTUM])
        delay = max(c[C_LATENCY] + c[C_JITTER] * gaussian(seed, _DELAY, k), 0.0)
        n[ARRIVED] = max(n[ARRIVED], taken + np.int64(round(delay)))
        at = n[HEAD] % ring.shape[0]
        ring[at, 0], ring[at, 1], ring[at, 2] = n[ARRIVED], taken, 1.0 if touching else 0.0
        ring[at, 3], ring[at, 4] = x, y
        n[HEAD] += 1
        if n[HEAD] - n[TAIL] > ring.shape[0]:
            n[TAIL] += 1
    while n[TAIL] < n[HEAD]:
        at = n[TAIL] % ring.shape[0]
        if ring[at, 0] > t0 + h_us:
            break
        n[SEEN_TAKEN], n[SEEN_TOUCHING] = np.int64(ring[at, 1]), np.int64(ring[at, 2])
        s[SEEN_X], s[SEEN_Y] = ring[at, 3], ring[at, 4]
        n[TAIL] += 1


@compiled()
def _follow(h: float, x0: float, x1: float, y0: float, y1: float, s: si.Array, c: si.Array) -> None:
    """The finger's bone after a step in which the arm's wanted place goes from 0 to 1."""
    d, k = c[C_DAMPING], c[C_STIFFNESS]
    arm = LumpedSkin(c[C_MASS], d, k)
    by = transition(h, arm)
    ahead = s[PULL]
    if s[BEFORE] > 0.0:
        ahead += 0.5 * (s[PULL] - s[PULL_BEFORE]) * h / s[BEFORE]
    pull = (k * x0 + d * (x1 - x0) / h, k * (x1 - x0) / h, 0.0)
    s[X], s[VX], _ = slide_by(by, h, s[X], s[VX], Forces(pull, ahead, 0.0), arm)
    pull = (k * y0 + d * (y1 - y0) / h, k * (y1 - y0) / h, 0.0)
    s[Y], s[VY], _ = slide_by(by, h, s[Y], s[VY], Forces(pull, 0.0, 0.0), arm)


@compiled()
def lagged(felt: float, before: float, after: float, h: float, lag: float) -> float:
    """Value that follows an amplitude (m) with a time constant `lag` (s; 0: at once), after a step
    h (s) in which the amplitude goes straight from `before` to `after`."""
    if lag <= 0.0 or (after == 0.0 and felt < _LEAST):
        return after
    behind = lag * (after - before) / h
    return after - behind + (felt - before + behind) * math.exp(-h / lag)


@compiled()
def _grip(force: float, amplitude: float, plant: PlantState, fingers: Fingers) -> None:
    """The friction at the end of a step; what was there becomes that at its start."""
    _, n, c, (tables, _, _, _, limit, rows, _) = plant
    i, p, j, q, beyond = table_place(force, amplitude, fingers)
    n[BEYOND] += beyond
    ref = c[C_REFERENCE]
    limit[0] = limit[1]
    rows[0] = rows[1]
    rest = row_between(tables, i, p, j, q, rows[1])
    limit[1] = rest * ref * (force / ref) ** c[C_EXPONENT]


@compiled()
def _drag(h: float, x0: float, v0: float, plant: PlantState) -> None:
    """The skin under a bone that went from x0 with v0, under the friction of the contact."""
    s, n, c, (tables, bone, speed_in, speed_out, limit, rows, track) = plant
    speeds = tables.speed
    mean, bend = (s[X] - x0) / h, 0.5 * (s[VX] - v0)
    bone[0], bone[1], speed_in[0], speed_out[0] = x0, s[X], mean - bend, mean + bend
    track.position[0], track.speed[0] = s[SKIN_X], s[SKIN_V]
    drive = BoneDrive(bone, speed_in, speed_out, limit, h, int(c[C_SUBSTEPS]))
    skin = LumpedSkin(c[C_PAD_MASS], c[C_PAD_DAMPING], c[C_PAD_STIFFNESS])
    strongest = max(limit[0], limit[1])
    done = slide_march(drive, skin, Rows(speeds, rows), c[C_STATIC], strongest, track)
    s[PULL_BEFORE], s[BEFORE] = s[PULL], h
    if done < 2:
        # Chattering without end: let the skin go with the bone, and say so in the counts.
        n[FAILED] += 1
        s[SKIN_X], s[SKIN_V], s[PULL], s[FRICTION] = s[X], 0.0, 0.0, 0.0
    else:
        s[SKIN_X], s[SKIN_V] = track.position[1], track.speed[1]
        s[FRICTION], s[PULL] = track.friction[1], track.bone_force[1]
    s[RELATIVE] = at_speed(speeds, rows[1], abs(s[SKIN_V]))


@compiled()
def advance(
    until: int,
    level: int,
    carrier: int,
    plant: PlantState,
    fingers: Fingers,
    path: HandPath,
    ring: si.Array,
    truth: si.Array,
) -> int:
    """Advance to `until` (µs) at a level (µV) and a carrier frequency (mHz).

    Returns the time reached; earlier than `until` where `truth` (rows, columns) is full, to be
    emptied by setting the count ROWS to 0. Allocates a few numbers a step, never raises.
    """
    s, n, c, rows = plant.state, plant.counts, plant.constants, plant.contact.rows
    places, plan = path
    step, row = np.int64(c[C_STEP]), np.int64(c[C_ROW])
    drifts = Drifts(0.0, c[C_QUALITY_DRIFT], c[C_CHARGE_DRIFT], c[C_SOFTENING], c[C_FIELD_DRIFT])
    cooling = Cooling(c[C_COOLING], c[C_FACE], c[C_FACE_LENGTH], c[C_EMISSIVITY], c[C_ROOM])
    limits = EnvelopeLimits(c[C_RAIL], c[C_CURRENT], c[C_SLEW])
    if carrier > 0:
        n[CARRIER] = carrier
    here = wanted(n[NOW], places, plan)
    while n[NOW] < until:
        if n[ROWS] >= truth.shape[0]:
            return int(n[NOW])
        t0 = n[NOW]
        t1 = min((t0 // step + 1) * step, until)
        h = (t1 - t0) * 1e-6
        there = wanted(t1, places, plan)
        x0, v0, y0 = s[X], s[VX], s[Y]
        z = complex(s[Z_RE], s[Z_IM])
        before, began = abs(z), s[FORCE]
        force = c[C_FORCE] * there[2]
        speed = 2.0 * math.pi * s[RESONANCE] * before
        quality, s[CHARGE], soft = changed(c[C_Q], s[WARMTH], speed, s[VOLTAGE], drifts)
        f0 = s[RESONANCE] * soft
        plate = Electrical(c[C_C0], c[C_LOSS], c[C_FACTOR] * s[CHARGE])
        frequency = n[CARRIER] * 1e-3 if n[CARRIER] > 0 else f0
        if level > 0 or before > 0.0:
            omega = 2.0 * math.pi * frequency
            asked = level * 1e-6 * c[C_GAIN]
            s[VOLTAGE] = voltage_given(asked, z, omega, plate, limits)
            swing = Resonance(frequency / f0, quality, quality / (math.pi * f0))
            held = c[C_PER_VOLT] * s[CHARGE] * quality / c[C_Q] * s[VOLTAGE]
            z = envelope_step(z, held, h, swing, 0.5 * (began + force), fingers)
            s[Z_RE], s[Z_IM] = z.real, z.imag
            drawn = drawn_current(s[VOLTAGE], z, omega, plate)
            s[CURRENT_A] = abs(drawn)
            # In the material and in the capacitance; what the finger takes warms the finger.
            inside = c[C_FACTOR] * c[C_Q] / (c[C_PER_VOLT] * quality) * abs(z) ** 2
            s[LOST] += 0.5 * omega * h * (inside + c[C_C0] * c[C_LOSS] * s[VOLTAGE] ** 2)
        else:
            s[VOLTAGE], s[CURRENT_A] = 0.0, 0.0
        amplitude = abs(z)
        s[FELT] = lagged(s[FELT], before, amplitude, h, c[C_LAG])
        _follow(h, here[0], there[0], here[1], there[1], s, c)
        s[FORCE] = force
        if force > 0.0 or began > 0.0:
            _grip(force, s[FELT], plant, fingers)
            if began <= 0.0:
                # A relaxed skin, that lands with the bone's place and speed.
                s[SKIN_X], s[SKIN_V], rows[0] = x0, v0, rows[1]
            _drag(h, x0, v0, plant)
        if force <= 0.0:
            s[SKIN_X], s[SKIN_V] = s[X], s[VX]
            s[PULL], s[PULL_BEFORE], s[BEFORE], s[FRICTION] = 0.0, 0.0, 0.0, 0.0
            s[RELATIVE] = math.nan
        n[NOW] = t1
        here = there
        _sense(t0, t1 - t0, x0, y0, plant, ring, force > 0.0)
        if t1 % THERMAL == 0:
            part = THERMAL * 1e-6
            s[WARMTH] = warmed(s[WARMTH], s[LOST] / part, part, c[C_CAPACITY], cooling)
            s[LOST] = 0.0
            s[RESONANCE] = resonance(t1, s[WARMTH], c)
        if t1 % row == 0:
            out = truth[n[ROWS]]
            out[0], out[1], out[2], out[3] = t1 * 1e-6, s[X], s[Y], math.hypot(s[VX], s[VY])
            out[4], out[5], out[6] = level * 1e-6, frequency, amplitude
            out[7], out[8], out[9] = s[RELATIVE], s[FRICTION], s[FORCE]
            out[10], out[11], out[12], out[13] = s[VOLTAGE], s[CURRENT_A], f0, s[SKIN_X]
            n[ROWS] += 1
    return int(n[NOW])
