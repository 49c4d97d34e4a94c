"""Which plates a calibration solves: over the priors, and once more where the data point."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.measure.calibration import plate_fit
from squeezefilm.measure.calibration.plate_fit import fitted_plate


class Solves:
    """Solves nothing; keeps what it is asked."""

    every: list[Solves]
    error = 0.0

    def __init__(self, display: Any, scores: Any, observations: Any) -> None:
        self.given = display, observations
        self.points: list[Any] = []
        self.refused = 3 * ["no such mode"]
        self.added: list[tuple[str, Any]] = []
        self.every.append(self)

    def add(self, points: Any, said: str, tell: Any) -> None:
        """Keep them; the half of it is told."""
        self.added.append((said, points))
        self.points += list(points)
        tell(said, 0.5)

    def require_enough(self) -> None:
        """There are."""
        self.added.append(("enough", None))

    def problem(self, observations: Any) -> Any:
        """Two observations with a standard error of 1, of the second and third answers."""
        emulator = SimpleNamespace(errors=np.array([9.0, 0.1, self.error]))
        return SimpleNamespace(
            emulator=emulator, columns=np.array([1, 2]), noise=np.ones(2), of=len(self.points)
        )


@pytest.fixture
def sampled(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Any, dict[str, Any]]]:
    """The posteriors that are sampled: all at 5 in each score."""
    asked: list[tuple[Any, dict[str, Any]]] = []

    def posterior(problem: Any, **how: Any) -> Any:
        asked.append((problem, how))
        return SimpleNamespace(scores=np.full((50, 2), 5.0))

    Solves.every = []
    monkeypatch.setattr(plate_fit, "Solves", Solves)
    monkeypatch.setattr(plate_fit, "NormalScores", lambda parameters: parameters)
    monkeypatch.setattr(plate_fit, "sampled_posterior", posterior)
    monkeypatch.setattr(plate_fit, "predictive", lambda *said, seed: (said, seed))
    return asked


def fitted(told: list[tuple[str, float]], size: tuple[int, int] | None = (6, 4)) -> Any:
    display: Any = "display"
    parameters: Any = ("a", "b")
    observations: Any = ("seen",)
    return fitted_plate(
        display, parameters, observations, seed=3, size=size,
        progress=lambda text, share: told.append((text, share)),
    )  # fmt: skip


def test_an_emulator_that_is_good_enough_is_asked_once(sampled: list[Any]) -> None:
    # 0.3 of a standard error is.
    Solves.error = 0.3
    told: list[tuple[str, float]] = []
    found = fitted(told)
    (solves,) = Solves.every
    assert solves.given == ("display", ("seen",))
    assert [said for said, _ in solves.added] == ["over the priors", "enough"]
    assert solves.added[0][1] == pytest.approx(plate_fit.prior_scores(2, 6, 3))
    assert len(sampled) == 2
    assert sampled[0][1] == {"seed": 3, "steps": 600}
    # Six of ten plates, of the time but for the twentieth that the posterior takes.
    assert told == [("over the priors", pytest.approx(0.285)), ("emulator", pytest.approx(0.57))]
    assert found.problem is sampled[1][0]
    # Solved and lost.
    assert found.solves == 6 + 3
    sampled[1][1]["progress"]("posterior", 0.5)
    assert told[-1] == ("posterior", pytest.approx(0.975))


def test_one_that_widens_what_is_observed_is_made_better_where_the_data_point(
    sampled: list[Any],
) -> None:
    Solves.error = 0.31
    told: list[tuple[str, float]] = []
    found = fitted(told)
    (solves,) = Solves.every
    said, points = solves.added[2]
    assert said == "where the data point"
    assert points.shape == (4, 2)
    # About the first posterior, a little wider: a quarter of a score.
    assert np.all(np.abs(points - 5.0) < 1.25)
    assert 0.05 < np.std(points) < 0.6
    assert told[2:] == [
        ("where the data point", pytest.approx((0.57 + 0.95) / 2)),
        ("emulator", pytest.approx(0.95)),
    ]
    assert (found.problem.of, found.solves) == (10, 13)


def test_without_a_second_round_none_is_made(sampled: list[Any]) -> None:
    Solves.error = 9.0
    fitted([], (6, 0))
    assert len(Solves.every[0].points) == 6
    fitted([], None)
    assert len(Solves.every[1].points) == sum(plate_fit.design_sizes(2))
