"""Partial levitation against analysis: published checks, limits, balances, energy, other laws."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from tests.plateau import mean_pressure, over_pressure

from squeezefilm.core.errors import InputError, OutOfRangeError, UnreachableError
from squeezefilm.core.materials import Gas
from squeezefilm.physics.chain.friction import friction_law
from squeezefilm.physics.contact.asperities import (
    AsperityLaw,
    CompiledAsperities,
    gaussian_overlap,
)
from squeezefilm.physics.contact.finger.fingertip import Finger, Skin
from squeezefilm.physics.contact.sharing.balance import share_load, share_load_tied
from squeezefilm.physics.contact.sharing.gas_table import DEEPEST_EXCURSION, FilmTable, film_table
from squeezefilm.physics.contact.sharing.levitation import relative_friction
from squeezefilm.physics.contact.sharing.pad import (
    PadFriction,
    pad_friction,
    pad_points,
)
from squeezefilm.physics.display import load_display
from squeezefilm.physics.film.closed import relative_damping, relative_stiffness
from squeezefilm.physics.film.gap import PaperGap, squeeze_number
from squeezefilm.physics.film.periodic.film import solve_uniform

GAS = Gas(1.85e-5, 1e5, 1.2, 67e-9)
LAW = AsperityLaw()
FINGER = Finger(10e-3, 50e-6, 350e-6, 0.5)
RIDGES = (np.arange(-14, 14) + 0.5) * 350e-6


@pytest.fixture(scope="module")
def table() -> FilmTable:
    return film_table(40.5e3, 250e-6, GAS)


# --- the numbers of the specification ---------------------------------------------------------


def test_a_rigid_finger_at_an_antinode(table: FilmTable) -> None:
    shared = share_load(table, LAW, np.array([0.5, 1, 1.5, 2, 3]) * 1e-6, 5e3)
    np.testing.assert_allclose(
        shared.relative_friction, [0.739, 0.501, 0.381, 0.313, 0.239], rtol=0, atol=5e-4
    )
    assert np.all(np.abs(shared.residual) < 1e-8)
    assert np.all(shared.relative_friction_error < 5e-4)


def test_the_two_limits_over_the_standing_wave(table: FilmTable) -> None:
    points = RIDGES
    own, tied = (
        over(table, points, 9.35e-3, limit).relative_friction[0] for limit in ("own", "one-gap")
    )
    assert own == pytest.approx(0.514, abs=5e-4)
    assert tied == pytest.approx(0.365, abs=5e-4)


def test_the_mean_over_the_period_is_not_the_pressure_at_the_mean_gap(table: FilmTable) -> None:
    # The specification gives .70/.35/.155/.066/.012 for the balance with p_a of the mean gap.
    found = []
    for a in np.array([0.5, 1, 1.5, 2, 3]) * 1e-6:

        def excess(u: float, a: float = a) -> float:
            return float(over_pressure(table, u, a) + LAW.pressure(u)) - 5e3

        u = brentq(excess, a / 0.98, 12e-6)
        found.append(float(LAW.pressure(u)) / 5e3)
    np.testing.assert_allclose(found, [0.70, 0.35, 0.155, 0.066, 0.012], rtol=0, atol=6e-3)


# --- the film table -----------------------------------------------------------------------------


def over_pressure_solved(table: FilmTable, u: float, eps: float, tolerance: float) -> float:
    """⟨p_gas⟩/p0 − 1 of the table's film at a mean gap and an excursion, solved by itself."""
    return solve_uniform(
        (table.length / u) ** 2,
        eps,
        knudsen_number=table.gas.mean_free_path / u,
        slip=table.slip,
        tolerance=tolerance,
    ).over_pressure


