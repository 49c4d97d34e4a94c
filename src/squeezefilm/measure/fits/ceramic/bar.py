"""Constants of a ceramic bar from the sweep of its length resonance."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.errors import InputError
from squeezefilm.hard_limits import DENSITY, LAYER, SIDE
from squeezefilm.materials import VACUUM_PERMITTIVITY
from squeezefilm.measure.fits.complex_fit import ComplexFit, fit_complex, sweep_adequacy
from squeezefilm.measure.fits.estimate import Adequacy, Estimate, Observation
from squeezefilm.measure.fits.sweep_reading import require_passive, sweep_peaks
from squeezefilm.measure.recordings.kinds import ImpedanceSweep


@si.checked_numbers
@dataclass(frozen=True)
class CeramicBar:
    """A bar poled through its thickness, with electrodes all over both faces: `length`, `width` and
    `thickness` (m) and its `density` (kg/m³). Raises `InputError` for one that is no bar."""

    length: Annotated[si.Metre, SIDE]
    width: Annotated[si.Metre, SIDE]
    thickness: Annotated[si.Metre, LAYER]
    density: Annotated[si.KilogramPerCubicMetre, DENSITY]

    def __post_init__(self) -> None:
        widest = max(self.width, self.thickness)
        if self.length < 2 * widest:
            raise InputError(
                f"length = {self.length * 1e3:.4g} mm is less than twice the largest other side, "
                f"{widest * 1e3:.4g} mm: the bar would not vibrate along its length alone; cut a "
                "longer or narrower one",
                quantity="length",
            )


@dataclass(frozen=True, eq=False)
class BarConstants:
    """What a bar's sweep says: s11 at constant field (m²/N), d31 (m/V, by convention negative), the
    coupling k31, the relative permittivity ε33 at constant stress, the Q of s11, and the loss
    tangents of d31 and ε33. `admittance` (S) is the fitted curve at the sweep's frequencies."""

    compliance_11: Estimate
    charge_coefficient_31: Estimate
    coupling_31: Estimate
    free_permittivity_33: Estimate
    quality_factor: Estimate
    charge_loss: Estimate
    dielectric_loss: Estimate
    admittance: si.ComplexArray
    adequacy: Adequacy
    fit: ComplexFit

    @property
    def observations(self) -> tuple[Observation, ...]:
        """None: constants of a material are no answers of a display."""
        return ()


def bar_constants(sweep: ImpedanceSweep, bar: CeramicBar) -> BarConstants:
    """Fit the length resonance of a free bar, with all losses.

    Y = iω (l w/t) [ε33T (1 − k31²) + ε33T k31² tan X/X], X = (ωl/2) √(ρ s11E), k31² = d31²/(s11E
    ε33T), all constants complex (IEEE standard on piezoelectricity 176-1987, section 6.4.1; losses
    after Holland 1967, 10.1109/T-SU.1967.29405). One dimension: a width of a quarter of the length
    lowers the frequency by some ½ (π ν w/l)²/12, about 0.3 %, which is not corrected. Raises
    `InputError` as `fit_impedance` does.
    """
    require_passive(sweep)
    start = _start(sweep, bar)
    omega = 2 * np.pi * sweep.frequency
    fit = fit_complex(lambda p: _curve(bar, p, omega), start, sweep.admittance)
    curve = _curve(bar, fit.parameters, omega)[0]

    def coupling(p: si.FloatArray) -> float:
        return math.exp(p[1] - (p[0] + p[2]) / 2 - math.log(VACUUM_PERMITTIVITY) / 2)

    compliance = fit.estimate(lambda p: math.exp(p[0]), "m2/N")
    charge = fit.estimate(lambda p: math.exp(p[1]), "m/V")
    low, high = charge.interval
    return BarConstants(
        compliance_11=compliance,
        charge_coefficient_31=replace(charge, value=-charge.value, interval=(-high, -low)),
        coupling_31=fit.estimate(coupling, "1"),
        free_permittivity_33=fit.estimate(lambda p: math.exp(p[2]), "1"),
        quality_factor=fit.estimate(lambda p: 1 / float(p[3]), "1"),
        charge_loss=fit.estimate(lambda p: float(p[4]), "1"),
        dielectric_loss=fit.estimate(lambda p: float(p[5]), "1"),
        admittance=curve,
        adequacy=sweep_adequacy(fit, sweep.frequency, "The formula of a bar"),
        fit=fit,
    )


def _start(sweep: ImpedanceSweep, bar: CeramicBar) -> si.FloatArray:
    """ln s11, ln |d31|, ln ε33, and the losses of the three, read off the sweep."""
    peaks = sweep_peaks(sweep)
    series, parallel = peaks.conductance_frequency, peaks.resistance_frequency
    if not series < parallel:
        raise InputError(
            f"the largest resistance ({parallel / 1e3:.5g} kHz) is not above the largest "
            f"conductance ({series / 1e3:.5g} kHz); give a sweep with a resonance and the parallel "
            "resonance above it",
            quantity="admittance",
        )
    compliance = 1 / (bar.density * (2 * bar.length * series) ** 2)
    # IEEE 176: k²/(1 − k²) = (π/2)(fp/fs) tan((π/2)(fp − fs)/fs).
    ratio = (
        math.pi / 2 * parallel / series * math.tan(math.pi / 2 * min(parallel / series - 1, 0.9))
    )
    square = ratio / (1 + ratio)
    low = slice(0, max(3, sweep.frequency.size // 20))
    capacitance = float(np.median(sweep.admittance.imag[low] / (2 * np.pi * sweep.frequency[low])))
    unit = VACUUM_PERMITTIVITY * bar.length * bar.width / bar.thickness
    x = math.pi / 2 * float(sweep.frequency[low].mean()) / series
    permittivity = capacitance / unit / abs(1 - square + square * math.tan(x) / x)
    charge = math.sqrt(square * compliance * permittivity * VACUUM_PERMITTIVITY)
    return np.array(
        [math.log(compliance), math.log(charge), math.log(permittivity), 0.012, 0.01, 0.015]
    )


def _curve(
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
