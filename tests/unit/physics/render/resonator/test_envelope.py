"""The envelope's closed forms: shapes and every refusal."""

import math

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.quantities import CLOSED_FORMS
from squeezefilm.physics.render.resonator import envelope

FORMS = [
    envelope.envelope_time_constant,
    envelope.envelope_bandwidth,
    envelope.sine_swing_kept,
    envelope.finest_period,
    envelope.fastest_speed,
]


@pytest.mark.parametrize("form", FORMS)
def test_every_closed_form_is_registered_and_checks_its_arguments(form: object) -> None:
    assert CLOSED_FORMS[f"squeezefilm.physics.render.resonator.envelope.{form.__name__}"] is form
    count = 3 if "swing" in form.__name__ else 2
    for bad in range(count):
        for value in (0.0, -1.0, math.nan, math.inf):
            with pytest.raises(InputError, match="cannot be used"):
                form(*[value if place == bad else 0.5 for place in range(count)])


def test_closed_forms_broadcast() -> None:
    periods, speeds = np.array([[1e-3], [2e-3]]), np.array([0.05, 0.1, 0.2])
    assert np.shape(envelope.sine_swing_kept(periods, speeds, 1e-3)) == (2, 3)
    assert np.shape(envelope.finest_period(speeds, 1e-3)) == (3,)


@pytest.mark.parametrize("kept", [0.0, 1.0, -0.5, math.nan])
@pytest.mark.parametrize("form", [envelope.finest_period, envelope.fastest_speed])
def test_a_share_outside_zero_to_one_is_refused(form: object, kept: float) -> None:
    with pytest.raises(InputError, match="kept = "):
        form(0.1, 1e-3, kept)
