"""Confidence intervals after an adaptive run: a bootstrap whose people are asked adaptively too.

Places that depended on the answers cannot be kept when other answers are simulated: a bootstrap
that keeps them covers too seldom. Here every replicate is the whole procedure, each stimulus chosen
by the answers that came before it, and the test is inverted as for constant stimuli
(`psychometric.bootstrap`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.study.adaptive import kernel
from squeezefilm.study.adaptive.bayesian import AdaptiveDesign, BayesianAdaptive
from squeezefilm.study.adaptive.staircase import StaircaseRule
from squeezefilm.study.psychometric.bootstrap import Simulated
from squeezefilm.study.psychometric.fit import (
    Interval,
    PsychometricFit,
    confidence_intervals,
    likelihood_of,
    opened,
)
from squeezefilm.study.psychometric.function import Axis, on_axis

Procedure = StaircaseRule | AdaptiveDesign


@si.checked_numbers
def rerun_intervals(
    fit: PsychometricFit,
    procedures: Sequence[Procedure],
    *,
    level: si.Dimensionless = 0.95,
    replicates: int = 499,
    seed: int = 0,
    parameters: tuple[str, ...] | None = None,
) -> dict[str, Interval]:
    """Confidence interval by parameter, in its unit, of a function fitted after adaptive runs.

    Args:
        fit: of the answers of all runs together; its answers are "correct" of the staircases and
            "positive" of the Bayesian choices.
        procedures: what chose the stimuli, one for each run, from their designs.
        level: of the intervals, between 0 and 1.
        replicates: simulated experiments, at least 39.
        seed: of the simulated answers.
        parameters: those wanted, such as ("threshold",); all that were fitted without.

    A replicate of 200 Bayesian choices takes some 10 ms, one of staircases next to nothing; each
    end of an interval takes one set of replicates or two.

    Raises:
        InputError: no procedure, a parameter that was not fitted, a number out of range, a
            staircase that reaches nought where the function has a logarithmic axis, or more answers
            than the procedures ask for, or fewer than those that ask a fixed number do.
    """
    si.require("level", level, above=0.0, below=1.0)
    si.require("replicates", replicates, at_least=39)
    _require_trials(fit, procedures)
    wanted = fit.fitted if parameters is None else parameters
    for name in wanted:
        si.require_one_of("parameters", name, fit.fitted)
    likelihood, best = likelihood_of(fit)
    axis = fit.function.axis
    random = np.random.default_rng(seed)
    among = [random.random((replicates, procedure.most_trials)) for procedure in procedures]
    again = _Again(likelihood.code, axis, tuple(procedures), among)
    found = confidence_intervals(likelihood, best, again, wanted, level, axis)
    return {name: opened(fit.function, name, ends) for name, ends in found.items()}


def _require_trials(fit: PsychometricFit, procedures: Sequence[Procedure]) -> None:
    if not procedures:
        raise InputError("no procedure chose the stimuli; give the rule or design of each run")
    trials, most = int(fit.trials.sum()), sum(procedure.most_trials for procedure in procedures)
    fixed = sum(
        procedure.most_trials for procedure in procedures if isinstance(procedure, AdaptiveDesign)
    )
    if not fixed <= trials <= most:
        raise InputError(
            f"the fit has {trials} answers, and the procedures ask for {fixed} to {most}; give the "
            "procedure of every run, each with the most_trials that it had",
            quantity="procedures",
        )


def simulate_runs(
    procedure: Procedure,
    shape: int,
    axis: Axis,
    theta: si.FloatArray,
    among: si.DimensionlessArray,
) -> tuple[si.FloatArray, si.FloatArray]:
    """Places on the axis of a function θ of the kernel's `shape`, and answers, of simulated runs.

    `among` are uniform random numbers, shape (runs, most trials), as are both results; NaN after
    a staircase's last reversal. Raises `InputError` for a staircase that reaches nought on a
    logarithmic axis.
    """
    x, y = np.empty_like(among), np.empty_like(among)
    if isinstance(procedure, StaircaseRule):
        rule, change = _rule(procedure, axis)
        kernel.run_staircase(rule, change, shape, theta, among, x, y)
        return x, y
    method = BayesianAdaptive(procedure)
    kernel.run_bayesian(
        method.probability.ravel(), method.chances, method.nuisance, kernel.entropies(),
        on_axis(np.array(procedure.stimuli), axis), shape, theta, among, x, y,
    )  # fmt: skip
    return x, y


def _rule(rule: StaircaseRule, axis: Axis) -> tuple[kernel.Rule, int]:
    """The rule on its own axis, and how its levels come to another's."""

    def level(one: float) -> float:
        return (math.log(one) if one > 0 else -math.inf) if rule.axis == "log" else one

    if axis == "log" and rule.axis == "linear" and rule.lowest <= 0.0:
        raise InputError(
            f"a staircase that may reach {rule.lowest:g} has no place on a logarithmic axis; give "
            "it a lowest above 0, or fit on a linear axis",
            quantity="lowest",
        )
    change = {("log", "linear"): 1, ("linear", "log"): -1}.get((rule.axis, axis), 0)
    return (
        kernel.Rule(
            level(rule.start), rule.step, rule.smallest_step, rule.down_after, rule.up_ratio,
            level(rule.lowest), level(rule.highest), rule.reversals, rule.most_trials,
        ),
        change,
    )  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class _Again:
    """The procedures once more, with the same random numbers for every truth."""

    shape: int
    axis: Axis
    procedures: tuple[Procedure, ...]
    among: list[si.DimensionlessArray]

    @property
    def dear(self) -> bool:
        """Bayesian choices take longer than fits."""
        return any(isinstance(procedure, AdaptiveDesign) for procedure in self.procedures)

    def __call__(self, theta: si.FloatArray) -> Simulated:
        runs = [
            simulate_runs(procedure, self.shape, self.axis, theta, among)
            for procedure, among in zip(self.procedures, self.among, strict=True)
        ]
        x, y = (np.concatenate(columns, axis=1) for columns in zip(*runs, strict=True))
        k, n = np.zeros_like(x), np.zeros_like(x)
        used = np.zeros(x.shape[0], dtype=np.int64)
        kernel.gather(x, y, k, n, used)
        return Simulated(x, k, n, used)
