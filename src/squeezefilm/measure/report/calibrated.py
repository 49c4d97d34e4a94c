"""What `measure calibrate` and `measure predict` print."""

from __future__ import annotations

from collections.abc import Iterator

from squeezefilm.core.kit.terminal import bullets, heading, plain_console, table
from squeezefilm.measure.calibration.blind import BlindPrediction
from squeezefilm.measure.calibration.folder import FolderCalibration
from squeezefilm.measure.report.calibration_page import VALUES_HEAD, value_rows


def show_calibration(found: FolderCalibration) -> None:
    """Print what a calibration found: its sentences, each value before and after, what is left
    out."""
    console, calibration = plain_console(), found.calibration
    heading(console, f"{calibration.display.name}, calibrated")
    table(console, VALUES_HEAD, value_rows(found), fixed=(0,))
    look = "green" if calibration.fits else "bold red"
    bullets(console, [("", text, look) for text in calibration.sentences[:1]])
    bullets(console, [("", text, "") for text in calibration.sentences[1:]])
    bullets(console, [("left out", text, "yellow") for text in found.left_out])


def prediction_lines(found: BlindPrediction) -> Iterator[str]:
    """What was predicted, in SI units, and the hash to tell somebody before measuring."""
    yield f"Of {found.display}, by {found.how} (SI units):"
    for one in found.predictions:
        where = "".join(f", {name} {value:.4g}" for name, value in one.conditions.items())
        low, high = one.interval
        yield (
            f"  {one.answer.replace('_', ' ')}{where}: {one.median:.5g} "
            f"({low:.5g} to {high:.5g}, {100 * one.level:.0f} %)"
        )
    yield f"SHA-256 {found.sha256}"
