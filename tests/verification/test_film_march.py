"""The oracle of the film solvers, the march in time: tables, measured orders, gas kept."""

from __future__ import annotations

import numpy as np
import pytest
from tests.film_march import settle_to_periodic, uniform_gap

from squeezefilm.physics.film.gas import FilmGas


@pytest.mark.parametrize(
    ("excursion", "squeeze_number", "expected"),
    [
        (0.1, 1.0, 1.000108),
        (0.1, 10.0, 1.005188),
        (0.1, 100.0, 1.010778),
        (0.5, 1.0, 1.009029),
        (0.5, 10.0, 1.160251),
        (0.5, 100.0, 1.307197),
        (0.9, 1.0, 1.373299),
        (0.9, 10.0, 2.333313),
        (0.9, 100.0, 3.148871),
    ],
)
def test_the_strip_settles_to_the_tabulated_load(excursion, squeeze_number, expected):
    film = settle_to_periodic(uniform_gap(excursion), squeeze_number, tolerance=2e-4)
    rounding = 5e-7
    assert abs(1 + film.over_pressure - expected) <= film.error + rounding
    assert film.error <= 2e-4 * film.over_pressure


@pytest.mark.parametrize(
    ("squeeze_number", "expected"), [(1.0, 1.018267), (10.0, 1.196820), (100.0, 1.306992)]
)
def test_the_disc_settles_to_the_tabulated_load(squeeze_number, expected):
    film = settle_to_periodic(uniform_gap(0.5), squeeze_number, shape="disc", tolerance=2e-4)
    assert abs(1 + film.over_pressure - expected) <= film.error + 5e-7


@pytest.mark.parametrize(
    ("gas", "expected"), [(FilmGas(1.4), 1.173567), (FilmGas(knudsen_number=0.026), 1.139260)]
)
def test_polytropic_gas_and_slip_reach_the_tabulated_load(gas, expected):
    film = settle_to_periodic(uniform_gap(0.5), 10.0, gas=gas, tolerance=2e-4)
    assert 1 + film.over_pressure == pytest.approx(expected, abs=2e-5)


def test_large_squeeze_numbers_follow_the_edge_layer_law():
    film = settle_to_periodic(uniform_gap(0.5), 1e4, tolerance=1e-3)
    assert film.over_pressure == pytest.approx(0.354006 - 0.46890 / 100.0, abs=2e-5)


@pytest.mark.parametrize("shape", ["strip", "disc"])
@pytest.mark.parametrize(
    ("refined", "counts", "fine"),
    [("steps", (32, 64, 128), (1024, 2048)), ("cells", (16, 32, 64), (256, 512))],
)
def test_time_and_space_are_of_second_order(shape, refined, counts, fine):
    def load(count: int) -> float:
        asked = {"steps": 32, "cells": 32} | {refined: count}
        film = settle_to_periodic(uniform_gap(0.5), 10.0, tolerance=None, shape=shape, **asked)
        return film.over_pressure

    exact = (4 * load(fine[1]) - load(fine[0])) / 3
    errors = [abs(load(count) - exact) for count in counts]
    order = np.log2(errors[-2] / errors[-1])
    # The mean over a period may converge faster than its loads do.
    assert order > 1.9


def test_no_gas_is_lost_over_a_settled_period():
    rare = FilmGas(knudsen_number=0.02)
    film = settle_to_periodic(uniform_gap(0.7), 30.0, gas=rare, tolerance=1e-3)
    assert film.mass_residual < 1e-9


def test_sealed_grooves_of_the_paper_s_finger():
    whole = 0.6 + 2.0 + 50.0
    wave, ridges = 2 * np.pi * 10.0 / 18.7, 2 * np.pi * 10.0 / 0.35

    def gap(X, T):
        return 1.0 + (2 * np.cos(wave * X) * np.cos(T) + 50 * np.cos(ridges * X)) / whole

    film = settle_to_periodic(gap, 20.418, cells=200, steps=32, tolerance=1e-3)
    assert film.over_pressure == pytest.approx(7.246e-3, rel=1e-3)
