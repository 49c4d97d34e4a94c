"""`write_design`: a search as a page, its numbers, and a file for every plate of the front."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from html import escape
from pathlib import Path

from squeezefilm.core import quantities as si
from squeezefilm.core.config.schema import text_of
from squeezefilm.core.kit import style
from squeezefilm.core.kit.folder import csv_text, json_text, require_folder, write_folder
from squeezefilm.core.kit.numbers import printable
from squeezefilm.core.kit.page_style import (
    FigureOf,
    as_html,
    bullets,
    figure_section,
    html_table,
    links,
    page,
    section,
    stamped,
    text_table,
    verdict_list,
)
from squeezefilm.design.search.candidate import Design, sourced_display_of
from squeezefilm.design.search.criteria import CRITERIA, bounded
from squeezefilm.design.search.found import DesignSearch, FrontMember
from squeezefilm.design.search.limits import margins
from squeezefilm.design.search.report.figures import FIGURES, MARKED
from squeezefilm.design.search.report.words import (
    asked_sentences,
    chosen_sentences,
    chosen_words,
    counts_sentence,
    effect_table,
    empty_front_sentences,
    front_head,
    front_row,
    limit_gain,
    limit_sentences,
    made_sentences,
    margin_words,
    rank_sentences,
    reference_sentences,
    row_of,
)
from squeezefilm.design.search.requirements import Requirements

_SURE: si.Dimensionless = 0.95
"""The share of the plates made that must keep all limits for a plate to be called good."""

PAGE, DATA, TABLE, PLATES = "index.html", "result.json", "front.csv", "plates"


def write_design(search: DesignSearch, folder: Path, *, fabrication: str = "") -> Path:
    """Write index.html, result.json, front.csv and plates/NAME.toml into `folder`; the page's path.

    `fabrication` is the address of what the plate to build is made from, relative to the page: its
    drawings. Raises `InputError` for a folder that cannot be written to.
    """
    folder = require_folder(folder)
    files: dict[str, str | bytes] = {
        f"{PLATES}/{member.name}.toml": plate_file(search.requirements, member.evaluated.design)
        for member in search.front
    }
    files |= {DATA: json_text(search.summary()), TABLE: front_csv(search)}
    files[PAGE] = design_page(search, fabrication=fabrication)
    return write_folder(folder, files)


def front_csv(search: DesignSearch) -> str:
    """The front as CSV: a row for each plate at a voltage, SI numbers, units in columns' names."""
    rows = []
    for row in search.summary()["front"]:
        made = row.pop("made") or {}
        rows.append({**row, **made})
    head = list(dict.fromkeys(key for row in rows for key in row)) or ["name"]
    return csv_text(head, ([row.get(key) for key in head] for row in rows))


def design_page(search: DesignSearch, *, fabrication: str = "") -> str:
    """The page of a search as text; it is complete but for the files that it links to."""
    requirements = search.requirements
    notes = [requirements.note] if requirements.note else []
    parts = [
        section("To read first", verdict_list(first_sentences(search))),
        section("What was asked for", bullets([*asked_sentences(requirements), *notes])),
        *(figure_section(item, _svg(search, item)) for item in FIGURES if item.has(search)),
        section("The plates of the front", _front_table(search)),
        *_chosen_sections(search, fabrication),
        *_reference_section(search),
        section("What each limit does and costs", bullets(limit_sentences(search))),
        section("Where nothing keeps the limits", _corners(search)),
        section("How far the screening is off", _errors(search)),
        section("What all of this assumes", bullets(requirements.assumed)),
        section("Files", _files(search)),
    ]
    name = as_html(requirements.name)
    stamp = search.provenance
    foot = (
        f"{stamped(stamp, 'SHA-256 of the display that the search started from')} ·\n"
        f"requirements <code>{escape(str(stamp.get('requirements_sha256', '')))}</code> ·\n"
        f"seed {search.seed}. {search.computed} answers computed, {search.kept} taken from before."
    )
    return page(
        f"{name}: a design search",
        as_html(requirements.title),
        f"<code>{name}</code>, searched by squeezefilm design",
        "".join(parts),
        foot,
    )


