"""How people differ: the friction at rest that goes with a length of a person."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import qmc

from squeezefilm.core.distributions import LogNormal
from squeezefilm.physics.contact.finger.fingertip import (
    CORRELATION,
    DECAY_LENGTH_SPREAD,
    REST_FRICTION_SPREAD,
    rest_friction_factor,
)


def test_drawn_people_spread_and_correlate_as_the_published_ones() -> None:
    points = qmc.Sobol(2, seed=1).random(2**12)
    length = LogNormal(1.0, DECAY_LENGTH_SPREAD).quantile(points[:, 0])
    rest = rest_friction_factor(np.clip(points[:, 1], 1e-9, 1 - 1e-9), length)
    logs = np.log([length, rest])
    assert np.median(rest) == pytest.approx(1, rel=0.02)
    assert np.std(logs[1]) == pytest.approx(REST_FRICTION_SPREAD, rel=0.02)
    assert np.corrcoef(logs)[0, 1] == pytest.approx(CORRELATION, abs=0.02)
