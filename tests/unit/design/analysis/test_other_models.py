"""The same plate by other theories."""

from dataclasses import replace

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.design.analysis.analysis import measured_beside, other_models
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import Measured, load_display

PLATE = load_display("biet2008-plate")


def test_other_beams_stand_beside_a_beam_that_was_asked_for() -> None:
    p = predict(PLATE, theory="timoshenko")
    found = {one.model: one for one in other_models(PLATE, p)}
    assert p.mode.model not in found
    # Without shear a beam is stiffer.
    stiff = found["euler_bernoulli_beam_plane_strain"]
    assert stiff.resonance_frequency > p.mode.resonance_frequency


@pytest.mark.parametrize("name", ["biet2008-stator", "winfield2007-tpad"])
def test_what_is_no_rectangular_plate_has_none(name: str) -> None:
    display = load_display(name)
    assert list(other_models(display, predict(display))) == []


def test_an_amplitude_that_was_given_is_of_no_theory() -> None:
    p = predict(PLATE, vibration_amplitude=1e-6, theory="timoshenko")
    assert list(other_models(PLATE, p)) == []


def test_what_was_measured_stands_beside_what_is_computed() -> None:
    p = predict(PLATE, theory="timoshenko")
    frequency, amplitude = measured_beside(PLATE, p)
    assert (frequency.measured, amplitude.measured, amplitude.voltage) == (30.5e3, 1.15e-6, 15.0)
    assert "section 3.2.1" in frequency.source
    assert "section 3.2.1" in amplitude.source
    assert frequency.computed == p.mode.resonance_frequency
    assert frequency.difference == pytest.approx(p.mode.resonance_frequency / 30.5e3 - 1)
    assert amplitude.computed == pytest.approx(15.0 * p.mode.amplitude_per_volt)


def test_it_does_not_depend_on_what_the_analysis_is_asked_for() -> None:
    asked = predict(PLATE, voltage=3.0, theory="timoshenko")
    given = predict(PLATE, vibration_amplitude=1e-6, theory="timoshenko")
    assert measured_beside(PLATE, asked) == measured_beside(PLATE, given)


def test_a_display_of_which_nothing_was_measured_has_nothing_beside() -> None:
    plain = replace(PLATE, measured=None)
    assert measured_beside(plain, predict(plain, theory="timoshenko")) == ()
    own = replace(PLATE, measured=Measured(quality_factor=50.0), provenance={})
    (quality,) = measured_beside(own, predict(own, theory="timoshenko"))
    assert (quality.measured, quality.computed, quality.source) == (50.0, 60.0, "")


def test_an_amplitude_without_its_voltage_is_refused() -> None:
    with pytest.raises(InputError, match="without its voltage"):
        Measured(vibration_amplitude=1e-6)
