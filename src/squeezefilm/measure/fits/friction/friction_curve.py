"""A measured friction curve beside every model of friction, and beside the interval."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.analysis.uncertainty import FrictionBand, friction_band
from squeezefilm.chain.friction import FrictionLaw
from squeezefilm.chain.friction_models import DEFAULT_MODEL, MODEL_KINDS, FrictionModel
from squeezefilm.chain.prediction import predict
from squeezefilm.display import Display, load_display
from squeezefilm.errors import InputError, SqueezefilmError
from squeezefilm.measure.fits.estimate import Adequacy, Observation
from squeezefilm.measure.recordings.kinds import FrictionCurve
from squeezefilm.measure.recordings.read import check_folder
from squeezefilm.progress import SayProgress
from squeezefilm.results import to_json

_SAMPLES = 64


@dataclass(frozen=True, eq=False)
class ModelDifference:
    """One model beside a curve: its µ′/µ at the curve's amplitudes, shape (points,), NaN where it
    refuses one; the root mean square of measured less computed over those it answers, and the same
    in units of the measured spread (None where it answers none, or no spread is known)."""

    model: FrictionModel
    relative_friction: si.DimensionlessArray
    difference: si.Dimensionless | None
    in_spreads: si.Dimensionless | None

    @property
    def answered(self) -> int:
        """At how many amplitudes the model has a friction."""
        return int(np.count_nonzero(np.isfinite(self.relative_friction)))


@dataclass(frozen=True, eq=False)
class CurveComparison:
    """A measured curve beside all models, nothing of which was fitted to it.

    `models` have the nearest first; `band` is the interval in which our default expects µ′/µ with
    everything but the amplitude uncertain, `inside` says of each measured point whether it lies
    there (where the band is not known it does not; None where nothing vibrates, and µ′/µ is 1 by
    its meaning). `adequacy` is the default model's.
    """

    curve: FrictionCurve
    display: str
    models: tuple[ModelDifference, ...]
    band: FrictionBand
    inside: tuple[bool | None, ...]
    adequacy: Adequacy

    @property
    def nearest(self) -> ModelDifference:
        """The model with the least difference among those that answer at every amplitude."""
        return self.models[0]

    @property
    def default(self) -> ModelDifference:
        """The default model's."""
        return next(one for one in self.models if one.model == DEFAULT_MODEL)

    @property
    def points_inside(self) -> tuple[int, int]:
        """How many points lie in the interval, and how many could."""
        asked = [one for one in self.inside if one is not None]
        return sum(asked), len(asked)

    @property
    def observations(self) -> tuple[Observation, ...]:
        """Each measured point, for a calibration, but one without vibration (µ′/µ is 1 by its
        meaning); none where its spread is not known."""
        c = self.curve
        return tuple(
            Observation(
                "relative_friction",
                float(friction),
                float(spread),
                {
                    "vibration_amplitude": float(amplitude),
                    "normal_force": c.normal_force,
                    "finger_speed": c.speed,
                },
            )
            for amplitude, friction, spread in zip(
                c.vibration_amplitude, c.relative_friction, c.spread, strict=True
            )
            if spread > 0 and amplitude > 0
        )

    def summary(self) -> dict[str, Any]:
        """What ``--json`` prints; keys carry units."""
        c = self.curve
        return {
            "recording": to_json(c.told),
            "display": self.display,
            "frequency_Hz": c.frequency,
            "normal_force_N": c.normal_force,
            "speed_m_per_s": c.speed,
            "vibration_amplitude_m": to_json(c.vibration_amplitude),
            "measured": to_json(c.relative_friction),
            "spread": to_json(c.spread),
            "interval": {
                "level": self.band.level,
                "low": to_json(self.band.low),
                "high": to_json(self.band.high),
                "inside": list(self.inside),
                "points_inside": self.points_inside[0],
                "points_asked": self.points_inside[1],
            },
            "models": [
                {
                    "model": one.model,
                    "rms_difference": one.difference,
                    "rms_difference_in_spreads": one.in_spreads,
                    "answered": one.answered,
                    "relative_friction": to_json(one.relative_friction),
                }
                for one in self.models
            ],
            "adequacy": to_json(self.adequacy),
        }


