"""Fit the levitation model to the published friction of people, and print what follows from it.

    python tools/levitation_fit.py

prints the two numbers of each person (decay length and friction at rest), those of the seventy
strokes, the defaults of `contact.finger.fingertip` that follow, and how a person who was left out
is predicted from the others, beside the mean and spread of the others without physics.
"""

from __future__ import annotations

import dataclasses
import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar

from squeezefilm import presets
from squeezefilm import quantities as si
from squeezefilm.chain.friction import FrictionLaw, friction_law
from squeezefilm.contact.finger.fingertip import DECAY_SPEED
from squeezefilm.display import load_display
from squeezefilm.measure.fits.friction.friction_scores import rest_friction
from squeezefilm.measure.recordings.kinds import FrictionCurve, FrictionDecays
from squeezefilm.measure.recordings.read import check_folder

FREE_STROKES_SPEED = 0.1
FREE_STROKES_FORCE = 0.5
_LENGTHS = np.geomspace(0.3e-6, 100e-6, 120)


def law_of(display: str, frequency: float, force: float, speed: float) -> FrictionLaw:
    """The law of a recording's display, whose decay length is that at its own speed."""
    described = load_display(display)
    half = described.actuator.wavelength / 2  # type: ignore[union-attr]
    finger = dataclasses.replace(described.finger, decay_speed_exponent=0.0)
    described = dataclasses.replace(described, finger=finger)
    return friction_law(described, half, frequency, normal_force=force, speed=speed)


def with_length(law: FrictionLaw, length: float) -> FrictionLaw:
    """The law of another decay length (m)."""
    finger = dataclasses.replace(law.finger, contact_decay_length=length)
    return dataclasses.replace(law, finger=finger)


def fitted(curve: FrictionCurve, law: FrictionLaw) -> tuple[float, float, float]:
    """Decay length (m) and friction at rest that are nearest to a curve, and the root mean square
    of what is left over the friction at rest."""

    def scaled(length: float) -> tuple[float, si.FloatArray]:
        shape = with_length(law, length).curve(curve.vibration_amplitude)
        rest = float(shape @ curve.friction / (shape @ shape))
        return rest, rest * shape

    def error(log_length: float) -> float:
        return float(np.sum((scaled(math.exp(log_length))[1] - curve.friction) ** 2))

    logs = np.log(_LENGTHS)
    near = int(np.argmin([error(log) for log in logs]))
    ends = logs[max(near - 1, 0)], logs[min(near + 1, logs.size - 1)]
    length = math.exp(minimize_scalar(error, bounds=ends, method="bounded").x)
    rest, model = scaled(length)
    left = math.sqrt(np.mean((model - curve.friction) ** 2)) / rest
    return length, rest, left


def half_friction_length(law: FrictionLaw, amplitude: float) -> float:
    """The decay length (m) with which friction has fallen to a half at an amplitude (m)."""
    lengths = [with_length(law, length).at(amplitude) for length in _LENGTHS]
    return float(np.exp(np.interp(0.5, lengths, np.log(_LENGTHS))))


def left_out(
    curves: list[FrictionCurve], laws: list[FrictionLaw], lengths: list[float], spread: float
) -> list[tuple[float, float]]:
    """Mean log density of a point of each curve by the model's population of the others, and by
    the mean and spread of the others at that amplitude."""
    scores = []
    for k, (curve, law) in enumerate(zip(curves, laws, strict=True)):
        amplitude = curve.vibration_amplitude
        relative = curve.friction / rest_friction(curve)
        others = [j for j in range(len(curves)) if j != k]
        middle = float(np.mean([math.log(lengths[j]) for j in others]))
        wide = spread * math.sqrt(1 + 1 / len(others))
        nodes, weights = np.polynomial.hermite.hermgauss(31)
        draws = np.exp(middle + wide * np.sqrt(2) * nodes)
        model = np.array([with_length(law, float(one)).curve(amplitude) for one in draws])
        # What a fitted person leaves, and the reading.
        error = 0.03
        density = weights / math.sqrt(math.pi) @ np.exp(-0.5 * ((relative - model) / error) ** 2)
        by_model = np.log(density / (error * math.sqrt(2 * math.pi)))
        beside = np.array(
            [
                np.interp(
                    amplitude,
                    curves[j].vibration_amplitude,
                    curves[j].friction / rest_friction(curves[j]),
                )
                for j in others
            ]
        )
        sd = np.hypot(np.std(beside, axis=0, ddof=1) * math.sqrt(1 + 1 / len(others)), error)
        by_others = -0.5 * ((relative - beside.mean(axis=0)) / sd) ** 2 - np.log(
            sd * math.sqrt(2 * math.pi)
        )
        scores.append((float(by_model.mean()), float(by_others.mean())))
    return scores