@pytest.mark.parametrize(("ambient", "slip"), [(1e5, "first"), (2e3, "fukui-kaneko")])
def test_the_table_is_within_its_bound_of_films_solved_elsewhere(ambient: float, slip: str) -> None:
    gas = GAS.at_pressure(ambient)
    table = FilmTable(40.5e3, 250e-6, gas, slip)
    rng = np.random.default_rng(7)
    for _ in range(40):
        u, eps = rng.uniform(1e-6, 8e-6), rng.uniform(0.02, DEEPEST_EXCURSION - 0.005)
        found = float(over_pressure(table, u, eps * u))
        solved = over_pressure_solved(table, u, eps, 1e-5)
        assert found == pytest.approx(ambient * solved, rel=table.relative_error)
    assert 0 < table.relative_error <= table.tolerance


@pytest.mark.parametrize("slip", ["first", pytest.param("veijola", marks=pytest.mark.slow)])
def test_tables_across_frequencies_are_within_their_bound(slip: str) -> None:
    """What a search takes of thousands of plates, each with a frequency of its own."""
    rng = np.random.default_rng(9)
    for _ in range(60):
        frequency, u = rng.uniform(15e3, 90e3), rng.uniform(1e-6, 8e-6)
        eps = rng.uniform(0.02, DEEPEST_EXCURSION - 0.005)
        table = FilmTable(frequency, 250e-6, GAS, slip)
        found = float(over_pressure(table, u, eps * u))
        solved = over_pressure_solved(table, u, eps, 1e-5)
        assert found == pytest.approx(1e5 * solved, rel=table.relative_error)
        assert 0 < table.relative_error <= table.tolerance


@pytest.mark.parametrize(
    "slip", ["first", pytest.param("veijola", marks=pytest.mark.slow), "fukui-kaneko"]
)
def test_the_deepest_panels_are_within_their_bound(slip: str) -> None:
    """Where the gap closes to 0.7 % of its mean, against films solved there with a tolerance of
    their own (`test_film_agreement` has one as deep by marching in time)."""
    table = FilmTable(40.5e3, 250e-6, GAS, slip)
    rng = np.random.default_rng(8)
    for _ in range(8):
        u, eps = rng.uniform(2e-6, 8e-6), rng.uniform(0.985, DEEPEST_EXCURSION)
        found = float(over_pressure(table, u, eps * u))
        solved = over_pressure_solved(table, u, eps, 1e-4)
        assert found == pytest.approx(1e5 * solved, rel=table.relative_error + 1e-4)
    assert 0 < table.relative_error <= table.tolerance
    assert math.isnan(over_pressure(table, 4e-6, 4e-6 * (DEEPEST_EXCURSION + 1e-3)))


def test_a_finer_table_changes_the_friction_by_less_than_the_coarse_bound() -> None:
    coarse, fine = (FilmTable(40.5e3, 250e-6, GAS, tolerance=t) for t in (2e-3, 2e-5))
    a = np.linspace(0.2e-6, 4e-6, 9)
    rough, exact = (share_load(t, LAW, a, 5e3) for t in (coarse, fine))
    assert np.all(
        np.abs(rough.relative_friction - exact.relative_friction) <= rough.relative_friction_error
    )
    assert fine.relative_error < coarse.relative_error


# --- limits -------------------------------------------------------------------------------------


def test_without_vibration_all_friction_is_left(table: FilmTable) -> None:
    still = share_load(table, LAW, 0.0, 5e3)
    assert float(still.relative_friction) == pytest.approx(1.0, abs=1e-9)
    assert float(still.mean_gap) == pytest.approx(2e-6, rel=1e-9)
    faint = share_load(table, LAW, np.array([1e-9, 1e-8]), 5e3)
    # ⟨p_gas⟩ goes with a²: a tenth of the amplitude takes a hundredth.
    lost = 1 - faint.relative_friction
    assert lost[1] / lost[0] == pytest.approx(100, rel=0.02)


