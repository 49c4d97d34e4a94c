"""Measured friction and published directions beside every model: printed and written by
`reproduce --data`, and the documentation's page of published friction."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from squeezefilm.core import quantities as si
from squeezefilm.core.kit import style
from squeezefilm.core.kit.folder import checkout, json_text, markdown_table, write_folder
from squeezefilm.core.kit.numbers import printable
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
from squeezefilm.core.results import stamp, write_whole
from squeezefilm.design.analysis.published_claims import MEANINGS, missed_by
from squeezefilm.design.analysis.report.rows import cited, missed_directions
from squeezefilm.measure.recordings.kinds import Told
from squeezefilm.measure.report.fit_figures import comparison_figure, conditions
from squeezefilm.measure.report.page import MODELS_HEAD, inside_words, model_rows
from squeezefilm.validation.command import ClaimResult
from squeezefilm.validation.frozen import MODELS, WORDS
from squeezefilm.validation.published_friction import FolderComparison
from squeezefilm.validation.report import pooled
from squeezefilm.validation.report.prototype import Table

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
    """A recording beside the models: who measured it, its name, what is said (first on what and how
    it was measured), its table, and what draws its figure."""

    told: Told
    name: str
    words: Sequence[str]
    caption: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    figure: Callable[[], Figure]


_Table = tuple[str, Sequence[str], Sequence[Sequence[str]]]


def _recordings(compared: FolderComparison) -> Iterator[_Compared]:
    """Curves first, then numbers of many people, then thresholds."""
    shown: _Table
    for curve in compared.curves:
        told = curve.curve.told
        words = [conditions(curve), inside_words(curve), curve.adequacy.sentence]
        shown = ("How far each model is off", MODELS_HEAD, model_rows(curve))
        yield _Compared(told, told.name, words, *shown, partial(comparison_figure, curve))
    for people in compared.populations:
        name = f"{people.told.name}: {people.quantity}"
        shown = ("What each model gives", pooled.PEOPLE_HEAD, pooled.people_rows(people))
        yield _Compared(
            people.told,
            name,
            [pooled.people_words(people)],
            *shown,
            partial(pooled.people_figure, people),
        )
    for detected in compared.detections:
        told = detected.told
        shown = ("What each rival gives", pooled.DETECTION_HEAD, pooled.detection_rows(detected))
        figure = partial(pooled.detection_figure, detected)
        yield _Compared(told, told.name, pooled.detection_words(detected), *shown, figure)


def _totals(compared: FolderComparison) -> tuple[_Table, _Table]:
    """Caption, head and rows of the models over all curves, and of the points in intervals."""
    held = "Points in the default's intervals"
    return (
        ("All curves", pooled.TOTALS_HEAD, pooled.total_rows(compared)),
        (held, pooled.COVERAGE_HEAD, pooled.coverage_rows(compared)),
    )


def show_comparisons(compared: FolderComparison) -> None:
    """Print each curve, the numbers of many people and the totals beside the models."""
    console = plain_console()
    for recording in _recordings(compared):
        heading(console, recording.name)
        table(console, recording.head, recording.rows, fixed=(0,))
        printed_bullets(console, [("", words, "") for words in recording.words])
    if len(compared.curves) > 1:
        heading(console, "All curves")
        for _, head, rows in _totals(compared):
            table(console, head, rows, fixed=(0,))
        printed_bullets(
            console, [("", pooled.covered_words(compared), ""), ("", pooled.SCORES, "")]
        )
    console.print(f"\n{pooled.FITTED}")


def write_comparisons(compared: FolderComparison, folder: Path) -> Path:
    """Write curves.json, a picture of each curve and measured-curves.html into `folder`.

    Returns the path of the page. Raises `InputError` for a folder that cannot be written to.
    """
    summary = compared.summary()
    summary_stamp = stamp(summary)
    files: dict[str, str | bytes] = {"curves.json": json_text(summary | {"stamp": summary_stamp})}
    body = section("What is compared", f"<p>{pooled.FITTED}</p>")
    if len(compared.curves) > 1:
        rows, held = (text_table(*shown) for shown in _totals(compared))
        body += section(
            "All curves", rows + bullets([pooled.covered_words(compared), pooled.SCORES]) + held
        )
    for number, recording in enumerate(_recordings(compared), 1):
        figure = recording.figure()
        files[f"curve-{number}.png"] = style.png(figure)
        said = [*recording.words, *(f"{what}: {how}" for what, how in recording.told.facts)]
        rows = text_table(recording.caption, recording.head, recording.rows)
        body += section(escape(printable(recording.name)), bullets(said) + rows)
        body += picture_sections({f"curve-{number}": (recording.name, figure)})
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
    lines = [_HEAD, "## All curves", ""]
    totals, held = (markdown_table(shown[1:]) for shown in _totals(compared))
    lines += [*totals, "", f"{pooled.covered_words(compared)}. {pooled.SCORES}", "", *held, ""]
    for recording in _recordings(compared):
        how, *rest = recording.words
        lines += [f"## {recording.name.capitalize()}", "", f"{recording.told.source}. {how}.", ""]
        lines += markdown_table((recording.head, recording.rows))
        lines += ["", f"{'; '.join(rest)}.", ""] if rest else [""]
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
            show_values(item.found.value, item.claim.unit),
            item.verdict,
        )
        for items in directions(results)
        for item in items
    ]
    return DIRECTIONS, rows


def model_sentences() -> list[str]:
    """The models that directions are asked of, each in a sentence."""
    return [f"{name}: {WORDS[kind]}." for name, kind in MODELS.items()]


def missed_lists() -> list[tuple[str, list[str]]]:
    """Each model with the measured directions that it misses, by the verdicts on record."""
    return [(name, missed_directions(name, why=True)) for name in MODELS if missed_by(name)]


def verdict_table(results: Iterable[ClaimResult]) -> Table:
    """Each verdict that was given: how often, and what it says."""
    counts = Counter(item.verdict for item in results)
    rows = [(name, str(counts[name]), said) for name, said in MEANINGS.items() if counts[name]]
    return ("verdict", "claims", "what it says"), rows
