"""`write_study`: identification.json, figures and a page of an identification study."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from squeezefilm import quantities as si
from squeezefilm.report.kit.folder import json_text, require_folder, write_folder
from squeezefilm.report.kit.numbers import printable, shown
from squeezefilm.report.kit.page_style import (
    FigureOf,
    bullets,
    drawn_figures,
    links,
    page,
    picture_files,
    picture_sections,
    section,
    stamped,
    text_table,
)
from squeezefilm.report.study import figures as draw
from squeezefilm.report.study import time_figures as times

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squeezefilm.study.identification.analysis import IdentificationAnalysis
    from squeezefilm.study.identification.power import PowerCurve
    from squeezefilm.study.identification.proportions import Interval


FIGURES = (
    FigureOf("confusion", "Confusion matrix", draw.confusion),
    FigureOf("correct", "Right answers", draw.proportion_correct),
    FigureOf("information", "Information transfer", draw.information),
    FigureOf("sensitivity", "Sensitivity along the stimuli", draw.sensitivity),
    FigureOf("similarities", "Similarities and biases", draw.similarities, file="similarity"),
    FigureOf("times", "Response times", times.response_times, has=lambda one: one.response_times),
    FigureOf("exploration", "Exploration", times.exploration, has=lambda one: one.exploration),
)
"""The figures of an identification study."""


def write_study(
    analysis: IdentificationAnalysis,
    folder: Path,
    *,
    power: PowerCurve | None = None,
    progress: Callable[[str], None] | None = None,
) -> Path:
    """Write numbers, figures and the page of a study into `folder`; the path of index.html.

    All is made in memory before the first file is written.

    Raises:
        InputError: a folder that cannot be written to.
    """
    tell = progress or (lambda _: None)
    folder = require_folder(folder)
    tell("figures")
    figures = study_figures(analysis, power)
    files = picture_files(_named(figures))
    summary = analysis.summary()
    if power is not None:
        summary["power"] = power
    files["identification.json"] = json_text(summary)
    files["index.html"] = study_page(analysis, figures, summary["provenance"])
    tell("writing the report")
    write_folder(folder, files)
    return folder / "index.html"


def study_figures(
    analysis: IdentificationAnalysis, power: PowerCurve | None = None
) -> dict[str, tuple[str, Figure]]:
    """The figures by key: heading and drawing. What was not measured has none."""
    found = drawn_figures(FIGURES, analysis)
    if power is not None:
        found["power"] = ("How many people a study needs", times.power(power))
    return found


def study_page(
    analysis: IdentificationAnalysis,
    figures: dict[str, tuple[str, Figure]],
    provenance: dict[str, Any],
) -> str:
    """The page as text; its figures lie beside it as study-KEY.png."""
    title = escape(printable(analysis.name))
    head = ("Quantity", "Value", "Remark")
    numbers = text_table(f"{analysis.origin} answers", head, key_rows(analysis))
    sections = (
        section("Numbers", numbers)
        + picture_sections(_named(figures))
        + section("Confusions in numbers", _confusion(analysis))
        + section("Information transfer by every estimator", _information(analysis))
        + (section("Mixed models", _mixed(analysis)) if analysis.mixed is not None else "")
        + section("What could not be computed", bullets(analysis.notes, "Nothing."))
    )
    return page(
        f"{title}: identification study",
        title,
        f"<b>{escape(printable(analysis.origin))}</b> answers, analysed by squeezefilm",
        sections,
        f"{stamped(provenance, 'SHA-256 of the answers')} ·\n"
        f"seed of the resampling {escape(str(provenance['seed']))}.\n"
        f"All numbers: {links(['identification.json'])}.",
    )


def _named(figures: dict[str, tuple[str, Figure]]) -> dict[str, tuple[str, Figure]]:
    """The figures by the name of their file."""
    return {f"study-{key}": one for key, one in figures.items()}


def _between(interval: Interval | None, scale: float = 1.0, unit: str = "") -> str:
    if interval is None:
        return "–"
    low, high = scale * interval.low, scale * interval.high
    return f"{low:.3g} to {high:.3g}{unit} ({interval.method}, {100 * interval.level:g} %)"


def key_rows(analysis: IdentificationAnalysis) -> list[tuple[str, str, str]]:
    """The main numbers: what, value, remark; for the page and for a terminal."""
    best, fit = analysis.information.best, analysis.sensitivity
    posterior = analysis.posterior.proportion_correct
    rows = [
        ("Participants", f"{analysis.participants}", f"{analysis.matrix.trials} trials"),
        *(
            (
                "Proportion correct",
                f"{100 * analysis.proportion_correct:.3g} %",
                _between(interval, 100, " %"),
            )
            for interval in (*analysis.intervals, posterior)
            if interval is not None
        ),
        ("Guessing", f"{100 * analysis.matrix.chance:.3g} %", ""),
        ("p against guessing", f"{analysis.chance_p:.2g}", "exact binomial, one-sided"),
        (
            "p against unrelated answers",
            f"{analysis.permutation_p:.2g}",
            "permutation within participants, one-sided",
        ),
        (
            "Information transfer",
            f"{best.estimate:.3g} bit of {analysis.information.greatest:.3g}",
            f"{best.name}; {_between(best.interval)}",
        ),
    ]
    if fit is not None:
        rows.append(("Total sensitivity Δ′", f"{fit.total:.3g}", "equal-variance Thurstone model"))
        rows += [
            (
                f"d′ {one} – {other}",
                f"{d:.2f}",
                f"{low:.2f} to {high:.2f} ({fit.interval_method}, {100 * fit.level:g} %)",
            )
            for one, other, d, low, high in zip(
                analysis.matrix.stimuli[:-1],
                analysis.matrix.stimuli[1:],
                fit.d_prime,
                fit.low,
                fit.high,
                strict=True,
            )
        ]
    if analysis.ex_gaussian is not None:
        g = analysis.ex_gaussian
        texts = [shown(value, si.Unit("s"), 3) for value in (g.mean, g.spread, g.tail)]
        rows.append(("Response time μ, σ, τ", ", ".join(texts), "ex-Gaussian, all trials"))
    return rows


def _confusion(analysis: IdentificationAnalysis) -> str:
    matrix, posterior = analysis.matrix, analysis.posterior
    rows = [
        [answer, *(_cell(analysis, i, j) for j in range(len(matrix.stimuli)))]
        for i, answer in enumerate(matrix.answers)
    ]
    return text_table(
        f"Per cent of each column; in brackets trials, and the {100 * posterior.level:g} % "
        f"interval of the Dirichlet posterior (prior {posterior.prior:g}, trials taken as "
        "independent)",
        ("Answered \\ simulated", *matrix.stimuli),
        rows,
    )


def _cell(analysis: IdentificationAnalysis, i: int, j: int) -> str:
    count = int(analysis.matrix.counts[i, j])
    percent = analysis.matrix.percent[i, j]
    low, high = 100 * analysis.posterior.low[i, j], 100 * analysis.posterior.high[i, j]
    share = "–" if percent != percent else f"{percent:.0f} %"
    return f"{share} ({count}; {low:.0f} to {high:.0f})"


def _information(analysis: IdentificationAnalysis) -> str:
    rows = [
        (
            item.name + (" (to quote)" if item.key == analysis.information.recommended else ""),
            f"{item.estimate:.3f}" if item.estimate == item.estimate else "none",
            "–"
            if item.interval is None
            else f"{item.interval.low:.3f} to {item.interval.high:.3f}",
            item.fails,
        )
        for item in analysis.information.estimates
    ]
    return text_table(
        "The pooled matrix; intervals over participants",
        ("Estimator", "Transfer (bit)", "Interval (bit)", "Where it fails"),
        rows,
    )


def _mixed(analysis: IdentificationAnalysis) -> str:
    fit = analysis.mixed
    assert fit is not None
    rows = [
        (
            name,
            f"{100 * one:.0f} %",
            f"{odds:.2f} ± {error:.2f}",
            "none (always or never right)" if mean != mean else f"{100 * mean:.0f} %",
        )
        for name, one, odds, error, mean in zip(
            fit.names,
            fit.proportion_correct,
            fit.log_odds,
            fit.log_odds_error,
            fit.average_proportion_correct,
            strict=True,
        )
    ]
    spread = f"{fit.participant_spread:.2f}"
    bounds = f"{fit.participant_spread_low:.2f} to {fit.participant_spread_high:.2f}"
    return text_table(
        f"{fit.model}. Participants spread by {spread} in log-odds ({bounds})",
        ("Stimulus", "A typical person", "Log-odds", "Mean over people"),
        rows,
    )
