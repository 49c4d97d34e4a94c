"""The points of a sweep, made and checked before anything is computed."""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import SWEEP_POINTS, require_within
from squeezefilm.design.sweep.answers import FOLLOWED, OPTIONS, VERBS, AskedNumber, asked_for
from squeezefilm.design.sweep.axes import DISPLAY, Axis, axes_of
from squeezefilm.design.sweep.points import Point
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.uncertainty.parameters import value_at, with_values
from squeezefilm.physics.uncertainty.uncertainty import SAMPLES


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
    axes = axes_of(displays[0], vary, over, sample)
    if any(axis.sampled for axis in axes) and any(answer.verb == FOLLOWED for answer in asked):
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
