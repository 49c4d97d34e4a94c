"""Measured friction and published directions beside every model: printed and written by
`reproduce --data`, and the documentation's page of published friction."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from squeezefilm.core import quantities as si
from squeezefilm.core.kit import style
from squeezefilm.core.kit.folder import checkout, json_text, write_folder
from squeezefilm.core.kit.page_style import page, picture_files, picture_sections, stamped
from squeezefilm.core.results import stamp, write_whole
from squeezefilm.design.analysis.published_claims import MEANINGS, missed_by
from squeezefilm.design.analysis.report.model_rows import cited, missed_directions
from squeezefilm.measure.recordings.kinds import Told
from squeezefilm.measure.report.fit_figures import comparison_figure, conditions
from squeezefilm.measure.report.page import MODELS_HEAD, inside_words, model_rows
from squeezefilm.validation.command import ClaimResult
from squeezefilm.validation.frozen import MODELS, WORDS
from squeezefilm.validation.published_friction import FolderComparison
from squeezefilm.validation.report import pooled
from squeezefilm.validation.report.parts import (
    Part,
    Table,
    markdown_lines,
    page_section,
    show_parts,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_HEAD = f"""# Published friction

Written by `squeezefilm reproduce --data published --write-docs`; do not edit. Published
measurements of fingers on ultrasonic plates that could be read, beside every model of friction and
beside two shapes without physics and the published levitation model of 2016.

{pooled.FITTED}

**What was never measured in them**: metal and coated surfaces, forces above 0.8 N, frequencies
below 29 kHz, moisture, and speed as the only change. The numbers were read off figures, with an
error of about 1 % of an axis.
"""


class _Compared(NamedTuple):
    """A recording beside the models: who measured it, what is said of it (first on what and how it
    was measured), and what draws its figure, where it has one."""

    told: Told
    part: Part
    figure: Callable[[], Figure] | None = None


def _recordings(compared: FolderComparison) -> Iterator[_Compared]:
    """Curves first, then numbers of many people, then thresholds."""
    for curve in compared.curves:
        told = curve.curve.told
        words = [conditions(curve), inside_words(curve), curve.adequacy.sentence]
        part = Part(told.name, words, [(MODELS_HEAD, model_rows(curve))])
        yield _Compared(told, part, partial(comparison_figure, curve))
    for people in compared.populations:
        name, rows = f"{people.told.name}: {people.quantity}", pooled.people_rows(people)
        part = Part(name, [pooled.people_words(people)], [(pooled.PEOPLE_HEAD, rows)])
        yield _Compared(people.told, part)
    for detected in compared.detections:
        told, rows = detected.told, pooled.detection_rows(detected)
        part = Part(told.name, pooled.detection_words(detected), [(pooled.DETECTION_HEAD, rows)])
        yield _Compared(told, part, partial(pooled.detection_figure, detected))


def _all_curves(compared: FolderComparison) -> Part:
    """The models over all curves, and the points in the default's intervals."""
    return Part(
        "All curves",
        [pooled.covered_words(compared), pooled.SCORES],
        [
            (pooled.TOTALS_HEAD, pooled.total_rows(compared)),
            (pooled.COVERAGE_HEAD, pooled.coverage_rows(compared)),
        ],
    )


def show_comparisons(compared: FolderComparison) -> None:
    """Print each curve, the numbers of many people and the totals beside the models."""
    parts = [recording.part for recording in _recordings(compared)]
    if len(compared.curves) > 1:
        parts.append(_all_curves(compared))
    show_parts([*parts, Part("What is compared", [pooled.FITTED])])


def write_comparisons(compared: FolderComparison, folder: Path) -> Path:
    """Write curves.json, a picture of each curve and measured-curves.html into `folder`.

    Returns the path of the page. Raises `InputError` for a folder that cannot be written to.
    """
    summary = compared.summary()
    summary_stamp = stamp(summary)
    files: dict[str, str | bytes] = {"curves.json": json_text(summary | {"stamp": summary_stamp})}
    body = page_section(Part("What is compared", [pooled.FITTED]))
    if len(compared.curves) > 1:
        body += page_section(_all_curves(compared))
    for number, (told, part, draw) in enumerate(_recordings(compared), 1):
        facts = [f"{what}: {how}" for what, how in told.facts]
        body += page_section(part._replace(sentences=[*part.sentences, *facts]))
        if draw is not None:
            pictures = {f"curve-{number}": (part.heading, draw())}
            files |= picture_files(pictures)
            body += picture_sections(pictures)
    files["measured-curves.html"] = page(
        "Measured friction",
        "Measured friction",
        "beside every model, beside fitted shapes, and beside our interval",
        body,
        stamped(summary_stamp, "SHA-256 of curves and answers"),
    )
    write_folder(folder, files)
    return folder / "measured-curves.html"


