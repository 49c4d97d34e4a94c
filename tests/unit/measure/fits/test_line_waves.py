"""Waves along a line: solutions of the beam's equation, and derivatives that are theirs."""

import numpy as np
import pytest

from squeezefilm.measure.fits.vibration.line_points import LineWaves

X = np.linspace(0, 80e-3, 4001)


@pytest.mark.parametrize("recorded", [True, False])
def test_every_column_is_a_free_bending_wave(recorded: bool) -> None:
    """The fourth derivative is k⁴ times the wave, where nothing is lost."""
    k, step = 280.0, X[1] - X[0]
    line = LineWaves(0.0, 80e-3, recorded, True)
    assert line.count == (2 if recorded else 1)
    waves = line.waves(X, np.array([k, 0.0])[: line.count])
    # By a coarse step, so that the last digits do not drown it.
    wide = waves[::20]
    fourth = (wide[:-4] - 4 * wide[1:-3] + 6 * wide[2:-2] - 4 * wide[3:-1] + wide[4:]) / (
        20 * step
    ) ** 4
    assert fourth == pytest.approx(k**4 * wide[2:-2], abs=5e-3 * k**4)


def test_derivatives_are_those_of_the_columns() -> None:
    line = LineWaves(0.0, 80e-3, True, True)
    at = np.array([280.0, 0.01])
    columns, bent = line.columns(X, at)
    assert bent.shape == (2, *columns.shape)
    step = np.array([1e-4, 0.0])
    slope = (line.waves(X, at + step) - line.waves(X, at - step)) / 2e-4
    assert bent[0] == pytest.approx(slope, abs=1e-5 * np.abs(slope).max())
