"""The headline of a prediction is the best place of its active area, on the solved shape."""

from __future__ import annotations

import dataclasses
import functools
from typing import Any

import numpy as np
import pytest

from squeezefilm.physics.chain.active_area import lowest
from squeezefilm.physics.chain.area_map import active_area, at_best_place
from squeezefilm.physics.chain.pad_law import PadLaw
from squeezefilm.physics.chain.pad_place import gauss_nodes
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.chain.wanted_voltage import voltage_for_friction
from squeezefilm.physics.contact.sharing.pad import pad_friction
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.surface_shape import surface_shape
from squeezefilm.physics.uncertainty.uncertainty import uncertain_friction

SOLVED = [
    "winfield2007-tpad",
    pytest.param("biet2008-plate", marks=pytest.mark.slow),
    pytest.param("touchpad-glass", marks=pytest.mark.slow),
]


@functools.cache
def predicted(name: str) -> Prediction:
    return predict(load_display(name))


# The headline.


@pytest.mark.parametrize("name", SOLVED)
def test_the_headline_is_the_best_of_the_active_area(name: str) -> None:
    p = predicted(name)
    area = active_area(load_display(name), p.mode, p.law, p.drive)
    assert area is not None
    assert p.place == area.best_place
    assert p.relative_friction == pytest.approx(area.best, abs=3e-5)
    _, lobe = area.of_note[0]
    assert p.vibration_amplitude == pytest.approx(lobe, rel=1e-5)
    assert p.place_summary()["is_best_of_area"]
    assert "best place of the active area" in p.place_said


@pytest.mark.slow
@pytest.mark.parametrize("name", SOLVED)
def test_the_interval_is_of_the_headline(name: str) -> None:
    p = predicted(name)
    found = uncertain_friction(load_display(name), p, samples=8)
    assert found.nominal == p.relative_friction
    low, high = found.interval
    assert low < p.relative_friction < high


def test_asked_for_by_its_place_the_headline_is_the_same() -> None:
    p = predicted("winfield2007-tpad")
    there = predict(load_display("winfield2007-tpad"), place=p.place)
    assert there.relative_friction == p.relative_friction
    assert there.vibration_amplitude == p.vibration_amplitude
    assert (p.place_was_asked, there.place_was_asked) == (False, True)


def test_of_a_pad_all_points_are_what_few_nodes_say() -> None:
    p = predicted("winfield2007-tpad")
    law, place = p.law, p.law.place
    assert place is not None
    _, met, shares = place.ridges(law.finger, law.contact_side)
    assert met.size > 5 * law.ridge_swings[0].size
    each = law.ridge_friction(p.vibration_amplitude * met)
    assert p.relative_friction == pytest.approx(float(each @ shares), abs=3e-8)
    assert law.mean_square == pytest.approx(float(met**2 @ shares), rel=1e-9)


@pytest.mark.parametrize("frequency", [None, pytest.param(25.9e3, marks=pytest.mark.slow)])
def test_an_answer_put_in_as_a_question_returns_itself(frequency: float | None) -> None:
    """By voltage, by amplitude and by friction, from each of them."""
    display = load_display("winfield2007-tpad")
    for volts in (0.3 * display.drive.voltage, display.drive.voltage):
        p = predict(display, voltage=volts, frequency=frequency)
        given = predict(display, vibration_amplitude=p.vibration_amplitude, frequency=frequency)
        assert given.place == p.place
        for name in ("relative_friction", "vibration_amplitude", "amplitude_at_place"):
            assert getattr(given, name) == pytest.approx(getattr(p, name), rel=1e-9)
        assert given.touch.free_amplitude == pytest.approx(p.touch.free_amplitude, rel=1e-9)
        found, amplitude = voltage_for_friction(display, p.relative_friction, frequency=frequency)
        assert found == pytest.approx(volts, rel=1e-9)
        assert amplitude == pytest.approx(p.vibration_amplitude, rel=1e-9)
    for wanted in (0.9, 0.5):
        volts, amplitude = voltage_for_friction(display, wanted, frequency=frequency)
        p = predict(display, voltage=volts, frequency=frequency)
        assert p.relative_friction == pytest.approx(wanted, rel=1e-9)
        assert p.vibration_amplitude == pytest.approx(amplitude, rel=1e-9)


def test_the_best_place_is_one_for_all_voltages() -> None:
    display = load_display("winfield2007-tpad")
    places = {predict(display, voltage=volts).place for volts in (0.0, 1.0, 20.0)}
    assert places == {predicted("winfield2007-tpad").place}


# Where no shape is solved, or the model knows none.


