"""What a finger's own sliding adds to the film: a wedge effect, three orders below the squeeze.

In the Reynolds equation sliding at U stands as 6 η U ∂(ph)/∂x beside 12 η ∂(ph)/∂t. Over a
symmetric plateau of width w the term is odd in U and changes the load only by (U/(ω w))², the
square of how far a finger slides in 1/ω over that width: 1e-5 at 0.1 m/s. Over a plateau leaning
against the surface it carries a wedge pressure, computed here.
"""

from __future__ import annotations

import numpy as np

from squeezefilm import quantities as si


@si.closed_form(
    positive="speed width mean_gap viscosity closing", nonnegative="amplitude"
)  # closing → 0 is a parallel plateau, which carries nothing
def wedge_pressure(
    speed: si.MetrePerSecondLike,
    width: si.MetreLike,
    mean_gap: si.MetreLike,
    amplitude: si.MetreLike,
    closing: si.DimensionlessLike,
    viscosity: si.PascalSecond,
) -> si.PascalLike:
    """The mean pressure (Pa) under a leaning plateau that slides; broadcasts.

    p = 6 η U w/h² · [ln(1 + n) − 2n/(2 + n)]/n², h the gap at its narrow edge and h (1 + n) at
    its wide one, n = `closing`; h⁻² is averaged over h = u − a cos T: u/(u² − a²)^{3/2}, quasi-
    steady. Reynolds 1886, incompressible, infinitely long plateau, no slip: an upper estimate.
    For n = 1 the bracket is 0.0265, and n = 1.19 gives the most.
    """
    mean_square = mean_gap / (mean_gap**2 - amplitude**2) ** 1.5
    shape = (np.log(1 + closing) - 2 * closing / (2 + closing)) / closing**2
    return 6 * viscosity * speed * width * mean_square * shape