def write_friction_docs(compared: FolderComparison, root: Path | None = None) -> Path:
    """Write docs/reference/published-friction.md of a checkout (the package's own, or the one at
    `root`) with its picture.

    Raises `InputError` where the package is installed without one.
    """
    docs = checkout(root) / "docs"
    for detected in compared.detections:
        write_whole(
            docs / "pictures" / "published-thresholds.png",
            style.png(pooled.detection_figure(detected)),
        )
    path = docs / "reference" / "published-friction.md"
    write_whole(path, friction_markdown(compared))
    return path


def friction_markdown(compared: FolderComparison) -> str:
    """The text of the page: all curves, each curve, the numbers of many people, and thresholds."""
    parts = [_all_curves(compared)]
    for told, part, _ in _recordings(compared):
        parts.append(part._replace(sentences=[told.source, *part.sentences]))
    lines = [_HEAD, *markdown_lines(parts)]
    if compared.detections:
        lines += ["![Measured and computed thresholds](../pictures/published-thresholds.png)", ""]
    return "\n".join(lines)


DIRECTIONS = ("where", "direction", "model", "bound", "found", "verdict")
_SIGNS = {"equals": "", "above": "> ", "at_least": "≥ ", "at_most": "≤ ", "within": "within "}


def plain_claims(results: Iterable[ClaimResult]) -> tuple[ClaimResult, ...]:
    """The claims that are no directions asked of a model."""
    return tuple(item for item in results if not item.claim.model)


def directions(results: Iterable[ClaimResult]) -> tuple[tuple[ClaimResult, ...], ...]:
    """The directions, each with what became of it in every model."""
    found: dict[str, list[ClaimResult]] = {}
    for item in results:
        if item.claim.model:
            found.setdefault(item.claim.id, []).append(item)
    return tuple(tuple(items) for items in found.values())


def show_values(values: Sequence[float] | None, unit: str) -> str:
    """The values of a claim as text with a unit, joined by slashes; a dash for none."""
    if not values:
        return "–"
    if unit == "m2":
        return " / ".join(f"{value * 1e4:.4g} cm²" for value in values)
    return " / ".join(si.format_quantity(value, si.Unit(unit), 4) for value in values)


def show_printed(item: ClaimResult) -> str:
    """The printed value with the sign of a bound; words where nothing was compared."""
    if not item.claim.printed:
        return "not compared"
    return _SIGNS[item.claim.relation] + show_values(item.claim.printed, item.claim.unit)


def direction_table(results: Iterable[ClaimResult]) -> Table:
    """Every direction in every model: where and what, said once, then bound, found, verdict."""
    rows = [
        (
            cited(item.claim.where) if item is items[0] else "",
            item.claim.statement if item is items[0] else "",
            item.claim.model,
            show_printed(item),
            show_values(item.value, item.claim.unit),
            item.verdict,
        )
        for items in directions(results)
        for item in items
    ]
    return DIRECTIONS, rows


def model_sentences() -> list[str]:
    """The models that directions are asked of, each in a sentence."""
    return [f"{name}: {WORDS[kind]}." for name, kind in MODELS.items()]


def missed_sentences() -> list[str]:
    """The measured directions that each model misses, by the verdicts on record."""
    return [
        f"{name}: {sentence}"
        for name in MODELS
        if missed_by(name)
        for sentence in missed_directions(name, why=True)
    ]


def verdict_table(results: Iterable[ClaimResult]) -> Table:
    """Each verdict that was given: how often, and what it says."""
    counts = Counter(item.verdict for item in results)
    rows = [(name, str(counts[name]), said) for name, said in MEANINGS.items() if counts[name]]
    return ("verdict", "claims", "what it says"), rows
