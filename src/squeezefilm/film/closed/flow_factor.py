"""Slip at the walls: how much more gas flows than the viscous film alone would let through.

The factor φ multiplies H³ in the Reynolds equation. It depends on the *local* Knudsen number,
mean free path over gap. The free path goes with 1/p, so it is Kn/(P H) where the film is
compressed to P and H.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.film.slip import slip_law


@si.checked_numbers
def flow_factor(
    local_knudsen_number: Annotated[si.DimensionlessLike, si.AtLeast(0.0)], slip: str = "first"
) -> si.FloatLike:
    """The factor φ by which slip raises the flow of a film at a local Knudsen number λ/h.

    - ``"first"``: 1 + 6 Kn, Burgdorfer 1959 (J. Basic Eng. 81, 94); good below Kn ≈ 0.1.
    - ``"second"``: 1 + 6 Kn + 6 Kn², Hsia & Domoto 1983 (J. Lubr. Technol. 105, 120).
    - ``"fukui-kaneko"``: the fitted Poiseuille flow rates of the linearised Boltzmann equation,
      full accommodation, Fukui & Kaneko 1990 (10.1115/1.2920234), for 0.01 ≤ √π/(2 Kn); their
      three ranges are blended over ±20 % of the joints at 0.15 and 5.
      The coefficients were not compared with the printed paper; they give its Knudsen minimum.
    - ``"veijola"``: 1 + 9.638 Kn^1.159, a fit for 0 ≤ Kn ≤ 880, Veijola et al. 1995
      (10.1016/0924-4247(95)00995-7).

    Takes and returns scalars or arrays. Raises `InputError` for an unknown law or a Knudsen
    number that is negative or not finite.
    """
    # numba is loaded by who computes, not by who imports the closed forms.
    from squeezefilm.film.slip_kernel import slip_factor

    law = slip_law(slip, 1.0)
    given = np.asarray(local_knudsen_number, dtype=float)
    flat = [slip_factor(law, float(k))[0] for k in given.ravel()]
    if given.ndim == 0:
        return float(flat[0])
    return np.array(flat).reshape(given.shape)
