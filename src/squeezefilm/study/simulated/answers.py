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
from squeezefilm.study.identification.confusion import ConfusionMatrix
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.record.tables import SURFACES, trial_columns
from squeezefilm.study.simulated.chain_tables import ChainTables, assumed, chain_tables
from squeezefilm.study.simulated.participants import (
    match_counts,
    require_people,
    simulate_matches,
)

if TYPE_CHECKING:
    from squeezefilm.study.tasks.analyze import StudyAnalysis


@dataclass(frozen=True, eq=False, repr=False)
class SimulatedStudy(Result):
    """Answers of simulated participants to a design.

    Attributes:
        tables: the chain behind them.
        answers: every trial that asks, practice and catch trials too; of match-to-sample the main
            trials, numbered among those that ask.
        seed: of orders, people and noise.
    """

    tables: ChainTables
    answers: Answers
    seed: int
    _shown: ClassVar[str] = "tables.design.name tables.observer.name participants seed"

    @property
    def participants(self) -> int:
        """Number of people."""
        return len(self.answers.people)

    @functools.cached_property
    def analyses(self) -> dict[str, StudyAnalysis]:
        """Analyses of the answers, by display; a psychometric function a person takes some 20 ms.
        Empty where gratings and stimuli do not pair up, so that nothing is right or wrong."""
        from squeezefilm.study.tasks.analyze import analyze_answers

        design = self.tables.design
        about = () if self.is_matching else assumed(design)
        try:
            return analyze_answers(self.answers, design.name, assumed=about, seed=self.seed)
        except InputError:
            if self.is_matching:
                return {}
            raise

    def confusion(self, display: int = 0) -> ConfusionMatrix:
        """The confusion matrix on a display: rows gratings, columns simulated periods.

        Raises `InputError` for another task than match-to-sample.
        """
        self._require_matching()
        design = self.tables.design
        names = tuple(stimulus.name for stimulus in design.stimuli)
        counts = match_counts(self.answers, display).sum(axis=0)
        return ConfusionMatrix(counts, design.answers, names)

    def proportion_correct(self, display: int = 0) -> si.Dimensionless:
        """Share of right matches on a display (1). Raises as `confusion` does."""
        self._require_matching()
        main = self.answers.main(display)
        return float(np.mean(main.choice == main.right))

    @property
    def is_matching(self) -> bool:
        """True of match-to-sample, which has confusions."""
        return self.tables.design.task == "match-to-sample"

    def _require_matching(self) -> None:
        if not self.is_matching:
            task = self.tables.design.task
            raise InputError(f"task = '{task}' has no confusions; its `analyses` say what it has")

    def summary(self) -> dict[str, Any]:
        """Mapping of plain JSON values; keys carry units."""
        tables, design = self.tables, self.tables.design
        return {
            "study": design.name,
            "task": design.task,
            "origin": self.answers.origin,
            "observer": tables.observer.name,
            "finger": tables.whose_finger,
            "participants": self.participants,
            "seed": self.seed,
            **self._by_display(),
            "provenance": stamp((design, tables.observer, tables.apparatus), self.seed),
        }

    def _by_display(self) -> dict[str, Any]:
        names = self.tables.design.displays
        if not self.is_matching:
            analysed = {name: analysis.summary() for name, analysis in self.analyses.items()}
            return {"displays": analysed}
        matrices = {name: self.confusion(index) for index, name in enumerate(names)}
        right = {name: self.proportion_correct(index) for index, name in enumerate(names)}
        counts = {name: matrix.counts.tolist() for name, matrix in matrices.items()}
        heads = {
            "rows": list(self.tables.design.answers),
            "columns": [stimulus.name for stimulus in self.tables.design.stimuli],
        }
        return {
            "layout": "rows: gratings answered; columns: periods simulated; counts",
            "confusion": counts,
            "proportion_correct": right,
            **heads,
            "displays": {
                name: {
                    **heads,
                    "confusion": counts[name],
                    "confusion_percent": np.round(matrices[name].percent, 3).tolist(),
                    "proportion_correct": right[name],
                }
                for name in names
            },
        }

    def _table(self) -> Any:
        return self.rows()

    def rows(self) -> list[dict[str, Any]]:
        """A row a trial, with units in the names."""
        a = self.answers
        names = [surface.name for surface in a.surfaces]
        answers, series = a.design.answers, [item.name for item in a.design.adaptive]
        surfaces = [column.name for column in trial_columns(a.design) if column.name in SURFACES]
        return [
            {
                "participant": int(a.participant[at]),
                "trial": int(a.number[at]),
                "display": a.design.displays[a.display[at]],
                "phase": str(a.phase[at]),
                **dict.fromkeys(surfaces, ""),
                **dict(zip(surfaces, (names[k] for k in a.presented[:, at]), strict=False)),
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
) -> SimulatedStudy:
    """Answers of simulated participants to a design.

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
    chain = chain_tables(design, observer, progress=progress) if tables is None else tables
    if chain.design != design or chain.observer != observer:
        raise InputError("the tables are of another design or observer; leave them out")
    answers = simulated_answers(chain, participants, seed, progress or (lambda _: None))
    return SimulatedStudy(chain, answers, seed)


def simulated_answers(
    tables: ChainTables, participants: int, seed: int, tell: Callable[[str], None]
) -> Answers:
    """The answers alone, of the design and the observer of tables. Raises as
    `simulate_participants` does."""
    require_people(tables.design, participants, seed)
    if tables.design.task == "match-to-sample":
        return simulate_matches(tables, participants, seed)
    # Its psychometric functions are compiled, which a match-to-sample study need not wait for.
    from squeezefilm.study.simulated.judgements import simulate_judgements

    return simulate_judgements(tables, participants, seed, tell)
