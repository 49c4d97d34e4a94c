"""Recordings as they were read and fitted: numbers, pictures and a page, and what `measure check`
and `measure fit` print."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from squeezefilm.core import quantities as si
from squeezefilm.core.kit.folder import json_text, write_folder
from squeezefilm.core.kit.numbers import decimals, shown
from squeezefilm.core.kit.page_style import (
    Pictures,
    as_html,
    bullets,
    page,
    picture_files,
    picture_sections,
    section,
    stamped,
    text_table,
)
from squeezefilm.core.kit.terminal import bullets as printed_bullets
from squeezefilm.core.kit.terminal import heading, table
from squeezefilm.core.results import stamp, to_json
from squeezefilm.measure.fits.estimate import LEVEL, Adequacy, Estimate, FitResult
from squeezefilm.measure.fits.friction.friction_curve import CurveComparison
from squeezefilm.measure.fits.friction.friction_scores import NO_PHYSICS
from squeezefilm.measure.recordings.read import FolderCheck, RecordingCheck
from squeezefilm.measure.report.figures import recording_figure
from squeezefilm.measure.report.fit_figures import fit_figure
from squeezefilm.physics.chain.pad_law import DEFAULT_MODEL

_READ = "SHA-256 of what was read"


def show_check(check: RecordingCheck) -> None:
    """Print how a recording was read, and what is doubtful of it."""
    heading(f"{check.recording.told.name} ({check.file.name})")
    table(("", ""), check.facts, fixed=(0,))
    doubts = [("doubtful", text, "yellow") for text in check.doubts]
    printed_bullets(doubts or [("", "Nothing doubtful was found.", "")])


def show_folder(checked: FolderCheck) -> None:
    """Print the recordings of a folder, and what could not be read."""
    for check in checked.checks:
        show_check(check)
    if checked.refused:
        heading(f"{len(checked.refused)} could not be read")
        printed_bullets([("refused", refusal.why, "bold red") for refusal in checked.refused])


def show_fit(check: RecordingCheck, fit: FitResult, response: FitResult | None = None) -> None:
    """Print the numbers of a fit with their intervals, and whether its model is adequate; of raw
    signals also those of the `response` that they give."""
    title = f"{check.recording.told.name} ({check.file.name}): {check.kind}"
    _show_one(title, fit)
    if response is not None:
        _show_one("The frequency response that these signals give", response)
    printed_bullets([("doubtful", text, "yellow") for text in check.doubts])


def _show_one(title: str, fit: FitResult) -> None:
    heading(title)
    if isinstance(fit, CurveComparison):
        table(MODELS_HEAD, model_rows(fit), fixed=(0,))
        printed_bullets([("", inside_words(fit), "")])
    elif rows := estimate_rows(fit):
        table(HEAD, rows, fixed=(0, 1))
    word, look = ("adequate", "green") if fit.adequacy.adequate else ("INADEQUATE", "bold red")
    printed_bullets([(word, fit.adequacy.sentence, look)])


MODELS_HEAD = ("model", "off by", "in spreads", "answered", "fitted")


def model_rows(compared: CurveComparison) -> list[tuple[str, ...]]:
    """The models and shapes, the nearest first: how far each is off."""
    return [
        (
            model_words(score.model),
            decimals(score.difference, 3),
            decimals(score.in_spreads, 1),
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


def inside_words(compared: CurveComparison) -> str:
    """Number of points that lie in the interval of the default, in words."""
    within, asked = compared.points_inside
    level = si.percent(compared.band.level)
    return (
        f"{within} of {asked} points that vibrate lie in the {level} interval of the default, with "
        "everything but the amplitude uncertain"
    )


HEAD = ("quantity", "value", si.percent(LEVEL) + " interval", "standard error")
_LEAST_DIGITS, _MOST_DIGITS = 3, 9


def estimate_rows(fit: FitResult) -> list[tuple[str, ...]]:
    """The estimates of a fit: name, value, interval, standard error; with so many digits that two
    of the standard error are seen."""
    rows: list[tuple[str, ...]] = []
    for name, estimate in estimates(fit):
        digits = _digits(estimate.value, estimate.standard_error)
        unit = si.Unit(estimate.unit or "1")
        low, high = (shown(value, unit, digits) for value in estimate.interval)
        error = shown(estimate.standard_error, unit, 2)
        rows.append((name, shown(estimate.value, unit, digits), f"{low} to {high}", error))
    return rows


def _digits(value: float, error: float) -> int:
    """Number of digits of a value that show two digits of its standard error."""
    if not (math.isfinite(value) and math.isfinite(error)) or value == 0 or error <= 0:
        return _LEAST_DIGITS
    wanted = math.floor(math.log10(abs(value))) - math.floor(math.log10(error)) + 2
    return min(max(wanted, _LEAST_DIGITS), _MOST_DIGITS)


def estimates(node: Any, path: str = "") -> Iterator[tuple[str, Estimate]]:
    """Every estimate below a dataclass by its name in words; members of lists are counted from
    1."""
    if isinstance(node, Estimate):
        yield path, node
    elif isinstance(node, Adequacy):
        return
    elif dataclasses.is_dataclass(node):
        for field in dataclasses.fields(node):
            if not field.name.startswith("_"):
                below = f"{path} {field.name}".strip().replace("_", " ")
                yield from estimates(getattr(node, field.name), below)
    elif isinstance(node, Mapping):
        for key, member in node.items():
            yield from estimates(member, f"{path} {key}")
    elif isinstance(node, tuple):
        for number, member in enumerate(node, 1):
            yield from estimates(member, f"{path} {number}" if len(node) > 1 else path)


def write_checks(checked: FolderCheck, folder: Path) -> Path:
    """Write check.json, a picture of each recording and check.html into `folder`.

    Returns the path of the page. Raises `InputError` for a folder that cannot be written to.
    """
    summary = checked.summary()
    stamped_with = stamp(summary)
    files: dict[str, str | bytes] = {"check.json": json_text(summary | {"stamp": stamped_with})}
    body = ""
    if checked.refused:
        body += section("Could not be read", bullets(refusal.why for refusal in checked.refused))
    for name, check in zip(_names(checked.checks), checked.checks, strict=True):
        figures = {name: (check.recording.told.name, recording_figure(check))}
        files |= picture_files(figures)
        body += picture_sections(figures)
        body += _as_read(check)
    files["check.html"] = page(
        "Recordings checked",
        "What was read",
        "before anything is fitted; corrected only where a description asks for it",
        body,
        stamped(stamped_with, _READ),
    )
    return write_folder(folder, files)


def write_fit(
    check: RecordingCheck, fit: FitResult, folder: Path, response: FitResult | None = None
) -> Path:
    """Write fit.json, the picture of data, model and residual and fit.html into `folder`; of raw
    signals also the fit of the `response` that they give.

    Returns the path of the page. Raises `InputError` for a folder that cannot be written to.
    """
    name = check.recording.told.name
    figures: Pictures = {}
    fitted = fit_figure(check, fit)
    if fitted is not None:
        figures["fit"] = ("Recorded, fitted and what is left", fitted)
    figures["recording"] = ("As recorded", recording_figure(check))
    summary = fit_summary(check, fit, response)
    files = {**picture_files(figures), "fit.json": json_text(summary)}
    word = "adequate" if fit.adequacy.adequate else "not adequate"
    body = section(f"The fit is {word}", f"<p>{as_html(fit.adequacy.sentence)}</p>")
    for title, part in (("Estimates", fit), ("Of the response that the signals give", response)):
        rows = [] if part is None else estimate_rows(part)
        if rows:
            body += section(title, text_table("What was fitted", HEAD, rows))
    body += picture_sections(figures) + _as_read(check)
    title = as_html(name)
    files["fit.html"] = page(
        f"{title}: a fit", title, escape(check.kind), body, stamped(summary["stamp"], _READ)
    )
    return write_folder(folder, files)


def fit_summary(
    check: RecordingCheck, fit: FitResult, response: FitResult | None = None
) -> dict[str, Any]:
    """Numbers as plain JSON values: estimates in the unit that each names, adequacy,
    observations for a calibration, and how the recording was read."""
    summary: dict[str, Any] = {"recording": check.summary(), **_numbers(fit)}
    if response is not None:
        summary["response"] = _numbers(response)
    return summary | {"stamp": stamp(summary)}


def _numbers(fit: FitResult) -> dict[str, Any]:
    numbers: dict[str, Any] = {
        "estimates": {
            name.replace(" ", "_"): to_json(estimate) for name, estimate in estimates(fit)
        },
        "adequacy": to_json(fit.adequacy),
        "observations": to_json(fit.observations),
    }
    if isinstance(fit, CurveComparison):
        numbers["comparison"] = fit.summary()
    return numbers


def _as_read(check: RecordingCheck) -> str:
    facts = text_table("How the recording was taken", ("what", "how"), check.facts)
    doubts = bullets(check.doubts, "Nothing doubtful was found.")
    return section("How it was read", facts) + section("What is doubtful", doubts)


def _names(checks: Sequence[RecordingCheck]) -> list[str]:
    """A file's name for each recording, told apart where two are called alike."""
    names: list[str] = []
    for check in checks:
        stem = "".join(c if c.isalnum() or c in "-_" else "-" for c in check.file.stem) or "a"
        names.append(stem if stem not in names else f"{stem}-{len(names) + 1}")
    return names