@pytest.mark.parametrize(
    ("name", "how"),
    [
        ("biet2008-plate", {"theory": "timoshenko"}),
        ("biet2008-stator", {"position": 0.0}),
        ("winfield2007-tpad", {"model": "paper2008"}),
        ("winfield2007-tpad", {"position": 0.0}),
    ],
)
def test_without_a_solved_shape_the_even_wave_stays_and_is_said(
    name: str, how: dict[str, Any]
) -> None:
    p = predict(load_display(name), **how)
    assert p.law.place is None
    assert p.place_summary()["is_on_even_wave"]
    assert "even wave" in p.place_said


def test_a_plate_that_hardly_moves_has_its_best_place_where_it_moves_most() -> None:
    display = load_display("winfield2007-tpad")
    p = predict(display, vibration_amplitude=1e-13)
    assert p.law.place is not None
    assert (p.law.place.x, p.law.place.y) == (0.0, 0.0)
    assert p.relative_friction == pytest.approx(1.0, abs=1e-4)


# The map.


def test_a_map_is_kept_whatever_place_its_law_has() -> None:
    p, display = predicted("winfield2007-tpad"), load_display("winfield2007-tpad")
    here = active_area(display, p.mode, p.law, p.drive)
    even = dataclasses.replace(p.law, place=None)
    assert active_area(display, p.mode, even, p.drive) is here
    law = at_best_place(display, p.mode, even)
    assert isinstance(law, PadLaw)
    assert law.place is not None
    assert (law.place.x, law.place.y) == p.place


def test_of_places_alike_the_one_that_moves_most_is_the_lowest() -> None:
    friction = np.array([[0.5, 0.3], [0.3 + 1e-12, np.nan]])
    assert lowest(friction, np.array([[3.0, 1.0], [-2.0, np.nan]])) == 2
    # And of those that move alike the first.
    assert lowest(friction, np.array([[3.0, 2.0], [2.0 + 1e-12, np.nan]])) == 1
    assert lowest(friction, np.zeros((2, 2))) == 1


@pytest.mark.parametrize(
    ("name", "theory"),
    [
        ("winfield2007-tpad", None),
        ("biet2008-stator", None),
        ("biet2008-plate", "timoshenko"),
        pytest.param("biet2008-plate", "solid", marks=pytest.mark.slow),
    ],
)
def test_a_grid_of_points_is_the_points_of_a_grid(name: str, theory: Any) -> None:
    display = load_display(name)
    shape = surface_shape(display.actuator, predict(display, theory=theory).mode)
    left, right, front, back = shape.bounds
    rng = np.random.default_rng(5)
    x, y = rng.uniform(left - 1e-3, right + 1e-3, 9), rng.uniform(front - 1e-3, back + 1e-3, 7)
    long, wide = rng.uniform(0.1e-3, 2e-3, 9), rng.uniform(0.1e-3, 2e-3, 7)
    expected = shape.under(x[:, None], y[None, :], long[:, None], wide[None, :])
    for found, by_points in zip(shape.under_grid(x, y, long, wide), expected, strict=True):
        assert found == pytest.approx(by_points, abs=1e-12)


# Few nodes for many ridges.


@pytest.mark.parametrize(("low", "size"), [(0.4, 8), (0.0, 24)])
def test_nodes_take_means_of_polynomials(low: float, size: int) -> None:
    values = np.random.default_rng(3).uniform(low, 1.0, 300)
    weights = np.random.default_rng(4).dirichlet(np.ones(values.size))
    nodes, shares = gauss_nodes(values, weights)
    assert nodes.size == size
    assert np.sum(shares) == pytest.approx(1.0)
    assert np.all((nodes >= np.min(values)) & (nodes <= np.max(values)))
    for degree in range(2 * size):
        assert shares @ nodes**degree == pytest.approx(weights @ values**degree, rel=1e-7)


def test_few_kinds_are_all_kept() -> None:
    nodes, shares = gauss_nodes(np.array([1.0, 0.5, 1.0, 0.9]), np.full(4, 0.25))
    assert nodes == pytest.approx([0.5, 0.9, 1.0])
    assert shares == pytest.approx([0.25, 0.25, 0.5])


@pytest.mark.parametrize("limit", ["own", "one-gap"])
def test_a_share_is_as_good_as_so_many_points(limit: Any) -> None:
    law = predicted("biet2008-stator").law
    swings = np.array([1.0, 0.8, 0.8, 0.3])
    pressure = law.finger.plateau_pressure(law.normal_force)

    def friction(swings: np.ndarray, shares: np.ndarray) -> float:
        found = pad_friction(law._films, law.asperities, 1e-6, swings, shares, pressure, limit)
        return float(found.relative_friction[0])

    few = friction(np.array([1.0, 0.8, 0.3]), np.array([1.0, 2.0, 1.0]))
    assert few == pytest.approx(friction(swings, np.ones(4)), abs=1e-12)