def test_asperities_that_end_abruptly_leave_full_levitation() -> None:
    # With a short decay nothing but the film is left where it can carry: 1 − µ′/µ → 1.
    table = film_table(40.5e3, 2e-3, GAS)
    law = AsperityLaw(5e3, 0.2e-6, 5e-9)
    assert float(share_load(table, law, 2e-6, 2e3).relative_friction) < 1e-6


@pytest.mark.parametrize(("width", "tolerance"), [(1e-3, 0.08), (8e-3, 0.01)])
def test_the_papers_model_comes_back_under_its_assumptions(width: float, tolerance: float) -> None:
    # Its assumptions: no gas escapes (σ → ∞: a wide plateau without slip), and the vibrating plate
    # just clears rigid asperities, h = h_r + a (1 + cos T): a decay length of 1 nm at h_r.
    gas = dataclasses.replace(GAS, mean_free_path=1e-15)
    table = film_table(40.5e3, width, gas)
    rigid = AsperityLaw(5e4, 0.6e-6, 1e-9)
    a, pressure = np.array([0.1, 0.2, 0.4]) * 1e-6, 5e4
    ours = share_load(table, rigid, a, pressure).relative_friction
    gap = PaperGap(
        roughness=0.6e-6,
        vibration_amplitude=a,
        ridge_amplitude=0.0,
        ridge_period=350e-6,
        wavelength=1e3,
        contact_length=1e-2,
    )
    papers = np.asarray(relative_friction(gap, pressure * 1e-4, gas.ambient_pressure))
    np.testing.assert_allclose(1 - ours, 1 - papers, rtol=tolerance)


def test_a_vacuum_takes_most_of_the_reduction_away(table: FilmTable) -> None:
    thin = film_table(40.5e3, 250e-6, GAS.at_pressure(2e3), "fukui-kaneko")
    inside = 1 - float(share_load(thin, LAW, 2e-6, 5e3).relative_friction)
    outside = 1 - float(share_load(table, LAW, 2e-6, 5e3).relative_friction)
    assert inside < 0.25 * outside


def test_a_plateau_that_nothing_carries_is_refused() -> None:
    empty = film_table(40.5e3, 250e-6, GAS.at_pressure(1e3))
    weak = AsperityLaw(10.0, 0.2e-6, 0.05e-6)
    with pytest.raises(OutOfRangeError, match="pressed through its asperities"):
        share_load(empty, weak, 3e-6, 5e4)


# --- asperities ---------------------------------------------------------------------------------


def test_exponential_heights_make_the_exponential_law() -> None:
    # The Greenwood–Williamson integral with heights e^{-z}: Γ(5/2) e^{-t}.
    for t in (0.0, 1.0, 4.0):
        integral, _ = quad(lambda z, t=t: (z - t) ** 1.5 * math.exp(-z), t, t + 60)
        assert integral == pytest.approx(math.gamma(2.5) * math.exp(-t), rel=1e-8)


def test_the_gaussian_overlap_is_its_integral() -> None:
    for t in (-2.0, 0.0, 1.5, 5.0):
        integral, _ = quad(
            lambda z, t=t: (z - t) ** 1.5 * math.exp(-z * z / 2) / math.sqrt(2 * math.pi), t, t + 30
        )
        assert float(gaussian_overlap(t)) == pytest.approx(integral, rel=1e-7, abs=1e-12)


@pytest.mark.parametrize("heights", ["exponential", "gaussian"])
def test_period_means_agree_with_quadrature_and_with_the_compiled_code(heights: str) -> None:
    from squeezefilm.physics.contact.asperity_kernel import asperity_mean

    law = AsperityLaw(heights=heights)  # type: ignore[arg-type]
    assert isinstance(law.compiled(), CompiledAsperities)
    for u, a in ((2e-6, 0.1e-6), (3e-6, 1.5e-6), (6e-6, 5e-6), (22e-6, 20e-6)):
        mean, _ = quad(
            lambda T, u=u, a=a: float(law.pressure(u - a * math.cos(T))) / math.pi,
            0, math.pi, epsabs=0, epsrel=1e-11, limit=200,
        )  # fmt: skip
        first, _ = quad(
            lambda T, u=u, a=a: (
                2 * float(law.pressure(u - a * math.cos(T))) * math.cos(T) / math.pi
            ),
            0, math.pi, epsabs=1e-13 * mean, limit=200,
        )  # fmt: skip
        assert float(mean_pressure(law, u, a)) == pytest.approx(mean, rel=1e-9)
        assert asperity_mean(law.compiled(), u, a) == pytest.approx((mean, first), rel=1e-8)


