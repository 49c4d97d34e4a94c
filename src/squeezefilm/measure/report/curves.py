"""Measured friction curves beside every model: what `reproduce --data` shows."""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.kit import style
from squeezefilm.core.kit.folder import json_text, write_folder
from squeezefilm.core.kit.numbers import HZ, SPEED, N, printable, shown
from squeezefilm.core.kit.page_style import (
    bullets,
    page,
    picture_sections,
    section,
    stamped,
    text_table,
)
from squeezefilm.core.kit.terminal import bullets as printed_bullets
from squeezefilm.core.kit.terminal import heading, plain_console, table
from squeezefilm.core.results import stamp
from squeezefilm.measure.fits.friction.friction_curve import LEVELS, CurveComparison
from squeezefilm.measure.fits.friction.friction_folder import FolderComparison
from squeezefilm.measure.fits.friction.friction_scores import NO_PHYSICS
from squeezefilm.measure.fits.friction.populations import PopulationComparison
from squeezefilm.measure.report.detection import (
    DETECTION_HEAD,
    detection_figure,
    detection_rows,
    detection_words,
)
from squeezefilm.measure.report.figures import measured_points
from squeezefilm.physics.chain.friction_models import DEFAULT_MODEL

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MODELS_HEAD = ("model", "off by", "in spreads", "answered", "fitted")
TOTALS_HEAD = ("model", "off by", "log score, mean ± s.e.", "fitted")
COVERAGE_HEAD = ("finger or paper", "points", "in the 50 % interval", "in the 90 % interval")
PEOPLE_HEAD = ("model", "value", "share of measured below")
FITTED = (
    "'Off by' is the root mean square of measured less computed friction, over one friction at "
    "rest that knows no model (the line through the first three points). The friction at rest is "
    "fitted to each curve, whatever the model; of shapes without physics, and of the levitation "
    "whose length is fitted, one amplitude too."
)
SCORES = (
    "Each finger counts once, and so does each paper whose fingers are not told apart. The log "
    "score is the mean natural logarithm of the density of a point, in units of the friction at "
    "rest, with the model's error over the other fingers and papers as its spread: higher is "
    "better."
)


def model_rows(compared: CurveComparison) -> list[tuple[str, ...]]:
    """The models and shapes, the nearest first: how far each is off."""
    return [
        (
            _model_words(score.model),
            _number(score.difference, 3),
            _number(score.in_spreads, 1),
            f"{score.answered} of {len(compared.inside)}",
            str(score.fitted),
        )
        for score in compared.models
    ]


def total_rows(compared: FolderComparison) -> list[tuple[str, ...]]:
    """The models over all fingers and papers, the nearest first."""
    return [
        (
            _model_words(total.model),
            _number(total.difference, 3),
            _number(total.log_score, 2)
            + ("" if total.log_score_error is None else f" ± {total.log_score_error:.2f}"),
            str(total.fitted),
        )
        for total in compared.totals
    ]


def people_rows(compared: PopulationComparison) -> list[tuple[str, ...]]:
    """What each model gives of a number of many people."""
    return [
        (
            _model_words(model),
            "–" if value is None else _valued(value, compared.unit),
            "–" if value is None else si.percent(compared.share_below(value)),
        )
        for model, value in compared.models
    ]


# Micrometres and milligrams, on the axis of a figure.
_SHOWN = {"m": ("µm", 1e6), "kg": ("mg", 1e6)}


def _valued(value: float, unit: str) -> str:
    return f"{1e6 * value:.3g} mg" if unit == "kg" else printable(shown(value, si.Unit(unit), 3))


def _model_words(model: str) -> str:
    if model in NO_PHYSICS:
        return f"{model} (no physics)"
    return f"{model} (the default)" if model == DEFAULT_MODEL else model


def _number(value: float | None, digits: int) -> str:
    return "–" if value is None else f"{value:.{digits}f}"


def inside_words(compared: CurveComparison) -> str:
    """How many points lie in our interval."""
    within, asked = compared.points_inside
    level = si.percent(compared.band.level)
    return (
        f"{within} of {asked} points that vibrate lie in the {level} interval of the default, with "
        "everything but the amplitude uncertain"
    )


def covered_words(compared: FolderComparison) -> str:
    """How many fingers and papers lie in our interval."""
    within, units, (low, high) = compared.units_covered
    return (
        f"{within} of {units} fingers or papers lie in the interval of the default, at least 90 % "
        f"of their points ({low:.2f}–{high:.2f}, 95 % interval of the share)"
    )


