"""The compiled stiffness under a finger against the formulas that it is written after."""

from __future__ import annotations

import numpy as np
import pytest
from tests.finger_stiffness import finger_stiffness, interface_stiffness

from squeezefilm.physics.contact.asperities import AsperityLaw
from squeezefilm.physics.contact.finger.fingertip import Skin
from squeezefilm.physics.contact.finger.load import compiled_finger, felt, strip_force
from squeezefilm.physics.contact.rough_contact import ContactLaw, RoughContact
from squeezefilm.physics.display import load_display
from squeezefilm.physics.film.closed import relative_damping, relative_stiffness
from squeezefilm.physics.film.gap import squeeze_number

AIR = load_display("biet2008-plate").gas
LAWS = (AsperityLaw(), AsperityLaw(heights="gaussian"), RoughContact())


@pytest.mark.parametrize("sigma", [1e-6, 0.1, 10.0, 899.0, 901.0, 1e5])
def test_a_strip_is_that_of_the_closed_form(sigma: float) -> None:
    found = strip_force(sigma)
    assert found.real == pytest.approx(relative_stiffness(sigma), rel=1e-11)
    assert found.imag == pytest.approx(relative_damping(sigma), rel=1e-11)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("swing", [0.0, 0.3e-6, 1.5e-6])
def test_the_interface_is_film_beside_the_first_harmonic_of_the_asperities(
    law: ContactLaw, swing: float
) -> None:
    gas, gap, frequency, width = AIR, 3e-6, 31e3, 250e-6
    sigma = squeeze_number(frequency, width, gap, gas.viscosity, gas.ambient_pressure)
    knudsen = gas.mean_free_path / gap
    film = (
        gas.ambient_pressure
        / gap
        * complex(
            float(relative_stiffness(sigma / (1 + 6 * knudsen))),
            float(relative_damping(sigma / (1 + 6 * knudsen))),
        )
    )
    # At rest the harmonic is the slope.
    a = max(swing, 1e-10)
    phase = np.cos(2 * np.pi * np.arange(512) / 512)
    solid = 2 * float(np.mean(law.pressure(gap - a * phase) * phase)) / a
    found = interface_stiffness(gap, swing, width, frequency, gas, law)
    assert found == pytest.approx(film + solid, rel=1e-5)


def test_what_the_plate_feels_is_that_of_the_finger_behind_it() -> None:
    gas, skin, law = AIR, Skin(), RoughContact()
    finger = compiled_finger(250e-6, 31e3, gas, skin, 0.7)
    interface = interface_stiffness(3e-6, 1e-6, 250e-6, 31e3, gas, law)
    expected = finger_stiffness(interface, skin, 31e3, 0.7)
    assert felt(3e-6, 1e-6, finger, law.compiled()) == pytest.approx(expected, rel=1e-12)
