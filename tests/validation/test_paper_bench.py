"""The paper's two numbers as a bench."""

from __future__ import annotations

import pytest
from tests.validation.paper_bench import (
    GLUE_PRIORS,
    glued_paper_display,
    paper_calibration,
    paper_observations,
)

from squeezefilm.measure.calibration.priors import calibration_parameters
from squeezefilm.measure.calibration.solved_answers import Asked
from squeezefilm.validation.explanations import MEASURED_FREQUENCY


def test_what_the_paper_measured() -> None:
    frequency, amplitude = paper_observations()
    assert frequency.value == MEASURED_FREQUENCY
    assert 15 * amplitude.value == pytest.approx(1.15e-6)
    assert set(GLUE_PRIORS) <= {one.path for one in calibration_parameters(glued_paper_display())}


@pytest.mark.campaign
def test_two_numbers_fix_combinations_only() -> None:
    """Soft glue, thin plate and soft ceramic explain them alike; none of them is identified."""
    found = paper_calibration()
    frequency = found.joint.answers[Asked("resonance_frequency")]
    assert frequency.mean() == pytest.approx(MEASURED_FREQUENCY, rel=0.01)
    left = {one.path: one.left for one in found.identification.known}
    assert left["actuator.substrate.young_modulus"] > 0.5
    assert left["actuator.glue.thickness"] > 0.3
    assert any(len(one.parts) > 1 for one in found.identification.combinations)
