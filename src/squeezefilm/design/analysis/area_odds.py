"""Probability of a friction at the best place of the active area, in its middle and at the worst.

Each draw of all that is uncertain has an amplitude with the finger where the prediction has it, and
at the other places as much more or less as the display as described. What a stiff pad's friction
differs by from that of ridges each at its own balance is taken to be the same at all of them.
"""

from __future__ import annotations

import contextlib
import dataclasses
import functools
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.core.kept.store import Kept
from squeezefilm.physics.chain.active_area import CRITERIA, ActiveArea
from squeezefilm.physics.chain.area_map import active_area
from squeezefilm.physics.chain.friction import FrictionLaw
from squeezefilm.physics.chain.pad_place import pad_place
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.display import Display
from squeezefilm.physics.uncertainty.draws import Mixture, Outcome, as_drawn, mixture_of
from squeezefilm.physics.uncertainty.intervals import evaluate, hash_of_draws, quantiles
from squeezefilm.physics.uncertainty.uncertainty import POINTS, SAMPLES, sobol_points

_KEPT: Kept[si.FloatArray] = Kept("draws-over-areas", si.FloatArray, large=True)

WHERE = ("best", "median", "worst")


@dataclass(frozen=True, eq=False)
class AreaOdds:
    """Draws of µ′/µ, shape (draws, 3): at the best place, in the median and at the worst; NaN where
    a draw has no friction."""

    samples: si.DimensionlessArray

    @si.checked_numbers
    def probabilities_below(
        self, relative_friction: si.Dimensionless
    ) -> tuple[si.Dimensionless, si.Dimensionless, si.Dimensionless]:
        """The shares of draws at or below a value, at the three; one without friction is not."""
        best, median, worst = np.mean(self.samples <= relative_friction, axis=0).tolist()
        return best, median, worst

    @property
    def worst_interval(self) -> tuple[si.Dimensionless, si.Dimensionless]:
        """Interval in which 90 % of the draws lie at the worst place."""
        low, _, high = quantiles(self.samples[:, 2]).tolist()
        return low, high

    def summary(self) -> dict[str, Any]:
        """Mapping that JSON has under `active_area`."""
        return {
            f"probability_below_{criterion:.2f}": dict(
                zip(WHERE, self.probabilities_below(criterion), strict=True)
            )
            for criterion in CRITERIA
        } | {"worst_interval": list(self.worst_interval), "draws": len(self.samples)}


class JudgedArea(NamedTuple):
    """An active area with how sure its friction is, where that is known."""

    area: ActiveArea
    odds: AreaOdds | None

    def summary(self) -> dict[str, Any]:
        """Mapping that JSON has under `active_area`; keys carry units."""
        return self.area.summary() | {"odds": None if self.odds is None else self.odds.summary()}


def judged_area(
    display: Display, prediction: Prediction, *, samples: int = SAMPLES, seed: int = 1
) -> JudgedArea | None:
    """The active area where a prediction was made, with its odds by the draws that the prediction's
    interval is of, see `uncertain_friction`; None where there is no area.

    Without odds where no `samples` were asked for (0), the area has no friction, nothing vibrates
    or nothing touches.
    """
    p = prediction
    area = active_area(display, p.mode, p.law, p.drive)
    if area is None:
        return None
    if not samples or p.touch.law is None or p.vibration_amplitude == 0 or not area.of_note:
        return JudgedArea(area, None)
    over = _elsewhere(display, p, area)
    mixture = mixture_of(display, p)
    points = sobol_points(mixture, POINTS * samples, seed)
    outcomes = np.stack(evaluate(mixture, points, lambda _: None)[0], axis=1)
    make = functools.partial(_drawn, mixture, over, points, outcomes)
    return JudgedArea(area, AreaOdds(_KEPT.found(hash_of_draws(mixture, points, over), make)))


@as_drawn()
def _drawn(
    mixture: Mixture,
    over: list[_Elsewhere | None],
    points: si.DimensionlessArray,
    outcomes: si.FloatArray,
) -> si.DimensionlessArray:
    """The friction of draws at places, shape (draws, places), NaN where a draw is refused."""
    drawn = np.full((len(points), len(over)), np.nan)
    for row, outcome, draw in zip(drawn, outcomes.tolist(), mixture.draws(points), strict=True):
        pressed = Outcome(*outcome)
        if np.isfinite(pressed.friction):
            with contextlib.suppress(SqueezefilmError):
                row[:] = _met(mixture.law(draw), pressed, over)
    return drawn


class _Elsewhere(NamedTuple):
    """Amplitudes of ridges at another place, over that where the prediction is, and shares."""

    swings: si.DimensionlessArray
    shares: si.DimensionlessArray


def _elsewhere(display: Display, p: Prediction, area: ActiveArea) -> list[_Elsewhere | None]:
    """The places of note of an area; None for the one where the prediction is."""
    here = p.law.place
    over: list[_Elsewhere | None] = []
    for place, lobe in area.of_note:
        if here is not None and place == (here.x, here.y):
            over.append(None)
            continue
        there = pad_place(display.actuator, p.mode, p.frequency, place)
        swings, shares = dataclasses.replace(p.law, place=there, position=0.0).ridge_swings
        over.append(_Elsewhere(swings * lobe / p.vibration_amplitude, shares))
    return over


def _met(law: FrictionLaw, outcome: Outcome, over: list[_Elsewhere | None]) -> list[float]:
    """The friction of a draw at places; None stands for the prediction's own."""
    tied = outcome.friction - float(law.friction_in("own", np.array([outcome.amplitude]))[0])
    means = (
        outcome.friction - tied
        if place is None
        else float(law.ridge_friction(outcome.amplitude * place.swings) @ place.shares)
        for place in over
    )
    return [min(max(mean + tied, 0.0), 1.0) for mean in means]
