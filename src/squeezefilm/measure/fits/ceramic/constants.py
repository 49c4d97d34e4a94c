"""Fits of a bare ceramic of any shape, and what is known of one before it is measured: the ratios
of the library's ceramics."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, SqueezefilmError
from squeezefilm.core.materials import VACUUM_PERMITTIVITY
from squeezefilm.core.presets.materials import materials
from squeezefilm.measure.fits.complex_fit import ComplexFit, Prior, sweep_adequacy
from squeezefilm.measure.fits.estimate import Adequacy, Estimate, Observation
from squeezefilm.measure.fits.sweep_reading import SweepPeaks, sweep_peaks
from squeezefilm.measure.recordings.kinds import ImpedanceSweep

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
_CLASS = 1.5
"""Spread of these three among piezoelectric ceramics at large, barium titanate and those without
lead among them, over that of the library's (assumed)."""
_NO_CERAMIC = 2.5
_LOSS, _LOSS_SPREAD = 0.015, 0.02
_SHEAR_LOSS_SPREAD = 0.2


@functools.cache
def ceramic_prior(of_class: bool = False) -> Prior:
    """Means and standard deviations of `PARAMETERS`.

    The ratios that a sweep of a disc hardly tells (among them Poisson's) scatter as those of the
    library's lead zirconate titanates do, hard to very soft; of a further one of their kind they
    are known to √(1 + 1/n) of that. The three sizes are as good as unknown, or `of_class` those of
    piezoelectric ceramics. Losses: 0.015 ± 0.02; that of s12 that of s11 to 20 % (both
    assumed). Read from `core/presets/materials.toml`.
    """
    rows = np.array(
        [_ratios(material.values) for material in materials() if material.kind == "ceramic"]
    )
    mean, spread = rows.mean(axis=0), rows.std(axis=0, ddof=1) * math.sqrt(1 + 1 / len(rows))
    sizes = [0, 2, 3]
    spread[sizes] = _CLASS * spread[sizes] if of_class else WIDE
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


@dataclass(frozen=True)
class RecordedMode:
    """The mode of a body, counted from 1 for the lowest, that a sweep was taken to be of, and which
    `other` one would be the next likely: `preference` is the natural logarithm of the Bayes
    factor."""

    number: int
    other: int
    preference: float

    @property
    def sentence(self) -> str:
        """A sentence on which mode was taken, and how sure that is."""
        said = (
            f"It was taken for mode {self.number} of its kind, counted from the lowest, preferred "
            f"over mode {self.other} by {self.preference:.3g} (natural logarithm of the Bayes "
            "factor)"
        )
        if self.preference >= DECISIVE:
            leaning = " Above the lowest the constants lean on what is usual of ceramics."
            return f"{said}.{leaning if self.number > 1 else ''}"
        return f"{said}, which decides nothing: sweep the lowest mode too, alone or with this one."


DECISIVE = math.log(20.0)
"""Preference on a mode from which it counts as told from the others: 20 to 1."""
_FITTED = 12.0
"""Excess over the best start's distance, as −ln likelihood, up to which a mode is fitted."""


