"""Results of a fit: a value with its interval, whether the model is adequate, what was observed;
and a message in place of a fit whose arithmetic ends."""

from __future__ import annotations

import functools
import math
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Annotated, ClassVar, ParamSpec, Protocol, TypeVar

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


class FitResult(Result):
    """A fit's result: its estimates and whether it is adequate are what a person looks for."""

    _shown: ClassVar[str] = "adequacy.sentence"

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


class Observing(Protocol):
    """A fit: it has observations."""

    @property
    def observations(self) -> tuple[Observation, ...]:
        """Observations for a calibration."""


_F = TypeVar("_F", bound=Observing)


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
