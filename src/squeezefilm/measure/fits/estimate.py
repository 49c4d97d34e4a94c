"""Results of a fit: a value with its interval, what was observed, whether the model is adequate;
and a message in place of a fit whose arithmetic ends.

Whether what a fit leaves is noise is judged by neighbours: noise differs from point to point; a
wrong model leaves them alike. Von Neumann's ratio of mean square successive difference to mean
square (10.1214/aoms/1177731677) tells one from the other without knowing how large the noise is.
"""

from __future__ import annotations

import functools
import math
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Annotated, ClassVar, NamedTuple, ParamSpec, TypeVar

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.results import Result

LEVEL: si.Dimensionless = 0.95
"""The level of every interval of a fit."""


@dataclass(frozen=True)
class Estimate:
    """A fitted value with its standard error and interval, in the value's own `unit`."""

    value: float
    standard_error: float
    interval: tuple[float, float]
    unit: str
    level: si.Dimensionless = LEVEL

    def __str__(self) -> str:
        value, error = self.value, self.standard_error
        unit = si.Unit(self.unit)
        return f"{si.format_quantity(value, unit, 6)} ± {si.format_quantity(error, unit, 2)}"


@dataclass(frozen=True)
class Adequacy:
    """Judgement of whether the fitted model describes what was recorded.

    `residual` is the mean distance |data − model| / |data|; `noise` what noise alone would leave;
    `where` names the place of the worst misfit in words; `sentence` says all of it to a person.
    """

    adequate: bool
    residual: si.Dimensionless
    noise: si.Dimensionless
    where: str
    sentence: str


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class FitResult(Result):
    """A fit's result: its `Estimate`s and whether it is adequate are what a person looks for."""

    adequacy: Adequacy
    _shown: ClassVar[str] = "adequacy.sentence"

    @property
    def observations(self) -> tuple[Observation, ...]:
        """Observations for a calibration; none where no answer of a display was fitted."""
        return ()

    def _told(self) -> Iterator[tuple[str, str]]:
        estimates = ((name, value) for name, value in vars(self).items())
        yield from ((name, str(e)) for name, e in estimates if isinstance(e, Estimate))
        yield from super()._told()


@si.checked_numbers
@dataclass(frozen=True)
class Observation:
    """A number that a calibration may use: an `answer` of the display by its name in the library
    (`resonance_frequency`, …) in SI units, its standard error, and under which `conditions` (SI, by
    name: voltage, normal_force, vibration_amplitude, finger_speed, x, y). `recording` is the name
    of the file that it was read from, where there is one."""

    answer: str
    value: float
    standard_error: Annotated[float, si.AtLeast(0.0)]
    conditions: Mapping[str, float] = field(default_factory=dict)
    recording: str = ""

    def __post_init__(self) -> None:
        for name, value in self.conditions.items():
            si.require(name, value)

    def in_words(self, answer: str) -> str:
        """An answer as it is said, with the recording that it was read from."""
        return f"{answer} ({self.recording})" if self.recording else answer


def observed(conditions: Mapping[str, float], **answers: Estimate) -> tuple[Observation, ...]:
    """Observations of answers by their names, all estimated under some `conditions` (SI)."""
    return tuple(
        Observation(answer, estimate.value, estimate.standard_error, conditions)
        for answer, estimate in answers.items()
    )


def amplitude_over(volts: si.Volt, amplitude: Estimate, frequency: si.Hertz) -> Observation:
    """Observation of the amplitude per volt of an `amplitude` (m) at one frequency and voltage."""
    return Observation(
        "amplitude_per_volt",
        amplitude.value / volts,
        amplitude.standard_error / volts,
        {"frequency": frequency, "voltage": volts},
    )


# Of a standard error, to either side of a fitted number.
_STEP = 1e-5


def interval_around(
    value: float,
    standard_error: float,
    freedom: int,
    unit: str,
    *,
    logarithmic: bool = False,
) -> Estimate:
    """A value with Student's interval for its degrees of freedom; of the value's logarithm where
    `logarithmic`."""
    from scipy.special import stdtrit

    reach = float(stdtrit(max(freedom, 1), 0.5 + LEVEL / 2)) * standard_error
    low, high = value - reach, value + reach
    if logarithmic:
        with np.errstate(over="ignore"):
            value, low, high = (float(np.exp(end)) for end in (value, low, high))
        return Estimate(value, value * standard_error, (low, high), unit)
    return Estimate(value, standard_error, (low, high), unit)