def recorded_mode(
    starts: Sequence[si.FloatArray],
    fit: Callable[[int], ComplexFit],
    prior: Prior,
) -> tuple[ComplexFit, RecordedMode]:
    """The fit of the mode, from 1 on, that was probably recorded: of each of `starts` (parameters
    read off the sweep as if it were of that mode, ln s11 first) that ceramics (`prior`) may have.

    The evidence of each is by Laplace's approximation at its fit: what is left of the data at their
    number of independent points, the prior there, and the volume that the data leave. Raises what
    `fit` raises where it fails of all.
    """
    far = [float(np.sum(((start - prior.mean) / prior.spread) ** 2)) / 2 for start in starts]
    fits: dict[int, ComplexFit] = {}
    failed: Exception | None = None
    for k in range(len(starts)):
        if far[k] > min(far) + _FITTED:
            continue
        try:
            fitted = fit(k + 1)
        except (SqueezefilmError, ArithmeticError, np.linalg.LinAlgError) as error:
            failed = failed or error
            continue
        # A fit may end at another mode than the one that it began at.
        at = int(np.argmin([abs(float(fitted.parameters[0] - other[0])) for other in starts]))
        if at not in fits or fitted.spread < fits[at].spread:
            fits[at] = fitted
    if not fits:
        assert failed is not None
        raise failed
    likely = _evidence(fits, prior)
    best = max(likely, key=lambda k: likely[k])
    behind = {k: likely[best] - value for k, value in likely.items() if k != best}
    behind |= {k: far[k] - far[best] for k in range(len(starts)) if k not in likely}
    other = min(behind, key=lambda k: behind[k])
    return fits[best], RecordedMode(best + 1, other + 1, max(behind[other], 0.0))


def _evidence(fits: Mapping[int, ComplexFit], prior: Prior) -> dict[int, float]:
    """The logarithm of each fit's evidence, but for what is common to all."""
    freedom = min(fits.values(), key=lambda fit: fit.spread).degrees_of_freedom
    logs = {}
    for k, fit in fits.items():
        off = (fit.parameters - prior.mean) / prior.spread
        volume = np.linalg.slogdet(fit.covariance / np.outer(prior.spread, prior.spread))[1]
        logs[k] = float(volume - off @ off) / 2 - freedom * math.log(fit.spread)
    return logs


def coupling_read(peaks: SweepPeaks, shares: Sequence[float], number: int) -> si.Dimensionless:
    """The square of the material's coupling (at most 0.9) that resonance and parallel resonance of
    a body's mode say. With k² of the material a mode has k² times its one of the `shares` of the
    free capacitance, beside which 1 less k² times the shares up to its own stands still."""
    ratio = (peaks.resistance_frequency / peaks.conductance_frequency) ** 2 - 1
    return min(ratio / (shares[number - 1] + ratio * sum(shares[:number])), 0.9)


def permittivity_read(
    sweep: ImpedanceSweep, square: float, motion: si.ComplexArray, geometry: si.Metre
) -> si.Dimensionless:
    """ε33 at constant stress that all points say together, of a body whose free capacitance is ε33
    times its `geometry` (area over thickness): Y is iω times that times 1 − k² + k² motion."""
    free = 2 * np.pi * sweep.frequency * VACUUM_PERMITTIVITY * geometry
    return float(np.median(np.abs(sweep.admittance / (1 + square * (motion - 1))) / free))


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
    mode: RecordedMode

    @property
    def observations(self) -> tuple[Observation, ...]:
        """No observations: constants of a material are no answers of a display."""
        return ()


def constants_of(
    fit: ComplexFit,
    sweep: ImpedanceSweep,
    curve: si.ComplexArray,
    at: tuple[int, int, int, int, int, int],
    model: str,
    mode: RecordedMode,
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
            mode,
            float(fit.parameters[s11] - ceramic_prior().mean[0]),
        ),
        "fit": fit,
        "mode": mode,
    }


def _doubted(adequacy: Adequacy, mode: RecordedMode, away: float) -> Adequacy:
    """The judgement with the mode that was taken: inadequate where another is as likely, and where
    s11 is beyond any ceramic, by its logarithm `away` from the prior's."""
    sentence = f"{adequacy.sentence} {mode.sentence}"
    if abs(away) >= math.log(_NO_CERAMIC):
        sentence += (
            f" The compliance is {math.exp(away):.2g} times that of usual ceramics, which none "
            "has: another mode was probably recorded; sweep around the lowest one."
        )
    adequate = abs(away) < math.log(_NO_CERAMIC) and mode.preference >= DECISIVE
    return replace(adequacy, adequate=adequacy.adequate and adequate, sentence=sentence)


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
