"""Shear of balanced plateaus: its limits, and the figures of a separate prototype."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.contact.asperities import AsperityLaw
from squeezefilm.contact.rough_contact import RoughContact
from squeezefilm.contact.sharing.balance import LoadSharing, share_load, share_load_tied
from squeezefilm.contact.sharing.gas_table import FilmTable, film_table
from squeezefilm.contact.sharing.shear import AsperityShear, sheared_friction
from squeezefilm.display import load_display
from squeezefilm.errors import InputError, OutOfRangeError, OutOfRangeWarning

FREQUENCY = 40.5e3
AMPLITUDES = np.array([0.5e-6, 1e-6, 2e-6, 3e-6])


@pytest.fixture(scope="module")
def table() -> FilmTable:
    return film_table(FREQUENCY, 250e-6, load_display("biet2008-stator").gas)


@pytest.fixture(scope="module")
def shared(table: FilmTable) -> LoadSharing:
    return share_load(table, AsperityLaw(), AMPLITUDES, 5e3)


def test_rigid_shear_is_the_share_of_the_load(shared: LoadSharing) -> None:
    rigid = sheared_friction(shared, AsperityShear(0.05, stiffness="rigid"), FREQUENCY)
    assert rigid == pytest.approx(shared.relative_friction, rel=1e-9)
    fast = sheared_friction(shared, AsperityShear(4.9), FREQUENCY)
    assert fast == pytest.approx(shared.relative_friction, rel=1e-9)


@pytest.mark.parametrize(
    ("stiffness", "speed", "known"),
    [
        ("constant", 0.02, [0.455, 0.202, 0.087, 0.056]),
        ("constant", 0.08, [0.684, 0.391, 0.201, 0.137]),
        ("constant", 0.3, [0.739, 0.501, 0.313, 0.236]),
        ("following", 0.08, [0.636, 0.277, 0.103, 0.062]),
        ("following", 0.3, [0.739, 0.497, 0.266, 0.183]),
        # The prototype had .230 at 0.5 um; small steps of the rate equations give 0.254.
        ("following", 0.02, [0.254, 0.077, 0.026, 0.015]),
    ],
)
def test_a_prototypes_figures(
    shared: LoadSharing, stiffness: str, speed: float, known: list[float]
) -> None:
    shear = AsperityShear(speed, 0.9, stiffness)  # type: ignore[arg-type]
    assert sheared_friction(shared, shear, FREQUENCY) == pytest.approx(known, rel=0.03)


def test_of_real_contact_it_parts_from_the_share_of_the_load(table: FilmTable) -> None:
    """Area falls short of pressure once much is in contact, more so under a hard-pressed finger."""
    law = RoughContact()
    light, hard = (share_load(table, law, 1e-6, p) for p in (1e3, 6e4))
    rigid = AsperityShear(0.1, stiffness="rigid")
    parts = [
        float(sheared_friction(one, rigid, FREQUENCY) - one.relative_friction)
        for one in (light, hard)
    ]
    assert abs(parts[0]) < 1e-4
    assert abs(parts[1]) > abs(parts[0])


def test_a_rough_interface_is_refused_where_it_would_be_flat(table: FilmTable) -> None:
    with pytest.raises(OutOfRangeError, match="nearly everything into contact"):
        share_load(table, RoughContact(), 1e-6, 4e5)


@pytest.mark.parametrize("amplitude", [1e-12, 1e-10, 1e-9])
def test_a_hard_pressed_plateau_that_hardly_moves_is_one_at_rest(
    table: FilmTable, amplitude: float
) -> None:
    """The search for its gap stays within the film's table."""
    rest = share_load(table, RoughContact(), 0.0, 5.2e4)
    found = share_load(table, RoughContact(), amplitude, 5.2e4)
    assert float(found.mean_gap) == pytest.approx(float(rest.mean_gap), rel=1e-3)
    with pytest.raises(OutOfRangeError, match="nearly everything into contact"):
        share_load(table, RoughContact(), amplitude, 2e5)


def test_of_tied_ridges_the_one_that_comes_nearest_is_refused(table: FilmTable) -> None:
    """Not the last one, which need not move at all."""
    for swings in ([0.3e-6, 0.0, 0.0], [0.0, 0.0, 0.3e-6]):
        with pytest.raises(OutOfRangeError, match="nearly everything into contact"):
            share_load_tied(table, RoughContact(), np.array(swings), 1.2e5)
    share_load_tied(table, RoughContact(), np.array([0.3e-6, 0.0, 0.0]), 9e4)


def test_many_speeds_are_one_call(shared: LoadSharing) -> None:
    speeds = np.array([[0.02, 0.08, 0.3], [0.5, 1.0, 2.0]])
    many = sheared_friction(shared, AsperityShear(speeds), FREQUENCY)
    assert many.shape == (2, 3, 4)
    for at in np.ndindex(2, 3):
        alone = sheared_friction(shared, AsperityShear(float(speeds[at])), FREQUENCY)
        assert many[at].tolist() == alone.tolist()


@pytest.mark.parametrize("heights", ["exponential", "gaussian"])
def test_asperities_pressed_too_hard_are_warned_of(table: FilmTable, heights: str) -> None:
    law = AsperityLaw(heights=heights)  # type: ignore[arg-type]
    most = law.largest_pressure
    # 1/e of the heights are above the gap at which that pressure is carried.
    gap = 1.0 if heights == "exponential" else 0.3374749
    assert most == pytest.approx(float(law.pressure(gap * law.decay_length)), rel=1e-6)
    share_load(table, law, 1e-8, 0.99 * most)
    with pytest.warns(OutOfRangeWarning, match="hold to"):
        share_load(table, law, 1e-8, np.array([1e3, 1.01 * most]))


def test_what_is_refused() -> None:
    with pytest.raises(InputError, match="speed"):
        AsperityShear(-0.1)
    with pytest.raises(InputError, match="stiffness"):
        AsperityShear(0.1, stiffness="soft")  # type: ignore[arg-type]