def coverage_rows(compared: FolderComparison) -> list[tuple[str, ...]]:
    """By finger or paper, the share of points in two central intervals of the default."""
    at = [LEVELS.index(level) for level in (0.5, 0.9)]
    return [
        (_unit_name(compared, unit), str(points), *(si.percent(inside[k] / points) for k in at))
        for unit, (inside, points) in compared.coverage.items()
    ]


def _unit_name(compared: FolderComparison, unit: str) -> str:
    """What the first curve of a finger or paper is called."""
    return next(printable(one.curve.told.name) for one in compared.curves if one.curve.unit == unit)


def people_words(compared: PopulationComparison) -> str:
    """How a number is distributed over people."""
    low, median, high = (
        _valued(float(value), compared.unit)
        for value in np.quantile(compared.measured, [0.05, 0.5, 0.95])
    )
    return (
        f"{compared.quantity}: median {median}, 5 to 95 % {low} to {high}, "
        f"{compared.measured.size} measured; {compared.display}, {compared.conditions}"
    )


def conditions(compared: CurveComparison) -> str:
    """On which display a curve was measured, and how."""
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
        color=style.BAND, label=f"{level} interval of the default",
    )  # fmt: skip
    strong = {compared.default.model: style.RENDERED, nearest.model: style.WANTED}
    for score in compared.models:
        look = strong.get(score.model, style.GUIDE)
        label = score.model if score.model in strong else None
        axes.plot(amplitude, score.friction, **look, label=label)
    axes.plot([], [], **style.GUIDE, label="other models and shapes")
    measured_points(axes, curve)
    style.legend_beside(axes)
    return figure


@style.drawn
def all_curves_figure(compared: FolderComparison) -> Figure:
    """Every measured curve over its friction at rest, and the default model beside each."""
    figure = style.new_figure(
        "Published friction over the amplitude, and the default model",
        "the default, lines, its friction at rest fitted; measured, points", 5,
    )  # fmt: skip
    axes = figure.subplots()
    colours = (style.BLUE, style.ORANGE, style.GREEN, style.INK)
    for number, one in enumerate(compared.curves):
        colour, amplitude = colours[number % len(colours)], 1e6 * one.curve.vibration_amplitude
        name = style.plain(one.curve.told.name, 40)
        axes.plot(amplitude, one.curve.friction / one.at_rest, "o", color=colour, ms=4, label=name)
        axes.plot(amplitude, one.default.friction / one.at_rest, "-", color=colour, lw=1.2)
    style.friction_axes(axes, top=axes.get_ylim()[1])
    axes.set_ylabel("friction over friction at rest")
    style.legend_beside(axes)
    return figure


@style.drawn
def coverage_figure(compared: FolderComparison) -> Figure:
    """The share of each unit's points in central intervals of the default, over their level."""
    from scipy.stats import binomtest

    figure = style.new_figure(
        "How many published points the intervals of the default hold, by finger or paper",
        "the default, its friction at rest fitted; bars: 95 % binomial intervals, as if the points "
        "of a curve were independent, which they are not", 5,
    )  # fmt: skip
    axes = figure.subplots()
    colours = (style.BLUE, style.ORANGE, style.GREEN, style.INK)
    for number, (unit, (inside, points)) in enumerate(compared.coverage.items()):
        share = inside / points
        found = [binomtest(int(k), points).proportion_ci(0.95) for k in inside]
        away = np.abs([[one.low, one.high] for one in found] - share[:, None]).T
        axes.errorbar(
            100 * np.array(LEVELS) + 0.6 * (number - 1), 100 * share, 100 * away, fmt="o-", ms=4,
            lw=1.2, elinewidth=0.7, color=colours[number % len(colours)],
            label=f"{style.plain(_unit_name(compared, unit), 40)} ({points} points)",
        )  # fmt: skip
    axes.plot([0, 100], [0, 100], **style.GUIDE, label="as promised")
    axes.set(
        xlabel="level of the central interval (%)", ylabel="points inside (%)",
        xlim=(0, 100), ylim=(0, 102),
    )  # fmt: skip
    style.legend_beside(axes)
    return figure


