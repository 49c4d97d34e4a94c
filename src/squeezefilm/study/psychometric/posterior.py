"""The posterior of a psychometric function on a grid, integrated by the midpoint rule.

The grid is even in the threshold on its axis, in ln width and in arcsin √rate, where a proportion
is equally sure everywhere. Coarse grids, the first over the whole prior, find where the posterior
lies; a fine one covers that.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

from squeezefilm.core import quantities as si
from squeezefilm.study.psychometric import kernel
from squeezefilm.study.psychometric.function import LARGEST_RATE, Axis, PsychometricPrior

PARAMETERS = ("threshold", "width", "lapse_rate", "guess_rate")

_COARSE = (40, 24, 8, 6)
_FINE = (48, 40, 20, 1)
_FINE_WITH_GUESS = (40, 32, 14, 14)
# Grids narrow until none of their sides shrinks by more than this.
_SETTLED = 0.8
_MOST_PASSES = 8
# Marginal probability outside of the fine grid, on each side.
_OUTSIDE = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Answered:
    """Answers, and the function that is to explain them.

    Attributes:
        code: of the shape.
        axis, prior: of the function.
        guess_rate: where it is known (1); None where it is fitted.
        x, k, n: places on the axis, answers, trials, shape (places,).
    """

    code: int
    axis: Axis
    prior: PsychometricPrior
    guess_rate: si.Dimensionless | None
    x: si.FloatArray
    k: si.FloatArray
    n: si.FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class PsychometricPosterior:
    """Marginal posteriors of a psychometric function.

    Attributes:
        edges: for each parameter the bounds of the cells, shape (cells + 1,), in the parameter's
            own unit (threshold as an intensity, width on the axis).
        probability: of the cells, shape (thresholds, widths, lapse rates, guess rates); sums to 1.
    """

    edges: tuple[si.FloatArray, si.FloatArray, si.FloatArray, si.FloatArray]
    probability: si.FloatArray

    def marginal(self, parameter: str) -> si.FloatArray:
        """Probability of each cell of one parameter, shape (cells,).

        Raises:
            InputError: an unknown parameter.
        """
        at = _index(parameter)
        return np.asarray(
            self.probability.sum(axis=tuple(other for other in range(4) if other != at))
        )

    def quantile(self, parameter: str, share: si.Dimensionless) -> float:
        """The value not exceeded with posterior probability `share`, in the parameter's unit.

        Between the edges of cells the cumulative probability is a monotone cubic.

        Raises:
            InputError: an unknown parameter, or a share not within 0 and 1.
        """
        si.require("share", share, at_least=0.0, at_most=1.0)
        edges = self.edges[_index(parameter)]
        if edges[0] == edges[-1]:
            return float(edges[0])
        middle = self.marginal(parameter)
        # The integral over a cell from the values in the middle of it and of its neighbours.
        bend = np.diff(np.pad(middle, 1, mode="reflect", reflect_type="odd"), 2)
        cells = np.maximum(middle + bend / 24, 0.0)
        heights = np.concatenate([[0.0], np.cumsum(cells)])
        places = np.interp(np.linspace(0, edges.size - 1, 2001), np.arange(edges.size), edges)
        return float(
            np.interp(share, PchipInterpolator(edges, heights / heights[-1])(places), places)
        )

    def interval(self, parameter: str, level: si.Dimensionless = 0.95) -> tuple[float, float]:
        """The central credible interval: as much probability below it as above it.

        Raises:
            InputError: an unknown parameter, or a level not between 0 and 1.
        """
        si.require("level", level, above=0.0, below=1.0)
        tail = 0.5 * (1.0 - level)
        return self.quantile(parameter, tail), self.quantile(parameter, 1.0 - tail)


def _index(parameter: str) -> int:
    si.require_one_of("parameter", parameter, PARAMETERS)
    return PARAMETERS.index(parameter)


def coarse_maxima(answered: Answered) -> si.FloatArray:
    """θ of the likeliest cells of a coarse grid over the whole prior, to start searches from.

    One for each sixth of the widths, shape (6, 4): few answers can have a narrow and a wide
    function as local maxima.
    """
    low, high = _span(answered)
    cells = _one_guess(_COARSE, answered.guess_rate)
    nodes, weights = _weigh(answered, low, high, cells)
    starts = []
    for first in range(0, cells[1], cells[1] // 6):
        band = weights[:, first : first + cells[1] // 6]
        i, j, a, b = np.unravel_index(int(np.argmax(band)), band.shape)
        starts.append([nodes[0][i], nodes[1][first + j], nodes[2][a], nodes[3][b]])
    return np.array(starts)


def grid_posterior(answered: Answered, mode: si.FloatArray) -> PsychometricPosterior:
    """The posterior of threshold, width, lapse rate and, where it is not known, guess rate.

    Args:
        answered: the answers, and what is to explain them.
        mode: θ of the largest ln density, shape (4,); the grid never loses it.
    """
    guess_rate = answered.guess_rate
    low, high = _span(answered)
    coarse = _one_guess(_COARSE, guess_rate)
    centre = [_coordinate(at, mode[at]) for at in range(4)]
    for _ in range(_MOST_PASSES):
        _, weights = _weigh(answered, low, high, coarse)
        before = high - low
        for at in range(4):
            marginal = weights.sum(axis=tuple(other for other in range(4) if other != at))
            total = np.cumsum(marginal)
            cell = (high[at] - low[at]) / coarse[at]
            first = low[at] + cell * (int(np.searchsorted(total, _OUTSIDE)) - 1)
            last = low[at] + cell * (int(np.searchsorted(total, 1.0 - _OUTSIDE)) + 2)
            low[at], high[at] = (
                max(low[at], min(first, centre[at] - cell)),
                min(high[at], max(last, centre[at] + cell)),
            )
        if np.all(high - low >= _SETTLED * before):
            break
    fine = _FINE if guess_rate is not None else _FINE_WITH_GUESS
    _, weights = _weigh(answered, low, high, fine)
    edges = []
    for at, size in enumerate(fine):
        theta = _theta(at, np.linspace(low[at], high[at], size + 1))
        as_logarithm = at == kernel.LOG_WIDTH or (at == kernel.THRESHOLD and answered.axis == "log")
        edges.append(np.exp(theta) if as_logarithm else theta)
    return PsychometricPosterior((edges[0], edges[1], edges[2], edges[3]), weights)


def _one_guess(
    cells: tuple[int, int, int, int], guess_rate: float | None
) -> tuple[int, int, int, int]:
    return cells if guess_rate is None else (*cells[:3], 1)


def _coordinate(at: int, theta: si.FloatLike) -> si.FloatArray:
    """Coordinate of a θ on the grid."""
    rate = at in (kernel.LAPSE, kernel.GUESS)
    return np.asarray(np.arcsin(np.sqrt(theta)) if rate else theta)


def _theta(at: int, coordinate: si.FloatArray) -> si.FloatArray:
    rate = at in (kernel.LAPSE, kernel.GUESS)
    return np.asarray(np.sin(coordinate) ** 2 if rate else coordinate)


def _span(answered: Answered) -> tuple[si.FloatArray, si.FloatArray]:
    """Lowest and highest coordinates of the whole prior; equal for a rate that is known."""
    low, high = answered.prior.bounds(answered.axis)
    if answered.guess_rate is not None:
        low[kernel.GUESS] = high[kernel.GUESS] = answered.guess_rate
    else:
        high[kernel.GUESS] = LARGEST_RATE
    return (
        np.array([_coordinate(at, low[at]) for at in range(4)]),
        np.array([_coordinate(at, high[at]) for at in range(4)]),
    )


def _weigh(
    answered: Answered, low: si.FloatArray, high: si.FloatArray, cells: tuple[int, int, int, int]
) -> tuple[list[si.FloatArray], si.FloatArray]:
    """Nodes (θ), and probabilities of the cells."""
    a, nodes, masses = answered, [], []
    for at, size in enumerate(cells):
        edges = np.linspace(low[at], high[at], size + 1)
        known = a.guess_rate if at == kernel.GUESS else None
        middle = 0.5 * (edges[1:] + edges[:-1])
        # To and fro through the coordinate a known rate would lose its last digit.
        theta = _theta(at, middle) if known is None else np.array([known])
        nodes.append(theta)
        # dθ/dφ of θ = sin²φ.
        stretch = np.sin(2 * middle) if at in (kernel.LAPSE, kernel.GUESS) else 1.0
        cell = np.diff(edges) * stretch
        whole = known is not None
        masses.append(np.ones(1) if whole else a.prior.density(at, theta, a.axis) * cell)
    m, w, lapse, guess = nodes
    weights = kernel.grid_log_likelihood(a.code, m, w, lapse, guess, a.x, a.k, a.n)
    np.exp(weights - weights.max(), out=weights)
    weights *= masses[0][:, None, None, None] * masses[1][:, None, None]
    weights *= masses[2][:, None] * masses[3]
    weights /= weights.sum()
    return nodes, weights