def inverse_of(estimate: Estimate) -> Estimate:
    """Inverse of an estimate (1), such as Q from a loss factor: its interval's ends change places.

    What is not above zero, an end of the interval or the value itself (noise can make a loss
    seem a gain), has an infinite inverse.
    """
    low, high = estimate.interval
    value, *ends = (
        1.0 / number if number > 0 else math.inf for number in (estimate.value, high, low)
    )
    error = value * estimate.standard_error / estimate.value if estimate.value > 0 else math.inf
    return Estimate(value, error, (ends[0], ends[1]), "1")


def propagated(
    of: Callable[[si.FloatArray], float],
    numbers: si.FloatArray,
    covariance: si.FloatArray,
    freedom: int,
    unit: str,
    *,
    positive: bool = False,
) -> Estimate:
    """A number that follows from fitted ones, with its interval by the delta method.

    `positive` numbers get theirs on a logarithmic scale, so that it never reaches zero. Holds where
    the number bends little within its own interval.
    """
    scale = np.sqrt(np.diag(covariance))

    def value(at: si.FloatArray) -> float:
        number = of(at)
        return float(np.log(number)) if positive else float(number)

    gradient = np.zeros(numbers.size)
    for i in np.flatnonzero(scale > 0):
        step = np.zeros(numbers.size)
        step[i] = max(_STEP * scale[i], 1e-9 * abs(numbers[i]) + 1e-15)
        gradient[i] = (value(numbers + step) - value(numbers - step)) / (2 * step[i])
    error = math.sqrt(max(float(gradient @ covariance @ gradient), 0.0))
    return interval_around(value(numbers), error, freedom, unit, logarithmic=positive)


_P = ParamSpec("_P")
_F = TypeVar("_F", bound=FitResult)


def guarded_fit(fit: Callable[_P, _F]) -> Callable[_P, _F]:
    """Have a fit raise `InputError` where its arithmetic ends, or an observation is refused.

    Trial steps of a search may overflow; that is no message to anybody, and none comes of it.
    """

    @functools.wraps(fit)
    def guarded(*args: _P.args, **kwargs: _P.kwargs) -> _F:
        try:
            with np.errstate(all="ignore"), warnings.catch_warnings():
                warnings.simplefilter("ignore", RuntimeWarning)
                warnings.simplefilter("ignore", np.exceptions.RankWarning)
                fitted = fit(*args, **kwargs)
                try:
                    _ = fitted.observations
                except InputError as error:
                    raise _no_fit(str(error)) from error
        except (ArithmeticError, np.linalg.LinAlgError) as error:
            raise _no_fit(str(error)) from error
        return fitted

    return guarded


def _no_fit(why: str) -> InputError:
    return InputError(
        f"the recording has no fit ({why}): its values are all alike, jump by many orders of "
        "magnitude, or show nothing of what is to be fitted. Look at it with squeezefilm measure "
        "check"
    )


STRUCTURED = 4.0
"""Standard deviations by which the ratio must lie below that of noise if neighbours are alike."""

TOLERATED: si.Dimensionless = 0.01
"""A misfit of this share of what was recorded still counts as a description of it."""

TOLERATED_SOMEWHERE: si.Dimensionless = 0.06
"""... and so much of the largest, at five neighbouring points (assumed, as the next)."""

ROUGH: si.Dimensionless = 0.03
"""Misfit up to which a model that is not adequate still gives its numbers roughly."""

_NEAR = 5
_HOPELESS = 0.5
_MOST_ALIKE = 0.98


class Structure(NamedTuple):
    """Likeness of neighbouring residuals: `correlation` 0 for noise, toward 1 for a misfit,
    `significance` in standard deviations."""

    correlation: si.Dimensionless
    significance: si.Dimensionless


def structure_of(residual: si.Array) -> Structure:
    """Likeness of the neighbours in a row of residuals (points,), real or complex."""
    parts = [residual.real, residual.imag] if np.iscomplexobj(residual) else [residual]
    squares = sum(float(part @ part) for part in parts)
    count = len(parts) * residual.size
    if squares == 0 or residual.size < 6:
        return Structure(0.0, 0.0)
    steps = sum(float(np.diff(part) @ np.diff(part)) for part in parts)
    ratio = steps / squares * residual.size / (residual.size - 1)
    return Structure(max(1 - ratio / 2, 0.0), (2 - ratio) / (2 / np.sqrt(count)))


