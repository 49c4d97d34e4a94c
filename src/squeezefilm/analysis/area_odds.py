"""How probable a friction is at the best place of the active area, in its middle and at the worst.

A draw of all that is uncertain is asked for the friction of one ridge against amplitude, and a pad
meets its mean over what the ridges move at the place. Which place is which, and what a finger there
leaves of the amplitude beside one at the best antinode, is taken from the display as described; so
is what the ridges of a stiff pad take from each other, from the best antinode.
"""

from __future__ import annotations

import contextlib
import dataclasses
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.analysis.draws import FreeAmplitude, Mixture, Outcome, as_drawn, outcome_of
from squeezefilm.analysis.intervals import quantiles
from squeezefilm.analysis.uncertainty import sobol_points
from squeezefilm.chain.active_area import CRITERIA, ActiveArea
from squeezefilm.chain.friction import FrictionLaw
from squeezefilm.chain.pad_place import pad_place
from squeezefilm.chain.prediction import Prediction
from squeezefilm.display import Display
from squeezefilm.errors import SqueezefilmError

DRAWS = 64
# Of the largest that a ridge meets: dense where friction falls most.
_AMPLITUDES = np.linspace(0.0, 1.0, 33) ** 1.5
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
    area has no friction, nothing vibrates or nothing touches."""
    p = prediction
    if p.touch.sharing is None or p.vibration_amplitude == 0 or not area.of_note:
        return None
    there = dataclasses.replace(p, law=dataclasses.replace(p.law, place=None, position=0.0))
    places = [pad_place(display.actuator, p.mode, p.frequency, one) for one, _ in area.of_note]
    side = area.contact_side
    swings = [
        np.abs(one.ridges(display.finger, side)[1]) * (lobe / p.vibration_amplitude)
        for one, (_, lobe) in zip(places, area.of_note, strict=True)
        if one is not None
    ]
    mixture = Mixture(display, there, driven=p.voltage is not None)
    free = FreeAmplitude(display, there)
    samples = np.full((DRAWS, len(swings)), np.nan)
    for row, draw in zip(samples, mixture.draws(sobol_points(mixture, DRAWS, seed)), strict=True):
        with contextlib.suppress(SqueezefilmError), as_drawn():
            found = outcome_of(mixture, draw, free(draw.display))
            row[:] = _met(mixture.law(draw), found, swings)
    return AreaOdds(samples)


def _met(law: FrictionLaw, found: Outcome, swings: list[si.DimensionlessArray]) -> list[float]:
    """The friction under pads whose ridges move by `swings`, over the amplitude that a draw has."""
    asked = found.amplitude * max(float(np.max(one)) for one in swings) * _AMPLITUDES
    ridge = law.ridge_friction(asked)
    own = law.sharing(found.amplitude, "own").relative_friction
    tied = found.friction - float(own[0])
    means = (float(np.mean(np.interp(found.amplitude * one, asked, ridge))) for one in swings)
    return [min(max(mean + tied, 0.0), 1.0) for mean in means]


def judged_area(
    display: Display, prediction: Prediction, area: ActiveArea | None, *, samples: int
) -> JudgedArea | None:
    """An area with its odds, where samples were asked for; None without an area."""
    if area is None:
        return None
    return JudgedArea(area, area_odds(display, prediction, area) if samples else None)
