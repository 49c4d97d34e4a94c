"""Simulated participants of all tasks but match-to-sample, trial by trial.

Senses and noise are those of match-to-sample (`physics.perception.percepts`): every surface is
perceived anew on every trial. What the tasks add is how an answer follows from what was perceived.
None of that was measured, none was tuned, and `assumptions` says each in a sentence that results
repeat.

Trials go in their order, all people at once, so that an adaptive series meets the answers that it
asks for. **Every number that comes out is simulated.**
"""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.perception.percepts import Perceived, perceived
from squeezefilm.physics.perception.senses import FINEST_PERIOD, Candidates, percept_deviation
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.adaptive.series import AdaptiveMethod, adaptive_method, hears_choice
from squeezefilm.study.design.tasks.task import Percepts
from squeezefilm.study.design.trials import Trial, trials
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.simulated.chain_tables import ChainTables, difference
from squeezefilm.study.simulated.participants import CHUNK, SimulatedPeople, unanswered

_FAINTEST = 0.05
"""Strength (d′) below which magnitudes fall no further."""
_JUDGED = ("spatial_period", "friction_depth")


@dataclass(frozen=True, slots=True, eq=False)
class _Given:
    """Answers to one trial of everybody: how unsure, and numbers of answers, or estimates."""

    doubt: si.DimensionlessArray
    choice: si.IntArray | int = -1
    estimate: si.DimensionlessArray | float = math.nan


def simulate_judgements(
    tables: ChainTables,
    participants: int,
    seed: int,
    tell: Callable[[str], None] = lambda _: None,
) -> Answers:
    """Answers to every trial that asks, practice and catch included; `tell` hears how many people
    have answered. Raises `InputError` for a design that judges what the observer has no sense of.
    """
    design = tables.design
    if design.judged not in _JUDGED:
        raise InputError(
            f"judged = '{design.judged}': simulated participants judge {' or '.join(_JUDGED)}; "
            "their senses know nothing else",
            quantity="judged",
        )
    room = _Room(tables)
    schedules = [
        [trial for trial in trials(design, person, seed) if trial.asks]
        for person in range(min(participants, CHUNK))
    ]
    answers = unanswered(design, room.surfaces, schedules, participants)
    for first in range(0, participants, CHUNK):
        count = min(CHUNK, participants - first)
        people = SimulatedPeople.drawn(
            tables.observer,
            len(tables.fingers),
            len(schedules[0]),
            seed,
            first // CHUNK,
            room.directions,
            # One surface has the noise of two: nobody's answers depend on how tasks are kept.
            max(design.described.surfaces, 2),
            count,
        )
        _answer(room, people, schedules[:count], answers, first)
        # Twenty words are enough for however many.
        if 20 * (first + count) // participants > 20 * first // participants:
            tell(f"{first + count} of {participants} simulated participants")
    return dataclasses.replace(answers, surfaces=tuple(room.surfaces))


class _Room:
    """Percepts of each finger, computed when first asked for."""

    def __init__(self, tables: ChainTables) -> None:
        design = tables.design
        self.design, self.observer, self.tables = design, tables.observer, tables
        self.surfaces: list[Stimulus] = [
            *design.stimuli,
            *(trial.stimulus for trial in design.catch),
        ]
        self.place = {surface.name: number for number, surface in enumerate(self.surfaces)}
        self.directions = tables.virtual.period.shape[-2]
        self.chosen, self.felt = functools.cache(self._chosen), functools.cache(self._felt)

    def _chosen(self, series: str, intensity: float) -> int:
        """The number of what an adaptive series presents at an intensity."""
        self.surfaces.append(self.design.comparison(self.design.series(series), intensity))
        return len(self.surfaces) - 1

    def _felt(self, display: int, finger: int, surface: int) -> tuple[si.FloatArray, si.FloatArray]:
        """Candidates of a surface under a finger, by direction: periods (m) and d′."""
        if surface < len(self.design.stimuli):
            known, place = self.tables.virtual, (display, finger, surface)
            return known.period[place], known.d_prime[place]
        found = self.tables.felt(display, finger, self.surfaces[surface])
        return found.period, found.d_prime

    def presented(
        self, display: si.IntArray, finger: si.IntArray, surface: si.IntArray
    ) -> Candidates:
        """Percepts of everybody, shape (people, directions, candidates)."""
        found = [
            self.felt(d, f, s)
            for d, f, s in zip(display.tolist(), finger.tolist(), surface.tolist(), strict=True)
        ]
        return Candidates(np.array([one for one, _ in found]), np.array([one for _, one in found]))


