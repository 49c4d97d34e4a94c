"""Criteria of a body by its own sizes, and those that only a solved plate has, made by hand."""

from __future__ import annotations

import dataclasses
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import VACUUM_PERMITTIVITY
from squeezefilm.design.search import criteria
from squeezefilm.design.search.criteria import _capacitance, _deflection, _stress
from squeezefilm.design.search.requirements import Limits
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.laminate import pressed_deflection, pressed_disc_deflection

PLATE: Any = load_display("biet2008-plate")
DISC: Any = load_display("winfield2007-tpad")
SECTION: Any = SimpleNamespace(
    bending_stiffness=20.0,
    neutral_axis=1.2e-3,
    layers=[SimpleNamespace(thickness=2e-3), SimpleNamespace(thickness=1e-3)],
)
NEEDED: Any = SimpleNamespace(limits=SimpleNamespace(press=5.0))


def moving(*nodes: float, half: float = 7e-3) -> Any:
    line = SimpleNamespace(nodal_positions=np.array(nodes)) if nodes else None
    return SimpleNamespace(mode=SimpleNamespace(line=line, half_wavelength=half))


def with_actuator(display: Any, **changes: Any) -> Any:
    return dataclasses.replace(display, actuator=dataclasses.replace(display.actuator, **changes))


def test_a_plate_is_pressed_between_its_outermost_nodal_lines() -> None:
    body, side = PLATE.actuator, PLATE.finger.contact_length
    found = _deflection(NEEDED, PLATE, moving(5e-3, 20e-3, 75e-3), SECTION)
    poisson = body.substrate.poisson_ratio
    assert found == pytest.approx(pressed_deflection(5.0, 70e-3, body.width, 20.0, poisson, side))
    # With its lines along the other side, between strips of ceramic, the metal alone is bent.
    bare = body.substrate.plane_strain_modulus * body.thickness**3 / 12
    crossed = with_actuator(PLATE, lines_across="width", nodal_lines=5)
    found = _deflection(NEEDED, crossed, moving(5e-3, 40e-3), SECTION)
    assert found == pytest.approx(pressed_deflection(5.0, 35e-3, body.length, bare, poisson, side))
    assert math.isnan(_deflection(NEEDED, PLATE, moving(), SECTION))


def test_a_disc_is_pressed_within_its_largest_nodal_circle() -> None:
    body = DISC.actuator
    poisson = body.substrate.poisson_ratio
    for nodes, radius in (((-9e-3, 4e-3, 9e-3), 9e-3), ((0.0,), body.diameter / 2)):
        found = _deflection(NEEDED, DISC, moving(*nodes), SECTION)
        assert found == pytest.approx(pressed_disc_deflection(5.0, radius, 20.0, poisson))
    assert math.isnan(_deflection(NEEDED, DISC, moving(), SECTION))
    hole = {"inner_diameter": 5e-3, "ceramic_inner_diameter": 6e-3}
    bored = SimpleNamespace(actuator=dataclasses.replace(body, **hole))
    assert math.isnan(_deflection(NEEDED, bored, moving(9e-3), SECTION))


def test_a_discs_ceramic_is_a_ring_of_one_capacitance() -> None:
    body = DISC.actuator
    outer, inner = body.ceramic_outer_diameter / 2, body.ceramic_inner_diameter / 2
    permittivity = body.ceramic.relative_permittivity * VACUUM_PERMITTIVITY
    expected = permittivity * math.pi * (outer**2 - inner**2) / body.ceramic_thickness
    assert _capacitance(body) == pytest.approx(expected)


def test_stress_is_that_of_the_face_farther_from_the_neutral_axis(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    modulus = PLATE.actuator.ceramic.in_plane_stiffness
    for ceramics, distance in (
        ((True, False), 1.2e-3), ((False, True), 1.8e-3), ((True, True), 1.8e-3),
        ((False, False), 1.8e-3),
    ):  # fmt: skip
        monkeypatch.setattr(criteria, "ceramics_of", lambda body, known=ceramics: known)
        found = _stress(PLATE.actuator, moving(), SECTION, 2e-6)
        assert found == pytest.approx(modulus * (math.pi / 7e-3) ** 2 * distance * 2e-6)


def test_only_what_a_limit_asks_for_is_computed_of_a_solved_plate(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def solved(limits: Limits, neighbour: Any = None, load: Any = None) -> dict[str, float]:
        p: Any = SimpleNamespace(
            mode=SimpleNamespace(neighbour=neighbour),
            voltage=10.0,
            frequency=3e4,
            law=None,
            drive=None,
        )
        monkeypatch.setattr(criteria, "load_of_mode", lambda *given: load)
        asked: Any = SimpleNamespace(limits=limits)
        return criteria.numbers_of_solved(asked, PLATE, p)

    def area(*_: Any) -> Any:
        return SimpleNamespace(share_below=lambda wanted: wanted / 2)

    heard: list[Any] = [SimpleNamespace(level_dB=91.0)]

    def sound(display: Any, p: Any) -> Any:
        if heard[0] == "refused":
            raise InputError("none")
        return heard[0]

    monkeypatch.setattr(criteria, "active_area", area)
    monkeypatch.setattr(criteria, "ear_exposure", sound)
    monkeypatch.setattr(
        criteria, "uncertain_friction", lambda *_: SimpleNamespace(interval=(0.4, 0.8))
    )
    assert solved(Limits(confidence="nominal")) == {"neighbour": math.inf}
    load = SimpleNamespace(current=0.2)
    weak = SimpleNamespace(share=0.99 * criteria.CROWDED, distance=-3.0)
    assert solved(Limits(confidence="nominal"), weak, load) == {
        "current": 0.2, "neighbour": math.inf,
    }  # fmt: skip
    strong = SimpleNamespace(share=criteria.CROWDED, distance=-3.0)
    assert solved(Limits(confidence="nominal"), strong) == {"neighbour": 3.0}
    found = solved(Limits(least_area=0.5, confidence="nominal"))
    assert found["area"] == pytest.approx(0.35)
    found = solved(Limits(most_relative_friction=0.6, most_sound_level=100.0, confidence="95 %"))
    assert found == {
        "neighbour": math.inf, "area": 0.3, "sound_level": 91.0, "surest_friction": 0.8,
    }  # fmt: skip
    for heard[0] in (None, "refused"):
        assert "sound_level" not in solved(Limits(most_sound_level=100.0, confidence="nominal"))
