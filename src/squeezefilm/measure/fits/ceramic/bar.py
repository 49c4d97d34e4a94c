"""Constants of a ceramic bar from the sweep of its length resonance."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import VACUUM_PERMITTIVITY
from squeezefilm.measure.fits.ceramic.constants import (
    CeramicConstants,
    constants_of,
    coupling_read,
    permittivity_read,
    resonance_peaks,
)
from squeezefilm.measure.fits.complex_fit import fit_complex
from squeezefilm.measure.fits.estimate import Estimate
from squeezefilm.measure.fits.sweep_reading import require_passive
from squeezefilm.measure.recordings.kinds import CeramicBar, ImpedanceSweep


@dataclass(frozen=True, eq=False)
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
    fit = fit_complex(lambda p: _curve(bar, p, omega), _start(sweep, bar), sweep.admittance)
    curve = _curve(bar, fit.parameters, omega)[0]

    def coupling(p: si.FloatArray) -> float:
        return math.exp(p[1] - (p[0] + p[2]) / 2 - math.log(VACUUM_PERMITTIVITY) / 2)

    return BarConstants(
        coupling_31=fit.estimate(coupling, "1"),
        **constants_of(fit, sweep, curve, (0, 1, 2, 3, 4, 5), "The formula of a bar"),
    )


def _start(sweep: ImpedanceSweep, bar: CeramicBar) -> si.FloatArray:
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
