"""Sweeps: points, made and checked before anything is computed, and what verbs answer at each."""

from __future__ import annotations

import functools
import itertools
import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.called_with import called_with
from squeezefilm.core.errors import InputError, WorkersError
from squeezefilm.core.hard_limits import SWEEP_POINTS, require_within
from squeezefilm.core.progress import SayProgress, about
from squeezefilm.core.results import config_hash, stamp
from squeezefilm.design.sweep.answers import FOLLOWED, OPTIONS, VERBS, AskedNumber, asked_for
from squeezefilm.design.sweep.axes import DISPLAY, Axis, axes_of
from squeezefilm.design.sweep.followed import FollowedMode, followed_modes
from squeezefilm.design.sweep.points import Answer, KeptAnswers, Point, address, answer_of
from squeezefilm.design.sweep.swept import NOT_YET, Sweep, SweptColumn, counted
from squeezefilm.design.sweep.tasks import NoAnswer
from squeezefilm.design.sweep.workers import workers
from squeezefilm.physics.display import Display, NamedDisplay, load_display
from squeezefilm.physics.uncertainty.parameters import value_at, with_values
from squeezefilm.physics.uncertainty.uncertainty import SAMPLES


@si.checked_numbers
@dataclass(frozen=True)
class SweepRequest:
    """Arguments of `sweep`."""

    display: NamedDisplay | Sequence[Display | str | Path]
    _: KW_ONLY
    vary: Mapping[str, Any] | Sequence[str] = ()
    ask: Sequence[str] | str = ()
    over: str | Path | None = None
    sample: Annotated[int, si.AtLeast(1)] | None = None
    seed: int = 0
    jobs: Annotated[int, si.AtLeast(1)] = 1
    scheduler: str | None = None
    out: str | Path | None = None
    fresh: bool = False
    progress: SayProgress | None = None


@reads_text
@called_with(SweepRequest)
def sweep(asked: SweepRequest) -> Sweep:
    """The numbers that verbs say of a display, at every point of a grid or of a file.

    Args:
        display: what is swept: a display, or several, which are then an axis of their own.
        vary: values by name, ``{"actuator.thickness": "1 mm..3 mm:9"}``: any path of a number in
            the display, or an operating option; see `design.sweep.axes`. Several make a grid.
        ask: names of numbers in the JSON of predict, render, plate, friction and analyze; the
            quickest verb that knows a name is asked. ``followed`` follows modes by their shapes.
        over: a CSV file whose header names what is varied, a point in each row.
        sample: how many points to draw in the ranges of `vary` without steps (``"1 mm..3 mm"``,
            ``"1 V..100 V:log"``), see `design.sweep.axes`; more of them keep those before.
        seed: of the samples.
        jobs: processes; more than one in a script needs ``if __name__ == "__main__":``.
        scheduler: a Dask cluster's, ``"tcp://host:8786"``; its workers answer in place of `jobs`.
        out: a folder that keeps every answer as it comes, and has those of before.
        fresh: compute again what the folder has.
        progress: is told how many points are done, and how long the rest takes.

    A point that cannot be computed is a row with its reason. Raises `InputError` before anything is
    computed for a name that is not known, a value that is none, or a sweep without a point that can
    be.
    """
    run = SweepRun(asked)
    run.finish()
    return run.result()


def plan_of(request: SweepRequest) -> Plan:
    """The points of a sweep, all checked. Raises `InputError` for what cannot be asked."""
    display, ask = request.display, request.ask
    given = [display] if isinstance(display, Display) else display
    displays = [item if isinstance(item, Display) else load_display(item) for item in given]
    if not displays:
        raise InputError("there is no display to sweep; name at least one")
    asked = asked_for([ask] if isinstance(ask, str) else ask)
    axes = axes_of(displays[0], request.vary, request.over, (request.sample, request.seed))
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
        strangers = [verb.name for verb in verbs if name in verb.strange]
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


