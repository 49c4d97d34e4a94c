"""Measured friction curves beside every model: what `reproduce --data` shows."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.chain.friction_models import DEFAULT_MODEL
from squeezefilm.measure.fits.friction.friction_curve import CurveComparison, ModelDifference
from squeezefilm.report.kit import style
from squeezefilm.report.kit.folder import json_text, write_folder
from squeezefilm.report.kit.numbers import HZ, SPEED, N, printable, shown
from squeezefilm.report.kit.page_style import (
    bullets,
    page,
    picture_sections,
    section,
    stamped,
    text_table,
)
from squeezefilm.report.kit.terminal import bullets as printed_bullets
from squeezefilm.report.kit.terminal import heading, plain_console, table
from squeezefilm.report.measured.figures import measured_points
from squeezefilm.results import stamp

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MODELS_HEAD = ("model", "r.m.s. difference of µ′/µ", "in measured spreads", "amplitudes answered")
NOTHING_FITTED = "Nothing was fitted to these curves: every model is as it stands."


def model_rows(compared: CurveComparison) -> list[tuple[str, ...]]:
    """The models, the nearest first: how far each is off."""
    return [_row(one, len(compared.inside)) for one in compared.models]


def _row(one: ModelDifference, points: int) -> tuple[str, ...]:
    off = "–" if one.difference is None else f"{one.difference:.3f}"
    spreads = "–" if one.in_spreads is None else f"{one.in_spreads:.1f}"
    name = f"{one.model} (the default)" if one.model == DEFAULT_MODEL else one.model
    return name, off, spreads, f"{one.answered} of {points}"


def inside_words(compared: CurveComparison) -> str:
    """How many points lie in our interval."""
    within, asked = compared.points_inside
    level = si.percent(compared.band.level)
    return (
        f"{within} of {asked} points that vibrate lie in our {level} interval, which draws "
        "everything but the amplitude"
    )


def conditions(compared: CurveComparison) -> str:
    """On which display a curve was measured, and how."""
    c = compared.curve
    return (
        f"{compared.display}, {shown(c.frequency, HZ)}, {shown(c.normal_force, N)}, finger at "
        f"{shown(c.speed, SPEED)}"
    )


@style.drawn
def comparison_figure(compared: CurveComparison) -> Figure:
    """The measured points, our interval, and the models: the nearest, the default, all others."""
    curve, nearest = compared.curve, compared.nearest
    name = style.plain(curve.told.name, 50)
    title = f"{name}: nearest is {nearest.model}, off by {nearest.difference or np.nan:.3f}"
    figure = style.new_figure(
        title, f"each as it stands, nothing fitted; {conditions(compared)}", 5
    )
    axes = figure.subplots()
    amplitude = 1e6 * curve.vibration_amplitude
    level = si.percent(compared.band.level)
    axes.fill_between(
        amplitude, compared.band.low, compared.band.high, color=style.BAND,
        label=f"our {level} interval",
    )  # fmt: skip
    strong = {compared.default.model: style.RENDERED, nearest.model: style.WANTED}
    for one in compared.models:
        look = strong.get(one.model, style.GUIDE)
        label = one.model if one.model in strong else None
        axes.plot(amplitude, one.relative_friction, **look, label=label)
    axes.plot([], [], **style.GUIDE, label="other models")
    measured_points(axes, curve)
    top = max(1.04, 1.1 * float(np.max(curve.relative_friction + curve.spread)))
    style.friction_axes(axes, top=top)
    style.legend_beside(axes)
    return figure


def show_comparisons(compared: Sequence[CurveComparison]) -> None:
    """Print each curve beside the models."""
    console = plain_console()
    for one in compared:
        heading(console, f"{one.curve.told.name}: {conditions(one)}")
        table(console, MODELS_HEAD, model_rows(one), fixed=(0,))
        printed_bullets(console, [("", inside_words(one), ""), ("", one.adequacy.sentence, "")])
    console.print(f"\n{NOTHING_FITTED}")


def write_comparisons(compared: Sequence[CurveComparison], folder: Path) -> Path:
    """Write curves.json, a picture of each curve and measured-curves.html into `folder`.

    Returns the path of the page. Raises `InputError` for a folder that cannot be written to.
    """
    summary = {"curves": [one.summary() for one in compared]}
    summary_stamp = stamp(summary)
    files: dict[str, str | bytes] = {"curves.json": json_text(summary | {"stamp": summary_stamp})}
    body = section("What is compared", f"<p>{NOTHING_FITTED}</p>")
    for number, one in enumerate(compared, 1):
        figure = comparison_figure(one)
        files[f"curve-{number}.png"] = style.png(figure)
        name = escape(printable(one.curve.told.name))
        rows = text_table("How far each model is off", MODELS_HEAD, model_rows(one))
        told = one.curve.told
        by = (("measured by", told.who), ("when", told.when), ("instrument", told.instrument),
              ("licence", told.licence), ("source", told.source))  # fmt: skip
        said = [conditions(one), inside_words(one), one.adequacy.sentence]
        said += [f"{what}: {how}" for what, how in by if how]
        body += section(name, bullets(said) + rows)
        body += picture_sections({f"curve-{number}": (one.curve.told.name, figure)})
    files["measured-curves.html"] = page(
        "Measured friction curves", "Measured friction curves",
        "each beside every model of friction, and beside our interval", body,
        stamped(summary_stamp, "SHA-256 of curves and answers"),
    )  # fmt: skip
    write_folder(folder, files)
    return folder / "measured-curves.html"
