"""What a value that nobody measured does to an actuator's answers: it is moved, one at a time."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.physics.uncertainty.parameters import unit_at, with_values

MOVED: si.Dimensionless = 0.2
"""A value without a range of its own is moved by so much of it, both ways (tried, not a range)."""

_Described = TypeVar("_Described")


@dataclass(frozen=True)
class Effect:
    """One value moved to both sides: its dotted path, its values and what the answers become.

    `is_range` says that the description gives the two ends (its 5 and 95 % quantiles); otherwise
    they are `MOVED` to either side. `answers` are by name at the lower and the upper value, NaN
    where the actuator cannot work so.
    """

    path: str
    source: str
    unit: str
    nominal: float
    low: float
    high: float
    is_range: bool
    answers: Mapping[str, tuple[float, float]]


def effects(
    described: _Described,
    provenance: Mapping[str, Provenance],
    answers: Callable[[_Described], Mapping[str, float]],
    tried: Callable[[str], bool],
) -> tuple[Effect, ...]:
    """What each value does that has a range of its own, or is assumed and `tried` (by its path), as
    `answers` finds it of the description with that one value changed. Names and whole numbers are
    left out."""
    found = []
    for path, nominal, origin in _uncertain(described, provenance):
        if origin.distribution is None and not tried(path):
            continue
        if origin.distribution is None:
            ends = nominal * (1 - MOVED), nominal * (1 + MOVED)
        else:
            low, high = origin.distribution.quantile(np.array([0.05, 0.95]))
            ends = float(low), float(high)
        there = [_answered(described, path, end, answers) for end in ends]
        names = there[0] | there[1]
        found.append(
            Effect(
                path,
                origin.source,
                unit_at(described, path)[0].symbol,
                nominal,
                *ends,
                origin.distribution is not None,
                {one: (there[0].get(one, np.nan), there[1].get(one, np.nan)) for one in names},
            )
        )
    return tuple(found)


def _uncertain(
    described: object, provenance: Mapping[str, Provenance]
) -> Iterator[tuple[str, float, Provenance]]:
    for path, origin in provenance.items():
        if origin.evidence != "assumed" and origin.distribution is None:
            continue
        value: object = described
        for part in path.split("."):
            value = value[int(part)] if isinstance(value, tuple) else getattr(value, part, None)
        if isinstance(value, float) and value != 0:
            yield path, value, origin


def _answered(
    described: _Described,
    path: str,
    value: float,
    answers: Callable[[_Described], Mapping[str, float]],
) -> dict[str, float]:
    try:
        return dict(answers(with_values(described, {path: value})))
    except SqueezefilmError:
        return {}
