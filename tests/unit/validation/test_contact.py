"""Published directions asked of each model: what each changes, and what it says of it."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from squeezefilm.design.analysis.published_claims import read_claims
from squeezefilm.physics.contact.finger.fingertip import Skin
from squeezefilm.validation.command import judge
from squeezefilm.validation.frozen import DIRECTION_VALUES, FROZEN
from squeezefilm.validation.values import ClaimValue

ASKED = [one for one in read_claims().all_claims if one.model]
BALANCE, RIDGES = "partial-levitation", "levitation-ridges"
friction = FROZEN.relative_friction


@functools.cache
def value(name: str, model: str) -> ClaimValue:
    return DIRECTION_VALUES[name](model)


def test_the_verdict_on_record_follows() -> None:
    for claim in ASKED:
        assert judge(claim, value(claim.id, claim.model)).verdict == claim.verdict, claim.name


def left(model: str, slip: str) -> float:
    here = replace(FROZEN, slip=slip)
    inside = here.relative_friction(model, ambient_pressure=0.017 * 101325)
    return (1 - inside) / (1 - here.relative_friction(model))


def gain(model: str, stiffness: float) -> float:
    free, damped = (
        friction(model, skin=Skin(stiffness_per_area=stiffness, damping_per_area=damping))
        for damping in (0.0, 1e6)
    )
    return free - damped


def ratio(model: str) -> float:
    return abs(friction(model, plateau_pressure=2e4) / friction(model) - 1)


def turned(model: str) -> float:
    return float(np.ptp([FROZEN.pad_friction(model, angle * math.pi / 4) for angle in range(3)]))


def between(name: str, low: float, high: float) -> Callable[[str], float]:
    return lambda model: friction(model, **{name: low}) - friction(model, **{name: high})


# Of the default skin at the frozen frequency (Pa/m).
INERTIA = Skin().mass_per_area * (2 * math.pi * 40.5e3) ** 2

EXPECTED: dict[str, Callable[[str], float]] = {
    "half-atmosphere": lambda model: abs(friction(model, ambient_pressure=5e4) - friction(model)),
    "reach": lambda model: (
        1 - friction(model, roughness=5e-9, amplitude=3e-6, plateau_pressure=2e3)
    ),
    "frequency": between("frequency", 3e4, 6e4),
    "amplitude": between("amplitude", 1e-6, 3e-6),
    "roughness": between("roughness", 0.6e-6, 0.2e-6),
    "speed": between("speed", 0.3, 0.03),
    "load": ratio,
    "damping": lambda model: gain(model, 1.1 * INERTIA),
    "orientation": turned,
}


@pytest.mark.parametrize("model", [BALANCE, RIDGES])
@pytest.mark.parametrize("name", EXPECTED)
def test_each_claim_changes_what_its_statement_is_about(name: str, model: str) -> None:
    assert value(name, model).value == pytest.approx([EXPECTED[name](model)])


@pytest.mark.parametrize("model", [BALANCE, RIDGES])
def test_the_vacuum_is_judged_by_slip_laws_that_are_in_range(model: str) -> None:
    found = value("vacuum", model)
    # 67 nm at 1 bar is 58 times as much at 17 mbar, about as much as the gap.
    assert f"free path is {67e-3 * 58.05:.1f} µm" in found.note
    assert found.value == pytest.approx([left(model, "fukui-kaneko"), left(model, "veijola")])
    assert f"would give {left(model, 'first'):.3f}" in found.note
    # Two laws fitted to the same kinetic theory agree; first order is for a tenth of it.
    assert found.value[0] == pytest.approx(found.value[1], rel=0.05)


def test_a_vacuum_takes_least_from_films_over_single_ridges() -> None:
    film, closed, ridges = (
        value("vacuum", model).value[0] for model in (BALANCE, "levitation", RIDGES)
    )
    assert 0 < film < closed < 0.6 < ridges < 0.82


def test_the_notes_say_the_other_numbers() -> None:
    for model in (BALANCE, RIDGES):
        half = friction(model, ambient_pressure=5e4) - friction(model)
        assert value("half-atmosphere", model).note == f"signed, {half:+.4f}"
        rough = 1 - friction(model, amplitude=3e-6)
        assert value("reach", model).note.endswith(f"on the frozen roughness and load {rough:.3f}")
        low, high = friction(model, frequency=3e4), friction(model, frequency=6e4)
        said = f"µ′/µ {low:.3f} at 30 kHz, {high:.3f} at 60 kHz"
        assert value("frequency", model).note == said
        harder = f"with twice its inertia {gain(model, 2 * INERTIA):+.4f}"
        assert harder in value("damping", model).note
        # On a mass alone the sign is the other one, where the skin enters.
        assert gain(model, 0.0) < 0 or model == RIDGES
        assert value("damping", model).note.endswith(f"stiffness, {gain(model, 0.0):+.4f}")
        level = FROZEN.pad_friction(model, 0.0)
        assert f"{level:.3f} with ridges along the nodal lines" in value("orientation", model).note


def test_what_is_true_by_construction_is_so_at_other_values() -> None:
    """No value of the parameters could have made these fail."""
    odd = replace(FROZEN, amplitude=1.3e-6, roughness=0.3e-6, plateau_pressure=9e3)
    for model in ("levitation", RIDGES):
        by_speed = [odd.relative_friction(model, speed=u) for u in np.geomspace(5e-3, 2.0, 9)]
        assert np.all(np.diff(by_speed) >= -1e-12)
        by_amplitude = [odd.relative_friction(model, amplitude=1e-7 * k) for k in range(1, 30)]
        assert np.all(np.diff(by_amplitude) < 0)


def test_in_a_balance_no_speed_enters() -> None:
    assert value("speed", BALANCE).value == (0.0,)
