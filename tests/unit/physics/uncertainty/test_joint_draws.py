"""What is drawn of a calibrated display, `physics.uncertainty.model_choices`."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from squeezefilm.core.calibration_record import JointSpread
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import load_display
from squeezefilm.physics.uncertainty.draws import Mixture
from squeezefilm.physics.uncertainty.intervals import evaluate
from squeezefilm.physics.uncertainty.model_choices import (
    AMPLITUDE_SHARE,
    FRICTION_OFFSET,
    calibrated_inputs,
)
from squeezefilm.physics.uncertainty.uncertainty import sobol_points

STATOR = load_display("biet2008-stator")


def test_one_amplitude_stands_for_the_plates_own_values() -> None:
    mixture = Mixture(STATOR, predict(STATOR), driven=True)
    assert calibrated_inputs(mixture.inputs, None, driven=True) == mixture.inputs
    joint = JointSpread(amplitude_share_deviation=0.02, friction_offset_deviation=0.01)
    paths = [one.path for one in calibrated_inputs(mixture.inputs, joint, driven=True)]
    assert not any(path.startswith("actuator.") for path in paths)
    assert paths[-2:] == [AMPLITUDE_SHARE, FRICTION_OFFSET]
    still = [one.path for one in calibrated_inputs(mixture.inputs, joint, driven=False)]
    assert AMPLITUDE_SHARE not in still


@pytest.mark.slow
def test_the_offset_is_added_and_the_table_is_drawn_from() -> None:
    def friction(joint: JointSpread | None) -> np.ndarray:
        display = dataclasses.replace(STATOR, joint=joint)
        mixture = Mixture(display, predict(display), driven=True)
        drawn, _ = evaluate(mixture, sobol_points(mixture, 16, 1), lambda _: None)
        return np.asarray(drawn.friction)

    # One row of the table for all that it names: what is left differs less.
    mixture = Mixture(STATOR, predict(STATOR), driven=True)
    row = tuple(0.5 for _ in mixture.paths)
    alone = friction(JointSpread(mixture.paths, draws=(row,)))
    assert np.ptp(alone) < 1e-9 < np.ptp(friction(None))
    lifted = friction(JointSpread(mixture.paths, friction_offset=0.05, draws=(row,)))
    np.testing.assert_allclose(lifted - alone, 0.05, atol=1e-9)
