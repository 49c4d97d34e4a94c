"""The finest grating that is felt, beside the finest that survives the resonator, by finger speed.

As described, and over the draws of a friction's interval: of each draw µ′/µ over amplitude and
speed, its amplitude, envelope, force and friction without vibration. The observer's senses stay as
they are: an interval says what the display leaves open, not how people differ.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.core.kept.store import Kept
from squeezefilm.core.results import values_of
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.contact.finger.fingertip import rest_friction_factor
from squeezefilm.physics.display import DECAY_LENGTH, Display
from squeezefilm.physics.perception.observer import Observer, load_observer
from squeezefilm.physics.perception.senses import (
    Rubbed,
    finest_felt,
    grating_evidence,
    switched_amplitude,
    tried_periods,
)
from squeezefilm.physics.render.program.inverse import FrictionTable
from squeezefilm.physics.render.resonator.envelope import (
    envelope_time_constant,
    fastest_speed,
    finest_period,
    sine_swing_kept,
)
from squeezefilm.physics.uncertainty.draws import Draw, Mixture, as_drawn, mixture_of
from squeezefilm.physics.uncertainty.intervals import LEVEL, MOST_REFUSED, ends, hash_of_draws
from squeezefilm.physics.uncertainty.uncertainty import sobol_points

PAPER_PERIODS: tuple[si.Metre, ...] = (0.4e-3, 2e-3, 4e-3, 8e-3, 10e-3)
"""Spatial periods of the paper's match-to-sample experiment (m)."""

EXPLORING_SPEEDS: tuple[si.MetrePerSecond, ...] = (0.01, 0.02, 0.05, 0.1, 0.2)
"""Finger speeds from slow to brisk exploration (m/s)."""

KEPT: si.Dimensionless = 0.9
"""Share of its swing that a grating keeps which survives."""


@dataclass(frozen=True, slots=True, eq=False)
class GratingsLeft:
    """Square gratings that keep their swing of amplitude, and at which finger speeds, by the closed
    forms of `envelope`.

    Attributes:
        kept: the share of its swing, peak to peak, that a grating must keep to survive (1).
        fundamental: share of the wave of its own period that is left of one that just survives (1).
        spatial_periods, speeds: those that are looked at (m, m/s).
        finest_period: that survives at each speed (m).
        fastest_speed: of a finger under which each period survives (m/s).
    """

    kept: si.Dimensionless
    fundamental: si.Dimensionless
    spatial_periods: si.MetreArray
    speeds: si.MetrePerSecondArray
    finest_period: si.MetreArray
    fastest_speed: si.MetrePerSecondArray


def what_survives(prediction: Prediction, time_constant: si.Second) -> GratingsLeft | None:
    """Gratings that survive an envelope's time constant (s); None where the amplitude changes no
    friction."""
    if prediction.relative_friction == 1 or prediction.vibration_amplitude == 0:
        return None
    periods, speeds = np.array(PAPER_PERIODS), np.array(EXPLORING_SPEEDS)
    just = finest_period(1.0, time_constant, KEPT)
    return GratingsLeft(
        kept=KEPT,
        fundamental=float(sine_swing_kept(just, 1.0, time_constant)),
        spatial_periods=periods,
        speeds=speeds,
        finest_period=np.asarray(finest_period(speeds, time_constant, KEPT)),
        fastest_speed=np.asarray(fastest_speed(periods, time_constant, KEPT)),
    )


DRAWS = 64
_KNOTS = 17
_KEPT: Kept[si.FloatArray] = Kept("draws-felt", si.FloatArray, large=True)

Felt = Callable[[si.MetreArray], si.DimensionlessArray]


@dataclass(frozen=True)
class FeltAt:
    """Gratings felt at a finger speed (m/s): the finest period (m) that keeps 90 % of its swing of
    amplitude (`survives`), the finest that is `felt` as described (None: none), and the `interval`
    of that over the draws (None at an end where so many of them have none; None without draws).
    `never` is the share of the draws in which no period is felt."""

    speed: si.MetrePerSecond
    survives: si.Metre
    felt: si.Metre | None
    interval: tuple[si.Metre | None, si.Metre | None] | None = None
    never: si.Dimensionless | None = None


@dataclass(frozen=True)
class FeltGratings:
    """The finest square grating that is felt, by speed, that of the prediction (`speed`) among
    them: friction switched between that without vibration and that at the display's amplitude.
    `observer` felt it, with a d′ of `criterion`; `why_no_interval` says why there is none."""

    observer: str
    criterion: si.Dimensionless
    at: tuple[FeltAt, ...]
    speed: si.MetrePerSecond
    level: si.Dimensionless = LEVEL
    draws: int = 0
    why_no_interval: str = ""
    model: str = "steady strokes, first-order envelope, the pad's three constants; senses fitted"

    @property
    def here(self) -> FeltAt:
        """Gratings felt at the prediction's speed."""
        return next(speed for speed in self.at if speed.speed == self.speed)

    def summary(self) -> dict[str, Any]:
        """Numbers as plain JSON values, with units in the keys: those at the prediction's speed,
        then at each."""
        return {
            **_row(self.here),
            **values_of(self, "observer draws why_no_interval model"),
            "detection_criterion_d_prime": self.criterion,
            "interval_level": self.level,
            "by_speed": [_row(felt) for felt in self.at],
        }


def _row(felt: FeltAt) -> dict[str, Any]:
    return {
        "finger_speed_m_per_s": felt.speed,
        "finest_period_survives_m": felt.survives,
        "finest_period_felt_m": felt.felt,
        "finest_period_felt_interval_m": felt.interval and list(felt.interval),
        "share_never_felt": felt.never,
    }


