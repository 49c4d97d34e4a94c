"""Constants of a ceramic disc from the sweep of a radial mode, with the solved disc."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import VACUUM_PERMITTIVITY
from squeezefilm.measure.fits.ceramic.constants import (
    PARAMETERS,
    CeramicConstants,
    ceramic_prior,
    compliances,
    constants_of,
    coupling_read,
    permittivity_read,
    resonance_peaks,
)
from squeezefilm.measure.fits.complex_fit import Prior, fit_complex, require_passive
from squeezefilm.measure.fits.estimate import Estimate
from squeezefilm.measure.recordings.kinds import ImpedanceSweep
from squeezefilm.physics.plate.ring.ceramic_disc import (
    CeramicDisc,
    disc_admittance,
    weak_constants,
)

_LEAST_SLENDERNESS = 5.0


@dataclass(frozen=True, eq=False, repr=False)
class DiscConstants(CeramicConstants):
    """Constants of a ceramic by the sweep of a disc's first radial mode: `CeramicConstants`, s12 at
    constant field (m²/N), Poisson's ratio −s12/s11, and the planar coupling.

    `from_data` is, for every one of `PARAMETERS`, by how much the sweep narrowed its standard
    deviation (1: only the prior speaks).
    """

    disc: CeramicDisc
    compliance_12: Estimate
    poisson_ratio: Estimate
    planar_coupling: Estimate
    from_data: dict[str, float]


def disc_constants(sweep: ImpedanceSweep, disc: CeramicDisc) -> DiscConstants:
    """Fit the axisymmetric piezoelectric solution of the free disc to a sweep of its lowest radial
    mode, or of it and others, with elastic, piezoelectric and dielectric losses.

    What the mode does not tell (Poisson's ratio,
    everything along the thickness) is held by what the library's ceramics have in common, and its
    uncertainty stays in the intervals. Constants do not depend on frequency within
    the sweep. Range: discs at least 5 times as wide as thick (`CeramicDisc`), full electrodes,
    free. Raises `InputError` as `fit_impedance` does, and for a thicker disc.
    """
    require_passive(sweep)
    slender = disc.diameter / disc.thickness
    if slender < _LEAST_SLENDERNESS:
        raise InputError(
            f"the disc is {slender:.3g} times as wide as thick; a radial mode can be told from "
            f"the others from {_LEAST_SLENDERNESS:.0f} on",
            quantity="disc",
        )
    prior = ceramic_prior()
    curve = partial(disc_curve, disc, sweep.frequency)
    fit = fit_complex(curve, _start(sweep, disc, prior), sweep.admittance, prior=prior)
    fitted = curve(fit.parameters)[0]
    spread = np.sqrt(np.diag(fit.covariance))

    def coupling(p: si.FloatArray) -> float:
        square = math.exp(2 * p[2] - p[0] - p[3]) / VACUUM_PERMITTIVITY
        return math.sqrt(2 * square / (1 - p[1]))

    return DiscConstants(
        **constants_of(fit, sweep, fitted, (0, 2, 3, 4, 5, 6), "The solved disc"),
        disc=disc,
        compliance_12=fit.estimate(lambda p: -float(p[1]) * math.exp(p[0]), "m2/N"),
        poisson_ratio=fit.estimate(lambda p: float(p[1]), "1"),
        planar_coupling=fit.estimate(coupling, "1"),
        from_data=dict(zip(PARAMETERS, (spread / prior.spread).tolist(), strict=True)),
    )


def disc_curve(
    disc: CeramicDisc, frequency: si.HertzArray, p: si.DimensionlessArray
) -> tuple[si.ComplexArray, si.ComplexArray]:
    """The admittance (S, (points,)) of a disc at frequencies (Hz) and its derivatives with the
    parameters `p` in the order of `PARAMETERS` (parameters, points)."""
    curve, slopes = disc_admittance(disc, weak_constants(*compliances(p)), frequency)
    return curve, _constant_slopes(p) @ slopes


def _constant_slopes(p: si.FloatArray) -> si.ComplexArray:
    """Derivatives of the ten constants with the parameters, (parameters, 10), by central
    differences of a closed form."""
    rows = []
    for k in range(p.size):
        up, down = p.copy(), p.copy()
        up[k] += 1e-6
        down[k] -= 1e-6
        rise = weak_constants(*compliances(up)) - weak_constants(*compliances(down))
        rows.append(rise / 2e-6)
    return np.array(rows)


def _start(sweep: ImpedanceSweep, disc: CeramicDisc, prior: Prior) -> si.FloatArray:
    """Sizes read off the sweep by the formulas of a thin disc's lowest mode, the rest from the
    prior.

    Y is iω times the free capacitance times 1 − k² + k² f(η), with f = (1 + σ) J1(η) / (η J0(η) −
    (1 − σ) J1(η)), η = (ω D/2) √(ρ s11 (1 − σ²)) and the planar coupling k (IEEE standard
    176-1987, section 6.4.2).
    """
    from scipy.optimize import brentq
    from scipy.special import j0, j1, jn_zeros, jv

    ratio, loss = float(prior.mean[1]), complex(1, -float(prior.mean[4]) / 2)
    root = float(brentq(lambda x: x * j0(x) - (1 - ratio) * j1(x), 1.0, jn_zeros(0, 1)[0]))
    peaks = resonance_peaks(sweep)
    series = peaks.conductance_frequency
    velocity = math.pi * series * disc.diameter / root
    s11 = 1 / (disc.density * velocity**2 * (1 - ratio**2))
    square = coupling_read(peaks, 2 * (1 + ratio) / (root**2 - 1 + ratio**2))
    x = root * sweep.frequency / series * loss
    motion = (1 + ratio) * jv(1, x) / (x * jv(0, x) - (1 - ratio) * jv(1, x))
    eps33 = permittivity_read(
        sweep, square, motion, math.pi / 4 * disc.diameter**2 / disc.thickness
    )
    d31 = math.sqrt(square * s11 * (1 - ratio) * eps33 * VACUUM_PERMITTIVITY / 2)
    p = prior.mean.copy()
    p[[0, 2, 3]] = math.log(s11), math.log(d31), math.log(eps33)
    return p
