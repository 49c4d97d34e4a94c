"""A bending actuator of two equal ceramics on a shim, clamped at one end: its closed forms.

Narrow beam: every layer is free across its width (plane stress), sections stay plane, and the clamp
is rigid. In the letters of this module s11 is the ceramic's compliance along the beam at constant
field, k31² = d31²/(s11 εᵀ33), E_m the shim's modulus, t_p and t_m the thicknesses of one ceramic
and of the shim, L the free length, w the width, V the voltage *of one ceramic*.

Sources: Smits and Choi 1991, 10.1109/58.84256, for what is derived and how; Wang and Cross 1999,
10.1109/58.808857, for the symmetrical triple layer. Both take the field to be uniform across a
ceramic. Where the beam is bent it is not: the charge that bending brings must be the same at every
height, so the field follows the strain and stiffens each ceramic about its *own* middle by
k31²/(1 − k31²). That term is left out here, as in the published forms, which for two thick ceramics
of high coupling are some 3 % too soft.
"""

from __future__ import annotations

import math
from typing import Annotated

from squeezefilm.core import quantities as si

SquareMetrePerNewtonLike = Annotated[si.FloatLike, si.Unit("m2/N")]
NewtonMetreLike = Annotated[si.FloatLike, si.Unit("N*m")]
NewtonPerVoltLike = Annotated[si.FloatLike, si.Unit("N/V")]
KilogramPerSquareMetreLike = Annotated[si.FloatLike, si.Unit("kg/m2")]
FaradPerMetreLike = Annotated[si.FloatLike, si.Unit("F/m")]
FaradLike = Annotated[si.FloatLike, si.Unit("F")]

FIRST_ROOT = 1.875104068711961
"""The first root of cos x cosh x = −1: a beam clamped at one end and free at the other."""


@si.closed_form(positive="compliance permittivity")
def coupling_squared(
    charge_coefficient: si.MetrePerVoltLike,
    compliance: SquareMetrePerNewtonLike,
    permittivity: FaradPerMetreLike,
) -> si.DimensionlessLike:
    """k31² = d31²/(s11 εᵀ33), with the permittivity at constant stress (F/m).

    Arguments (m/V, m²/N, F/m) broadcast. Below 1 for any real ceramic. Raises `InputError` for a
    compliance or permittivity not above 0. Source: IEEE Standard on Piezoelectricity 176-1987.
    """
    return charge_coefficient**2 / (compliance * permittivity)


@si.closed_form(positive="ceramic_thickness compliance", nonnegative="shim_thickness shim_modulus")
def bending_stiffness(
    ceramic_thickness: si.MetreLike,
    compliance: SquareMetrePerNewtonLike,
    shim_thickness: si.MetreLike,
    shim_modulus: si.PascalLike,
) -> NewtonMetreLike:
    """G = (2/3)[(t_m/2 + t_p)³ − (t_m/2)³]/s11 + E_m t_m³/12, per width (N·m), at constant field.

    Arguments (m, m²/N, m, Pa) broadcast. Source: Wang and Cross 1999. Raises `InputError` for a
    ceramic's thickness or compliance not above 0, or negative values of the shim.
    """
    half = shim_thickness / 2
    ceramics = 2 * ((half + ceramic_thickness) ** 3 - half**3) / (3 * compliance)
    return ceramics + shim_modulus * shim_thickness**3 / 12


@si.closed_form(positive="ceramic_thickness compliance", nonnegative="shim_thickness")
def moment_per_volt(
    ceramic_thickness: si.MetreLike,
    compliance: SquareMetrePerNewtonLike,
    shim_thickness: si.MetreLike,
    charge_coefficient: si.MetrePerVoltLike,
) -> NewtonPerVoltLike:
    """The bending moment per width and per volt of one ceramic, (d31/s11)(t_m + t_p), in N/V.

    Both ceramics, one in its poling direction and one against it. Arguments (m, m²/N, m, m/V)
    broadcast. Source: Wang and Cross 1999. Raises `InputError` as `bending_stiffness`.
    """
    return charge_coefficient / compliance * (shim_thickness + ceramic_thickness)


@si.closed_form(positive="stiffness width length")
def tip_stiffness(
    stiffness: NewtonMetreLike, width: si.MetreLike, length: si.MetreLike
) -> si.NewtonPerMetreLike:
    """k = 3 G w/L³ (N/m), of the tip against a force there. Arguments (N·m, m, m) broadcast.
    Source: Euler's beam. Raises `InputError` for any not above 0."""
    return 3 * stiffness * width / length**3


@si.closed_form(positive="width length")
def blocked_force(
    moment: si.NewtonLike, width: si.MetreLike, length: si.MetreLike
) -> si.NewtonLike:
    """F = 3 M w/(2 L) (N), the force that keeps the tip where it is; it does not depend on the
    stiffness. Arguments (N, m, m) broadcast. Source: Smits and Choi 1991. Raises `InputError` for a
    width or length not above 0."""
    return 3 * moment * width / (2 * length)


@si.closed_form(positive="stiffness mass_per_area length")
def resonance_frequency(
    stiffness: NewtonMetreLike, mass_per_area: KilogramPerSquareMetreLike, length: si.MetreLike
) -> si.HertzLike:
    """f1 = (1.8751²/2π L²) √(G/m) (Hz), the first bending resonance with the voltage held.

    Arguments (N·m, kg/m², m) broadcast. Slender beams: shear and rotary inertia take less than 1 %
    for lengths above some 15 thicknesses. Raises `InputError` for any not above 0.
    """
    return FIRST_ROOT**2 / (2 * math.pi * length**2) * (stiffness / mass_per_area) ** 0.5


@si.closed_form(positive="permittivity ceramic_thickness length width", nonnegative="coupling")
def clamped_capacitance(
    permittivity: FaradPerMetreLike,
    coupling: si.DimensionlessLike,
    ceramic_thickness: si.MetreLike,
    length: si.MetreLike,
    width: si.MetreLike,
) -> FaradLike:
    """The capacitance of one ceramic that may not bend nor stretch along the beam (F),
    εᵀ33 (1 − k31²) L w/t_p. Arguments (F/m, 1, m, m, m) broadcast. Source: Wang and Cross 1999.
    Raises `InputError` for a permittivity or size not above 0 or a negative coupling."""
    return permittivity * (1 - coupling) * length * width / ceramic_thickness
