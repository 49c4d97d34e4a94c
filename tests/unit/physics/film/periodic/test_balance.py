"""The load balance on an over-pressure known in closed form: no film is solved."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError, OutOfRangeError, UnreachableError
from squeezefilm.physics.film.periodic import balance
from squeezefilm.physics.film.periodic.balance import VibratedFilm, mean_gap_for_load

GIVEN: dict[str, Any] = {"viscosity": 1.8e-5, "ambient_pressure": 1e5}
FILM = VibratedFilm(2e-6, 40e3, 10e-3, **GIVEN)


class Films:
    """W − 1 = 0.2 ε^1.5, with an error of a thousandth; takes down what it was asked."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, noise: float = 0.0) -> None:
        self.asked: list[tuple[np.ndarray, np.ndarray, dict[str, Any]]] = []
        self.shapes: list[str] = []

        def solve(sigma: Any, eps: Any, *, shape: str, **rest: Any) -> SimpleNamespace:
            self.asked.append((np.array(sigma), np.array(eps), rest))
            self.shapes.append(shape)
            over = 0.2 * np.asarray(eps) ** 1.5
            return SimpleNamespace(
                over_pressure=over, over_pressure_error=1e-3 * over + noise, model="made"
            )

        monkeypatch.setattr(balance, "solve_films", solve)


@pytest.mark.parametrize("shape", ["strip", "disc"])
@pytest.mark.parametrize("load", [1.0, 3e2, 1.7e4])
def test_the_gap_found_carries_the_load(
    monkeypatch: pytest.MonkeyPatch, load: float, shape: str
) -> None:
    films = Films(monkeypatch)
    film = VibratedFilm(
        2e-6, 40e3, 10e-3, polytropic_exponent=1.4, mean_free_path=7e-8, slip="second",
        shape=shape, **GIVEN,
    )  # fmt: skip
    found = mean_gap_for_load(film, load, tolerance=1e-4)
    eps = (load / 1e5 / 0.2) ** (1 / 1.5)
    assert found.excursion_ratio == pytest.approx(eps, rel=1e-4)
    assert found.mean_gap == pytest.approx(2e-6 / eps, rel=1e-4)
    assert found.least_gap == found.mean_gap - 2e-6
    assert found.mean_load_pressure == pytest.approx(load, rel=1e-4)
    assert found.mean_load_pressure_error == pytest.approx(1e-3 * load, rel=1e-3)
    # The load goes with h^−1.5.
    assert found.static_stiffness == pytest.approx(1.5 * load / found.mean_gap, rel=1e-3)
    assert found.mean_gap_error == pytest.approx(found.mean_gap * 1e-3 / 1.5, rel=0.1)
    sigma = 12 * 1.8e-5 * 2 * math.pi * 40e3 * 1e-4 / 1e5 / found.mean_gap**2
    assert found.squeeze_number == pytest.approx(sigma)
    assert found.knudsen_number == pytest.approx(7e-8 / found.mean_gap)
    assert (found.load, found.film, found.model) == (load, film, "made")
    assert set(films.shapes) == {shape}
    assert found.iterations == 24 + 3 * (len(films.asked) - 2)
    assert f"after {found.iterations} film solves" in found.status
    for squeeze, excursion, rest in films.asked:
        gap = 2e-6 / excursion
        assert squeeze == pytest.approx(12 * 1.8e-5 * 8e4 * math.pi * 1e-4 / 1e5 / gap**2)
        assert rest["knudsen_number"] == pytest.approx(7e-8 / gap)
        assert (rest["polytropic_exponent"], rest["slip"]) == (1.4, "second")


@pytest.mark.parametrize(
    ("load", "says"),
    [
        # 0.2 · 0.95^1.5 of 100 kPa, and 0.2 · 0.001^1.5 of it.
        (18.6e3, r"more than the film carries at excursion_ratio 0\.95 .*: 18\.52 kPa"),
        (0.6, r"less than the film carries at excursion_ratio 0\.001 .*: 632\.5 mPa"),
    ],
)
def test_loads_beyond_both_ends_are_out_of_reach(
    monkeypatch: pytest.MonkeyPatch, load: float, says: str
) -> None:
    Films(monkeypatch)
    with pytest.raises(UnreachableError, match=says):
        mean_gap_for_load(FILM, load)


def test_the_faint_end_is_left_out_and_a_film_lost_in_rounding_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # With an error of 1e-5 beside it, less than 2.04e-4 is unknown by more than a twentieth.
    Films(monkeypatch, noise=1e-5)
    assert mean_gap_for_load(FILM, 40.0).excursion_ratio == pytest.approx(
        0.002 ** (1 / 1.5), rel=1e-3
    )
    with pytest.raises(UnreachableError, match="less than the film carries"):
        mean_gap_for_load(FILM, 15.0)
    Films(monkeypatch, noise=1.0)
    with pytest.raises(OutOfRangeError, match="lost in rounding"):
        mean_gap_for_load(FILM, 40.0)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"shape": "square"}, "Allowed: strip, disc"),
        ({"amplitude": 0.0}, "amplitude"),
        ({"frequency": 0.0}, "frequency"),
        ({"length": 0.0}, "length"),
        ({"viscosity": 0.0}, "viscosity"),
        ({"ambient_pressure": 0.0}, "ambient_pressure"),
        ({"mean_free_path": -1e-9}, "mean_free_path"),
    ],
)
def test_what_no_film_has_is_refused(changes: dict[str, Any], says: str) -> None:
    good: dict[str, Any] = {"amplitude": 2e-6, "frequency": 40e3, "length": 10e-3}
    with pytest.raises(InputError, match=says):
        VibratedFilm(**{**good, **changes})
