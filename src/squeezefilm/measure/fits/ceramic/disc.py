"""Constants of a ceramic disc from the sweep of a radial mode, with the solved disc."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import Annotated

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
    recorded_mode,
    resonance_peaks,
)
from squeezefilm.measure.fits.complex_fit import ComplexFit, Prior, fit_complex
from squeezefilm.measure.fits.estimate import Estimate
from squeezefilm.measure.fits.sweep_reading import require_passive
from squeezefilm.measure.recordings.kinds import ImpedanceSweep
from squeezefilm.physics.plate.ring.ceramic_disc import (
    CeramicDisc,
    disc_admittance,
    disc_system,
    weak_constants,
)

_LEAST_SLENDERNESS = 5.0
_MODES = 4


@dataclass(frozen=True, eq=False)
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
    """Fit the axisymmetric piezoelectric solution of the free disc to a sweep of one or more of its
    radial modes, with elastic, piezoelectric and dielectric losses.

    Which of the lowest four the most conductance is of is found by what ceramics are and by what is
    left of the data (`recorded_mode`), and said. What the mode does not tell (Poisson's ratio,
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
    starts = _starts(sweep, disc, prior)

    def fitted_as(number: int) -> ComplexFit:
        curve = partial(disc_curve, disc, sweep.frequency, modes=number)
        return fit_complex(curve, starts[number - 1], sweep.admittance, prior=prior)

    fit, mode = recorded_mode(starts, fitted_as, ceramic_prior(of_class=True))
    fitted = disc_curve(disc, sweep.frequency, fit.parameters, mode.number)[0]
    spread = np.sqrt(np.diag(fit.covariance))

    def coupling(p: si.FloatArray) -> float:
        square = math.exp(2 * p[2] - p[0] - p[3]) / VACUUM_PERMITTIVITY
        return math.sqrt(2 * square / (1 - p[1]))

    return DiscConstants(
        **constants_of(fit, sweep, fitted, (0, 2, 3, 4, 5, 6), "The solved disc", mode),
        disc=disc,
        compliance_12=fit.estimate(lambda p: -float(p[1]) * math.exp(p[0]), "m2/N"),
        poisson_ratio=fit.estimate(lambda p: float(p[1]), "1"),
        planar_coupling=fit.estimate(coupling, "1"),
        from_data=dict(zip(PARAMETERS, (spread / prior.spread).tolist(), strict=True)),
    )


def disc_curve(
    disc: CeramicDisc,
    frequency: si.HertzArray,
    p: si.DimensionlessArray,
    modes: Annotated[int, si.AtLeast(1)] = 2,
) -> tuple[si.ComplexArray, si.ComplexArray]:
    """The admittance (S, (points,)) of a disc at frequencies (Hz) and its derivatives with the
    parameters `p` in the order of `PARAMETERS` (parameters, points); up to that many of its radial
    `modes` are resolved."""
    system = disc_system(disc, max(7, 2 * modes + 2))
    curve, slopes = disc_admittance(disc, weak_constants(*compliances(p)), frequency, system)
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


def _starts(sweep: ImpedanceSweep, disc: CeramicDisc, prior: Prior) -> list[si.FloatArray]:
    """Sizes read off the sweep by the formulas of a thin disc as if it were of each of its modes,
    the rest from the prior.

    Y is iω times the free capacitance times 1 − k² + k² f(η), with f = (1 + σ) J1(η) / (η J0(η) −
    (1 − σ) J1(η)), η = (ω D/2) √(ρ s11 (1 − σ²)) and the planar coupling k (IEEE standard
    176-1987, section 6.4.2).
    """
    from scipy.optimize import brentq
    from scipy.special import j0, j1, jn_zeros, jv

    ratio, loss = float(prior.mean[1]), complex(1, -float(prior.mean[4]) / 2)

    def free(x: float) -> float:
        return float(x * j0(x) - (1 - ratio) * j1(x))

    ends = zip([1.0, *jn_zeros(1, _MODES - 1)], jn_zeros(0, _MODES), strict=True)
    roots = [float(brentq(free, *pair)) for pair in ends]
    shares = [2 * (1 + ratio) / (x**2 - 1 + ratio**2) for x in roots]
    peaks = resonance_peaks(sweep)
    series = peaks.conductance_frequency
    starts = []
    for number, root in enumerate(roots, 1):
        velocity = math.pi * series * disc.diameter / root
        s11 = 1 / (disc.density * velocity**2 * (1 - ratio**2))
        square = coupling_read(peaks, shares, number)
        x = root * sweep.frequency / series * loss
        motion = (1 + ratio) * jv(1, x) / (x * jv(0, x) - (1 - ratio) * jv(1, x))
        geometry = math.pi / 4 * disc.diameter**2 / disc.thickness
        eps33 = permittivity_read(sweep, square, motion, geometry)
        d31 = math.sqrt(square * s11 * (1 - ratio) * eps33 * VACUUM_PERMITTIVITY / 2)
        p = prior.mean.copy()
        p[[0, 2, 3]] = math.log(s11), math.log(d31), math.log(eps33)
        starts.append(p)
    return starts
