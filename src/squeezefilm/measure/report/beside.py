"""Measured friction beside every model: rows of a table, words and the figure."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.kit import style
from squeezefilm.core.kit.numbers import HZ, SPEED, N, shown
from squeezefilm.measure.fits.friction.friction_curve import CurveComparison
from squeezefilm.measure.fits.friction.friction_scores import NO_PHYSICS
from squeezefilm.measure.report.figures import measured_points
from squeezefilm.physics.chain.friction_models import DEFAULT_MODEL

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MODELS_HEAD = ("model", "off by", "in spreads", "answered", "fitted")


def model_rows(compared: CurveComparison) -> list[tuple[str, ...]]:
    """The models and shapes, the nearest first: how far each is off."""
    return [
        (
            model_words(score.model),
            number_words(score.difference, 3),
            number_words(score.in_spreads, 1),
            f"{score.answered} of {len(compared.inside)}",
            str(score.fitted),
        )
        for score in compared.models
    ]


def model_words(model: str) -> str:
    """Name of a model or shape, and whether it is the default or no physics."""
    if model in NO_PHYSICS:
        return f"{model} (no physics)"
    return f"{model} (the default)" if model == DEFAULT_MODEL else model


def number_words(value: float | None, digits: int) -> str:
    """A number with so many decimals; a dash for none."""
    return "–" if value is None else f"{value:.{digits}f}"


def inside_words(compared: CurveComparison) -> str:
    """Number of points that lie in the interval of the default, in words."""
    within, asked = compared.points_inside
    level = si.percent(compared.band.level)
    return (
        f"{within} of {asked} points that vibrate lie in the {level} interval of the default, with "
        "everything but the amplitude uncertain"
    )


def conditions(compared: CurveComparison) -> str:
    """Words for the display on which a curve was measured, and how."""
    c = compared.curve
    words = [
        compared.display,
        _spanned(c.frequency, HZ),
        _spanned(compared.normal_force, N) + _assumed(compared, "normal_force"),
        f"finger at {_spanned(compared.speed, SPEED)}" + _assumed(compared, "speed"),
    ]
    return ", ".join(words)


def _assumed(compared: CurveComparison, name: str) -> str:
    return " (assumed)" if name in compared.assumed else ""


def _spanned(values: si.FloatLike, unit: si.Unit) -> str:
    low, high = shown(float(np.min(values)), unit), shown(float(np.max(values)), unit)
    return low if low == high else f"{low} to {high}"


@style.drawn
def comparison_figure(compared: CurveComparison) -> Figure:
    """The measured points, our interval, and the models: the nearest, the default, all others."""
    curve, nearest = compared.curve, compared.nearest
    name = style.plain(curve.told.name, 50)
    title = f"{name}: nearest is {nearest.model}, off by {nearest.difference or np.nan:.3f}"
    figure = style.new_figure(title, f"friction at rest fitted; {conditions(compared)}", 5)
    axes = figure.subplots()
    amplitude = 1e6 * curve.vibration_amplitude
    level = si.percent(compared.band.level)
    axes.fill_between(
        amplitude,
        compared.fitted_at_rest * compared.band.low,
        compared.fitted_at_rest * compared.band.high,
        color=style.BAND,
        label=f"{level} interval of the default",
    )
    strong = {compared.default.model: style.RENDERED, nearest.model: style.WANTED}
    for score in compared.models:
        look = strong.get(score.model, style.GUIDE)
        label = score.model if score.model in strong else None
        axes.plot(amplitude, score.friction, **look, label=label)
    axes.plot([], [], **style.GUIDE, label="other models and shapes")
    measured_points(axes, curve)
    style.legend_beside(axes)
    return figure
