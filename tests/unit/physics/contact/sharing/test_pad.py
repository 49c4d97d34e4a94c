"""A pad of many ridges on a film made by hand: means over ridges, limits, postures, ripples."""

from __future__ import annotations

import math
from typing import Any, cast

import numpy as np
import pytest

from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.physics.contact.asperities import AsperityLaw
from squeezefilm.physics.contact.finger.fingertip import Finger, Skin
from squeezefilm.physics.contact.sharing.balance import share_load, share_load_tied
from squeezefilm.physics.contact.sharing.gas_table import FilmTable
from squeezefilm.physics.contact.sharing.kernel import CompiledFilms
from squeezefilm.physics.contact.sharing.pad import (
    FrictionRipple,
    pad_friction,
    pad_points,
)

LAW = AsperityLaw()
AMBIENT, SHARE = 1e5, math.exp(-1.0)
HALF = 6e-3


def finger(ridge_period: float, contact_length: float = 10e-3, ridge_angle: float = 0.0) -> Finger:
    return Finger(contact_length, 50e-6, ridge_period, 0.5, ridge_angle=ridge_angle)


class HandMade:
    """A table of films whose over-pressure is p0/e times ε², solved panel by panel."""

    frequency, width, slip, relative_error = 30e3, 250e-6, "first", 1e-3

    def __init__(self) -> None:
        panels = np.full((12, 3, 3, 1, 1), -1.0)
        edges = -np.log1p(-(np.array([3e-3, 0.8, 0.95, 0.985]) ** 2))
        built = np.zeros((12, 3), dtype=np.int64)
        self.compiled = CompiledFilms(np.array([40e-6, AMBIENT, -6.0]), edges, built, panels)
        self.asked: list[int] = []

    def build(self, panel: int) -> None:
        assert self.compiled.built.flat[panel] == 0
        self.asked.append(panel)
        self.compiled.built.flat[panel] = 1


@pytest.fixture
def table() -> FilmTable:
    return cast(FilmTable, HandMade())


def test_panels_are_built_as_balances_ask_for_them(table: Any) -> None:
    found = share_load(table, LAW, np.array([[0.5e-6, 3e-6]]), np.array([[2e3], [9e3]]))
    assert found.mean_gap.shape == (2, 2)
    assert sorted(set(table.asked)) == sorted(table.asked)
    assert table.asked
    total = found.gas_pressure + found.asperity_pressure
    assert total == pytest.approx(np.array([[2e3] * 2, [9e3] * 2]), rel=1e-8)
    assert found.gas_pressure == pytest.approx(
        AMBIENT * SHARE * (np.array([[0.5e-6, 3e-6]]) / found.mean_gap) ** 2
    )
    assert found.relative_friction == pytest.approx(found.asperity_pressure / total)
    assert found.relative_friction_error == pytest.approx(
        1e-3 * found.gas_pressure / total, rel=1e-3
    )
    assert "each plateau at its own balance" in found.model
    assert "250 µm" in found.model
    assert "rigid skin" in found.model
    yielding = share_load(table, LAW, 1e-6, 3e3, skin=Skin())
    assert "yielding skin" in yielding.model
    # What the skin takes is the film's and the asperities' alternating pressure over its inertia.
    assert yielding.gap_amplitude != 1e-6
    assert yielding.skin_amplitude > 0
    # Another balance asks for nothing anew.
    before = list(table.asked)
    share_load_tied(table, LAW, np.array([0.5e-6]), 2e3)
    assert table.asked == before


def test_a_skin_that_resonates_goes_along_and_is_refused(table: Any) -> None:
    stiffness = 1.2 * (2 * math.pi * table.frequency) ** 2
    with pytest.raises(OutOfRangeError, match="goes along with the plate"):
        share_load(table, LAW, 1e-6, 3e3, skin=Skin(1.2, stiffness, 1e-3))


def test_one_ridge_tied_is_that_ridge_and_many_mean_their_pressures(table: FilmTable) -> None:
    own = share_load(table, LAW, 1e-6, 3e3)
    tied = share_load_tied(table, LAW, np.array([1e-6]), 3e3)
    assert tied.mean_gap == pytest.approx(float(own.mean_gap), rel=1e-8)
    assert tied.relative_friction == pytest.approx(float(own.relative_friction), rel=1e-8)
    error = float(own.relative_friction_error)
    assert tied.relative_friction_error == pytest.approx(error, rel=1e-3)
    with pytest.raises(InputError, match="shares"):
        share_load_tied(table, LAW, np.array([1e-6]), 3e3, np.array([0.5, 0.5]))


def test_a_pad_pressed_through_and_one_off_the_table_are_refused(table: FilmTable) -> None:
    weak = AsperityLaw(1.0)
    with pytest.raises(OutOfRangeError, match=r"under 900 kPa at an amplitude of 1 µm is pressed"):
        share_load(table, weak, np.array([0.0, 1e-6]), np.array([1.0, 9e5]))
    # The gap at which 1e-9 of ambient is left is some 10 mm: beyond e^6 lengths of 40 µm.
    with pytest.raises(OutOfRangeError, match="not tabulated"):
        share_load(table, weak, 1e-4, 1e-6)


