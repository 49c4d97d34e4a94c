"""Observations on friction against one frozen set: what each changes, and what it says of it."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable

import numpy as np
import pytest

from squeezefilm.analysis.claims.command import judge, read_claims
from squeezefilm.analysis.claims.contact import FROZEN, FrozenContact
from squeezefilm.analysis.claims.values import CLAIM_VALUES, ClaimValue
from squeezefilm.contact.finger.skin import Skin
from squeezefilm.contact.sharing.balance import share_load
from squeezefilm.contact.sharing.gas_table import film_table
from squeezefilm.contact.sharing.tapping import tapping_friction

CLAIMS = {one.id: one for one in read_claims().claims if one.id.startswith("contact-")}
friction = FROZEN.relative_friction


@functools.cache
def value(name: str) -> ClaimValue:
    return CLAIM_VALUES[f"contact-{name}"]()


def test_the_frozen_set_is_the_published_one() -> None:
    assert (FROZEN.frequency, FROZEN.amplitude, FROZEN.roughness) == (40.5e3, 2e-6, 0.6e-6)
    finger = FROZEN.finger
    assert (finger.contact_length, finger.ridge_amplitude, finger.ridge_period) == (
        10e-3, 50e-6, 350e-6,
    )  # fmt: skip
    assert finger.normal_force == 0.5
    assert dataclasses.astuple(FROZEN.gas)[:4] == (1.85e-5, 1e5, 1.2, 67e-9)
    # 0.36 N on 1 cm², on the plateaus of 250 in 350 µm.
    assert FROZEN.plateau_pressure == pytest.approx(0.36 / 1e-4 * 350 / 250, rel=0.01)
    assert FROZEN.evidence["plateau_pressure"] == "assumed: 0.36 N on 1 cm², carried by 5/7 of it"
    named = {key.partition(".")[0] for key in FROZEN.evidence} - {"slip"}
    fields = {one.name for one in dataclasses.fields(FrozenContact)}
    assert named | {"evidence"} == fields
    assert all(
        text.partition(":")[0] in ("published", "assumed", "derived")
        for text in FROZEN.evidence.values()
    )


def test_what_is_not_given_is_frozen() -> None:
    table = film_table(40.5e3, FROZEN.finger.plateau_width, FROZEN.gas, "first")
    law = FROZEN.finger.asperity_law(0.6e-6)
    expected = float(share_load(table, law, 2e-6, 5e3).relative_friction)
    assert friction() == pytest.approx(expected)
    same = friction(
        frequency=40.5e3, amplitude=2e-6, roughness=0.6e-6, ambient_pressure=1e5,
        plateau_pressure=5e3, slip="first", skin=None,
    )  # fmt: skip
    assert same == pytest.approx(expected)
    other = FrozenContact(amplitude=1e-6)
    assert other.relative_friction() == pytest.approx(friction(amplitude=1e-6))
    assert friction(amplitude=0.0) == pytest.approx(1.0)


def test_each_change_acts_in_its_direction() -> None:
    still = friction()
    assert friction(frequency=50e3) < still < friction(frequency=30e3)
    assert friction(amplitude=3e-6) < still < friction(amplitude=1e-6)
    assert friction(roughness=0.3e-6) < still < friction(roughness=1e-6)
    assert friction(plateau_pressure=2e3) < still
    assert friction(ambient_pressure=2e3) > still
    assert friction(ambient_pressure=2e3, slip="fukui-kaneko") != friction(ambient_pressure=2e3)
    assert friction(skin=Skin()) != still


@pytest.mark.parametrize("name", CLAIMS)
def test_the_verdict_on_record_follows(name: str) -> None:
    assert judge(CLAIMS[name], value(name.removeprefix("contact-"))).verdict == CLAIMS[name].verdict


def left(slip: str) -> float:
    return (1 - friction(ambient_pressure=2e3, slip=slip)) / (1 - friction(slip=slip))


def gain(stiffness: float) -> float:
    free, damped = (
        friction(skin=Skin(stiffness_per_area=stiffness, damping_per_area=damping))
        for damping in (0.0, 1e6)
    )
    return free - damped


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("near-vacuum", lambda: left("first")),
        ("half-atmosphere", lambda: abs(friction(ambient_pressure=5e4) - friction())),
        (
            "reach",
            lambda: 1 - friction(roughness=5e-9, amplitude=3e-6, plateau_pressure=2e3),
        ),
        ("frequency", lambda: friction(frequency=3e4) - friction(frequency=6e4)),
        ("amplitude", lambda: friction(amplitude=1e-6) - friction(amplitude=3e-6)),
        ("roughness", lambda: friction(roughness=0.6e-6) - friction(roughness=0.2e-6)),
        ("damping", lambda: gain(0.0)),
    ],
)
def test_each_claim_changes_what_its_statement_is_about(
    name: str, expected: Callable[[], float]
) -> None:
    assert value(name).value == pytest.approx([expected()])


def test_the_notes_say_the_other_numbers() -> None:
    vacuum, half = value("near-vacuum").note, value("half-atmosphere").note
    # 67 nm at 1 bar is 50 times as much at 20 mbar.
    assert f"free path is {67e-3 * 50:.1f} µm" in vacuum
    assert vacuum.endswith(f"the law of Fukui and Kaneko gives {left('fukui-kaneko'):.3f}")
    assert half.startswith(f"signed, {friction(ambient_pressure=5e4) - friction():+.4f}: at half")
    rough = 1 - friction(amplitude=3e-6)
    assert value("reach").note.endswith(f"on the frozen roughness and load {rough:.3f}")
    for name, low, high, said in (
        ("frequency", friction(frequency=3e4), friction(frequency=6e4), ("30 kHz", "60 kHz")),
        ("amplitude", friction(amplitude=1e-6), friction(amplitude=3e-6), ("1 µm", "3 µm")),
        ("roughness", friction(), friction(roughness=0.2e-6), ("0.6 µm", "0.2 µm")),
    ):
        note = f"µ′/µ {low:.3f} at {said[0]}, {high:.3f} at {said[1]}"
        assert value(name).note == note
    # A skin twice as stiff as it is inert at the frequency follows the pressure: damping helps.
    hard = gain(2 * Skin().mass_per_area * (2 * math.pi * 40.5e3) ** 2)
    assert hard > 0
    assert f"the change is {hard:+.4f}, the observed direction" in value("damping").note


def test_tapping_depends_on_the_speed_and_not_on_the_load() -> None:
    assert value("tapping-load").value == pytest.approx([0.0], abs=1e-9)
    slow, fast = (
        tapping_friction(2e-6, 40.5e3, speed, 5e3).relative_friction for speed in (0.03, 0.3)
    )
    found = value("tapping-speed")
    assert found.value == pytest.approx([fast - slow])
    assert np.sign(found.value[0]) == 1
    assert f"µ′/µ {slow:.3f} at 30 mm/s, {fast:.3f} at 300 mm/s; partial" in found.note
