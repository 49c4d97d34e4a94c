"""Samples in place of a grid: points drawn in ranges, together one axis of a sweep.

actuator.thickness=1 mm..3 mm            uniform between the ends
voltage=1 V..100 V:log                   uniform in the logarithm

They are the first points of a scrambled Sobol sequence (Sobol 1967, Owen 1998), which fill the
space more evenly than chance; with the same seed and ranges more samples begin with the same ones.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import SWEEP_POINTS, require_within
from squeezefilm.design.sweep.axes import Axis, quantity_of_text, what_is_varied
from squeezefilm.design.sweep.options import Option
from squeezefilm.physics.display import Display

_RANGE = re.compile(r"(?P<first>[^:]+?)\.\.(?P<last>[^:]+?)\s*(?::\s*(?P<log>log))?\s*")


@dataclass(frozen=True)
class SampledAxes:
    """What is varied: the samples' axis, if there are ranges, and what is left as it was given."""

    axes: tuple[Axis, ...]
    others: Mapping[str, Any] | Sequence[str]


@dataclass(frozen=True)
class _Range:
    """One range: its ends (SI), whether it is drawn in its logarithm, whether in whole numbers."""

    name: str
    unit: si.Unit
    option: Option | None
    first: float
    last: float
    logarithmic: bool
    whole: bool

    def values(self, shares: si.FloatArray) -> list[float]:
        """The values at shares of the range, from 0 to 1."""
        low, high = self.first, self.last
        if self.whole:
            found = np.floor(low + shares * (high - low + 1))
        elif self.logarithmic:
            found = low * (high / low) ** shares
        else:
            found = low + shares * (high - low)
        values = [float(f"{one:.12g}") for one in found.tolist()]
        if self.whole:
            return [int(value) for value in values]
        return values if self.option is None else [self.option.number(value) for value in values]


def axes_of_ranges(
    display: Display, vary: Mapping[str, Any] | Sequence[str], count: int | None, seed: int
) -> SampledAxes:
    """The axis of `count` samples in those of `vary` that are ranges without steps.

    Raises `InputError` for samples without a range, a count or a seed that is none, and for ends
    that are no range.
    """
    if count is None:
        return SampledAxes((), vary)
    require_within(SWEEP_POINTS, count, "samples")
    si.require("seed", seed, at_least=0)
    if isinstance(vary, str):
        vary = [vary]
    pairs = (
        list(vary.items())
        if isinstance(vary, Mapping)
        else [(text.partition("=")[0].strip(), text.partition("=")[2].strip()) for text in vary]
    )
    ranges: dict[int, _Range] = {}
    for number, (name, values) in enumerate(pairs):
        found = _RANGE.fullmatch(values) if isinstance(values, str) else None
        if found is not None:
            ranges[number] = _range(name, found, display)
    if not ranges:
        raise InputError(
            'samples are drawn in ranges, and none is given; give vary = "actuator.thickness='
            '1 mm..3 mm", without a number of steps',
            quantity="sample",
        )
    others: Mapping[str, Any] | Sequence[str]
    if isinstance(vary, Mapping):
        others = {name: values for k, (name, values) in enumerate(pairs) if k not in ranges}
    else:
        others = [text for k, text in enumerate(vary) if k not in ranges]
    return SampledAxes((_axis(list(ranges.values()), count, seed),), others)


def _axis(ranges: Sequence[_Range], count: int, seed: int) -> Axis:
    from scipy.stats import qmc

    # Whole powers of two, of which the first are taken: a sequence has no other beginning.
    shares = qmc.Sobol(len(ranges), scramble=True, rng=seed).random_base2(
        math.ceil(math.log2(max(count, 2)))
    )[:count]
    columns = [one.values(shares[:, k]) for k, one in enumerate(ranges)]
    return Axis(
        tuple(one.name for one in ranges),
        tuple(one.unit for one in ranges),
        tuple(zip(*columns, strict=True)),
        sampled=tuple("log" if one.logarithmic else "linear" for one in ranges),
    )


def _range(name: str, found: re.Match[str], display: Display) -> _Range:
    option, unit, whole = what_is_varied(name, display)
    if unit is None:
        raise InputError(f"{name} takes words, which have no range; name them with commas between")
    ends = (found[end].strip() for end in ("first", "last"))
    low, high = sorted(quantity_of_text(name, end, unit) for end in ends)
    if low == high or (found["log"] and low <= 0):
        raise InputError(
            f"{name} from {found['first'].strip()} to {found['last'].strip()} is no range to draw "
            f"in; give two ends{', above 0 for a logarithm' if found['log'] else ''}"
        )
    return _Range(name, unit, option, low, high, found["log"] is not None, whole)
