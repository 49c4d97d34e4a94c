"""Sweeps: the same questions asked of a display at every point of a grid, or at those of a file."""

from __future__ import annotations

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
from squeezefilm.core.errors import WorkersError
from squeezefilm.core.progress import SayProgress, about
from squeezefilm.core.results import config_hash, stamp
from squeezefilm.design.sweep.answers import FOLLOWED, AskedNumber
from squeezefilm.design.sweep.followed import FollowedMode, followed_modes
from squeezefilm.design.sweep.plan import plan_of, told_apart
from squeezefilm.design.sweep.points import Answer, KeptAnswers, Point, address, answered
from squeezefilm.design.sweep.swept import NOT_YET, Sweep, SweptColumn, counted
from squeezefilm.design.sweep.workers import workers
from squeezefilm.physics.display import Display, NamedDisplay


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


class SweepRun:
    """A sweep under way: its plan, and the answers that it has."""

    def __init__(self, asked: SweepRequest) -> None:
        self.plan = plan_of(
            asked.display, asked.vary, asked.ask, asked.over, (asked.sample, asked.seed)
        )
        self._asked, self._tell = asked, asked.progress or (lambda _: None)
        self._kept = KeptAnswers(None if asked.out is None else Path(asked.out))
        self._found: dict[tuple[int, str], Answer] = {}
        self._before: set[str] = set()
        self._computed = 0

    def finish(self) -> None:
        """Ask what is not known yet. What came is kept where this is interrupted."""
        described: dict[Any, Any] = {}
        waiting: dict[str, list[tuple[int, str]]] = {}
        points: list[Point] = []
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
                    points.append(point)
        addresses = list(waiting)
        began = time.monotonic()
        self._say(0, len(points), began)
        if not points:
            return
        jobs = min(self._asked.jobs, len(points))
        with workers(jobs, self._asked.scheduler, self._tell) as pool:
            for number, answer in answered(points, pool):
                at = addresses[number]
                self._kept.add(at, points[number], answer)
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
        plan = self.plan
        reasons = tuple(self._reason(k) for k in range(len(plan.points)))
        follows = self._followed()
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
            self._warnings(),
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

    def _followed(self) -> tuple[FollowedMode, ...]:
        if all(number.verb != FOLLOWED for number in self.plan.asked):
            return ()
        return followed_modes(self._modes(), self.plan.shape, self.plan.begin())

    def _warnings(self) -> tuple[tuple[str, int], ...]:
        """Warnings with their counts, texts that differ in their numbers only told once."""
        answers = self._found.values()
        return counted(text for answer in answers for text in dict.fromkeys(answer.warnings))


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
