"""Fit the levitation model to the published friction of people, and print what follows from it.

    python tools/levitation_fit.py

prints the two numbers of each person (decay length and friction at rest), those of the seventy
strokes, the defaults of `physics.contact.finger.fingertip` that
follow; how a person who was left out is predicted from the others, beside the mean and spread of
the others without physics; how the log-normal population predicts a stroke beside a resample of the
strokes; and what partial levitation makes of the same people, of skins that move by their own
phase, and of a vacuum, with the roughness of skin as the literature has it and fitted.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
from typing import NamedTuple

import numpy as np
from scipy.stats import gaussian_kde, multivariate_normal

from squeezefilm.core import presets
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError, OutOfRangeError
from squeezefilm.measure.fits.friction.friction_scores import (
    PersonFit,
    fitted_person,
    nearest_scale,
    rest_friction,
    scored,
    with_decay_length,
)
from squeezefilm.measure.recordings.kinds import FrictionCurve, FrictionDecays
from squeezefilm.measure.recordings.read import check_folder
from squeezefilm.physics.chain.friction import FrictionLaw, friction_law
from squeezefilm.physics.contact.finger.fingertip import Finger, Skin
from squeezefilm.physics.contact.rough_contact import RoughContact
from squeezefilm.physics.contact.sharing.levitation import levitation_friction, levitation_scale
from squeezefilm.physics.display import load_display

FREE_STROKES_SPEED = 0.1
REFERENCE_SPEED = Finger.decay_speed
FREE_STROKES_FORCE = 0.5
_LENGTHS = np.geomspace(0.3e-6, 300e-6, 140)


def law_of(display: str, frequency: float, force: float, speed: float) -> FrictionLaw:
    """The law of a recording's display, whose decay length is that at its own speed."""
    described = load_display(display)
    half = described.actuator.wavelength / 2  # type: ignore[union-attr]
    finger = dataclasses.replace(described.finger, decay_speed_exponent=0.0)
    described = dataclasses.replace(described, finger=finger)
    return friction_law(described, half, frequency, normal_force=force, speed=speed)


def length_of(law: FrictionLaw, amplitude: float, friction: float = 0.5) -> float:
    """The decay length (m) with which friction has fallen to a share at an amplitude (m)."""
    lengths = [with_decay_length(law, length).at(amplitude) for length in _LENGTHS]
    return float(np.exp(np.interp(friction, lengths, np.log(_LENGTHS))))


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
        model = np.array([with_decay_length(law, float(one)).curve(amplitude) for one in draws])
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
    """What is fitted: each person's numbers; the mean (geometric, m) and the logarithms' spread of
    strokes, their correlation with the friction at rest, and the logarithms themselves (strokes,
    2), their law and the amplitudes at half of the friction; the exponent of the speed, and the
    length (m) at the reference speed."""

    curves: list[FrictionCurve]
    laws: list[FrictionLaw]
    people: list[PersonFit]
    slow: float
    strokes: float
    spread: float
    ends: tuple[float, float]
    correlation: float
    logarithms: si.FloatArray
    free: FrictionLaw
    halves: si.MetreArray
    exponent: float
    at_reference: float


def fits() -> Fits:
    """Fit the published friction that comes with the package."""
    recordings = [check.recording for check in check_folder(presets.friction_folder()).checks]
    curves = [one for one in recordings if isinstance(one, FrictionCurve) and one.speed is not None]
    laws = [law_of(one.display, one.frequency, float(one.normal_force), 0.01) for one in curves]
    people = [fitted_person(curve, law) for curve, law in zip(curves, laws, strict=True)]
    slow = math.exp(float(np.mean([math.log(person.decay_length) for person in people])))
    strokes = next(one for one in recordings if isinstance(one, FrictionDecays))
    free = law_of(strokes.display, strokes.frequency, FREE_STROKES_FORCE, FREE_STROKES_SPEED)
    halves = strokes.decay_amplitude * math.sqrt(2 * math.log(2))
    logs = np.log([length_of(free, float(half)) for half in halves])
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
        np.column_stack([logs, np.log(strokes.friction_coefficient)]),
        free,
        halves,
        exponent,
        slow * (REFERENCE_SPEED / 0.01) ** exponent,
    )


