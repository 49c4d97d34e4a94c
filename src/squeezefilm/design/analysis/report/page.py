"""`write_analysis`: result.json and report.html, one file that needs nothing from anywhere."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from squeezefilm.core import quantities as si
from squeezefilm.core.kept.store import Kept
from squeezefilm.core.kit.folder import json_text, require_folder, write_folder
from squeezefilm.core.kit.page_style import (
    as_html,
    bullets,
    figure_section,
    html_table,
    page,
    part,
    section,
    stamped,
    text_table,
    verdict_list,
)
from squeezefilm.core.results import to_json
from squeezefilm.design.analysis.report.decisions import interval_rows, sensitivity_rows
from squeezefilm.design.analysis.report.described_values import display_values
from squeezefilm.design.analysis.report.figures import FIGURES, drawing
from squeezefilm.design.analysis.report.model_rows import (
    MISSED_HEADING,
    group_words,
    influence_rows,
    missed_directions,
    models,
    theory_rows,
    weight_rows,
)
from squeezefilm.design.analysis.report.point_rows import electronics_rows
from squeezefilm.design.analysis.report.rows import (
    decision_rows,
    more_rows,
    unsaid_warnings,
    working_point,
)

if TYPE_CHECKING:
    from squeezefilm.design.analysis.analyze import Analysis
    from squeezefilm.design.analysis.verdict import Finding

# What stands beside an analysis for comparison, each computed by itself.
_BESIDE = (
    "ears",
    "band",
    "friction_curves",
    "response",
    "felt",
)
# Of what could be measured: as many rows as one decides from.
_NEXT = 5
_DRAWN: Kept[dict[str, str]] = Kept("figures", dict[str, str], large=True)


def write_analysis(
    analysis: Analysis,
    folder: Path,
    progress: Callable[[str], None] | None = None,
) -> Path:
    """Write result.json and report.html into `folder`; the path of the page.

    Figures are kept on disk. Raises `InputError` where the folder cannot be written to.
    """
    folder, tell = require_folder(folder), progress or (lambda _: None)
    asked = ("sensitivities",) if analysis.has_sensitivities else ()
    more = ("other_models",) if analysis.whole else ()
    analysis.compute((*_BESIDE, *asked, *more), tell)
    summary = analysis.summary()
    data = result_data(analysis, summary)
    tell("figures")
    drawn = _figures(analysis, data)
    tell("writing the report")
    files = {"result.json": json_text(data), "report.html": report_page(analysis, summary, drawn)}
    write_folder(folder, files)
    return folder / "report.html"


def _figures(analysis: Analysis, data: Mapping[str, Any]) -> dict[str, str]:
    """The drawings by key, of which all numbers are in the `data` of result.json, or follow from
    what is in there: drawn once for the same data, whenever it was computed."""
    numbers = {name: value for name, value in data.items() if name != "provenance"}
    asked = json.dumps(to_json([numbers, sorted(analysis.display.provenance.items())]))

    def drawn() -> dict[str, str]:
        return {item.key: drawing(analysis, item.key) for item in FIGURES}

    return _DRAWN.found(asked, drawn)


def result_data(analysis: Analysis, summary: dict[str, Any]) -> dict[str, Any]:
    """What result.json holds: the summary, the curves behind the figures, the display itself."""
    return {
        **summary,
        "curves": {
            "response": analysis.response,
            "friction": analysis.friction_curves,
            "band": analysis.band,
            "fidelity": analysis.fidelity,
            "active_area": None if analysis.active_area is None else analysis.active_area.area,
        },
        "display_description": analysis.display,
    }


def report_page(
    analysis: Analysis,
    summary: dict[str, Any] | None = None,
    drawn: Mapping[str, str] | None = None,
) -> str:
    """The report as the text of one self-contained HTML page; `drawn` are its drawings by key,
    where they are there already."""
    summary = summary or analysis.summary()
    ready = drawn or _figures(analysis, result_data(analysis, summary))
    display = analysis.display
    title, name = as_html(display.title), as_html(display.name)
    has_shifts = analysis.has_sensitivities
    figures = (
        figure_section(item, f"{number}. {item.heading}", ready[item.key])
        for number, item in enumerate(FIGURES, 1)
    )
    parts = [
        part("decide", "To decide from", _INTRODUCTION),
        section("Verdict", _findings(analysis.findings)),
        section("Warnings", _warnings(analysis)),
        section("Key numbers", _key_numbers(analysis)),
        *figures,
        section("Drive electronics", _electronics(analysis)),
        section("What to measure next", _measure_next(analysis)),
        part("models", "Appendix: models", _aside(analysis)),
        section("How far the film's model is from where it holds", _validity(analysis)),
        section("Models", _models(analysis)),
        part("origin", "Appendix: where the numbers come from", ""),
        section("More numbers", text_table("Beside the key numbers", _HEAD, more_rows(analysis))),
        section("How sure the friction is", _how_sure(analysis)),
        *([section("What each value does", _sensitivities(analysis))] if has_shifts else []),
        section("Where the values come from", _provenance(analysis)),
    ]
    stamp = summary["provenance"]
    seed = "no random numbers" if stamp["seed"] is None else f"seed {escape(str(stamp['seed']))}"
    return page(
        f"{name}: squeezefilm report",
        title,
        f"<code>{name}</code>, analysed by squeezefilm",
        "".join(parts),
        f"{stamped(stamp, 'description SHA-256')} ·\n{seed}.\n"
        "The numbers and curves are in <code>result.json</code> beside this page.",
        images="data:",
    )


_HEAD = ("Quantity", "Value", "Remark")
_INTRODUCTION = (
    "This part is by one model each for plate, film and friction. "
    '<a href="#part-models">Models</a> and <a href="#part-origin">where the values come from</a> '
    "follow in the appendix."
)


def _aside(analysis: Analysis) -> str:
    """What to remember while reading about models."""
    p = analysis.prediction
    return (
        f"The verdict's friction of {p.relative_friction:.2f} is by "
        f"<code>{escape(p.model)}</code>. <code>squeezefilm friction --out</code> draws it beside "
        "every other model, <code>squeezefilm reproduce</code> the paper's own figures."
    )


def _findings(findings: tuple[Finding, ...]) -> str:
    return verdict_list((finding.kind, finding.text) for finding in findings)


def _key_numbers(analysis: Analysis) -> str:
    rows, kinds = [], []
    for heading, of_subject, _ in decision_rows(analysis):
        rows.append((escape(heading), "", ""))
        rows += [
            (as_html(label), f'<span class="mark">{as_html(text)}</span>', as_html(remark))
            for label, text, remark in of_subject
        ]
        kinds += ["subject", *[""] * len(of_subject)]
    here = as_html(working_point(analysis.prediction))
    return html_table(f"{here[0].upper()}{here[1:]}", _HEAD, rows, kinds=kinds)


def _electronics(analysis: Analysis) -> str:
    """What the plate asks of its amplifier, and which can give it."""
    rows = electronics_rows(analysis.drive_electronics) + interval_rows(analysis.uncertainty)[1:]
    return text_table("Without a finger, but for the power taken", _HEAD, rows)


def _sensitivities(analysis: Analysis) -> str:
    """What each uncertain or toleranced value does to frequency, amplitude and friction."""
    found = analysis.sensitivities
    if found is None:
        return "<p>Nothing vibrates here.</p>"
    caption = f"From the 5 % to the 95 % end of each range; plates by {found.plate_model}"
    head = ("Value", "From, to", "Frequency", "Amplitude", "µ′/µ", "Range")
    return text_table(caption, head, sensitivity_rows(found))


_INFLUENCES = ("Drawn", "From", "Share of the variance", "Whose")


def _measure_next(analysis: Analysis) -> str:
    """What could be measured, the most rewarding first."""
    unsure = analysis.uncertainty
    if unsure is None:
        return "<p>Not known without an interval of the friction: the verdict says why.</p>"
    group = next(one for one in unsure.groups if one.knowledge == "measurable")
    rows = influence_rows(unsure, "measurable", _NEXT)
    return text_table(group_words(group), _INFLUENCES, rows)


def _how_sure(analysis: Analysis) -> str:
    unsure = analysis.uncertainty
    if unsure is None:
        return "<p>No interval: the verdict says why.</p>"
    said = f"{unsure.sentence}, {si.percent(unsure.level)} interval. {unsure.standing}."
    parts = [f"<p>{escape(said)}</p>"]
    if analysis.model_form is not None:
        parts.append(f"<p>{escape(analysis.model_form.text)}</p>")
    for group in unsure.groups:
        rows = influence_rows(unsure, group.knowledge, len(unsure.influences))
        parts.append(text_table(group_words(group), _INFLUENCES, rows))
    caption = "Laws and states that are drawn, by weights that are assumed"
    parts.append(text_table(caption, ("What", "Which", "Weight", "Why"), weight_rows(unsure)))
    if unsure.refused.count:
        parts.append(f"<p>{escape(unsure.refused.sentence)}.</p>")
    return "\n<br>\n".join(parts)


def _validity(analysis: Analysis) -> str:
    def limits(low: float | None, high: float | None) -> str:
        parts = [] if low is None else [f"at least {low:g}"]
        parts += [] if high is None else [f"at most {high:g}"]
        return " and ".join(parts)

    rows = []
    for check in analysis.prediction.validity.checks:
        holds = check not in analysis.prediction.validity.failed
        rows.append(
            (
                escape(check.name),
                f"{check.value:.3g}",
                limits(check.low, check.high),
                f'<span class="mark">{"✓ holds" if holds else "✗ does not hold"}</span>',
                as_html(check.sentence),
            )
        )
    head = ("Assumption", "Number", "Wanted", "Here", "In words")
    return html_table("Assumptions of the film's model", head, rows)


def _warnings(analysis: Analysis) -> str:
    return bullets(unsaid_warnings(analysis), "None beyond the doubts of the verdict.")


def _models(analysis: Analysis) -> str:
    used = html_table(
        "What made the numbers",
        ("Link of the chain", "Model"),
        [(escape(what), f"<code>{escape(model)}</code>") for what, model in models(analysis)],
    )
    model = analysis.prediction.model
    used += f"\n<h3>{escape(MISSED_HEADING.format(model))}</h3>\n"
    used += bullets(missed_directions(model, why=True))
    if not analysis.whole:
        return f"{used}\n<p><code>--all</code> adds the same plate by other theories.</p>"
    if not analysis.other_models:
        return used
    rows = [
        (f"<code>{escape(row[0])}</code>", *map(as_html, row[1:])) for row in theory_rows(analysis)
    ]
    others = html_table(
        "The same plate by other theories, each driven at its own resonance, without a finger",
        ("Model", "Resonance", "Half wavelength", "Amplitude"),
        rows,
    )
    return f"{used}\n<br>\n{others}"


def _provenance(analysis: Analysis) -> str:
    rows, kinds = [], []
    for value in display_values(analysis.display):
        assumed = value.evidence == "assumed"
        evidence = escape(value.evidence) or "not stated"
        kinds.append("assumed" if assumed else "")
        rows.append(
            (
                f"<code>{escape(value.path)}</code>",
                as_html(value.text),
                as_html(value.source) or "–",
                f'<span class="mark">⚠\u00a0{evidence}</span>' if assumed else evidence,
            )
        )
    return html_table(
        "Every value of the description; ⚠ marks what is assumed",
        ("Key", "Value", "Source", "Evidence"),
        rows,
        kinds=kinds,
    )
