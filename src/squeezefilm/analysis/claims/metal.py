"""Metal on metal without a film: one number fitted, two predictions put on record.

Dong and Dapino (JoVE 52931, 10.3791/52931): vibration at 22 kHz lowers sliding friction by 62 % at
20.3 mm/s, under 1 to 4 MPa. The model is that of a display without its gas: asperities alone carry
the load, ⟨p_a⟩ = p, and what touches is elastic in shear until it slips within the period
(`contact.sharing.shear`).

With exponential asperities friction then depends on two numbers only: the amplitude over the decay
length of the asperities, and κ U/(µ ω λ). The pressure drops out. What is fitted is κ/µ, the
tangential over the normal stiffness and the friction coefficient: the stiffness of contact and
tribometer in shear is what is known least, and it enters with the speed in one product, so that
the fit takes friction coefficient and frequency out of the prediction as well. What is left is
the amplitude over the decay length, of which a spread is assumed; and whether the stiffness is
constant or follows the load, which gives two predictions.

What is predicted stood here before the value published for 87 mm/s was read.
"""

from __future__ import annotations

import functools
import itertools
import math
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.analysis.claims.values import ClaimValue, value_of
from squeezefilm.contact.asperities import AsperityLaw
from squeezefilm.contact.sharing.balance import LoadSharing
from squeezefilm.contact.sharing.shear import AsperityShear, sheared_friction

FREQUENCY: si.Hertz = 22e3
PRESSURE: si.Pascal = 2e6
"""Between the 1 and 4 MPa stated; friction does not depend on it."""

FITTED_SPEED: si.MetrePerSecond = 20.3e-3
FITTED_FRICTION: si.Dimensionless = 0.38
READING: si.Dimensionless = 0.005
"""Half of the last digit of "62 %"."""

PREDICTED_SPEEDS: tuple[si.MetrePerSecond, si.MetrePerSecond] = (40.6e-3, 87e-3)

AMPLITUDES: tuple[si.Metre, si.Metre] = (0.5e-6, 5e-6)
"""Zero-to-peak, across the contact; assumed, spread evenly in the logarithm."""

DECAY_LENGTHS: tuple[si.Metre, si.Metre] = (0.1e-6, 1e-6)
"""Of the asperities of ground metal; assumed, spread evenly in the logarithm."""

LEVEL: si.Dimensionless = 0.9
Stiffness = Literal["constant", "following"]

_DRAWS = 8
_LEAST_RATIO, _MOST_RATIO = 1e-6, 1e4


@dataclass(frozen=True, eq=False)
class MetalPrediction:
    """µ′/µ at `speeds`, with one kind of stiffness; medians and the ends of the interval (1).

    `stiffness_over_friction` is κ/µ as fitted (1): median and the ends of its interval. `refused`
    is the share of draws that the fitted number cannot be reached with: their asperities never part
    enough.
    """

    stiffness: Stiffness
    speeds: tuple[si.MetrePerSecond, ...]
    relative_friction: tuple[si.Dimensionless, ...]
    low: tuple[si.Dimensionless, ...]
    high: tuple[si.Dimensionless, ...]
    fitted_friction: si.Dimensionless
    stiffness_over_friction: tuple[si.Dimensionless, si.Dimensionless, si.Dimensionless]
    draws: int
    refused: si.Dimensionless


def dry_friction(
    amplitude: Annotated[si.Metre, si.AtLeast(0.0)],
    decay_length: Annotated[si.Metre, si.Above(0.0)],
    speed: Annotated[si.MetrePerSecond, si.Above(0.0)],
    stiffness_over_friction: Annotated[si.Dimensionless, si.Above(0.0)],
    stiffness: Stiffness,
) -> si.Dimensionless:
    """µ′/µ (1) of exponential asperities that alone carry the load, at `FREQUENCY`.

    `amplitude` (m) is that of the gap, `stiffness_over_friction` κ/µ (1). Their pressure over a
    period is p in the mean, so that the mean gap is λ ln I0(a/λ) wider than at rest.
    """
    from scipy.special import i0e

    # Heights are counted from the gap at rest, of which only differences matter.
    law = AsperityLaw(PRESSURE, decay_length, decay_length)
    wider = decay_length * math.log(float(i0e(amplitude / decay_length))) + amplitude
    one = np.ones(())
    shared = LoadSharing(
        amplitude=amplitude * one,
        plateau_pressure=PRESSURE * one,
        mean_gap=(decay_length + wider) * one,
        gas_pressure=0.0 * one,
        asperity_pressure=PRESSURE * one,
        gap_amplitude=amplitude * one,
        skin_amplitude=0.0 * one,
        residual=0.0 * one,
        film_error=0.0,
        steps=0.0 * one,
        asperities=law,
        model="asperities alone, no gas",
    )
    shear = AsperityShear(speed, 1.0, stiffness, stiffness_over_friction)
    return float(sheared_friction(shared, shear, FREQUENCY))


