"""`write_checks` and `write_fit`: numbers, pictures and a page of what was read and fitted."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from squeezefilm.core.kit import style
from squeezefilm.core.kit.folder import json_text, write_folder
from squeezefilm.core.kit.numbers import printable
from squeezefilm.core.kit.page_style import (
    bullets,
    page,
    picture_sections,
    section,
    stamped,
    text_table,
)
from squeezefilm.core.results import stamp, to_json
from squeezefilm.measure.fits.by_kind import Fit
from squeezefilm.measure.fits.friction.friction_curve import CurveComparison
from squeezefilm.measure.recordings.read import FolderCheck, RecordingCheck
from squeezefilm.measure.report.figures import recording_figure
from squeezefilm.measure.report.fit_figures import fit_figure
from squeezefilm.measure.report.terminal import HEAD, estimate_rows, estimates

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def write_checks(found: FolderCheck, folder: Path) -> Path:
    """Write check.json, a picture of each recording and check.html into `folder`.

    Returns the path of the page. Raises `InputError` for a folder that cannot be written to.
    """
    summary = found.summary()
    stamped_with = stamp(summary)
    files: dict[str, str | bytes] = {"check.json": json_text(summary | {"stamp": stamped_with})}
    body = ""
    if found.refused:
        body += section("Could not be read", bullets(one.why for one in found.refused))
    for name, check in zip(_names(found.checks), found.checks, strict=True):
        figure = recording_figure(check)
        files[f"{name}.png"] = style.png(figure)
        body += picture_sections({name: (check.recording.told.name, figure)})
        body += section("How it was read", _facts(check)) + _doubts(check)
    files["check.html"] = page(
        "Recordings checked", "What was read", "before anything is fitted; corrected only where a "
        "description asks for it",
        body, _foot(stamped_with),
    )  # fmt: skip
    write_folder(folder, files)
    return folder / "check.html"


def write_fit(check: RecordingCheck, fit: Fit, folder: Path, response: Fit | None = None) -> Path:
    """Write fit.json, the picture of data, model and residual and fit.html into `folder`; of raw
    signals also the fit of the `response` that they give.

    Returns the path of the page. Raises `InputError` for a folder that cannot be written to.
    """
    name = check.recording.told.name
    figures: dict[str, tuple[str, Figure]] = {}
    fitted = fit_figure(check, fit)
    if fitted is not None:
        figures["fit"] = ("Recorded, fitted and what is left", fitted)
    figures["recording"] = ("As recorded", recording_figure(check))
    files: dict[str, str | bytes] = {
        f"{key}.png": style.png(figure) for key, (_, figure) in figures.items()
    }
    summary = fit_summary(check, fit, response)
    files["fit.json"] = json_text(summary)
    word = "adequate" if fit.adequacy.adequate else "not adequate"
    body = section(f"The fit is {word}", f"<p>{_text(fit.adequacy.sentence)}</p>")
    for heading, one in (("Estimates", fit), ("Of the response that the signals give", response)):
        rows = [] if one is None else estimate_rows(one)
        if rows:
            body += section(heading, text_table("What was fitted", HEAD, rows))
    body += picture_sections(figures) + section("How it was read", _facts(check)) + _doubts(check)
    title = _text(name)
    files["fit.html"] = page(
        f"{title}: a fit", title, escape(check.kind), body, _foot(summary["stamp"])
    )
    write_folder(folder, files)
    return folder / "fit.html"


def fit_summary(check: RecordingCheck, fit: Fit, response: Fit | None = None) -> dict[str, Any]:
    """What ``measure fit --json`` prints: estimates in the unit that each names, adequacy,
    observations for a calibration, and how the recording was read."""
    summary: dict[str, Any] = {"recording": check.summary(), **_numbers(fit)}
    if response is not None:
        summary["response"] = _numbers(response)
    return summary | {"stamp": stamp(summary)}


def _numbers(fit: Fit) -> dict[str, Any]:
    found: dict[str, Any] = {
        "estimates": {name.replace(" ", "_"): to_json(one) for name, one in estimates(fit)},
        "adequacy": to_json(fit.adequacy),
        "observations": to_json(fit.observations),
    }
    if isinstance(fit, CurveComparison):
        found["comparison"] = fit.summary()
    return found


def _facts(check: RecordingCheck) -> str:
    return text_table("How the recording was taken", ("what", "how"), check.facts)


def _doubts(check: RecordingCheck) -> str:
    return section("What is doubtful", bullets(check.doubts, "Nothing doubtful was found."))


def _text(words: str) -> str:
    return escape(printable(words))


def _foot(stamped_with: dict[str, Any]) -> str:
    return stamped(stamped_with, "SHA-256 of what was read")


def _names(checks: Sequence[RecordingCheck]) -> list[str]:
    """A file's name for each recording, told apart where two are called alike."""
    names: list[str] = []
    for check in checks:
        stem = "".join(c if c.isalnum() or c in "-_" else "-" for c in check.file.stem) or "a"
        names.append(stem if stem not in names else f"{stem}-{len(names) + 1}")
    return names