def test_gaussian_heights_share_the_load_like_their_tangent_exponential(table: FilmTable) -> None:
    # Over a swing much smaller than the heights the law is its tangent: an exponential.
    gauss = AsperityLaw(5e3, 2e-6, 1.0e-6, "gaussian")
    step = 1e-11
    slope = math.log(float(gauss.pressure(2e-6)) / float(gauss.pressure(2e-6 + step))) / step
    tangent = AsperityLaw(5e3, 2e-6, 1 / slope)
    for a, bound in ((0.02e-6, 1e-5), (0.2e-6, 2e-3)):
        one, two = (
            float(share_load(table, law, a, 5e3).relative_friction) for law in (gauss, tangent)
        )
        assert abs(one - two) < bound


def test_the_mean_of_the_exponential_law_holds_for_swings_of_many_decay_lengths() -> None:
    value = float(mean_pressure(AsperityLaw(5e3, 2e-6, 0.1e-6), 50e-6, 40e-6))
    assert value > 0
    assert math.isfinite(value)


# --- energy ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("damping", [0.0, 3e5, 3e6])
@pytest.mark.parametrize("stiffness", [0.0, 4e11])
def test_no_energy_is_created(table: FilmTable, damping: float, stiffness: float) -> None:
    # What the plate puts in per period, Im(p̂ ā), is what film and skin take: asperities keep none.
    from squeezefilm.physics.contact.asperity_kernel import asperity_mean
    from squeezefilm.physics.contact.sharing.kernel import film_value

    skin = Skin(stiffness_per_area=stiffness, damping_per_area=damping)
    a = 1.5e-6
    shared = share_load(table, LAW, a, 5e3, skin=skin)
    u, swing, moved = (
        float(getattr(shared, name)) for name in ("mean_gap", "gap_amplitude", "skin_amplitude")
    )
    k, d = (film_value(which, u, swing, table.compiled)[0] for which in (1, 2))
    assert d > 0
    Z = complex(k + asperity_mean(LAW.compiled(), u, swing)[1] / swing, d)
    D = skin.dynamic_stiffness(table.frequency)
    b = a / (1 + Z / D)
    assert abs(b) == pytest.approx(swing, rel=1e-9)
    assert abs(b * Z / D) == pytest.approx(moved, rel=1e-9)
    put_in = (Z * b).imag * a
    taken = d * swing**2 + D.imag * moved**2
    assert put_in == pytest.approx(taken, rel=1e-9)
    assert taken > 0


INERTIA = 1.2 * (2 * math.pi * 40.5e3) ** 2