class Fits(NamedTuple):
    """What is fitted: of each person decay length (m), friction at rest (N) and what is left; the
    mean (geometric, m) and the logarithms' spread of strokes, their correlation with the friction
    at rest; the exponent of the speed, and the length (m) at the reference speed."""

    curves: list[FrictionCurve]
    laws: list[FrictionLaw]
    people: list[tuple[float, float, float]]
    slow: float
    strokes: float
    spread: float
    ends: tuple[float, float]
    correlation: float
    exponent: float
    at_reference: float


def fits() -> Fits:
    """Fit the published friction that comes with the package."""
    recordings = [check.recording for check in check_folder(presets.friction_folder()).checks]
    curves = [one for one in recordings if isinstance(one, FrictionCurve) and one.speed is not None]
    laws = [law_of(one.display, one.frequency, float(one.normal_force), 0.01) for one in curves]
    people = [fitted(curve, law) for curve, law in zip(curves, laws, strict=True)]
    slow = math.exp(float(np.mean([math.log(length) for length, _, _ in people])))
    strokes = next(one for one in recordings if isinstance(one, FrictionDecays))
    free = law_of(strokes.display, strokes.frequency, FREE_STROKES_FORCE, FREE_STROKES_SPEED)
    halves = strokes.decay_amplitude * math.sqrt(2 * math.log(2))
    logs = np.log([half_friction_length(free, float(half)) for half in halves])
    fast = math.exp(float(np.mean(logs)))
    exponent = math.log(fast / slow) / math.log(FREE_STROKES_SPEED / 0.01)
    low, high = np.exp(np.quantile(logs - logs.mean(), [0.05, 0.95]))
    return Fits(
        curves,
        laws,
        people,
        slow,
        fast,
        float(np.std(logs, ddof=1)),
        (float(low), float(high)),
        float(np.corrcoef(logs, np.log(strokes.friction_coefficient))[0, 1]),
        exponent,
        slow * (DECAY_SPEED / 0.01) ** exponent,
    )


def main() -> None:
    """Fit and print."""
    found = fits()
    print("person                      decay length  friction at rest  left")
    for curve, (length, rest, left) in zip(found.curves, found.people, strict=True):
        print(f"{curve.told.name:26}  {1e6 * length:9.2f} um  {rest:13.3f} N    {left:.3f}")
    print(
        f"strokes: {1e6 * found.strokes:.2f} um, standard deviation of the logarithm "
        f"{found.spread:.3f}, 5 to 95 % {found.ends[0]:.2f} to {found.ends[1]:.2f} of it; "
        f"correlation with the friction at rest {found.correlation:.2f}"
    )
    print(
        f"people at 10 mm/s: {1e6 * found.slow:.2f} um; exponent of the speed "
        f"{found.exponent:.3f}; at {1e3 * DECAY_SPEED:.0f} mm/s {1e6 * found.at_reference:.2f} um"
    )
    lengths = [length for length, _, _ in found.people]
    scores = np.array(left_out(found.curves, found.laws, lengths, found.spread))
    difference = scores[:, 0] - scores[:, 1]
    print("left out: log density of a point, by the model and by the others' mean and spread")
    for curve, (by_model, by_others) in zip(found.curves, scores, strict=True):
        print(f"{curve.told.name:26}  {by_model:6.2f}  {by_others:6.2f}")
    error = np.std(difference, ddof=1) / math.sqrt(difference.size)
    print(f"paired difference {difference.mean():.2f} +- {error:.2f}")


if __name__ == "__main__":
    main()
