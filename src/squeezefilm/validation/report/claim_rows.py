"""Published directions of friction, model by model, and what each verdict means, as tables."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from squeezefilm.core import quantities as si
from squeezefilm.design.analysis.published_claims import MEANINGS, missed_by
from squeezefilm.design.analysis.report.model_rows import cited, missed_directions
from squeezefilm.validation.command import ClaimResult
from squeezefilm.validation.frozen import MODELS, WORDS
from squeezefilm.validation.report.prototype import Table

DIRECTIONS = ("where", "direction", "model", "bound", "found", "verdict")
_SIGNS = {"equals": "", "above": "> ", "at_least": "≥ ", "at_most": "≤ ", "within": "within "}


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
            show_values(item.value, item.claim.unit),
            item.verdict,
        )
        for items in directions(results)
        for item in items
    ]
    return DIRECTIONS, rows


def model_sentences() -> list[str]:
    """The models that directions are asked of, each in a sentence."""
    return [f"{name}: {WORDS[kind]}." for name, kind in MODELS.items()]


def missed_lists() -> list[tuple[str, list[str]]]:
    """Each model with the measured directions that it misses, by the verdicts on record."""
    return [(name, missed_directions(name, why=True)) for name in MODELS if missed_by(name)]


def verdict_table(results: Iterable[ClaimResult]) -> Table:
    """Each verdict that was given: how often, and what it says."""
    counts = Counter(item.verdict for item in results)
    rows = [(name, str(counts[name]), said) for name, said in MEANINGS.items() if counts[name]]
    return ("verdict", "claims", "what it says"), rows
