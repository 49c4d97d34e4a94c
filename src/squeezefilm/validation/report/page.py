"""Page of `reproduce`: the page of validation, and the paper's figures redrawn."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from pathlib import Path

from squeezefilm.core.kit import style
from squeezefilm.core.kit.folder import checkout, json_text, markdown_table, write_folder
from squeezefilm.core.kit.page_style import bullets, page_head
from squeezefilm.core.results import write_whole
from squeezefilm.design.analysis.paper_procedure import PaperDesign
from squeezefilm.validation.command import ClaimResult, Reproduction
from squeezefilm.validation.explanations import PrototypeStudy
from squeezefilm.validation.report.prototype import (
    Table,
    comparison,
    explanation_table,
    identifiability,
    prototype_markdown,
    sentences,
    separation_table,
)
from squeezefilm.validation.report.published import (
    direction_table,
    directions,
    missed_lists,
    model_sentences,
    plain_claims,
    show_printed,
    show_values,
    verdict_table,
)

_HEADER = """# Validation

Written by `squeezefilm reproduce --write-docs`; do not edit. Source of the claims, unless another
is named: Biet, Giraud, Lemaire-Semail, *The implementation of tactile feedback using squeeze film
effect devices*. Claims on friction by others were read in abstracts, and are compared at one frozen
set of assumed parameters (`validation/frozen.py`).

