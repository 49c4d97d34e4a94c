"""Runs of a path: straight stretches one way, whatever the axes."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from squeezefilm.physics.perception.path_percepts import straight_runs
from squeezefilm.physics.render.motion.stroke import FingerPath, MinimumJerkStroke


def _path(corners: list[tuple[float, float]], each: int = 50) -> FingerPath:
    places = np.array(corners)
    share = np.linspace(0, 1, each, endpoint=False)[:, None]
    parts = [a + share * (b - a) for a, b in itertools.pairwise(places)]
    points = np.concatenate([*parts, places[-1:]])
    return FingerPath(0.01 * np.arange(len(points)), points[:, 0], points[:, 1])


SQUARE = [(0, 0), (0.03, 0), (0.03, 0.02), (0, 0.02), (0, 0)]


def test_strokes_there_and_back_are_one_run_each() -> None:
    stroke = MinimumJerkStroke(0.04, 0.5, 3)
    t = np.linspace(0, stroke.duration, 151)
    runs = straight_runs(FingerPath(t, stroke.position(t), np.zeros(t.size)))
    assert [run.length for run in runs] == pytest.approx([0.04] * 3)
    assert [math.cos(run.heading) for run in runs] == pytest.approx([1, -1, 1])


def test_corners_cut_and_directions_are_told() -> None:
    runs = straight_runs(_path(SQUARE))
    assert [run.along_x for run in runs] == [True, False, True, False]
    assert [run.length for run in runs] == pytest.approx([0.03, 0.02, 0.03, 0.02], abs=1e-9)


@pytest.mark.parametrize("angle", [0.3, 1.1, 2.5])
def test_turning_path_and_axes_together_changes_nothing(angle: float) -> None:
    c, s = math.cos(angle), math.sin(angle)
    turned = [(c * x - s * y + 0.01, s * x + c * y - 0.02) for x, y in SQUARE]
    here, there = straight_runs(_path(SQUARE)), straight_runs(_path(turned))
    assert [(a.begin, a.end) for a in here] == [(b.begin, b.end) for b in there]
    apart = [
        math.remainder(b.heading - a.heading - angle, math.tau)
        for a, b in zip(here, there, strict=True)
    ]
    assert apart == pytest.approx([0] * 4, abs=1e-9)


def test_noise_below_a_millimetre_cuts_nothing_and_a_curve_is_cut() -> None:
    straight = _path([(0, 0), (0.04, 0.01)], 400)
    noise = np.random.default_rng(3).normal(0, 2e-5, (2, straight.x.size))
    noisy = FingerPath(straight.time, straight.x + noise[0], straight.y + noise[1])
    assert len(straight_runs(noisy)) == 1
    around = np.linspace(0, 2 * math.pi, 400)
    circle = FingerPath(around, 0.02 * np.cos(around), 0.02 * np.sin(around))
    runs = straight_runs(circle)
    # A chord of half-angle a strays from its arc by r (1 − cos a): a millimetre at 18.2°.
    assert len(runs) >= 360 / (2 * 18.2)
    assert all(run.length <= 2 * 0.02 * math.sin(math.radians(18.2)) * 1.01 for run in runs)


def test_what_is_too_short_is_no_run() -> None:
    assert straight_runs(_path([(0, 0), (0.0035, 0), (0, 0)])) == ()