@style.drawn
def people_figure(compared: PopulationComparison) -> Figure:
    """How many people have less than a value, and where the models are."""
    unit, scale = _SHOWN.get(compared.unit, (compared.unit, 1.0))
    figure = style.new_figure(
        f"{compared.quantity}: {compared.measured.size} measured",
        f"nothing fitted; {compared.display}, {compared.conditions}", 4,
    )  # fmt: skip
    axes = figure.subplots()
    ordered = scale * np.sort(compared.measured)
    axes.step(ordered, np.arange(1, ordered.size + 1) / ordered.size, color=style.INK, where="post",
              label="measured")  # fmt: skip
    for model, value in compared.models:
        if value is not None:
            look = style.RENDERED if model == DEFAULT_MODEL else style.GUIDE
            axes.axvline(scale * value, **look, label=model if model == DEFAULT_MODEL else None)
    axes.set(xlabel=f"{compared.quantity} ({unit})", ylabel="share of measured", ylim=(0, 1))
    style.legend_beside(axes)
    return figure


def show_comparisons(compared: FolderComparison) -> None:
    """Print each curve, the numbers of many people and the totals beside the models."""
    console = plain_console()
    for one in compared.curves:
        heading(console, f"{one.curve.told.name}: {conditions(one)}")
        table(console, MODELS_HEAD, model_rows(one), fixed=(0,))
        printed_bullets(console, [("", inside_words(one), ""), ("", one.adequacy.sentence, "")])
    for people in compared.populations:
        heading(console, f"{people.told.name}: {people.quantity}")
        table(console, PEOPLE_HEAD, people_rows(people), fixed=(0,))
        printed_bullets(console, [("", people_words(people), "")])
    for detected in compared.detections:
        heading(console, detected.told.name)
        table(console, DETECTION_HEAD, detection_rows(detected), fixed=(0,))
        printed_bullets(console, [("", words, "") for words in detection_words(detected)])
    if len(compared.curves) > 1:
        heading(console, "All curves")
        table(console, TOTALS_HEAD, total_rows(compared), fixed=(0,))
        table(console, COVERAGE_HEAD, coverage_rows(compared), fixed=(0,))
        printed_bullets(console, [("", covered_words(compared), ""), ("", SCORES, "")])
    console.print(f"\n{FITTED}")


def write_comparisons(compared: FolderComparison, folder: Path) -> Path:
    """Write curves.json, a picture of each curve and measured-curves.html into `folder`.

    Returns the path of the page. Raises `InputError` for a folder that cannot be written to.
    """
    summary = compared.summary()
    summary_stamp = stamp(summary)
    files: dict[str, str | bytes] = {"curves.json": json_text(summary | {"stamp": summary_stamp})}
    body = section("What is compared", f"<p>{FITTED}</p>")
    if len(compared.curves) > 1:
        rows = text_table("All curves", TOTALS_HEAD, total_rows(compared))
        figure = coverage_figure(compared)
        files["coverage.png"] = style.png(figure)
        held = text_table(
            "Points in the default's intervals", COVERAGE_HEAD, coverage_rows(compared)
        )
        body += section("All curves", rows + bullets([covered_words(compared), SCORES]) + held)
        body += picture_sections({"coverage": ("Coverage by finger or paper", figure)})
    parts = [
        (one.curve.told, [conditions(one), inside_words(one), one.adequacy.sentence],
         text_table("How far each model is off", MODELS_HEAD, model_rows(one)),
         comparison_figure(one))
        for one in compared.curves
    ]  # fmt: skip
    parts += [
        (people.told, [people_words(people)],
         text_table("What each model gives", PEOPLE_HEAD, people_rows(people)),
         people_figure(people))
        for people in compared.populations
    ]  # fmt: skip
    parts += [
        (detected.told, detection_words(detected),
         text_table("What each rival gives", DETECTION_HEAD, detection_rows(detected)),
         detection_figure(detected))
        for detected in compared.detections
    ]  # fmt: skip
    for number, (told, said, rows, figure) in enumerate(parts, 1):
        files[f"curve-{number}.png"] = style.png(figure)
        by = (("measured by", told.who), ("when", told.when), ("instrument", told.instrument),
              ("licence", told.licence), ("source", told.source))  # fmt: skip
        told_words = [f"{what}: {how}" for what, how in by if how]
        body += section(escape(printable(told.name)), bullets([*said, *told_words]) + rows)
        body += picture_sections({f"curve-{number}": (told.name, figure)})
    files["measured-curves.html"] = page(
        "Measured friction", "Measured friction",
        "beside every model, beside fitted shapes, and beside our interval", body,
        stamped(summary_stamp, "SHA-256 of curves and answers"),
    )  # fmt: skip
    write_folder(folder, files)
    return folder / "measured-curves.html"
