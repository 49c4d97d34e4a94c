"""Many draws of a mixture, kept on disk, and the check of how many are asked for.

Whoever analyses a display again, with another texture or report, asks for the same draws again.
"""

from __future__ import annotations

import dataclasses
import functools
import json
from hashlib import blake2b

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, SqueezefilmError
from squeezefilm.core.kept.store import Kept
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import to_json
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.display import Display
from squeezefilm.physics.uncertainty.draws import Mixture, Outcome, Refusals, as_drawn

# So many messages take no time.
_TOLD = 20

# Fewer are drawn again sooner than found.
_WORTH_KEEPING = 100


_KEPT: Kept[tuple[si.FloatArray, Refusals]] = Kept(
    "draws", tuple[si.FloatArray, Refusals], large=True
)


def evaluate(
    mixture: Mixture,
    points: si.DimensionlessArray,
    tell: SayProgress,
    what: str = "friction of draw",
) -> tuple[Outcome, Refusals]:
    """Outcome of draws at points of the unit cube, shape (n, inputs): arrays of shape (n,), NaN
    where refused; and what was refused. `tell` is told some twenty times."""
    outcomes = mixture.known(points)
    new = np.flatnonzero(np.isnan(outcomes[:, 0]))
    make = functools.partial(_drawn_now, mixture, points, new, tell, what)
    worth_keeping = new.size >= _WORTH_KEEPING
    made = _KEPT.found(hash_of_draws(mixture, points[new]), make) if worth_keeping else make()
    outcomes[new], refused = made
    mixture.learn(points[new], outcomes[new])
    return Outcome(*outcomes.T), dataclasses.replace(refused, evaluations=len(points))


def description_of(display: Display, prediction: Prediction, more: object = None) -> str:
    """All that follows from a display at a prediction's working point is kept under: both with
    every number in full, and whatever `more` it depends on."""
    sources = sorted(display.provenance.items())
    return json.dumps(to_json([display, sources, prediction.summary(), prediction.law.slip, more]))


def hash_of_draws(mixture: Mixture, points: si.DimensionlessArray, more: object = None) -> str:
    """A hash of all that draws at points of the unit cube, shape (n, inputs), come from: the
    display with its ranges, its prediction, and of these what the prediction's numbers do not say
    in full; and of what `more` is made of them."""
    p, law = mixture.prediction, mixture.prediction.law
    beside = (p.mode.modal_mass, p.held_amplitude, law.position, *law.ridge_swings)
    told = (mixture.model, mixture.inputs, beside, points, more)
    return blake2b(description_of(mixture.display, p, told).encode()).hexdigest()


@as_drawn()
def _drawn_now(
    mixture: Mixture,
    points: si.DimensionlessArray,
    new: si.IntArray,
    tell: SayProgress,
    what: str,
) -> tuple[si.FloatArray, Refusals]:
    """Outcome of the points numbered `new`, shape (n, 3), and what was refused."""
    outcomes, refused = np.full((new.size, 3), np.nan), Refusals(new.size)
    every = max(new.size // _TOLD, 1)
    draws = mixture.draws(points[new]) if new.size else iter(())
    for number, (point, draw) in enumerate(zip(points[new], draws, strict=True)):
        if number % every == 0:
            tell(f"{what} {number + 1} of {len(points)}")
        try:
            outcomes[number] = mixture.outcome(point, draw)
        except SqueezefilmError as error:
            refused.refuse(draw.heights, error)
    return outcomes, refused


def require_samples(samples: int) -> None:
    """Raise `InputError` for base samples that are no power of two from 8 to 65 536."""
    if samples < 8 or samples > 65536 or samples & (samples - 1):
        raise InputError(
            f"samples = {samples} cannot be used: take a power of two from 8 to 65536, like 128",
            quantity="samples",
        )
