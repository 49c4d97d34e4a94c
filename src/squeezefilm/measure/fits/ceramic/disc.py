"""Constants of a ceramic disc from the sweep of its first radial mode, with the solved disc."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
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
    resonance_peaks,
)
from squeezefilm.measure.fits.complex_fit import ComplexFit, Prior, fit_complex
from squeezefilm.measure.fits.estimate import Adequacy, Estimate
from squeezefilm.measure.fits.sweep_reading import require_passive
from squeezefilm.measure.recordings.kinds import ImpedanceSweep
from squeezefilm.physics.plate.ring.ceramic_disc import CeramicDisc, disc_admittance, weak_constants

_LEAST_SLENDERNESS = 5.0
_NO_CERAMIC = 2.5


@dataclass(frozen=True)
class Combination:
    """One direction in the parameters, each in units of its standard deviation beforehand.

    `weights` names the parameters that take part, `left` is how much of the standard deviation the
    data leave: 1 is nothing learnt.
    """

    weights: dict[str, float]
    left: si.Dimensionless


@dataclass(frozen=True, eq=False)
class DiscConstants(CeramicConstants):
    """What the sweep of a disc's first radial mode says of its ceramic: `CeramicConstants`, s12 at
    constant field (m²/N), Poisson's ratio −s12/s11, and the planar coupling.

    `from_data` is, for every one of `PARAMETERS`, by how much the sweep narrowed its standard
    deviation (1: only the prior speaks). `mean_misfit` is mean |ΔY| / mean |Y|.
    """

    disc: CeramicDisc
    compliance_12: Estimate
    poisson_ratio: Estimate
    planar_coupling: Estimate
    from_data: dict[str, float]
    combinations: tuple[Combination, ...]
    mean_misfit: si.Dimensionless


def disc_constants(
    sweep: ImpedanceSweep, disc: CeramicDisc, prior: Prior | None = None
) -> DiscConstants:
    """Fit the axisymmetric piezoelectric solution of the free disc to a sweep of its first radial
    mode, with elastic, piezoelectric and dielectric losses.

    What the mode does not tell (Poisson's ratio, everything along the thickness) is held by
    `prior`, that of the library's ceramics where none is given, and its uncertainty stays in the
    intervals. Constants do not depend on frequency within the sweep. Range: discs at least 5 times
    as wide as thick (`CeramicDisc`), full electrodes, free. Raises `InputError` as `fit_impedance`
    does, and for a thicker disc.
    """
    require_passive(sweep)
    slender = disc.diameter / disc.thickness
    if slender < _LEAST_SLENDERNESS:
        raise InputError(
            f"the disc is {slender:.3g} times as wide as thick; a radial mode can be told from "
            f"the others from {_LEAST_SLENDERNESS:.0f} on",
            quantity="disc",
        )
    prior = prior or ceramic_prior()
    curve = partial(disc_curve, disc, sweep.frequency)
    start = _start(sweep, disc, prior)
    fit = fit_complex(curve, start, sweep.admittance, prior=prior)
    fitted = curve(fit.parameters)[0]
    miss = np.mean(np.abs(sweep.admittance - fitted)) / np.mean(np.abs(sweep.admittance))
    spread = np.sqrt(np.diag(fit.covariance))

    def coupling(p: si.FloatArray) -> float:
        square = math.exp(2 * p[2] - p[0] - p[3]) / VACUUM_PERMITTIVITY
        return math.sqrt(2 * square / (1 - p[1]))

    constants = constants_of(fit, sweep, fitted, (0, 2, 3, 4, 5, 6), "The solved disc")
    constants["adequacy"] = _doubted(
        constants["adequacy"], float(fit.parameters[0] - prior.mean[0])
    )
    return DiscConstants(
        **constants,
        disc=disc,
        compliance_12=fit.estimate(lambda p: -float(p[1]) * math.exp(p[0]), "m2/N"),
        poisson_ratio=fit.estimate(lambda p: float(p[1]), "1"),
        planar_coupling=fit.estimate(coupling, "1"),
        from_data=dict(zip(PARAMETERS, (spread / prior.spread).tolist(), strict=True)),
        combinations=combinations(fit, prior),
        mean_misfit=float(miss),
    )


def _doubted(adequacy: Adequacy, away: float) -> Adequacy:
    """Inadequate where s11 is beyond any ceramic by its logarithm `away` from the prior's: the
    second radial mode taken as the first makes s11 (2.06/5.40)² = 0.15 of what it is."""
    if abs(away) < math.log(_NO_CERAMIC):
        return adequacy
    said = (
        f" The compliance is {math.exp(away):.2g} times that of usual ceramics, which none has: "
        "another than the first radial mode was probably recorded; sweep around the lowest one."
    )
    return replace(adequacy, adequate=False, sentence=adequacy.sentence + said)


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
    """Sizes read off the sweep by the formulas of a thin disc, the rest from the prior.

    The first radial mode of a thin disc of σ near 0.32 is at η = 2.06 of η = (ω D/2) √(ρ s11
    (1 − σ²)); its coupling follows k²/(1 − k²) ≈ 2.51 (fp − fs)/fs − 0.78 ((fp − fs)/fs)² (IEEE
    standard 176-1987, figure of the planar coupling, a fit to it), enough to start from.
    """
    p = prior.mean.copy()
    peaks = resonance_peaks(sweep)
    series, parallel = peaks.conductance_frequency, peaks.resistance_frequency
    velocity = math.pi * series * disc.diameter / 2.06
    s11 = 1 / (disc.density * velocity**2 * (1 - p[1] ** 2))
    apart = parallel / series - 1
    ratio = max(2.51 * apart - 0.78 * apart**2, 0.01)
    square = ratio / (1 + ratio)
    # Well above the mode the disc is held in its plane.
    high = slice(-max(3, sweep.frequency.size // 20), None)
    capacitance = float(
        np.median(sweep.admittance.imag[high] / (2 * np.pi * sweep.frequency[high]))
    )
    area = math.pi / 4 * disc.diameter**2
    held = max(capacitance, 1e-15) * disc.thickness / (VACUUM_PERMITTIVITY * area)
    eps33 = held / (1 - square)
    d31 = math.sqrt(square * s11 * (1 - p[1]) * eps33 * VACUUM_PERMITTIVITY / 2)
    p[[0, 2, 3]] = math.log(s11), math.log(d31), math.log(eps33)
    return p


def combinations(fit: ComplexFit, prior: Prior) -> tuple[Combination, ...]:
    """The directions in which the data speak, best known first: eigenvectors of their information
    in units of the prior. Those that are left above 0.9 are not listed."""
    information = fit.information * np.outer(prior.spread, prior.spread)
    values, vectors = np.linalg.eigh(information)
    combined = []
    for value, vector in zip(values[::-1], vectors.T[::-1], strict=True):
        left = 1 / math.sqrt(1 + max(float(value), 0.0))
        if left > 0.9:
            break
        vector = vector * np.sign(vector[np.argmax(np.abs(vector))])
        weights = {
            name: float(weight)
            for name, weight in zip(PARAMETERS, vector, strict=True)
            if abs(weight) > 0.1
        }
        combined.append(Combination(weights, left))
    return tuple(combined)


@si.checked_numbers
def disc_by_mass(
    diameter: Annotated[si.Metre, si.Above(0.0)],
    thickness: Annotated[si.Metre, si.Above(0.0)],
    mass: Annotated[si.Kilogram, si.Above(0.0)],
) -> CeramicDisc:
    """The disc of a diameter, a thickness (m) and a mass (kg) that was weighed."""
    volume = math.pi / 4 * diameter**2 * thickness
    return CeramicDisc(diameter, thickness, mass / volume)
