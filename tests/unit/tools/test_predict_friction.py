"""Friction that was kept back is predicted in a sealed file, by people as they are fitted."""

from __future__ import annotations

import tomllib

import pytest

from levitation_fit import fits, ridge_fits
from predict_disc import is_sealed
from predict_friction import FILES
from squeezefilm.physics.chain.pad_law import FrictionModel
from squeezefilm.physics.contact.finger.fingertip import (
    CONTACT_DECAY_LENGTH,
    DECAY_SPEED_EXPONENT,
    RIDGE_LENGTH,
    RIDGE_POWER_OF_PEOPLE,
    RIDGE_POWER_OF_SPEED,
)


@pytest.mark.parametrize("model", FILES)
def test_the_predictions_are_as_they_were_sealed(model: FrictionModel) -> None:
    text = FILES[model].read_text(encoding="utf-8")
    assert is_sealed(text)
    for name, made in tomllib.loads(text)["prediction"].items():
        rows = [row for key, row in made.items() if "5_" in key]
        for row in rows:
            several = row if isinstance(row[0], list) else [row]
            assert all(one == sorted(one) for one in several), name


@pytest.mark.slow
def test_the_default_finger_is_what_published_friction_fits() -> None:
    found = fits()
    assert found.at_reference == pytest.approx(CONTACT_DECAY_LENGTH, rel=5e-3)
    assert found.exponent == pytest.approx(DECAY_SPEED_EXPONENT, abs=5e-3)
    assert max(person.left for person in found.people) < 0.05
    assert len(found.people) == 3
    ridges = ridge_fits(found)
    assert max(left for _, left in ridges.people) < 0.05
    assert ridges.at_reference == pytest.approx(RIDGE_LENGTH, rel=1e-2)
    assert ridges.exponent / found.exponent == pytest.approx(RIDGE_POWER_OF_SPEED, abs=0.05)
    assert ridges.spread / found.spread == pytest.approx(RIDGE_POWER_OF_PEOPLE, abs=0.05)
