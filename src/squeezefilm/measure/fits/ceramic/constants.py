"""Constants of a bare ceramic from its impedance: of a bar by its formula, of a disc by the solved
disc; and what is known of one before it is measured, the ratios of the library's ceramics."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import VACUUM_PERMITTIVITY
from squeezefilm.core.presets.materials import materials
from squeezefilm.measure.fits.complex_fit import (
    ComplexFit,
    Prior,
    SweepPeaks,
    fit_complex,
    require_passive,
    sweep_adequacy,
    sweep_peaks,
)
from squeezefilm.measure.fits.estimate import Adequacy, Estimate, FitResult
from squeezefilm.measure.recordings.kinds import CeramicBar, ImpedanceSweep
from squeezefilm.physics.plate.ring.ceramic_disc import CeramicDisc, disc_admittance, weak_constants

PARAMETERS = (
    "ln s11",
    "-s12/s11",
    "ln |d31|",
    "ln eps33",
    "loss of s11",
    "loss of d31",
    "loss of eps33",
    "loss of s12 over loss of s11, less 1",
    "s13/s11",
    "s33/s11",
    "s44/s11",
    "d33/d31",
    "d15/d31",
    "eps11/eps33",
)
"""Names of what is fitted of a disc, in this order: s at constant field, ε relative and at constant
stress."""

WIDE = 1.0
"""Spread of ln s11, ln |d31| and ln ε33 before anything is measured: as good as nothing."""
_NO_CERAMIC = 2.5
_LOSS, _LOSS_SPREAD = 0.015, 0.02
_SHEAR_LOSS_SPREAD = 0.2


@functools.cache
def ceramic_prior() -> Prior:
    """Means and standard deviations of `PARAMETERS`.

    The ratios that a sweep of a disc hardly tells (among them Poisson's) scatter as those of the
    library's lead zirconate titanates do, hard to very soft; of a further one of their kind they
    are known to √(1 + 1/n) of that. The three sizes are as good as unknown. Losses: 0.015 ± 0.02;
    that of s12 that of s11 to 20 % (both assumed). Read from `core/presets/materials.toml`.
    """
    rows = np.array(
        [_ratios(material.values) for material in materials() if material.kind == "ceramic"]
    )
    mean, spread = rows.mean(axis=0), rows.std(axis=0, ddof=1) * math.sqrt(1 + 1 / len(rows))
    spread[[0, 2, 3]] = WIDE
    means = np.concatenate([mean[:4], [_LOSS] * 3, [0.0], mean[4:]])
    spreads = np.concatenate([spread[:4], [_LOSS_SPREAD] * 3, [_SHEAR_LOSS_SPREAD], spread[4:]])
    return Prior(means, spreads)


def _ratios(values: dict[str, object]) -> list[float]:
    """ln s11, −s12/s11, ln |d31|, ln ε33, then the six ratios of `PARAMETERS`."""
    table = values["constants"]
    assert isinstance(table, dict)

    def of(name: str) -> float:
        value = table[name]["value"]
        return float(value) if isinstance(value, int | float) else float(str(value).split()[0])

    s11, s12, s13, s33, s44 = (of(f"compliance_{k}") for k in ("11", "12", "13", "33", "44"))
    d31, d33, d15 = (of(f"charge_coefficient_{k}") for k in ("31", "33", "15"))
    eps11, eps33 = of("free_permittivity_11"), of("free_permittivity_33")
    logs = [math.log(s11), -s12 / s11, math.log(abs(d31) * 1e-12), math.log(eps33)]
    return [*logs, s13 / s11, s33 / s11, s44 / s11, d33 / d31, d15 / d31, eps11 / eps33]


@si.checked_numbers
def compliances(
    p: si.DimensionlessArray,
) -> tuple[si.ComplexArray, si.ComplexArray, si.ComplexArray]:
    """Complex compliances s11, s12, s13, s33, s44 (m²/N), charge coefficients d31, d33, d15 (m/V)
    and free relative permittivities ε11, ε33 of parameters `p` in the order of `PARAMETERS`.

    All compliances but s12 have the loss of s11, all charge coefficients that of d31, both
    permittivities that of ε33 (assumed: a radial mode hardly asks for the others).
    """
    if p.shape != (len(PARAMETERS),):
        raise InputError(f"p has the shape {p.shape}; give the {len(PARAMETERS)} of PARAMETERS")
    s11 = math.exp(p[0]) * (1 - 1j * p[4])
    s12 = -p[1] * math.exp(p[0]) * (1 - 1j * p[4] * (1 + p[7]))
    d31 = -math.exp(p[2]) * (1 - 1j * p[5])
    eps33 = math.exp(p[3]) * (1 - 1j * p[6])
    return (
        np.array([s11, s12, s11 * p[8], s11 * p[9], s11 * p[10]]),
        np.array([d31, d31 * p[11], d31 * p[12]]),
        np.array([eps33 * p[13], eps33]),
    )


def coupling_read(peaks: SweepPeaks, share: si.Dimensionless) -> si.Dimensionless:
    """The square of the material's coupling (at most 0.9) that resonance and parallel resonance of
    a body's lowest mode say, which has k² times its `share` of the free capacitance."""
    ratio = (peaks.resistance_frequency / peaks.conductance_frequency) ** 2 - 1
    return min(ratio / (share * (1 + ratio)), 0.9)


def permittivity_read(
    sweep: ImpedanceSweep, square: float, motion: si.ComplexArray, geometry: si.Metre
) -> si.Dimensionless:
    """ε33 at constant stress that all points say together, of a body whose free capacitance is ε33
    times its `geometry` (area over thickness): Y is iω times that times 1 − k² + k² motion."""
    free = 2 * np.pi * sweep.frequency * VACUUM_PERMITTIVITY * geometry
    return float(np.median(np.abs(sweep.admittance / (1 + square * (motion - 1))) / free))


@dataclass(frozen=True, eq=False, repr=False)
class CeramicConstants(FitResult):
    """s11 at constant field (m²/N), d31 (m/V, by convention negative), the relative permittivity
    ε33 at constant stress, the Q of s11, and the loss tangents of d31 and ε33. `model` and
    `residual` (S, (points,)) are at the sweep's `frequency` (Hz)."""

    compliance_11: Estimate
    charge_coefficient_31: Estimate
    free_permittivity_33: Estimate
    quality_factor: Estimate
    charge_loss: Estimate
    dielectric_loss: Estimate
    frequency: si.HertzArray
    model: si.ComplexArray
    residual: si.ComplexArray
    fit: ComplexFit


def constants_of(
    fit: ComplexFit,
    sweep: ImpedanceSweep,
    curve: si.ComplexArray,
    at: tuple[int, int, int, int, int, int],
    model: str,
) -> dict[str, Any]:
    """The fields of `CeramicConstants`: of parameters that stand `at` ln s11, ln |d31|, ln ε33 and
    the losses of the three. `curve` (S) is the fitted admittance, `model` its words."""
    s11, d31, eps33, loss, charge_loss, dielectric_loss = at
    charge = fit.estimate(lambda p: math.exp(p[d31]), "m/V")
    low, high = charge.interval
    return {
        "compliance_11": fit.estimate(lambda p: math.exp(p[s11]), "m2/N"),
        "charge_coefficient_31": replace(charge, value=-charge.value, interval=(-high, -low)),
        "free_permittivity_33": fit.estimate(lambda p: math.exp(p[eps33]), "1"),
        "quality_factor": fit.estimate(lambda p: 1 / float(p[loss]), "1"),
        "charge_loss": fit.estimate(lambda p: float(p[charge_loss]), "1"),
        "dielectric_loss": fit.estimate(lambda p: float(p[dielectric_loss]), "1"),
        "frequency": sweep.frequency,
        "model": curve,
        "residual": sweep.admittance - curve,
        "adequacy": _doubted(
            sweep_adequacy(fit, sweep.frequency, model),
            float(fit.parameters[s11] - ceramic_prior().mean[0]),
        ),
        "fit": fit,
    }


def _doubted(adequacy: Adequacy, away: float) -> Adequacy:
    """The judgement, inadequate where s11 is beyond any ceramic, by its logarithm `away` from the
    prior's."""
    if abs(away) < math.log(_NO_CERAMIC):
        return adequacy
    sentence = (
        f"{adequacy.sentence} The compliance is {math.exp(away):.2g} times that of usual ceramics, "
        "which none has: another mode was probably recorded; sweep around the lowest one."
    )
    return replace(adequacy, adequate=False, sentence=sentence)


def resonance_peaks(sweep: ImpedanceSweep) -> SweepPeaks:
    """`sweep_peaks` of a sweep that holds a resonance and the parallel resonance above it. Raises
    `InputError` for one that does not."""
    peaks = sweep_peaks(sweep)
    if not peaks.conductance_frequency < peaks.resistance_frequency:
        raise InputError(
            f"the largest resistance ({peaks.resistance_frequency / 1e3:.5g} kHz) is not above the "
            f"largest conductance ({peaks.conductance_frequency / 1e3:.5g} kHz); give a sweep with "
            "a resonance and the parallel resonance above it, less noisy",
            quantity="admittance",
        )
    return peaks


@dataclass(frozen=True, eq=False, repr=False)
class BarConstants(CeramicConstants):
    """`CeramicConstants` of a bar, and its coupling k31."""

    coupling_31: Estimate


def bar_constants(sweep: ImpedanceSweep, bar: CeramicBar) -> BarConstants:
    """Fit the lowest length resonance of a free bar, or it and others, with all losses.

    Y = iω (l w/t) [ε33T (1 − k31²) + ε33T k31² tan X/X], X = (ωl/2) √(ρ s11E), k31² = d31²/(s11E
    ε33T), all constants complex (IEEE standard on piezoelectricity 176-1987, section 6.4.1; losses
    after Holland 1967, 10.1109/T-SU.1967.29405). One dimension: a width of a quarter of the length
    lowers the frequency by some ½ (π ν w/l)²/12, about 0.3 %, which is not corrected: s11 reads
    0.6 % too high, while k31 stays (Love's rod with lateral inertia, fitted beside it).

    k31 is that of the whole curve, with its losses. The two extremes of |Y| by the formula of a
    body without losses (IEEE 176) give more, by 1.1 % at k31²Q = 10, since losses push them apart.
    Raises `InputError` as `fit_impedance` does.
    """
    require_passive(sweep)
    omega = 2 * np.pi * sweep.frequency
    fit = fit_complex(lambda p: _bar_curve(bar, p, omega), _bar_start(sweep, bar), sweep.admittance)
    curve = _bar_curve(bar, fit.parameters, omega)[0]

    def coupling(p: si.FloatArray) -> float:
        return math.exp(p[1] - (p[0] + p[2]) / 2 - math.log(VACUUM_PERMITTIVITY) / 2)

    return BarConstants(
        coupling_31=fit.estimate(coupling, "1"),
        **constants_of(fit, sweep, curve, (0, 1, 2, 3, 4, 5), "The formula of a bar"),
    )


def _bar_start(sweep: ImpedanceSweep, bar: CeramicBar) -> si.FloatArray:
    """ln s11, ln |d31|, ln ε33, and the losses of the three, read off the sweep of the lowest mode,
    where X is π/2."""
    peaks = resonance_peaks(sweep)
    series = peaks.conductance_frequency
    compliance = 1 / (2 * bar.length * series) ** 2 / bar.density
    square = coupling_read(peaks, 8 / math.pi**2)
    low = slice(0, max(3, sweep.frequency.size // 20))
    capacitance = float(np.median(sweep.admittance.imag[low] / (2 * np.pi * sweep.frequency[low])))
    if capacitance <= 0:
        raise InputError(
            "the sweep begins within the resonance, where the bar is no capacitor; begin it below "
            f"{0.95 * series / 1e3:.4g} kHz",
            quantity="admittance",
        )
    x = math.pi / 2 * sweep.frequency / series * complex(1, -0.006)
    geometry = bar.length * bar.width / bar.thickness
    permittivity = permittivity_read(sweep, square, np.tan(x) / x, geometry)
    charge = math.sqrt(square * compliance * permittivity * VACUUM_PERMITTIVITY)
    return np.array(
        [math.log(compliance), math.log(charge), math.log(permittivity), 0.012, 0.01, 0.015]
    )


def _bar_curve(
    bar: CeramicBar, p: si.FloatArray, omega: si.FloatArray
) -> tuple[si.ComplexArray, si.ComplexArray]:
    """The bar's admittance and its derivatives with the six parameters."""
    tangents = 1 - 1j * p[3:6]
    s, d, permittivity = np.exp(p[:3]) * tangents
    permittivity = permittivity * VACUUM_PERMITTIVITY
    face = 1j * omega * bar.length * bar.width / bar.thickness
    x = omega * bar.length / 2 * np.sqrt(bar.density * s)
    tan = np.tan(x)
    share = tan / x
    motional = d**2 / s
    curve = face * (permittivity + motional * (share - 1))
    # d(tan x / x)/d ln s = (1 + tan² x − tan x / x)/2.
    by_s = face * motional * (1 - share + (1 + tan**2 - share) / 2)
    by_d = 2 * face * motional * (share - 1)
    by_permittivity = face * permittivity
    relative = np.array([by_s, by_d, by_permittivity])
    return curve, np.concatenate([relative, relative * (-1j / tangents)[:, None]])


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

    What the mode does not tell (Poisson's ratio, everything along the thickness) is held by what
    the library's ceramics have in common, and its uncertainty stays in the intervals. Constants do
    not depend on frequency within the sweep. Range: discs at least 5 times as wide as thick
    (`CeramicDisc`), full electrodes, free. Raises `InputError` as `fit_impedance` does, and for a
    thicker disc.
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
    fit = fit_complex(curve, _disc_start(sweep, disc, prior), sweep.admittance, prior=prior)
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


def _disc_start(sweep: ImpedanceSweep, disc: CeramicDisc, prior: Prior) -> si.FloatArray:
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
    geometry = math.pi / 4 * disc.diameter**2 / disc.thickness
    eps33 = permittivity_read(sweep, square, motion, geometry)
    d31 = math.sqrt(square * s11 * (1 - ratio) * eps33 * VACUUM_PERMITTIVITY / 2)
    p = prior.mean.copy()
    p[[0, 2, 3]] = math.log(s11), math.log(d31), math.log(eps33)
    return p
