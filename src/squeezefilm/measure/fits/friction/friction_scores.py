"""Scores of models beside measured friction: a score that no normalisation decides, beside shapes
of which one amplitude is fitted.

The friction at rest is fitted to each curve, whatever the model: an extrapolated one differs by
25 to 35 % between models and would decide in place of the shape. Differences are over one friction
at rest that knows no model, so that curves in newtons and in µ can be averaged.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.recordings.kinds import FrictionCurve
from squeezefilm.physics.contact.sharing.levitation import levitation_friction

_FIRST_POINTS = 3
NO_PHYSICS = ("gaussian", "exponential")
SHAPES: Mapping[str, Callable[[si.FloatArray], si.FloatArray]] = {
    "gaussian": lambda over: np.exp(-(over**2) / 2),
    "exponential": lambda over: np.exp(-over),
    "levitation, its length fitted": levitation_friction,
}
"""Shapes over the amplitude in units of one that is fitted: those of `NO_PHYSICS`, and the
levitation model without a gap at rest."""


@dataclass(frozen=True, eq=False)
class ModelScore:
    """A model beside a curve, with `fitted` numbers fitted to it: the friction at rest, and of
    `SHAPES` the amplitude too.

    `friction` is the model's at the curve's amplitudes and in its unit, shape (points,), NaN where
    the model refuses one. `difference` is the root mean square of measured less computed over the
    friction at rest of `rest_friction`, `in_spreads` the same in standard deviations of the points;
    None where the model answers nowhere, or no deviation is known.
    """

    model: str
    fitted: int
    friction: si.FloatArray
    difference: si.Dimensionless | None
    in_spreads: si.Dimensionless | None

    @property
    def answered(self) -> int:
        """Number of amplitudes at which the model has a friction."""
        return int(np.count_nonzero(np.isfinite(self.friction)))

    @property
    def rank(self) -> tuple[bool, float]:
        """Key that sorts the least difference first, and models that refuse an amplitude last."""
        return self.answered < self.friction.size, self.difference or 0.0


def rest_friction(curve: FrictionCurve) -> float:
    """Friction at rest in the curve's unit: the line through its three smallest amplitudes, at
    zero.

    Raises `InputError` where that is not above 0.
    """
    amplitude = curve.vibration_amplitude[:_FIRST_POINTS]
    friction = curve.friction[:_FIRST_POINTS]
    at_rest = float(np.mean(friction))
    if np.ptp(amplitude) > 0:
        at_rest = float(np.polynomial.Polynomial.fit(amplitude, friction, 1)(0.0))
    if at_rest <= 0:
        raise InputError(
            f"the friction of '{curve.told.name}' at rest is {at_rest:.3g} by the line through its "
            "first three points; it must be above 0: give points in the order of the amplitude, "
            "and friction with its sign"
        )
    return at_rest


def shape_scores(curve: FrictionCurve) -> tuple[ModelScore, ...]:
    """The scores of `SHAPES`."""
    scores = []
    for name in SHAPES:
        _, shape = fitted_shape(name, curve.vibration_amplitude, curve.friction)
        scores.append(scored(name, shape, curve, fitted=2))
    return tuple(scores)


def fitted_shape(
    name: str, amplitude: si.MetreArray, friction: si.FloatArray
) -> tuple[si.Metre, si.DimensionlessArray]:
    """The amplitude (m) that a shape of `SHAPES` is over, by least squares with the friction at
    rest free, and the relative friction (points,) that it gives."""
    shape, largest = SHAPES[name], float(np.max(amplitude))
    coarse = largest * np.geomspace(0.02, 50.0, 60)
    known = [shape(amplitude / decay) for decay in coarse]
    decay = nearest_scale(lambda decay: shape(amplitude / decay), coarse, known, friction)
    return decay, shape(amplitude / decay)


def nearest_scale(
    curve_of: Callable[[float], si.FloatArray],
    coarse: si.MetreArray,
    known: Sequence[si.FloatArray] | si.FloatArray,
    friction: si.FloatArray,
) -> si.Metre:
    """The scale (m) of which `curve_of` is nearest to a friction (points,) by least squares, with
    the friction at rest free; `known` are the curves at the rising scales of `coarse` (m)."""

    def error(curve: si.FloatArray) -> float:
        return float(np.sum((friction - _scaled(curve, friction)) ** 2))

    # Coarse first: the sum of squares is flat far from the best scale.
    logs, near = np.log(coarse), int(np.argmin([error(curve) for curve in known]))
    ends = logs[max(near - 1, 0)], logs[min(near + 1, logs.size - 1)]
    nearest = minimize_scalar(
        lambda log: error(curve_of(np.exp(log))), bounds=ends, method="bounded"
    )
    return float(np.exp(nearest.x))


def _scaled(shape: si.DimensionlessArray, friction: si.FloatArray) -> si.FloatArray:
    """A shape times the friction at rest that is nearest to a curve by least squares; NaN where it
    is unknown."""
    known = np.isfinite(shape)
    square = float(np.sum(shape[known] ** 2))
    if square == 0:
        return np.full(shape.size, np.nan)
    return np.asarray(shape * float(np.sum(shape[known] * friction[known])) / square)


def scored(
    model: str, relative_friction: si.DimensionlessArray, curve: FrictionCurve, fitted: int = 1
) -> ModelScore:
    """The score of µ′/µ of a model at a curve's amplitudes, shape (points,), NaN where refused."""
    friction = _scaled(relative_friction, curve.friction)
    off = curve.friction - friction
    known = np.isfinite(off)
    if not known.any():
        return ModelScore(model, fitted, friction, None, None)
    difference = float(np.sqrt(np.mean(off[known] ** 2))) / rest_friction(curve)
    in_spreads = None
    if curve.deviation is not None and (sure := known & (curve.deviation > 0)).any():
        in_spreads = float(np.sqrt(np.mean((off[sure] / curve.deviation[sure]) ** 2)))
    return ModelScore(model, fitted, friction, difference, in_spreads)
