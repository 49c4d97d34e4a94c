"""`simulate_participants`: the answers of simulated people to whatever a design asks."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.errors import InputError
from squeezefilm.core.results import Result, stamp
from squeezefilm.physics.perception.observer import NamedObserver
from squeezefilm.study.design.study_design import NamedDesign
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.simulated.chain_tables import ChainTables, chain_tables
from squeezefilm.study.simulated.participants import (
    SimulatedStudy,
    require_people,
    right_answers,
    simulate_matches,
)
from squeezefilm.study.simulated.recalled import assumed

if TYPE_CHECKING:
    from squeezefilm.study.tasks.analyze import StudyAnalysis


@dataclass(frozen=True, eq=False, repr=False)
class SimulatedAnswers(Result):
    """Answers of simulated participants to a design of any other task than match-to-sample.

    Attributes:
        tables: the chain behind them.
        answers: every trial that asks, practice and catch trials too.
        seed: of orders, people and noise.
    """

    tables: ChainTables
    answers: Answers
    seed: int
    _shown: ClassVar[str] = "tables.design.name tables.observer.name participants seed"

    @property
    def participants(self) -> int:
        """How many people."""
        return len(self.answers.people)

    @functools.cached_property
    def analyses(self) -> dict[str, StudyAnalysis]:
        """What they say, by display; a psychometric function a person takes some 20 ms."""
        from squeezefilm.study.tasks.analyze import analyze_answers

        design = self.tables.design
        return analyze_answers(self.answers, design.name, assumed=assumed(design), seed=self.seed)

    def summary(self) -> dict[str, Any]:
        """What ``squeezefilm study simulate --json`` prints; keys carry units."""
        tables, design = self.tables, self.tables.design
        return {
            "study": design.name,
            "task": design.task,
            "origin": self.answers.origin,
            "observer": tables.observer.name,
            "finger": tables.whose_finger,
            "participants": self.participants,
            "seed": self.seed,
            "displays": {name: analysis.summary() for name, analysis in self.analyses.items()},
            "provenance": stamp((design, tables.observer, tables.apparatus), self.seed),
        }

    def _table(self) -> Any:
        return self.rows()

    def rows(self) -> list[dict[str, Any]]:
        """One row a trial, units in the names."""
        a = self.answers
        names = [surface.name for surface in a.surfaces]
        answers, series = a.design.answers, [one.name for one in a.design.adaptive]
        return [
            {
                "participant": int(a.participant[at]),
                "trial": int(a.number[at]),
                "display": a.design.displays[a.display[at]],
                "phase": str(a.phase[at]),
                "stimulus": names[a.first[at]],
                "second_stimulus": names[a.second[at]] if a.second[at] >= 0 else "",
                "third_stimulus": "" if a.third is None else names[a.third[at]],
                "adaptive_series": series[a.series[at]] if a.series[at] >= 0 else "",
                "intensity": float(a.intensity[at]),
                "choice": answers[a.choice[at]] if a.choice[at] >= 0 else "",
                "estimate": float(a.estimate[at]),
                "correct": float(a.correct[at]),
                "response_time_s": float(a.response_time[at]),
            }
            for at in range(a.trials)
        ]


@reads_text
def simulate_participants(
    design: NamedDesign,
    observer: NamedObserver,
    participants: int,
    seed: int,
    tables: ChainTables | None = None,
    progress: Callable[[str], None] | None = None,
) -> SimulatedStudy | SimulatedAnswers:
    """Answers of simulated participants to a design: a `SimulatedStudy` of match-to-sample, else
    `SimulatedAnswers`.

    A participant's answers depend on the seed and their number alone, not on how many there are.

    Args:
        design: the study.
        observer: what people are made of.
        participants: how many; 1 to a million.
        seed: the same seed gives the same answers.
        tables: of `chain_tables` for the same design and observer, where they are known already.
        progress: is told each step.

    Raises:
        InputError: a number out of range, tables of another design or observer, or a design that
            judges what the observer has no sense of.
    """
    require_people(design, participants, seed)
    found = chain_tables(design, observer, progress=progress) if tables is None else tables
    if found.design != design or found.observer != observer:
        raise InputError("the tables are of another design or observer; leave them out")
    if design.task == "match-to-sample":
        return simulate_matches(design, observer, participants, seed, found)
    # Its psychometric functions are compiled, which a match-to-sample study need not wait for.
    from squeezefilm.study.simulated.judgements import simulate_judgements

    answers = simulate_judgements(design, observer, participants, seed, found, progress)
    return SimulatedAnswers(found, answers, seed)


def answers_of(study: SimulatedStudy) -> Answers:
    """A simulated match-to-sample study's main trials, as analyses take them."""
    design = study.tables.design
    asked = study.choice.shape[1]
    size = study.choice.size
    nothing: si.FloatArray = np.full(size, np.nan)
    none = np.full(size, -1, dtype=np.int64)
    return Answers(
        design=design,
        origin=study.origin,
        people=tuple(f"simulated-{person + 1}" for person in range(study.participants)),
        surfaces=design.stimuli,
        participant=np.repeat(np.arange(study.participants), asked),
        number=study.number.ravel() + 1,
        phase=np.full(size, "main"),
        display=study.display.ravel(),
        series=none,
        first=study.stimulus.ravel(),
        second=none,
        intensity=nothing,
        choice=study.choice.ravel(),
        right=right_answers(design)[study.stimulus.ravel()],
        estimate=nothing,
        response_time=study.response_time.ravel(),
    )
