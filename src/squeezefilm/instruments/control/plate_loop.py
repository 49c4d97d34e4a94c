"""One step of the loops that hold a plate: resonance tracked, amplitude held, finger's load seen.

The mode's envelope in the frame of its carrier, z (what a pickup shows, turned by its calibrated
phase), answers a drive u as

    τ ż = K u − (1 + D + i δ) z,   δ = (f − f0)/half-bandwidth,

D being what a finger adds to the loss, over the plate's own. Over a step a = e^{−T/τ}, so

    z − a z' − (1 − a) K u' = −(1 − a) (D + i δ) z'

gives D and δ of each step, whatever amplitude is being played. Of these

- the frequency follows δ by a loop of second order, which a steady drift leaves no error in;
- what a small amplitude shows is mostly noise, and moves both less: z²/(z² + soft²) of it;
- D is smoothed, and the drive gets what it takes: K u = w + κ (w − Re z) + D Re z makes the
  amplitude follow the wanted one, w, with a pole of its own. Nothing is integrated that winds up.

A plate that softens is on its upper branch from above only, so the search comes from there. It
stops at a phase within 45° of resonance where a free or loaded plate's amplitude is there too, and
then probes: half a half-bandwidth above, δ must be a half, whatever finger is on the plate, and is
not for crosstalk or a mode of another mass (a false lock, which is passed by). A lock is given up
for a phase that leaves or an amplitude that is missing (lost), or for one that no plate under a
finger has (false), and searched for again.

Integers alone, so that `firmware/squeezefilm_loops.c` gives the same numbers. Frequencies are in
mHz, voltages in µV, both finer where said.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from squeezefilm.core.compiled import compiled

# 64-bit integers throughout. Rounding is to the nearest and halves away from zero, so that it is
# symmetric and moves no average. The twin of the first part of `firmware/squeezefilm_loops.c`.
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


SEARCHING, PROBING, LOCKED, NOT_FOUND, WRONG_SIGN = range(5)
"""Modes; the last two are latched, without drive."""
LEVEL_HELD, FREQUENCY_HELD = 1, 2
"""Flags of a command that a limit held back."""
ONE = 1 << 16
SHARE = 1 << 24
MOST_PICKUP = 1 << 24  # µV
_MOST = MOST_PICKUP << 4
_FINE = 8  # bits of a mHz
_LARGEST_LOAD = 64 * ONE
_LEAST_LOAD = -(ONE // 2)


_ANY = (1 << 31) - 1
Share = Annotated[int, (0, SHARE)]
Signed = Annotated[int, (-_ANY - 1, _ANY)]
Positive = Annotated[int, (1, _ANY)]


class LoopGains(NamedTuple):
    """Settings of the loops, as `gains.loop_gains` makes them; the firmware's struct.

    Shares (of 2^24): `keep` a, `take` 1 − a, `ratio` K (pickup over drive), `track_share` and
    `rate_share` of the frequency's loop, `load_share` of the load's smoothing. Of 2^16: `turnover`
    1/(1 − a), `inverse` 1/K, `correction` κ, `heaviest` the largest D of a finger. In mHz:
    `half_bandwidth`, `lowest_frequency`, `highest_frequency`, `reference`; `sweep` in mHz/256 a
    step. `turn` (2^32 a turn) is the pickup's phase at `reference`, `turn_per_mhz` (2^40 a turn)
    its slope. `lowest_level`, `highest_level`, `search_level`, `floor` and `soft` are in µV:
    a pickup below `floor` tells nothing, one at `soft` is believed half. `patience` is how many
    steps something must be wrong. Each has the least and the most that a device counts.
    """

    keep: Share
    take: Annotated[int, (1, SHARE)]
    turnover: Annotated[int, (ONE, _ANY)]
    ratio: Annotated[int, (1, 4 * SHARE)]
    inverse: Positive
    correction: Signed
    half_bandwidth: Annotated[int, (1, 1 << 24)]
    track_share: Share
    rate_share: Share
    load_share: Share
    lowest_frequency: Positive
    highest_frequency: Positive
    sweep: Positive
    turn: Signed
    reference: Positive
    turn_per_mhz: Signed
    lowest_level: Annotated[int, (0, 0)]
    highest_level: Positive
    search_level: Positive
    floor: Annotated[int, (1, 1 << 24)]
    soft: Annotated[int, (0, 1 << 24)]
    heaviest: Annotated[int, (0, 64 * ONE)]
    patience: Annotated[int, (4, 1 << 20)]


class LoopState(NamedTuple):
    """State of the loops between their steps.

    The mode; frequency (mHz/256), its rate (mHz/256 a step); the load D (2^20) and the detuning
    last seen (half-bandwidths, 2^16); the envelope (µV/16); whether a search may lock; for how many
    steps something was wrong (in a search: strong and on the axis); how many locks were lost, how
    many were false, and how many commands were held back. In a probe `wrong` counts its steps and
    `rate` sums what it sees.
    """

    mode: int
    frequency: int
    rate: int
    load: int
    detuning: int
    re: int
    im: int
    ready: int
    wrong: int
    lost: int
    false: int
    held: int


class LoopCommand(NamedTuple):
    """The drive's level (µV; below zero is a turned phase), the carrier (mHz), and flags."""

    level: int
    frequency: int
    flags: int


