"""Bayesian choice of the next stimulus: the one whose answer is expected to tell the most.

The method of Kontsevich & Tyler 1999 (10.1016/S0042-6989(98)00285-5), with the lapse rate as a
nuisance that may be integrated out before the entropy is taken (Prins 2013, 10.1167/13.7.3) and
with the mutual information computed as the entropy of the expected answer less the expected
entropy of the answer, which is the same and needs one pass over the grid.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.compiled import compiled
from squeezefilm.core.errors import InputError
from squeezefilm.study.psychometric import kernel
from squeezefilm.study.psychometric.function import (
    Axis,
    PsychometricPrior,
    Shape,
    on_axis,
    shape_code,
)

Interest = Literal["threshold and width", "all"]


@reads_text
@si.checked_numbers
@dataclass(frozen=True, slots=True)
class AdaptiveDesign:
    """Start of a Bayesian choice of stimuli.

    Args:
        stimuli: intensities to choose from, two or more, in the unit of the stimulus.
        prior: of the parameters; its grid is of quantiles, so flat where the prior is.
        shape, axis: of the psychometric function.
        guess_rate: known, at least 0 and at most 0.5.
        cells: of the grid of threshold, ln width and lapse rate.
        interest: "threshold and width", where the lapse rate is integrated out before the
            entropy is taken, or "all".
        most_trials: after which it ends, at least 1.

    Raises:
        InputError: a value outside its range.
    """

    stimuli: tuple[float, ...]
    prior: PsychometricPrior
    shape: Shape = "logistic"
    axis: Axis = "linear"
    guess_rate: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(0.5)] = 0.5
    cells: Annotated[tuple[int, int, int], si.AtLeast(1)] = (40, 20, 5)
    interest: Interest = "threshold and width"
    most_trials: Annotated[int, si.AtLeast(1)] = 120

    def __post_init__(self) -> None:
        shape_code(self.shape, self.axis)
        if len(self.stimuli) < 2:
            raise InputError(f"stimuli = {self.stimuli} leaves nothing to choose; give two or more")
        self._require_room()

    def _require_room(self) -> None:
        """Refuse a domain in which no answer changes what is presented. Raises `InputError`."""
        if self.cells[0] == 1 and self.cells[1] == 1:
            raise InputError(
                "cells of one threshold and one width leave nothing to be learned; give more",
                quantity="cells",
            )
        places = on_axis(np.array(self.stimuli), self.axis)
        low, high = (float(value) for value in on_axis(np.array(self.prior.threshold), self.axis))
        widest = self.prior.width[1]
        if places.max() + widest < low or places.min() - widest > high:
            raise InputError(
                "every stimulus lies further from the thresholds of the prior than the widest "
                "function reaches, so that no answer tells anything; move one of them",
                quantity="stimuli",
            )


@dataclass(frozen=True, slots=True)
class AdaptiveTrial:
    """An answer: the intensity shown, and whether it was positive (correct, or yes)."""

    intensity: float
    positive: bool


class BayesianAdaptive:
    """A Bayesian choice of stimuli as it runs. `next_stimulus`, then `update`, until `finished`.

    Nothing in it is random: the design and the answers so far are all its state, and playing them
    again (`update`) gives the choice that was interrupted.
    """

    def __init__(self, design: AdaptiveDesign) -> None:
        self.design = design
        self._nodes = _nodes(design)
        self._table = _table(design)
        self._weights = np.full(self._table.shape[0], 1.0 / self._table.shape[0])
        self._trials: list[AdaptiveTrial] = []

    @property
    def trials(self) -> tuple[AdaptiveTrial, ...]:
        """The answers so far."""
        return tuple(self._trials)

    @property
    def finished(self) -> bool:
        """True where it has its trials."""
        return len(self._trials) >= self.design.most_trials

    @property
    def probability(self) -> si.DimensionlessArray:
        """The posterior on the grid, shape `design.cells`; sums to 1."""
        return self._weights.reshape(self.design.cells).copy()

    def estimate(self) -> tuple[float, float]:
        """Posterior mean of the threshold (in the stimulus' unit; of ln intensity on a
        logarithmic axis) and posterior geometric mean of the width. For intervals use a fit."""
        weights = self.probability
        place = float(np.sum(weights.sum(axis=(1, 2)) * self._nodes[0]))
        width = float(np.exp(np.sum(weights.sum(axis=(0, 2)) * self._nodes[1])))
        return (float(np.exp(place)) if self.design.axis == "log" else place), width

    def expected_information(self) -> si.FloatArray:
        """Mutual information of the next answer and what is of interest (nat), shape (stimuli,)."""
        # The lapse rate runs fastest over the cells.
        nuisance = 1 if self.design.interest == "all" else self.design.cells[2]
        return information(self._weights, self._table, nuisance)

    def next_stimulus(self) -> float:
        """The intensity whose answer tells the most; of equals the first in `design.stimuli`.

        Raises:
            InputError: all trials have been made.
        """
        self._require_room()
        return float(self.design.stimuli[int(np.argmax(self.expected_information()))])

    def update(self, intensity: float, positive: bool) -> None:
        """Take in an answer, to whatever intensity was shown.

        Raises:
            InputError: an intensity off the axis, or all trials have been made.
        """
        self._require_room()
        intensity = float(intensity)
        if intensity in self.design.stimuli:
            psi = self._table[:, self.design.stimuli.index(intensity)]
        else:
            psi = _probabilities(self.design, np.atleast_1d(on_axis(intensity, self.design.axis)))[
                :, 0
            ]
        weights = self._weights * (psi if positive else 1.0 - psi)
        total = float(weights.sum())
        if not total > 0.0:
            raise InputError(
                f"the answer {bool(positive)} at intensity {intensity:g} is impossible under "
                "every parameter of the prior; widen it",
                quantity="intensity",
            )
        self._weights = weights / total
        self._trials.append(AdaptiveTrial(intensity, bool(positive)))

    def _require_room(self) -> None:
        if self.finished:
            raise InputError(f"all {self.design.most_trials} trials have been made; start another")


def _nodes(design: AdaptiveDesign) -> list[si.FloatArray]:
    """Threshold, ln width and lapse rate of the grid."""
    return [
        design.prior.quantile(at, (np.arange(size) + 0.5) / size, design.axis)
        for at, size in enumerate(design.cells)
    ]


@functools.lru_cache(maxsize=8)
def _table(design: AdaptiveDesign) -> si.FloatArray:
    """ψ of every cell at the stimuli: (cells, stimuli), for everybody whose design it is."""
    probabilities = _probabilities(design, on_axis(np.array(design.stimuli), design.axis))
    probabilities.flags.writeable = False
    return probabilities


def _probabilities(design: AdaptiveDesign, places: si.FloatArray) -> si.FloatArray:
    """ψ of every cell at places on the axis: (cells, places)."""
    code = shape_code(design.shape, design.axis)
    m, w, lapse = _nodes(design)
    rise = np.stack(
        [
            kernel.probabilities(code, np.array([mean, width, 0.0, 0.0]), places)
            for mean in m
            for width in w
        ]
    )
    guess = design.guess_rate
    psi = guess + np.maximum(1.0 - guess - lapse[None, :, None], 0.0) * rise[:, None, :]
    return np.ascontiguousarray(psi.reshape(-1, places.size))


@compiled(error_model="numpy")
def _term(p: float) -> float:
    """−p ln p."""
    return -p * math.log(p) if p > 0.0 else 0.0


@compiled(error_model="numpy")
def information(weights: si.FloatArray, chances: si.FloatArray, nuisance: int) -> si.FloatArray:
    """Mutual information (nat) of the next of two answers and what is of interest, shape
    (stimuli,).

    `weights` (cells,) sum to 1; `chances` (cells, stimuli) are the probabilities of one answer. Of
    every `nuisance` cells in a row only the sum is of interest.
    """
    cells, stimuli = chances.shape
    told, total, joint = np.zeros(stimuli), np.zeros(stimuli), np.empty(stimuli)
    for first in range(0, cells, nuisance):
        share = 0.0
        for cell in range(first, first + nuisance):
            share += weights[cell]
        if share <= 0.0:
            continue
        joint[:] = 0.0
        for cell in range(first, first + nuisance):
            weight, chance = weights[cell], chances[cell]
            for at in range(stimuli):
                joint[at] += weight * chance[at]
        for at in range(stimuli):
            total[at] += joint[at]
            told[at] -= share * (_term(joint[at] / share) + _term((share - joint[at]) / share))
    for at in range(stimuli):
        told[at] += _term(total[at]) + _term(1.0 - total[at])
    return told
