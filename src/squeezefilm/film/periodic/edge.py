"""The edge layer of a film at high squeeze number, where the film falls to ambient pressure."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.film.periodic.batch import solve_films

_SIGMA = 3600.0


@dataclass(frozen=True)
class EdgeLayer:
    """C(ε) of W = W∞ − C/√σ for a strip with two edges, W∞, and the error of C."""

    constant: si.Dimensionless
    constant_error: si.Dimensionless
    asymptotic_load: si.Dimensionless
    excursion_ratio: si.Dimensionless
    polytropic_exponent: si.Dimensionless
    model: str


@si.checked_numbers
def edge_layer(
    excursion_ratio: si.Dimensionless,
    *,
    polytropic_exponent: si.Dimensionless = 1.0,
    relative_accuracy: Annotated[float, si.AtLeast(1e-6), si.AtMost(1e-2)] = 1e-5,
) -> EdgeLayer:
    """The edge-layer constant C(ε) of a strip without slip: W = W∞ − C/√σ as σ → ∞.

    The half-space problem (M = P^{1/n}H, its value H at the edge and constant far inside, in the
    coordinate √σ x) is a strip wide enough that its edges do not feel each other: at σ = 3600 what
    is left between them is below e^-20, and W∞ − W at that σ is C/√σ with no further term. W∞ is
    Salbu's limit, √((1 + 1.5 ε²)/(1 − ε²)) for n = 1. `constant_error` is the estimate of the
    solve; `relative_accuracy` (1e-6 to 1e-2) is what is asked of it. Holds for |ε| to 0.95.

    Raises `InputError` for an ε of 0 (C is 0 there and has no relative accuracy), |ε| > 0.95 or an
    n outside 1 to 5/3.
    """
    si.require("excursion_ratio", abs(excursion_ratio), at_least=1e-3, at_most=0.95)
    si.require("polytropic_exponent", polytropic_exponent, at_least=1.0, at_most=5.0 / 3.0)
    n = polytropic_exponent
    H = 1.0 + excursion_ratio * np.cos(2.0 * np.pi * np.arange(512) / 512)
    psi = (np.mean(H**3) / np.mean(H ** (2.0 - n))) ** (1.0 / (n + 1.0))
    limit = float(psi**n * np.mean(H ** (-n)))
    root = float(np.sqrt(_SIGMA))
    # C/√σ is about an eightieth of the over-pressure here: the solve must be that much finer.
    tolerance = max(relative_accuracy / 80.0, 2e-9)
    batch = solve_films(
        _SIGMA, excursion_ratio, polytropic_exponent=n, tolerance=tolerance, workers=1
    )
    return EdgeLayer(
        constant=root * (limit - float(batch.mean_load)),
        constant_error=root * float(batch.over_pressure_error),
        asymptotic_load=limit,
        excursion_ratio=excursion_ratio,
        polytropic_exponent=n,
        model=f"{batch.model}, σ = {_SIGMA:g}",
    )
