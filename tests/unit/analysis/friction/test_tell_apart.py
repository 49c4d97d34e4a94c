"""Telling laws apart: discriminability of made-up laws, and what of the finger cancels."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.analysis.friction import tell_apart as room
from squeezefilm.analysis.friction.tell_apart import AMPLITUDES, FORCES, NOISE, SPEEDS, tell_apart
from squeezefilm.chain.prediction import Prediction, predict
from squeezefilm.display import load_display
from squeezefilm.errors import InputError, OutOfRangeError

STATOR = load_display("biet2008-stator")


@pytest.fixture(scope="module")
def point() -> Prediction:
    return predict(STATOR, vibration_amplitude=2e-6)


GRID = (FORCES.size, SPEEDS.size, AMPLITUDES.size)


def made(friction: Any, monkeypatch: pytest.MonkeyPatch, point: Prediction, draws: int = 8) -> Any:
    """`tell_apart` with µ′/µ over the grid by a function of law, shear, draw and force."""

    def frictions(mixture: Any, points: Any, heights: Any, shears: Any, tell: Any) -> Any:
        found = np.empty((3, 3, len(points), *GRID))
        for i, height in enumerate(heights.options):
            for j, shear in enumerate(shears.options):
                for k in range(len(points)):
                    found[i, j, k] = friction(height.name, shear.name, k)
        return found

    monkeypatch.setattr(room, "_frictions", frictions)
    return tell_apart(STATOR, point, draws=draws)


def test_laws_are_told_apart_where_they_differ_most(
    point: Prediction, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Gaussian differs at one condition alone; the shear nowhere."""

    def friction(height: str, shear: str, k: int) -> np.ndarray:
        found = np.full(GRID, 0.5)
        if height == "gaussian":
            found[1, 2, 3] = 0.6
        return found

    found = made(friction, monkeypatch, point)
    one = found.best[found.pairs.index(("persson", "gaussian"))]
    at = one.condition
    assert (at.normal_force, at.speed, at.amplitude) == (FORCES[1], SPEEDS[2], AMPLITUDES[3])
    # No finger differs from another: the measurement alone scatters.
    d = 0.1 / (NOISE * np.sqrt((0.5**2 + 0.6**2) / 2))
    assert one.discriminability == pytest.approx(d)
    assert one.means == pytest.approx((0.5, 0.6))
    # Φ(d/2), d = 3.62.
    assert one.right == pytest.approx(0.965, abs=1e-3)
    for pair in (("persson", "exponential"), ("following", "rigid")):
        assert found.best[found.pairs.index(pair)].right == 0.5
    heights, shears = found.overall
    assert (heights.least, shears.least) == (0.5, 0.5)
    assert found.discriminability.shape == (6, *GRID)


def test_what_a_finger_does_everywhere_cancels_in_a_ratio(
    point: Prediction, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Fingers differ by a factor of two, the shear by a tenth at one speed."""

    def friction(height: str, shear: str, k: int) -> np.ndarray:
        found = np.full(GRID, 0.2 if k % 2 else 0.4)
        if shear == "rigid":
            found[:, 3] *= 1.3
        return found

    found = made(friction, monkeypatch, point)
    one = found.best[found.pairs.index(("following", "rigid"))]
    # The deviation of the fingers, 0.1 and 0.13, is as large as what is looked for.
    assert one.discriminability < 0.8
    assert one.ratio_discriminability == pytest.approx(np.log(1.3) / (NOISE * np.sqrt(2)))
    assert sorted(one.ratio_means) in (
        pytest.approx([1, 1.3]), pytest.approx([1 / 1.3, 1]),
    )  # fmt: skip
    assert SPEEDS[3] in {at.speed for at in one.ratio}
    assert one.ratio_right > 0.95 > one.right


def test_where_draws_are_refused_nothing_is_said(
    point: Prediction, monkeypatch: pytest.MonkeyPatch
) -> None:
    def friction(height: str, shear: str, k: int) -> np.ndarray:
        found = np.full(GRID, 0.5)
        if height == "exponential" and k == 0:
            found[3] = np.nan
        return found

    found = made(friction, monkeypatch, point)
    assert np.isnan(found.discriminability[:, 3]).all()
    assert np.isfinite(found.discriminability[:, :3]).all()
    assert found.summary()["discriminability"][0]["d"][3][0][0] is None
    with pytest.raises(InputError, match="nowhere on the grid"):
        made(lambda *_: np.full(GRID, np.nan), monkeypatch, point)


def test_a_model_that_settles_the_shear_leaves_nothing_to_tell() -> None:
    rigid = predict(STATOR, vibration_amplitude=2e-6, model="partial-levitation")
    with pytest.raises(InputError, match="nothing to tell apart"):
        tell_apart(STATOR, rigid)


def test_a_refused_amplitude_ends_the_row(monkeypatch: pytest.MonkeyPatch) -> None:
    class Law:
        finger = SimpleNamespace(tangential_stiffness="following")

        def over_speeds(self, amplitude: Any, speed: Any, limit: str) -> Any:
            if amplitude.max() > 2.5e-6:
                raise OutOfRangeError("pressed through")
            return np.full((speed.size, amplitude.size), 0.4 if limit == "own" else 0.2)

    rows = room._over_grid(Law(), 0.5)  # type: ignore[arg-type]
    assert rows[:, :3] == pytest.approx(np.full((SPEEDS.size, 3), 0.3))
    assert np.isnan(rows[:, 3]).all()


@pytest.mark.slow
def test_a_slow_stroke_tells_the_shear_elements_of_the_stator_apart(point: Prediction) -> None:
    """Rigid shear does not know speed: the ratio of two speeds settles it; no height law is told
    from another by one measurement."""
    found = tell_apart(STATOR, point, draws=4)
    best = dict(zip(found.pairs, found.best, strict=True))
    assert best["following", "rigid"].ratio_right > 0.95
    assert best["following", "rigid"].condition.speed == SPEEDS[0]
    assert best["persson", "exponential"].right < 0.7
