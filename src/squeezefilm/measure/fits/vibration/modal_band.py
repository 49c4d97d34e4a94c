"""Modes over a band of frequencies: the columns that a fit weighs, and poles to start from."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import optional


@dataclass(frozen=True, eq=False)
class ModalBand:
    """Frequencies `f` (Hz, (points,)) and the columns of modes over them.

    A mode's numbers are f_k over `middle`, less 1, and its loss 1/Q_k; a delay's is 2πτ `width`.
    """

    f: si.HertzArray
    middle: si.Hertz
    width: si.Hertz

    @classmethod
    def over(cls, f: si.HertzArray) -> ModalBand:
        """The band of rising frequencies (Hz)."""
        return cls(f, float((f[0] + f[-1]) / 2), float(f[-1] - f[0]))

    @cached_property
    def place(self) -> si.FloatArray:
        """Frequencies from the middle, over the width."""
        return (self.f - self.middle) / self.width

    def columns(self, shape: si.FloatArray) -> tuple[si.ComplexArray, si.ComplexArray]:
        """Modes, a constant and a slope; their derivatives by every number of `shape`."""
        count = shape.size // 2
        matrix = np.empty((self.f.size, count + 2), dtype=complex)
        bent = np.zeros((2 * count, self.f.size, count + 2), dtype=complex)
        squared = (self.f / self.middle) ** 2
        for k in range(count):
            own, loss = 1 + shape[2 * k], shape[2 * k + 1]
            below = own**2 * (1 + 1j * loss) - squared
            matrix[:, k] = own**2 / below
            bent[2 * k, :, k] = -2 * own * squared / below**2
            bent[2 * k + 1, :, k] = -1j * own**4 / below**2
        matrix[:, count] = 1.0
        matrix[:, count + 1] = self.place
        return matrix, bent

    def delayed(self, shape: si.FloatArray) -> tuple[si.ComplexArray, si.ComplexArray]:
        """The same behind a delay, the last number of `shape`."""
        matrix, bent = self.columns(shape[:-1])
        turn = np.exp(-1j * shape[-1] * self.f / self.width)[:, None]
        late = -1j * (self.f / self.width)[:, None] * turn * matrix
        return turn * matrix, np.concatenate([turn * bent, late[None]])

    def shape_of(self, modes: list[tuple[float, float]]) -> si.FloatArray:
        """The numbers of modes of these frequencies (Hz) and losses."""
        return np.array([one for f, loss in modes for one in (f / self.middle - 1, loss)])


def band_poles(band: ModalBand, H: si.ComplexArray, count: int) -> list[tuple[float, float]]:
    """Poles by sdypy-EMA's least-squares complex-frequency fit; those that the residual needs most.

    Takes an even row of frequencies, so that what was recorded is interpolated for it.
    """
    import contextlib
    import io
    import warnings

    with optional("measure", "a modal fit"):
        from sdypy import EMA

    f = np.linspace(band.f[0], band.f[-1], max(2 * band.f.size, 400))
    even = np.interp(f, band.f, H.real) + 1j * np.interp(f, band.f, H.imag)
    # Its polynomials take frequencies from zero: the band is moved down, which changes no width, to
    # a fifth of itself above zero, so that no pole is taken for its own mirror image.
    below = float(f[0]) - band.width / 5
    shifted = f - below
    with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
        warnings.simplefilter("ignore")
        model = EMA.Model(
            even[None, :],
            shifted,
            lower=0.99 * float(shifted[0]),
            upper=1.01 * float(shifted[-1]),
            pol_order_high=min(6 * count, 60),
            frf_form="receptance",
        )
        model.get_poles(method="lscf", show_progress=False)
    found: list[tuple[float, float]] = []
    for row in model.all_poles:
        for pole in np.ravel(row):
            own, width = abs(pole.imag) / (2 * np.pi) + below, -2 * pole.real / (2 * np.pi)
            if band.f[0] < own < band.f[-1] and 0 < width < band.width:
                found.append((float(own), float(width / own)))
    return _chosen(band, H, found, count)


def _chosen(
    band: ModalBand, H: si.ComplexArray, poles: list[tuple[float, float]], count: int
) -> list[tuple[float, float]]:
    """One pole after the other, each the one that leaves least of the response."""
    chosen: list[tuple[float, float]] = []
    remainder = band.columns(np.empty(0))[0]
    columns = [band.columns(band.shape_of([one]))[0][:, 0] for one in poles]
    for _ in range(min(count, len(poles))):
        basis = np.linalg.qr(remainder)[0]
        left = H - basis @ (basis.conj().T @ H)
        gains = []
        for column in columns:
            own = column - basis @ (basis.conj().T @ column)
            size = np.linalg.norm(own)
            least = 1e-3 * np.linalg.norm(column)
            gains.append(float(abs(np.vdot(own, left)) / size) if size > least else 0.0)
        best = int(np.argmax(gains))
        chosen.append(poles[best])
        remainder = np.column_stack([remainder, columns[best]])
    return chosen
