"""What a rigid clamp does to a strip of plate that bends: next to it the width stays straight.

A strip bends across as it bends along, but at the clamp it cannot. Its deflection is taken as
f(x) + Σ g_n(x) φ_n(y) with even polynomials φ_n across the width whose mean is 0 (Kantorovich's
method, as a thin plate by D11, D12 and D66 per width). Least energy gives

    A g'''' + (X + Xᵀ − B) g'' + C g = h,     g = g' = 0 at the clamp,
    A = D11 <φφ>,  X = D12 <φ φ''>,  B = 4 D66 <φ'φ'>,  C = D11 <φ''φ''> − D12²/D11 <φ''><φ''>ᵀ,

whose solutions decay from the clamp. What is missing of the curvature across changes the curvature
along by D12/D11 of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.polynomial import Polynomial
from scipy.linalg import eig

from squeezefilm.core import quantities as si

# Of 4 and 6 polynomials the reach differs by less than 1 %.
_TERMS = 6


@si.checked_numbers
@dataclass(frozen=True)
class ClampHold:
    """The clamp's hold on a strip: what is missing of the curvature across, over that far away.

    `reach` (m) is its integral and `moment` (m²) that times x where the curvature starts from its
    far value; `tilted_reach` (m²) and `tilted_moment` (m³) are what a slope of the far value adds,
    per 1/m. `ratio` is D12/D11.
    """

    ratio: si.Dimensionless
    reach: si.Metre
    moment: si.SquareMetre
    tilted_reach: si.SquareMetre
    tilted_moment: Annotated[float, si.Unit("m3")]

    @classmethod
    @si.checked_numbers
    def of(
        cls,
        along: Annotated[float, si.Unit("N*m"), si.Above(0.0)],
        across: Annotated[float, si.Unit("N*m")],
        twist: Annotated[float, si.Unit("N*m"), si.Above(0.0)],
        width: Annotated[si.Metre, si.Above(0.0)],
    ) -> ClampHold:
        """Of a strip's D11, D12 and D66 per width (N·m) and its width (m). Source: derived above;
        checked against the plate room's solids.

        Raises `InputError` unless |D12| is below D11, as of every material that is stable.
        """
        si.require("across / along", across / along, above=-1.0, below=1.0)
        # In half widths, over which the mean of y^(2n) is 1/(2n + 1).
        powers = [Polynomial([0.0] * 2 * n + [1.0]) - 1 / (2 * n + 1) for n in range(1, _TERMS + 1)]

        def means(left: int, right: int) -> si.FloatArray:
            pairs = [
                [(p.deriv(left) * q.deriv(right)).integ()(1.0) for q in powers] for p in powers
            ]
            return np.array(pairs)

        bent = np.array([p.deriv(2).integ()(1.0) for p in powers])
        A, X, B = along * means(0, 0), across * means(0, 2), 4 * twist * means(1, 1)
        C = along * means(2, 2) - across**2 / along * np.outer(bent, bent)
        far = np.linalg.solve(C, bent)
        far /= bent @ far
        # s² A + s (X + Xᵀ − B) + C = 0 for s = r² of exp(−r x).
        one, none = np.eye(_TERMS), np.zeros((_TERMS, _TERMS))
        squares, vectors = eig(
            np.block([[none, one], [-C, B - X - X.T]]), np.block([[one, none], [none, A]])
        )
        r, shapes = np.sqrt(squares.astype(complex)), vectors[:_TERMS]
        ends = np.concatenate([shapes, -shapes * r])
        found = []
        for start in (np.concatenate([far, 0 * far]), np.concatenate([0 * far, far])):
            share = np.linalg.solve(ends, start) * (bent @ shapes)
            found += [float(np.real(np.sum(share / r))), float(np.real(np.sum(share / r**2)))]
        half = width / 2
        reach, moment, tilted_reach, tilted_moment = found
        return cls(
            across / along,
            reach * half,
            moment * half**2,
            tilted_reach * half**2,
            tilted_moment * half**3,
        )

    @si.checked_numbers
    def shares(
        self, length: Annotated[si.Metre, si.Above(0.0)]
    ) -> tuple[si.Dimensionless, si.Dimensionless]:
        """The tip's free deflection under a moment that is the same along and across, and its
        stiffness against a force, over those of a strip whose width bends freely everywhere.

        Valid from some 3 widths of length (m) on, where the hold has died away at the tip.
        """
        L = length
        further = 1 + 2 * self.ratio * (self.reach / L - self.moment / L**2)
        # A force's curvature falls from the clamp to nothing at the tip.
        missing = self.reach - self.tilted_reach / L
        lever = self.moment - self.tilted_moment / L
        return further, 1 / (1 - 3 * self.ratio**2 * (missing / L - lever / L**2))
