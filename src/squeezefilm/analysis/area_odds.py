"""How probable a friction is at the best place of the active area, in its middle and at the worst.

A draw of all that is uncertain is asked at three amplitudes: those of an even wave that gives, as
described, the best, the median and the worst friction of the area. Which place is which, and how
the amplitudes stand to each other, is taken from the display as described.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.analysis.draws import FreeAmplitude, Mixture, between_limits, outcome_of
from squeezefilm.analysis.intervals import quantiles
from squeezefilm.analysis.uncertainty import sobol_points
from squeezefilm.chain.active_area import CRITERIA, ActiveArea
from squeezefilm.chain.prediction import Prediction
from squeezefilm.display import Display
from squeezefilm.errors import SqueezefilmError, UnreachableError

DRAWS = 64
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
        """Between which 90 % of the draws lie at the worst place."""
        low, _, high = quantiles(self.samples[:, 2]).tolist()
        return low, high

    def summary(self) -> dict[str, Any]:
        """What JSON has under `active_area`."""
        return {
            f"probability_below_{one:.2f}": dict(
                zip(WHERE, self.probabilities_below(one), strict=True)
            )
            for one in CRITERIA
        } | {"worst_interval": list(self.worst_interval), "draws": len(self.samples)}


class JudgedArea(NamedTuple):
    """An active area with how sure its friction is, where that is known."""

    area: ActiveArea
    odds: AreaOdds | None

    def summary(self) -> dict[str, Any]:
        """What JSON has under `active_area`; keys carry units."""
        return self.area.summary() | {"odds": None if self.odds is None else self.odds.summary()}


def area_odds(
    display: Display, prediction: Prediction, area: ActiveArea, *, seed: int = 1
) -> AreaOdds | None:
    """The friction of an area by 64 draws of all that is uncertain in a display; None where the
    area has no friction or an even wave does not reach it."""
    p = prediction
    known = (area.best, area.median, area.worst)
    if p.touch.sharing is None or p.vibration_amplitude == 0:
        return None
    even = dataclasses.replace(p.law, place=None, position=0.0)
    try:
        asked = [even.amplitude_for(min(one, 1.0)) for one in known if one is not None]
    except UnreachableError:
        return None
    if len(asked) < len(known):
        return None
    shares = np.array(asked) / p.vibration_amplitude
    there = dataclasses.replace(p, law=even)
    mixture = Mixture(display, there, driven=p.voltage is not None)
    free = FreeAmplitude(display, there)
    samples = np.full((DRAWS, len(known)), np.nan)
    for row, draw in zip(samples, mixture.draws(sobol_points(mixture, DRAWS, seed)), strict=True):
        try:
            amplitude = outcome_of(mixture, draw, free(draw.display)).amplitude
            row[:] = between_limits(mixture.law(draw), draw, amplitude * shares)
        except SqueezefilmError:
            continue
    return AreaOdds(samples)


def judged_area(
    display: Display, prediction: Prediction, area: ActiveArea | None, *, samples: int
) -> JudgedArea | None:
    """An area with its odds, where samples were asked for; None without an area."""
    if area is None:
        return None
    return JudgedArea(area, area_odds(display, prediction, area) if samples else None)