class RidgeFits(NamedTuple):
    """With films solved over single ridges: the lengths (m) of each person and what is left, the
    length of the mean of people and of strokes, the logarithms' spread of strokes; the exponent of
    the speed, and the length (m) at the reference speed."""

    people: list[tuple[float, float]]
    slow: float
    strokes: float
    spread: float
    exponent: float
    at_reference: float


def ridge_fits(found: Fits) -> RidgeFits:
    """Fit the same data by `levitation-ridges`."""
    people = []
    for curve, law in zip(found.curves, found.laws, strict=True):
        person = fitted_person(curve, law.by("levitation-ridges"))
        finger = with_decay_length(law, person.decay_length).finger
        people.append((finger.ridge_length_at(0.01), person.left))
    free = found.free.by("levitation-ridges")
    logs = []
    for half in np.quantile(found.halves, (np.arange(15) + 0.5) / 15):
        finger = with_decay_length(free, length_of(free, float(half))).finger
        logs.append(math.log(finger.ridge_length_at(FREE_STROKES_SPEED)))
    slow = math.exp(float(np.mean([math.log(length) for length, _ in people])))
    fast = math.exp(float(np.mean(logs)))
    exponent = math.log(fast / slow) / math.log(FREE_STROKES_SPEED / 0.01)
    at_reference = slow * (REFERENCE_SPEED / 0.01) ** exponent
    return RidgeFits(people, slow, fast, float(np.std(logs)), exponent, at_reference)


def population_scores(logarithms: si.FloatArray) -> si.FloatArray:
    """Log densities of each stroke (strokes, 2) by the log-normal population of all others, and by
    a resample of the others, smoothed as Scott has it."""
    scores = []
    for k, stroke in enumerate(logarithms):
        others = np.delete(logarithms, k, axis=0)
        population = multivariate_normal(others.mean(axis=0), np.cov(others.T))
        resample = gaussian_kde(others.T)
        scores.append((float(population.logpdf(stroke)), float(resample.logpdf(stroke)[0])))
    return np.array(scores)


def rounded(curve: FrictionCurve, law: FrictionLaw) -> tuple[float, float]:
    """What the closed form leaves of a person, over the friction at rest, and the length (m), under
    a round pad whose pressure falls toward its edge as Hertz has it, over the wave."""
    across = (np.arange(40) + 0.5) / 40
    x, y = (axis.ravel() for axis in np.meshgrid(across, across))
    x, y = x[x**2 + y**2 < 1], y[x**2 + y**2 < 1]
    share = np.sqrt(1 - x**2 - y**2)
    share /= share.mean()
    radius = law.contact_side / math.sqrt(math.pi)
    met = np.abs(np.cos(np.pi * radius * x / law.half_wavelength))
    even = levitation_scale(1.0, law.contact_pressure, law.gas.ambient_pressure)

    def curve_of(length: float) -> si.DimensionlessArray:
        over = met / (length * even * np.sqrt(share))
        each = levitation_friction(np.outer(curve.vibration_amplitude, over))
        return np.asarray(each @ share / share.size)

    known = [curve_of(length) for length in _LENGTHS]
    length = nearest_scale(curve_of, _LENGTHS, known, curve.friction)
    return _left(curve, curve_of(length)), length


class Balances(NamedTuple):
    """Partial levitation beside the same data. `as_read` is what it leaves of each person with the
    literature's roughness and modulus, over the friction at rest; `fitted` with the roughness (m)
    that is nearest to each, and that roughness; `skins` the least and the greatest µ′/µ, at 2.1 µm
    and 0.5 N, over skins that move by their own phase; `vacuum` the least and the greatest share
    of the effect that they leave at 0.017 atm."""

    as_read: list[float]
    fitted: list[tuple[float, float]]
    skins: tuple[float, float]
    vacuum: tuple[float, float]


