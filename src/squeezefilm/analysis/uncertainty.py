"""How sure a friction is: quasi-Monte-Carlo over what is uncertain, and which of it matters."""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.analysis.parameters import (
    SKIN_COMPLIANCE,
    Parameter,
    replaced,
    uncertain_parameters,
)
from squeezefilm.chain.friction import FrictionLaw, friction_law
from squeezefilm.chain.prediction import Prediction
from squeezefilm.chain.touch import touch
from squeezefilm.display import Display
from squeezefilm.errors import InputError, OutOfRangeError, SqueezefilmError
from squeezefilm.plate.beam.response import beam_response
from squeezefilm.plate.layout import AnnularStator, RectangularPlate
from squeezefilm.plate.working_mode import working_mode
from squeezefilm.progress import SayProgress

LEVEL: si.Dimensionless = 0.9
_MOST_FAILED = 0.05


@dataclass(frozen=True)
class Influence:
    """How much of the variance of µ′/µ one parameter explains, alone and with all its company.

    First-order and total Sobol' indices with the half width of their 95 % confidence interval.
    """

    parameter: Parameter
    first_order: si.Dimensionless
    first_order_error: si.Dimensionless
    total: si.Dimensionless
    total_error: si.Dimensionless


@dataclass(frozen=True, eq=False)
class UncertainFriction:
    """µ′/µ with its interval: `nominal` at the described values, `interval` between the 5 % and
    95 % quantiles of `samples` (µ′/µ) with their `amplitudes` (m), all parameters varied at once.

    `influences` are ranked, the most important to know better first. `failed` samples had no load
    balance (asperities pressed through) and are left out, with the whole row of the design.
    """

    nominal: si.Dimensionless
    median: si.Dimensionless
    interval: tuple[si.Dimensionless, si.Dimensionless]
    level: si.Dimensionless
    samples: si.DimensionlessArray
    amplitudes: si.MetreArray
    influences: tuple[Influence, ...]
    failed: int
    evaluations: int
    seed: int
    model: str

    @property
    def sentence(self) -> str:
        """The result as one says it: µ′/µ = 0.41 (0.28–0.55)."""
        low, high = self.interval
        return f"µ′/µ = {self.nominal:.2f} ({low:.2f}–{high:.2f})"

    def summary(self) -> dict[str, Any]:
        """The numbers for ``--json``, with units in the keys where there are any."""
        return {
            "relative_friction": self.nominal,
            "relative_friction_median": self.median,
            "relative_friction_interval": list(self.interval),
            "interval_level": self.level,
            "evaluations": self.evaluations,
            "failed": self.failed,
            "seed": self.seed,
            "measure_next": [
                {
                    "parameter": item.parameter.path,
                    "total_order": item.total,
                    "total_order_error": item.total_error,
                    "first_order": item.first_order,
                    "first_order_error": item.first_order_error,
                    "distribution": item.parameter.origin,
                    "range": [
                        si.format_quantity(value, item.parameter.unit)
                        for value in item.parameter.distribution.support
                    ],
                    "source": item.parameter.source,
                }
                for item in self.influences
            ],
        }


def uncertain_friction(
    display: Display,
    prediction: Prediction,
    *,
    samples: int = 128,
    seed: int = 1,
    progress: SayProgress | None = None,
) -> UncertainFriction:
    """A prediction's friction, by partial levitation, with all that is uncertain varied at once.

    Saltelli's design over Sobol' points: `samples` (a power of two, 8 to 65 536) base points make
    samples × (parameters + 2) evaluations. The plate's own uncertain dimensions and constants move
    the amplitude as a beam's would (a solved plate for every sample would take hours), Q and
    voltage in proportion; the drive is taken to follow the resonance. Source: Saltelli et al. 2010,
    10.1016/j.cpc.2009.09.018, by SALib. Raises `InputError` for `samples` that are no power of two,
    `OutOfRangeError` where more than 5 % of the samples have no load balance.
    """
    if samples < 8 or samples > 65536 or samples & (samples - 1):
        raise InputError(
            f"samples = {samples} cannot be used: take a power of two from 8 to 65536, like 128"
        )
    driven = prediction.voltage is not None
    parameters = uncertain_parameters(display, prediction.surface.name, driven=driven)
    values = _quantiles(parameters, _saltelli_points(parameters, samples, seed))
    tell = progress or (lambda _: None)
    friction, amplitude = _evaluate(display, prediction, parameters, values, tell)
    blocks = friction.reshape(samples, len(parameters) + 2)
    whole = np.isfinite(blocks).all(axis=1)
    failed = int(np.count_nonzero(~np.isfinite(friction)))
    if failed > _MOST_FAILED * friction.size:
        raise OutOfRangeError(
            f"{failed} of {friction.size} samples have no load balance: within its uncertainty "
            "this finger presses its asperities through. Narrow the ranges, press less, or vibrate "
            "less"
        )
    kept = blocks[whole]
    independent = np.concatenate([kept[:, 0], kept[:, -1]])
    amplitudes = amplitude.reshape(blocks.shape)[whole]
    tails = (1 - LEVEL) / 2
    low, middle, high = np.quantile(independent, [tails, 0.5, 1 - tails])
    return UncertainFriction(
        nominal=_nominal(prediction),
        median=float(middle),
        interval=(float(low), float(high)),
        level=LEVEL,
        samples=independent,
        amplitudes=np.concatenate([amplitudes[:, 0], amplitudes[:, -1]]),
        influences=_influences(parameters, kept, seed),
        failed=failed,
        evaluations=friction.size,
        seed=seed,
        model="partial levitation between its two limits; Sobol' indices by SALib",
    )


