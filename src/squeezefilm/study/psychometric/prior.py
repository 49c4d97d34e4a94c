"""What is held possible of a psychometric function before the data: priors and their grids."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import betainc, betaincinv, betaln

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.study.psychometric.function import Axis, on_axis

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
