"""An actuator analysed by its kind, and its page: what one decides from, its figures, and where its
values are from."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from squeezefilm.actuators.analysis.drawn import DrawnAnswers
from squeezefilm.actuators.analysis.motor import MotorAnalysis, analyze_motor
from squeezefilm.actuators.analysis.skin_stretch import SkinStretchAnalysis, analyze_skin_stretch
from squeezefilm.actuators.described import load_actuator
from squeezefilm.actuators.motor.description import MotorDescription
from squeezefilm.actuators.report.motor import MOTOR_ANSWERS, MOTOR_FIGURES, motor_rows
from squeezefilm.actuators.report.skin_stretch import (
    SKIN_STRETCH_ANSWERS,
    SKIN_STRETCH_FIGURES,
    skin_stretch_rows,
)
from squeezefilm.core import quantities as si
from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.kit.folder import json_text, require_folder, write_folder
from squeezefilm.core.kit.numbers import Row
from squeezefilm.core.kit.page_style import (
    FigureOf,
    as_html,
    bullets,
    drawn_figures,
    page,
    picture_files,
    picture_sections,
    section,
    stamped,
    text_table,
)
from squeezefilm.core.kit.terminal import bullets as terminal_bullets
from squeezefilm.core.kit.terminal import show_rows
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import stamp


def assumed_words(provenance: Mapping[str, Provenance]) -> str:
    """A sentence with the number of an actuator's values that are assumed."""
    assumed = sum(source.evidence == "assumed" for source in provenance.values())
    return (
        f"{assumed} of {len(provenance)} values with a source are assumed, and the numbers hang on "
        "them; the page's last tables (--out DIR) list them and say what they do."
    )


class AnalyzedActuator(NamedTuple):
    """An actuator's `analysis` and what is shown of it: key numbers, figures, and in words, by
    name, the `answers` whose certainty the page tells."""

    analysis: MotorAnalysis | SkinStretchAnalysis
    rows: Callable[[Any], list[Row]]
    figures: tuple[FigureOf, ...]
    answers: Mapping[str, str]

    def show(self) -> None:
        """Print key numbers, warnings, and what is assumed."""
        analysis, described = self.analysis, self.analysis.described
        title = f"{described.title} [{described.name}]"
        show_rows(title, self.rows(analysis), analysis.warnings, fixed=(0, 1))
        terminal_bullets([("interval", drawn_words(analysis.drawn), "")])
        terminal_bullets([("assumed", assumed_words(described.provenance), "yellow")])

    def write(self, folder: Path) -> Path:
        """Write result.json, a PNG of each figure, and report.html into `folder`; the path of the
        page. Raises `InputError` where the folder cannot be written to."""
        folder, described = require_folder(folder), self.analysis.described
        summary, figures = self.analysis.summary(), drawn_figures(self.figures, self.analysis)
        stamped_with = stamp(summary)
        files = picture_files(figures)
        files["result.json"] = json_text(summary | {"stamp": stamped_with})
        warned = [*self.analysis.warnings, assumed_words(described.provenance)]
        head = ("quantity", "value", "remark")
        numbers = text_table("Amplitudes zero to peak", head, self.rows(self.analysis))
        body = section("Warnings", bullets(warned)) + section("Key numbers", numbers)
        body += picture_sections(figures) + how_sure(self.analysis.drawn, self.answers)
        body += _sources(described.provenance)
        title = as_html(described.title)
        foot = stamped(stamped_with, "SHA-256 of the numbers")
        files["report.html"] = page(title, title, as_html(described.name), body, foot)
        return write_folder(folder, files)


def analyze_actuator(
    target: str | Path, voltage: si.Volt | None = None, progress: SayProgress | None = None
) -> AnalyzedActuator:
    """Analyse a motor or an array, by a preset's name or the path of its file, at a voltage (V,
    zero-to-peak; its own if None). Raises what `load_actuator` and the kind's analysis raise.
    """
    described = load_actuator(target)
    if isinstance(described, MotorDescription):
        of_motor = analyze_motor(described, voltage=voltage, progress=progress)
        return AnalyzedActuator(of_motor, motor_rows, MOTOR_FIGURES, MOTOR_ANSWERS)
    of_array = analyze_skin_stretch(described, voltage=voltage, progress=progress)
    return AnalyzedActuator(of_array, skin_stretch_rows, SKIN_STRETCH_FIGURES, SKIN_STRETCH_ANSWERS)


def _sources(provenance: Mapping[str, Provenance]) -> str:
    """Sources of values, those of the same place side by side: seven ceramics alike take as
    many rows as one."""
    rows: dict[tuple[str, str, str], list[str]] = {}
    for path, origin in provenance.items():
        numbered = re.sub(r"\.\d+\.", ".*.", path)
        rows.setdefault((numbered, origin.evidence, origin.source), []).append(path)
    table = [
        (paths[0] if len(paths) == 1 else f"{name} ({len(paths)} alike)", evidence, source)
        for (name, evidence, source), paths in rows.items()
    ]
    head = ("value", "evidence", "source")
    return section("Where the values come from", text_table("As the file says", head, table))


def drawn_words(sampled: DrawnAnswers) -> str:
    """Sentences that say what the intervals are."""
    given = sum(value.origin == "given" for value in sampled.drawn)
    guessed = len(sampled.drawn) - given
    many = "all" if guessed == len(sampled.drawn) else f"{guessed} of them"
    ranges = "from ranges of the file"
    if guessed:
        ranges = f"{many} from ranges that are themselves assumed"
    said = (
        f"In brackets, 5 to 95 % of {sampled.count} draws (seed {sampled.seed}) of "
        f"{len(sampled.drawn)} uncertain values together, {ranges}."
    )
    if sampled.refused:
        said += (
            f" In {sampled.refused} of the draws the actuator does not work (most often: "
            f"{sampled.reason}); they are left out."
        )
    if not sampled.intervals:
        said += " Fewer than half work, and no interval is given."
    return said


def how_sure(sampled: DrawnAnswers, answers: Mapping[str, str]) -> str:
    """Section of a page: what was drawn, from where and why, and how much of the spread of each of
    the `answers` (in words, by name) follows it."""
    known = {name: words for name, words in answers.items() if name in sampled.shares}
    rows = [
        (
            value.path.split(".", 1)[-1].replace("_", " "),
            " to ".join(value.spread),
            *(si.percent(sampled.shares[name][k]) for name in known),
            value.source if value.origin == "given" else f"assumed: {value.source}",
        )
        for k, value in enumerate(sampled.drawn)
    ]
    head = ("value", "range", *(f"of the {words}" for words in known.values()), "why")
    table = text_table("Drawn evenly, and the share of each spread that follows it", head, rows)
    said = f"{drawn_words(sampled)} What has the largest share is worth measuring first."
    return section("How sure that is", f"<p>{as_html(said)}</p>{table}")