class SweepRun:
    """A sweep under way: its plan, and the answers that it has."""

    def __init__(self, asked: SweepRequest) -> None:
        self.plan = plan_of(asked)
        self._asked, self._tell = asked, asked.progress or (lambda _: None)
        self._kept = KeptAnswers(None if asked.out is None else Path(asked.out))
        self._found: dict[tuple[int, str], Answer] = {}
        self._before: set[str] = set()
        self._computed = 0

    def finish(self) -> None:
        """Ask what is not known yet. What came is kept where this is interrupted."""
        described: dict[Any, Any] = {}
        waiting: dict[str, list[tuple[int, str]]] = {}
        points: dict[str, Point] = {}
        for number, (questions, _) in enumerate(self.plan.points):
            for verb, point in questions.items():
                at = address(point, described)
                known = None if self._asked.fresh else self._kept.get(at)
                if known is not None:
                    self._found[number, verb] = known
                    self._before.add(at)
                elif at in waiting:
                    waiting[at].append((number, verb))
                else:
                    waiting[at] = [(number, verb)]
                    points[at] = point
        began = time.monotonic()
        self._say(0, len(points), began)
        if not points:
            return
        jobs = min(self._asked.jobs, len(points))
        # Equal plates follow each other: one over voltage, force or finger is solved once.
        plates = {at: point.display.actuator for at, point in points.items()}
        tasks = {at: (point,) for at, point in points.items()}
        with workers(jobs, self._asked.scheduler, self._tell) as pool:
            for at, answer in pool.answers(answer_of, tasks, plates):
                if isinstance(answer, NoAnswer):
                    answer = Answer({}, reason=answer.reason, lasting=answer.lasting)
                self._kept.add(at, points[at], answer)
                self._found.update(dict.fromkeys(waiting[at], answer))
                self._computed += 1
                self._say(self._computed, len(points), began)

    def _say(self, done: int, of: int, began: float) -> None:
        """Tell how far it is, and how long the rest takes if it goes on like this."""
        if not of:
            return
        left = ""
        if 0 < done < of:
            seconds = (time.monotonic() - began) / done * (of - done)
            left = f", {about(seconds)} left"
        self._tell(f"{done} of {of} points" + left)

    def result(self) -> Sweep:
        """The table of the answers there are."""
        plan, answers = self.plan, self._found.values()
        reasons = tuple(self._reason(k) for k in range(len(plan.points)))
        follows: tuple[FollowedMode, ...] = ()
        if any(number.verb == FOLLOWED for number in plan.asked):
            follows = followed_modes(self._modes(), plan.shape, plan.begin())
        columns: list[SweptColumn] = []
        for number in plan.asked:
            columns += self._columns(number, follows)
        hashed = [config_hash(display) for display in plan.displays]
        fingers = "; ".join(dict.fromkeys(display.whose_finger for display in plan.displays))
        origin = stamp(None) | {
            "config_sha256": hashed[0] if len(hashed) == 1 else hashed,
            "finger": fingers,
        }
        return Sweep(
            ", ".join(told_apart(plan.displays)),
            plan.verbs,
            plan.axes,
            tuple(columns),
            reasons,
            # Texts that differ in their numbers only are told once.
            counted(text for answer in answers for text in dict.fromkeys(answer.warnings)),
            self._computed,
            len(self._before),
            origin,
            follows,
        )

    def _reason(self, number: int) -> str:
        questions, refused = self.plan.points[number]
        if refused:
            return refused
        answers = [self._found.get((number, verb)) for verb in questions]
        said = [answer.reason for answer in answers if answer is not None and answer.reason]
        if said:
            return "; ".join(dict.fromkeys(said))
        return NOT_YET if None in answers else ""

    def _columns(
        self, asked: AskedNumber, follows: Sequence[FollowedMode]
    ) -> Iterator[SweptColumn]:
        every = range(len(self.plan.points))
        if asked.verb == FOLLOWED:
            quantity = asked.key.rpartition(".")[2]
            for mode in follows:
                if not mode.driven and quantity != "frequency_Hz" and quantity != "quality_factor":
                    continue  # nothing drives it anywhere: a column of nothing
                name = f"{FOLLOWED}.{mode.label}.{quantity}"
                yield SweptColumn(name, asked.unit, mode.values(self._modes(), quantity))
            return
        verb = self.plan.verb_of(asked)
        answers = [self._found.get((number, verb)) for number in every]
        values = [math.nan if a is None else a.numbers.get(asked.key, math.nan) for a in answers]
        yield SweptColumn(asked.column, asked.unit, np.array(values))

    def _modes(self) -> list[Any]:
        """Modes that the points tell of; None where they say nothing."""
        answers = [self._found.get((k, FOLLOWED)) for k in range(len(self.plan.points))]
        return [None if answer is None else answer.modes for answer in answers]


def sweep_until_stopped(asked: SweepRequest) -> tuple[Sweep, str]:
    """A sweep that Ctrl-C or the end of a cluster stops, with what was computed until then, and
    what stopped it (empty where nothing did). Raises as `sweep`."""
    run = SweepRun(asked)
    stopped = ""
    try:
        run.finish()
    except KeyboardInterrupt:
        stopped = "stopped"
    except WorkersError as error:
        stopped = str(error)
    return run.result(), stopped