def first_sentences(search: DesignSearch) -> Iterator[tuple[str, str]]:
    """Sentences that one must know of a search, each with its kind: good, limit or doubt."""
    requirements, chosen = search.requirements, search.chosen
    if search.stopped:
        yield "doubt", "The search was stopped: these are the plates found until then."
    if chosen is None:
        yield "limit", f"No plate meets the requirements. {counts_sentence(search)}"
        for sentence in empty_front_sentences(search):
            yield "limit", sentence
    else:
        yield "good", counts_sentence(search)
        # What a tolerance may push across a limit is not called good.
        kept = 0.0 if chosen.made is None else chosen.made.kept
        sure = "good" if kept >= _SURE else "limit"
        made = made_sentences(requirements, chosen)[0]
        for sentence in chosen_sentences(search)[:1]:
            yield sure, f"The plate to build: {sentence} {made}"
    compared = reference_sentences(search)
    if compared and search.front:
        kind = "good" if search.beats_reference else "limit"
        yield kind, " ".join(dict.fromkeys((compared[0], compared[-1])))
    if gain := limit_gain(search):
        yield "limit", gain
    if chosen is not None and chosen.made is not None and chosen.made.kept < 0.9:
        yield (
            "limit",
            "A limit met exactly is met by half of what is made; least_yield among the limits asks "
            "for more.",
        )
    yield (
        "doubt",
        "No plate here was built. The quality factor is assumed, and with it every amplitude; the "
        "friction is by a model fitted to people on glass alone.",
    )


def _svg(search: DesignSearch, item: FigureOf) -> str:
    """A figure as SVG; marks of plates have titles that a browser shows under the pointer."""
    figure = item.draw(search)
    svg = style.svg(figure, item.key, " ".join(figure.get_suptitle().split()))
    titles = {
        member.name: escape(
            f"{member.name}: {chosen_words(search.requirements, member.evaluated.design)}; "
            + ", ".join(
                f"{head} {text}"
                for head, text in zip(
                    front_head(search.requirements),
                    front_row(search.requirements, member),
                    strict=True,
                )
            )
        )
        for member in search.front
    }
    return re.sub(
        rf'<g id="{item.key}-{MARKED}([0-9a-f]+)-\d+">',
        lambda mark: f"{mark[0]}<title>{titles[mark[1]]}</title>",
        svg,
    )


def _front_table(search: DesignSearch) -> str:
    if not search.front:
        return "<p>No plate meets the requirements.</p>"
    requirements = search.requirements
    head = ["name", "what was chosen", *front_head(requirements)]
    rows, kinds = [], []
    for member in search.front:
        chosen = member is search.chosen
        # Where the marks of the figure lead to.
        anchor = (
            f'<a id="front-row-{member.name}" href="{PLATES}/{member.name}.toml">{member.name}</a>'
        )
        rows.append(
            [
                anchor + (" ◀ to build" if chosen else ""),
                as_html(chosen_words(requirements, member.evaluated.design)),
                *map(as_html, front_row(requirements, member)),
            ]
        )
        kinds.append("assumed" if chosen else "")
    if search.reference is not None and not search.reference.reason:
        own = map(as_html, row_of(requirements, search.reference))
        rows.append([as_html(requirements.compare_with), "to compare with", *own, ""])
    caption = "A name leads to the plate's file; the yield is of plates made with the tolerances"
    return html_table(caption, map(as_html, head), rows, kinds=kinds)


def _chosen_sections(search: DesignSearch, fabrication: str) -> Iterator[str]:
    chosen = search.chosen
    if chosen is None:
        return
    more = f'<p><a href="{escape(fabrication)}">What it is made from: drawings and parts</a></p>'
    yield section(
        f"The plate to build: {chosen.name}",
        bullets(chosen_sentences(search))
        + (more if fabrication else "")
        + text_table(
            "Its numbers, by the solved plate",
            ("criterion", "value", "limit", "margin", "90 % of those made"),
            _criteria_rows(search, chosen),
        ),
    )
    head, effects = effect_table(search.requirements, chosen)
    if effects:
        told = "One standard deviation more of each, the others as drawn"
        table = text_table(told, ("tolerance", *head), effects)
        yield section("What each tolerance does to it", table)
    if warned := chosen.evaluated.warnings:
        yield section("What was warned of when it was solved", bullets(warned))


