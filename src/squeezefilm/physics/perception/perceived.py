"""Perception of a surface on one trial: the strongest rhythm, its period, with noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.physics.perception.observer import Observer
from squeezefilm.physics.perception.senses import Candidates

_FAINTEST = 0.05
"""Evidence (d′) below which a period is as blurred as at this one."""


@dataclass(frozen=True, slots=True, eq=False)
class Perceived:
    """Perceived rhythms on trials; arrays of one shape.

    Attributes:
        log_period: natural logarithm of the period perceived (of m).
        strength: evidence of the rhythm perceived, noise included (1).
        felt: whether that passes the observer's criterion.
    """

    log_period: si.FloatArray
    strength: si.DimensionlessArray
    felt: NDArray[np.bool_]


def perceived(
    surface: Candidates,
    observer: Observer,
    skill: si.DimensionlessArray,
    spread: si.DimensionlessArray,
    noise: si.FloatArray,
    blur: si.FloatArray,
) -> Perceived:
    """The strongest of a surface's candidate rhythms, and the period that it seems to have.

    The evidence of each candidate gets noise of standard deviation `skill`; the strongest is
    perceived, with σ √(1 + 1/d′²) `skill` in the logarithm of its period.

    Args:
        surface: candidates, shape (…, candidates).
        observer: whose criterion.
        skill: by what noise is more than a practised person's (1), shape (…).
        spread: σ of a clear rhythm's ln period (1), shape (…).
        noise, blur: standard normal numbers, shapes (…, candidates) and (…).
    """
    heard = surface.d_prime + skill[..., None] * noise
    best = np.argmax(heard, axis=-1)[..., None]
    strength, period, d_prime = (
        np.take_along_axis(of_rhythms, best, -1)[..., 0]
        for of_rhythms in (heard, surface.period, surface.d_prime)
    )
    felt = strength > observer.detection_criterion
    clear = np.where(felt, np.maximum(d_prime, _FAINTEST), np.inf)
    wide = spread * skill * np.sqrt(1.0 + 1.0 / clear**2)
    return Perceived(np.log(period) + wide * blur, strength, felt)


def perceived_anew(
    surface: Candidates,
    observer: Observer,
    skill: si.DimensionlessArray,
    spread: si.DimensionlessArray,
    random: np.random.Generator,
    drawn: int,
) -> Perceived:
    """Perceived rhythm, with noise drawn anew; `surface` has shape (people, …, candidates). The
    noise of `drawn` people is drawn, so that nobody depends on how many there are."""
    count, *shape = surface.period.shape
    noise = random.standard_normal((drawn, *shape))[:count]
    blur = random.standard_normal((drawn, *shape[:-1]))[:count]
    return perceived(surface, observer, skill, spread, noise, blur)
