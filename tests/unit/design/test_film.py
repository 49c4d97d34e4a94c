"""`squeezefilm film`: which films make a map, what is told meanwhile, and what is refused."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.design.film import FilmRequest, solve_film, sweep_film
from squeezefilm.physics.film.periodic import batch


def test_a_map_is_of_all_films_of_six_decades(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: dict[str, Any] = {}

    def solved(sigma: Any, excursion: Any, *, progress: Any, **how: Any) -> Any:
        asked.update(how)
        for done in (0, 100, 244, 250, 1000, 2440):
            progress(done, 2440)
        every = sigma * excursion
        names = ["over_pressure_error", "stiffness_relative", "damping_relative", "force_error"]
        rest = {name: k * every for k, name in enumerate(names, 2)}
        return SimpleNamespace(over_pressure=every, model="a model", **rest)

    monkeypatch.setattr(batch, "solve_films", solved)
    told: list[str] = []
    request = FilmRequest("disc", 1.0, 1.2, 0.1, "second", 3e-3)
    found = sweep_film(request, progress=told.append)
    assert asked == {
        "shape": "disc", "polytropic_exponent": 1.2, "knudsen_number": 0.1, "slip": "second",
        "tolerance": 3e-3, "force": True,
    }  # fmt: skip
    sigma, excursion = found.squeeze_number, found.excursion_ratio
    assert (sigma[0], sigma[-1]) == pytest.approx((0.01, 1e4))
    # Ten films a decade, each a tenth of it from the next.
    assert np.diff(np.log10(sigma)) == pytest.approx(0.1)
    assert (excursion[0], excursion[-1]) == pytest.approx((0.02, 0.95))
    assert np.diff(excursion) == pytest.approx(0.93 / 39)
    assert found.over_pressure == pytest.approx(sigma[:, None] * excursion)
    for k, name in enumerate(
        ("over_pressure_error", "stiffness_relative", "damping_relative", "force_error"), 2
    ):
        assert getattr(found, name) == pytest.approx(k * found.over_pressure)
    # Each tenth is told once.
    assert told == [f"{done} of 2440 films" for done in (0, 244, 1000, 2440)]
    summary = found.summary()
    assert summary["request"]["shape"] == "disc"
    assert len(summary["over_pressure"]) == len(sigma)
    sweep_film(request)


@pytest.mark.parametrize("shape", ["rectangle", "ellipse"])
def test_a_map_in_the_plane_is_refused(shape: str) -> None:
    with pytest.raises(InputError, match=f"shape '{shape}' would take minutes; sweep knows strip"):
        sweep_film(FilmRequest(shape))


def test_a_gap_of_ones_own_is_under_a_strip() -> None:
    with pytest.raises(InputError, match="solved under a strip, not under a disc"):
        solve_film(10.0, lambda x, t: 1 + 0.1 * np.cos(t) + 0 * x, shape="disc")
