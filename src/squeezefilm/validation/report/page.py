"""Report of `reproduce`, at the terminal, as a page and as the documentation's page of validation:
claims and verdicts, directions of friction model by model, the errata."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from squeezefilm.core.kit.folder import checkout, json_text, write_folder
from squeezefilm.core.kit.page_style import page, stamped
from squeezefilm.core.results import write_whole
from squeezefilm.design.analysis.paper_procedure import PaperDesign
from squeezefilm.validation.command import ClaimResult, Reproduction
from squeezefilm.validation.report.parts import Part, markdown_lines, page_section, show_parts
from squeezefilm.validation.report.published import (
    direction_table,
    directions,
    missed_sentences,
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
_SOURCE = (
    "Source: Biet, Giraud, Lemaire-Semail, <em>The implementation of tactile feedback using "
    "squeeze film effect devices</em>. Published friction against amplitude is compared by "
    "<code>squeezefilm reproduce --data published</code>; the default model is fitted to it."
)

_HEAD = ("where", "claim", "printed", "printed formula", "recomputed", "verdict")
_ERRATA = ("equation", "printed", "corrected", "why")
_VERDICT_STYLES = {
    "reproduces": "green",
    "holds": "green",
    "misprint": "cyan",
    "sign only": "cyan",
    "true by construction": "cyan",
    "reachable with parameters of our choice": "cyan",
    "does not reproduce": "yellow",
    "does not hold": "yellow",
}


def claim_parts(result: Reproduction) -> list[Part]:
    """Everything that is told of a reproduction, in its order."""
    plain, asked = plain_claims(result.results), directions(result.results)
    claims = [(item.claim.where, item.claim.statement, *_found(item)) for item in plain]
    parts = [
        Part("What the verdicts say", (), [verdict_table(result.results)]),
        Part("Claims", (), [(_HEAD, claims)]),
        Part("Why", [f"{item.claim.statement}: {_reason(item)}" for item in plain]),
    ]
    if asked:
        why = [
            f"{item.claim.statement}, by {item.claim.model}: {_reason(item)}"
            for items in asked
            for item in items
        ]
        parts += [
            Part(
                "Directions of friction that others observed, model by model",
                model_sentences(),
                [direction_table(result.results)],
            ),
            Part("Why, model by model", why),
            Part("What measurements say and the models do not", missed_sentences()),
        ]
    errata = [(item.equation, item.printed, item.corrected, item.why) for item in result.errata]
    parts.append(Part("The paper's design procedure", design_sentences(result.design)))
    parts.append(Part("Errata of the paper", (), [(_ERRATA, errata)]))
    return parts


def show_claims(result: Reproduction) -> None:
    """Print every published claim, and what is told of it."""
    show_parts(claim_parts(result), _style)


def _style(row: Sequence[str]) -> str:
    """The colour of a row that begins or ends with a verdict."""
    return _VERDICT_STYLES.get(row[-1]) or _VERDICT_STYLES.get(row[0], "")


def write_validation_docs(result: Reproduction, root: Path | None = None) -> Path:
    """Write docs/reference/validation.md of a checkout (the package's own, or the one at `root`).

    Raises `InputError` where the package is installed without one.
    """
    path = checkout(root) / "docs" / "reference" / "validation.md"
    write_whole(path, validation_markdown(result))
    return path


def validation_markdown(result: Reproduction) -> str:
    """The text of the page of validation."""
    return "\n".join([_HEADER, *markdown_lines(claim_parts(result))])


def write_reproduction(result: Reproduction, folder: Path) -> Path:
    """Write claims.json and reproduction.html.

    Returns the page's path. Raises `InputError` where the folder cannot be written to.
    """
    summary, title = result.summary(), "The paper's claims, recomputed"
    body = "".join(map(page_section, claim_parts(result)))
    foot = stamped(summary["provenance"], "SHA-256 of the claims", "computed")
    files = {
        "claims.json": json_text(summary),
        "reproduction.html": page(title, title, _SOURCE, body, foot, images=""),
    }
    write_folder(folder, files)
    return folder / "reproduction.html"


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


def _found(item: ClaimResult) -> tuple[str, str, str, str]:
    """The printed value, what the printed formula gives, what was recomputed, the verdict."""
    value = show_values(item.value, item.claim.unit)
    return show_printed(item), _formula(item), value, item.verdict


def _formula(item: ClaimResult) -> str:
    values = item.printed_formula_value
    if values is None or values == item.value:
        return "–"
    if item.claim.id.startswith("squeeze-number"):
        return " / ".join(f"{value:.4g} 1/m" for value in values)
    return show_values(values, item.claim.unit)


def _reason(item: ClaimResult) -> str:
    """Verdict and reason, another reading, and the note, which for a prediction is the
    prediction."""
    parts = [item.note] if item.note else []
    if item.alternative is not None:
        parts.insert(0, f"another reading gives {show_values(item.alternative, item.claim.unit)}")
    return f"{item.verdict}; {item.claim.why}." + (f" ({'; '.join(parts)})" if parts else "")
