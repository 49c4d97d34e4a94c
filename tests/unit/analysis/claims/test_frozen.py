"""The one set of parameters of all claims on friction, and the models that it is given to."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from squeezefilm.analysis.claims.frozen import FROZEN, MODELS, FrozenContact
from squeezefilm.contact.asperities import AsperityLaw
from squeezefilm.contact.finger.skin import Skin
from squeezefilm.contact.rough_contact import RoughContact
from squeezefilm.contact.sharing.balance import share_load
from squeezefilm.contact.sharing.gas_table import film_table
from squeezefilm.contact.sharing.shear import AsperityShear, sheared_friction
from squeezefilm.contact.sharing.tapping import tapping_friction
from squeezefilm.errors import InputError

LEVITATION, SHEAR, TAPS = "partial-levitation", "partial-levitation-shear", "intermittent-contact"
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
    named = {key.partition(".")[0] for key in FROZEN.evidence}
    fields = {one.name for one in dataclasses.fields(FrozenContact)}
    assert named | {"evidence"} == fields
    assert all(
        text.partition(":")[0].partition(";")[0] in ("published", "assumed", "derived")
        for text in FROZEN.evidence.values()
    )


def test_the_models_name_their_laws() -> None:
    """What a finger has by default may change; what was compared may not change with it."""
    assert MODELS[LEVITATION].law == AsperityLaw()
    assert MODELS[LEVITATION].stiffness == "rigid"
    assert isinstance(MODELS[SHEAR].law, RoughContact)
    assert MODELS[SHEAR].stiffness == "following"
    assert not MODELS[TAPS].film
    assert len({model.words for model in MODELS.values()}) == len(MODELS)


def test_what_is_not_given_is_frozen() -> None:
    table = film_table(40.5e3, FROZEN.finger.plateau_width, FROZEN.gas, "fukui-kaneko")
    shared = share_load(table, AsperityLaw(), 2e-6, 5e3)
    assert friction(LEVITATION) == pytest.approx(float(shared.relative_friction))
    shared = share_load(table, RoughContact(), 2e-6, 5e3)
    sheared = sheared_friction(shared, AsperityShear(0.08, 0.9, "following"), 40.5e3)
    assert friction(SHEAR) == pytest.approx(float(sheared))
    taps = tapping_friction(2e-6, 40.5e3, 0.08, 5e3, friction_coefficient=0.9)
    assert friction(TAPS) == pytest.approx(taps.relative_friction)
    other = FrozenContact(amplitude=1e-6)
    for model in MODELS:
        assert other.relative_friction(model) == pytest.approx(friction(model, amplitude=1e-6))
        assert friction(model, amplitude=0.0) == pytest.approx(1.0)


def test_heights_grow_with_those_of_both_faces() -> None:
    for model in MODELS:
        rough, smooth = FROZEN.law(model), dataclasses.replace(FROZEN, roughness=0.0).law(model)
        assert rough == MODELS[model].law
        assert smooth.decay_length == pytest.approx(rough.decay_length / np.sqrt(2))


def test_each_change_acts() -> None:
    for model in (LEVITATION, SHEAR):
        still = friction(model)
        for change in (
            {"frequency": 50e3}, {"amplitude": 3e-6}, {"roughness": 0.3e-6},
            {"plateau_pressure": 2e3}, {"ambient_pressure": 2e3}, {"slip": "first"},
            {"skin": Skin()},
        ):  # fmt: skip
            assert friction(model, **change) != still
    # An elastic element can only leave less than what slides.
    rigid = dataclasses.replace(MODELS[SHEAR], stiffness="rigid")
    assert 0 < friction(SHEAR) < friction(SHEAR, speed=5.0) <= 1
    assert "slides" in rigid.words


def test_a_pad_is_the_mean_over_its_ridges() -> None:
    """Over an antinode a pad meets less amplitude than a plateau there, and so keeps more."""
    for model in (LEVITATION, SHEAR):
        assert friction(model) < FROZEN.pad_friction(model, 0.0) < 1
        # Turned by half a turn the ridges are the same.
        assert FROZEN.pad_friction(model, np.pi) == pytest.approx(FROZEN.pad_friction(model, 0.0))


def test_a_model_that_is_not_known_is_refused() -> None:
    with pytest.raises(InputError, match="Did you mean 'partial-levitation'"):
        friction("partial-levitatio")
