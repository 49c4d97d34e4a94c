"""Which gratings survive."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.design.analysis.felt import what_survives
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.display import load_display


@pytest.fixture(scope="module")
def plate() -> Prediction:
    """The paper's plate at 15 V."""
    return predict(load_display("biet2008-plate"))


def test_the_papers_periods_by_exploring_speeds(plate: Prediction) -> None:
    """The paper's plate: 0.4 mm at 119 mm/s keeps 90 % of its swing and 68 % of its fundamental."""
    tau = plate.envelope_time_constant
    left = what_survives(plate, tau)
    assert left is not None
    assert (left.kept, left.fundamental) == (0.9, pytest.approx(0.684, abs=1e-3))
    assert left.fastest_speed[0] == pytest.approx(0.1195, abs=5e-4)
    just = left.finest_period / (4 * tau * left.speeds)
    assert np.tanh(just) == pytest.approx(np.full(5, 0.9))
    assert left.spatial_periods / left.fastest_speed == pytest.approx(
        left.finest_period / left.speeds
    )


def test_without_a_voltage_or_a_friction_that_changes_nothing_is_said() -> None:
    display = load_display("biet2008-plate")
    still = predict(display, voltage=0.0)
    assert what_survives(still, 1e-3) is None
