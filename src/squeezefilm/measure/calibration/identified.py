"""Which parameters the data identify, and which only in combination.

In scores in which every prior is N(0, 1), independent of the others, the posterior's covariance is
the identity where nothing was learned. Its eigenvectors with small eigenvalues are what the data
fixed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from squeezefilm.core import quantities as si

Standing = Literal["identified", "narrowed", "not told"]
IDENTIFIED, NOT_TOLD = 0.35, 0.9
"""A spread of at most so much of the prior's is identified; of more than so much is not told."""
_FIXED, _ALONE, _NAMED = 0.35, 0.8, 0.08


@dataclass(frozen=True)
class Known:
    """How well one parameter is known: the share of its prior spread that is left (1: nothing was
    learned), in scores."""

    path: str
    left: si.Dimensionless

    @property
    def standing(self) -> Standing:
        """In one word or two."""
        if self.left <= IDENTIFIED:
            return "identified"
        return "not told" if self.left > NOT_TOLD else "narrowed"


@dataclass(frozen=True)
class Combination:
    """A combination of parameters that the data fixed to a share (`left`) of its prior spread.

    `parts` are the parameters with their weights (their squares sum to less than 1), the largest
    first; positive ones make up for negative ones.
    """

    left: si.Dimensionless
    parts: tuple[tuple[str, float], ...]

    @property
    def sentence(self) -> str:
        """As one says it."""
        to = f"to {si.percent(self.left, 1 if self.left < 0.1 else 0)} of their prior spread"
        if len(self.parts) == 1:
            return f"{self.parts[0][0]} alone is fixed {to}."
        up = [name for name, weight in self.parts if weight > 0]
        down = [name for name, weight in self.parts if weight < 0]
        if not down or not up:
            return (
                f"Only together are fixed {to}: {_and(up or down)}: more of one is less of another."
            )
        return (
            f"Only together are fixed {to}: {_and(up)} against {_and(down)}: more of the first "
            "goes with more of the second."
        )


@dataclass(frozen=True)
class Identification:
    """What data say of parameters: each by itself, and the combinations that are fixed."""

    known: tuple[Known, ...]
    combinations: tuple[Combination, ...]

    @property
    def sentences(self) -> tuple[str, ...]:
        """As one says it."""
        said = []
        words = {
            "identified": "The data identify",
            "narrowed": "The data narrow",
            "not told": "The data say next to nothing of",
        }
        for standing, verb in words.items():
            told = [one for one in self.known if one.standing == standing]
            names = [
                one.path
                if standing == "not told"
                else f"{one.path} ({si.percent(one.left)} of its prior spread is left)"
                for one in told
            ]
            if names:
                said.append(f"{verb} {_and(names)}.")
        said += [one.sentence for one in self.combinations if len(one.parts) > 1]
        return tuple(said)


def identification(
    paths: tuple[str, ...],
    scores: si.DimensionlessArray,
    weights: si.DimensionlessArray | None = None,
) -> Identification:
    """What draws of scores (draws, parameters), with `weights` (draws,), say of the parameters."""
    if not paths:
        return Identification((), ())
    share = np.full(len(scores), 1 / len(scores)) if weights is None else weights / weights.sum()
    off = scores - share @ scores
    covariance = off.T @ (share[:, None] * off)
    known = tuple(Known(path, float(np.sqrt(covariance[k, k]))) for k, path in enumerate(paths))
    values, vectors = np.linalg.eigh(covariance)
    combinations = []
    for value, vector in zip(values, vectors.T, strict=True):
        left = float(np.sqrt(max(value, 0.0)))
        if left > _FIXED:
            break
        order = np.argsort(-(vector**2))
        vector = vector * np.sign(vector[order[0]])
        alone = vector[order[0]] ** 2 > _ALONE
        parts = order[:1] if alone else [k for k in order if vector[k] ** 2 > _NAMED]
        combinations.append(Combination(left, tuple((paths[k], float(vector[k])) for k in parts)))
    return Identification(known, tuple(combinations))


def _and(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