@compiled()
def first_state(gains: LoopGains) -> LoopState:
    """The state of a search that begins: at the highest frequency."""
    return LoopState(SEARCHING, gains.highest_frequency << _FINE, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0)


@compiled()
def plate_step(
    gains: LoopGains, state: LoopState, pickup: tuple[int, int], wanted: int, applied: int
) -> tuple[LoopState, LoopCommand]:
    """One step: state and measurements in, state and command out.

    Args:
        gains: of the identified plate.
        state: what the step before left.
        pickup: in phase with the drive and ahead of it by 90° (µV, zero-to-peak), over the last
            step; cut at 16.8 V.
        wanted: the level (µV, at least 0) that would hold the wanted amplitude on the plate as
            identified, without a finger.
        applied: the level that was on the plate over the last step (µV).
    """
    frequency = scaled(state.frequency, _FINE)
    apart = frequency - gains.reference
    turn = gains.turn + scaled(apart * gains.turn_per_mhz, 8)
    cosine, sinus = sine(turn + QUARTER), sine(turn)
    p = clamped(pickup[0], -MOST_PICKUP, MOST_PICKUP)
    q = clamped(pickup[1], -MOST_PICKUP, MOST_PICKUP)
    re = clamped(scaled(p * cosine + q * sinus, 26), -_MOST, _MOST)
    im = clamped(scaled(q * cosine - p * sinus, 26), -_MOST, _MOST)
    free = clamped(scaled(gains.ratio * applied, 20), -_MOST, _MOST)
    if state.mode == SEARCHING:
        return _searched(gains, state, re, im, free)
    if state.mode == PROBING:
        return _probed(gains, state, re, im, free)
    if state.mode == LOCKED:
        return _held(gains, state, re, im, wanted, free)
    return state, LoopCommand(0, frequency, 0)


@compiled()
def _searched(
    gains: LoopGains, state: LoopState, re: int, im: int, free: int
) -> tuple[LoopState, LoopCommand]:
    """A step of the search, `free` being the amplitude that a free plate has at its resonance."""
    mode, frequency, ready = SEARCHING, state.frequency, state.ready
    on_axis = abs(re) > abs(im)
    if not on_axis:
        ready = 1
    strong = abs(re) >= gains.floor << 4 and abs(re) * (ONE + gains.heaviest) >= free * ONE
    # A plate that begins to move is on the axis for a while, wherever its resonance is.
    wrong = state.wrong + 1 if on_axis and strong else 0
    level = gains.search_level
    if re > 0 and ready == 1 and wrong > gains.patience >> 2:
        mode, wrong = PROBING, 0
    elif re < 0 and wrong > gains.patience:
        mode, level = WRONG_SIGN, 0
    if mode == SEARCHING:
        frequency -= gains.sweep
        if frequency < gains.lowest_frequency << _FINE:
            mode, level = NOT_FOUND, 0
            frequency = gains.lowest_frequency << _FINE
    new = LoopState(
        mode, frequency, 0, 0, 0, re, im, ready, wrong, state.lost, state.false, state.held
    )
    return new, LoopCommand(level, scaled(frequency, _FINE), 0)


@compiled()
def _probed(
    gains: LoopGains, state: LoopState, re: int, im: int, free: int
) -> tuple[LoopState, LoopCommand]:
    """A step of the probe: it tracks for a while, then stays above and sees what that does."""
    frequency, rate, load, detuning, _ = _tracked(gains, state, re, im, free)
    mode, ready, false, count = PROBING, 0, state.false, state.wrong + 1
    settled, last = gains.patience, 2 * gains.patience
    shift = gains.half_bandwidth << (_FINE - 1)
    if count == settled:
        frequency, rate = frequency + shift, 0
    elif count > settled:
        frequency, load, rate = state.frequency, state.load, state.rate
        if count > last - (gains.patience >> 2):
            rate += detuning
        if count == last:
            seen = quotient(rate, gains.patience >> 2)
            frequency, rate, count = frequency - shift, 0, 0
            if ONE >> 3 < seen < ONE:
                mode = LOCKED
            else:
                mode, false = SEARCHING, false + 1
    new = LoopState(
        mode, frequency, rate, load, detuning, re, im, ready, count, state.lost, false, state.held
    )
    return new, LoopCommand(gains.search_level, scaled(frequency, _FINE), 0)