def correlation_factor(residual: si.Array) -> float:
    """Factor of standard errors where neighbouring residuals are alike.

    √((1 + ρ)/(1 − ρ)) for a correlation ρ that falls geometrically with the distance; 1 where it
    could be noise.
    """
    structure = structure_of(residual)
    if structure.significance < STRUCTURED:
        return 1.0
    alike = min(structure.correlation, _MOST_ALIKE)
    return float(np.sqrt((1 + alike) / (1 - alike)))


def adequacy_of(
    data: si.Array,
    residual: si.Array,
    place: Callable[[int], str],
    *,
    remedy: str,
    said: str = "",
    model: str = "The model",
) -> Adequacy:
    """Judge whether a `model` describes `data` (points,), by what it leaves of them, in order.

    Both in the units of the fit: where every point counts by its own size, as in a sweep of
    impedance, both are over that size. `place` puts a point's number into words ("at 30.5 kHz"),
    `remedy` says what to do about a misfit, `said` goes before all else. The misfit is what the
    residual has beyond noise; noise is what differs between neighbours. A misfit of five
    neighbours is judged by itself, since a whole row hides it.
    """
    size = float(np.mean(np.abs(data))) or 1.0
    left = float(np.mean(np.abs(residual))) / size
    structure = structure_of(residual)
    structured = structure.significance > STRUCTURED
    noise = left * float(np.sqrt(max(1 - structure.correlation, 0.0))) if structured else left
    misfit = float(np.sqrt(max(left**2 - noise**2, 0.0)))
    where = place(_worst(residual))
    local = _beyond_noise(residual, noise * size) / (float(np.max(np.abs(data))) or 1.0)

    def judged(adequate: bool, sentence: str) -> Adequacy:
        return Adequacy(adequate, left, noise, where, said + sentence)

    if left > _HOPELESS:
        return judged(
            False,
            f"{model} leaves {si.percent(left)} of what was recorded undescribed, most of it "
            f"{where}: its numbers mean nothing. {remedy}",
        )
    off = f"it is off by {si.percent(misfit, 1)} beyond noise, most {where}"
    if local > TOLERATED_SOMEWHERE and misfit <= TOLERATED:
        off = f"it is off by {si.percent(local, 1)} beyond noise {where}"
    if (structured and misfit > TOLERATED) or local > TOLERATED_SOMEWHERE:
        if misfit <= ROUGH and local <= 2 * TOLERATED_SOMEWHERE:
            return judged(
                False,
                f"{model} describes what was recorded only roughly: {off}. Its numbers are good "
                f"for a first look; the intervals are widened and are no bound. {remedy}",
            )
        return judged(
            False,
            f"{model} does not describe what was recorded: {off}. Intervals are widened for it, "
            f"which cannot make a wrong model right. {remedy}",
        )
    sentence = f"{model} leaves {si.percent(left, 2)} of what was recorded, as noise would"
    if structured:
        sentence = (
            f"{model} describes what was recorded but for {si.percent(misfit, 2)} beyond noise, "
            f"most {where}; intervals are widened for it"
        )
    return judged(True, sentence + ".")


def _beyond_noise(residual: si.Array, noise: float) -> float:
    """Excess of the largest mean of five neighbours over what noise of this mean size makes of one:
    four of its standard deviations."""
    if residual.size < _NEAR:
        return 0.0
    means = np.abs(np.convolve(residual, np.ones(_NEAR) / _NEAR, mode="valid"))
    # A mean size tells the standard deviation of one component.
    share = np.sqrt(2 / np.pi) if np.iscomplexobj(residual) else np.sqrt(np.pi / 2)
    return float(means.max() - STRUCTURED * share * noise / np.sqrt(_NEAR))


def _worst(residual: si.Array) -> int:
    """Index where five residuals in a row are largest on average: a misfit, and not one odd
    point."""
    row = np.abs(residual)
    if row.size < _NEAR:
        return int(np.argmax(row))
    return int(np.argmax(np.convolve(row, np.ones(_NEAR) / _NEAR, mode="same")))
