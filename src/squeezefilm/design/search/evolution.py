"""Who proposes designs: a genetic algorithm where they are screened, a Bayesian sampler where they
are solved; both are Optuna's, with a journal on disk that several hosts may share."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from squeezefilm.core.errors import InputError, optional
from squeezefilm.design.search.candidate import (
    Design,
    Evaluated,
    Level,
    design_of,
    rough_frequency,
)
from squeezefilm.design.search.criteria import bounded, excess_of
from squeezefilm.design.search.journal import usable_journal
from squeezefilm.design.search.requirements import Requirements
from squeezefilm.design.search.store import asked_hash, requirements_hash

if TYPE_CHECKING:
    import optuna

JOURNAL = "journal.log"
"""Its name in the folder of a search."""

POPULATION = 100

# Of so many random designs for each of the first generation those are taken whose frequency is
# allowed, where it is bounded on both sides: of random plates one in twenty has 40 kHz ± 5 %.
_LOOKED_AT = 40

# In place of an objective that is infinite or not known, which no sampler takes.
_NONE = 1e6
# Optuna's own name for it, beside a trial: above 0 where a limit is not kept.
_EXCESS = "constraints"
_GENERATION = "NSGAIISampler:generation"
_MEMBER = "member"


class Proposals:
    """One Optuna study: the designs of one shape, proposed in batches and answered in batches.

    What is to be screened is proposed by NSGA-II (Deb et al. 2002, 10.1109/4235.996017), what is to
    be solved by a tree-structured Parzen estimator (Ozaki et al. 2020, 10.1145/3377930.3389817),
    since that takes long: the `level`. A first generation is aimed at a frequency that limits bound
    on both sides. The seed and the number of the batch decide what is proposed: whoever asks again
    from the beginning is proposed the same. In a `folder` what was answered is published in a
    journal; hosts that search there, each with a `member` of its own, learn from each other's
    answers.
    """

    def __init__(
        self,
        requirements: Requirements,
        shape: int,
        level: Level,
        folder: Path | None,
        seed: int,
        *,
        member: int = 0,
    ) -> None:
        with optional("design", "a search of designs"):
            import optuna

        optuna.logging.set_verbosity(optuna.logging.ERROR)
        self._requirements, self._shape, self._level = requirements, shape, level
        self._seed, self._member = (seed, member, shape, int(level == "solved")), member
        self._space = requirements.spaces[shape]
        directions = [optuna.study.StudyDirection.MINIMIZE] * len(requirements.objectives)
        self._study = optuna.create_study(directions=directions)
        self._shared: Any = None
        self.is_rebuilt = False
        self._others, self._published, self._told = 0, 0, 0
        if folder is not None:
            # A folder may have answers to other requirements, of which these values are none.
            whose = f"{asked_hash(requirements, level)} {requirements_hash(requirements)[:16]}"
            self._journal = folder / JOURNAL
            storage, self.is_rebuilt = usable_journal(self._journal)
            self._shared = optuna.create_study(
                study_name=f"{self._space.shape}, {level}, seed {seed}, {whose}",
                storage=storage,
                directions=directions,
                load_if_exists=True,
            )
            self._published = len(self._of_members(own=True))

    def _of_members(self, *, own: bool) -> list[Any]:
        """The published trials of this member, or of all others."""
        try:
            every = self._shared.get_trials(deepcopy=False)
        # Optuna reads what was added since, and fails anywhere where that is damaged.
        except Exception as error:
            raise InputError(
                f"{self._journal} was damaged while the search ran ({type(error).__name__}); start "
                "it again: it goes on from what is kept of its designs"
            ) from error
        return [one for one in every if (one.user_attrs.get(_MEMBER) == self._member) == own]

    def known(self, found: Iterable[Evaluated]) -> None:
        """Tell of designs that somebody else proposed, so that the sampler learns from them."""
        for one in found:
            places = self._space.places(one.design.settings)
            self._study.add_trial(_trial(places, self._values(one), self._excess(one)))

    def publish_again(self, found: Iterable[tuple[Evaluated, int]]) -> None:
        """Publish what other members found, where the journal was lost (`is_rebuilt`).

        What this one found it publishes when it is told of it again.
        """
        for answer, member in found:
            places = self._space.places(answer.design.settings)
            own = {_MEMBER: member}
            self._shared.add_trial(_trial(places, self._values(answer), self._excess(answer), own))

    def ask(self, count: int, batch: int) -> list[tuple[Any, Design]]:
        """So many designs, each with the trial that is to be told of."""
        if self._shared is not None:
            others = self._of_members(own=False)
            for one in others[self._others :]:
                excess = one.system_attrs.get(_EXCESS, [0.0])
                trial = _trial(one.params, one.values, excess)
                # As one of the generation that the next one is bred from.
                trial.system_attrs[_GENERATION] = max(batch - 1, 0)
                self._study.add_trial(trial)
            self._others = len(others)
        self._study.sampler = self._sampler(batch)
        if self._level == "screened" and batch == 0:
            for places in self._aimed(count):
                self._study.enqueue_trial(places)
        found = []
        for _ in range(count):
            trial = self._study.ask()
            shares = {one.name: trial.suggest_float(one.name, 0.0, 1.0) for one in self._space.free}
            found.append((trial, design_of(self._shape, self._space.at(shares))))
        return found

    def _aimed(self, count: int) -> list[dict[str, float]]:
        """Places of at most so many random designs whose rough frequency is allowed; none where the
        frequency is not bounded on both sides."""
        limits = self._requirements.limits
        low, high = limits.least_frequency, limits.most_frequency
        found: list[dict[str, float]] = []
        if low is None or high is None:
            return found
        draw = np.random.default_rng(self._seed)
        for _ in range(_LOOKED_AT * count):
            places = {one.name: float(draw.random()) for one in self._space.free}
            design = design_of(self._shape, self._space.at(places))
            if low <= rough_frequency(self._requirements, design) <= high:
                found.append(places)
            if len(found) == count:
                break
        return found

    def tell(self, answers: Sequence[tuple[Any, Evaluated]]) -> None:
        """What was found of proposals."""
        for trial, one in answers:
            values, excess = self._values(one), self._excess(one)
            trial.set_user_attr(_EXCESS, excess)
            self._study.tell(trial, values)
            self._told += 1
            # What a search that was stopped has published is there.
            if self._shared is not None and self._told > self._published:
                own = {_MEMBER: self._member}
                self._shared.add_trial(_trial(trial.params, values, excess, own))

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


def _trial(
    params: dict[str, float],
    values: Sequence[float],
    excess: Sequence[float],
    attrs: dict[str, Any] | None = None,
) -> Any:
    """A finished trial of designs' places, with its constraints where Optuna looks for them."""
    import optuna

    return optuna.trial.create_trial(
        params=params,
        distributions={name: optuna.distributions.FloatDistribution(0.0, 1.0) for name in params},
        values=list(values),
        system_attrs={_EXCESS: list(excess)},
        user_attrs=attrs or {},
    )


def _constraints(trial: Any) -> Sequence[float]:
    found: Sequence[float] = trial.user_attrs[_EXCESS]
    return found