def _problem(parameters: tuple[Parameter, ...]) -> dict[str, Any]:
    """The parameters as SALib takes them: each by its share of probability."""
    return {
        "num_vars": len(parameters),
        "names": [item.path for item in parameters],
        "bounds": [[0.0, 1.0]] * len(parameters),
    }


def _saltelli_points(parameters: tuple[Parameter, ...], samples: int, seed: int) -> si.FloatArray:
    """The design's points in the unit cube, shape (samples · (parameters + 2), parameters)."""
    from SALib.sample import sobol

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        points = sobol.sample(_problem(parameters), samples, calc_second_order=False, seed=seed)
    return np.asarray(points)


def _quantiles(parameters: tuple[Parameter, ...], points: si.FloatArray) -> si.FloatArray:
    """The parameters' values at points of the unit cube; a column for each."""
    return np.column_stack(
        [item.distribution.quantile(points[:, k]) for k, item in enumerate(parameters)]
    )


def _influences(
    parameters: tuple[Parameter, ...], friction: si.DimensionlessArray, seed: int
) -> tuple[Influence, ...]:
    """What each parameter explains of the design's frictions, shape (samples, parameters + 2); the
    most important first."""
    from SALib.analyze import sobol

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        indices = sobol.analyze(
            _problem(parameters),
            friction.ravel(),
            calc_second_order=False,
            seed=seed,
            print_to_console=False,
        )
    found = [
        Influence(item, *(float(indices[key][k]) for key in ("S1", "S1_conf", "ST", "ST_conf")))
        for k, item in enumerate(parameters)
    ]
    return tuple(sorted(found, key=lambda item: -item.total))


@dataclass(frozen=True, eq=False)
class FrictionBand:
    """µ′/µ over the vibration amplitude with everything but the amplitude uncertain.

    `low` and `high` are quantiles that hold `level` of the samples at each amplitude; NaN where
    more than half of them have no load balance.
    """

    amplitude: si.MetreArray
    low: si.DimensionlessArray
    high: si.DimensionlessArray
    level: si.Dimensionless
    samples: int


def friction_band(
    display: Display,
    prediction: Prediction,
    amplitude: si.MetreArray,
    *,
    samples: int = 64,
    seed: int = 1,
    progress: Callable[[str, float], None] | None = None,
) -> FrictionBand:
    """The band in which µ′/µ lies at each amplitude (m, zero-to-peak, shape (n,)).

    What is uncertain of finger, gas and surface is varied at once, as in `uncertain_friction`, by
    `samples` Sobol' points (a power of two); drive and actuator stand still, since the amplitude is
    the abscissa. `progress` is called with a text and a fraction. Raises `InputError` for
    amplitudes below 0.
    """
    from scipy.stats import qmc

    parameters = uncertain_parameters(display, prediction.surface.name, driven=False)
    values = _quantiles(parameters, qmc.Sobol(len(parameters), rng=seed).random(samples))
    rows = np.full((samples, amplitude.size), np.nan)
    for number, (changes, share) in enumerate(_changes(parameters, values)):
        if progress is not None:
            progress(f"sample {number + 1} of {samples}", number / samples)
        try:
            limits = _law(replaced(display, changes), prediction).limits(amplitude)
        except SqueezefilmError:
            continue
        rows[number] = share * limits.own + (1 - share) * limits.one_gap
    known = np.isfinite(rows).sum(axis=0) > samples / 2
    tails = (1 - LEVEL) / 2
    edges = np.full((2, amplitude.size), np.nan)
    edges[:, known] = np.nanquantile(rows[:, known], [tails, 1 - tails], axis=0)
    return FrictionBand(amplitude, edges[0], edges[1], LEVEL, samples)


