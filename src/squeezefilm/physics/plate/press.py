"""Press of a finger on a plate, and stress of the ceramic in vibration: two closed forms that a
designer asks before a plate is built."""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si

# Terms of the series; the last changes the sum by less than 1e-5 of it.
_TERMS = 199


@si.checked_numbers
def pressed_deflection(
    force: Annotated[si.Newton, si.AtLeast(0.0)],
    span: Annotated[si.Metre, si.Above(0.0)],
    width: Annotated[si.Metre, si.Above(0.0)],
    bending_stiffness: Annotated[si.NewtonMetre, si.Above(0.0)],
    poisson_ratio: Annotated[si.Dimensionless, si.AtLeast(0.0), si.Below(0.5)] = 0.3,
    contact_length: Annotated[si.Metre, si.Above(0.0)] | None = None,
) -> si.Metre:
    """The static deflection (m) at the middle of a plate that is held along two lines and pressed.

    A uniform plate of `bending_stiffness` D (N·m, per unit width) lies on two knife edges `span`
    apart, its other two edges free, `width` apart; the force (N) acts in the middle, spread over
    `contact_length` (m) along the span (a point without one). Levy's series: of each sine along the
    span four exponentials across the width, D ∇⁴w = 0 with the force as a step of the shear at the
    middle line (Timoshenko and Woinowsky-Krieger, Theory of Plates and Shells, 1959, section 28).

    Its limits are the beam, F a³/(48 D (1 − ν²) b) for b ≪ a, and the infinitely wide plate,
    0.01695 F a²/D. Valid for small deflections of a thin plate; what overhangs the knife edges is
    left out, and so what it adds in stiffness.
    """
    m = np.arange(1, _TERMS + 1, 2)
    k = m * math.pi / span
    along = np.ones(m.size)
    if contact_length is not None and (side := min(contact_length, span)) > 0:
        along = np.sinc(k * side / (2 * math.pi))
    # Amplitude of the line load over the sines; at the middle every odd sine is ±1 twice.
    load = 2 * force / span * along
    middle = _middle(k * width / 2, poisson_ratio)
    return float(np.sum(load * middle / (bending_stiffness * k**3)))


def _middle(half: si.FloatArray, nu: float) -> si.FloatArray:
    """D k³ W(0) / q of each sine: W = a e⁻ᵗ + b t e⁻ᵗ + c e^{t−h} + d (h − t) e^{t−h}, t = k y.

    W′ = 0 and W‴ = q/2 at the middle (half of the force goes to either side); no moment and no
    edge force at t = h. Written so that no exponential grows.
    """
    e, none = np.exp(-half), np.zeros(half.shape)

    def derivatives(t: si.FloatArray) -> si.FloatArray:
        """W, W′, W″, W‴ of the four functions at t: sines, order, function."""
        left, right = np.exp(-t), np.exp(t - half)
        s = half - t
        rows = (
            (left, t * left, right, s * right),
            (-left, (1 - t) * left, right, (s - 1) * right),
            (left, (t - 2) * left, right, (s - 2) * right),
            (-left, (3 - t) * left, right, (s - 3) * right),
        )
        return np.moveaxis(np.array(rows), -1, 0)

    middle, edge = derivatives(none), derivatives(half)
    rows = np.stack(
        (
            middle[:, 1],
            middle[:, 3],
            edge[:, 2] - nu * edge[:, 0],
            edge[:, 3] - (2 - nu) * edge[:, 1],
        ),
        axis=1,
    )
    push = np.array([0.0, 0.5, 0.0, 0.0])
    motion = np.linalg.solve(rows, np.broadcast_to(push[:, None], (half.size, 4, 1)))[..., 0]
    at_middle: si.FloatArray = motion[:, 0] + e * motion[:, 2] + half * e * motion[:, 3]
    return at_middle


@si.closed_form(positive="radius bending_stiffness", nonnegative="force")
def pressed_disc_deflection(
    force: si.NewtonLike,
    radius: si.MetreLike,
    bending_stiffness: si.NewtonMetre,
    poisson_ratio: si.Dimensionless,
) -> si.MetreLike:
    """The static deflection (m) in the middle of a disc held along a circle of `radius` (m).

    F r² (3 + ν) / (16 π (1 + ν) D), of a point force on a disc that ends at that circle; what
    overhangs it makes it stiffer. Broadcasts. Source: Timoshenko and Woinowsky-Krieger, Theory of
    Plates and Shells, 1959, section 19.
    """
    shape = (3 + poisson_ratio) / (16 * np.pi * (1 + poisson_ratio))
    deflection: si.MetreLike = force * radius**2 * shape / bending_stiffness
    return deflection


@si.closed_form(positive="half_wavelength modulus", nonnegative="amplitude distance")
def bending_stress(
    amplitude: si.MetreLike,
    half_wavelength: si.MetreLike,
    distance: si.MetreLike,
    modulus: si.Pascal,
) -> si.PascalLike:
    """The amplitude of the stress (Pa) of a flexural wave, `distance` (m) from the neutral axis.

    E (π/(λ/2))² z A of a plate that bends to a cylinder, with `modulus` E that of a wide strip, and
    A the zero-to-peak `amplitude` (m) of an antinode. Broadcasts. The wave of the working mode
    alone: what the ends of a ceramic add (a solved plate's stress is singular there), and the
    drive's own field, are left out.
    """
    stress: si.PascalLike = modulus * (np.pi / half_wavelength) ** 2 * distance * amplitude
    return stress
