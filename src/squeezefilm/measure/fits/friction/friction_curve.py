"""Measured friction beside every model of friction, and beside the interval."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.progress import SayProgress, said_with_time_left, within
from squeezefilm.core.results import to_json, values_of
from squeezefilm.measure.fits.estimate import Adequacy, FitResult, Observation
from squeezefilm.measure.fits.friction.friction_scores import (
    SHAPES,
    ModelScore,
    rest_friction,
    scored,
    shape_scores,
)
from squeezefilm.measure.recordings.kinds import FrictionCurve
from squeezefilm.physics.chain.friction import where_known
from squeezefilm.physics.chain.pad_law import DEFAULT_MODEL, MODEL_KINDS
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.uncertainty.intervals import LEVEL
from squeezefilm.physics.uncertainty.uncertainty import FrictionBand, friction_bands

_SAMPLES = 64
LEVELS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, LEVEL)
"""Levels of the central intervals of which the coverage is counted, that of `FrictionBand` last."""


@dataclass(frozen=True, eq=False, repr=False)
class CurveComparison(FitResult):
    """A measured curve beside all models and shapes, of which its friction at rest alone was
    fitted to it (of `SHAPES` an amplitude too).

    `models` have the nearest first; `at_rest` is the friction at rest that knows no model, in the
    curve's unit, and `fitted_at_rest` that of our default's fit, by which `band`, the interval in
    which the default expects µ′/µ with everything but the amplitude uncertain, is compared:
    `inside_levels` says of each measured point whether it lies in each central interval of
    `LEVELS`, shape (levels, points), the last of which is the band. `adequacy` is the default
    model's. `normal_force` and `speed` are those that were computed with, `assumed` names the ones
    that the recording does not tell.
    """

    curve: FrictionCurve
    display: str
    models: tuple[ModelScore, ...]
    at_rest: float
    fitted_at_rest: float
    normal_force: si.NewtonLike
    speed: si.MetrePerSecondLike
    assumed: tuple[str, ...]
    band: FrictionBand
    inside_levels: NDArray[np.bool_]
    _shown: ClassVar[str] = "display adequacy.sentence"

    @property
    def inside(self) -> tuple[bool | None, ...]:
        """Flags, True for each point that lies in `band`; where the band is not known it does not,
        None where nothing vibrates."""
        return tuple(
            None if a == 0 else bool(here)
            for a, here in zip(self.curve.vibration_amplitude, self.inside_levels[-1], strict=True)
        )

    @property
    def nearest(self) -> ModelScore:
        """The model with the least difference among those that answer at every amplitude."""
        return next(score for score in self.models if score.model not in SHAPES)

    @property
    def default(self) -> ModelScore:
        """The default model's."""
        return next(score for score in self.models if score.model == DEFAULT_MODEL)

    @property
    def points_inside(self) -> tuple[int, int]:
        """Number of points in the interval, and of those that could be."""
        asked = [point for point in self.inside if point is not None]
        return sum(asked), len(asked)

    @property
    def covered(self) -> bool:
        """True where as many points lie in the interval as its level says."""
        within, asked = self.points_inside
        return within >= self.band.level * asked

    @property
    def observations(self) -> tuple[Observation, ...]:
        """Each measured point, for a calibration, but those without vibration: over these where the
        curve is not in µ′/µ, with their error. None of a curve whose spread is not known, or that
        has no friction without vibration at one force."""
        c = self.curve
        if c.deviation is None:
            return ()
        still, unsure = 1.0, 0.0
        if c.quantity != "relative_friction":
            rest = c.vibration_amplitude == 0
            if not rest.any() or np.ptp(self.normal_force) > 0 or np.mean(c.friction[rest]) <= 0:
                return ()
            still = float(np.mean(c.friction[rest]))
            unsure = float(np.linalg.norm(c.deviation[rest])) / int(rest.sum()) / still
        relative = c.friction / still
        error = np.hypot(c.deviation / still, relative * unsure)
        force, speed = (
            np.broadcast_to(of, c.friction.shape) for of in (self.normal_force, self.speed)
        )
        return tuple(
            Observation(
                "relative_friction",
                float(relative[k]),
                float(error[k]),
                {
                    "vibration_amplitude": float(c.vibration_amplitude[k]),
                    "normal_force": float(force[k]),
                    "finger_speed": float(speed[k]),
                },
            )
            for k in range(c.friction.size)
            if c.deviation[k] > 0 and c.vibration_amplitude[k] > 0
        )

    def summary(self) -> dict[str, Any]:
        """Numbers as plain JSON values; keys carry units."""
        c = self.curve
        return {
            "recording": to_json(c.told),
            **values_of(
                self,
                "display curve.finger curve.frequency normal_force speed assumed "
                "curve.vibration_amplitude curve.quantity curve.deviation adequacy",
            ),
            "measured": to_json(c.friction),
            "friction_at_rest": self.at_rest,
            "interval": {
                **values_of(self.band, "level low high"),
                "inside": list(self.inside),
                "points_inside": self.points_inside[0],
                "points_asked": self.points_inside[1],
            },
            "models": [
                {
                    **values_of(score, "model fitted answered friction"),
                    "rms_difference": score.difference,
                    "rms_difference_in_spreads": score.in_spreads,
                }
                for score in self.models
            ],
        }


