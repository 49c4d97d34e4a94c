"""The value of a measurement, where it can be computed by hand."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.measure.calibration.identified import (
    Candidate,
    candidates,
    friction_candidate,
    ranked,
)


def test_what_is_left_of_a_gaussian() -> None:
    """Friction and a reading with correlation ρ and noise s: √(1 − ρ²/(1 + s²)) is left."""
    random = np.random.default_rng(1)
    reading, other = random.normal(size=(2, 4000))
    friction = 0.9 * reading + np.sqrt(1 - 0.81) * other
    options = [
        Candidate("idle", "", random.normal(size=4000), 0.3),
        Candidate("telling", "", reading, 0.5),
    ]
    first, second = ranked(friction, options, seed=2)
    assert first.name == "telling"
    assert first.left == pytest.approx(np.sqrt(1 - 0.81 / 1.25), abs=0.06)
    assert second.left == pytest.approx(1.0, abs=0.03)
    assert "expected to leave" in first.sentence


def test_candidates_have_accuracies() -> None:
    found = candidates({"mass": np.array([1.0, 1.1]), "unknown": np.array([1.0, 1.1])})
    assert [one.name for one in found] == ["mass on a balance"]
    assert "2 µm" in friction_candidate(np.ones(2), 2e-6).name
