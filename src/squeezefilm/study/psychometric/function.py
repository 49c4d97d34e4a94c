"""Psychometric functions: the probability of an answer against the intensity of a stimulus.

ψ(x) = γ + (1 − γ − λ) S(x), with the guess rate γ, the lapse rate λ and a shape S that rises
from 0 to 1 (Schütt, Harmeling, Macke & Wichmann 2016, 10.1016/j.visres.2016.02.002). All shapes
are given by the same two numbers, so that they can be compared: the threshold, where S = ½, and
the width, from S = 5 % to S = 95 %.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal, get_args

import numpy as np
from scipy.special import ndtri

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.from_text import reads_text
from squeezefilm.study.psychometric import kernel

Shape = Literal[
    "logistic", "gaussian", "gumbel", "reversed-gumbel", "hyperbolic-secant", "weibull", "quick"
]
Axis = Literal["linear", "log"]

SHAPES: tuple[Shape, ...] = get_args(Shape)
AXES: tuple[Axis, ...] = get_args(Axis)

_CODES: dict[Shape, int] = {
    "logistic": kernel.LOGISTIC,
    "gaussian": kernel.GAUSSIAN,
    "gumbel": kernel.GUMBEL,
    "reversed-gumbel": kernel.REVERSED_GUMBEL,
    "hyperbolic-secant": kernel.HYPERBOLIC_SECANT,
    # With the threshold at ½ Weibull's and Quick's functions are the same, Gumbel's of ln x.
    "weibull": kernel.GUMBEL,
    "quick": kernel.GUMBEL,
}


def shape_code(shape: Shape, axis: Axis) -> int:
    """The kernel's number of a shape.

    Raises:
        InputError: an unknown shape or axis, or Weibull's or Quick's function, which are
            defined on a logarithmic axis, on a linear one.
    """
    si.require_one_of("shape", shape, SHAPES)
    si.require_one_of("axis", axis, AXES)
    if shape in ("weibull", "quick") and axis != "log":
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
        shape: of S: "logistic", "gaussian", "gumbel", "reversed-gumbel", "hyperbolic-secant",
            and on a logarithmic axis "weibull" or "quick" (the same function, 1 − 2^−(x/m)^β
            with β = 4.0674/width).
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

    def slope(self, intensity: float) -> float:
        """dψ/dx at an intensity, per unit of the stimulus."""
        x = float(on_axis(intensity, self.axis))
        z = (x - float(on_axis(self.threshold, self.axis))) / self.width
        rise = 1.0 - self.guess_rate - self.lapse_rate
        along = rise * kernel.sigmoid(_CODES[self.shape], z)[2] / self.width
        return float(along / intensity if self.axis == "log" else along)


def _standard_quantile(code: int, share: float) -> float:
    """z = (x − m)/width at which S = share."""
    tail = 0.05
    if code == kernel.LOGISTIC:
        return float(np.log(share / (1 - share)) / (2 * np.log(1 / tail - 1)))
    if code == kernel.GAUSSIAN:
        return float(ndtri(share) / (2 * ndtri(1 - tail)))
    reach = np.log(-np.log(tail)) - np.log(-np.log(1 - tail))
    if code == kernel.GUMBEL:
        return float((np.log(-np.log1p(-share)) - np.log(np.log(2))) / reach)
    if code == kernel.REVERSED_GUMBEL:
        return float(-(np.log(-np.log(share)) - np.log(np.log(2))) / reach)
    return float(np.log(np.tan(np.pi / 2 * share)) / (2 * np.log(np.tan(np.pi / 2 * (1 - tail)))))
