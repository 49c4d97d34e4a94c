"""The points of a sweep, made and checked before anything is computed.

Samples in place of a grid: points drawn in ranges, together one axis of a sweep.

actuator.thickness=1 mm..3 mm            uniform between the ends
voltage=1 V..100 V:log                   uniform in the logarithm

They are the first points of a scrambled Sobol sequence (Sobol 1967, Owen 1998), which fill the
space more evenly than chance; with the same seed and ranges more samples begin with the same ones.
"""

from __future__ import annotations

import functools
import itertools
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import SWEEP_POINTS, require_within
from squeezefilm.design.sweep.answers import (
    FOLLOWED,
    OPTIONS,
    VERBS,
    AskedNumber,
    VerbOption,
    asked_for,
)
from squeezefilm.design.sweep.axes import (
    DISPLAY,
    Axis,
    axes_of,
    quantity_of_text,
    require_each_once,
    what_is_varied,
)
from squeezefilm.design.sweep.points import Point
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.uncertainty.parameters import value_at, with_values
from squeezefilm.physics.uncertainty.uncertainty import SAMPLES

_RANGE = re.compile(r"(?P<first>[^:]+?)\.\.(?P<last>[^:]+?)\s*(?::\s*(?P<log>log))?\s*")


@dataclass(frozen=True)
class SampledAxes:
    """Axes of a sampled sweep: the samples' axis, if there are ranges, and the rest as given."""

    axes: tuple[Axis, ...]
    others: Mapping[str, Any] | Sequence[str]


@dataclass(frozen=True)
class _DrawnRange:
    """A range: its ends (SI), whether it is drawn in its logarithm, whether in whole numbers."""

    name: str
    unit: si.Unit
    option: VerbOption | None
    first: float
    last: float
    logarithmic: bool
    whole: bool

    def values(self, shares: si.FloatArray) -> list[float]:
        """The values at shares of the range, from 0 to 1."""
        low, high = self.first, self.last
        if self.whole:
            drawn = np.floor(low + shares * (high - low + 1))
        elif self.logarithmic:
            drawn = low * (high / low) ** shares
        else:
            drawn = low + shares * (high - low)
        values = [float(f"{value:.12g}") for value in drawn.tolist()]
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
    ranges: dict[int, _DrawnRange] = {}
    for number, (name, values) in enumerate(pairs):
        match = _RANGE.fullmatch(values) if isinstance(values, str) else None
        if match is not None:
            ranges[number] = _range(name, match, display)
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


def _axis(ranges: Sequence[_DrawnRange], count: int, seed: int) -> Axis:
    from scipy.stats import qmc

    # Whole powers of two, of which the first are taken: a sequence has no other beginning.
    shares = qmc.Sobol(len(ranges), scramble=True, rng=seed).random_base2(
        math.ceil(math.log2(max(count, 2)))
    )[:count]
    columns = [axis.values(shares[:, k]) for k, axis in enumerate(ranges)]
    return Axis(
        tuple(axis.name for axis in ranges),
        tuple(axis.unit for axis in ranges),
        tuple(zip(*columns, strict=True)),
        sampled=tuple("log" if axis.logarithmic else "linear" for axis in ranges),
    )


def _range(name: str, match: re.Match[str], display: Display) -> _DrawnRange:
    option, unit, whole = what_is_varied(name, display)
    if unit is None:
        raise InputError(f"{name} takes words, which have no range; name them with commas between")
    ends = (match[end].strip() for end in ("first", "last"))
    low, high = sorted(quantity_of_text(name, end, unit) for end in ends)
    if low == high or (match["log"] and low <= 0):
        raise InputError(
            f"{name} from {match['first'].strip()} to {match['last'].strip()} is no range to draw "
            f"in; give two ends{', above 0 for a logarithm' if match['log'] else ''}"
        )
    return _DrawnRange(name, unit, option, low, high, match["log"] is not None, whole)


def plan_of(
    display: Display | Sequence[Display | str | Path],
    vary: Mapping[str, Any] | Sequence[str],
    ask: Sequence[str] | str,
    over: str | Path | None,
    sample: tuple[int | None, int] = (None, 0),
) -> Plan:
    """The points of a sweep, all checked; `sample` is how many to draw in ranges, and the seed.

    Raises `InputError` for what cannot be asked."""
    given = [display] if isinstance(display, Display) else display
    displays = [item if isinstance(item, Display) else load_display(item) for item in given]
    if not displays:
        raise InputError("there is no display to sweep; name at least one")
    asked = asked_for([ask] if isinstance(ask, str) else ask)
    varied = axes_of_ranges(displays[0], vary, *sample)
    axes = (*varied.axes, *axes_of(displays[0], varied.others, over))
    require_each_once(axes)
    if varied.axes and any(answer.verb == FOLLOWED for answer in asked):
        raise InputError("modes are followed over a grid, not over samples; give ranges steps")
    if len(displays) > 1:
        labels = tuple((name,) for name in told_apart(displays))
        axes = (Axis((DISPLAY,), (None,), labels), *axes)
    if not axes:
        raise InputError(
            'a sweep varies something; give vary = "voltage=5 V..30 V:6", a file `over`, or '
            "several displays"
        )
    count = math.prod(len(axis) for axis in axes)
    require_within(SWEEP_POINTS, count, "points of the sweep")
    _check_options(axes, asked, displays)
    return Plan(tuple(displays), axes, asked)


