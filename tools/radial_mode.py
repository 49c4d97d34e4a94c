"""What the first radial mode of a disc lets one say of a higher one, before that is measured."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError
from squeezefilm.measure.fits.ceramic.constants import DiscConstants, compliances
from squeezefilm.measure.fits.complex_fit import SweepPeaks, sweep_peaks
from squeezefilm.measure.fits.estimate import Estimate
from squeezefilm.measure.recordings.kinds import ImpedanceSweep
from squeezefilm.physics.plate.ring.ceramic_disc import disc_admittance, weak_constants

LEVEL = 0.95
_ROOTS = (2.049, 5.389, 8.572, 11.732)
"""η of the radial modes of a thin disc of Poisson's ratio 0.3: (1 − σ) J1(η) = η J0(η)."""

_BAND, _POINTS = (0.92, 1.16), 160


@si.checked_numbers
@dataclass(frozen=True)
class Extrapolation:
    """What is assumed of the ceramic between the frequency of the fit and that of the prediction.

    `dispersion` and its spread: a loss that hardly depends on frequency goes with constants that
    fall by (2/π) tan δ per factor e of frequency (Kramers and Kronig); 1 is all of that.
    `loss_spread` is the standard deviation of the logarithm of losses there over those here: of the
    mechanical ones, and of the electrical ones beside it (assumed). `conductance_spread` and
    `frequency_spread`, relative, are what the solved disc leaves at the mode that was fitted; the
    prediction takes them, or what it finds there if that is more.
    """

    dispersion: si.Dimensionless = 1.0
    dispersion_spread: Annotated[si.Dimensionless, si.AtLeast(0)] = 0.5
    mechanical_loss_spread: Annotated[si.Dimensionless, si.AtLeast(0)] = 0.12
    electrical_loss_spread: Annotated[si.Dimensionless, si.AtLeast(0)] = 0.2
    conductance_spread: Annotated[si.Dimensionless, si.AtLeast(0)] = 0.02
    frequency_spread: Annotated[si.Dimensionless, si.AtLeast(0)] = 0.001


@dataclass(frozen=True, eq=False)
class RadialPrediction:
    """The predicted peaks of a radial mode: medians with 95 % intervals. `series_resonance` (Hz) is
    where the conductance is largest, `peak_conductance` (S) its value, `parallel_resonance` (Hz)
    where the resistance is largest, `peak_resistance` (Ω) its value.

    `shares` is, for every source of doubt, the share of the variance of each of the four (in that
    order) that it alone makes.
    """

    number: int
    series_resonance: Estimate
    parallel_resonance: Estimate
    peak_conductance: Estimate
    peak_resistance: Estimate
    shares: dict[str, tuple[float, float, float, float]]
    draws: int
    seed: int


