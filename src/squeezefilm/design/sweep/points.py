"""Points in, answers out: what a sweep asks of those who answer (`design.sweep.workers`)."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.core.kept.store import in_passing
from squeezefilm.design.sweep.answers import numbers_of
from squeezefilm.design.sweep.tasks import Lost, Workers
from squeezefilm.design.sweep.verbs import VERBS
from squeezefilm.physics.display import Display


@dataclass(frozen=True, eq=False)
class Point:
    """One question: a display and operating options, and the verb that is asked; `samples` is the
    base of an interval's samples, 0 for none."""

    display: Display
    options: Mapping[str, Any]
    verb: str
    samples: int = 0


@dataclass(frozen=True, eq=False)
class Answer:
    """What a verb said of a point: its numbers by dotted key, its warnings, what it took (s), and
    where it refused, the reason. `lasting` is an answer that would be the same another time;
    `modes` are those to be followed, with their motions."""

    numbers: Mapping[str, float]
    warnings: tuple[str, ...] = ()
    reason: str = ""
    seconds: float = 0.0
    lasting: bool = True
    modes: Mapping[str, Any] | None = field(default=None, repr=False)


def answer_of(point: Point) -> Answer:
    """The answer to one point, in this process. What is refused or fails is an answer, too."""
    import warnings

    began = time.perf_counter()
    verb = VERBS[point.verb]
    try:
        # A sweep keeps its answers, and not the plates.
        with in_passing(), warnings.catch_warnings():
            # Verbs collect those that are of the answer.
            warnings.simplefilter("ignore")
            display = verb.display(point.display, point.options)
            said = verb.answer(display, verb.settings(point.options), point.samples)
    except SqueezefilmError as error:
        return Answer({}, reason=str(error), seconds=time.perf_counter() - began)
    except Exception as error:
        # One point out of many: the others must not be lost by a fault of ours, which is told.
        reason = f"not foreseen: {type(error).__name__}: {error}"
        return Answer({}, reason=reason, seconds=time.perf_counter() - began, lasting=False)
    return Answer(
        dict(numbers_of(said)),
        tuple(said.get("warnings", ())),
        seconds=time.perf_counter() - began,
        modes=said if "motions" in said else None,
    )


def answered(
    points: Sequence[Point], pool: Workers, *, answer: Callable[[Point], Answer] = answer_of
) -> Iterator[tuple[int, Answer]]:
    """Each point's number and its answer, as they come from those who answer.

    Points of equal plates are answered one after the other: a sweep over voltage, force or finger
    solves a plate once. A point that processes died of has that as its answer. Raises as
    `Workers.answers`.
    """
    plates = {number: point.display.actuator for number, point in enumerate(points)}
    tasks = {number: (point,) for number, point in enumerate(points)}
    for number, found in pool.answers(answer, tasks, plates):
        yield number, _lost(found) if isinstance(found, Lost) else found


def _lost(found: Lost) -> Answer:
    return Answer({}, reason=found.reason, lasting=False)