def _answer(
    room: _Room, people: SimulatedPeople, schedules: list[list[Trial]], answers: Answers, begin: int
) -> None:
    """Let people answer, whose numbers begin with `begin`: fills their rows of `answers`."""
    design, observer = room.design, room.observer
    count, asked = len(schedules), len(schedules[0])
    task, reference = design.described, room.place.get(design.reference, -1)

    @functools.cache
    def standing(person: int, display: str, series: str) -> AdaptiveMethod:
        """The method of a person's series, as the answers so far left it."""
        return adaptive_method(design.series(series), task=design.task)

    def mine(values: NDArray[Any]) -> Any:
        return values.reshape(*values.shape[:-1], -1, asked)[..., begin : begin + count, :]

    display, presented, intensity = map(
        mine, (answers.display, answers.presented, answers.intensity)
    )
    choice, estimate, time = map(mine, (answers.choice, answers.estimate, answers.response_time))
    judge = _judge(room, people)
    for at in range(asked):
        for person, row in enumerate(schedules):
            trial = row[at]
            if trial.adaptive:
                how = trial.reference_first, trial.answer
                comparison, intensity[person, at] = reference, 0.0
                if task.presents_comparison(*how):
                    method = standing(person, trial.display, trial.adaptive)
                    intensity[person, at] = method.next_stimulus()
                    comparison = room.chosen(trial.adaptive, float(intensity[person, at]))
                presented[:, person, at] = task.arranges(reference, comparison, *how)
        skill = 1.0 + observer.learning_excess * math.exp(-at / observer.learning_trials)
        felt = [
            perceived(
                room.presented(display[:, at], people.finger, presented[place, :, at]),
                observer,
                np.full((count, 1), skill),
                people.spread[:, None],
                people.noise[at, place],
                people.blur[at, place],
            )
            for place in range(task.surfaces)
        ]
        given = judge(felt, skill, at)
        choice[:, at], estimate[:, at] = given.choice, given.estimate
        time[:, at] = (observer.response_time + observer.doubt_time * given.doubt) * np.exp(
            observer.response_time_spread * people.slowness[at]
        )
        for person, row in enumerate(schedules):
            if row[at].adaptive:
                said: Any = design.answers[choice[person, at]]
                if not hears_choice(design.series(row[at].adaptive), task):
                    said = said == row[at].answer
                method = standing(person, row[at].display, row[at].adaptive)
                method.update(float(intensity[person, at]), said)


_Judge = Callable[[list[Perceived], float, int], _Given]


def _judge(room: _Room, people: SimulatedPeople) -> _Judge:
    """Judge of the design's task: a function from percepts to answers."""
    task = room.design.task
    if task == "magnitude-estimation":
        return functools.partial(_number, room, people)
    in_plane = task == "same-different" and room.directions > 1
    return functools.partial(_alike_in_plane if in_plane else _decided, room, people)


def _in_clearest_direction(felt: Perceived) -> Perceived:
    """Percept in the direction in which it is the most evident."""
    best = np.arange(felt.strength.shape[0]), np.argmax(felt.strength, axis=-1)
    return Perceived(felt.log_period[best], felt.strength[best], felt.felt[best])


def _judged(
    room: _Room, people: SimulatedPeople, felt: Perceived, skill: float
) -> tuple[si.FloatArray, si.FloatArray]:
    """Judged amounts on a scale, and the standard deviation of one percept on it."""
    if room.design.judged == "friction_depth":
        return felt.strength, np.full(felt.strength.shape, skill)
    return felt.log_period, people.spread * skill


