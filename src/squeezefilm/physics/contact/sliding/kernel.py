"""The compiled march of the skin, under friction by rows over its own speed.

Between two speeds of the grid friction is a line, so that it is one more damper there: the skin's
equation stays linear from knot to knot, and `skin_path` solves it however great that damper is. The
instants at which the speed passes a knot, and at which slips begin and end, are found inside the
step: no speed is regularised, and a stuck skin does not move at all. Where friction changes with
time as well, it is a line in time over a piece; a piece in which that strays from the law is
shortened.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.physics.contact.sliding.pieces import (
    STAYS,
    BoneDrive,
    BoneStep,
    Rows,
    SkinState,
    beyond,
    interval_at,
    on_law,
    pull_at,
    slip_over,
    slipped,
    stay,
)
from squeezefilm.physics.contact.sliding.skin_path import HALVINGS, TERMS, LumpedSkin

# Slip starts and ends that one sample interval may hold before the march gives up.
MOST_EVENTS = 200
# Of the strongest friction: how far the line used may stray from the law at the end of a piece.
LAW_TOLERANCE = 3e-4
# Pieces are shortened down to this part of a substep.
_SHORTEST = 2.0**-40
# Of a step: what rounding leaves over.
_LAST = 1e-14


class Track(NamedTuple):
    """Record of a march; `position[0]` and `speed[0]` hold the start.

    `work` (3, n) is the work done by the bone, lost to friction and to damping. `account` is the
    time stuck (s), slips begun, and the largest departure of the friction used from the friction
    law at the end of a piece (over the strongest of all).
    """

    position: si.Array
    speed: si.Array
    friction: si.Array
    bone_force: si.Array
    stuck: si.Array
    work: si.Array
    account: si.Array


@compiled(forceinline=True)
def strongest_and_fall(rows: Rows, force: si.Array) -> tuple[float, float]:
    """The strongest friction (N) of all rows at `force` (N) for each of their units, and its
    steepest fall with speed (N·s/m), at least 0."""
    speed, coefficient = rows
    top, fall = np.zeros(speed.size), np.zeros(speed.size)
    for i in range(force.size):
        row, load = coefficient[min(i, coefficient.shape[0] - 1)], force[i]
        # Knot by knot, which a processor does for several at once.
        for j in range(speed.size - 1):
            high = row[j] * load
            down = high - row[j + 1] * load
            top[j] = high if high > top[j] else top[j]
            fall[j] = down if down > fall[j] else fall[j]
        top[-1] = max(top[-1], row[-1] * load)
    return top.max(), (fall[:-1] / np.diff(speed)).max()


@compiled(forceinline=True)
def interval_march(
    at: SkinState,
    now: BoneStep,
    drive: BoneDrive,
    skin: LumpedSkin,
    rows: Rows,
    static_ratio: float,
    tolerance: float,
    series: si.Array,
    work: si.Array,
    account: si.Array,
) -> tuple[SkinState, bool]:
    """March the skin over an interval, adding to its `work` and to `account`. False where slips
    began and ended, or speeds were passed, too often."""
    h = drive.time_step / drive.substeps
    trial, s, events, passed = h, 0.0, 0, 0
    for number in range(drive.substeps):
        goal = drive.time_step if number == drive.substeps - 1 else (number + 1) * h
        tries = 0
        while s < goal:
            if goal - s <= _LAST * drive.time_step:
                s = goal
                break
            reach, part = min(trial, goal - s), 0.0
            pull = pull_at(s, now, skin)
            if at.side == 0.0 and now.free:
                side = math.copysign(1.0, pull.start - skin.stiffness * at.place)
                at = SkinState(at.place, at.speed, side, 0)
                account[1] += 1.0
            if at.side != 0.0:
                slip = slip_over(reach, s, at, pull, now, drive, skin, rows, series)
                part = slip.part
            if part == 0.0:
                # After a slip too short to be found it stays for longer each time.
                briefly = min(reach * 0.5**HALVINGS * 4.0**tries, reach)
                tries += at.side != 0.0
                part, side = stay(at, s, goal, briefly, pull, now, static_ratio, skin, work)
                account[0] += part
                account[1] += abs(side) - abs(at.side)
                events += side != 0.0
                at = SkinState(at.place, at.speed, side, 0 if side != 0.0 else at.knot)
                s = goal if part == goal - s else s + part
                trial = h
            elif slip.astray > tolerance and reach > _SHORTEST * h:
                trial = part * max(0.1, 0.8 * math.sqrt(tolerance / slip.astray))
            else:
                s = goal if part >= goal - s else s + part
                trial = h
                if slip.astray > 0.01 * tolerance:
                    trial = min(h, reach * max(1.0, 0.8 * math.sqrt(tolerance / slip.astray)))
                if slip.astray > 0.0:
                    account[2] = max(account[2], LAW_TOLERANCE * slip.astray / tolerance)
                at = slipped(slip, at, skin, series, work)
                if slip.ended != STAYS:
                    at, stopped = beyond(slip, s, at, pull, now, static_ratio, skin.stiffness)
                    account[1] += stopped and at.side != 0.0
                    passed, events = passed + 1, events + stopped
            if events > MOST_EVENTS or passed > 2 * MOST_EVENTS * rows.speed.size:
                return at, False
    return at, True


@compiled(forceinline=True)
def record(i: int, at: SkinState, load: float, drive: BoneDrive, rows: Rows, track: Track) -> None:
    """Write sample i of the skin, pulled with a load (N), into the track."""
    track.position[i], track.speed[i] = at.place, at.speed
    track.stuck[i] = at.side == 0.0
    track.bone_force[i] = track.friction[i] = load
    if at.side != 0.0:
        # The law itself, from which the line that moved the skin may have strayed.
        law = drive.limit[i] * on_law(rows.speed, rows.coefficient, i, at.knot, abs(at.speed))
        # Where friction vanishes at rest, a skin that has turned is still on its line.
        track.friction[i] = math.copysign(law, at.speed if at.speed != 0.0 else at.side)


@compiled()
def slide_march(
    drive: BoneDrive,
    skin: LumpedSkin,
    rows: Rows,
    static_ratio: float,
    strongest: float,
    track: Track,
) -> int:
    """March the skin over all n samples; `strongest` is the strongest friction of all (N).

    Returns n, or the interval in which slip started and ended, or speeds were passed, too often.
    """
    k, c, account = skin.stiffness, skin.damping, track.account
    tolerance, series, work = LAW_TOLERANCE * strongest, np.empty(TERMS), np.empty(3)
    x, v, side, j = track.position[0], track.speed[0], 0.0, 0
    load = k * (drive.bone[0] - x) + c * (drive.speed_in[0] - v)
    holds = static_ratio * (drive.limit[0] * rows.coefficient[0, 0])
    if v != 0.0:
        side = math.copysign(1.0, v)
    elif abs(load) > holds or rows.coefficient[:2, 0].max() == 0.0:
        side = math.copysign(1.0, load)
        account[1] += 1.0
    while j < rows.speed.size - 1 and rows.speed[j + 1] <= abs(v):
        j += 1
    at = SkinState(x, v, side, j)
    record(0, at, load, drive, rows, track)
    for i in range(drive.bone.size - 1):
        # Where the way has turned of itself.
        side = -at.side if at.side * at.speed < 0.0 else at.side
        at, now = SkinState(at.place, at.speed, side, at.knot), interval_at(i, drive, rows)
        work[:] = 0.0
        at, done = interval_march(
            at, now, drive, skin, rows, static_ratio, tolerance, series, work, account
        )
        if not done:
            return i
        load = k * (drive.bone[i + 1] - at.place) + c * (drive.speed_out[i] - at.speed)
        record(i + 1, at, load, drive, rows, track)
        for kind in range(3):
            track.work[kind, i + 1] = track.work[kind, i] + work[kind]
    return int(drive.bone.size)
