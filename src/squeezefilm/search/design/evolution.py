"""Who proposes designs: a genetic algorithm where they are screened, a Bayesian sampler where they
are solved; both are Optuna's, with a journal on disk that several hosts may share."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from squeezefilm.search.design.candidate import Design, Evaluated, design_of
from squeezefilm.search.design.criteria import bounded, excess_of
from squeezefilm.search.design.requirements import Requirements

if TYPE_CHECKING:
    import optuna

JOURNAL = "journal.log"
"""Its name in the folder of a search."""

POPULATION = 100

# In place of an objective that is infinite or not known, which no sampler takes.
_NONE = 1e6
_EXCESS = "excess"
_TOLD = "told"  # of trials that were known from elsewhere, and proposed by no one


class Proposals:
    """One Optuna study: the designs of one shape, proposed in batches and answered in batches.

    `dear` proposes by a tree-structured Parzen estimator (Ozaki et al. 2020, 10.1145/3377930.3389817)
    in place of NSGA-II (Deb et al. 2002, 10.1109/4235.996017). `member` tells hosts apart that share
    a `folder`. The seed, the member and the number of the batch decide what is proposed, so that
    what was interrupted goes on as it would have.
    """

    def __init__(
        self,
        requirements: Requirements,
        shape: int,
        folder: Path | None,
        seed: int,
        *,
        member: int = 0,
        dear: bool = False,
    ) -> None:
        import optuna

        optuna.logging.set_verbosity(optuna.logging.ERROR)
        self._requirements, self._shape, self._dear = requirements, shape, dear
        self._seed, self._space = (seed, member, shape, int(dear)), requirements.spaces[shape]
        storage: Any = None
        if folder is not None:
            from optuna.storages import JournalStorage
            from optuna.storages.journal import JournalFileBackend

            storage = JournalStorage(JournalFileBackend(str(folder / JOURNAL)))
        kind = "solved" if dear else "screened"
        self._study = optuna.create_study(
            study_name=f"{self._space.shape}, {kind}, seed {seed}",
            storage=storage,
            directions=["minimize"] * len(requirements.objectives),
            load_if_exists=True,
        )
        self._end_what_was_left()
        self._before = self._proposed_before()

    def _proposed_before(self) -> list[dict[str, float]]:
        """What this member proposed in earlier runs and was told of, in that order: a search that
        is asked again goes the same way until it comes where it stopped."""
        import optuna

        done = (optuna.trial.TrialState.COMPLETE,)
        return [
            dict(trial.params)
            for trial in self._study.get_trials(deepcopy=False, states=done)
            if not trial.user_attrs.get(_TOLD)
            and trial.user_attrs.get("member", 0) == self._seed[1]
        ]

    def _end_what_was_left(self) -> None:
        """Trials of this member that were begun and never answered are nobody's any more."""
        import optuna

        running = optuna.trial.TrialState.RUNNING
        for trial in self._study.get_trials(deepcopy=False, states=(running,)):
            if trial.user_attrs.get("member", 0) == self._seed[1]:
                self._study.tell(trial.number, state=optuna.trial.TrialState.FAIL)

    @property
    def answered(self) -> int:
        """How many proposals have an answer."""
        import optuna

        done = (optuna.trial.TrialState.COMPLETE,)
        return len(self._study.get_trials(deepcopy=False, states=done))

    @property
    def repeats(self) -> bool:
        """Whether what is asked next is what was asked in earlier runs."""
        return bool(self._before)

    def known(self, found: Sequence[Evaluated]) -> None:
        """Tell of designs that somebody else proposed, so that the sampler learns from them."""
        import optuna

        for one in found:
            shares = self._space.places(one.design.settings)
            self._study.add_trial(
                optuna.trial.create_trial(
                    params=shares,
                    distributions={name: _distribution() for name in shares},
                    values=self._values(one),
                    user_attrs={_EXCESS: self._excess(one), _TOLD: True},
                )
            )

    def ask(self, count: int, batch: int) -> list[tuple[Any, Design]]:
        """So many designs, each with the trial that is to be told of: those of earlier runs first,
        whose trials (None) were told of then."""
        again, self._before = self._before[:count], self._before[count:]
        found: list[tuple[Any, Design]] = [
            (None, design_of(self._shape, self._space.at(shares))) for shares in again
        ]
        self._study.sampler = self._sampler(batch)
        for _ in range(count - len(found)):
            trial = self._study.ask()
            shares = {one.name: trial.suggest_float(one.name, 0.0, 1.0) for one in self._space.free}
            if self._seed[1]:
                trial.set_user_attr("member", self._seed[1])
            found.append((trial, design_of(self._shape, self._space.at(shares))))
        return found

    def tell(self, answers: Sequence[tuple[Any, Evaluated]]) -> None:
        """What was found of proposals."""
        for trial, one in answers:
            if trial is None:
                continue
            trial.set_user_attr(_EXCESS, self._excess(one))
            self._study.tell(trial, self._values(one))

    def _sampler(self, batch: int) -> optuna.samplers.BaseSampler:
        import optuna

        seed = int(np.random.SeedSequence([*self._seed, batch]).generate_state(1)[0])
        with warnings.catch_warnings():
            # Constraints and multivariate sampling are called experimental; the version is pinned.
            warnings.simplefilter("ignore")
            if self._dear:
                return optuna.samplers.TPESampler(
                    seed=seed,
                    multivariate=True,
                    constant_liar=True,
                    n_startup_trials=0,
                    constraints_func=_constraints,
                )
            return optuna.samplers.NSGAIISampler(
                population_size=POPULATION, seed=seed, constraints_func=_constraints
            )

    def _values(self, one: Evaluated) -> list[float]:
        if one.reason:
            return [_NONE] * len(self._requirements.objectives)
        values = one.objectives(self._requirements.objectives)
        return [value if np.isfinite(value) else _NONE for value in values]

    def _excess(self, one: Evaluated) -> list[float]:
        """How far each limit is exceeded; a design that cannot be built exceeds all."""
        bounds = list(bounded(self._requirements.limits))
        if one.reason:
            return [10.0] * max(len(bounds), 1)
        found = []
        for criterion, bound in bounds:
            value = one.numbers.get(criterion.key)
            excess = -1.0 if value is None else excess_of(criterion, value, bound)
            found.append(float(np.clip(np.nan_to_num(excess, nan=0.0), -1.0, 10.0)))
        return found or [0.0]


def _constraints(trial: Any) -> Sequence[float]:
    found: Sequence[float] = trial.user_attrs[_EXCESS]
    return found


def _distribution() -> Any:
    import optuna

    return optuna.distributions.FloatDistribution(0.0, 1.0)
