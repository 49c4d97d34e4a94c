"""Bending waves along a line, forward and backward, with the near fields of its ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si


@dataclass(frozen=True, eq=False)
class LineWaves:
    """The columns of waves along a line from `first` to `last` (m).

    The shape is k, then for complex data the decay over k, then the drift's two numbers (one).
    """

    first: si.Metre
    last: si.Metre
    complex: bool
    free_ends: bool
    drift: bool

    @property
    def length(self) -> si.Metre:
        """Of the line (m)."""
        return self.last - self.first

    @property
    def count(self) -> int:
        """How many numbers bend the columns."""
        own = 2 if self.complex else 1
        return own + (own if self.drift else 0)

    def reach(self, wave_number: float) -> si.FloatArray:
        """How far the shape may go from its start."""
        rows = [wave_number / 3] + ([0.25] if self.complex else [])
        return np.array(rows + [2.0] * (self.count - len(rows)))

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
        found = np.stack(rows, axis=1)
        if not self.drift:
            return found
        rate = shape[-2] + 1j * shape[-1] if self.complex else shape[-1]
        return np.asarray(found * (1 + rate * (x - middle) / self.length)[:, None])

    def columns(self, x: si.MetreArray, shape: si.FloatArray) -> tuple[si.Array, si.Array]:
        """The columns and their derivatives by central differences of them."""
        bent = []
        for i in range(shape.size):
            step = np.zeros(shape.size)
            step[i] = 1e-6 * (shape[0] if i == 0 else 1.0)
            above, below = self.waves(x, shape + step), self.waves(x, shape - step)
            bent.append((above - below) / (2 * step[i]))
        return self.waves(x, shape), np.stack(bent)
