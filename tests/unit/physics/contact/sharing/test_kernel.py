"""The compiled balance on films made by hand: every part against numpy or scipy."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.polynomial import chebyshev
from scipy.optimize import brentq
from tests.plateau import mean_pressure

from squeezefilm.physics.contact.asperities import AsperityLaw
from squeezefilm.physics.contact.sharing.kernel import (
    ASPERITIES,
    BALANCED,
    COLUMNS,
    GAP,
    GAS,
    NEEDS_PANEL,
    OUT_OF_TABLE,
    PRESSED_THROUGH,
    RESIDUAL,
    STATUS,
    STEPS,
    UNSETTLED,
    CompiledFilms,
    CompiledRidges,
    asperity_mean,
    balance,
    balance_rows,
    film_value,
)

LENGTH, AMBIENT, FIRST = 40e-6, 1e5, -4.0
EDGES = -np.log1p(-(np.array([3e-3, 0.8, 0.95, 0.985]) ** 2))
SOFT = AsperityLaw(5e3, 2e-6, 0.6e-6)
LAWS = [SOFT, AsperityLaw(5e3, 2e-6, 0.6e-6, "gaussian")]


def films(panels: np.ndarray | None = None, built: np.ndarray | None = None) -> CompiledFilms:
    """Six columns from e^−4 lengths on, three rows; ln of over-pressure, stiffness and damping
    over their scales are −1, −0.5 and −2 everywhere if nothing else is said."""
    if panels is None:
        panels = np.zeros((6, 3, 3, 2, 3))
        panels[:, :, :, 0, 0] = [-1.0, -0.5, -2.0]
    if built is None:
        built = np.ones((6, 3), dtype=np.int64)
    return CompiledFilms(np.array([LENGTH, AMBIENT, FIRST]), EDGES, built, panels)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("u", [1.5e-6, 4e-6, 9e-6])
@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.98])
def test_asperities_are_averaged_over_the_period(law: AsperityLaw, u: float, share: float) -> None:
    cosine = np.cos(2 * np.pi * np.arange(4096) / 4096)
    pressure = np.asarray(law.pressure(u - share * u * cosine))
    mean, first = asperity_mean(law.compiled(), u, share * u)
    # Chebyshev terms stand in for Gaussian heights: to some 1e-8.
    assert mean == pytest.approx(pressure.mean(), rel=1e-7)
    harmonic = 2 * (pressure * cosine).mean()
    assert first == pytest.approx(harmonic, rel=1e-7, abs=1e-12 * mean)


def test_where_no_asperity_reaches_nothing_is_carried() -> None:
    mean, first = asperity_mean(LAWS[1].compiled(), 12.5e-6, 0.4e-6)
    assert (mean, first) == (0.0, 0.0)


@pytest.mark.parametrize("which", [0, 1, 2])
def test_a_film_is_read_off_its_panel(which: int) -> None:
    panels = 0.2 * np.random.default_rng(5).standard_normal((6, 3, 3, 4, 5))
    for column in range(6):
        for row, excursion in enumerate((0.5, 0.9, 0.97)):
            for within in (0.1, 0.8):
                u = LENGTH * math.exp(FIRST + column + within)
                depth = -math.log1p(-(excursion**2))
                eta = 2 * (depth - EDGES[row]) / (EDGES[row + 1] - EDGES[row]) - 1
                value = math.exp(
                    chebyshev.chebval2d(2 * within - 1, eta, panels[column, row, which])
                )
                scale = AMBIENT * excursion**2 if which == 0 else AMBIENT / u
                found, lack = film_value(which, u, excursion * u, films(panels))
                assert found == pytest.approx(scale * value, rel=1e-11)
                assert lack == -1


def test_a_still_film_carries_nothing_and_still_resists() -> None:
    assert film_value(0, 3e-6, 0.0, films()) == (0.0, -1)
    assert film_value(1, 3e-6, 0.0, films())[0] == pytest.approx(AMBIENT * math.exp(-0.5) / 3e-6)
    assert film_value(2, 3e-6, 0.0, films())[0] == pytest.approx(AMBIENT * math.exp(-2.0) / 3e-6)


@pytest.mark.parametrize(
    ("place", "excursion", "lack"),
    [
        (-0.01, 0.5, -2), (6.01, 0.5, -2), (2.5, 0.986, -2),
        (2.5, 0.5, 6), (2.5, 0.9, -1), (2.5, 0.96, 8), (5.99, 0.96, 17), (0.01, 0.5, 0),
    ],
)  # fmt: skip
def test_a_point_off_the_table_and_a_panel_not_solved_are_told(
    place: float, excursion: float, lack: int
) -> None:
    built = np.zeros((6, 3), dtype=np.int64)
    built[2, 1] = 1
    u = LENGTH * math.exp(FIRST + place)
    value, found = film_value(0, u, excursion * u, films(built=built))
    assert found == lack
    assert math.isnan(value) == (lack != -1)


def balanced(
    amplitudes: Any,
    pressure: float,
    *,
    law: AsperityLaw = SOFT,
    table: CompiledFilms | None = None,
) -> np.ndarray:
    out = np.full(COLUMNS, np.nan)
    met = np.atleast_1d(np.asarray(amplitudes, dtype=float))
    alike = np.full(met.size, 1 / met.size)
    ridges = CompiledRidges(met, alike)
    lacking = balance(ridges, pressure, law.compiled(), table or films(), out)
    return np.append(out, lacking)


PANEL = COLUMNS  # the panel lacking, after the row


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("pressure", [50.0, 3e3, 3e4])
@pytest.mark.parametrize("amplitude", [0.0, 0.2e-6, 1e-6, 3e-6])
def test_gas_and_asperities_carry_the_load(
    law: AsperityLaw, pressure: float, amplitude: float
) -> None:
    row = balanced(amplitude, pressure, law=law)
    assert row[STATUS] == BALANCED
    u = row[GAP]
    assert row[GAS] == pytest.approx(AMBIENT * math.exp(-1.0) * (amplitude / u) ** 2)
    assert row[ASPERITIES] == pytest.approx(float(mean_pressure(law, u, amplitude)), rel=1e-8)
    assert row[GAS] + row[ASPERITIES] == pytest.approx(pressure, rel=1e-9)
    assert row[RESIDUAL] == pytest.approx((row[GAS] + row[ASPERITIES]) / pressure - 1, abs=1e-15)
    assert row[PANEL] == -1.0
    assert 1 <= row[STEPS] < 40


@pytest.mark.parametrize("law", LAWS)
def test_tied_ridges_share_one_gap(law: AsperityLaw) -> None:
    swings = np.array([1.5e-6, 0.3e-6, 0.9e-6])

    def carried(u: float) -> tuple[float, float]:
        gas = AMBIENT * math.exp(-1.0) * np.mean((swings / u) ** 2)
        return float(gas), float(np.mean(mean_pressure(law, u, swings)))

    row = balanced(swings, 4e3, law=law)
    u = brentq(lambda u: sum(carried(u)) - 4e3, 1.3e-6, 60e-6, xtol=1e-16)
    assert row[STATUS] == BALANCED
    assert row[GAP] == pytest.approx(u, rel=1e-8)
    assert row[GAS] == pytest.approx(carried(u)[0], rel=1e-7)
    assert row[ASPERITIES] == pytest.approx(carried(u)[1], rel=1e-7)


def test_what_cannot_be_balanced_is_told_apart() -> None:
    # Asperities that carry less than the load even where the gap is all but closed.
    weak = AsperityLaw(1.0, 2e-6, 0.6e-6)
    assert balanced(1e-6, 9e5, law=weak)[STATUS] == PRESSED_THROUGH
    # A load so small that the gap is beyond the table: 40 µm · e².
    assert balanced(3e-6, 1.0, law=weak)[STATUS] == OUT_OF_TABLE
    none = np.zeros((6, 3), dtype=np.int64)
    row = balanced(1e-6, 3e3, table=films(built=none))
    assert row[STATUS] == NEEDS_PANEL
    # The first guess is where asperities alone carry: that panel is asked for.
    u = float(
        brentq(lambda u: float(mean_pressure(SOFT, u, 1e-6)) - 3e3, 1.02e-6, 20e-6, xtol=1e-16)
    )
    column = math.floor(math.log(u / LENGTH) - FIRST)
    assert row[PANEL] == 3 * column + (0 if 1e-6 / u < 0.8 else 1 if 1e-6 / u < 0.95 else 2)
    assert UNSETTLED not in (BALANCED, NEEDS_PANEL, PRESSED_THROUGH, OUT_OF_TABLE)


def test_rows_that_are_balanced_are_kept_and_the_first_lacking_panel_is_told() -> None:
    built = np.ones((6, 3), dtype=np.int64)
    built[0, 0] = built[1, 1] = 0
    table = films(built=built)
    # The gaps: 1.2 to 2 µm in column 0, 2 to 5.4 µm in column 1.
    swings, loads = np.array([0.0, 0.2e-6, 0.3e-6]), np.array([3e3, 9e3, 9e3])
    out = np.zeros((3, COLUMNS))
    assert balance_rows(swings, loads, SOFT.compiled(), table, out) == 0
    assert out[:, STATUS] == pytest.approx([BALANCED, NEEDS_PANEL, NEEDS_PANEL])
    out[0, GAS] = 77.0  # a mark: what stands is not made again
    built[0, 0] = 1
    assert balance_rows(swings, loads, SOFT.compiled(), table, out) == -1
    assert out[:, STATUS] == pytest.approx([BALANCED] * 3)
    assert out[0, GAS] == 77.0
    assert out[1:, GAS] + out[1:, ASPERITIES] == pytest.approx([9e3, 9e3])
