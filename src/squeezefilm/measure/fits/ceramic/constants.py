"""What the sweep of a bare ceramic says, whatever its shape."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.complex_fit import ComplexFit, sweep_adequacy
from squeezefilm.measure.fits.estimate import Adequacy, Estimate, Observation
from squeezefilm.measure.fits.sweep_reading import SweepPeaks, sweep_peaks
from squeezefilm.measure.recordings.kinds import ImpedanceSweep


@dataclass(frozen=True, eq=False)
class CeramicConstants:
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
    adequacy: Adequacy
    fit: ComplexFit

    @property
    def observations(self) -> tuple[Observation, ...]:
        """None: constants of a material are no answers of a display."""
        return ()


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
        "adequacy": sweep_adequacy(fit, sweep.frequency, model),
        "fit": fit,
    }


def resonance_peaks(sweep: ImpedanceSweep) -> SweepPeaks:
    """`sweep_peaks` of a sweep that holds a resonance and the parallel resonance above it. Raises
    `InputError` for one that does not."""
    peaks = sweep_peaks(sweep)
    if not peaks.conductance_frequency < peaks.resistance_frequency:
        raise InputError(
            f"the largest resistance ({peaks.resistance_frequency / 1e3:.5g} kHz) is not above the "
            f"largest conductance ({peaks.conductance_frequency / 1e3:.5g} kHz); give a sweep with "
            "the first resonance and the parallel resonance above it",
            quantity="admittance",
        )
    return peaks
