"""Conducting a session: every trial presented on a device and asked of a person, in turn."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Protocol

from squeezefilm.core import quantities as si
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.conduct.run import Acknowledgement, Presentation, Response, StudyRun
from squeezefilm.study.conduct.study_device import StudyDevice, TrialMotion
from squeezefilm.study.record.store import utc_now

Mark = Callable[[str, si.Second | None], None]
"""Is told what happened and when (s, the run's clock; now, without a moment)."""


class Examiner(Protocol):
    """What stands between a session and the person: a terminal, a page, or a script."""

    def rest(self, duration: si.Second) -> None:
        """Let the person rest (s)."""
        ...

    def feel(self, presentation: Presentation, place: int) -> None:
        """Return when the person has felt surface number `place` (from 0) long enough."""
        ...

    def ask(self, presentation: Presentation) -> str | float:
        """The answer: one of the trial's alternatives, or a number where there are none."""
        ...

    def acknowledge(self, presentation: Presentation, told: Acknowledgement) -> None:
        """The answer is on the disk; tell it, with what was right if the trial has feedback."""
        ...


def conduct(
    run: StudyRun,
    device: StudyDevice,
    examiner: Examiner,
    *,
    clock: Callable[[], float] = time.monotonic,
    mark: Mark = lambda *_: None,
    placed: Callable[[], None] | None = None,
) -> int:
    """Present and ask every trial that is left on the session's display. Returns how many.

    `placed` returns when a surface that somebody puts there by hand is in place; None where a
    device plays. A trial counts as presented from then on, or from when the device begins: not in
    the break before it.

    One surface plays while the question is asked, as the person compares it with what lies
    beside it; the response time runs from its onset. Two surfaces play one after the other, and
    it runs from the end of the second. Whatever happens, the device is silent afterwards.
    `mark` is told "start NAME" and "stop NAME" of each surface, and "answer CHOICE" with the moment
    that is recorded as the end of the trial.
    Raises what the device and the study's file raise; the trial then comes again.
    """
    count = 0
    while (presentation := run.next_trial(shown=False)) is not None:
        if presentation.rest:
            examiner.rest(presentation.rest)
        response = _presented(run, presentation, device, examiner, clock, mark, placed)
        told = run.respond(presentation.token, response)
        examiner.acknowledge(presentation, told)
        count += 1
    return count


def _presented(
    run: StudyRun,
    presentation: Presentation,
    device: StudyDevice,
    examiner: Examiner,
    clock: Callable[[], float],
    mark: Mark,
    placed: Callable[[], None] | None,
) -> Response:
    trial = presentation.trial
    begun, begun_utc = clock(), utc_now()
    felt: list[TrialMotion] = []
    asked, last = begun, len(presentation.surfaces) - 1
    answer: str | float | None = None
    for place, surface in enumerate(presentation.surfaces):
        # A real grating lies in its box; nothing plays.
        plays = isinstance(surface, Stimulus)
        by_hand = plays and placed is not None
        if place == 0 and not by_hand:
            run.next_trial()
        try:
            if isinstance(surface, Stimulus):
                device.present(surface, trial.seed)
                if placed is not None:
                    placed()
                    if place == 0:
                        run.next_trial()
                        begun, begun_utc = clock(), utc_now()
                mark(f"start {surface.name}", clock())
            if trial.asks and last == 0:
                asked = clock()
                answer = examiner.ask(presentation)
            else:
                examiner.feel(presentation, place)
        finally:
            if plays:
                felt.append(device.stop())
                ended = felt[-1].ended
                mark(f"stop {surface.name}", clock() if math.isnan(ended) else ended)
    if trial.asks and answer is None:
        asked = clock()
        answer = examiner.ask(presentation)
    ended = clock()
    if answer is not None:
        mark(f"answer {answer}", ended)
    return Response(
        choice=answer if isinstance(answer, str) else "",
        estimate=None if answer is None or isinstance(answer, str) else float(answer),
        response_time=ended - asked if trial.asks else None,
        started_monotonic=begun,
        ended_monotonic=ended,
        started_utc=begun_utc,
        ended_utc=utc_now(),
        explorations=tuple(felt),
    )
