"""Draws that are found on disk in place of being drawn again."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.kept.store import CACHE_VARIABLE
from squeezefilm.design.analysis import area_odds, felt
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.uncertainty import intervals
from squeezefilm.physics.uncertainty.draws import Mixture
from squeezefilm.physics.uncertainty.uncertainty import sobol_points

STATOR = load_display("biet2008-stator")


def _mixture(display: Display, **other: float) -> Mixture:
    return Mixture(display, predict(display, **other), driven=True)  # type: ignore[arg-type]


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[int]:
    """How many draws were drawn, each time that some were."""
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path))
    found: list[int] = []
    draw = intervals._drawn_now

    def counted(mixture: Mixture, points: np.ndarray, new: np.ndarray, *rest: object) -> object:
        found.append(new.size)
        return draw(mixture, points, new, *rest)  # type: ignore[arg-type]

    monkeypatch.setattr(intervals, "_drawn_now", counted)
    return found


def test_the_same_draws_are_found_by_another_mixture(calls: list[int]) -> None:
    points = sobol_points(_mixture(STATOR), 128, 1)
    first, refused = intervals.evaluate(_mixture(STATOR), points, lambda _: None)
    again, refused_again = intervals.evaluate(_mixture(STATOR), points, lambda _: None)
    assert calls == [128]
    for one, other in zip(first, again, strict=True):
        assert np.array_equal(one, other, equal_nan=True)
    assert refused == refused_again or refused.count == refused_again.count


def test_whatever_draws_come_from_makes_them_others(calls: list[int]) -> None:
    points = sobol_points(_mixture(STATOR), 128, 1)
    finger = dataclasses.replace(STATOR.finger, plateau_width=240e-6)
    narrower = dataclasses.replace(
        STATOR,
        provenance={
            path: dataclasses.replace(one, evidence="measured")
            for path, one in STATOR.provenance.items()
        },
    )
    others = (
        _mixture(STATOR),
        _mixture(dataclasses.replace(STATOR, finger=finger)),
        _mixture(STATOR, normal_force=0.6),
        _mixture(STATOR, speed=0.02),
        _mixture(STATOR, vibration_amplitude=1.5e-6),
    )
    asked = {intervals.hash_of_draws(one, points) for one in others}
    assert len(asked) == len(others)
    # A range is a part of what is drawn, though displays of other ranges count as equal.
    measured = _mixture(narrower)
    assert intervals.hash_of_draws(measured, points[:, : len(measured.inputs)]) not in asked
    assert intervals.hash_of_draws(others[0], points[:64]) not in asked
    assert calls == []


def test_few_draws_are_not_kept(calls: list[int], tmp_path: Path) -> None:
    points = sobol_points(_mixture(STATOR), 16, 1)
    for _ in range(2):
        intervals.evaluate(_mixture(STATOR), points, lambda _: None)
    assert calls == [16, 16]
    assert not (tmp_path / "draws").exists()


@pytest.mark.slow
def test_felt_gratings_and_odds_over_the_area_are_found_again(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path))
    plate, called = load_display("biet2008-plate"), []
    monkeypatch.setattr(intervals, "_drawn_now", _told(intervals._drawn_now, "interval", called))
    monkeypatch.setattr(felt, "_felt_of_draws", _told(felt._felt_of_draws, "felt", called))
    monkeypatch.setattr(area_odds, "_drawn", _told(area_odds._drawn, "area", called))
    found = []
    for force in (0.5, 0.5, 0.6):
        prediction = predict(plate, normal_force=force)
        area = area_odds.judged_area(plate, prediction, samples=32)
        gratings = felt.felt_gratings(plate, prediction, draws=16)
        assert area is not None
        assert area.odds is not None
        assert gratings is not None
        found.append((area.odds.summary(), gratings.summary()))
    assert called == 2 * ["interval", "area", "felt"]
    assert found[0] == found[1] != found[2]


def _told(function: Callable[..., Any], name: str, called: list[str]) -> Callable[..., Any]:
    def told(*arguments: Any) -> Any:
        called.append(name)
        return function(*arguments)

    return told
