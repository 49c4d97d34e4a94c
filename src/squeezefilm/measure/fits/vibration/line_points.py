"""Waves along a line: the columns of bending waves with the near fields of the ends; and nodes and
antinodes by the points around each, where one even wave does not fit.

A plate with ceramics on it has no single wave number; its nodal lines and antinodes are still
where they are. A cubic through the points within a third of a half wavelength finds them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.measure.fits.estimate import Estimate, interval_around
from squeezefilm.measure.fits.least_squares import SeparableFit, linear_fit


@dataclass(frozen=True, eq=False)
class LineWaves:
    """The columns of waves along a line from `first` to `last` (m).

    The shape is k, then for complex data the decay over k.
    """

    first: si.Metre
    last: si.Metre
    complex: bool
    free_ends: bool

    @property
    def length(self) -> si.Metre:
        """Length of the line (m)."""
        return self.last - self.first

    @property
    def count(self) -> int:
        """Number of numbers that bend the columns."""
        return 2 if self.complex else 1

    def reach(self, wave_number: float) -> si.FloatArray:
        """Distance that the shape may go from its start."""
        return np.array([wave_number / 3, 0.25][: self.count])

    def waves(self, x: si.MetreArray, shape: si.FloatArray) -> si.Array:
        """The columns (points, waves): forward, backward, and the near fields of the ends."""
        k, middle = shape[0], (self.first + self.last) / 2
        if self.complex:
            turn = (1j * k + k * shape[1]) * (x - middle)
            rows = [np.exp(-turn), np.exp(turn)]
        else:
            rows = [np.cos(k * (x - middle)), np.sin(k * (x - middle))]
        if self.free_ends:
            rows += [np.exp(-k * (x - self.first)), np.exp(-k * (self.last - x))]
        return np.stack(rows, axis=1)

    def wave(self, x: si.MetreArray, shape: si.FloatArray, weights: si.Array) -> si.Array:
        """The sum of the columns by their weights, (points,)."""
        return np.asarray(self.waves(x, shape) @ weights)

    def columns(self, x: si.MetreArray, shape: si.FloatArray) -> tuple[si.Array, si.Array]:
        """The columns and their derivatives by central differences of them."""
        bent = []
        for i in range(shape.size):
            step = np.zeros(shape.size)
            step[i] = 1e-6 * (shape[0] if i == 0 else 1.0)
            above, below = self.waves(x, shape + step), self.waves(x, shape - step)
            bent.append((above - below) / (2 * step[i]))
        return self.waves(x, shape), np.stack(bent)


_REACH = 0.35
_FEWEST = 6
_DENSE = 24


@dataclass(frozen=True, eq=False)
class LinePoints:
    """A standing wave's displacement `w` (m, real or complex) at rising `x` (m), of about this
    `half_wavelength` (m)."""

    x: si.MetreArray
    w: si.Array
    half_wavelength: si.Metre

    @cached_property
    def swing(self) -> si.MetreArray:
        """The displacement along the direction in which most of the line swings."""
        if not np.iscomplexobj(self.w):
            return np.asarray(self.w, dtype=float)
        return np.asarray((self.w * np.exp(-0.5j * np.angle(np.sum(self.w**2)))).real)

    @cached_property
    def _smooth(self) -> tuple[si.MetreArray, si.MetreArray]:
        """A dense row of places, and the local cubics' values there."""
        count = 1 + _DENSE * int(np.ceil(np.ptp(self.x) / self.half_wavelength))
        dense = np.linspace(self.x[0], self.x[-1], count)
        values = np.full(count, np.nan)
        for i, place in enumerate(dense):
            fit = self._around(float(place))
            if fit is not None:
                values[i] = fit.weights[0]
        good = np.isfinite(values)
        return dense[good], values[good]

    def _around(self, place: si.Metre) -> SeparableFit | None:
        """The cubic around a place, over the reach; None for fewer than 6 points there."""
        reach = _REACH * self.half_wavelength
        near = np.abs(self.x - place) < reach
        if near.sum() < _FEWEST:
            return None
        matrix = np.vander((self.x[near] - place) / reach, 4, increasing=True)
        return linear_fit(matrix, self.swing[near])

    @cached_property
    def nodes(self) -> tuple[Estimate, ...]:
        """Places where the displacement changes its sign (m)."""
        x, w = self._smooth
        crossings = []
        for i in np.flatnonzero(np.signbit(w[1:]) != np.signbit(w[:-1])):
            place = float(x[i] - w[i] * (x[i + 1] - x[i]) / (w[i + 1] - w[i]))
            fit = self._around(place)
            if fit is not None:
                crossings.append(self._crossing(fit, place))
        return tuple(crossings)

    def _crossing(self, fit: SeparableFit, place: si.Metre) -> Estimate:
        """The zero of a cubic next to its middle."""
        reach = _REACH * self.half_wavelength

        def crossing(_: si.FloatArray, weights: si.Array) -> float:
            at = 0.0
            for _step in range(4):
                value = np.polynomial.polynomial.polyval(at, weights)
                slope = weights[1] + 2 * weights[2] * at + 3 * weights[3] * at**2
                at -= float(value / slope)
            return place + reach * at

        return fit.estimate(crossing, "m")

    @property
    def spacing(self) -> Estimate | None:
        """The mean distance of nodes (m); of six or more without the outermost at each end, which
        the free edges' near fields move: as the library's half wavelength. None of fewer than 2."""
        nodes = self.nodes[1:-1] if len(self.nodes) >= 6 else self.nodes
        if len(nodes) < 2:
            return None
        first, last, count = nodes[0], nodes[-1], len(nodes) - 1
        error = float(np.hypot(first.standard_error, last.standard_error)) / count
        freedom = 2 * _FEWEST
        return interval_around((last.value - first.value) / count, error, freedom, "m")

    @property
    def antinode(self) -> tuple[si.Metre, Estimate] | None:
        """Place where the displacement is largest between the outermost nodes, and how large (m);
        None of fewer than 2 nodes."""
        if len(self.nodes) < 2:
            return None
        x, w = self._smooth
        between = (x > self.nodes[0].value) & (x < self.nodes[-1].value)
        if not between.any():
            return None
        place = float(x[between][np.argmax(np.abs(w[between]))])
        fit = self._around(place)
        if fit is None:
            return None
        size = fit.estimate(lambda _, weights: float(abs(weights[0])), "m")
        return place, size
