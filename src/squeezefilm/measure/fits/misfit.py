"""Judgements of whether what a fit leaves is noise, and what a person is told about it.

Noise differs from point to point; a wrong model leaves neighbours alike. Von Neumann's ratio of
mean square successive difference to mean square (10.1214/aoms/1177731677) tells one from the
other without knowing how large the noise is.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.measure.fits.estimate import Adequacy

STRUCTURED = 4.0
"""Standard deviations by which the ratio must lie below that of noise if neighbours are alike."""

TOLERATED: si.Dimensionless = 0.01
"""A misfit of this share of what was recorded still counts as a description of it."""

TOLERATED_SOMEWHERE: si.Dimensionless = 0.06
"""... and so much of the largest, at five neighbouring points (assumed, as the next)."""

ROUGH: si.Dimensionless = 0.03
"""Misfit up to which a model that is not adequate still gives its numbers roughly."""

_NEAR = 5
_HOPELESS = 0.5
_MOST_ALIKE = 0.98


class Structure(NamedTuple):
    """Likeness of neighbouring residuals: `correlation` 0 for noise, toward 1 for a misfit,
    `significance` in standard deviations."""

    correlation: si.Dimensionless
    significance: si.Dimensionless


def structure_of(residual: si.Array) -> Structure:
    """Likeness of the neighbours in a row of residuals (points,), real or complex."""
    parts = [residual.real, residual.imag] if np.iscomplexobj(residual) else [residual]
    squares = sum(float(part @ part) for part in parts)
    count = len(parts) * residual.size
    if squares == 0 or residual.size < 6:
        return Structure(0.0, 0.0)
    steps = sum(float(np.diff(part) @ np.diff(part)) for part in parts)
    ratio = steps / squares * residual.size / (residual.size - 1)
    return Structure(max(1 - ratio / 2, 0.0), (2 - ratio) / (2 / np.sqrt(count)))


def correlation_factor(residual: si.Array) -> float:
    """Factor of standard errors where neighbouring residuals are alike.

    √((1 + ρ)/(1 − ρ)) for a correlation ρ that falls geometrically with the distance; 1 where it
    could be noise.
    """
    structure = structure_of(residual)
    if structure.significance < STRUCTURED:
        return 1.0
    alike = min(structure.correlation, _MOST_ALIKE)
    return float(np.sqrt((1 + alike) / (1 - alike)))


def adequacy_of(
    data: si.Array,
    residual: si.Array,
    place: Callable[[int], str],
    *,
    remedy: str,
    said: str = "",
    model: str = "The model",
) -> Adequacy:
    """Judge whether a `model` describes `data` (points,), by what it leaves of them, in order.

    Both in the units of the fit: where every point counts by its own size, as in a sweep of
    impedance, both are over that size. `place` puts a point's number into words ("at 30.5 kHz"),
    `remedy` says what to do about a misfit, `said` goes before all else. The misfit is what the
    residual has beyond noise; noise is what differs between neighbours. A misfit of five
    neighbours is judged by itself, since a whole row hides it.
    """
    size = float(np.mean(np.abs(data))) or 1.0
    left = float(np.mean(np.abs(residual))) / size
    structure = structure_of(residual)
    structured = structure.significance > STRUCTURED
    noise = left * float(np.sqrt(max(1 - structure.correlation, 0.0))) if structured else left
    misfit = float(np.sqrt(max(left**2 - noise**2, 0.0)))
    where = place(_worst(residual))
    local = _beyond_noise(residual, noise * size) / (float(np.max(np.abs(data))) or 1.0)

    def judged(adequate: bool, sentence: str) -> Adequacy:
        return Adequacy(adequate, left, noise, where, said + sentence)

    if left > _HOPELESS:
        return judged(
            False,
            f"{model} leaves {si.percent(left)} of what was recorded undescribed, most of it "
            f"{where}: its numbers mean nothing. {remedy}",
        )
    off = f"it is off by {si.percent(misfit, 1)} beyond noise, most {where}"
    if local > TOLERATED_SOMEWHERE and misfit <= TOLERATED:
        off = f"it is off by {si.percent(local, 1)} beyond noise {where}"
    if (structured and misfit > TOLERATED) or local > TOLERATED_SOMEWHERE:
        if misfit <= ROUGH and local <= 2 * TOLERATED_SOMEWHERE:
            return judged(
                False,
                f"{model} describes what was recorded only roughly: {off}. Its numbers are good "
                f"for a first look; the intervals are widened and are no bound. {remedy}",
            )
        return judged(
            False,
            f"{model} does not describe what was recorded: {off}. Intervals are widened for it, "
            f"which cannot make a wrong model right. {remedy}",
        )
    sentence = f"{model} leaves {si.percent(left, 2)} of what was recorded, as noise would"
    if structured:
        sentence = (
            f"{model} describes what was recorded but for {si.percent(misfit, 2)} beyond noise, "
            f"most {where}; intervals are widened for it"
        )
    return judged(True, sentence + ".")


def _beyond_noise(residual: si.Array, noise: float) -> float:
    """Excess of the largest mean of five neighbours over what noise of this mean size makes of one:
    four of its standard deviations."""
    if residual.size < _NEAR:
        return 0.0
    means = np.abs(np.convolve(residual, np.ones(_NEAR) / _NEAR, mode="valid"))
    # A mean size tells the standard deviation of one component.
    share = np.sqrt(2 / np.pi) if np.iscomplexobj(residual) else np.sqrt(np.pi / 2)
    return float(means.max() - STRUCTURED * share * noise / np.sqrt(_NEAR))


def _worst(residual: si.Array) -> int:
    """Index where five residuals in a row are largest on average: a misfit, and not one odd
    point."""
    row = np.abs(residual)
    if row.size < _NEAR:
        return int(np.argmax(row))
    return int(np.argmax(np.convolve(row, np.ones(_NEAR) / _NEAR, mode="same")))