def fitted_ratio(
    amplitude: si.Metre, decay_length: si.Metre, wanted: si.Dimensionless, stiffness: Stiffness
) -> si.Dimensionless | None:
    """κ/µ (1) at which µ′/µ is `wanted` at `FITTED_SPEED`; None where none reaches it."""
    from scipy.optimize import brentq

    def excess(logarithm: float) -> float:
        ratio = math.exp(logarithm)
        return dry_friction(amplitude, decay_length, FITTED_SPEED, ratio, stiffness) - wanted

    ends = math.log(_LEAST_RATIO), math.log(_MOST_RATIO)
    if excess(ends[0]) > 0.0 or excess(ends[1]) < 0.0:
        return None
    return math.exp(float(brentq(excess, *ends, xtol=1e-9)))


def metal_prediction(stiffness: Stiffness) -> MetalPrediction:
    """The fit on the one published number, and what follows at the other speeds.

    Every combination of eight amplitudes, eight decay lengths and three readings of the number,
    the middles of equal parts of each spread, is fitted by itself and equally likely.
    """
    middles = (np.arange(_DRAWS) + 0.5) / _DRAWS
    amplitudes, lengths = (
        low * (high / low) ** middles for low, high in (AMPLITUDES, DECAY_LENGTHS)
    )
    readings = FITTED_FRICTION + READING * np.array([-2 / 3, 0.0, 2 / 3])
    ratios, rows, fitted = [], [], []
    for a, decay, wanted in itertools.product(
        amplitudes.tolist(), lengths.tolist(), readings.tolist()
    ):
        ratio = fitted_ratio(a, decay, wanted, stiffness)
        if ratio is None:
            continue
        at = [
            dry_friction(a, decay, speed, ratio, stiffness)
            for speed in (FITTED_SPEED, *PREDICTED_SPEEDS)
        ]
        ratios.append(ratio)
        fitted.append(at[0])
        rows.append(at[1:])
    ends = 0.5, 0.5 - LEVEL / 2, 0.5 + LEVEL / 2
    median, low, high = (tuple(np.quantile(rows, end, axis=0).tolist()) for end in ends)
    ratio_range = tuple(float(np.quantile(ratios, end)) for end in ends)
    draws = _DRAWS**2 * readings.size
    return MetalPrediction(
        stiffness=stiffness,
        speeds=PREDICTED_SPEEDS,
        relative_friction=median,
        low=low,
        high=high,
        fitted_friction=float(np.median(fitted)),
        stiffness_over_friction=ratio_range,  # type: ignore[arg-type]
        draws=draws,
        refused=1 - len(rows) / draws,
    )


@functools.cache
def _both() -> tuple[MetalPrediction, MetalPrediction]:
    return metal_prediction("constant"), metal_prediction("following")


@value_of("metal-fitted")
def _() -> ClaimValue:
    both = _both()
    ratios = "; ".join(
        f"{one.stiffness}: κ/µ {one.stiffness_over_friction[0]:.2g} "
        f"({one.stiffness_over_friction[1]:.2g} to {one.stiffness_over_friction[2]:.2g}), "
        f"{si.percent(one.refused)} of {one.draws} draws cannot reach it"
        for one in both
    )
    return ClaimValue(tuple(one.fitted_friction for one in both), note=ratios)


@value_of("metal-direction")
def _() -> ClaimValue:
    return ClaimValue(
        tuple(one.relative_friction[-1] - one.relative_friction[0] for one in _both())
    )


@value_of("metal-prediction")
def _() -> ClaimValue:
    return ClaimValue(tuple(prediction.relative_friction[0] for prediction in _both()))


@value_of("metal-compared")
def _() -> ClaimValue:
    both = _both()
    said = "; ".join(
        f"stiffness {'that follows the load' if one.stiffness == 'following' else 'constant'}: "
        + ", ".join(
            f"{1e3 * speed:.1f} mm/s {middle:.2f} ({low:.2f} to {high:.2f})"
            for speed, middle, low, high in zip(
                one.speeds, one.relative_friction, one.low, one.high, strict=True
            )
        )
        for one in both
    )
    return ClaimValue(
        tuple(prediction.relative_friction[-1] for prediction in both),
        note=f"with {si.percent(LEVEL)} intervals, {said}; the intervals hold what the last digit "
        "of the fitted number and the ratio of amplitude to decay length leave open, and no other "
        "doubt",
    )