def _remembered(room: _Room, finger: si.IntArray) -> si.FloatArray:
    """Level of the reference without noise, of each person; of a strength the first's without."""
    if room.design.judged != "friction_depth":
        return np.full(finger.shape, room.design.reference_level)
    place = room.place.get(room.design.reference, 0)
    return np.asarray(room.tables.virtual.d_prime[0, finger, place, :, 0].max(axis=-1))


def _decided(
    room: _Room, people: SimulatedPeople, felt: list[Perceived], skill: float, at: int
) -> _Given:
    """Answers as the task's record decides; of who lapses, or has nothing to decide by, guesses."""
    decides = room.design.described.decides
    assert decides is not None
    felt = [_in_clearest_direction(surface) for surface in felt]
    judged = [_judged(room, people, surface, skill) for surface in felt]
    known = np.array([surface.felt for surface in felt])
    if room.design.judged == "friction_depth":
        # How strong a surface is can be said of one that is hardly felt.
        known = np.ones_like(known)
        # Where nothing is felt there is the noise of a percept.
        noise = skill * people.noise[at, :, :, 0, 0]
        judged = [
            (np.where(np.isfinite(level), level, alone), deviation)
            for (level, deviation), alone in zip(judged, noise, strict=False)
        ]
    level, deviation = np.array([one for one, _ in judged]), judged[0][1]
    remembered = _remembered(room, people.finger)
    criterion = room.observer.detection_criterion
    found = decides(Percepts(level, known, deviation, criterion, remembered))
    blind = ~found.decided | (people.blind[at] < people.lapse)
    number = len(room.design.answers)
    guess = number - 1 - np.floor(people.guess[at] * number).astype(np.int64)
    choice = np.where(blind, guess, found.choice)
    return _Given(np.where(blind, 1.0, found.doubt), choice)


def _alike_in_plane(
    room: _Room, people: SimulatedPeople, felt: list[Perceived], skill: float, at: int
) -> _Given:
    one, other = felt
    # Strengths in each direction, and periods in those in which both are felt.
    terms = one.strength.shape[-1] + np.sum(one.felt & other.felt, axis=-1)
    apart = difference(one, other, np.full((terms.size, 1), skill), people.spread[:, None])
    apart = apart / np.sqrt(terms)
    limit = room.observer.detection_criterion
    blind = people.blind[at] < people.lapse
    choice = np.where(blind, people.guess[at] < 0.5, apart > limit).astype(np.int64)
    return _Given(np.where(blind, 1.0, np.exp(-np.abs(apart - limit))), choice)


def _number(
    room: _Room, people: SimulatedPeople, felt: list[Perceived], skill: float, at: int
) -> _Given:
    design = room.design
    values = np.array([design.judged_value(stimulus) for stimulus in design.stimuli])
    middle = math.exp(float(np.mean(np.log(np.maximum(values, 1e-12)))))
    here = design.reference_value if design.reference else middle
    one = _in_clearest_direction(felt[0])
    if design.judged == "friction_depth":
        # Strength has no unit of its own: that of the reference is felt as often as it likes.
        known = _remembered(room, people.finger)
        step = percept_deviation(room.observer.strength_weber_fraction)
        level, known = (step * np.maximum(x, _FAINTEST) for x in (one.strength, known))
        error = people.memory * step / np.tanh(known)
        # Back from steps of the noise to strengths.
        level, known = np.log(np.sinh(level)), np.log(np.sinh(known))
    else:
        level = np.where(one.felt, one.log_period, math.log(FINEST_PERIOD))
        known, error = np.array(math.log(here)), people.spread * people.memory
    scale = design.modulus or people.scale
    number = scale * np.exp(level - known - error)
    blind = people.blind[at] < people.lapse
    least, most = float(values.min()) / here, float(values.max()) / here
    anything = scale * least * (most / least) ** people.guess[at]
    number = np.where(blind, anything, number)
    digits = 10.0 ** (np.floor(np.log10(number)) - 1.0)
    doubt = np.where(one.felt & ~blind, 0.3, 1.0)
    return _Given(doubt, estimate=np.round(number / digits) * digits)
