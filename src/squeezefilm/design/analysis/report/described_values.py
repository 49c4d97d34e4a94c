"""Every value of a display's description, for people: with its unit, its source, its evidence."""

from __future__ import annotations

from dataclasses import dataclass

from squeezefilm.core import quantities as si
from squeezefilm.core.config.schema import leaves
from squeezefilm.core.kit.numbers import dotted, shown
from squeezefilm.physics.display import Display


@dataclass(frozen=True)
class Value:
    """One value of a display's description: its path, its text, where it is from."""

    path: str
    text: str
    source: str
    evidence: str


def display_values(display: Display) -> list[Value]:
    """Every value of a display with its unit, its source and the evidence behind it.

    Members of lists are counted from 1, as the messages of `core.config.load` count them.
    """
    rows = []
    for path, value, hint, _ in leaves(display):
        unit = si.unit_of(hint)
        origin = display.provenance.get(".".join(str(part) for part in path))
        if isinstance(value, float | int) and not isinstance(value, bool):
            text = shown(value, unit, 6) if unit is not None else f"{value}"
        else:
            text = str(value)
        source, evidence = ("", "") if origin is None else (origin.source, origin.evidence)
        rows.append(Value(dotted(path), text, source, evidence))
    return rows