def balances(found: Fits) -> Balances:
    """Ask partial levitation of persons, artificial skins and a vacuum."""
    laws = [law.by("partial-levitation") for law in found.laws]
    fitted = []
    for curve, law in zip(found.curves, laws, strict=True):
        tried = [
            (_left_by(curve, _rough(law, r, 3.2e6)), r) for r in np.geomspace(0.2e-6, 8e-6, 60)
        ]
        fitted.append(min(tried))
    middle = float(np.median([roughness for _, roughness in fitted]))
    skins, vacuum = [], []
    for force, frequency in ((0.5, 32.112e3), (0.35, 29.075e3)):
        law = law_of(found.curves[0].display, frequency, force, 0.01).by("partial-levitation")
        law = dataclasses.replace(_rough(law, middle, 3.2e6), slip="fukui-kaneko")
        thin = dataclasses.replace(law, gas=law.gas.at_pressure(0.017 * 101325))
        inertia = Skin().mass_per_area * (2 * math.pi * frequency) ** 2
        for stiffness, damping in itertools.product((0.0, 1.1, 1.5, 2.0, 4.0), (1e5, 3e5, 1e6)):
            skin = Skin(stiffness_per_area=stiffness * inertia, damping_per_area=damping)
            if force == 0.5:
                skins.append(_yielding(law, 2.1e-6, skin))
            else:
                inside = _yielding(thin, 1.6e-6, skin)
                vacuum.append((1 - inside) / (1 - _yielding(law, 1.6e-6, skin)))
    as_read = [
        _left_by(curve, _rough(law, 5e-6, 20e6))
        for curve, law in zip(found.curves, laws, strict=True)
    ]
    return Balances(
        as_read,
        fitted,
        (float(np.nanmin(skins)), float(np.nanmax(skins))),
        (float(np.nanmin(vacuum)), float(np.nanmax(vacuum))),
    )


def _rough(law: FrictionLaw, roughness: float, modulus: float) -> FrictionLaw:
    """The law of a skin of a roughness (m) and modulus (Pa) on the law's own face."""
    contact = RoughContact(roughness=roughness, modulus=modulus)
    finger = dataclasses.replace(
        law.finger, asperities=contact, asperity_roughness=law.surface.roughness
    )
    return dataclasses.replace(law, finger=finger)


def _left(curve: FrictionCurve, relative: si.DimensionlessArray) -> float:
    """The root mean square that a relative friction at a curve's amplitudes leaves of it, over its
    friction at rest, which is fitted."""
    difference = scored("tried", relative, curve).difference
    return math.inf if difference is None else difference


def _left_by(curve: FrictionCurve, law: FrictionLaw) -> float:
    """The same of a law; infinite where it ends."""
    try:
        return _left(curve, law.curve(curve.vibration_amplitude))
    except OutOfRangeError:
        return math.inf


def _yielding(law: FrictionLaw, amplitude: float, skin: Skin) -> float:
    """µ′/µ at an amplitude (m) of a skin that moves by its own phase; NaN where the law ends."""
    law = dataclasses.replace(law, finger=dataclasses.replace(law.finger, skin=skin))
    try:
        return float(law.sharing(amplitude, yielding=True).relative_friction[0])
    except (OutOfRangeError, ConvergenceError):
        return math.nan