def test_ridges_stand_half_a_period_off_the_middle_and_carry_with_the_part_in_contact() -> None:
    half = finger(0.5e-3)
    whole = pad_points(half, 2e-3)
    assert whole.along == pytest.approx([-0.75e-3, -0.25e-3, 0.25e-3, 0.75e-3])
    assert whole.shares == pytest.approx([0.25] * 4)
    # Of the outer two a half, from the middle of that half.
    cut = pad_points(half, 1.5e-3)
    assert cut.along == pytest.approx([-0.625e-3, -0.25e-3, 0.25e-3, 0.625e-3])
    assert cut.shares == pytest.approx([1 / 6, 1 / 3, 1 / 3, 1 / 6])
    assert cut.length == pytest.approx([0.25e-3, 0.5e-3, 0.5e-3, 0.25e-3])
    assert pad_points(half, 2e-3, 8).along.size == 32
    assert pad_points(half, 2e-3, 8).width == pytest.approx(np.full(32, 0.25e-3))
    with pytest.raises(InputError, match="holds no ridge"):
        pad_points(half, 0.4e-3)
    with pytest.raises(InputError, match="ridges in the contact"):
        pad_points(half, 100_001 * 0.5e-3)


@pytest.mark.parametrize("angle", [0.0, 0.3, math.pi / 4, -0.8, math.pi / 2])
def test_ridges_at_an_angle_are_sampled_evenly_over_the_square(angle: float) -> None:
    side = 5e-3
    points = pad_points(finger(0.4e-3, ridge_angle=angle), side, 16)
    for places, sizes in ((points.along, points.length), (points.across, points.width)):
        assert np.all(np.abs(places) + sizes / 2 <= side / 2 * (1 + 1e-9))
        # Evenly: the first moments are those of the square's uniform density.
        assert points.shares @ places == pytest.approx(0.0, abs=0.001 * side)
        spread = math.sqrt(points.shares @ places**2)
        assert spread == pytest.approx(side / math.sqrt(12), rel=0.01)
    assert np.sum(points.shares) == pytest.approx(1.0)


@pytest.mark.parametrize("angle", [0.0, 0.3, math.pi / 4])
def test_means_over_a_pad_are_continuous_in_its_size(angle: float) -> None:
    """Of what changes within a ridge: a thousandth more of the side, a few thousandths more of it,
    where whole ridges would come in."""
    sides = 3e-3 * 1.001 ** np.arange(400)
    means = []
    for side in sides.tolist():
        points = pad_points(finger(0.4e-3, ridge_angle=angle), side, 4)
        means.append(points.shares @ np.cos(np.pi * points.along / HALF) ** 2)
    assert np.abs(np.diff(means)).max() < 2e-3
    assert np.ptp(means) > 0.1


SWINGS, SHARES = np.array([0.9, 0.2, 0.2, 0.7]), np.array([1.0, 3.0, 2.0, 2.0])


def test_each_ridge_at_its_own_balance_is_the_mean_of_ridges(table: FilmTable) -> None:
    found = pad_friction(table, LAW, np.array([0.4e-6, 2e-6]), SWINGS, SHARES, 3e3)
    for i, a in enumerate((0.4e-6, 2e-6)):
        each = [share_load(table, LAW, a * w, 3e3) for w in SWINGS]
        for name, own in (
            ("mean_gap", "mean_gap"),
            ("film_pressure", "gas_pressure"),
            ("asperity_pressure", "asperity_pressure"),
            ("relative_friction_error", "relative_friction_error"),
        ):
            mean = np.average([float(getattr(one, own)) for one in each], weights=SHARES)
            assert getattr(found, name)[i] == pytest.approx(
                mean, rel=1e-3 if "err" in name else 1e-6
            )
    assert found.relative_friction + found.film_share == pytest.approx([1.0, 1.0])
    assert found.limit == "own"
    assert 0 <= found.residual < 1e-8
    for shares in (SHARES[:3], np.zeros(4)):
        with pytest.raises(InputError, match="one for each, not all 0"):
            pad_friction(table, LAW, 1e-6, SWINGS, shares, 3e3)


def test_ridges_on_one_gap_are_tied(table: FilmTable) -> None:
    found = pad_friction(table, LAW, np.array([0.4e-6, 2e-6]), SWINGS, SHARES, 3e3, "one-gap")
    for i, a in enumerate((0.4e-6, 2e-6)):
        tied = share_load_tied(table, LAW, a * SWINGS, 3e3, SHARES / 8)
        assert found.mean_gap[i] == pytest.approx(float(tied.mean_gap), rel=1e-9)
        assert found.film_pressure[i] == pytest.approx(float(tied.gas_pressure), rel=1e-9)
        assert found.asperity_pressure[i] == pytest.approx(float(tied.asperity_pressure), rel=1e-9)
    assert found.relative_friction_error.shape == found.relative_friction.shape == (2,)
    assert found.limit == "one-gap"
    assert "one mean gap" in found.model


def test_a_ripple_is_its_range_over_its_mean() -> None:
    ripple = FrictionRipple(np.arange(4.0), np.array([0.5, 0.9, 0.7, 0.7]), 5e-3, HALF)
    assert ripple.mean == pytest.approx(0.7)
    assert ripple.ripple == pytest.approx(0.4 / 0.7)
