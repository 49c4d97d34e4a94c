"""The posterior of a psychometric function on a grid, integrated by the midpoint rule.

Every parameter runs over quantiles of its own prior, so that all cells weigh the same before the
data. A coarse grid over the whole prior finds where the posterior lies; a fine one covers that.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm.errors import InputError
from squeezefilm.quantities import Dimensionless, FloatArray, require
from squeezefilm.study import psychometric_kernel as kernel
from squeezefilm.study.psychometric import Axis
from squeezefilm.study.psychometric_prior import PsychometricPrior

PARAMETERS = ("threshold", "width", "lapse_rate", "guess_rate")

_COARSE = (40, 24, 8, 8)
_FINE = (48, 40, 20, 20)
# Marginal probability outside of the fine grid, on each side.
_OUTSIDE = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class PsychometricPosterior:
    """Marginal posteriors of a psychometric function.

    Attributes:
        axis: of the function.
        edges: for each parameter the bounds of the cells, shape (cells + 1,), in the parameter's
            own unit (threshold as an intensity, width on the axis).
        probability: of the cells, shape (thresholds, widths, lapse rates, guess rates); sums to 1.
        log_evidence: ln of the likelihood's mean over the prior, without binomial coefficients.
    """

    axis: Axis
    edges: tuple[FloatArray, FloatArray, FloatArray, FloatArray]
    probability: FloatArray
    log_evidence: float

    def marginal(self, parameter: str) -> FloatArray:
        """Probability of each cell of one parameter, shape (cells,).

        Raises:
            InputError: an unknown parameter.
        """
        at = _index(parameter)
        return np.asarray(
            self.probability.sum(axis=tuple(other for other in range(4) if other != at))
        )

    def quantile(self, parameter: str, share: Dimensionless) -> float:
        """The value not exceeded with posterior probability `share`, in the parameter's unit.

        The probability is taken to be spread evenly over a cell in the prior's quantiles.

        Raises:
            InputError: an unknown parameter, or a share not within 0 and 1.
        """
        require("share", share, at_least=0.0, at_most=1.0)
        heights = np.concatenate([[0.0], np.cumsum(self.marginal(parameter))])
        return float(np.interp(share * heights[-1], heights, self.edges[_index(parameter)]))

    def interval(self, parameter: str, level: Dimensionless = 0.95) -> tuple[float, float]:
        """The central credible interval: as much probability below it as above it.

        Raises:
            InputError: an unknown parameter, or a level not between 0 and 1.
        """
        require("level", level, above=0.0, below=1.0)
        tail = 0.5 * (1.0 - level)
        return self.quantile(parameter, tail), self.quantile(parameter, 1.0 - tail)

    def mean(self, parameter: str) -> float:
        """The posterior mean, in the parameter's unit."""
        edges = self.edges[_index(parameter)]
        return float(np.sum(self.marginal(parameter) * 0.5 * (edges[1:] + edges[:-1])))

    def draws(self, count: int, seed: int) -> FloatArray:
        """Samples of (threshold, width, lapse rate, guess rate), shape (count, 4).

        For whatever is computed from several parameters. Within a cell samples are spread evenly.
        """
        random = np.random.default_rng(seed)
        flat = random.choice(self.probability.size, count, p=self.probability.ravel())
        cells = np.unravel_index(flat, self.probability.shape)
        within = random.random((count, 4))
        return np.stack(
            [
                edges[cell] + within[:, at] * (edges[cell + 1] - edges[cell])
                for at, (edges, cell) in enumerate(zip(self.edges, cells, strict=True))
            ],
            axis=1,
        )


def _index(parameter: str) -> int:
    if parameter not in PARAMETERS:
        raise InputError(
            f"parameter = {parameter!r} is not known; it must be one of {', '.join(PARAMETERS)}",
            quantity="parameter",
        )
    return PARAMETERS.index(parameter)


def grid_posterior(
    code: int,
    axis: Axis,
    prior: PsychometricPrior,
    guess_rate: Dimensionless | None,
    x: FloatArray,
    k: FloatArray,
    n: FloatArray,
    *,
    cells: tuple[int, int, int, int] = _FINE,
) -> tuple[PsychometricPosterior, FloatArray]:
    """The posterior, and the θ of the coarse cell of largest ln density, to start a search from.

    Args:
        code: of the shape.
        axis, prior: of the function.
        guess_rate: where it is known (1); None where it is fitted.
        x: places on the axis; k: answers; n: trials; all of shape (places,).
        cells: of the fine grid along threshold, ln width, lapse rate and guess rate.
    """
    low, high = np.zeros(4), np.ones(4)
    coarse = _one_guess(_COARSE, guess_rate)
    nodes, weights, _ = _weigh(code, axis, prior, guess_rate, x, k, n, low, high, coarse)
    for at in range(4):
        marginal = weights.sum(axis=tuple(other for other in range(4) if other != at))
        total = np.cumsum(marginal)
        first = int(np.searchsorted(total, _OUTSIDE)) - 1
        last = int(np.searchsorted(total, 1.0 - _OUTSIDE)) + 2
        low[at] = max(first, 0) / coarse[at]
        high[at] = min(last, coarse[at]) / coarse[at]
    best = np.unravel_index(int(np.argmax(weights)), weights.shape)
    start = np.array([node[cell] for node, cell in zip(nodes, best, strict=True)])
    _, weights, peak = _weigh(
        code, axis, prior, guess_rate, x, k, n, low, high, _one_guess(cells, guess_rate)
    )
    evidence = peak + float(np.log(np.prod(high - low)))
    edges = []
    for at, size in enumerate(weights.shape):
        share = low[at] + (high[at] - low[at]) * np.arange(size + 1) / size
        theta = _values(prior, guess_rate, at, share, axis)
        as_width = at == kernel.LOG_WIDTH or (at == kernel.THRESHOLD and axis == "log")
        edges.append(np.exp(theta) if as_width else theta)
    posterior = PsychometricPosterior(
        axis, (edges[0], edges[1], edges[2], edges[3]), weights, evidence
    )
    return posterior, start


def _one_guess(
    cells: tuple[int, int, int, int], guess_rate: float | None
) -> tuple[int, int, int, int]:
    return cells if guess_rate is None else (*cells[:3], 1)


def _values(
    prior: PsychometricPrior,
    guess_rate: float | None,
    at: int,
    share: FloatArray,
    axis: Axis,
) -> FloatArray:
    if at == kernel.GUESS and guess_rate is not None:
        return np.full(share.shape, guess_rate)
    return prior.quantile(at, share, axis)


def _weigh(
    code: int,
    axis: Axis,
    prior: PsychometricPrior,
    guess_rate: float | None,
    x: FloatArray,
    k: FloatArray,
    n: FloatArray,
    low: FloatArray,
    high: FloatArray,
    cells: tuple[int, int, int, int],
) -> tuple[list[FloatArray], FloatArray, float]:
    """Nodes, probabilities of the cells, and ln of the mean likelihood of the part covered."""
    nodes = []
    for at, size in enumerate(cells):
        share = low[at] + (high[at] - low[at]) * (np.arange(size) + 0.5) / size
        nodes.append(_values(prior, guess_rate, at, share, axis))
    weights = kernel.grid_log_likelihood(code, *nodes, x, k, n)
    largest = float(weights.max())
    np.exp(weights - largest, out=weights)
    total = float(weights.sum())
    weights /= total
    return nodes, weights, largest + float(np.log(total / weights.size))