def told_apart(displays: Sequence[Display]) -> list[str]:
    """The names of displays, numbered where two have the same."""
    names = [display.name for display in displays]
    return [
        name if names.count(name) == 1 else f"{name} ({number})"
        for number, name in enumerate(names, 1)
    ]


def _check_options(
    axes: Sequence[Axis], asked: Sequence[AskedNumber], displays: Sequence[Display]
) -> None:
    """Refuse options that mean nothing to what is asked, before anything is computed."""
    verbs = [VERBS[name] for name in dict.fromkeys(answer.verb for answer in asked)]
    options = [name for axis in axes for name in axis.names if name in OPTIONS]
    for name in options:
        strangers = [verb.name for verb in verbs if not verb.knows(name)]
        applies = {"voltage", "ambient_pressure"} | {o for v in verbs for o in v.takes}
        if strangers or name not in applies:
            whose = " and ".join(strangers or [verb.name for verb in verbs])
            takers = ", ".join(verb.name for verb in VERBS.values() if name in verb.takes)
            raise InputError(
                f"{name} does not go with what is asked of {whose}; it goes with {takers}: ask "
                f"for numbers of these, as in ask = {takers.split(', ')[0]}.NAME",
                quantity="vary",
            )
    if {"voltage", "vibration_amplitude"} <= set(options):
        raise InputError("a voltage and an amplitude are both varied; vary one of them")
    if any(answer.verb == "render" for answer in asked) and "texture" not in options:
        raise InputError(
            'what is asked of render needs a texture; give vary = "texture=sine-3mm"',
            quantity="vary",
        )
    for axis in axes:
        for number in (k for k, name in enumerate(axis.names) if name == "surface"):
            for display, step in itertools.product(displays, axis.steps):
                display.surface(str(step[number]))


@dataclass(frozen=True, eq=False)
class Plan:
    """The points of a sweep and what is asked of each."""

    displays: tuple[Display, ...]
    axes: tuple[Axis, ...]
    asked: tuple[AskedNumber, ...]

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of steps that each axis has."""
        return tuple(len(axis) for axis in self.axes)

    @functools.cached_property
    def verbs(self) -> tuple[str, ...]:
        """The verbs that are asked, the quickest first; `analyze` says what `predict` says."""
        wanted = {answer.verb for answer in self.asked}
        return tuple(v for v in VERBS if v in wanted and not (v == "predict" and self._whole))

    @functools.cached_property
    def _whole(self) -> bool:
        return any(answer.verb == "analyze" for answer in self.asked)

    def verb_of(self, asked: AskedNumber) -> str:
        """The verb that answers it here."""
        return "analyze" if self._whole and asked.verb == "predict" else asked.verb

    @functools.cached_property
    def points(self) -> tuple[tuple[dict[str, Point], str], ...]:
        """Question of each point to each verb, and the reason why it has none.

        Raises `InputError` where none of them can be: the first reason.
        """
        made = [self._point(step) for step in itertools.product(*(a.steps for a in self.axes))]
        if all(reason for _, reason in made):
            raise InputError(f"no point of the sweep can be computed: {made[0][1]}")
        return tuple(made)

    def _point(self, step: tuple[tuple[Any, ...], ...]) -> tuple[dict[str, Point], str]:
        display, options, values = self.displays[0], {}, {}
        for axis, row in zip(self.axes, step, strict=True):
            for name, value in zip(axis.names, row, strict=True):
                if name == DISPLAY:
                    display = self.displays[axis.steps.index(row)]
                elif name in OPTIONS:
                    options[name] = value
                else:
                    values[name] = value
        try:
            display = with_values(display, values) if values else display
        except InputError as error:
            return {}, str(error)
        draws = SAMPLES if any(answer.draws for answer in self.asked) else 0
        return {verb: Point(display, options, verb, draws) for verb in self.verbs}, ""

    def begin(self) -> int:
        """The number of the point nearest to the display's own values, where following begins."""
        nearest = []
        for axis in self.axes:
            numbers, own = axis.numbers, None
            if numbers is not None and axis.names[0] not in OPTIONS:
                own = value_at(self.displays[0], axis.names[0])[0]
            nearest.append(
                0 if own is None or numbers is None else int(np.argmin(np.abs(numbers - own)))
            )
        return int(np.ravel_multi_index(nearest, self.shape))
