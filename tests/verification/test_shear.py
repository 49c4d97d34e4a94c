"""Load sharing with shear against a separately written solution, and what must hold of both.

The other solution takes nothing compiled and no table: films solved one by one inside brentq, the
asperities' mean by quadrature, and the rate equation of the shear integrated by SciPy from event to
event (what sticks begins to slip, what slips sticks again) until the period repeats.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.interpolate import CubicHermiteSpline
from scipy.optimize import brentq

from squeezefilm.contact.asperities import AsperityLaw
from squeezefilm.contact.rough_contact import LEAST_GAP, ContactLaw, RoughContact
from squeezefilm.contact.sharing.balance import share_load
from squeezefilm.contact.sharing.gas_table import FilmTable
from squeezefilm.contact.sharing.shear import AsperityShear, sheared_friction
from squeezefilm.film.periodic.film import solve_uniform
from squeezefilm.materials import Gas

GAS = Gas(1.85e-5, 1e5, 1.2, 67e-9)
FREQUENCY, WIDTH = 40.5e3, 250e-6
OMEGA, MU, KAPPA = 2 * math.pi * FREQUENCY, 0.9, 2 / 3
LAWS: dict[str, ContactLaw] = {"exponential": AsperityLaw(), "rough": RoughContact()}


@pytest.fixture(scope="module")
def table() -> FilmTable:
    return FilmTable(FREQUENCY, WIDTH, GAS, tolerance=5e-6)


class Law(NamedTuple):
    """Pressure, −dp/dh, what friction can hold over µ, and −d/dh of it, at a gap."""

    pressure: Callable[[float], float]
    stiffness: Callable[[float], float]
    limit: Callable[[float], float]
    fall: Callable[[float], float]


def plain(law: ContactLaw) -> Law:
    if isinstance(law, AsperityLaw):
        start, gap, decay = law.reference_pressure, law.reference_gap, law.decay_length
        p = lambda h: start * math.exp(-(h - gap) / decay)  # noqa: E731
        k = lambda h: p(h) / decay  # noqa: E731
        return Law(p, k, p, k)
    known = law.spectrum
    at = (LEAST_GAP + 0.025 * np.arange(known.logarithm.size)) * law.roughness
    spline = CubicHermiteSpline(at, known.logarithm, known.steepness / law.roughness)
    slope, scale = spline.derivative(), math.sqrt(2) / (law.modulus * law.rms_slope)
    p = lambda h: law.pressure_scale * math.exp(float(spline(h)))  # noqa: E731
    k = lambda h: -p(h) * float(slope(h))  # noqa: E731
    held = lambda h: math.sqrt(math.pi) / 2 / scale * math.erf(scale * p(h))  # noqa: E731
    return Law(p, k, held, lambda h: k(h) * math.exp(-((scale * p(h)) ** 2)))


def balanced_gap(law: Law, a: float, load: float) -> float:
    length = WIDTH * math.sqrt(24 * math.pi * GAS.viscosity * FREQUENCY / GAS.ambient_pressure)

    def excess(u: float) -> float:
        film = solve_uniform(
            (length / u) ** 2, a / u, knudsen_number=GAS.mean_free_path / u, tolerance=1e-6
        )
        solid = quad(lambda t: law.pressure(u - a * math.cos(t)), 0, math.pi, epsrel=1e-10)[0]
        return float(GAS.ambient_pressure * film.over_pressure + solid / math.pi - load)

    return float(brentq(excess, a / 0.98 + 0.1e-6, 14e-6, xtol=1e-14, rtol=1e-9))


class Slider:
    """The shear over µ along a period of phases from −π (the largest gap) to π."""

    def __init__(self, law: Law, u: float, a: float, advance: float, constant: float | None):
        self.law, self.u, self.a, self.advance, self.constant = law, u, a, advance, constant

    def gap(self, t: float) -> float:
        return self.u - self.a * math.cos(t)

    def limit(self, t: float) -> float:
        return self.law.limit(self.gap(t))

    def rise(self, t: float) -> float:
        return -self.law.fall(self.gap(t)) * self.a * math.sin(t)

    def rate(self, t: float, q: float) -> float:
        """dq/dT of what sticks."""
        if self.constant is not None:
            return self.advance * self.constant
        parts = q * self.rise(t) / self.limit(t) if t > 0 else 0.0
        return self.advance * self.law.stiffness(self.gap(t)) + parts

    def half(self, ends: tuple[float, float], q: float, sticks: bool) -> tuple[float, float, bool]:
        """q at the end of a half period, its integral, and whether it sticks there."""
        scale = self.limit(0.0)
        t, total = ends[0], 0.0
        while t < ends[1]:
            if sticks:
                stop: Any = lambda t, y: y[0] - self.limit(t)  # noqa: E731
                right: Any = lambda t, y: [self.rate(t, y[0]), y[0]]  # noqa: E731
                stop.direction = 1.0
            else:
                stop = lambda t, y: self.rise(t) - self.rate(t, self.limit(t))  # noqa: E731
                right = lambda t, y: [self.rise(t), y[0]]  # noqa: E731
                stop.direction = 1.0
                q = self.limit(t)
            stop.terminal = True
            found = solve_ivp(
                right, (t, ends[1]), [q, 0.0], "DOP853", events=stop,
                rtol=1e-9, atol=1e-11 * scale, max_step=0.1,
            )  # fmt: skip
            t, q, total = found.t[-1], float(found.y[0, -1]), total + float(found.y[1, -1])
            if found.status == 1:
                sticks = not sticks
        return q, total, sticks

    def mean(self) -> float:
        q, last, sticks, total = self.limit(-math.pi), math.inf, False, 0.0
        for _ in range(40):
            if abs(q - last) <= 1e-9 * self.limit(0.0):
                break
            last = q
            q, first, sticks = self.half((-math.pi, 0.0), q, sticks)
            if not sticks:
                sticks = self.rise(1e-9) > self.rate(1e-9, q)
            q, second, sticks = self.half((0.0, math.pi), q, sticks)
            total = first + second
        return total / (2 * math.pi)


CASES = [
    ("exponential", "constant", 0.3e-6, 0.005), ("exponential", "constant", 1e-6, 0.05),
    ("exponential", "constant", 3e-6, 0.2), ("exponential", "following", 0.3e-6, 0.02),
    ("exponential", "following", 1e-6, 0.1), ("exponential", "following", 3e-6, 0.5),
    ("rough", "constant", 0.3e-6, 0.05), ("rough", "constant", 1e-6, 0.2),
    ("rough", "constant", 3e-6, 0.02), ("rough", "following", 0.3e-6, 0.005),
    ("rough", "following", 1e-6, 0.08), ("rough", "following", 3e-6, 0.3),
]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(("name", "stiffness", "a", "speed"), CASES)
def test_against_events(
    table: FilmTable, name: str, stiffness: str, a: float, speed: float
) -> None:
    law, load = LAWS[name], 5e3
    other = plain(law)
    u = balanced_gap(other, a, load)
    rest = brentq(lambda h: math.log(other.pressure(h) / load), 0.1e-6, 9e-6, xtol=1e-16)
    constant = other.stiffness(rest) if stiffness == "constant" else None
    slider = Slider(other, u, a, KAPPA * speed / (MU * OMEGA), constant)
    shear = AsperityShear(speed, MU, stiffness)  # type: ignore[arg-type]
    shared = share_load(table, law, a, load)
    assert float(shared.mean_gap) == pytest.approx(u, rel=1e-5)
    found = float(sheared_friction(shared, shear, FREQUENCY))
    assert found == pytest.approx(slider.mean() / other.limit(rest), abs=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", ["rigid", "constant", "following"])
@pytest.mark.parametrize(
    "law", [AsperityLaw(), RoughContact(), AsperityLaw(5e3, 2e-6, 0.8e-6, "gaussian")]
)
def test_more_vibration_never_rubs_more_and_more_speed_never_less(
    table: FilmTable, law: ContactLaw, stiffness: str
) -> None:
    speeds, swings = np.geomspace(1e-3, 2.0, 30), np.linspace(0.0, 5e-6, 60)
    shear = AsperityShear(speeds, MU, stiffness)  # type: ignore[arg-type]
    for load in (700.0, 5e3, 3e4):
        found = sheared_friction(share_load(table, law, swings, load), shear, FREQUENCY)
        assert np.all(np.diff(found, axis=0) >= -1e-6)
        assert np.all(np.diff(found, axis=1) <= 1e-6)
        assert found[:, 0] == pytest.approx(1.0, abs=1e-9)


@pytest.mark.slow
def test_rigid_shear_is_the_share_of_the_load(table: FilmTable) -> None:
    swings = np.geomspace(0.02e-6, 6e-6, 40)
    rigid = AsperityShear(0.1, stiffness="rigid")
    for law in (AsperityLaw(), AsperityLaw(5e3, 2e-6, 0.8e-6, "gaussian")):
        for load in (700.0, 5e3, 3e4):
            shared = share_load(table, law, swings, load)
            found = sheared_friction(shared, rigid, FREQUENCY)
            np.testing.assert_allclose(found, shared.relative_friction, rtol=0, atol=1e-9)
