"""A calibrated display with its numbers, pictures and a page, and what `measure calibrate` and
`measure predict` print."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path

from squeezefilm.core import quantities as si
from squeezefilm.core.calibration_record import ComparedAnswer
from squeezefilm.core.kit.folder import json_text, write_folder
from squeezefilm.core.kit.numbers import changed, shown
from squeezefilm.core.kit.page_style import (
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
from squeezefilm.core.kit.terminal import heading, plain_console, table
from squeezefilm.core.results import stamp
from squeezefilm.measure.calibration.blind import BlindPrediction
from squeezefilm.measure.calibration.calibration import Calibration
from squeezefilm.measure.calibration.folder import FolderCalibration
from squeezefilm.measure.calibration.identified import IDENTIFIED, NOT_TOLD
from squeezefilm.measure.calibration.written_display import calibrated_text
from squeezefilm.measure.report.calibration_figures import (
    FIGURES,
    deviation,
    row_name,
    sorted_values,
)
from squeezefilm.physics.uncertainty.intervals import LEVEL

DISPLAY_FILE, PAGE = "calibrated.toml", "calibration.html"
VALUES_HEAD = ("value", "before", "after", "90 % interval", "spread left")


def write_calibration(found: FolderCalibration, folder: Path) -> Path:
    """Write calibrated.toml, calibration.json, its pictures and calibration.html into `folder`.

    Returns the path of the page. Raises `InputError` for a folder that cannot be written to.
    """
    calibration = found.calibration
    summary = found.summary() | {"stamp": stamp(calibration.described, calibration.seed)}
    figures = drawn_figures(FIGURES, found)
    pictures = {key: picture_sections({key: one}) for key, one in figures.items()}
    get = pictures.get
    body = section(
        "What was measured is explained" if calibration.fits else "The model does NOT explain it",
        bullets([*calibration.doubts, *_misfits(calibration)]),
    )
    body += get("friction", "") + get("compared", "")
    body += section("Every measured number", _compared(calibration.compared))
    body += section("How far off, by what was measured", _by_kind(calibration.compared))
    body += get("values", "")
    body += section("Each value", text_table("Before and after", VALUES_HEAD, value_rows(found)))
    body += section("What is identified", bullets(calibration.identification.sentences))
    body += get("next", "") + section("How it was computed", _computed(calibration))
    body += section("What it was learned from", _recordings(found))
    body += section(
        "Left out", bullets(found.left_out, "Nothing: every recording of the folder was used.")
    )
    body += section("Files", f"<p>{links((DISPLAY_FILE, 'calibration.json'))}</p>")
    name = as_html(calibration.display.name)
    files: dict[str, str | bytes] = {
        DISPLAY_FILE: calibrated_text(calibration, found.recordings),
        "calibration.json": json_text(summary),
        **picture_files(figures),
        PAGE: page(
            f"{name}: a calibration",
            f"{name}, calibrated",
            as_html(found.display.calibration.sentence if found.display.calibration else ""),
            body,
            stamped(summary["stamp"], "SHA-256 of the description that was calibrated"),
        ),
    }
    write_folder(folder, files)
    return folder / PAGE


def _misfits(calibration: Calibration) -> list[str]:
    """The judgements, each with what it is of."""
    of_friction = [one.worst.startswith("relative friction") for one in calibration.misfits]
    return [
        f"{'Friction' if friction else 'The plate'}: {one.sentence}"
        for one, friction in zip(calibration.misfits, of_friction, strict=True)
    ]


def value_rows(found: FolderCalibration) -> list[tuple[str, ...]]:
    """Each value: its interval before, its median and interval after, how much spread is left."""
    return [
        (
            one.path,
            " to ".join(shown(end, one.unit) for end in one.prior),
            shown(one.median, one.unit),
            " to ".join(shown(end, one.unit) for end in one.interval),
            si.percent(one.left),
        )
        for one in sorted_values(found)
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
                row_name(one),
                one.measured,
                f"± {100 * one.error:.2g} %",
                _difference(one.before),
                _difference(one.after),
                _apart(deviation(one)),
            )
            for one in rows
        ],
    )


def _difference(ends: tuple[float, ...]) -> str:
    if not ends:
        return "–"
    low, middle, high = (changed(one - 1, 2) for one in ends)
    return f"{middle} ({low} to {high})"


def _apart(off: float) -> str:
    return "–" if math.isnan(off) else f"{abs(off):.1f} standard errors"


def _by_kind(rows: Sequence[ComparedAnswer]) -> str:
    """For each kind of answer how many were measured and how far the calibrated model is off."""
    kinds: dict[str, list[ComparedAnswer]] = {}
    for one in rows:
        # A friction is said with its conditions, which make no kind.
        kind = one.said if one.relative_friction is None else "relative friction"
        kinds.setdefault(kind, []).append(one)
    table = []
    for kind, members in kinds.items():
        known = [abs(deviation(one)) for one in members if one.after]
        square = math.sqrt(sum(off**2 for off in known) / len(known)) if known else math.nan
        largest = max(known, default=math.nan)
        table.append((kind, f"{len(members)}", _apart(square), _apart(largest)))
    caption = "By the median of the calibrated model, in standard errors of both together"
    return text_table(caption, ("what", "numbers", "root mean square", "largest"), table)


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


def _recordings(found: FolderCalibration) -> str:
    head = ("file", "kind", "who", "when", "instrument", "from", "SHA-256")
    rows = [
        (
            one.file,
            one.kind,
            *(text or "not told" for text in (one.who, one.when, one.instrument, one.origin)),
            one.sha256,
        )
        for one in found.recordings
    ]
    return text_table("Recordings that were used", head, rows)


def show_calibration(found: FolderCalibration) -> None:
    """Print what a calibration found: its sentences, each value before and after, what is left
    out."""
    console, calibration = plain_console(), found.calibration
    heading(console, f"{calibration.display.name}, calibrated")
    table(console, VALUES_HEAD, value_rows(found), fixed=(0,))
    look = "green" if calibration.fits else "bold red"
    printed_bullets(console, [("", text, look) for text in calibration.sentences[:1]])
    printed_bullets(console, [("", text, "") for text in calibration.sentences[1:]])
    printed_bullets(console, [("left out", text, "yellow") for text in found.left_out])


def prediction_lines(found: BlindPrediction) -> Iterator[str]:
    """Lines that tell what was predicted, in SI units, and the hash to tell somebody before
    measuring."""
    yield f"Of {found.display}, by {found.how} (SI units):"
    for one in found.predictions:
        where = "".join(f", {name} {value:.4g}" for name, value in one.conditions.items())
        low, high = one.interval
        yield (
            f"  {one.answer.replace('_', ' ')}{where}: {one.median:.5g} "
            f"({low:.5g} to {high:.5g}, {100 * one.level:.0f} %)"
        )
    yield f"SHA-256 {found.sha256}"
