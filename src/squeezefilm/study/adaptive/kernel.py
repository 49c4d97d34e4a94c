"""The compiled parts of adaptive methods: what an answer is expected to tell, and whole runs.

A run is simulated by the same rules as `Staircase` and `BayesianAdaptive` follow trial by trial;
tests hold the two together.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.study.psychometric import kernel

EXACT: si.FloatArray = np.empty(0)
"""In place of a table of entropies: take logarithms."""
# Probability below which what is of interest counts for nothing in a simulated run.
_LEAST = 1e-6
# Places on an axis that differ by less are one stimulus.
_SAME = 1e-9


class Rule(NamedTuple):
    """A staircase on its own axis; fields as those of `StaircaseRule`."""

    start: float
    step: float
    smallest_step: float
    down_after: int
    up_ratio: float
    lowest: float
    highest: float
    reversals: int
    most_trials: int


def entropies(size: int = 4096) -> si.FloatArray:
    """Entropy (nat) of two answers at `size` steps of p from 0 on and one beyond 1, to be
    interpolated: within 2e-5, and within 3e-7 for p from 3 to 97 %; quicker than logarithms."""
    p = np.arange(1, size) / size
    inside = -p * np.log(p) - (1.0 - p) * np.log1p(-p)
    return np.concatenate([[0.0], inside, [0.0, 0.0]])


@compiled(error_model="numpy")
def _term(p: float) -> float:
    """−p ln p."""
    return -p * math.log(p) if p > 0.0 else 0.0


@compiled(error_model="numpy")
def _pair(p: float, table: si.FloatArray) -> float:
    """The entropy of two answers, from a table."""
    place = p * (table.size - 2)
    below = int(place)
    return float(table[below] + (place - below) * (table[below + 1] - table[below]))


@compiled(error_model="numpy")
def information(
    weights: si.FloatArray,
    chances: si.FloatArray,
    nuisance: int,
    least: float,
    table: si.FloatArray,
    told: si.FloatArray,
) -> None:
    """Mutual information (nat) of the next answer and what is of interest, of every stimulus.

    `weights` (cells,) sum to 1; `chances` (answers − 1, cells, stimuli) are the probabilities of
    all answers but the last. Of every `nuisance` cells in a row only the sum is of interest; those
    whose sum is below `least` are left out. A `table` of `entropies` serves two answers; `EXACT`
    takes logarithms. Fills `told` (stimuli,).
    """
    answers, cells, stimuli = chances.shape
    total = np.zeros((answers, stimuli))
    joint = np.empty((answers, stimuli))
    told[:] = 0.0
    whole = 0.0
    for first in range(0, cells, nuisance):
        share = 0.0
        for cell in range(first, first + nuisance):
            share += weights[cell]
        if share <= least:
            continue
        whole += share
        joint[:] = 0.0
        for answer in range(answers):
            here = joint[answer]
            for cell in range(first, first + nuisance):
                weight, chance = weights[cell], chances[answer, cell]
                for at in range(stimuli):
                    here[at] += weight * chance[at]
        if table.size:
            here, sure = joint[0], 1.0 / share
            for at in range(stimuli):
                total[0, at] += here[at]
                told[at] -= share * _pair(here[at] * sure, table)
            continue
        for at in range(stimuli):
            rest, known = share, 0.0
            for answer in range(answers):
                rest -= joint[answer, at]
                total[answer, at] += joint[answer, at]
                known += _term(joint[answer, at] / share)
            told[at] -= share * (known + _term(rest / share))
    for at in range(stimuli):
        rest, guessed = 1.0, 0.0
        for answer in range(answers):
            p = total[answer, at] / whole
            rest -= p
            guessed += _term(p)
        told[at] = told[at] / whole + guessed + _term(rest)


@compiled(error_model="numpy")
def run_bayesian(
    prior: si.FloatArray,
    chances: si.FloatArray,
    nuisance: int,
    table: si.FloatArray,
    places: si.FloatArray,
    shape: int,
    theta: si.FloatArray,
    among: si.FloatArray,
    x: si.FloatArray,
    y: si.FloatArray,
) -> None:
    """Runs of Bayesian choices of two answers with simulated people of the function θ.

    `places` (stimuli,) and θ are on the axis of the function. The random numbers `among`
    (runs, trials), uniform in 0 to 1, say the answers. Fills places `x` and answers `y`, its shape.
    """
    psi = kernel.probabilities(shape, theta, places)
    told = np.empty(places.size)
    for run in range(among.shape[0]):
        weights = prior.copy()
        for trial in range(among.shape[1]):
            information(weights, chances, nuisance, _LEAST, table, told)
            at = int(np.argmax(told))
            positive = among[run, trial] < psi[at]
            x[run, trial], y[run, trial] = places[at], 1.0 if positive else 0.0
            whole = 0.0
            for cell in range(weights.size):
                p = chances[0, cell, at]
                weights[cell] *= p if positive else 1.0 - p
                whole += weights[cell]
            weights /= whole


@compiled(error_model="numpy")
def run_staircase(
    rule: Rule,
    change: int,
    shape: int,
    theta: si.FloatArray,
    among: si.FloatArray,
    x: si.FloatArray,
    y: si.FloatArray,
) -> None:
    """Runs of a staircase with simulated people of the function θ, as `run_bayesian`.

    `change` takes a level to the axis of the function: 0 as it is, 1 its exponential, −1 its
    logarithm. Trials after the last reversal are NaN.
    """
    for run in range(among.shape[0]):
        level, step = rule.start, rule.step
        streak, before, turns = 0, 0, 0
        x[run], y[run] = np.nan, np.nan
        for trial in range(among.shape[1]):
            if turns >= rule.reversals:
                break
            place = level if change == 0 else math.exp(level) if change > 0 else math.log(level)
            s, _, _ = kernel.sigmoid(shape, (place - theta[0]) / math.exp(theta[1]))
            right = among[run, trial] < theta[3] + (1.0 - theta[3] - theta[2]) * s
            x[run, trial], y[run, trial] = place, 1.0 if right else 0.0
            streak = streak + 1 if right else 0
            direction = 0
            if not right:
                direction = 1
            elif streak == rule.down_after:
                direction, streak = -1, 0
            if direction != 0:
                if before != 0 and before != direction:
                    turns += 1
                    if 0.5 * step >= rule.smallest_step:
                        step *= 0.5
                before = direction
                level += step * (rule.up_ratio if direction > 0 else -1.0)
                level = min(max(level, rule.lowest), rule.highest)


@compiled(error_model="numpy")
def gather(
    x: si.FloatArray, y: si.FloatArray, k: si.FloatArray, n: si.FloatArray, used: si.IntArray
) -> None:
    """Put the trials of each run at one place together: `x` is changed to the places of a run,
    rising, `k` and `n` (of its shape) become right answers and trials, `used` (runs,) how many
    places a run has. NaN are no trials."""
    for run in range(x.shape[0]):
        order = np.argsort(x[run])
        places, answers = x[run][order], y[run][order]
        last = -1
        for trial in range(places.size):
            if np.isnan(places[trial]):
                break
            if last < 0 or places[trial] > x[run, last] + _SAME:
                last += 1
                x[run, last], k[run, last], n[run, last] = places[trial], 0.0, 0.0
            k[run, last] += answers[trial]
            n[run, last] += 1.0
        used[run] = last + 1
