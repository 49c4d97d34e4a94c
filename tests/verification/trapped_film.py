"""The film as σ → ∞, when its gas is trapped, by its defining means."""

from __future__ import annotations

import numpy as np

from squeezefilm.core.quantities import FloatLike


def trapped_load(amplitude_ratio: FloatLike, n: float = 1.0) -> FloatLike:
    """The mean load over ambient pressure, Ψⁿ⟨H⁻ⁿ⟩ with H = 1 + ε cos T.

    Ψ = [⟨H³⟩/⟨H^(2−n)⟩]^(1/(n+1)). Isothermal
    √((1 + 1.5 ε²)/(1 − ε²)): Salbu 1964, 10.1115/1.3653080.
    """
    phase = 2 * np.pi * np.arange(1024) / 1024
    gap = 1 + np.multiply.outer(amplitude_ratio, np.cos(phase))
    psi = ((gap**3).mean(axis=-1) / (gap ** (2 - n)).mean(axis=-1)) ** (1 / (n + 1))
    load: FloatLike = psi**n * (gap**-n).mean(axis=-1)
    return load
