"""Psychometric functions: the probability of an answer against the intensity of a stimulus.

ψ(x) = γ + (1 − γ − λ) S(x), with the guess rate γ, the lapse rate λ and a shape S that rises
from 0 to 1 (Schütt, Harmeling, Macke & Wichmann 2016, 10.1016/j.visres.2016.02.002). All shapes
are given by the same two numbers, so that they can be compared: the threshold, where S = ½, and
the width, from S = 5 % to S = 95 %. What is held possible of them before the data is a prior.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Literal, get_args

import numpy as np
from scipy.special import betainc, betaincinv, betaln, ndtri

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.errors import InputError
from squeezefilm.study.psychometric import kernel

Shape = Literal["logistic", "gaussian", "gumbel", "weibull"]
Axis = Literal["linear", "log"]

SHAPES: tuple[Shape, ...] = get_args(Shape)
AXES: tuple[Axis, ...] = get_args(Axis)

_CODES: dict[Shape, int] = {
    "logistic": kernel.LOGISTIC,
    "gaussian": kernel.GAUSSIAN,
    "gumbel": kernel.GUMBEL,
    # Weibull's function is Gumbel's of ln x; with the threshold at ½ it is Quick's too.
    "weibull": kernel.GUMBEL,
}


def shape_code(shape: Shape, axis: Axis) -> int:
    """The kernel's number of a shape.

    Raises:
        InputError: an unknown shape or axis, or Weibull's function, which is defined on a
            logarithmic axis, on a linear one.
    """
    si.require_one_of("shape", shape, SHAPES)
    si.require_one_of("axis", axis, AXES)
    if shape == "weibull" and axis != "log":
        raise InputError(
            f"shape = '{shape}' is defined for the logarithm of intensity; give axis = 'log', or "
            "take shape = 'gumbel' for a linear axis",
            quantity="axis",
        )
    return _CODES[shape]


def on_axis(intensity: si.FloatLike, axis: Axis) -> si.FloatArray:
    """Places on the axis of a shape: the intensities, or their natural logarithms.

    Raises:
        InputError: an intensity that is not finite, or not above 0 on a logarithmic axis.
    """
    si.require("intensity", intensity, above=0.0 if axis == "log" else None)
    array = np.asarray(intensity, dtype=float)
    return np.log(array) if axis == "log" else array


@reads_text
@si.checked_numbers
@dataclass(frozen=True, slots=True)
class PsychometricFunction:
    """A psychometric function: ψ(x) = γ + (1 − γ − λ) S((x − threshold)/width).

    Args:
        shape: of S: "logistic", "gaussian", "gumbel", and on a logarithmic axis "weibull"
            (1 − 2^−(x/m)^β with β = 4.0674/width).
        threshold: intensity at which S = ½, in the unit of the stimulus.
        width: from S = 5 % to S = 95 %, above 0: in the unit of the stimulus, or on a
            logarithmic axis the natural logarithm of the ratio of the two intensities.
        guess_rate: γ, probability of the answer without a stimulus (1), at least 0: 1/m where
            one of m alternatives is chosen.
        lapse_rate: λ, probability of another answer however strong the stimulus (1), at least 0;
            γ + λ must be below 1.
        axis: "linear", or "log" where S is a function of ln x; intensities are above 0 then.

    Raises:
        InputError: a value outside its range, an unknown shape or axis.
    """

    shape: Shape
    threshold: float
    width: Annotated[float, si.Above(0.0)]
    guess_rate: Annotated[si.Dimensionless, si.AtLeast(0.0), si.Below(1.0)] = 0.0
    lapse_rate: Annotated[si.Dimensionless, si.AtLeast(0.0), si.Below(1.0)] = 0.0
    axis: Axis = "linear"

    def __post_init__(self) -> None:
        shape_code(self.shape, self.axis)
        si.require("threshold", self.threshold, above=0.0 if self.axis == "log" else None)
        if self.guess_rate + self.lapse_rate >= 1.0:
            raise InputError(
                f"guess_rate + lapse_rate = {self.guess_rate + self.lapse_rate:g} leaves no rise; "
                "their sum must be below 1",
                quantity="lapse_rate",
            )

    @property
    def _theta(self) -> si.FloatArray:
        place = float(on_axis(self.threshold, self.axis))
        return np.array([place, np.log(self.width), self.lapse_rate, self.guess_rate])

    def __call__(self, intensity: si.FloatLike) -> si.DimensionlessLike:
        """Probability of the answer at an intensity (1), the shape of `intensity`."""
        x = on_axis(intensity, self.axis)
        code = shape_code(self.shape, self.axis)
        flat = kernel.probabilities(code, self._theta, np.ascontiguousarray(x).ravel())
        return float(flat[0]) if x.ndim == 0 else flat.reshape(x.shape)

    def intensity(self, probability: si.Dimensionless) -> float:
        """The intensity at which ψ equals a probability between γ and 1 − λ.

        Raises:
            InputError: a probability not between guess rate and 1 − lapse rate.
        """
        si.require("probability", probability, above=self.guess_rate, below=1.0 - self.lapse_rate)
        rise = 1.0 - self.guess_rate - self.lapse_rate
        return self.quantile((probability - self.guess_rate) / rise)

    def quantile(self, share: si.Dimensionless) -> float:
        """The intensity at which the shape S (without guesses and lapses) equals `share`.

        Raises:
            InputError: a share not between 0 and 1.
        """
        si.require("share", share, above=0.0, below=1.0)
        z = _standard_quantile(_CODES[self.shape], share)
        if self.axis == "log":
            return float(self.threshold * np.exp(self.width * z))
        return float(self.threshold + self.width * z)


def _standard_quantile(code: int, share: float) -> float:
    """z = (x − m)/width at which S = share."""
    if code == kernel.LOGISTIC:
        return math.log(share / (1 - share)) / kernel.K_LOGISTIC
    if code == kernel.GAUSSIAN:
        return float(ndtri(share)) / kernel.K_GAUSSIAN
    return (math.log(-math.log1p(-share)) - kernel.LN_LN_2) / kernel.K_GUMBEL


LARGEST_RATE: si.Dimensionless = 0.5
"""Lapse rates, and guess rates that are fitted, are held to lie below this."""


@dataclass(frozen=True, slots=True)
class PsychometricPrior:
    """Independent priors of threshold, width, lapse rate and, where it is fitted, guess rate.

    Args:
        threshold: its lowest and highest value, in the unit of the stimulus; flat between them
            on the axis of the function.
        width: its least and largest value, above 0, in the unit of the axis; ln width is flat
            between them, so that no scale is preferred.
        lapse_rate: exponents (a, b) of its Beta prior, both at least 1, cut at 0.5. The default,
            (1, 10), is that of Schütt et al. 2016: mean 0.09.
        guess_rate: exponents of the Beta prior of a guess rate that is fitted, cut at 0.5.

    Raises:
        InputError: bounds in the wrong order or outside their range.
    """

    threshold: tuple[float, float]
    width: tuple[float, float]
    lapse_rate: tuple[float, float] = (1.0, 10.0)
    guess_rate: tuple[float, float] = (1.0, 10.0)

    def __post_init__(self) -> None:
        for name in ("threshold", "width"):
            low, high = getattr(self, name)
            si.require(name, low, above=0.0 if name == "width" else None)
            si.require(name, high)
            if not low < high:
                raise InputError(
                    f"{name} = ({low:g}, {high:g}) is no range; write the lower value first",
                    quantity=name,
                )
        for name in ("lapse_rate", "guess_rate"):
            si.require(f"{name} (an exponent of its Beta prior)", getattr(self, name), at_least=1.0)

    @classmethod
    def for_stimuli(cls, intensity: si.FloatArray, axis: Axis = "linear") -> PsychometricPrior:
        """A weak prior from the intensities used, of which there must be two or more.

        The threshold lies within their range or half of it beyond (on the axis), the width
        between half the smallest distance of two of them, but no less than 1 % of the range, and
        three times their range (the ranges of Schütt et al. 2016).

        Raises:
            InputError: fewer than two different intensities.
        """
        places = np.unique(on_axis(intensity, axis))
        if places.size < 2:
            raise InputError(
                f"{places.size} different intensities do not tell how far a threshold may lie; "
                "give a prior, or two or more intensities"
            )
        reach = float(places[-1] - places[0])
        low, high = float(places[0]) - 0.5 * reach, float(places[-1]) + 0.5 * reach
        least = max(0.5 * float(np.diff(places).min()), 0.01 * reach)
        ends = (float(np.exp(low)), float(np.exp(high))) if axis == "log" else (low, high)
        return cls(ends, (least, 3.0 * reach))

    def bounds(self, axis: Axis) -> tuple[si.FloatArray, si.FloatArray]:
        """Lowest and highest θ (threshold on the axis, ln width, lapse rate, guess rate)."""
        ends = on_axis(np.array(self.threshold), axis)
        low, high = np.log(np.array(self.width))
        return (
            np.array([ends[0], low, 0.0, 0.0]),
            np.array([ends[1], high, LARGEST_RATE, LARGEST_RATE - 0.01]),
        )

    def quantile(self, parameter: int, share: si.DimensionlessArray, axis: Axis) -> si.FloatArray:
        """θ of a parameter (0 to 3) not exceeded with a prior probability `share`, its shape."""
        if parameter < 2:
            low, high = self.bounds(axis)
            return np.asarray(low[parameter] + share * (high[parameter] - low[parameter]))
        a, b = self.lapse_rate if parameter == 2 else self.guess_rate
        return np.asarray(betaincinv(a, b, share * betainc(a, b, LARGEST_RATE)))

    def density(self, parameter: int, theta: si.FloatArray, axis: Axis) -> si.FloatArray:
        """Prior probability per unit of θ of a parameter (0 to 3), the shape of `theta`."""
        if parameter < 2:
            low, high = self.bounds(axis)
            return np.full(theta.shape, 1.0 / (high[parameter] - low[parameter]))
        a, b = self.lapse_rate if parameter == 2 else self.guess_rate
        scale = np.exp(betaln(a, b)) * betainc(a, b, LARGEST_RATE)
        return np.asarray(theta ** (a - 1.0) * (1.0 - theta) ** (b - 1.0) / scale)
