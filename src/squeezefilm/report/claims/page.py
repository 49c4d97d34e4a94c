"""What `reproduce` shows: docs/validation.md, and the paper's figures redrawn on one page."""

from __future__ import annotations

import html
from collections.abc import Callable, Sequence
from pathlib import Path

from squeezefilm import quantities as si
from squeezefilm.analysis.claims.command import ClaimResult, Reproduction
from squeezefilm.analysis.claims.procedure import Design
from squeezefilm.errors import InputError
from squeezefilm.report.claims.prototype import prototype_markdown
from squeezefilm.report.claims.prototype_page import html_row, prototype_sections
from squeezefilm.report.kit.folder import json_text, write_folder
from squeezefilm.report.kit.page_style import STYLE
from squeezefilm.results import write_whole

_HEADER = """# Validation

Written by `squeezefilm reproduce --write-docs`; do not edit. Source of the claims, unless another
is named: Biet, Giraud, Lemaire-Semail, *The implementation of tactile feedback using squeeze film
effect devices*. Claims on friction by others were read in abstracts, and are compared at one frozen
set of assumed parameters (`analysis/claims/contact.py`).

**Friction against amplitude is not validated against measurements**: no measured curve of an
ultrasonic display could be read anywhere. What follows compares with what the paper printed, and
says where and why the numbers differ. "Printed formula" is what the formula gives as it stands in
the paper, where that differs from the corrected one.
"""


def show_values(values: Sequence[float] | None, unit: str) -> str:
    """The values of a claim as text with a unit, joined by slashes; a dash for none."""
    if values is None:
        return "–"
    if unit == "m2":
        return " / ".join(f"{value * 1e4:.4g} cm²" for value in values)
    return " / ".join(
        si.format_quantity(value, si.Unit(unit), 4).replace("um", "µm") for value in values
    )


def write_validation_docs(result: Reproduction, root: Path | None = None) -> Path:
    """Write docs/validation.md of a checkout (the package's own, or the one at `root`).

    Raises `InputError` where the package is installed without one.
    """
    path = checkout(root) / "docs" / "validation.md"
    write_whole(path, validation_markdown(result))
    return path


def checkout(root: Path | None = None) -> Path:
    """The checkout that this package runs from, or `root`. Raises `InputError` if it is none."""
    top = root or Path(__file__).parents[4]
    if not (top / "docs").is_dir() or not (top / "pyproject.toml").is_file():
        raise InputError(
            "--write-docs needs a checkout of the source, and this is an installed package; "
            "clone the repository and run it there"
        )
    return top


def validation_markdown(result: Reproduction) -> str:
    """The text of docs/validation.md: a table of all claims, their reasons, the errata."""
    lines = [_HEADER, "## Claims", ""]
    lines.append("| where | claim | printed | printed formula | recomputed | verdict |")
    lines.append("|---|---|---|---|---|---|")
    lines += [
        f"| {item.claim.where} | {item.claim.statement} | {_printed(item)} | {_formula(item)} | "
        f"{show_values(item.value, item.claim.unit)} | **{item.verdict}** |"
        for item in result.results
    ]
    lines += ["", "## Why", ""]
    for item in result.results:
        lines.append(
            f"* **{item.claim.statement}** ({item.verdict}): {item.claim.why}." + _extra(item)
        )
    if result.prototype is not None:
        lines += prototype_markdown(result.prototype)
    lines += ["", "## The paper's design procedure", ""]
    lines += [f"* {sentence}" for sentence in design_sentences(result.design)]
    lines += ["", "## Errata of the paper", "", "| equation | printed | corrected | why |"]
    lines.append("|---|---|---|---|")
    lines += [
        f"| {one.equation} | {_cell(one.printed)} | {_cell(one.corrected)} | {one.why} |"
        for one in result.errata
    ]
    return "\n".join([*lines, ""])


def design_sentences(design: Design) -> list[str]:
    """What the procedure of section 3.1 yields step by step, then its contradictions."""
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


def _printed(item: ClaimResult) -> str:
    sign = {"equals": "", "above": "> ", "at_least": "≥ ", "at_most": "≤ "}[item.claim.relation]
    return sign + show_values(item.claim.printed, item.claim.unit)


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
    from squeezefilm.report.claims.figures import reproduction_figures

    tell = progress or (lambda _: None)
    figures = []
    for title, svg in reproduction_figures(tell):
        figures.append(
            f"<section><h2>{html.escape(title)}</h2>"
            f'<figure><div class="scroll" tabindex="0">{svg}</div></figure></section>'
        )
    if result.prototype is not None:
        tell("the prototype")
        figures += prototype_sections(result.prototype)
    page = _page(result, figures)
    files = {"claims.json": json_text(result.summary()), "reproduction.html": page}
    write_folder(folder, files)
    return folder / "reproduction.html"


def _page(result: Reproduction, figures: list[str]) -> str:
    rows = "\n".join(
        html_row(
            (
                item.claim.where,
                item.claim.statement,
                _printed(item),
                _formula(item),
                show_values(item.value, item.claim.unit),
                item.verdict,
                item.claim.why,
            )
        )
        for item in result.results
    )
    errata = "\n".join(
        html_row((one.equation, one.printed, one.corrected, one.why)) for one in result.errata
    )
    design = "".join(f"<li>{html.escape(one)}</li>" for one in design_sentences(result.design))
    return f"""<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>The paper's claims, recomputed</title>
<style>{STYLE}</style></head><body><header>
<h1>The paper's claims, recomputed</h1>
<p>Source: Biet, Giraud, Lemaire-Semail, <em>The implementation of tactile feedback using squeeze
film effect devices</em>. Friction against amplitude is not validated against measurements.</p>
</header><main><section><h2>Claims</h2>
<div class="scroll" tabindex="0"><table><thead><tr><th>where</th><th>claim</th><th>printed</th>
<th>printed formula</th><th>recomputed</th><th>verdict</th><th>why</th></tr></thead>
<tbody>{rows}</tbody></table></div></section>
{"".join(figures)}
<section><h2>The paper's design procedure</h2><ul>{design}</ul></section>
<section><h2>Errata</h2>
<div class="scroll" tabindex="0"><table><thead><tr><th>equation</th><th>printed</th>
<th>corrected</th>
<th>why</th></tr></thead><tbody>{errata}</tbody></table></div></section></main></body></html>
"""
