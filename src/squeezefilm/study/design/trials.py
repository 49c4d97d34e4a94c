"""Each participant's trials: seeded, and balanced over participants and repetitions.

A Latin square has every condition once in every place; a Williams square also has every condition
follow each other one equally often (Williams 1949, 10.1071/CH9490149), with n rows for n even and
2n for n odd. Repetition k of participant p takes row (p + k) of the square, so that a participant
who does all rows, and participants who are as many as the rows, are each balanced. The seed gives
the conditions their places in the square, once per run through its rows.
"""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cache, lru_cache
from typing import Any, Literal, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.study.design.study_design import Order, StudyDesign
from squeezefilm.study.design.tasks.task import Condition

Phase = Literal["familiarisation", "practice", "main", "catch"]
_LISTS = ("stimuli", "alternatives")
_ORDERS, _MATCHING, _SPREAD, _PRACTICE, _NOISE = range(5)


@dataclass(frozen=True, slots=True)
class Trial:
    """A trial as planned.

    Attributes:
        number: from 1, within the participant.
        display: what it is presented on.
        block: from 1 within the display; 0 before the first.
        phase: familiarisation (no answer), practice (feedback), main or catch.
        stimuli: names presented, in order; empty where an adaptive series chooses them.
        alternatives: answers that may be given, in the order in which they are offered; empty
            where any number may be given, or none is asked for.
        answer: what is right; an empty text where nothing is.
        adaptive: the series that chooses the stimuli, if any.
        reference_first: whether an adaptive series presents the reference first.
        pause: rest before this trial (s).
        seed: of whatever is random while it is presented.
    """

    number: int
    display: str
    block: int
    phase: Phase
    stimuli: Condition
    alternatives: tuple[str, ...]
    answer: str
    adaptive: str
    reference_first: bool
    pause: si.Second
    seed: int

    @property
    def asks(self) -> bool:
        """True where an answer is wanted."""
        return self.phase != "familiarisation"

    @property
    def feedback(self) -> bool:
        """True where the participant is told what was right."""
        return self.phase == "practice"

    def row(self) -> dict[str, Any]:
        """The trial as a study's file holds it: lists as JSON, the pause with its unit."""
        row = dataclasses.asdict(self)
        row["pause_s"] = row.pop("pause")
        return row | {name: json.dumps(row[name]) for name in _LISTS}

    @classmethod
    def of_row(cls, row: Mapping[str, Any]) -> Trial:
        """The trial of a row that `row` made."""
        values = {**row, "pause": row["pause_s"], "reference_first": bool(row["reference_first"])}
        for name in _LISTS:
            values[name] = tuple(json.loads(row[name]))
        return cls(**{field.name: values[field.name] for field in fields(cls)})


def latin_square(size: int) -> tuple[tuple[int, ...], ...]:
    """The cyclic Latin square: row r has (r + place) mod size. Raises `InputError` below 1."""
    si.require("size", size, at_least=1)
    return tuple(tuple((row + place) % size for place in range(size)) for row in range(size))


def williams_square(size: int) -> tuple[tuple[int, ...], ...]:
    """Rows in which each condition is once, each place has each condition equally often, and each
    ordered pair of neighbours comes equally often.

    n rows for n even, 2n for n odd (Williams 1949): the zigzag 0, 1, n−1, 2, n−2, … and its
    cyclic shifts, for n odd their mirror images too. Raises `InputError` below 1.
    """
    si.require("size", size, at_least=1)
    zigzag = [
        (place + 1) // 2 if place % 2 else (size - place // 2) % size for place in range(size)
    ]
    rows = [tuple((place + shift) % size for place in zigzag) for shift in range(size)]
    # One condition has no neighbours: its mirror image is itself.
    return tuple(rows if size % 2 == 0 or size == 1 else rows + [row[::-1] for row in rows])


def orders(
    count: int, repetitions: int, participant_number: int, seed: int, order: Order = "williams"
) -> tuple[tuple[int, ...], ...]:
    """The order of `count` conditions in each of a participant's repetitions; see the module.

    Args:
        count: conditions; at least 1.
        repetitions: rows wanted.
        participant_number: from 0.
        seed: of the study, the same for all its participants.
        order: as in `StudyDesign`.
    """
    si.require("participant_number", participant_number, at_least=0)
    if order == "shuffled":
        random = _random(seed, _ORDERS, participant_number)
        return tuple(tuple(random.permutation(count).tolist()) for _ in range(repetitions))
    square = williams_square(count) if order == "williams" else latin_square(count)
    planned_orders = []
    for repetition in range(repetitions):
        cycle, place = divmod(repetition, len(square))
        random = _random(seed, _ORDERS, cycle)
        relabelled, rows = random.permutation(count), random.permutation(len(square))
        row = square[rows[(participant_number + place) % len(square)]]
        planned_orders.append(tuple(int(relabelled[label]) for label in row))
    return tuple(planned_orders)


class _Planned(NamedTuple):
    """A trial before it is numbered; the answer of one without is what is right of its stimuli."""

    block: int
    phase: Phase
    stimuli: Condition
    answer: str | None = None
    adaptive: str = ""
    reference_first: bool = False
    pause: si.Second = 0.0