**The default model is fitted to published friction of people against amplitude**, which refutes all
others here: see [Published friction](published-friction.md), every data set beside every model.
What follows compares with what the paper printed, and says where and why the numbers differ.
"Printed formula" is what the formula
gives as it stands in the paper, where that differs from the corrected one.
"""

_OBSERVED = "Directions of friction that others observed, model by model"
_MISSED = "What measurements say and the models do not"
_HEAD = ("where", "claim", "printed", "printed formula", "recomputed", "verdict")
_ERRATA = ("equation", "printed", "corrected", "why")


def write_validation_docs(result: Reproduction, root: Path | None = None) -> Path:
    """Write docs/reference/validation.md of a checkout (the package's own, or the one at `root`).

    Raises `InputError` where the package is installed without one.
    """
    path = checkout(root) / "docs" / "reference" / "validation.md"
    write_whole(path, validation_markdown(result))
    return path


def validation_markdown(result: Reproduction) -> str:
    """The text of the page of validation: a table of all claims, their reasons, the errata."""
    lines = [_HEADER, "## What the verdicts say", ""]
    lines += markdown_table(verdict_table(result.results))
    plain = plain_claims(result.results)
    lines += ["", "## Claims", ""]
    claims = [
        (item.claim.where, item.claim.statement, *_found(item), f"**{item.verdict}**")
        for item in plain
    ]
    lines += markdown_table((_HEAD, claims))
    lines += ["", "### Why", ""]
    for item in plain:
        lines.append(
            f"* **{item.claim.statement}** ({item.verdict}): {item.claim.why}." + _extra(item)
        )
    lines += _direction_lines(result)
    if result.prototype is not None:
        lines += prototype_markdown(result.prototype)
    lines += ["", "## The paper's design procedure", ""]
    lines += [f"* {sentence}" for sentence in design_sentences(result.design)]
    lines += ["", "## Errata of the paper", ""]
    errata = [(e.equation, _cell(e.printed), _cell(e.corrected), e.why) for e in result.errata]
    lines += markdown_table((_ERRATA, errata))
    return "\n".join([*lines, ""])


def _direction_lines(result: Reproduction) -> list[str]:
    """The directions of friction model by model, why, and what each model misses."""
    asked = directions(result.results)
    if not asked:
        return []
    lines = ["", f"## {_OBSERVED}", ""]
    lines += [f"* {sentence}" for sentence in model_sentences()]
    head, rows = direction_table(result.results)
    lines += ["", *markdown_table((head, [(*row[:-1], f"**{row[-1]}**") for row in rows]))]
    lines += ["", "### Why, model by model", ""]
    for items in asked:
        lines.append(f"* **{items[0].claim.statement}**")
        lines += [
            f"    * {item.claim.model} ({item.verdict}): {item.claim.why}." + _extra(item)
            for item in items
        ]
    lines += ["", f"## {_MISSED}"]
    for model, sentences_ in missed_lists():
        lines += ["", f"`{model}`:", "", *(f"* {sentence}" for sentence in sentences_)]
    return lines


def design_sentences(design: PaperDesign) -> list[str]:
    """The steps of the procedure of section 3.1, then its contradictions."""
    kilohertz, area = design.lowest_frequency / 1e3, design.area * 1e4
    size = f"{design.length * 1e3:.3g} × {design.width * 1e3:.3g} mm"
    return [
        f"The frequency criterion σ ≥ 10 asks for at least {kilohertz:.1f} kHz.",
        f"The mean explored area of 28.18 cm² takes {design.ceramics} ceramics of 11 mm on a plate "
        f"of {size} ({area:.3g} cm²); the paper takes seven, 83 × 49 mm, without saying why.",
        f"Such a plate works with {design.nodal_lines} nodal lines at "
        f"{design.resonance_frequency / 1e3:.1f} kHz (Timoshenko beam), λ/2 = "
        f"{design.half_wavelength * 1e3:.3g} mm, and needs "
        f"{design.required_amplitude * 1e6:.3g} µm for a relative friction of 0.7 by the paper's "
        "model.",
        *(f"Contradiction: {sentence}." for sentence in design.contradictions),
    ]


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def _found(item: ClaimResult) -> tuple[str, str, str]:
    """The printed value, what the printed formula gives, what was recomputed."""
    return show_printed(item), _formula(item), show_values(item.value, item.claim.unit)


def _formula(item: ClaimResult) -> str:
    values = item.printed_formula_value
    if values is None or values == item.value:
        return "–"
    if item.claim.id.startswith("squeeze-number"):
        return " / ".join(f"{value:.4g} 1/m" for value in values)
    return show_values(values, item.claim.unit)


def _extra(item: ClaimResult) -> str:
    parts = []
    if item.alternative is not None:
        parts.append(f"another reading gives {show_values(item.alternative, item.claim.unit)}")
    if item.note:
        parts.append(item.note)
    return f" *({'; '.join(parts)})*" if parts else ""


def write_reproduction(
    result: Reproduction, folder: Path, *, progress: Callable[[str], None] | None = None
) -> Path:
    """Write claims.json and reproduction.html with figures 4, 5, 10 and 11 redrawn.

    Returns the page's path. Raises `InputError` where the folder cannot be written to.
    """
    from squeezefilm.validation.report.figures import reproduction_figures

    tell = progress or (lambda _: None)
    figures = [
        f"<section><h2>{escape(title)}</h2>{_framed(svg)}</section>"
        for title, svg in reproduction_figures(tell)
    ]
    if result.prototype is not None:
        tell("the prototype")
        figures += prototype_sections(result.prototype)
    files = {
        "claims.json": json_text(result.summary()),
        "reproduction.html": _page(result, figures),
    }
    write_folder(folder, files)
    return folder / "reproduction.html"


def _page(result: Reproduction, figures: list[str]) -> str:
    claims = [
        (item.claim.where, item.claim.statement, *_found(item), item.verdict, _reason(item))
        for item in plain_claims(result.results)
    ]
    errata = [(one.equation, one.printed, one.corrected, one.why) for one in result.errata]
    title, design = "The paper's claims, recomputed", bullets(design_sentences(result.design))
    return f"""{page_head(title, images="")}<header>
<h1>{title}</h1>
<p>Source: Biet, Giraud, Lemaire-Semail, <em>The implementation of tactile feedback using squeeze
film effect devices</em>. Published friction against amplitude is compared by
<code>squeezefilm reproduce --data published</code>; the default model is fitted to it.</p>
</header><main>
<section><h2>What the verdicts say</h2>{_table(verdict_table(result.results))}</section>
<section><h2>Claims</h2>{_table(((*_HEAD, "why"), claims))}</section>
{_direction_sections(result)}
{"".join(figures)}
<section><h2>The paper's design procedure</h2>{design}</section>
<section><h2>Errata</h2>{_table((_ERRATA, errata))}</section></main></body></html>
"""


def _reason(item: ClaimResult) -> str:
    """Reason, and the note, which for a prediction is the prediction."""
    return f"{item.claim.why} ({item.note})" if item.note else item.claim.why


def _direction_sections(result: Reproduction) -> str:
    """HTML: the directions of friction model by model, and what each model misses."""
    asked = directions(result.results)
    if not asked:
        return ""
    head, rows = direction_table(result.results)
    reasons = [_reason(item) for items in asked for item in items]
    full = [(*row, reason) for row, reason in zip(rows, reasons, strict=True)]
    missed = "".join(f"<h3>{escape(model)}</h3>{bullets(texts)}" for model, texts in missed_lists())
    return (
        f"<section><h2>{_OBSERVED}</h2>{bullets(model_sentences())}"
        f"{_table(((*head, 'why'), full))}</section><section><h2>{_MISSED}</h2>{missed}</section>"
    )


def prototype_sections(study: PrototypeStudy) -> list[str]:
    """HTML sections: the comparison, and what would identify the cause."""
    parts = (
        ("The plate: the paper, the solved plate, the prototype", _table(comparison(study))),
        (
            "What one frequency cannot tell",
            bullets(sentences(study))
            + _framed(style.svg(identifiability(study), "identifiability", "Identifiability"))
            + _table(explanation_table(study))
            + "<p>Distance of each pair, in units of what could be measured:</p>"
            + _table(separation_table(study)),
        ),
    )
    return [f"<section><h2>{escape(title)}</h2>{body}</section>" for title, body in parts]


def _framed(drawing: str) -> str:
    """A drawing (an SVG element) as a figure that scrolls."""
    return f'<figure><div class="scroll" tabindex="0">{drawing}</div></figure>'


def _table(table: Table) -> str:
    """Head and rows of plain texts as HTML."""
    head, rows = table
    top = "".join(f"<th>{escape(cell)}</th>" for cell in head)
    body = "\n".join(
        "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
    )
    return (
        f'<div class="scroll" tabindex="0"><table><thead><tr>{top}</tr></thead>'
        f"<tbody>{body}</tbody></table></div>"
    )
