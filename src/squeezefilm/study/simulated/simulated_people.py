"""Simulated people of the tasks of `judgements`: who they are, and all their noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.perception.observer import Observer
from squeezefilm.physics.perception.senses import percept_deviation

CHUNK = 60
"""People whose noise is drawn together: a multiple of all rows for 5 stimuli. Orders of more people
repeat those of the first so many."""
_STREAM = 31
_OWN_SCALE, _OWN_MIDDLE = 0.5, 10.0
"""People without a modulus: spread of ln of their scales, and the middle of them."""


@dataclass(frozen=True, slots=True, eq=False)
class SimulatedPeople:
    """Up to sixty people and all their noise; arrays begin with the person."""

    finger: si.IntArray
    spread: si.DimensionlessArray
    lapse: si.DimensionlessArray
    scale: si.DimensionlessArray
    memory: si.DimensionlessArray
    noise: si.FloatArray
    blur: si.FloatArray
    blind: si.DimensionlessArray
    guess: si.DimensionlessArray
    slowness: si.FloatArray

    @classmethod
    def drawn(
        cls,
        observer: Observer,
        fingers: int,
        asked: int,
        seed: int,
        chunk: int,
        directions: tuple[int, ...],
        surfaces: int = 2,
    ) -> SimulatedPeople:
        """Whoever is in a chunk; nobody depends on how many there are."""
        random = _random(seed, chunk)
        normal, among = random.standard_normal, random.random
        clear = percept_deviation(observer.period_weber_fraction)
        return cls(
            finger=random.integers(0, fingers, CHUNK),
            spread=clear * np.exp(observer.period_spread * normal(CHUNK)),
            lapse=observer.lapse_rate * np.exp(observer.lapse_spread * normal(CHUNK)),
            scale=_OWN_MIDDLE * np.exp(_OWN_SCALE * normal(CHUNK)),
            memory=normal(CHUNK),
            noise=normal((asked, surfaces, CHUNK, *directions, observer.candidates)),
            blur=normal((asked, surfaces, CHUNK, *directions)),
            blind=among((asked, CHUNK)),
            guess=among((asked, CHUNK)),
            slowness=normal((asked, CHUNK)),
        )


def _random(seed: int, chunk: int) -> np.random.Generator:
    return np.random.default_rng([seed, _STREAM, chunk])


def finger_of(person: int, fingers: int, seed: int) -> int:
    """Which of so many finger classes a simulated person of these tasks has."""
    return int(_random(seed, person // CHUNK).integers(0, fingers, CHUNK)[person % CHUNK])
