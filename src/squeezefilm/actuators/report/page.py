"""The page of an actuator: what one decides from, its figures, and where its values are from."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from squeezefilm.actuators.analysis.drawn import DrawnAnswers
from squeezefilm.core import quantities as si
from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.kit import style
from squeezefilm.core.kit.folder import json_text, require_folder, write_folder
from squeezefilm.core.kit.numbers import Row, shown
from squeezefilm.core.kit.page_style import (
    as_html,
    bullets,
    page,
    picture_sections,
    section,
    stamped,
    text_table,
)
from squeezefilm.core.results import stamp

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Described(Protocol):
    """An actuator as its file describes it."""

    name: str
    title: str

    @property
    def provenance(self) -> Mapping[str, Provenance]:
        """Sources of the values, by their paths."""


class ActuatorAnalysis(Protocol):
    """Fields of every analysis of an actuator."""

    @property
    def described(self) -> Any:
        """The actuator, `Described`."""

    @property
    def warnings(self) -> tuple[str, ...]:
        """In sentences."""

    def summary(self) -> dict[str, Any]:
        """The numbers, with units in the keys."""


def assumed_words(provenance: Mapping[str, Provenance]) -> str:
    """A sentence with the number of an actuator's values that are assumed."""
    assumed = sum(one.evidence == "assumed" for one in provenance.values())
    return (
        f"{assumed} of {len(provenance)} values with a source are assumed, and the numbers hang on "
        "them; the page's last tables (--out DIR) list them and say what they do."
    )


def write_page(
    found: ActuatorAnalysis,
    folder: Path,
    *,
    key_numbers: Sequence[Row],
    figures: Mapping[str, tuple[str, Figure]],
    more: str = "",
    pictures: Mapping[str, bytes] | None = None,
) -> Path:
    """Write result.json, a PNG of each of the `figures` (by file name: heading and figure),
    other `pictures` by file name, and report.html into `folder`; the path of the page.

    `more` are sections of HTML after the figures. Raises `InputError` where the folder cannot be
    written to.
    """
    folder, described = require_folder(folder), found.described
    summary = found.summary()
    stamped_with = stamp(summary)
    files: dict[str, str | bytes] = {
        f"{name}.png": style.png(figure) for name, (_, figure) in figures.items()
    }
    files |= pictures or {}
    files["result.json"] = json_text(summary | {"stamp": stamped_with})
    warned = [*found.warnings, assumed_words(described.provenance)]
    head = ("quantity", "value", "remark")
    body = section("Warnings", bullets(warned))
    body += section("Key numbers", text_table("Amplitudes zero to peak", head, key_numbers))
    body += picture_sections(figures) + more + _sources(described.provenance)
    title = as_html(described.title)
    foot = stamped(stamped_with, "SHA-256 of the numbers")
    files["report.html"] = page(title, title, as_html(described.name), body, foot)
    write_folder(folder, files)
    return folder / "report.html"


def _sources(provenance: Mapping[str, Provenance]) -> str:
    """Sources of values, those of the same place side by side: seven ceramics alike take as
    many rows as one."""
    rows: dict[tuple[str, str, str], list[str]] = {}
    for path, one in provenance.items():
        numbered = re.sub(r"\.\d+\.", ".*.", path)
        rows.setdefault((numbered, one.evidence, one.source), []).append(path)
    table = [
        (paths[0] if len(paths) == 1 else f"{name} ({len(paths)} alike)", evidence, source)
        for (name, evidence, source), paths in rows.items()
    ]
    head = ("value", "evidence", "source")
    return section("Where the values come from", text_table("As the file says", head, table))


def with_interval(found: DrawnAnswers, value: float, name: str, unit: si.Unit) -> str:
    """A value (in its unit) and what lies between 5 and 95 % of the draws of the answer `name`."""
    interval = found.intervals.get(name)
    said = shown(value, unit, 3)
    if interval is None:
        return said
    return f"{said} ({shown(interval[0], unit, 2)} to {shown(interval[2], unit, 2)})"


def drawn_words(found: DrawnAnswers) -> str:
    """Sentences that say what the intervals are."""
    given = sum(value.origin == "given" for value in found.drawn)
    guessed = len(found.drawn) - given
    many = "all" if guessed == len(found.drawn) else f"{guessed} of them"
    ranges = "from ranges of the file"
    if guessed:
        ranges = f"{many} from ranges that are themselves assumed"
    said = (
        f"In brackets, 5 to 95 % of {found.count} draws (seed {found.seed}) of {len(found.drawn)} "
        f"uncertain values together, {ranges}."
    )
    if found.refused:
        said += (
            f" In {found.refused} of the draws the actuator does not work (most often: "
            f"{found.reason}); they are left out."
        )
    if not found.intervals:
        said += " Fewer than half work, and no interval is given."
    return said


def how_sure(found: DrawnAnswers, answers: Mapping[str, str]) -> str:
    """Section of a page: what was drawn, from where and why, and how much of the spread of each of
    the `answers` (in words, by name) follows it."""
    known = {name: words for name, words in answers.items() if name in found.shares}
    rows = [
        (
            value.path.split(".", 1)[-1].replace("_", " "),
            " to ".join(value.spread),
            *(si.percent(found.shares[name][k]) for name in known),
            value.source if value.origin == "given" else f"assumed: {value.source}",
        )
        for k, value in enumerate(found.drawn)
    ]
    head = ("value", "range", *(f"of the {words}" for words in known.values()), "why")
    table = text_table("Drawn evenly, and the share of each spread that follows it", head, rows)
    said = f"{drawn_words(found)} What has the largest share is worth measuring first."
    return section("How sure that is", f"<p>{as_html(said)}</p>{table}")
