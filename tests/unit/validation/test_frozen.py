"""The one set of parameters of all claims on friction, and the models that it is given to."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.contact.asperities import AsperityLaw
from squeezefilm.physics.contact.finger.fingertip import Skin
from squeezefilm.physics.contact.sharing.balance import share_load
from squeezefilm.physics.contact.sharing.gas_table import film_table
from squeezefilm.physics.contact.sharing.levitation import levitation_friction, levitation_scale
from squeezefilm.validation.frozen import FROZEN, MODELS, FrozenContact

BALANCE, CLOSED, RIDGES = "partial-levitation", "levitation", "levitation-ridges"
friction = FROZEN.relative_friction


def test_the_frozen_set_is_the_published_one() -> None:
    assert (FROZEN.frequency, FROZEN.amplitude, FROZEN.roughness) == (40.5e3, 2e-6, 0.6e-6)
    finger = FROZEN.finger
    assert (finger.contact_length, finger.ridge_amplitude, finger.ridge_period) == (
        10e-3, 50e-6, 350e-6,
    )  # fmt: skip
    assert dataclasses.astuple(FROZEN.gas)[:4] == (1.85e-5, 1e5, 1.2, 67e-9)
    # 0.36 N on 1 cm², on the plateaus of 250 in 350 µm.
    assert FROZEN.plateau_pressure == pytest.approx(0.36 / 1e-4 * 350 / 250, rel=0.01)
    assert 2 * FROZEN.half_wavelength == 18.7e-3


def test_every_model_has_words_of_its_own() -> None:
    assert len(set(MODELS.values())) == len(MODELS)


def test_what_is_not_given_is_frozen() -> None:
    table = film_table(40.5e3, FROZEN.finger.plateau_width, FROZEN.gas, "fukui-kaneko")
    shared = share_load(table, AsperityLaw(), 2e-6, 5e3)
    assert friction(BALANCE) == pytest.approx(float(shared.relative_friction))
    # 5 kPa on the plateaus, 5/7 of the contact.
    scale = levitation_scale(float(FROZEN.finger.decay_length_at(0.08)), 5e3 * 5 / 7, 1e5)
    lifted = levitation_friction(np.array([2e-6 / scale]))
    assert friction(CLOSED) == pytest.approx(lifted[0])
    other = FrozenContact(amplitude=1e-6)
    for model in MODELS:
        assert other.relative_friction(model) == pytest.approx(friction(model, amplitude=1e-6))
        assert friction(model, amplitude=0.0) == pytest.approx(1.0, abs=1e-3)


def test_heights_grow_with_those_of_both_faces() -> None:
    rough, smooth = (
        dataclasses.replace(FROZEN, roughness=roughness).law(BALANCE).asperities
        for roughness in (0.6e-6, 1e-9)
    )
    assert rough == AsperityLaw()
    assert isinstance(smooth, AsperityLaw)
    assert smooth.decay_length == pytest.approx(rough.decay_length / np.sqrt(2), rel=1e-5)


def test_each_change_acts() -> None:
    for model, changes in {
        BALANCE: {
            "frequency": 50e3, "roughness": 0.3e-6, "slip": "first", "skin": Skin(),
        },
        CLOSED: {"speed": 0.3},
        RIDGES: {"frequency": 50e3, "speed": 0.3, "slip": "first"},
    }.items():  # fmt: skip
        still = friction(model)
        common = {"amplitude": 3e-6, "plateau_pressure": 2e3, "ambient_pressure": 2e3}
        for name, value in (changes | common).items():
            assert friction(model, **{name: value}) != still, name


def test_a_pad_is_the_mean_over_its_ridges() -> None:
    """Over an antinode a pad meets less amplitude than a plateau there, and so keeps more."""
    for model in (BALANCE, RIDGES):
        assert friction(model) < FROZEN.pad_friction(model, 0.0) < 1
        # Turned by half a turn the ridges are the same.
        assert FROZEN.pad_friction(model, np.pi) == pytest.approx(FROZEN.pad_friction(model, 0.0))


def test_a_model_that_is_not_known_is_refused() -> None:
    with pytest.raises(InputError, match="Did you mean 'partial-levitation'"):
        friction("partial-levitatio")