@lru_cache(maxsize=256)
def trials(design: StudyDesign, participant_number: int, seed: int) -> tuple[Trial, ...]:
    """All trials of a participant in the order in which they are presented.

    Args:
        design: what is planned.
        participant_number: from 0, in the order of enrolment; it chooses rows of the squares.
        seed: of the study; the same for all its participants.

    Raises:
        InputError: a number or seed below 0.
    """
    si.require("participant_number", participant_number, at_least=0)
    si.require("seed", seed, at_least=0)
    found: list[Trial] = []
    names = design.answers

    @cache
    def right(condition: Condition) -> str:
        return design.answer_to(*(design.stimulus(name) for name in condition))

    sequence = orders(len(design.displays), 1, participant_number, seed)[0]
    for place, index in enumerate(sequence):
        matching = _random(seed, _MATCHING, participant_number, place)
        # The box of gratings lies in another order for each participant and display.
        offered = tuple(names[i] for i in matching.permutation(len(names)))
        if design.task != "match-to-sample":
            offered = names
        for planned in _display_trials(design, place, participant_number, seed, matching):
            number = len(found) + 1
            found.append(
                Trial(
                    number=number,
                    display=design.displays[index],
                    block=planned.block,
                    phase=planned.phase,
                    stimuli=planned.stimuli,
                    alternatives=() if planned.phase == "familiarisation" else offered,
                    answer=right(planned.stimuli) if planned.answer is None else planned.answer,
                    adaptive=planned.adaptive,
                    reference_first=planned.reference_first,
                    pause=planned.pause,
                    seed=_trial_seed(seed, participant_number, number),
                )
            )
    return tuple(found)


def trial_count(design: StudyDesign) -> int:
    """Trials of one participant that ask for an answer."""
    return sum(trial.asks for trial in trials(design, 0, 0))


def expected_duration(design: StudyDesign) -> si.Second:
    """Time that one participant takes (s): trials at `trial_duration`, and the breaks."""
    planned = trials(design, 0, 0)
    return len(planned) * design.trial_duration + sum(trial.pause for trial in planned)


def _random(seed: int, purpose: int, *more: int) -> np.random.Generator:
    return np.random.default_rng([seed, purpose, *more])


def _display_trials(
    design: StudyDesign, place: int, participant: int, seed: int, matching: np.random.Generator
) -> list[_Planned]:
    """The trials on a participant's display number `place`, in their order."""
    felt = [stimulus.name for stimulus in design.stimuli]
    if design.task == "match-to-sample":
        felt = list(design.answers)
    planned = [
        _Planned(0, "familiarisation", (felt[i],), answer="")
        for _ in range(design.familiarisation)
        for i in matching.permutation(len(felt))
    ]
    every = design.conditions
    practice = _random(seed, _PRACTICE, participant, place)
    rounds = -(-design.practice // len(every)) if every else 0
    rehearsed = [every[i] for _ in range(rounds) for i in practice.permutation(len(every))]
    planned += [_Planned(0, "practice", pair) for pair in rehearsed[: design.practice]]
    series = _adaptive_trials(design, place, participant, seed) if design.adaptive else []
    if not design.adaptive:
        planned += _block_trials(design, place, participant, seed)
    if place and planned:
        planned[0] = planned[0]._replace(pause=design.break_between_blocks)
    return planned + series


def _block_trials(design: StudyDesign, place: int, participant: int, seed: int) -> list[_Planned]:
    """The repetitions of each block in their order, and catch trials between them."""
    every = design.conditions
    rows = orders(
        len(every), design.blocks * design.repetitions, participant, seed + place, design.order
    )
    spread = _random(seed, _SPREAD, participant, place)
    catches = [trial for trial in design.catch for _ in range(trial.count)]
    where = spread.integers(0, design.blocks, len(catches))
    planned: list[_Planned] = []
    for block in range(design.blocks):
        mine = rows[block * design.repetitions : (block + 1) * design.repetitions]
        queue = [_Planned(block + 1, "main", every[i]) for row in mine for i in row]
        for trial in (c for c, b in zip(catches, where, strict=True) if b == block):
            # Never the first trial of a block: people are still settling.
            at = int(spread.integers(1, len(queue) + 1))
            caught = design.catch_condition(trial)
            queue.insert(at, _Planned(block + 1, "catch", caught, trial.answer))
        if block:
            queue[0] = queue[0]._replace(pause=design.break_between_blocks)
        planned += queue
    return planned


def _adaptive_trials(
    design: StudyDesign, place: int, participant: int, seed: int
) -> list[_Planned]:
    """The series interleaved at random, catch trials between them, in blocks of equal size; where
    the reference comes, and how often, is the task's (`StudyTask.series`)."""
    random = _random(seed, _SPREAD, participant, place)
    queue: list[_Planned] = []
    for series in design.adaptive:
        kinds = [design.described.series(k, series.method) for k in range(series.count)]
        for i in random.permutation(series.count):
            reference_first, answer = kinds[i]
            queue.append(_Planned(0, "main", (), answer, series.name, reference_first))
    queue = [queue[i] for i in random.permutation(len(queue))]
    for catch in (trial for trial in design.catch for _ in range(trial.count)):
        caught = _Planned(0, "catch", design.catch_condition(catch), catch.answer)
        queue.insert(int(random.integers(1, len(queue) + 1)), caught)
    size = -(-len(queue) // design.blocks)
    return [
        planned._replace(
            block=position // size + 1,
            pause=design.break_between_blocks
            if position % size == 0 and (place or position)
            else 0.0,
        )
        for position, planned in enumerate(queue)
    ]


def _trial_seed(seed: int, participant: int, number: int) -> int:
    state = np.random.SeedSequence([seed, _NOISE, participant, number]).generate_state(2, np.uint32)
    # 53 bits, so that no reader of JSON or CSV rounds it.
    return int(state[0]) << 21 | int(state[1]) >> 11
