"""What gas and asperities carry on a plateau in the mean over a period: a value of the film table,
and asperities without compiled code."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.special import i0e

from squeezefilm.physics.contact.asperities import AsperityLaw
from squeezefilm.physics.contact.sharing.gas_table import FilmTable, complete
from squeezefilm.physics.contact.sharing.kernel import CompiledFilms, film_value


def over_pressure(table: FilmTable, mean_gap: Any, amplitude: Any) -> Any:
    """⟨p_gas⟩ − p0 (Pa) at a mean gap and an amplitude (m); broadcasts. NaN off the table."""

    def at(gap: float, swing: float) -> float:
        value = np.nan

        def lacking(films: CompiledFilms) -> int:
            nonlocal value
            value, lack = film_value(0, gap, swing, films)
            return lack

        complete(table, lacking)
        return value

    return np.vectorize(at, otypes=[float])(mean_gap, amplitude)


def mean_pressure(law: AsperityLaw, mean_gap: Any, amplitude: Any) -> Any:
    """⟨p_a(u − a cos T)⟩ (Pa); broadcasts. Closed form (I0) for exponential heights; for Gaussian
    ones the trapezoidal rule, which converges spectrally (below 1e-9 for a up to 33 λ_r)."""
    u, a = np.broadcast_arrays(np.asarray(mean_gap, float), np.asarray(amplitude, float))
    if law.heights == "exponential":
        return np.asarray(law.pressure(u - a) * i0e(a / law.decay_length))[()]
    phase = np.cos(2 * np.pi * np.arange(128) / 128)
    return np.mean(np.asarray(law.pressure(u[..., None] - a[..., None] * phase)), axis=-1)[()]