@pytest.mark.parametrize("stiffness", [0.0, 0.7, 0.95, 1.05, 1.3, 3.0])
def test_damping_a_skin_lowers_friction_where_linear_analysis_says(
    table: FilmTable, stiffness: float
) -> None:
    """At 20 nm, against the strip's closed form and the slope of the asperities' law: the gap
    swings by |D/(D + Z)|, and a skin that cannot move brings that to 1."""
    a, softest = 2e-8, Skin(1.2, stiffness * INERTIA, 0.0)
    free, damped, held = (
        share_load(table, LAW, a, 5e3, skin=dataclasses.replace(softest, damping_per_area=c))
        for c in (0.0, 2e5, 1e9)
    )
    u = float(free.mean_gap)
    sigma = squeeze_number(40.5e3, 250e-6, u, GAS.viscosity, GAS.ambient_pressure)
    slipping = float(sigma) / (1 + 6 * GAS.mean_free_path / u)
    film = complex(relative_stiffness(slipping), relative_damping(slipping))
    Z = GAS.ambient_pressure / u * film + 5e3 / LAW.decay_length
    for found, damping in ((free, 0.0), (damped, 2e5), (held, 1e9)):
        D = dataclasses.replace(softest, damping_per_area=damping).dynamic_stiffness(40.5e3)
        assert float(found.gap_amplitude) == pytest.approx(a * abs(D / (D + Z)), rel=0.01)
    rides_along = (stiffness - 1) * INERTIA > -(abs(Z) ** 2) / (2 * Z.real)
    assert rides_along == (stiffness > 0.8)
    assert (float(free.gap_amplitude) < a) == rides_along
    assert (float(held.relative_friction) < float(free.relative_friction)) == rides_along


def test_the_skin_moves_little_at_ultrasonic_frequency(table: FilmTable) -> None:
    a = np.array([0.5, 1, 1.5, 2, 3]) * 1e-6
    rigid = share_load(table, LAW, a, 5e3)
    # By its inertia it moves against the pressure.
    free = share_load(table, LAW, a, 5e3, skin=Skin(mass_per_area=3.3))
    assert np.all((free.skin_amplitude > 0.05e-6) & (free.skin_amplitude < 0.08e-6))
    change = np.abs(free.relative_friction - rigid.relative_friction)
    assert np.all(change < 0.025)
    assert np.all(change[1:] < 0.015)
    light = share_load(table, LAW, a, 5e3, skin=Skin())
    assert np.all(light.skin_amplitude > 2 * free.skin_amplitude)
    assert np.all(light.relative_friction < free.relative_friction)
    heavy = share_load(table, LAW, a, 5e3, skin=Skin(mass_per_area=1e6))
    np.testing.assert_allclose(heavy.relative_friction, rigid.relative_friction, atol=1e-6)


# --- the pad --------------------------------------------------------------------------------


def over(table: FilmTable, points: np.ndarray, half: float, limit: Any = "own") -> PadFriction:
    """The pad of ridges at points (m) over an antinode of a wave of a half wavelength (m)."""
    swings, shares = np.abs(np.cos(np.pi * points / half)), np.ones(points.size)
    return pad_friction(table, LAW, 2e-6, swings, shares, 5e3, limit)


def test_a_long_wave_makes_the_limits_one(table: FilmTable) -> None:
    points = RIDGES
    alone = float(share_load(table, LAW, 2e-6, 5e3).relative_friction)
    for limit in ("own", "one-gap"):
        pad = over(table, points, 10.0, limit)
        assert pad.relative_friction[0] == pytest.approx(alone, abs=1e-6)
        assert pad.film_share[0] == pytest.approx(1 - alone, abs=1e-6)


def test_the_pad_is_the_mean_of_its_ridges(table: FilmTable) -> None:
    points = RIDGES
    each = share_load(table, LAW, 2e-6 * np.abs(np.cos(np.pi * points / 9.35e-3)), 5e3)
    pad = over(table, points, 9.35e-3)
    assert pad.relative_friction[0] == pytest.approx(float(np.mean(each.relative_friction)))
    tied = share_load_tied(table, LAW, each.amplitude, 5e3)
    at = tied.mean_gap, each.amplitude
    total = over_pressure(table, *at) + mean_pressure(LAW, *at)
    assert float(np.mean(total)) == pytest.approx(5e3, rel=1e-8)