@compiled()
def _held(
    gains: LoopGains, state: LoopState, re: int, im: int, wanted: int, free: int
) -> tuple[LoopState, LoopCommand]:
    """A step of a plate that is locked."""
    frequency, rate, load, detuning, flags = _tracked(gains, state, re, im, free)
    floor = gains.floor << 4
    target = clamped(scaled(gains.ratio * wanted, 20), 0, _MOST)
    need = target + scaled(gains.correction * (target - re), 16) + scaled(load * re, 20)
    asked = scaled(clamped(need, -4 * _MOST, 4 * _MOST) * gains.inverse, 20)
    level = clamped(asked, gains.lowest_level, gains.highest_level)
    if level < asked:
        flags |= LEVEL_HELD
    due = free * ONE > (ONE + gains.heaviest) * floor
    missing = due and (re <= abs(im) or re < floor)
    strange = load > gains.heaviest << 4 or load < _LEAST_LOAD << 4
    bad = missing or strange or flags & FREQUENCY_HELD != 0
    wrong = state.wrong + 1 if bad else 0
    mode, ready = LOCKED, 0
    lost, false, held = state.lost, state.false, state.held + (1 if flags else 0)
    if wrong > gains.patience:
        mode, ready, level = SEARCHING, 1, gains.search_level
        frequency, rate, load, wrong = gains.highest_frequency << _FINE, 0, 0, 0
        if strange and not missing:
            false += 1
        else:
            lost += 1
    new = LoopState(mode, frequency, rate, load, detuning, re, im, ready, wrong, lost, false, held)
    return new, LoopCommand(level, scaled(frequency, _FINE), flags)


@compiled()
def _tracked(
    gains: LoopGains, state: LoopState, re: int, im: int, free: int
) -> tuple[int, int, int, int, int]:
    """Frequency, rate, load and detuning after a step that was seen, and a flag for a limit."""
    frequency, rate, load, detuning = state.frequency, state.rate, state.load, state.detuning
    floor = gains.floor << 4
    size = state.re * state.re + state.im * state.im
    if size >= floor * floor:
        extra, detuning = _departures(gains, state, re, im, free, size)
        belief = _belief(size, gains.soft << 4)
        error = scaled(scaled(gains.half_bandwidth * detuning, 8) * belief, 16)
        rate -= scaled(scaled(gains.rate_share * belief, 16) * error, 24)
        frequency += rate - scaled(gains.track_share * error, 24)
        load += scaled(scaled(gains.load_share * belief, 16) * ((extra << 4) - load), 24)
    low, high = gains.lowest_frequency << _FINE, gains.highest_frequency << _FINE
    if low <= frequency <= high:
        return frequency, rate, load, detuning, 0
    return clamped(frequency, low, high), 0, load, detuning, FREQUENCY_HELD


@compiled()
def _belief(size: int, soft: int) -> int:
    """`size` / (`size` + `soft`²), 2^16."""
    whole = size + soft * soft
    while whole >= 1 << 46:
        whole, size = whole >> 2, size >> 2
    return quotient(size << 16, whole)


@compiled()
def _departures(
    gains: LoopGains, state: LoopState, re: int, im: int, free: int, size: int
) -> tuple[int, int]:
    """D and δ (2^16) of the last step, each within ±16."""
    a, b = state.re, state.im
    x = re - scaled(gains.keep * a, 24) - scaled(gains.take * free, 24)
    y = im - scaled(gains.keep * b, 24)
    along, across = -(x * a + y * b), -(y * a - x * b)
    # So that a ratio of 24 bits fits into 64.
    while size >= 1 << 30:
        size, along, across = size >> 2, quotient(along, 4), quotient(across, 4)
    most = 1 << 38
    along = quotient(clamped(along, -most, most) << 24, size)
    across = quotient(clamped(across, -most, most) << 24, size)
    most = 1 << 28
    extra = scaled(clamped(along, -most, most) * gains.turnover, 24)
    detuning = scaled(clamped(across, -most, most) * gains.turnover, 24)
    return (
        clamped(extra, -_LARGEST_LOAD, _LARGEST_LOAD),
        clamped(detuning, -_LARGEST_LOAD, _LARGEST_LOAD),
    )
