"""Measured friction beside models: scores that no normalisation decides, beside shapes of which one
amplitude is fitted; and the finger that is nearest, this person's, a new one's or the mean one's.

The friction at rest is fitted to each curve, whatever the model: an extrapolated one differs by
25 to 35 % between models and would decide in place of the shape. Differences are over one friction
at rest that knows no model, so that curves in newtons and in µ can be averaged.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
from scipy.optimize import minimize_scalar

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.distributions import LogNormal
from squeezefilm.core.errors import InputError
from squeezefilm.measure.recordings.kinds import FrictionCurve
from squeezefilm.measure.recordings.read import read_recording
from squeezefilm.physics.chain.friction import FrictionLaw
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.contact.finger.fingertip import FASTEST, MEAN_SPREAD, SLOWEST
from squeezefilm.physics.contact.sharing.levitation import levitation_friction
from squeezefilm.physics.display import DECAY_LENGTH, Display, NamedDisplay, load_display

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


_LENGTHS = np.geomspace(0.3e-6, 100e-6, 120)
# Of a curve's points, left out in turn: neighbours err alike.
_BLOCKS = 5


@dataclass(frozen=True)
class PersonFit:
    """The decay length of a person (m) with its relative standard error, the friction at rest in
    the curve's unit, and the root mean square of what is left over the friction at rest."""

    decay_length: si.Metre
    relative_error: si.Dimensionless
    friction_at_rest: float
    left: si.Dimensionless


@si.checked_numbers
def with_decay_length(law: FrictionLaw, length: Annotated[si.Metre, si.Above(0)]) -> FrictionLaw:
    """The law of a finger whose decay length is another (m), whatever the speed."""
    finger = dataclasses.replace(law.finger, contact_decay_length=length, decay_speed_exponent=0.0)
    return dataclasses.replace(law, finger=finger)


@si.checked_numbers
def fitted_person(curve: FrictionCurve, law: FrictionLaw) -> PersonFit:
    """The decay length and friction at rest that are nearest to a curve by least squares, at the
    law's force and speed.

    The error is a jackknife over five stretches of the curve. Range: lengths from 0.3 to 100 µm, an
    even wave or the law's own place. Raises `InputError` for fewer than six points, and for a curve
    that falls as no length in that range has it.
    """
    amplitude, friction = curve.vibration_amplitude, curve.friction
    if friction.size <= _BLOCKS:
        raise InputError(
            f"a person's curve has {friction.size} points, too few for its two numbers; "
            f"measure at {_BLOCKS + 1} amplitudes or more",
            quantity="finger",
        )
    known = np.array(
        [with_decay_length(law, float(length)).curve(amplitude) for length in _LENGTHS]
    )
    length, rest, left = _nearest(law, amplitude, friction, known)
    if not 1.02 * _LENGTHS[0] < length < 0.98 * _LENGTHS[-1]:
        raise InputError(
            "a person's curve falls too "
            + ("fast" if length < 1e-6 else "little")
            + " for any decay length from 0.3 to 100 µm; measure at more, or larger, amplitudes",
            quantity="finger",
        )
    parts = np.array_split(np.argsort(amplitude, kind="stable"), _BLOCKS)
    without = []
    for part in parts:
        kept = np.setdiff1d(np.arange(friction.size), part)
        without.append(_nearest(law, amplitude[kept], friction[kept], known[:, kept])[0])
    spread = np.log(without)
    error = math.sqrt((_BLOCKS - 1) * float(np.mean((spread - spread.mean()) ** 2)))
    return PersonFit(length, error, rest, left)


def _nearest(
    law: FrictionLaw,
    amplitude: si.MetreArray,
    friction: si.FloatArray,
    known: si.FloatArray,
) -> tuple[si.Metre, float, si.Dimensionless]:
    """Decay length, friction at rest and what is left; `known` are the laws of `_LENGTHS`."""

    def curve_of(length: float) -> si.FloatArray:
        return with_decay_length(law, length).curve(amplitude)

    length = nearest_scale(curve_of, _LENGTHS, known, friction)
    shape = curve_of(length)
    rest = float(shape @ friction / (shape @ shape))
    return length, rest, math.sqrt(np.mean((rest * shape - friction) ** 2)) / rest


@reads_text
def with_finger(
    display: NamedDisplay,
    finger: Annotated[str | Path, "new, mean, or a recording"] = "new",
) -> Display:
    """The display under another finger, which whatever draws a finger takes up.

    "new": a person of whom nothing is known, as described, or as people spread. "mean": the mean of
    people, whose length is known to the standard error of 14 people. A recording of this
    person's friction over the amplitude, as `measure` reads it: its decay length at the recording's
    own speed, with the fit's error; the recording's display, or this one, says how it was
    measured. What else differs between fingers (contact length, force, skin) stays as described.
    Raises `InputError` for another word, and for a recording that is no friction curve.
    """
    if finger == "new":
        return display
    own = display.finger
    if finger == "mean":
        spread = LogNormal(own.contact_decay_length, MEAN_SPREAD)
        why = "the mean of people: standard error over 14 of them"
        return _known(display, spread, why, own.decay_speed)
    if isinstance(finger, str) and not Path(finger).suffix:
        raise InputError(
            f"'{finger}' is no finger; allowed are new, mean, and a file with a friction curve",
            quantity="finger",
        )
    curve = read_recording(finger)
    if not isinstance(curve, FrictionCurve):
        raise InputError(
            f"{finger} holds no friction curve; record friction over the amplitude",
            quantity="finger",
        )
    measured = load_display(curve.display) if curve.display else display
    told = {name: getattr(curve, name) for name in ("normal_force", "speed", "frequency")}
    if any(np.size(value) > 1 for value in told.values() if value is not None):
        raise InputError(
            f"{finger} mixes forces, speeds or frequencies; give a recording of one condition",
            quantity="finger",
        )
    told = {name: None if value is None else float(value) for name, value in told.items()}
    law = predict(
        measured, vibration_amplitude=float(np.max(curve.vibration_amplitude)), **told
    ).law
    fit = fitted_person(curve, law)
    at = min(max(law.speed, SLOWEST), FASTEST)
    # A curve without any noise leaves its reading.
    spread = LogNormal(fit.decay_length, max(fit.relative_error, 0.01))
    why = f"fitted to {Path(finger).name}, {100 * fit.left:.1f} % of the friction at rest left"
    return _known(display, spread, why, at)


def _known(display: Display, spread: LogNormal, why: str, speed: si.MetrePerSecond) -> Display:
    """The display under a finger whose length at a speed (m/s) is known as `spread` has it (m)."""
    length = spread.median
    finger = dataclasses.replace(display.finger, contact_decay_length=length, decay_speed=speed)
    provenance = {**display.provenance, DECAY_LENGTH: Provenance(why, "derived", spread)}
    return dataclasses.replace(display, finger=finger, provenance=provenance)
