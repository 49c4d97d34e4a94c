"""How like two percepts are, and surfaces matched with those recalled: the noise's own law."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy import stats

from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.physics.perception.percepts import Perceived
from squeezefilm.physics.perception.senses import Candidates
from squeezefilm.study.simulated.chain_tables import assumed, difference, recalled_distances
from squeezefilm.study.simulated.participants import SimulatedPeople

OBSERVER = dataclasses.replace(load_observer(), candidates=1)


def _one(strength: list[float], period: list[float]) -> Perceived:
    found = np.array(strength)
    return Perceived(np.log(period), found, found > 1.0)


def test_differences_are_in_standard_deviations_of_that_difference() -> None:
    skill, spread = np.full(2, 2.0), np.full(2, 0.1)
    a = _one([3.0, 0.5], [4e-3, 1e-3])
    assert difference(a, a, skill, spread) == 0.0
    # Strengths alone, where one of two is not felt; with the period where both are.
    b = _one([3.0, 2.5], [4e-3, 9e-3])
    assert difference(a, b, skill, spread) == pytest.approx(2.0 / (np.sqrt(2) * 2.0))
    c = _one([3.0, 0.5], [4e-3 * np.exp(0.3), 1e-3])
    assert difference(a, c, skill, spread) == pytest.approx(3.0 / (np.sqrt(2) * 2.0))
    assert difference(a, b, skill, spread) == difference(b, a, skill, spread)
    # What is less than nothing is nothing.
    none, less = _one([-np.inf, 0.0], [1.0, 1.0]), _one([-3.0, -1.0], [1.0, 1.0])
    assert difference(none, less, skill, spread) == 0.0


def _tables(d_prime: list[list[float]]) -> Any:
    """Surfaces of one rhythm in two directions each, on one display under one finger."""
    strengths = np.array(d_prime)[None, None, :, :, None]
    return SimpleNamespace(
        virtual=Candidates(np.full(strengths.shape, 4e-3), strengths), observer=OBSERVER
    )


def _distances(d_prime: list[list[float]], stimulus: int, people: int) -> np.ndarray:
    asked = 400
    found, _ = recalled_distances(
        _tables(d_prime),
        np.zeros((people, asked), dtype=np.int64),
        np.zeros(people, dtype=np.int64),
        np.full((people, asked), stimulus),
        np.ones((people, asked)),
        np.full((people, 1), 0.09),
        np.random.default_rng(7),
        20,
    )
    return found


def test_the_same_surface_differs_by_noise_alone() -> None:
    # Far above the criterion, strengths and periods of both directions: four squares of a normal.
    # A period's spread grows by √(1 + 1/d′²), by half a per cent at d′ = 10.
    found = _distances([[10.0, 10.0], [30.0, 30.0]], 0, 20)[..., 0].ravel() ** 2
    assert stats.kstest(found, stats.chi2(4).cdf).pvalue > 0.001
    assert found.mean() == pytest.approx(4.0, rel=0.04)


def test_surfaces_far_apart_are_never_confused_and_equal_ones_by_chance() -> None:
    apart = _distances([[3.0, 3.0], [30.0, 3.0], [3.0, 30.0]], 1, 20)
    assert np.all(np.argmin(apart, axis=-1) == 1)
    alike = np.argmin(_distances([[10.0, 10.0]] * 4, 2, 20), axis=-1)
    share = np.bincount(alike.ravel(), minlength=4) / alike.size
    assert share == pytest.approx([0.25] * 4, abs=0.025)


def test_nobody_depends_on_how_many_there_are() -> None:
    few, many = (
        _distances([[2.0, 1.0], [1.0, 2.0]], 0, 3),
        _distances([[2.0, 1.0], [1.0, 2.0]], 0, 20),
    )
    assert np.array_equal(few, many[:3])


def test_everybody_has_noise_in_each_direction() -> None:
    people = SimulatedPeople.drawn(OBSERVER, 6, 3, 11, 1, 2)
    assert people.noise.shape == (3, 2, 60, 2, OBSERVER.candidates)
    few = SimulatedPeople.drawn(OBSERVER, 6, 3, 11, 1, 2, count=7)
    assert np.array_equal(few.noise, people.noise[:, :, :7])
    assert np.array_equal(few.slowness, people.slowness[:, :7])


def test_what_is_assumed_is_said_for_each_way_of_exploring() -> None:
    from tests.unit.study.design.test_matching import shapes

    said = assumed(shapes())
    assert any("plain hand" in one for one in said)
    assert any("recalled" in one for one in said)
