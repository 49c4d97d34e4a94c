"""Output of `reproduce`: its terminal lines, the page of validation, its report with figures."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from html import escape
from pathlib import Path

from squeezefilm.core import quantities as si
from squeezefilm.core.kit import style
from squeezefilm.core.kit.folder import checkout, json_text, markdown_table, write_folder
from squeezefilm.core.kit.page_style import as_html, html_table, page, section, stamped
from squeezefilm.core.kit.terminal import bullets, heading, table
from squeezefilm.core.results import write_whole
from squeezefilm.design.analysis.paper_procedure import PaperDesign
from squeezefilm.design.analysis.published_claims import MEANINGS, missed_by
from squeezefilm.design.analysis.report.rows import cited, missed_directions
from squeezefilm.validation.command import ClaimResult, Reproduction
from squeezefilm.validation.frozen import MODELS
from squeezefilm.validation.report.prototype import Block, Item, Part, Table, prototype_parts

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

DIRECTIONS = ("where", "direction", "model", "bound", "found", "verdict")
_SIGNS = {"equals": "", "above": "> ", "at_least": "≥ ", "at_most": "≤ ", "within": "within "}
_HEAD = ("where", "claim", "printed", "printed formula", "recomputed", "verdict")


def write_validation_docs(result: Reproduction, root: Path | None = None) -> Path:
    """Write docs/reference/validation.md of a checkout (the package's own, or the one at `root`).

    Raises `InputError` where the package is installed without one.
    """
    path = checkout(root) / "docs" / "reference" / "validation.md"
    write_whole(path, validation_markdown(result))
    return path


def _parts(result: Reproduction) -> Iterator[Part]:
    """Everything but the figures redrawn: claims, directions of friction, prototype, procedure."""
    plain, asked = plain_claims(result.results), directions(result.results)
    yield Part("What the verdicts say", [verdict_table(result.results)])
    claims = [
        (item.claim.where, item.claim.statement, *_found(item), f"**{item.verdict}**")
        for item in plain
    ]
    yield Part("Claims", [(_HEAD, claims)])
    why: list[Item] = [f"**{item.claim.statement}** {_reason(item)}" for item in plain]
    yield Part("Why", [why], level=3)
    if asked:
        head, rows = direction_table(result.results)
        found = head, [(*row[:-1], f"**{row[-1]}**") for row in rows]
        models: list[Item] = [*model_sentences()]
        yield Part("Directions of friction that others observed, model by model", [models, found])
        by_model: list[Item] = [
            (
                f"**{items[0].claim.statement}**",
                [f"{item.claim.model} {_reason(item)}" for item in items],
            )
            for items in asked
        ]
        yield Part("Why, model by model", [by_model], level=3)
        missed: list[Block] = []
        for name, texts in missed_lists():
            missed += [f"`{name}`:", [*texts]]
        yield Part("What measurements say and the models do not", missed)
    if result.prototype is not None:
        yield from prototype_parts(result.prototype)
    yield Part("The paper's design procedure", [design_sentences(result.design)])
    errata = [(e.equation, e.printed, e.corrected, e.why) for e in result.errata]
    yield Part("Errata of the paper", [(("equation", "printed", "corrected", "why"), errata)])


def _reason(item: ClaimResult) -> str:
    """The verdict, why, another reading, and the note, which for a prediction is the prediction."""
    said = [item.found.note] if item.found.note else []
    if item.found.alternative is not None:
        other = show_values(item.found.alternative, item.claim.unit)
        said.insert(0, f"another reading gives {other}")
    more = f" *({'; '.join(said)})*" if said else ""
    return f"({item.verdict}): {item.claim.why}.{more}"


def validation_markdown(result: Reproduction) -> str:
    """The text of the page of validation: a table of all claims, their reasons, the errata."""
    blocks = [_HEADER.strip()]
    for part in _parts(result):
        blocks.append(f"{'#' * part.level} {part.heading}")
        for block in part.blocks:
            if isinstance(block, str):
                blocks.append(block)
            elif isinstance(block, list):
                blocks.append("\n".join(line for item in block for line in _markdown_item(item)))
            elif isinstance(block, tuple):
                head, rows = block
                cells = [[cell.replace("|", "\\|") for cell in row] for row in rows]
                blocks.append("\n".join(markdown_table((head, cells))))
    return "\n\n".join(blocks) + "\n"


def _markdown_item(item: Item) -> list[str]:
    text, below = (item, ()) if isinstance(item, str) else item
    return [f"* {text}", *(f"    * {line}" for line in below)]


def design_sentences(design: PaperDesign) -> list[Item]:
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


def _found(item: ClaimResult) -> tuple[str, str, str]:
    """The printed value, what the printed formula gives, what was recomputed."""
    return show_printed(item), _formula(item), show_values(item.found.value, item.claim.unit)


def _formula(item: ClaimResult) -> str:
    values = item.found.printed_formula_value
    if values is None or values == item.found.value:
        return "–"
    if item.claim.id.startswith("squeeze-number"):
        return " / ".join(f"{value:.4g} 1/m" for value in values)
    return show_values(values, item.claim.unit)


def write_reproduction(
    result: Reproduction, folder: Path, *, progress: Callable[[str], None] | None = None
) -> Path:
    """Write claims.json and reproduction.html with figures 4, 5, 10 and 11 redrawn.

    Returns the page's path. Raises `InputError` where the folder cannot be written to.
    """
    from squeezefilm.validation.report.figures import reproduction_figures

    tell = progress or (lambda _: None)
    summary, title = result.summary(), "The paper's claims, recomputed"
    body = "".join(_html(part) for part in _parts(result))
    for name, svg in reproduction_figures(tell):
        body += section(escape(name), _framed(svg), "figure")
    source = (
        "Source: Biet, Giraud, Lemaire-Semail, <em>The implementation of tactile feedback using "
        "squeeze film effect devices</em>. Published friction against amplitude is compared by "
        "<code>squeezefilm reproduce --data published</code>; the default model is fitted to it."
    )
    foot = stamped(summary["provenance"], "SHA-256 of the claims")
    files = {
        "claims.json": json_text(summary),
        "reproduction.html": page(title, title, source, body, foot, images=""),
    }
    return write_folder(folder, files)


def _html(part: Part) -> str:
    """A part as a section."""
    parts = []
    for block in part.blocks:
        if isinstance(block, str):
            parts.append(f"<p>{_marked(block)}</p>")
        elif isinstance(block, list):
            parts.append(f"<ul>{''.join(map(_html_item, block))}</ul>")
        elif isinstance(block, tuple):
            head, rows = block
            cells = [[_marked(cell) for cell in row] for row in rows]
            parts.append(html_table(escape(part.heading), map(escape, head), cells, heard=True))
        else:
            parts.append(_framed(style.svg(block(), "drawn", part.heading)))
    return section(escape(part.heading), "".join(parts))


def _html_item(item: Item) -> str:
    if isinstance(item, str):
        return f"<li>{_marked(item)}</li>"
    text, below = item
    return f"<li>{_marked(text)}<ul>{''.join(map(_html_item, below))}</ul></li>"


def _marked(text: str) -> str:
    """Text with Markdown's marks of bold, italic and code as HTML."""
    text = re.sub(r"\*\*(.+?)\*\*", r"<b>\1</b>", as_html(text))
    return re.sub(r"`(.+?)`", r"<code>\1</code>", re.sub(r"\*(\(.+?\))\*", r"<em>\1</em>", text))


def _framed(drawing: str) -> str:
    """A drawing (an SVG element) as a figure that scrolls."""
    return f'<figure><div class="scroll" tabindex="0">{drawing}</div></figure>'


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


def show_claims(result: Reproduction) -> None:
    """Print every published claim: printed, recomputed, verdict; the directions of friction in
    every model; then where and why; the errata; what the verdicts mean."""
    plain, asked = plain_claims(result.results), directions(result.results)
    columns = ("claim", "printed", "as printed", "recomputed", "verdict")
    table(columns, [_claim_row(item) for item in plain], fixed=(0,), styles=_style)
    if asked:
        heading("Directions of friction that others observed, at one frozen set of values")
        _say(model_sentences())
        head, rows = direction_table(result.results)
        names = [item.claim.id if item is items[0] else "" for items in asked for item in items]
        named = [(name, *row[2:]) for name, row in zip(names, rows, strict=True)]
        table(head[1:], named, fixed=(0, 1), styles=_style)
    heading("Where and why")
    for item in plain:
        heading(f"{item.claim.id}: {item.verdict}")
        _say([f"{item.claim.where}: {item.claim.statement}", *_reasons(item)])
    for items in asked:
        claim = items[0].claim
        heading(claim.id)
        _say([f"{claim.where}: {claim.statement}"])
        for item in items:
            _say([f"{item.claim.model}: {item.verdict}", *_reasons(item)])
    if result.errata:
        heading("Errata of the paper")
        errata = [
            (e.equation, f"{e.printed}  must be  {e.corrected}: {e.why}", "") for e in result.errata
        ]
        bullets(errata)
    head, counted = verdict_table(result.results)
    heading(f"{len(result.results)} claims, and what their verdicts say")
    table(head, counted, fixed=(1,), styles=lambda row: _VERDICT_STYLES.get(row[0], ""))


def _style(row: Sequence[str]) -> str:
    return _VERDICT_STYLES.get(row[-1], "")


def _claim_row(item: ClaimResult) -> tuple[str, ...]:
    values = (item.found.printed_formula_value, item.found.value)
    shown = (show_values(value, item.claim.unit) for value in values)
    return item.claim.id, show_printed(item), *shown, item.verdict


def _reasons(item: ClaimResult) -> list[str]:
    return [f"why: {item.claim.why}", *([item.found.note] if item.found.note else [])]


def _say(texts: Iterable[str]) -> None:
    bullets([("", text, "") for text in texts])


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
    return [f"{name}: {words}." for name, words in MODELS.items()]


def missed_lists() -> list[tuple[str, list[str]]]:
    """Each model with the measured directions that it misses, by the verdicts on record."""
    return [(name, missed_directions(name, why=True)) for name in MODELS if missed_by(name)]


def verdict_table(results: Iterable[ClaimResult]) -> Table:
    """Each verdict that was given: how often, and what it says."""
    counts = Counter(item.verdict for item in results)
    rows = [(name, str(counts[name]), said) for name, said in MEANINGS.items() if counts[name]]
    return ("verdict", "claims", "what it says"), rows
