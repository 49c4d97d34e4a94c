"""Friction has no steps over force, place and length of contact: ridges come in part by part."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from squeezefilm.physics.chain.friction import FrictionLaw
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import load_display

# By theory what a solid would be solved for.
DISPLAYS = {
    "biet2008-stator": {},
    "biet2008-plate": {"theory": "timoshenko"},
    "touchpad-glass": {"theory": "timoshenko"},
}


def laws(display: str, speed: float, count: int) -> list[FrictionLaw]:
    """Laws of a display at random forces, places along the wave and lengths of the contact, half of
    them over the best place."""
    best = predict(
        load_display(display), vibration_amplitude=2e-6, speed=speed, **DISPLAYS[display]
    ).law  # type: ignore[arg-type]
    rng = np.random.default_rng(43)
    made = []
    for number in range(count):
        length, share = float(rng.uniform(7e-3, 13e-3)), float(rng.uniform(0.0, 1.0))
        law = dataclasses.replace(
            best,
            finger=dataclasses.replace(best.finger, contact_length=length),
            normal_force=float(rng.uniform(0.1, 1.0)),
        )
        if number % 2:
            law = dataclasses.replace(law, place=None, position=share * best.half_wavelength)
        made.append(law)
    return made


def change(law: FrictionLaw, **more: float) -> float:
    """By how much µ′/µ at 2 µm changes, over its lesser value, between a law and one with more of
    a quantity, each in shares of it."""
    grown = dataclasses.replace(
        law,
        normal_force=law.normal_force * (1 + more.get("force", 0.0)),
        position=law.position * (1 + more.get("place", 0.0)),
        finger=dataclasses.replace(
            law.finger, contact_length=law.finger.contact_length * (1 + more.get("length", 0.0))
        ),
    )
    before, after = law.at(2e-6), grown.at(2e-6)
    return abs(after - before) / min(before, after)


@pytest.mark.parametrize("speed", [0.005, pytest.param(0.08, marks=pytest.mark.slow)])
@pytest.mark.parametrize("quantity", ["force", "place", "length"])
@pytest.mark.parametrize("display", DISPLAYS)
def test_what_is_one_per_cent_apart_has_friction_within_two(
    display: str, quantity: str, speed: float
) -> None:
    assert max(change(law, **{quantity: 0.01}) for law in laws(display, speed, 60)) < 0.02