def _nominal(prediction: Prediction) -> float:
    law = dataclasses.replace(prediction.law, model="partial-levitation")
    return law.at(prediction.vibration_amplitude)


def _evaluate(
    display: Display,
    prediction: Prediction,
    parameters: tuple[Parameter, ...],
    values: si.FloatArray,
    tell: SayProgress,
) -> tuple[si.DimensionlessArray, si.MetreArray]:
    friction = np.full(len(values), np.nan)
    amplitude = np.full(len(values), np.nan)
    scale = _Amplitude(display, prediction)
    every = len(values) // 20  # of 64 samples at least
    for number, (changes, compliance) in enumerate(_changes(parameters, values)):
        if number % every == 0:
            tell(f"friction of sample {number + 1} of {len(values)}")
        try:
            here = replaced(display, changes)
            friction[number], amplitude[number] = _one(here, prediction, scale(here), compliance)
        except SqueezefilmError:
            continue
    return friction, amplitude


def _changes(
    parameters: tuple[Parameter, ...], values: si.FloatArray
) -> Iterator[tuple[dict[str, float], float]]:
    """Of each sample: values by their path in the display, and the skin's compliance."""
    compliance = [item.path for item in parameters].index(SKIN_COMPLIANCE)
    paths = [item.path for item in parameters if item.path != SKIN_COMPLIANCE]
    for row in values:
        changes = dict(zip(paths, np.delete(row, compliance).tolist(), strict=True))
        yield changes, float(row[compliance])


def _law(display: Display, prediction: Prediction) -> FrictionLaw:
    """Partial levitation on a display with other values, at a prediction's working point."""
    return friction_law(
        display,
        prediction.mode.half_wavelength,
        prediction.frequency,
        surface=display.surface(prediction.surface.name),
        normal_force=prediction.normal_force,
        model="partial-levitation",
        position=prediction.law.position,
    )


def _one(
    display: Display, prediction: Prediction, free_amplitude: si.Metre, compliance: float
) -> tuple[float, float]:
    p, law = prediction, _law(display, prediction)
    amplitude = free_amplitude
    if p.voltage is not None and p.mode.modal_mass is not None:
        quality = getattr(display.actuator, "quality_factor", p.mode.quality_factor)
        mode = dataclasses.replace(p.mode, quality_factor=float(quality))
        amplitude = touch(mode, law, free_amplitude).amplitude
    limits = law.limits(amplitude)
    own, tied = float(limits.own[0]), float(limits.one_gap[0])
    return compliance * own + (1 - compliance) * tied, amplitude


class _Amplitude:
    """The free amplitude of a display with other values, from that of the prediction."""

    def __init__(self, display: Display, prediction: Prediction) -> None:
        self.nominal, self.prediction = display, prediction
        self.free = prediction.touch.free_amplitude
        self.reference = self._per_volt(display) if prediction.voltage is not None else 1.0

    def __call__(self, display: Display) -> si.Metre:
        free = self.free * self._volts(display)
        here, nominal = display.actuator, self.nominal.actuator
        if self.prediction.voltage is None or here == nominal:
            return free
        if dataclasses.replace(here, quality_factor=nominal.quality_factor) == nominal:
            # At resonance, in proportion; a stator's amplitude is measured, whatever its Q.
            measured = isinstance(here, AnnularStator)
            return free * (1 if measured else here.quality_factor / nominal.quality_factor)
        return free * self._per_volt(display) / self.reference

    def _volts(self, display: Display) -> float:
        """An uncertain drive in proportion; a voltage asked for stands as it is."""
        if self.prediction.voltage is None or self.nominal.drive.voltage == 0:
            return 1.0
        return display.drive.voltage / self.nominal.drive.voltage

    @staticmethod
    def _per_volt(display: Display) -> float:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            if isinstance(display.actuator, RectangularPlate):
                return beam_response(display.actuator).amplitude_per_volt
            return working_mode(display.actuator).amplitude_per_volt