def _criteria_rows(search: DesignSearch, member: FrontMember) -> Iterator[tuple[str, ...]]:
    """Every criterion of a plate that is known or was asked for: value, limit, margin, interval of
    those made."""
    bounds = {criterion.key: bound for criterion, bound in bounded(search.requirements.limits)}
    left = margins(search.requirements, member.evaluated)
    made = {} if member.made is None else member.made.intervals
    for key, criterion in CRITERIA.items():
        value = criterion.value(member.evaluated.numbers)
        if key not in bounds and (math.isnan(value) or criterion.of):
            continue
        limit = criterion.bound_said(bounds[key]) if key in bounds else ""
        yield (
            criterion.said,
            criterion.shown(value),
            limit,
            margin_words(left[key]) if key in left else "not judged" if limit else "",
            " to ".join(criterion.shown(end) for end in made[key]) if key in made else "",
        )


def _reference_section(search: DesignSearch) -> Iterator[str]:
    if not (said := reference_sentences(search)):
        return
    reference, chosen = search.reference, search.chosen
    table = ""
    if reference is not None and not reference.reason and chosen is not None:
        rows = [
            (
                criterion.said,
                criterion.shown(reference.numbers[key]),
                criterion.shown(chosen.evaluated.numbers.get(key)),
            )
            for key, criterion in CRITERIA.items()
            if key in reference.numbers
        ]
        head = ("criterion", search.requirements.compare_with, f"{chosen.name}, to build")
        table = text_table("Both, judged in the same way", head, rows)
    yield section(f"Beside {as_html(search.requirements.compare_with)}", bullets(said) + table)


def _corners(search: DesignSearch) -> str:
    if not search.corners:
        return (
            "<p>In every part of every range that was looked at often enough, something keeps the "
            "limits.</p>"
        )
    rows = [
        (
            f"{corner.shape}, {corner.where}",
            f"{corner.designs}",
            f"{CRITERIA[corner.key].said}, {100 * corner.share:.0f} % of them"
            if corner.key
            else f"{100 * corner.share:.0f} % cannot be built",
            corner.example,
        )
        for corner in search.corners
    ]
    head = ("part of the space", "designs", "most often broken", "for example")
    return text_table("Parts without a design that keeps all limits", head, rows)


def _errors(search: DesignSearch) -> str:
    rows = [
        (
            f"{correction.space.shape}: {CRITERIA[key].said}",
            si.percent(raw, 1),
            si.percent(correction.errors[key], 1),
        )
        for correction in search.corrections
        if correction is not None
        for key, raw in correction.raw.items()
    ]
    table = text_table(
        "Screened against solved, one standard deviation",
        ("number", "as screened", "corrected, on plates left out"),
        rows,
    )
    return bullets(rank_sentences(search)) + (table if rows else "")


def _files(search: DesignSearch) -> str:
    plates = [f"{PLATES}/{member.name}.toml" for member in search.front]
    return (
        f"<p>{links((DATA, TABLE, *plates))}</p>"
        "<p>A plate's file is a display like any other: <code>squeezefilm analyze "
        "plates/NAME.toml</code> works it out, <code>squeezefilm render</code> plays a texture on "
        "it.</p>"
    )


def plate_file(requirements: Requirements, design: Design) -> str:
    """The text of a TOML file from which `load_display` reads the plate: the same values, and of
    each where it is from.

    Raises `GeometryError` for a design that cannot be built, and `InputError` as `text_of`.
    """
    said = printable(chosen_words(requirements, design))
    head = (
        f"# A plate that squeezefilm design found for the requirements "
        f"'{printable(requirements.name)}':\n# {said}.\n"
        "# It was computed and never built. squeezefilm analyze works it out.\n\n"
    )
    display = sourced_display_of(requirements, design)
    return head + text_of(display, display.provenance)