def main() -> None:
    """Fit and print."""
    found = fits()
    print("person                      decay length  friction at rest  left")
    for curve, person in zip(found.curves, found.people, strict=True):
        print(
            f"{curve.told.name:26}  {1e6 * person.decay_length:6.2f} um "
            f"+-{100 * person.relative_error:.0f} %  {person.friction_at_rest:.3f} N    "
            f"{person.left:.3f}"
        )
    print(
        f"strokes: {1e6 * found.strokes:.2f} um, standard deviation of the logarithm "
        f"{found.spread:.3f}, 5 to 95 % {found.ends[0]:.2f} to {found.ends[1]:.2f} of it; "
        f"correlation with the friction at rest {found.correlation:.2f}"
    )
    print(
        f"people at 10 mm/s: {1e6 * found.slow:.2f} um; exponent of the speed "
        f"{found.exponent:.3f}; at {1e3 * REFERENCE_SPEED:.0f} mm/s "
        f"{1e6 * found.at_reference:.2f} um"
    )
    lengths = [person.decay_length for person in found.people]
    scores = np.array(left_out(found.curves, found.laws, lengths, found.spread))
    difference = scores[:, 0] - scores[:, 1]
    print("left out: log density of a point, by the model and by the others' mean and spread")
    for curve, (by_model, by_others) in zip(found.curves, scores, strict=True):
        print(f"{curve.told.name:26}  {by_model:6.2f}  {by_others:6.2f}")
    error = np.std(difference, ddof=1) / math.sqrt(difference.size)
    print(f"paired difference {difference.mean():.2f} +- {error:.2f}")
    apart = population_scores(found.logarithms)
    error = np.std(apart[:, 0] - apart[:, 1], ddof=1) / math.sqrt(len(apart))
    rest = np.std(found.logarithms[:, 1], ddof=1)
    print(
        f"strokes: standard deviation of ln of the friction at rest {rest:.3f}; log "
        f"density of one left out {apart[:, 0].mean():.3f} by the log-normal population of the "
        f"others, {apart[:, 1].mean():.3f} by a resample of them, difference "
        f"{(apart[:, 0] - apart[:, 1]).mean():.3f} +- {error:.3f}"
    )
    for curve, law in zip(found.curves, found.laws, strict=True):
        left, length = rounded(curve, law)
        print(f"{curve.told.name:26}  a rounded pad {1e6 * length:6.2f} um  left {left:.3f}")
    ridges = ridge_fits(found)
    print("films solved over single ridges:")
    for curve, (length, left) in zip(found.curves, ridges.people, strict=True):
        print(f"{curve.told.name:26}  {1e6 * length:6.2f} um  left {left:.3f}")
    print(
        f"people at 10 mm/s {1e6 * ridges.slow:.2f} um, strokes {1e6 * ridges.strokes:.2f} um, at "
        f"{1e3 * REFERENCE_SPEED:.0f} mm/s {1e6 * ridges.at_reference:.2f} um; over the closed "
        f"form's the exponent of the speed {ridges.exponent / found.exponent:.2f}, the spread of "
        f"the strokes' logarithms {ridges.spread / found.spread:.2f}"
    )
    skins = law_of(found.curves[0].display, 32.112e3, 0.5, 0.01)
    for name, friction in (("lossy", 0.084), ("elastic", 0.81)):
        length = length_of(skins, 2.1e-6, friction)
        over = with_decay_length(skins, length_of(skins.by("levitation-ridges"), 2.1e-6, friction))
        print(
            f"{name} artificial skin, mu'/mu {friction} at 2.1 um, 0.5 N: {1e6 * length:.2f} um, "
            f"over single ridges {1e6 * over.finger.ridge_length_at(0.01):.2f} um"
        )
    tried = balances(found)
    print("partial levitation, what touches slips:")
    for curve, as_read, (left, roughness) in zip(
        found.curves, tried.as_read, tried.fitted, strict=True
    ):
        print(
            f"{curve.told.name:26}  5 um and 20 MPa of the literature left {as_read:.3f}; fitted "
            f"{1e6 * roughness:.2f} um left {left:.3f}"
        )
    print(
        f"over skins that move by their own phase mu'/mu {tried.skins[0]:.2f} to "
        f"{tried.skins[1]:.2f} at 2.1 um (measured 0.084 and 0.81), and {tried.vacuum[0]:.2f} to "
        f"{tried.vacuum[1]:.2f} of the effect at 0.017 atm (measured 0.60 to 0.82)"
    )


if __name__ == "__main__":
    main()
