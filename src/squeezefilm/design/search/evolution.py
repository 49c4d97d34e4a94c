"""Proposal of designs: a genetic algorithm where they are screened, a Bayesian sampler where they
are solved; both are Optuna's."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from squeezefilm.core.errors import optional
from squeezefilm.design.search.candidate import (
    Design,
    Evaluated,
    Level,
    design_of,
    rough_frequency,
)
from squeezefilm.design.search.criteria import bounded, excess_of
from squeezefilm.design.search.requirements import Requirements

if TYPE_CHECKING:
    import optuna

POPULATION = 100

# Of so many random designs for each of the first generation those are taken whose frequency is
# allowed, where it is bounded on both sides: of random plates one in twenty has 40 kHz ± 5 %.
_LOOKED_AT = 40

# In place of an objective that is infinite or not known, which no sampler takes.
_NONE = 1e6
# Optuna's own name for it, beside a trial: above 0 where a limit is not kept.
_EXCESS = "constraints"
_GENERATION = "NSGAIISampler:generation"


class Proposals:
    """An Optuna study: the designs of one shape, proposed in batches and answered in batches.

    What is to be screened is proposed by NSGA-II (Deb et al. 2002, 10.1109/4235.996017), what is to
    be solved by a tree-structured Parzen estimator (Ozaki et al. 2020, 10.1145/3377930.3389817),
    since that takes long: the `level`. A first generation is aimed at a frequency that limits bound
    on both sides. The seed, the number of the batch and what others found decide what is proposed:
    whoever asks again from the beginning is proposed the same. Hosts that search together, each
    with a `member` of its own, are proposed different designs.
    """

    def __init__(
        self, requirements: Requirements, shape: int, level: Level, seed: int, *, member: int = 0
    ) -> None:
        with optional("design", "a search of designs"):
            import optuna

        optuna.logging.set_verbosity(optuna.logging.ERROR)
        self._requirements, self._shape, self._level = requirements, shape, level
        self._seed = (seed, member, shape, int(level == "solved"))
        self._space = requirements.spaces[shape]
        directions = [optuna.study.StudyDirection.MINIMIZE] * len(requirements.objectives)
        self._study = optuna.create_study(directions=directions)
        self._others: set[Design] = set()

    def known(self, answers: Iterable[Evaluated], generation: int | None = None) -> None:
        """Tell of designs that somebody else proposed, so that the sampler learns from them: as
        of the generation that the next one is bred from, where it is given."""
        from optuna import distributions, trial

        share = distributions.FloatDistribution(0.0, 1.0)
        for answer in answers:
            places = self._space.places(answer.design.settings)
            finished = trial.create_trial(
                params=places,
                distributions=dict.fromkeys(places, share),
                values=self._values(answer),
                # Where Optuna looks for a finished trial's constraints.
                system_attrs={_EXCESS: self._excess(answer)},
            )
            if generation is not None:
                finished.system_attrs[_GENERATION] = generation
            self._study.add_trial(finished)

    def ask(
        self, count: int, batch: int, others: Iterable[Evaluated] = ()
    ) -> list[tuple[Any, Design]]:
        """Propose so many designs, each with the trial that is to be told of; `others` are all that
        other hosts have found until now of this shape at this level."""
        fresh = {answer.design: answer for answer in others if answer.design not in self._others}
        self._others.update(fresh)
        self.known(fresh.values(), max(batch - 1, 0))
        self._study.sampler = self._sampler(batch)
        if self._level == "screened" and batch == 0:
            for places in self._aimed(count):
                self._study.enqueue_trial(places)
        proposed = []
        for _ in range(count):
            trial = self._study.ask()
            shares = {
                variable.name: trial.suggest_float(variable.name, 0.0, 1.0)
                for variable in self._space.free
            }
            proposed.append((trial, design_of(self._shape, self._space.at(shares))))
        return proposed

    def _aimed(self, count: int) -> list[dict[str, float]]:
        """Places of at most so many random designs whose rough frequency is allowed; none where the
        frequency is not bounded on both sides."""
        limits = self._requirements.limits
        low, high = limits.least_frequency, limits.most_frequency
        allowed: list[dict[str, float]] = []
        if low is None or high is None:
            return allowed
        draw = np.random.default_rng(self._seed)
        for _ in range(_LOOKED_AT * count):
            places = {variable.name: float(draw.random()) for variable in self._space.free}
            design = design_of(self._shape, self._space.at(places))
            if low <= rough_frequency(self._requirements, design) <= high:
                allowed.append(places)
            if len(allowed) == count:
                break
        return allowed

    def tell(self, answers: Sequence[tuple[Any, Evaluated]]) -> None:
        """Take what was found of proposals."""
        for trial, answer in answers:
            trial.set_user_attr(_EXCESS, self._excess(answer))
            self._study.tell(trial, self._values(answer))

    def _sampler(self, batch: int) -> optuna.samplers.BaseSampler:
        import optuna

        seed = int(np.random.SeedSequence([*self._seed, batch]).generate_state(1)[0])
        with warnings.catch_warnings():
            # Constraints and multivariate sampling are called experimental; the version is pinned.
            warnings.simplefilter("ignore")
            if self._level == "solved":
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

    def _values(self, candidate: Evaluated) -> list[float]:
        if candidate.reason:
            return [_NONE] * len(self._requirements.objectives)
        values = candidate.objectives(self._requirements.objectives)
        return [value if np.isfinite(value) else _NONE for value in values]

    def _excess(self, candidate: Evaluated) -> list[float]:
        """Excess over each limit; a design that cannot be built exceeds all."""
        bounds = list(bounded(self._requirements.limits))
        if candidate.reason:
            return [10.0] * max(len(bounds), 1)
        excesses = []
        for criterion, bound in bounds:
            value = candidate.numbers.get(criterion.key)
            excess = -1.0 if value is None else excess_of(criterion, value, bound)
            excesses.append(float(np.clip(np.nan_to_num(excess, nan=0.0), -1.0, 10.0)))
        return excesses or [0.0]


def _constraints(trial: Any) -> Sequence[float]:
    excess: Sequence[float] = trial.user_attrs[_EXCESS]
    return excess
