"""Simulated participants of a match-to-sample study: noise, decisions and times, in arrays.

On a trial each candidate rhythm of the virtual surface has its evidence plus noise of standard
deviation 1; the strongest is perceived if it passes the criterion. Its period is perceived with
σ √(1 + 1/d′²) in the logarithm, σ from the person's Weber fraction (75 % of two intervals). Each
real grating is felt again on each trial, with noise of its own. The answer is the grating whose
perceived period is nearest; a person who feels nothing, or lapses, guesses. All noise falls with
practice. Where a surface is matched with the stimuli themselves, `chain_tables` says how.
**Every number that comes out is simulated.**
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.hard_limits import SIMULATED_TRIALS, require_within
from squeezefilm.physics.perception.observer import Observer
from squeezefilm.physics.perception.percepts import perceived_anew
from squeezefilm.physics.perception.senses import Candidates, percept_deviation
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.design.trials import Trial, trials
from squeezefilm.study.identification.confusion import participant_counts
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.simulated.chain_tables import ChainTables, recalled_distances

_MOST_PEOPLE = 1_000_000
_STREAM = 29


def unanswered(
    design: StudyDesign,
    surfaces: Sequence[Stimulus],
    schedules: Sequence[Sequence[Trial]],
    participants: int,
) -> Answers:
    """Trials of so many simulated people before anybody answers: schedules repeat, and what an
    adaptive series will present is −1."""
    rows = np.arange(participants) % len(schedules)
    place = {surface.name: number for number, surface in enumerate(surfaces)}
    displays = {name: number for number, name in enumerate(design.displays)}
    series = {one.name: number for number, one in enumerate(design.adaptive)}
    names = {name: number for number, name in enumerate(design.answers)}
    planned = [trial for schedule in schedules for trial in schedule]
    chosen = [-1] * design.described.surfaces
    shown = [[place[name] for name in trial.stimuli] or chosen for trial in planned]
    size = participants * len(schedules[0])

    def of_all(values: Sequence[Any]) -> NDArray[Any]:
        found = np.array(values)
        each = found.reshape(len(schedules), -1, *found.shape[1:])[rows]
        return each.reshape(size, *found.shape[1:])

    return Answers(
        design=design,
        origin="simulated",
        people=tuple(f"simulated-{person + 1}" for person in range(participants)),
        surfaces=tuple(surfaces),
        participant=np.repeat(np.arange(participants), len(schedules[0])),
        number=of_all([trial.number for trial in planned]),
        phase=of_all([trial.phase for trial in planned]),
        display=of_all([displays[trial.display] for trial in planned]),
        series=of_all([series.get(trial.adaptive, -1) for trial in planned]),
        presented=np.ascontiguousarray(of_all(shown).T),
        intensity=np.full(size, np.nan),
        choice=np.full(size, -1),
        right=of_all([names.get(trial.answer, -1) for trial in planned]),
        estimate=np.full(size, np.nan),
        response_time=np.full(size, np.nan),
    )


def simulate_matches(tables: ChainTables, participants: int, seed: int) -> Answers:
    """Answers to the main trials of a match-to-sample design, numbered among those that ask.

    Orders are those of `trials`; from the sixty-first person on they repeat. Practice and catch
    trials count for learning only.
    """
    design = tables.design
    schedules = [_main_trials(design, person, seed) for person in range(min(participants, CHUNK))]
    answers = unanswered(design, design.stimuli, schedules, participants)
    planned = answers.display, answers.presented[0], answers.number - 1
    display, stimulus, number = (values.reshape(participants, -1)[:CHUNK] for values in planned)
    choice = answers.choice.reshape(participants, -1)
    time = answers.response_time.reshape(participants, -1)
    for first in range(0, participants, CHUNK):
        count = min(CHUNK, participants - first)
        random = np.random.default_rng([seed, _STREAM, first // CHUNK])
        here = slice(first, first + count)
        choice[here], time[here] = _answers(tables, display, stimulus, number, random, count)
    return answers


def _main_trials(design: StudyDesign, person: int, seed: int) -> list[Trial]:
    asked = (trial for trial in trials(design, person, seed) if trial.asks)
    return [
        dataclasses.replace(trial, number=number)
        for number, trial in enumerate(asked, 1)
        if trial.phase == "main"
    ]


def match_counts(answers: Answers, display: int = 0) -> si.IntArray:
    """Matches of each person on a display, shape (participants, answers, stimuli)."""
    main, design = answers.main(display), answers.design
    names, stimuli = len(design.answers), len(design.stimuli)
    return participant_counts(main.participant, main.presented[0], main.choice, names, stimuli)[1]


def require_people(design: StudyDesign, participants: int, seed: int) -> None:
    """Refuse a number of people or a seed out of range, and more trials than are simulated at once.
    Raises `InputError`."""
    si.require("participants", participants, at_least=1, at_most=_MOST_PEOPLE)
    si.require("seed", seed, at_least=0)
    most = int(SIMULATED_TRIALS.most // design.most_trials)
    enough = f"of {design.most_trials} trials each, at most {most} people are simulated"
    require_within(SIMULATED_TRIALS, participants * design.most_trials, enough=enough)


def right_answers(design: StudyDesign) -> si.IntArray:
    """Number of the right alternative of each stimulus, −1 where none is right."""
    names = design.answers
    right = [design.answer_to(stimulus) for stimulus in design.stimuli]
    return np.array([names.index(name) if name else -1 for name in right], dtype=np.int64)


def _answers(
    tables: ChainTables,
    display: si.IntArray,
    stimulus: si.IntArray,
    number: si.IntArray,
    random: np.random.Generator,
    count: int,
) -> tuple[si.IntArray, si.SecondArray]:
    """Choice and response time, shape (people, trials).

    Noise is drawn for a whole chunk whatever `count` is, so that people do not depend on it.
    """
    observer, asked = tables.observer, display.shape[1]
    finger = random.integers(0, len(tables.fingers), CHUNK)[:count]
    clear = percept_deviation(observer.period_weber_fraction)
    sigma = clear * np.exp(observer.period_spread * random.standard_normal(CHUNK)[:count])
    lapse = observer.lapse_rate * np.exp(
        observer.lapse_spread * random.standard_normal(CHUNK)[:count]
    )
    display, stimulus, number = display[:count], stimulus[:count], number[:count]
    skill = 1.0 + observer.learning_excess * np.exp(-number / observer.learning_trials)
    if tables.design.matched_with == "stimuli":
        away, felt = recalled_distances(
            tables, display, finger, stimulus, skill, sigma[:, None], random, CHUNK
        )
        # In standard deviations already; what is faint is like what is faint, so nobody guesses.
        decides, unit = np.ones(felt.shape, dtype=bool), np.ones_like(skill)
    else:
        away, felt = _from_gratings(tables, display, finger, stimulus, skill, sigma, random)
        decides, unit = felt & np.isfinite(away).any(axis=2), sigma[:, None] * skill
    guess = random.integers(0, away.shape[2], (CHUNK, asked))[:count]
    blind = random.random((CHUNK, asked))[:count] < lapse[:, None]
    decides = decides & ~blind
    choice = np.where(decides, np.argmin(away, axis=2), guess)
    doubt = np.where(decides, _doubt(away, unit), 1.0)
    spread = random.standard_normal((CHUNK, asked))[:count]
    times = (observer.response_time + observer.doubt_time * doubt) * np.exp(
        observer.response_time_spread * spread
    )
    return choice.astype(np.int64), times


def _from_gratings(
    tables: ChainTables,
    display: si.IntArray,
    finger: si.IntArray,
    stimulus: si.IntArray,
    skill: si.DimensionlessArray,
    sigma: si.DimensionlessArray,
    random: np.random.Generator,
) -> tuple[si.FloatArray, NDArray[np.bool_]]:
    """Distance of the perceived period from each real grating's, shape (people, trials, gratings),
    infinite where that was not felt; and whether the surface was."""
    shown, touched = tables.virtual, tables.real
    # They are explored by strokes: in one direction.
    places = display, finger[:, None], stimulus, 0
    felt_now = Candidates(shown.period[places], shown.d_prime[places])
    virtual = perceived_anew(felt_now, tables.observer, skill, sigma[:, None], random, CHUNK)
    within = (*display.shape, *touched.period.shape[1:])
    again = (
        np.broadcast_to(one[finger][:, None], within) for one in (touched.period, touched.d_prime)
    )
    real = perceived_anew(
        Candidates(*again),
        tables.observer,
        skill[:, :, None],
        sigma[:, None, None],
        random,
        CHUNK,
    )
    apart = np.abs(virtual.log_period[:, :, None] - real.log_period)
    return np.where(real.felt, apart, np.inf), virtual.felt


def _doubt(away: si.FloatArray, sigma: si.DimensionlessArray) -> si.DimensionlessArray:
    """1 where two gratings are equally near, falling by e for each σ that the second is further."""
    if away.shape[2] < 2:
        return np.zeros(away.shape[:2])
    two = np.sort(away, axis=2)[:, :, :2]
    gap = np.where(np.isfinite(two[:, :, 1]), two[:, :, 1] - two[:, :, 0], 0.0)
    return np.asarray(np.exp(-gap / sigma))


CHUNK = 60
"""People whose noise is drawn together: a multiple of all rows for 5 stimuli. Orders of more people
repeat those of the first so many."""
_PEOPLE_STREAM = 31
_OWN_SCALE, _OWN_MIDDLE = 0.5, 10.0
"""People without a modulus: spread of ln of their scales, and the middle of them."""


@dataclass(frozen=True, slots=True, eq=False)
class SimulatedPeople:
    """Simulated people, up to sixty, and their noise of each trial; arrays have a person a row, or
    begin with the trial, of a percept with the surface in it, and have the person then."""

    finger: si.IntArray
    spread: si.DimensionlessArray
    lapse: si.DimensionlessArray
    scale: si.DimensionlessArray
    memory: si.DimensionlessArray
    noise: si.FloatArray
    blur: si.FloatArray
    blind: si.DimensionlessArray
    guess: si.DimensionlessArray
    slowness: si.FloatArray

    @classmethod
    def drawn(
        cls,
        observer: Observer,
        fingers: int,
        asked: int,
        seed: int,
        chunk: int,
        directions: int,
        surfaces: int = 2,
        count: int = CHUNK,
    ) -> SimulatedPeople:
        """The first `count` people of a chunk; nobody depends on how many there are."""
        random = np.random.default_rng([seed, _PEOPLE_STREAM, chunk])
        normal, among = random.standard_normal, random.random
        clear = percept_deviation(observer.period_weber_fraction)
        return cls(
            finger=random.integers(0, fingers, CHUNK)[:count],
            spread=clear * np.exp(observer.period_spread * normal(CHUNK))[:count],
            lapse=observer.lapse_rate * np.exp(observer.lapse_spread * normal(CHUNK))[:count],
            scale=_OWN_MIDDLE * np.exp(_OWN_SCALE * normal(CHUNK))[:count],
            memory=normal(CHUNK)[:count],
            noise=normal((asked, surfaces, CHUNK, directions, observer.candidates))[:, :, :count],
            blur=normal((asked, surfaces, CHUNK, directions))[:, :, :count],
            blind=among((asked, CHUNK))[:, :count],
            guess=among((asked, CHUNK))[:, :count],
            slowness=normal((asked, CHUNK))[:, :count],
        )
