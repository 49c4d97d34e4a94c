"""The documentation's page of published friction: every data set beside every model."""

from __future__ import annotations

from pathlib import Path

from squeezefilm.core.kit import style
from squeezefilm.core.kit.docs import checkout, markdown_table
from squeezefilm.core.results import write_whole
from squeezefilm.measure.fits.friction.friction_folder import FolderComparison
from squeezefilm.measure.report.curves import (
    COVERAGE_HEAD,
    FITTED,
    MODELS_HEAD,
    PEOPLE_HEAD,
    SCORES,
    TOTALS_HEAD,
    all_curves_figure,
    conditions,
    coverage_figure,
    coverage_rows,
    covered_words,
    inside_words,
    model_rows,
    people_rows,
    people_words,
    total_rows,
)
from squeezefilm.measure.report.detection import (
    DETECTION_HEAD,
    detection_figure,
    detection_rows,
    detection_words,
)

_HEAD = f"""# Published friction

Written by `squeezefilm reproduce --data published --write-docs`; do not edit. Published
measurements of fingers on ultrasonic plates that could be read, beside every model of friction and
beside two shapes without physics and the published levitation model of 2016.

{FITTED}

**What was never measured in them**: metal and coated surfaces, forces above 0.8 N, frequencies
below 29 kHz, moisture, and speed as the only change. The numbers were read off figures, with an
error of about 1 % of an axis.

![Published friction beside the default model](../pictures/published-friction.png)
"""


def write_friction_docs(compared: FolderComparison, root: Path | None = None) -> Path:
    """Write docs/reference/published-friction.md of a checkout (the package's own, or the one at
    `root`) with its picture.

    Raises `InputError` where the package is installed without one.
    """
    docs = checkout(root) / "docs"
    write_whole(
        docs / "pictures" / "published-friction.png", style.png(all_curves_figure(compared))
    )
    write_whole(docs / "pictures" / "published-coverage.png", style.png(coverage_figure(compared)))
    for detected in compared.detections:
        write_whole(
            docs / "pictures" / "published-thresholds.png", style.png(detection_figure(detected))
        )
    path = docs / "reference" / "published-friction.md"
    write_whole(path, friction_markdown(compared))
    return path


def friction_markdown(compared: FolderComparison) -> str:
    """The text of the page: all curves, each curve, the numbers of many people, and thresholds."""
    lines = [_HEAD, "## All curves", ""]
    lines += markdown_table((TOTALS_HEAD, total_rows(compared)))
    lines += ["", f"{covered_words(compared)}. {SCORES}", ""]
    lines += markdown_table((COVERAGE_HEAD, coverage_rows(compared)))
    lines += ["", "![Predicted and observed coverage](../pictures/published-coverage.png)", ""]
    for one in compared.curves:
        told = one.curve.told
        lines += [f"## {told.name.capitalize()}", "", f"{told.source}. {conditions(one)}.", ""]
        lines += markdown_table((MODELS_HEAD, model_rows(one)))
        lines += ["", f"{inside_words(one)}; {one.adequacy.sentence}.", ""]
    for people in compared.populations:
        name = f"{people.told.name}: {people.quantity}"
        lines += [
            f"## {name.capitalize()}",
            "",
            f"{people.told.source}. {people_words(people)}.",
            "",
        ]
        lines += markdown_table((PEOPLE_HEAD, people_rows(people)))
        lines.append("")
    for detected in compared.detections:
        lines += [f"## {detected.told.name.capitalize()}", "", f"{detected.told.source}.", ""]
        lines += markdown_table((DETECTION_HEAD, detection_rows(detected)))
        lines += ["", *(f"{words[0].upper()}{words[1:]}.\n" for words in detection_words(detected))]
        lines += ["![Measured and computed thresholds](../pictures/published-thresholds.png)", ""]
    return "\n".join(lines)
