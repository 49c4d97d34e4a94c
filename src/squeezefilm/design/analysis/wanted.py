"""The voltage that a wanted friction takes: as described, and over all that is uncertain."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import OutOfRangeError, SqueezefilmError, UnreachableError
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import values_of
from squeezefilm.physics.chain.friction import FrictionLaw
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.chain.touch import amplitude_per_volt, kept_at
from squeezefilm.physics.chain.wanted_voltage import needed_voltage
from squeezefilm.physics.contact.sharing.levitation import HIGHEST_AMPLITUDE
from squeezefilm.physics.display import Display
from squeezefilm.physics.uncertainty.draws import (
    Draw,
    Mixture,
    Refusals,
    as_drawn,
    between_limits,
)
from squeezefilm.physics.uncertainty.intervals import LEVEL, MOST_REFUSED, ends
from squeezefilm.physics.uncertainty.uncertainty import POINTS, SAMPLES, refusal_words, sobol_points

_LEAST: si.Metre = 2e-8
# From one amplitude that is tried to the next, and how many between the last two. Small steps:
# every further octave of amplitude may take tables that are not solved yet.
_STEP, _BETWEEN = 1.4, 9
# How near to where the gap closes the last amplitude is tried, as a ratio.
_CLOSE = 1.02


@dataclass(frozen=True, eq=False)
class VoltageInterval:
    """The voltage (V, zero-to-peak) at which each draw has a wanted µ′/µ.

    `interval` and `median` hold as those of `UncertainFriction`; None stands for a voltage that is
    none, since so many draws never get there. `never` is the share of the draws whose friction no
    vibration brings so low, `beyond` that of those which need more than `limit`, the drive's own
    voltage (the former with them): 1 − `beyond` is the probability that the display as driven does
    it. `voltages` has one for each draw, infinite where none does and NaN where it is refused.
    """

    interval: tuple[si.Volt | None, si.Volt | None]
    median: si.Volt | None
    level: si.Dimensionless
    limit: si.Volt
    beyond: si.Dimensionless
    never: si.Dimensionless
    voltages: si.VoltArray
    refused: Refusals
    seed: int

    def summary(self) -> dict[str, Any]:
        """Numbers as plain JSON values."""
        return {
            "voltage_interval_V": list(self.interval),
            "voltage_median_V": self.median,
            "interval_level": self.level,
            "drive_voltage_V": self.limit,
            "share_beyond_drive": self.beyond,
            "share_never": self.never,
            "evaluations": self.refused.evaluations,
            "refused": self.refused.count,
            "refused_why": dict(self.refused.reasons),
            "seed": self.seed,
        }


@dataclass(frozen=True)
class Wanted:
    """Price of a wanted friction: amplitude with the finger on it (m) and voltage (V), as
    described; None where nothing brings the display there, and `why_not` says why. `uncertain` is
    the voltage over the draws; None without one, with the reason in `why_no_interval`."""

    relative_friction: si.Dimensionless
    vibration_amplitude: si.Metre | None
    voltage: si.Volt | None
    why_not: str = ""
    uncertain: VoltageInterval | None = None
    why_no_interval: str = ""

    def summary(self) -> dict[str, Any]:
        """Numbers as plain JSON values."""
        unsure = self.uncertain
        return {
            **values_of(
                self, "relative_friction vibration_amplitude voltage why_not why_no_interval"
            ),
            **({} if unsure is None else unsure.summary()),
        }


def wanted_friction(
    display: Display,
    prediction: Prediction,
    relative_friction: si.Dimensionless,
    *,
    samples: int = SAMPLES,
    seed: int = 1,
    strict: bool = True,
    progress: SayProgress | None = None,
) -> Wanted:
    """Price of a wanted µ′/µ where a prediction was made: by its solved plate, frequency, force,
    surface, place and speed.

    `samples` is the base of the draws (0: no interval). Raises `UnreachableError` where no voltage
    does it as described, without `strict` that is said in its place, and what
    `voltage_for_friction` raises else.
    """
    p = prediction
    volts: si.Volt | None
    amplitude: si.Metre | None
    why_not = ""
    try:
        volts, amplitude = needed_voltage(p.mode, p.law, relative_friction)
    except UnreachableError as error:
        if strict:
            raise
        volts, amplitude, why_not = None, None, str(error)
    unsure, why = None, ""
    if samples and p.law.position:
        why = "the finger is away from the antinode"
    elif samples and relative_friction >= 1:
        why = "nothing is wanted"
    elif samples:
        try:
            unsure = uncertain_voltage(
                display, p, relative_friction, samples=samples, seed=seed, progress=progress
            )
        except OutOfRangeError as error:
            why = str(error)
    return Wanted(relative_friction, amplitude, volts, why_not, unsure, why)


@as_drawn()
def uncertain_voltage(
    display: Display,
    prediction: Prediction,
    relative_friction: Annotated[si.Dimensionless, si.AtLeast(0.0), si.Below(1.0)],
    *,
    samples: int = SAMPLES,
    seed: int = 1,
    progress: SayProgress | None = None,
) -> VoltageInterval:
    """The voltage at which each draw has a wanted µ′/µ, of the draws of `uncertain_friction`.

    The same Sobol' points (4 × `samples`, a power of two) as of its interval, so that the share of
    voltages up to the drive's is the share of its µ′/µ that lie as low. The amplitude of a draw is
    found within 1e-3; the finger's damping at that amplitude is in the voltage. Raises
    `OutOfRangeError` where more than 2 % of the draws are refused at rest or under their finger.
    """
    tell = progress or (lambda _: None)
    p = prediction
    # The amplitude per volt at this frequency, whatever voltage or amplitude was asked for.
    per_volt = amplitude_per_volt(p.mode, p.frequency)
    unit = dataclasses.replace(
        p, voltage=1.0, touch=dataclasses.replace(p.touch, free_amplitude=per_volt)
    )
    mixture = Mixture(display, unit, driven=True)
    points = sobol_points(mixture, POINTS * samples, seed)
    refused = Refusals(len(points))
    volts = np.full(len(points), np.nan)
    every, first = max(len(points) // 20, 1), max(p.vibration_amplitude, 1e-6)
    for number, draw in enumerate(mixture.draws(points)):
        if number % every == 0:
            tell(f"voltage of draw {number + 1} of {len(points)}")
        law = mixture.law(draw)
        try:
            amplitude = _amplitude(law, draw, relative_friction, first)
            kept = kept_at(mixture.mode(draw), law, amplitude) if np.isfinite(amplitude) else 1.0
            volts[number] = amplitude / (mixture.free(draw.display) * kept)
        except SqueezefilmError as error:
            refused.refuse(draw.heights, error)
    if refused.share > MOST_REFUSED:
        raise OutOfRangeError(refusal_words(refused))
    low, middle, high = (end if np.isfinite(end) else None for end in ends(volts))
    limit = display.drive.voltage
    known = volts[~np.isnan(volts)]
    return VoltageInterval(
        interval=(low, high),
        median=middle,
        level=LEVEL,
        limit=limit,
        beyond=float(np.mean(known > limit)),
        never=float(np.mean(np.isinf(known))),
        voltages=volts,
        refused=refused,
        seed=seed,
    )


def _amplitude(law: FrictionLaw, draw: Draw, wanted: si.Dimensionless, first: si.Metre) -> si.Metre:
    """The amplitude (m) at which a draw has a wanted µ′/µ, looked for around a `first` one;
    infinite where none has. Raises what the balance raises where even the least is refused."""
    from scipy.interpolate import PchipInterpolator

    def at(amplitude: float) -> float:
        return float(between_limits(law, draw, np.array([amplitude]))[0])

    low, high = _bracket(at, wanted, min(max(first, _LEAST), HIGHEST_AMPLITUDE))
    if not np.isfinite(high):
        return high
    near = np.linspace(low, high, _BETWEEN)
    # Friction falls with amplitude; where rounding has it rise it is taken to stand still.
    row = np.minimum.accumulate(between_limits(law, draw, near)) - 1e-12 * np.arange(_BETWEEN)
    return float(PchipInterpolator(-row, near)(-min(max(wanted, row[-1]), row[0])))


def _bracket(
    at: Callable[[float], float], wanted: si.Dimensionless, first: si.Metre
) -> tuple[si.Metre, si.Metre]:
    """Two amplitudes (m) a factor apart with a wanted µ′/µ between them; the second is infinite
    where the gap closes before, or nothing up to 50 µm does it."""
    here = first
    try:
        reached = at(here) <= wanted
    except OutOfRangeError:
        # So strong a vibration closes the gap at some ridge: what is wanted lies below, or nowhere.
        reached = True
    while reached:
        before, here = here, here / _STEP
        if before <= _LEAST:
            return 0.0, before
        try:
            reached = at(here) <= wanted
        except OutOfRangeError:
            if here <= _LEAST:
                raise
    step = _STEP
    while here < HIGHEST_AMPLITUDE and step > _CLOSE:
        there = min(here * step, HIGHEST_AMPLITUDE)
        try:
            if at(there) <= wanted:
                return here, there
        except OutOfRangeError:
            step = step**0.5
            continue
        here = there
    return here, np.inf
