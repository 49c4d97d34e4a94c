"""What the terminal shows of `reproduce`: claims, directions model by model, why, the errata."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from squeezefilm.core import quantities as si
from squeezefilm.core.kit.numbers import shown
from squeezefilm.core.kit.terminal import bullets, heading, plain_console, table
from squeezefilm.validation.report.directions import (
    directions,
    model_sentences,
    plain_claims,
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
_SIGNS = {"above": "> ", "at_least": "≥ ", "at_most": "≤ ", "within": "within "}


def show_claims(result: Reproduction) -> None:
    """Print every published claim: printed, recomputed, verdict; the directions of friction in
    every model; then where and why; the errata; what the verdicts mean."""
    console = plain_console()
    plain, asked = plain_claims(result.results), directions(result.results)
    table(
        console,
        ("claim", "printed", "as printed", "recomputed", "verdict"),
        [_claim_row(item) for item in plain],
        fixed=(0,),
        styles=_style,
    )
    if asked:
        heading(console, "Directions of friction that others observed, at one frozen set of values")
        bullets(console, [("", text, "") for text in model_sentences()])
        rows = [_direction_row(item, first=item is items[0]) for items in asked for item in items]
        names = ("direction", "model", "bound", "found", "verdict")
        table(console, names, rows, fixed=(0, 1), styles=_style)
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
            (one.equation, f"{one.printed}  must be  {one.corrected}: {one.why}", "")
            for one in result.errata
        ]
        bullets(console, errata)
    head, counted = verdict_table(result.results)
    heading(console, f"{len(result.results)} claims, and what their verdicts say")
    table(console, head, counted, fixed=(1,), styles=lambda row: _VERDICT_STYLES.get(row[0], ""))


def _style(row: Sequence[str]) -> str:
    return _VERDICT_STYLES.get(row[-1], "")


def _claim_row(item: ClaimResult) -> tuple[str, ...]:
    claim, formula = item.claim, item.printed_formula_value
    return (
        claim.id,
        _values(claim.printed, claim.unit, _SIGNS.get(claim.relation, "")) or "not compared",
        "–" if formula is None else _values(formula, claim.unit),
        _values(item.value, claim.unit),
        item.verdict,
    )


def _direction_row(item: ClaimResult, *, first: bool) -> tuple[str, ...]:
    claim = item.claim
    return (
        claim.id if first else "",
        claim.model,
        _values(
            claim.printed[: None if claim.relation == "within" else 1],
            claim.unit,
            _SIGNS.get(claim.relation, ""),
        ),
        "\n".join(f"{value:.2g}" for value in item.value),
        item.verdict,
    )


def _reasons(item: ClaimResult) -> list[str]:
    return [f"why: {item.claim.why}", *([item.note] if item.note else [])]


def _say(console: Console, texts: Iterable[str]) -> None:
    bullets(console, [("", text, "") for text in texts])


def _values(values: Iterable[float], unit: str, sign: str = "") -> str:
    return "\n".join(sign + shown(value, si.Unit(unit)) for value in values)