def display_of(recording: str, display: str) -> Display:
    """The display that a recording names. Raises `InputError` where it names none."""
    if not display:
        raise InputError(
            f"the recording '{recording}' names no display; write display = \"…\" into "
            "its description: a preset, or a TOML file that describes plate, surface and finger",
            quantity="display",
        )
    return load_display(display)


def compare_friction_curve(
    curve: FrictionCurve, progress: SayProgress | None = None, display: Display | None = None
) -> CurveComparison:
    """A measured curve beside every model of friction at its frequency, force and speed, on the
    `display` that was given, or the one that it names; the friction at rest alone is fitted.

    A force or speed that the recording does not tell is the display's. The interval is that of
    `friction_bands`: 90 % of draws over parameters, laws and mechanisms. Raises `InputError` for a
    curve without a display, and what `predict` raises for its display at its largest amplitude.
    """
    tell = said_with_time_left(progress or (lambda _: None))
    display = display_of(curve.told.name, curve.display) if display is None else display
    at_rest = rest_friction(curve)
    finger = display.finger
    assumed = tuple(name for name in ("normal_force", "speed") if getattr(curve, name) is None)
    force = finger.normal_force if curve.normal_force is None else curve.normal_force
    speed = finger.speed if curve.speed is None else curve.speed
    amplitude, count = curve.vibration_amplitude, curve.friction.size
    friction = {model: np.full(count, np.nan) for model in MODEL_KINDS}
    edges = np.full((len(LEVELS), 2, count), np.nan)
    at = np.stack([np.broadcast_to(of, count) for of in (curve.frequency, force, speed)])
    several = np.unique(at, axis=1).T
    for number, condition in enumerate(several):
        here = np.flatnonzero((at == condition[:, None]).all(axis=0))
        part = within(tell, number / len(several), (number + 1) / len(several))
        part(f"{curve.told.name}: the working mode of {display.name}", 0.0)
        frequency, normal_force, own_speed = map(float, condition)
        prediction = predict(
            display,
            vibration_amplitude=float(amplitude[here].max()),
            frequency=frequency,
            normal_force=normal_force,
            speed=own_speed,
        )
        for k, model in enumerate(MODEL_KINDS):
            part(f"{curve.told.name}: {model}", 0.2 + 0.3 * k / len(MODEL_KINDS))
            friction[model][here] = where_known(prediction.law.by(model).curve, amplitude[here])
        bands = friction_bands(
            display,
            prediction,
            amplitude[here],
            LEVELS,
            samples=_SAMPLES,
            progress=within(part, 0.5, 1.0),
        )
        edges[:, :, here] = [(band.low, band.high) for band in bands]
    scores = [scored(model, friction[model], curve) for model in MODEL_KINDS]
    scores += shape_scores(curve)
    scores.sort(key=lambda score: score.rank)
    default = next(score for score in scores if score.model == DEFAULT_MODEL)
    # Where the default falls steeply from rest on, a line through its first points starts too low.
    fitted = float(np.nanmean(default.friction / friction[DEFAULT_MODEL]))
    relative = curve.friction / fitted
    inside_levels = (edges[:, 0] <= relative) & (relative <= edges[:, 1])
    return CurveComparison(
        curve=curve,
        display=display.name,
        models=tuple(scores),
        at_rest=at_rest,
        fitted_at_rest=fitted,
        normal_force=force,
        speed=speed,
        assumed=assumed,
        band=FrictionBand(amplitude, edges[-1, 0], edges[-1, 1], LEVEL, _SAMPLES),
        adequacy=_adequacy(curve, default, at_rest),
        inside_levels=inside_levels,
    )


def _adequacy(curve: FrictionCurve, default: ModelScore, at_rest: float) -> Adequacy:
    """Judge whether the default model describes the curve within what its spread alone leaves.

    With n points of independent errors and one number fitted the sum of squares in spreads is
    chi-square with n − 1 degrees; what exceeds its 99 % quantile is more than chance.
    """
    from scipy.stats import chi2

    off = np.abs(curve.friction - default.friction) / at_rest
    if not np.isfinite(off).any():
        words = f"{default.model} has no friction at any of these amplitudes"
        return Adequacy(False, float("nan"), float("nan"), "everywhere", words)
    worst = int(np.nanargmax(off))
    where = f"at {1e6 * curve.vibration_amplitude[worst]:.3g} µm"
    deviation = np.zeros(off.size) if curve.deviation is None else curve.deviation / at_rest
    count = np.count_nonzero((deviation > 0) & np.isfinite(off))
    adequate = bool(
        default.in_spreads is not None
        and count > 1
        and default.in_spreads**2 * count <= chi2.ppf(0.99, count - 1)
        and np.isfinite(off).all()
    )
    said = "describes the curve within its spread" if adequate else "does not describe the curve"
    if default.in_spreads is None:
        said = "cannot be judged, since the curve has no spread"
    sentence = (
        f"{default.model} {said}: it is off by {default.difference:.3f} (r.m.s., over the friction "
        f"at rest), most {where}, by {off[worst]:.3f}; the friction at rest alone was fitted"
    )
    return Adequacy(adequate, float(np.nanmean(off)), float(np.mean(deviation)), where, sentence)
