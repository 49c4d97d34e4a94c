"""Questions to a blind prediction, read from text."""

import math
from typing import Any

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.measure.calibration.solved_answers import question
from squeezefilm.measure.fits.estimate import Observation


def test_an_answer_is_read_with_its_conditions() -> None:
    assert question("resonance_frequency") == Observation("resonance_frequency", 0.0, 0.0, {})
    found = question("relative_friction: vibration_amplitude = 1.7 um, normal_force=0.5 N")
    assert found.conditions == {"vibration_amplitude": 1.7e-6, "normal_force": 0.5}
    lines = question("mode_frequency: lines_across_length=7, lines_across_width=0").conditions
    assert lines == {"lines_across_length": 7.0, "lines_across_width": 0.0}


@pytest.mark.parametrize(
    "text", ["mass: wind=1 m", "mass: normal_force", "relative_friction: vibration_amplitude=1.7"]
)
def test_a_condition_that_cannot_be_read_is_refused(text: str) -> None:
    with pytest.raises(InputError):
        question(text)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"value": math.nan}, "value = nan"),
        ({"standard_error": math.inf}, "standard_error = inf"),
        ({"standard_error": -1.0}, "at least 0"),
        ({"conditions": {"voltage": math.nan}}, "voltage = nan"),
    ],
)
def test_what_was_observed_is_finite(changed: dict[str, Any], said: str) -> None:
    observed = {"answer": "resonance_frequency", "value": 34e3, "standard_error": 17.0}
    with pytest.raises(InputError, match=said):
        Observation(**{**observed, **changed})