def felt_gratings(
    display: Display,
    prediction: Prediction,
    *,
    draws: int = DRAWS,
    speeds: tuple[Annotated[si.MetrePerSecond, si.Above(0.0)], ...] = EXPLORING_SPEEDS,
) -> FeltGratings | None:
    """The finest gratings that are felt where a prediction was made, at the prediction's finger
    speed and at others.

    `draws` is a power of two (0: no interval); the observer is the preset "fingertip". None where
    nothing vibrates. Raises what the friction's law raises at the amplitude.
    """
    p = prediction
    if p.vibration_amplitude == 0 or p.relative_friction == 1:
        return None
    senses = load_observer()
    tau = p.envelope_time_constant
    base, pad = p.friction_coefficient * p.normal_force, display.finger.fingerpad
    nominal, speeds = [], tuple(sorted({p.speed, *speeds}))
    for speed in speeds:
        law = functools.partial(p.friction, speed=speed)
        nominal.append(_finest(senses, tau, p.vibration_amplitude, law, Rubbed(base, pad, speed)))
    drawn, why = (None, "no draws were asked for")
    if draws and p.touch.law is not None:
        drawn, why = _drawn(display, p, senses, speeds, draws)
    rows = []
    for k, speed in enumerate(speeds):
        column = None if drawn is None else drawn[:, k]
        low, _, high = (np.nan,) * 3 if column is None else ends(column)
        rows.append(
            FeltAt(
                speed,
                float(finest_period(speed, tau)),
                _known(nominal[k]),
                None if column is None else (_known(low), _known(high)),
                None if column is None else float(np.mean(np.isinf(column))),
            )
        )
    count = 0 if drawn is None else draws
    return FeltGratings(
        senses.name, senses.detection_criterion, tuple(rows), p.speed, LEVEL, count, why
    )


def _finest(
    senses: Observer, tau: si.Second, high: si.Metre, law: Felt, rubbed: Rubbed
) -> si.Metre:
    period = tried_periods()
    amplitude = switched_amplitude(period / rubbed.speed, tau, high)
    return finest_felt(senses, period, grating_evidence(senses, period, amplitude, law, rubbed))


def _drawn(
    display: Display,
    p: Prediction,
    senses: Observer,
    speeds: tuple[si.MetrePerSecond, ...],
    count: int,
) -> tuple[si.MetreArray | None, str]:
    """The finest period felt (m) of each draw at each speed as `_felt_of_draws` has it; None with
    the reason where too many draws are refused."""
    mixture = mixture_of(display, p)
    points = sobol_points(mixture, count, seed=1)
    make = functools.partial(_felt_of_draws, mixture, points, senses, speeds)
    periods = _KEPT.found(hash_of_draws(mixture, points, (senses, speeds)), make)
    lost = float(np.mean(np.isnan(periods[:, 0])))
    if lost > MOST_REFUSED:
        return None, f"{lost:.1%} of the draws are refused, more than {MOST_REFUSED:.0%}"
    return periods, ""


@as_drawn()
def _felt_of_draws(
    mixture: Mixture,
    points: si.DimensionlessArray,
    senses: Observer,
    speeds: tuple[si.MetrePerSecond, ...],
) -> si.MetreArray:
    """The finest period felt (m) of each draw at each speed, shape (draws, speeds), infinite where
    none is, NaN where the draw is refused."""
    periods = np.full((len(points), len(speeds)), np.nan)
    for number, draw in enumerate(mixture.draws(points)):
        try:
            high = mixture.outcome(points[number], draw).amplitude
            rest = _rest_friction_factor(mixture, draw, points[number])
            periods[number] = _felt_of(mixture, draw, high, senses, speeds, rest)
        except SqueezefilmError:
            continue
    return periods


def _rest_friction_factor(
    mixture: Mixture, draw: Draw, point: si.DimensionlessArray
) -> si.Dimensionless:
    """The friction at rest of a drawn person over the described one; 1 where the person is known.

    A sum of coordinates, modulo 1, is uniform and independent of each of them: so the points of the
    friction serve for this number too.
    """
    people = any(
        input_.path == DECAY_LENGTH and getattr(input_, "origin", "") == "assumed"
        for input_ in mixture.inputs
    )
    if not people:
        return 1.0
    described = mixture.display.finger.contact_decay_length
    ratio = np.array([draw.display.finger.contact_decay_length / described])
    share = np.clip(np.array([float(point.sum()) % 1.0]), 1e-6, 1 - 1e-6)
    return float(rest_friction_factor(share, ratio)[0])


def _felt_of(
    mixture: Mixture,
    draw: Draw,
    high: si.Metre,
    senses: Observer,
    speeds: tuple[si.MetrePerSecond, ...],
    rest_factor: si.Dimensionless,
) -> list[si.Metre]:
    law, every = mixture.law(draw), np.array(speeds)
    knots = high * np.linspace(0.0, 1.0, _KNOTS) ** 2
    own, even = law.over_speeds(knots, every, "own"), law.on_even_wave
    # As `between_limits` has it.
    alike = own if even is law else even.over_speeds(knots, every, "own")
    stiff = even.over_speeds(knots, every, "one-gap") - alike
    friction = np.clip(own + (1 - draw.skin_compliance) * stiff, 0.0, 1.0)
    mode = mixture.mode(draw)
    tau = float(envelope_time_constant(mode.quality_factor, mode.resonance_frequency))
    base = rest_factor * law.friction_coefficient * draw.normal_force
    pad = draw.display.finger.fingerpad
    periods = []
    for speed, row in zip(speeds, friction, strict=True):
        table = FrictionTable(knots, np.zeros(1), row[None, :], speed)
        periods.append(_finest(senses, tau, high, table, Rubbed(base, pad, speed)))
    return periods


def _known(value: si.Metre) -> si.Metre | None:
    return float(value) if np.isfinite(value) else None
