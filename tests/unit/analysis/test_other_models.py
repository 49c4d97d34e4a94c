"""The same plate by other theories."""

import pytest

from squeezefilm.analysis.other_models import other_models
from squeezefilm.chain.prediction import predict
from squeezefilm.display import load_display

PLATE = load_display("biet2008-plate")


def test_beams_and_the_shear_plate_stand_beside_a_beam_that_was_asked_for() -> None:
    p = predict(PLATE, theory="timoshenko")
    found = {one.model: one for one in other_models(PLATE, p)}
    assert p.mode.model not in found
    assert {"shear_plate", "euler_bernoulli_beam_plane_strain"} <= set(found)
    # Without shear a beam is stiffer.
    stiff = found["euler_bernoulli_beam_plane_strain"]
    assert stiff.resonance_frequency > p.mode.resonance_frequency
    assert found["shear_plate"].vibration_amplitude is None


@pytest.mark.parametrize("name", ["biet2008-stator", "winfield2007-tpad"])
def test_what_is_no_rectangular_plate_has_none(name: str) -> None:
    display = load_display(name)
    assert list(other_models(display, predict(display))) == []


def test_an_amplitude_that_was_given_is_of_no_theory() -> None:
    p = predict(PLATE, vibration_amplitude=1e-6, theory="timoshenko")
    assert list(other_models(PLATE, p)) == []
