"""What each value that nobody measured does, as rows of a table."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from squeezefilm.actuators.analysis.effects import MOVED, Effect
from squeezefilm.core import quantities as si
from squeezefilm.core.kit.numbers import changed, shown

# Changes below this are called none.
_NOTHING = 1e-3


def effect_head(answers: Mapping[str, str]) -> tuple[str, ...]:
    """The head of `effect_rows`: the value, where it was moved to, and each answer in words."""
    return ("value", "moved to", *answers.values())


def effect_rows(
    found: Iterable[Effect], nominal: Mapping[str, float], answers: Mapping[str, str]
) -> list[tuple[str, ...]]:
    """A row for each value that does anything: its path, its two ends, and by how much each answer
    (its name, in words) changes to either side; the strongest first."""
    rows = []
    for one in found:
        ends = tuple(shown(end, si.Unit(one.unit)) for end in (one.low, one.high))
        shares = {
            name: tuple(end / nominal[name] - 1 for end in one.answers.get(name, (np.nan,) * 2))
            for name in answers
        }
        most = max((abs(x) for pair in shares.values() for x in pair if np.isfinite(x)), default=0)
        cannot = any(not np.isfinite(x) for pair in shares.values() for x in pair)
        if most < _NOTHING and not cannot:
            continue
        cells = ("; ".join(_said(x) for x in pair) for pair in shares.values())
        row = (one.path.split(".", 1)[-1].replace("_", " "), "; ".join(ends), *cells)
        rows.append((np.inf if cannot else most, row))
    return [row for _, row in sorted(rows, key=lambda one: -one[0])]


def _said(share: float) -> str:
    return changed(share) if np.isfinite(share) else "does not work"


EFFECTS = (
    f"Each value that is assumed is moved by {si.percent(MOVED)} to both sides, or to the ends of "
    "its range where the file gives one; the others stay. This tells which of them to measure "
    "first. It is no interval: nobody knows how far off they are."
)
"""What stands over the rows."""