def predict_radial_mode(
    constants: DiscConstants,
    fitted_on: ImpedanceSweep,
    number: Annotated[int, si.AtLeast(1), si.AtMost(4)] = 2,
    *,
    seed: int = 19,
    draws: Annotated[int, si.AtLeast(20)] = 400,
    assumed: Extrapolation | None = None,
) -> RadialPrediction:
    """Predict a radial mode (2: the second) of the disc whose first mode was fitted.

    The posterior of all constants is drawn, with what is `assumed` of the way to the other
    frequency, and the disc solved for every draw. Tolerances of diameter and thickness need no
    draw: the fit to the first mode takes them into the constants, and what is left of them is the
    share of thickness in the frequency. Raises `InputError` for arguments out of range,
    `ConvergenceError` if a mode is not found.
    """
    si.require("number", number, at_least=1, at_most=len(_ROOTS))
    assumed = assumed or Extrapolation()
    seen = sweep_peaks(fitted_on)
    here = _peaks(constants, constants.fit.parameters, seen.conductance_frequency, 1)
    extra = _left_at_the_fit(here, seen, assumed)
    random = np.random.default_rng(seed)
    deviations = random.standard_normal((draws, constants.fit.parameters.size + 7))
    sources = _sources(constants)

    def drawn(rows: si.FloatArray) -> si.FloatArray:
        found = [
            _drawn(constants, row, seen.conductance_frequency, number, assumed, extra)
            for row in rows
        ]
        return np.asarray(np.log(np.array(found)))

    every = drawn(deviations)
    total = every.var(axis=0)
    shares = {}
    few = deviations[: max(20, draws // 8)]
    for name, columns in sources.items():
        alone = np.zeros_like(few)
        alone[:, columns] = few[:, columns]
        part = drawn(alone).var(axis=0) / total
        shares[name] = (float(part[0]), float(part[1]), float(part[2]), float(part[3]))
    series, parallel, conductance, resistance = (
        _told(every[:, k], unit) for k, unit in enumerate(("Hz", "Hz", "S", "ohm"))
    )
    return RadialPrediction(number, series, parallel, conductance, resistance, shares, draws, seed)


def _told(logs: si.FloatArray, unit: str) -> Estimate:
    low, middle, high = np.exp(np.quantile(logs, [(1 - LEVEL) / 2, 0.5, (1 + LEVEL) / 2]))
    error = float(middle * logs.std(ddof=1))
    return Estimate(float(middle), error, (float(low), float(high)), unit, LEVEL)


def _sources(constants: DiscConstants) -> dict[str, np.ndarray]:
    """Which columns of the deviations belong to which source of doubt: the posterior is drawn
    along its own axes, Poisson's ratio first (see `_posterior_root`)."""
    size = constants.fit.parameters.size
    return {
        "Poisson's ratio": np.array([0]),
        "the other constants": np.arange(1, size),
        "dispersion of the constants": np.array([size]),
        "losses at another frequency": np.array([size + 1, size + 2]),
        "what the disc leaves at the fitted mode": np.arange(size + 3, size + 7),
    }


def _posterior_root(constants: DiscConstants) -> si.FloatArray:
    """A root of the posterior's covariance whose first column goes along Poisson's ratio, with all
    that moves with it; lower triangular with that parameter first."""
    covariance = constants.fit.covariance
    order = np.array([1, 0, *range(2, covariance.shape[0])])
    sizes = np.sqrt(np.diag(covariance))
    scaled = (covariance / np.outer(sizes, sizes))[np.ix_(order, order)]
    lower = np.linalg.cholesky(scaled + 1e-10 * np.eye(order.size))
    root = np.zeros_like(lower)
    root[order] = lower * sizes[order][:, None]
    return root


def _drawn(
    constants: DiscConstants,
    deviation: si.FloatArray,
    fitted_at: si.Hertz,
    number: int,
    assumed: Extrapolation,
    extra: tuple[float, float],
) -> tuple[float, float, float, float]:
    """Series and parallel resonance, peak conductance and resistance of one draw."""
    best = constants.fit.parameters
    p = best + _posterior_root(constants) @ deviation[: best.size]
    rest = deviation[best.size :]
    # A loss is positive, and a drawn one not less than a tenth of the fitted one.
    p[4:7] = np.maximum(p[4:7], 0.1 * best[4:7])
    if number > 1:
        p = _extrapolated(p, rest, _ROOTS[number - 1] / _ROOTS[0], assumed)
    peaks = _peaks(constants, p, fitted_at, number)
    frequency, conductance = extra
    return (
        peaks.conductance_frequency * math.exp(frequency * rest[3]),
        peaks.resistance_frequency * math.exp(frequency * rest[4]),
        peaks.conductance * math.exp(conductance * rest[5]),
        peaks.resistance * math.exp(conductance * rest[6]),
    )


def _extrapolated(
    p: si.FloatArray, rest: si.FloatArray, ratio: si.Dimensionless, assumed: Extrapolation
) -> si.FloatArray:
    """The parameters at `ratio` times the frequency of the fit."""
    p = p.copy()
    slope = assumed.dispersion + assumed.dispersion_spread * rest[0]
    fall = slope * 2 / math.pi * math.log(ratio)
    # s11, d31 and ε33, each by its own loss; ratios and Poisson's ratio stay.
    p[[0, 2, 3]] -= fall * p[[4, 5, 6]]
    p[4] *= math.exp(assumed.mechanical_loss_spread * rest[1])
    p[[5, 6]] *= math.exp(
        assumed.mechanical_loss_spread * rest[1] + assumed.electrical_loss_spread * rest[2]
    )
    return p


def _left_at_the_fit(
    here: SweepPeaks, seen: SweepPeaks, assumed: Extrapolation
) -> tuple[float, float]:
    """What the fitted disc leaves of frequencies and of the two peaks at the mode of the fit."""
    frequency = max(
        abs(math.log(here.conductance_frequency / seen.conductance_frequency)),
        abs(math.log(here.resistance_frequency / seen.resistance_frequency)),
        assumed.frequency_spread,
    )
    conductance = max(
        abs(math.log(here.conductance / seen.conductance)),
        abs(math.log(here.resistance / seen.resistance)),
        assumed.conductance_spread,
    )
    return frequency, conductance


def _peaks(
    constants: DiscConstants, p: si.FloatArray, fitted_at: si.Hertz, number: int
) -> SweepPeaks:
    """The peaks of a radial mode of the disc with parameters `p`, by a sweep and parabolas."""
    middle = fitted_at * _ROOTS[number - 1] / _ROOTS[0]
    low, high = _BAND if number > 1 else (0.92, 1.35)
    frequency = np.linspace(low * middle, high * middle, _POINTS)
    curve = disc_admittance(constants.disc, weak_constants(*compliances(p)), frequency)[0]
    peaks = sweep_peaks(ImpedanceSweep(frequency, curve))
    inside = frequency[0] < peaks.conductance_frequency < peaks.resistance_frequency < frequency[-1]
    if not inside:
        raise ConvergenceError(
            f"radial mode {number} was not found between {frequency[0] / 1e3:.5g} and "
            f"{frequency[-1] / 1e3:.5g} kHz; fit a sweep of the first radial mode"
        )
    return peaks
