"""A calibrated display with its numbers, pictures and a page, and what `measure calibrate` and
`measure predict` print."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.calibration_record import ComparedAnswer
from squeezefilm.core.kit import style
from squeezefilm.core.kit.folder import json_text, write_folder
from squeezefilm.core.kit.numbers import changed, shown, span
from squeezefilm.core.kit.page_style import (
    FigureOf,
    as_html,
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
from squeezefilm.core.kit.terminal import bullets as printed_bullets
from squeezefilm.core.kit.terminal import heading, table
from squeezefilm.core.results import stamp
from squeezefilm.measure.calibration.blind import BlindPrediction
from squeezefilm.measure.calibration.calibration import Calibration
from squeezefilm.measure.calibration.folder import FolderCalibration
from squeezefilm.measure.calibration.identified import IDENTIFIED, NOT_TOLD
from squeezefilm.measure.calibration.written_display import calibrated_text
from squeezefilm.physics.uncertainty.intervals import LEVEL

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DISPLAY_FILE, PAGE = "calibrated.toml", "calibration.html"
VALUES_HEAD = ("value", "before", "after", "90 % interval", "spread left")


@style.drawn
def friction_figure(calibrated: FolderCalibration) -> Figure:
    """Friction's interval before and after."""
    before, after = calibrated.calibration.before, calibrated.calibration.after
    pairs = (("as described", before), ("with what was measured", after))
    known = [(name, interval) for name, interval in pairs if interval is not None]
    if after is None:
        title = "Friction has no interval: too many draws have none"
    elif before is None:
        title = f"µ′/µ is {span(*after.interval)}"
    else:
        title = (
            f"µ′/µ is {span(*after.interval)} where it was {span(*before.interval)}: "
            f"{si.percent(after.width / before.width)} of that interval is left"
        )
    figure, axes = style.new_axes(
        title, f"{si.percent(LEVEL)} intervals at the display's own voltage, force and speed", 2.5
    )
    for row, (_, interval) in enumerate(known):
        color = style.BLUE if interval is after else style.MUTED
        axes.plot(interval.interval, [row, row], color=color, lw=4.5, solid_capstyle="butt")
        axes.plot([interval.median], [row], **style.ESTIMATE)
    names = [f"{name},\n{shown(interval.amplitude, si.Unit('m'), 2)}" for name, interval in known]
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.grid(visible=False, axis="y")
    axes.tick_params(axis="y", length=0)
    axes.set(xlim=(0, 1.04), xlabel="relative friction µ′/µ")
    return figure


FIGURES = (FigureOf("friction", "Friction before and after", friction_figure),)
"""The figures of a calibration, in the order of its page."""


def write_calibration(calibrated: FolderCalibration, folder: Path) -> Path:
    """Write calibrated.toml, calibration.json, its pictures and calibration.html into `folder`.

    Returns the path of the page. Raises `InputError` for a folder that cannot be written to.
    """
    calibration = calibrated.calibration
    summary = calibrated.summary() | {"stamp": stamp(calibration.described, calibration.seed)}
    figures = drawn_figures(FIGURES, calibrated)
    judged = [
        f"{'Friction' if misfit.worst.startswith('relative friction') else 'The plate'}: "
        f"{misfit.sentence}"
        for misfit in calibration.misfits
    ]
    body = section(
        "What was measured is explained" if calibration.fits else "The model does NOT explain it",
        bullets([*calibration.doubts, *judged]),
    )
    body += picture_sections(figures)
    body += section("Every measured number", _compared(calibration.compared))
    body += section(
        "Each value", text_table("Before and after", VALUES_HEAD, value_rows(calibrated))
    )
    body += section("What is identified", bullets(calibration.identification.sentences))
    options = [
        (option.name, option.accuracy, si.percent(option.left))
        for option in calibration.next_measurements
    ]
    head = ("measurement", "to", "left of the interval of µ′/µ")
    body += section("What to measure next", text_table("The most telling first", head, options))
    body += section("How it was computed", _computed(calibration))
    body += section("What it was learned from", _recordings(calibrated))
    body += section(
        "Left out", bullets(calibrated.left_out, "Nothing: every recording of the folder was used.")
    )
    body += section("Files", f"<p>{links((DISPLAY_FILE, 'calibration.json'))}</p>")
    name = as_html(calibration.display.name)
    files: dict[str, str | bytes] = {
        DISPLAY_FILE: calibrated_text(calibration, calibrated.recordings),
        "calibration.json": json_text(summary),
        **picture_files(figures),
        PAGE: page(
            f"{name}: a calibration",
            f"{name}, calibrated",
            as_html(
                calibrated.display.calibration.sentence if calibrated.display.calibration else ""
            ),
            body,
            stamped(summary["stamp"], "SHA-256 of the description that was calibrated"),
        ),
    }
    return write_folder(folder, files)