def compare_friction_curve(
    curve: FrictionCurve, progress: SayProgress | None = None, display: Display | None = None
) -> CurveComparison:
    """A measured curve beside every model of friction at its frequency, force and speed, on the
    `display` that was given, or the one that it names; nothing is fitted.

    The interval is that of `friction_band`: 90 % of draws over parameters, laws and mechanisms.
    Raises `InputError` for a curve without a display, and what `predict` raises for its display at
    its largest amplitude.
    """
    if display is None and not curve.display:
        raise InputError(
            f"the friction curve '{curve.told.name}' names no display; write display = \"…\" into "
            "its description: a preset, or a TOML file that describes plate, surface and finger",
            quantity="display",
        )
    tell = progress or (lambda _: None)
    display = load_display(curve.display) if display is None else display
    tell(f"{curve.told.name}: the working mode of {display.name}")
    amplitude = curve.vibration_amplitude
    prediction = predict(
        display,
        vibration_amplitude=float(amplitude[-1]),
        frequency=curve.frequency,
        normal_force=curve.normal_force,
        speed=curve.speed,
    )
    found = []
    for model in MODEL_KINDS:
        tell(f"{curve.told.name}: {model}")
        found.append(_difference(curve, model, _answers(prediction.law.by(model), amplitude)))
    tell(f"{curve.told.name}: the interval")
    band = friction_band(display, prediction, amplitude, samples=_SAMPLES)
    measured = curve.relative_friction
    inside = tuple(
        None if a == 0 else bool(low <= x <= high)
        for a, x, low, high in zip(amplitude, measured, band.low, band.high, strict=True)
    )
    found.sort(key=lambda one: (one.answered < amplitude.size, one.difference or 0.0))
    default = next(one for one in found if one.model == DEFAULT_MODEL)
    return CurveComparison(
        curve=curve,
        display=display.name,
        models=tuple(found),
        band=band,
        inside=inside,
        adequacy=_adequacy(curve, default),
    )


def compare_folder(
    folder: str | Path, progress: SayProgress | None = None
) -> tuple[CurveComparison, ...]:
    """`compare_friction_curve` for every friction curve that a folder's TOML files describe.

    Recordings of other kinds are passed over. Raises `InputError` for a folder that has none, and
    for a file that cannot be read, before anything is computed.
    """
    found = check_folder(folder)
    if found.refused:
        raise InputError(found.refused[0].why)
    curves = [one.recording for one in found.checks if isinstance(one.recording, FrictionCurve)]
    if not curves:
        raise InputError(
            f"{folder} holds no friction curve, only: "
            + ", ".join(sorted({one.kind for one in found.checks}))
            + '; write kind = "friction curve" into the description of one'
        )
    return tuple(compare_friction_curve(curve, progress) for curve in curves)


def _answers(law: FrictionLaw, amplitude: si.MetreArray) -> si.DimensionlessArray:
    """µ′/µ at each amplitude, NaN where the law refuses it."""
    with contextlib.suppress(SqueezefilmError):
        return law.curve(amplitude)
    friction = np.full(amplitude.size, np.nan)
    for k, one in enumerate(amplitude):
        with contextlib.suppress(SqueezefilmError):
            friction[k] = law.at(float(one))
    return friction


def _difference(
    curve: FrictionCurve, model: FrictionModel, friction: si.DimensionlessArray
) -> ModelDifference:
    off = curve.relative_friction - friction
    known = np.isfinite(off)
    if not known.any():
        return ModelDifference(model, friction, None, None)
    rms = float(np.sqrt(np.mean(off[known] ** 2)))
    sure = known & (curve.spread > 0)
    spreads = None
    if sure.any():
        spreads = float(np.sqrt(np.mean((off[sure] / curve.spread[sure]) ** 2)))
    return ModelDifference(model, friction, rms, spreads)


def _adequacy(curve: FrictionCurve, default: ModelDifference) -> Adequacy:
    """Whether the default model describes the curve within what its spread alone leaves.

    With n points of independent errors the mean square in spreads is chi-square over n; what
    exceeds its 99 % quantile is more than chance.
    """
    from scipy.stats import chi2

    off = np.abs(curve.relative_friction - default.relative_friction)
    if not np.isfinite(off).any():
        words = f"{default.model} has no friction at any of these amplitudes"
        return Adequacy(False, float("nan"), float("nan"), "everywhere", words)
    worst = int(np.nanargmax(off))
    where = f"at {1e6 * curve.vibration_amplitude[worst]:.3g} µm"
    size = np.maximum(np.abs(curve.relative_friction), 1e-12)
    residual, noise = float(np.nanmean(off / size)), float(np.mean(curve.spread / size))
    count = np.count_nonzero((curve.spread > 0) & np.isfinite(off))
    adequate = bool(
        default.in_spreads is not None
        and default.in_spreads**2 * count <= chi2.ppf(0.99, count)
        and np.isfinite(off).all()
    )
    said = "describes the curve within its spread" if adequate else "does not describe the curve"
    if default.in_spreads is None:
        said = "cannot be judged, since the curve has no spread"
    sentence = (
        f"{default.model} {said}: it is off by {default.difference:.3f} (r.m.s. of µ′/µ), most "
        f"{where}, by {off[worst]:.3f}; nothing was fitted"
    )
    return Adequacy(adequate, residual, noise, where, sentence)
