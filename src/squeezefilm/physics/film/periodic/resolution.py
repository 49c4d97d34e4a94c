"""Films for compiled code, and numbers of cells and times for a tolerance: first guess, and what to
do when it was not enough.

The guesses were fitted to measured errors. They only save time: what is returned is judged by
the error estimate of the solve itself, and refined until that meets the tolerance.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Literal, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si

STRIP, DISC = 0, 1


class Films(NamedTuple):
    """Many films of one shape and law of slip, both by their numbers: squeeze number, excursion
    ratio, polytropic exponent and Knudsen number of each."""

    squeeze_number: si.FloatArray
    excursion_ratio: si.FloatArray
    polytropic_exponent: si.FloatArray
    knudsen_number: si.FloatArray
    law: int
    shape: int

    @property
    def planform(self) -> Literal["strip", "disc"]:
        """Name of the shape."""
        return "strip" if self.shape == STRIP else "disc"

    def at(self, which: si.IntArray) -> Films:
        """Those of some indices."""
        sigma, eps, n, kn = (column[which] for column in self[:4])
        return Films(sigma, eps, n, kn, self.law, self.shape)


class PeriodTimes(NamedTuple):
    """The collocation times of a period: how many, the length of their padded row, the transposed
    Fourier differentiation matrix, and one minus the unit matrix, both flattened."""

    number: int
    row: int
    derivative: si.FloatArray
    mask: si.FloatArray


class Cells(NamedTuple):
    """Conductance of the faces, σ × volume of the cells, and the share of the area of each node."""

    conductance: si.FloatArray
    volume: si.FloatArray
    share: si.FloatArray


class GridGap(NamedTuple):
    """The gap at the nodes and faces of the finest grid, one after the other, and the weights of p
    in the mean load at its nodes: rows of times. The gap's row at a grid's first node begins at
    `first`, that at the next `stride` further on: 0 where the gap does not depend on position."""

    gap: si.FloatArray
    weight: si.FloatArray
    first: int
    stride: int


class SolveRoom(NamedTuple):
    """Memory for a solve: rows of times, and the inverses of the diagonal blocks."""

    rows: si.FloatArray
    blocks: si.FloatArray


class FilmResolution(NamedTuple):
    """Cells of the finest grid, its times, and the times that check them on the coarsest grid."""

    cells: int
    times: PeriodTimes
    check: PeriodTimes


CELLS = np.array([4, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512, 768])
TIMES = np.array([5, 7, 9, 11, 13, 15, 19, 23, 27, 31, 39, 47, 63, 79, 95, 127, 159])
CHECKS = np.array([7, 9, 13, 15, 19, 19, 23, 31, 31, 39, 47, 63, 79, 95, 127, 159, 191])
"""Numbers of times, and the larger ones that check each of them on the coarsest grid."""


def derivative(count: int) -> si.FloatArray:
    """The spectral derivative on an odd number of points over a period."""
    k = np.arange(count)
    d = k[:, None] - k[None, :]
    angle = np.pi * d / count
    sine = np.where(d == 0, 1.0, np.sin(angle))
    return np.where(d == 0, 0.0, 0.5 * (-1.0) ** d / sine)


@lru_cache(maxsize=64)
def collocation_times(nt: int) -> PeriodTimes:
    """Times of a period, so many, with what is computed with them.

    `nt` is odd: an even number leaves the highest harmonic without a derivative.
    """
    ntp = 8 * ((nt + 7) // 8)  # `lanes.LANES` at once: what names it loads numba
    DT = np.zeros((nt, ntp))
    DT[:, :nt] = derivative(nt).T
    return PeriodTimes(nt, ntp, DT.ravel(), 1.0 - np.eye(nt, ntp).ravel())


def resolution_of(cells: int, times: int) -> FilmResolution:
    """Cells of the finest grid, the times at an index into `TIMES`, and those that check them."""
    return FilmResolution(
        cells, collocation_times(int(TIMES[times])), collocation_times(int(CHECKS[times]))
    )


def first_guess(
    squeeze_number: si.FloatArray,
    excursion_ratio: si.FloatArray,
    knudsen_number: si.FloatArray,
    tolerance: float,
    least_cells: int = 4,
    least_times: int = 5,
) -> tuple[si.IntArray, si.IntArray]:
    """Indices into `CELLS` and `TIMES` that probably meet a relative tolerance on W − 1."""
    sigma = squeeze_number / (1.0 + 6.0 * knudsen_number)
    layer = np.sqrt(np.sqrt(1.0 + sigma / 60.0))
    cells = 4.0 * (0.008 / tolerance) ** 0.25 * layer**0.6
    a = np.log(np.maximum(sigma, 0.03))
    q = np.sqrt(np.arctanh(excursion_ratio))
    d = np.log(np.log10(1.0 / min(0.5 * tolerance, 0.01)))
    times = np.exp(
        0.7123
        + 0.2144 * d
        + 0.1161 * d * d
        + a * (0.0328 - 0.0199 * d + a * (-0.0144 + 0.0014 * a))
        + q * (1.6309 + 0.1814 * d - 0.4562 * q + a * (-0.2191 + 0.0251 * q + 0.007 * a))
    )
    # Four cells are too few to judge the edge layer by.
    least = np.where(sigma > 30.0, max(8, least_cells), least_cells)
    chosen_cells = np.searchsorted(CELLS, np.maximum(0.87 * cells, least))
    chosen_times = np.searchsorted(TIMES, np.maximum(0.99 * times, least_times))
    return (
        np.minimum(chosen_cells, len(CELLS) - 1),
        np.minimum(chosen_times, len(TIMES) - 1),
    )


def refined(
    cells: si.IntArray,
    times: si.IntArray,
    space: si.FloatArray,
    time: si.FloatArray,
    allowed: si.FloatArray,
) -> tuple[si.IntArray, si.IntArray]:
    """The next indices for cases whose errors in space and time exceed what is allowed.

    A case that gave no numbers at all (NaN) had too few times for a deep excursion.
    """
    lost = ~np.isfinite(space + time)
    space_ratio = np.where(lost, 0.0, space / allowed)
    time_ratio = np.where(lost, 10.0, time / allowed)
    wanted = CELLS[cells] * np.maximum(space_ratio / 0.5, 1.0) ** 0.25
    more_cells = np.searchsorted(CELLS, 0.95 * wanted)
    more_cells = np.where(space_ratio > 0.5, np.maximum(more_cells, cells + 1), cells)
    steps = np.where(time_ratio > 300.0, 3, np.where(time_ratio > 15.0, 2, 1))
    more_times = np.where(time_ratio > 0.45, times + steps, times)
    return np.minimum(more_cells, len(CELLS) - 1), np.minimum(more_times, len(TIMES) - 1)