def value_rows(calibrated: FolderCalibration) -> list[tuple[str, ...]]:
    """Each value: its interval before, its median and interval after, how much spread is left;
    what the data told most of first."""
    return [
        (
            value.path,
            " to ".join(shown(end, value.unit) for end in value.prior),
            shown(value.median, value.unit),
            " to ".join(shown(end, value.unit) for end in value.interval),
            si.percent(value.left),
        )
        for value in sorted(calibrated.calibration.values, key=lambda value: value.left)
    ]


def _compared(rows: Sequence[ComparedAnswer]) -> str:
    """The measured numbers beside the model before and after, as differences from what was
    measured."""
    head = ("measured", "value", "standard error", "model before", "model after", "apart")
    return text_table(
        f"The model alone less what was measured: median, {si.percent(LEVEL)} interval",
        head,
        [
            (
                row_name(answer),
                answer.measured,
                f"± {100 * answer.error:.2g} %",
                _difference(answer.before),
                _difference(answer.after),
                _apart(deviation(answer)),
            )
            for answer in rows
        ],
    )


def deviation(answer: ComparedAnswer) -> float:
    """Number of standard errors (measurement's and model's together) by which the measured value
    lies above the calibrated model's median; NaN where the model has none."""
    if not answer.after:
        return float("nan")
    from scipy.special import ndtri

    spread = (answer.after[2] - answer.after[0]) / (2 * float(ndtri((1 + LEVEL) / 2)))
    return (1 - answer.after[1]) / max(float(np.hypot(answer.error, spread)), 1e-12)


def row_name(answer: ComparedAnswer) -> str:
    """An observation by its name, and its recording where it has one."""
    return style.plain(
        f"{answer.said} ({answer.recording})" if answer.recording else answer.said, 90
    )


def _difference(ends: tuple[float, ...]) -> str:
    if not ends:
        return "–"
    low, middle, high = (changed(end - 1, 2) for end in ends)
    return f"{middle} ({low} to {high})"


def _apart(off: float) -> str:
    return "–" if math.isnan(off) else f"{abs(off):.1f} standard errors"


def _computed(calibration: Calibration) -> str:
    errors = [f"{name} {100 * error:.2g} %" for name, error in calibration.emulator_errors.items()]
    said = [
        f"{calibration.solves} plates were solved; a fast stand-in between them was off, at plates "
        f"it was not shown, by {', '.join(errors)} (root mean square)."
        if errors
        else "No plate was solved: nothing was measured of it.",
        f"Identified is a value of whose spread at most {si.percent(IDENTIFIED)} is left, not told "
        f"one of which more than {si.percent(NOT_TOLD)} is.",
        f"Seed {calibration.seed}.",
    ]
    for law, shares in calibration.laws.items():
        weights = ", ".join(f"{name} {si.percent(share)}" for name, share in shares.items())
        said.append(f"{law.replace('_', ' ')}, believed after the data: {weights}.")
    return bullets(said)


def _recordings(calibrated: FolderCalibration) -> str:
    head = ("file", "kind", "who", "when", "instrument", "from", "SHA-256")
    rows = [
        (
            recording.file,
            recording.kind,
            *(
                text or "not told"
                for text in (recording.who, recording.when, recording.instrument, recording.origin)
            ),
            recording.sha256,
        )
        for recording in calibrated.recordings
    ]
    return text_table("Recordings that were used", head, rows)


def show_calibration(calibrated: FolderCalibration) -> None:
    """Print what a calibration found: its sentences, each value before and after, what is left
    out."""
    calibration = calibrated.calibration
    heading(f"{calibration.display.name}, calibrated")
    table(VALUES_HEAD, value_rows(calibrated), fixed=(0,))
    look = "green" if calibration.fits else "bold red"
    printed_bullets([("", text, look) for text in calibration.sentences[:1]])
    printed_bullets([("", text, "") for text in calibration.sentences[1:]])
    printed_bullets([("left out", text, "yellow") for text in calibrated.left_out])


def prediction_lines(prediction: BlindPrediction) -> Iterator[str]:
    """Lines that tell what was predicted, in SI units, and the hash to tell somebody before
    measuring."""
    yield f"Of {prediction.display}, by {prediction.how} (SI units):"
    for predicted in prediction.predictions:
        where = "".join(f", {name} {value:.4g}" for name, value in predicted.conditions.items())
        low, high = predicted.interval
        yield (
            f"  {predicted.answer.replace('_', ' ')}{where}: {predicted.median:.5g} "
            f"({low:.5g} to {high:.5g}, {100 * predicted.level:.0f} %)"
        )
    yield f"SHA-256 {prediction.sha256}"
