"""What a texture of places alone was made for, and what it costs under another speed."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.program.renderer import MadeForSpeed

AMPLITUDE = np.array([0.0, 1e-6, 2e-6])


def stickier_when_fast(amplitude: np.ndarray, speed: np.ndarray) -> np.ndarray:
    return 1.0 - 0.1 * amplitude / 1e-6 / (speed / 0.1)


def test_the_largest_miss_at_half_and_at_double_the_speed_is_stated_with_its_sign() -> None:
    made = MadeForSpeed.of(stickier_when_fast, AMPLITUDE, 0.1)
    # 1 - 0.4, 1 - 0.2 and 1 - 0.1 at the largest amplitude.
    assert (made.error_at_half, made.error_at_double) == pytest.approx((-0.2, 0.1))
    assert made.summary() == {
        "made_for_speed_m_per_s": 0.1,
        "friction_error_at_half_speed": made.error_at_half,
        "friction_error_at_double_speed": made.error_at_double,
    }
    assert made.sentence() == (
        "made for a finger at 100 mm/s; at half that speed relative friction is off by up to -0.2, "
        "at double by up to +0.1"
    )


def test_where_the_speed_does_not_matter_it_says_so() -> None:
    made = MadeForSpeed.of(lambda a, v: 1.0 - a / 4e-6, AMPLITUDE, 0.08)
    assert made.sentence() == (
        "made for a finger at 80 mm/s; by this model friction does not depend on the speed"
    )


def test_what_is_no_speed_or_no_law_is_refused() -> None:
    with pytest.raises(InputError, match="speed = 0 m/s"):
        MadeForSpeed.of(stickier_when_fast, AMPLITUDE, 0.0)
    with pytest.raises(InputError, match="one value per amplitude"):
        MadeForSpeed.of(lambda a, v: np.ones(1), AMPLITUDE, 0.1)
