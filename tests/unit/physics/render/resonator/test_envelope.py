"""The envelope's closed forms and its discrete response: shapes and every refusal."""

import math

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.quantities import CLOSED_FORMS
from squeezefilm.physics.render.resonator import envelope

FORMS = [
    envelope.envelope_time_constant,
    envelope.envelope_bandwidth,
    envelope.square_swing_kept,
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
    assert np.shape(envelope.square_swing_kept(periods, speeds, 1e-3)) == (2, 3)
    assert np.shape(envelope.sine_swing_kept(periods, speeds, 1e-3)) == (2, 3)
    assert np.shape(envelope.finest_period(speeds, 1e-3)) == (3,)


@pytest.mark.parametrize("kept", [0.0, 1.0, -0.5, math.nan])
@pytest.mark.parametrize("form", [envelope.finest_period, envelope.fastest_speed])
def test_a_share_outside_zero_to_one_is_refused(form: object, kept: float) -> None:
    with pytest.raises(InputError, match="kept = "):
        form(0.1, 1e-3, kept)


def test_an_unknown_shape_is_refused() -> None:
    with pytest.raises(InputError, match="Allowed: square, sine"):
        envelope.finest_period(0.1, 1e-3, 0.9, "triangle")


@pytest.mark.parametrize("duty", [0.0, 1.0, math.nan])
def test_a_duty_outside_zero_to_one_is_refused(duty: float) -> None:
    with pytest.raises(InputError, match="duty = "):
        envelope.square_swing_kept(1e-3, 0.1, 1e-3, duty)


def test_response_keeps_shape_and_starts_from_initial() -> None:
    command = np.full((2, 4), 1e-6)
    response = envelope.envelope_response(command, 1e-3, 1e-3, np.array([0.0, 1e-6]))
    assert response.shape == (2, 4)
    assert response[:, 0].tolist() == [0.0, 1e-6]
    assert response[1] == pytest.approx(command[1])
    assert response[0] == pytest.approx(1e-6 * (1 - np.exp(-np.arange(4))))


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((np.array([]), 1e-3, 1e-3), "at least one sample"),
        ((np.float64(1e-6), 1e-3, 1e-3), "at least one sample"),
        ((np.array([1e-6, math.nan]), 1e-3, 1e-3), "command = nan"),
        ((np.ones(3), 0.0, 1e-3), "time_step = 0 s"),
        ((np.ones(3), 1e-3, -1.0), "time_constant = -1 s"),
        ((np.ones(3), 1e-3, 1e-3, math.inf), "initial = inf"),
        ((np.ones((2, 3)), 1e-3, 1e-3, np.ones(3)), "does not fit"),
    ],
)
def test_a_response_that_cannot_be_computed_is_refused(arguments: tuple, said: str) -> None:
    with pytest.raises(InputError, match=said):
        envelope.envelope_response(*arguments)