def test_crossing_the_nodes_is_felt_as_a_ripple() -> None:
    stator = load_display("biet2008-stator")
    ripples = []
    for side in (6e-3, 8e-3, 10e-3):
        finger = dataclasses.replace(FINGER, contact_length=side, normal_force=5e3 * side**2 / 1.4)
        display = dataclasses.replace(stator, finger=finger)
        law = friction_law(display, 10e-3, 40.5e3, model="partial-levitation")
        ripple = law.ripple(2e-6)
        ripples.append(ripple.ripple)
        assert ripple.contact_length == pytest.approx(side)
        # The pad is symmetric about the antinode.
        np.testing.assert_allclose(
            ripple.relative_friction[1:], ripple.relative_friction[:0:-1], rtol=1e-6
        )
    assert ripples == sorted(ripples, reverse=True)
    # A contact of half a wavelength covers every phase alike.
    assert ripples[-1] < 0.05
    assert 0.09 < ripples[0] < 0.57


def test_ridges_along_the_wave_sample_it_finely(table: FilmTable) -> None:
    # Across it in 28 places, which are 9.8 mm of them: the same wave.
    whole = dataclasses.replace(FINGER, contact_length=9.8e-3, ridge_angle=math.pi / 2)
    turned = over(table, pad_points(whole).along, 9.35e-3).relative_friction[0]
    level = over(table, RIDGES, 9.35e-3).relative_friction[0]
    assert turned == pytest.approx(level, abs=5e-3)
    with pytest.raises(InputError, match="limit = 'both'"):
        over(table, RIDGES, 9.35e-3, "both")


# --- sliding --------------------------------------------------------------------------------------


def test_sliding_adds_nothing_that_matters(table: FilmTable) -> None:
    u = float(share_load(table, LAW, 2e-6, 5e3).mean_gap)
    # (h³ p′)′ = 6 η U h′ at 100 mm/s under a plateau twice as high at one edge as at the other,
    # p = 0 at both, h⁻² averaged over the period of u − a cos T: 0.2 % of the load (Reynolds 1886).
    x = np.linspace(0, 1, 2001)
    h = 1 + x
    level = np.trapezoid(h**-2, x) / np.trapezoid(h**-3, x)
    slope = h**-2 - level * h**-3
    p = np.concatenate([[0], np.cumsum((slope[1:] + slope[:-1]) / 2 * np.diff(x))])
    mean_square = u / (u**2 - 2e-6**2) ** 1.5
    wedge = 6 * GAS.viscosity * 0.1 * 250e-6 * mean_square * abs(np.trapezoid(p, x))
    assert 0 < wedge < 0.002 * 5e3


# --- the law of a display -------------------------------------------------------------------


def test_a_display_has_the_law() -> None:
    law = friction_law(load_display("biet2008-stator"), 9.35e-3, 40.5e3, model="partial-levitation")
    a = np.linspace(0, 5e-6, 11)
    curve = law.curve(a)
    assert curve[0] == pytest.approx(1)
    assert np.all(np.diff(curve) < 0)
    assert law.at(2e-6) == pytest.approx(curve[4], rel=1e-6)
    load = law.load(2e-6)
    carried = load.over_pressure * law.gas.ambient_pressure / law.contact_pressure
    assert 1 - carried == pytest.approx(curve[4], rel=1e-6)
    assert 0 < load.error < 1e-3 * load.over_pressure
    wanted = float(curve[4])
    assert law.amplitude_for(wanted) == pytest.approx(2e-6, rel=1e-4)
    assert law.amplitude_for(1.0) == 0
    with pytest.raises(UnreachableError, match="not reached by any vibration amplitude"):
        law.amplitude_for(0.01)
    fast = law.table(5e-6)
    between = np.linspace(0, 5e-6, 37)
    np.testing.assert_allclose(fast(between), law.curve(between), atol=1e-3)
    own = law.friction_in("own", a)
    spread = np.abs(own - law.friction_in("one-gap", a))
    assert np.all(spread[1:] > 0)
    assert spread[0] < 1e-9
    np.testing.assert_allclose(own, curve, rtol=1e-9)
