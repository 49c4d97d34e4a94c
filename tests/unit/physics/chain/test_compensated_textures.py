"""Gains and bounds of speed by drive, on both displays."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.results import to_json
from squeezefilm.design.textures.gratings_left import (
    driven_envelope,
    texture_survival,
)
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.display import load_display
from squeezefilm.physics.render.resonator.compensation import DrivenEnvelope

# τ of the paper's plate as solved, and of its stator with the Q assumed for it.
PLATE = DrivenEnvelope(0.5687e-3, 0.5687e-3, 1.72e-6)
STATOR = DrivenEnvelope(1.572e-3, 1.572e-3, 2e-6)


@pytest.fixture(scope="module")
def plate() -> Prediction:
    """The paper's plate at 15 V."""
    return predict(load_display("biet2008-plate"))


def test_the_envelope_is_that_of_the_free_plate_at_its_voltage(plate: Prediction) -> None:
    envelope = driven_envelope(plate)
    assert envelope.rise_time_constant == pytest.approx(0.569e-3, abs=1e-6)
    assert envelope.amplitude_limit == pytest.approx(plate.touch.free_amplitude, rel=1e-6)


@pytest.mark.parametrize("envelope", [PLATE, STATOR], ids=["plate", "stator"])
def test_gains_do_not_depend_on_the_device_and_stay_under_their_bounds(
    envelope: DrivenEnvelope,
) -> None:
    table = texture_survival("tested", envelope, speeds=[0.05, 0.1])
    assert table.gain == pytest.approx(
        [1.0, math.log(19) / math.log(10), math.log(19) / math.log(1 / 0.28)], rel=1e-9
    )
    assert np.all(table.gain <= table.bound)
    assert table.bound[1] < 2.0  # what cannot be done without inverting the phase
    assert table.finest_period[:, 1] == pytest.approx(2 * table.finest_period[:, 0])
    full = texture_survival("tested", envelope, level=1.0)
    assert full.gain == pytest.approx([1.0, 1.0, math.log(19) / math.log(10)], rel=1e-9)
    assert full.bound == pytest.approx([1.0, 1.0, 2.0], rel=1e-9)
    data = json.loads(json.dumps(to_json(full), allow_nan=False))
    assert data["laws"][2] == {
        "name": "compensated, phase inversion", "compensated": True, "braking": True,
    }  # fmt: skip


def test_without_a_voltage_there_is_no_envelope() -> None:
    given = predict(load_display("biet2008-plate"), vibration_amplitude=1e-6)
    with pytest.raises(InputError, match="not a voltage: give a voltage"):
        driven_envelope(given)


@pytest.mark.parametrize("level", [0.0, 1.1, math.nan])
def test_levels_outside_the_limits_are_refused(level: float) -> None:
    with pytest.raises(InputError, match="level"):
        texture_survival("tested", PLATE, level)


def test_drive_laws_do_what_their_names_say() -> None:
    from squeezefilm.design.textures.gratings_left import DRIVE_LAWS

    assert {law.name: (law.compensated, law.braking) for law in DRIVE_LAWS} == {
        "no compensation": (False, False),
        "compensated, no phase inversion": (True, False),
        "compensated, phase inversion": (True, True),
    }
