"""Questions to a blind prediction, read from text."""

import pytest

from squeezefilm.errors import InputError
from squeezefilm.measure.calibration.questions import question
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
