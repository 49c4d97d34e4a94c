"""Terminal output of `reproduce`: claims, directions model by model, why, the errata."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from squeezefilm.core.kit.terminal import bullets, heading, plain_console, table
from squeezefilm.validation.report.published import (
    direction_table,
    directions,
    model_sentences,
    plain_claims,
    show_printed,
    show_values,
    verdict_table,
)

if TYPE_CHECKING:
    from rich.console import Console

    from squeezefilm.validation.command import ClaimResult, Reproduction

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
    console = plain_console()
    plain, asked = plain_claims(result.results), directions(result.results)
    columns = ("claim", "printed", "as printed", "recomputed", "verdict")
    table(console, columns, [_claim_row(item) for item in plain], fixed=(0,), styles=_style)
    if asked:
        heading(console, "Directions of friction that others observed, at one frozen set of values")
        _say(console, model_sentences())
        head, rows = direction_table(result.results)
        names = [item.claim.id if item is items[0] else "" for items in asked for item in items]
        named = [(name, *row[2:]) for name, row in zip(names, rows, strict=True)]
        table(console, head[1:], named, fixed=(0, 1), styles=_style)
    heading(console, "Where and why")
    for item in plain:
        heading(console, f"{item.claim.id}: {item.verdict}")
        _say(console, [f"{item.claim.where}: {item.claim.statement}", *_reasons(item)])
    for items in asked:
        claim = items[0].claim
        heading(console, claim.id)
        _say(console, [f"{claim.where}: {claim.statement}"])
        for item in items:
            _say(console, [f"{item.claim.model}: {item.verdict}", *_reasons(item)])
    if result.errata:
        heading(console, "Errata of the paper")
        errata = [
            (
                erratum.equation,
                f"{erratum.printed}  must be  {erratum.corrected}: {erratum.why}",
                "",
            )
            for erratum in result.errata
        ]
        bullets(console, errata)
    head, counted = verdict_table(result.results)
    heading(console, f"{len(result.results)} claims, and what their verdicts say")
    table(console, head, counted, fixed=(1,), styles=lambda row: _VERDICT_STYLES.get(row[0], ""))


def _style(row: Sequence[str]) -> str:
    return _VERDICT_STYLES.get(row[-1], "")


def _claim_row(item: ClaimResult) -> tuple[str, ...]:
    unit = item.claim.unit
    printed_formula = show_values(item.found.printed_formula_value, unit)
    return (
        item.claim.id,
        show_printed(item),
        printed_formula,
        show_values(item.found.value, unit),
        item.verdict,
    )


def _reasons(item: ClaimResult) -> list[str]:
    return [f"why: {item.claim.why}", *([item.found.note] if item.found.note else [])]


def _say(console: Console, texts: Iterable[str]) -> None:
    bullets(console, [("", text, "") for text in texts])
