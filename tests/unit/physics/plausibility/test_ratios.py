"""What is compared of a display: every ratio beside its own quotient, in their order."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import pytest

from squeezefilm.core.materials import Gas
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.plate.layout import CeramicPatch, GlueLayer, RectangularPlate
from squeezefilm.physics.plausibility.expected import expectation, ratios


def listed(display: Display, voltage: float | None = None) -> list[tuple[str, str, float]]:
    return [(one.of, ".".join(map(str, one.path)), one.value) for one in ratios(display, voltage)]


def assert_listed(found: Any, *expected: tuple[str, str, float]) -> None:
    assert [(of, at) for of, at, _ in found] == [(of, at) for of, at, _ in expected]
    for (of, _, value), (*_, wanted) in zip(found, expected, strict=True):
        assert value == pytest.approx(wanted), of


def plate_display() -> tuple[Display, RectangularPlate]:
    """The paper's with two unlike ceramics on glue, the second thinner, and dense metal."""
    display = load_display("biet2008-plate")
    assert isinstance(display.actuator, RectangularPlate)
    first = CeramicPatch(8e-3, 0.0, 10e-3, 20e-3, 1e-3)
    second = CeramicPatch(30e-3, 0.0, 5e-3, 10e-3, 0.8e-3)
    plate = dataclasses.replace(
        display.actuator,
        length=60e-3, width=20e-3, thickness=1.5e-3, patches=(first, second),
        glue=GlueLayer(thickness=20e-6, young_modulus=3e9, poisson_ratio=0.35, density=1200.0),
        substrate=dataclasses.replace(display.actuator.substrate, density=8400.0),
    )  # fmt: skip
    return dataclasses.replace(display, actuator=plate), plate


def test_of_a_plate() -> None:
    display, plate = plate_display()
    speed = math.sqrt(plate.substrate.young_modulus / 8400.0)
    ceramic = math.sqrt(plate.ceramic.in_plane_stiffness / plate.ceramic.density)
    seen = expectation(plate)
    assert seen is not None
    found = listed(display, 30.0)
    of_plate = [
        ("plate thickness over its shorter side", "actuator.thickness", 1.5 / 20),
        ("plate thickness over its longer side", "actuator.thickness", 1.5 / 60),
        ("area of ceramics over that of the plate", "actuator.patches", 250 / 1200),
    ]
    for number, (length, width, thick), (longer, wider, thicker) in (
        (0, (10, 20, 1.0), (2.0, 2.0, 1.25)),
        (1, (5, 10, 0.8), (0.5, 0.5, 0.8)),
    ):
        at = f"actuator.patches.{number}"
        of_plate += [
            ("ceramic over plate thickness", f"{at}.thickness", thick / 1.5),
            ("ceramic side over its thickness", f"{at}.length", length / thick),
            ("ceramic side over its thickness", f"{at}.width", width / thick),
            ("ceramic size over its neighbours'", f"{at}.length", longer),
            ("ceramic size over its neighbours'", f"{at}.width", wider),
            ("ceramic size over its neighbours'", f"{at}.thickness", thicker),
        ]
    of_plate += [
        ("glue over ceramic thickness", "actuator.glue.thickness", 20 / 800),
        ("glued film's thickness", "actuator.patches.1.thickness", 0.8e-3),
        ("wave speed of the substrate", "actuator.substrate.young_modulus", speed),
        ("wave speed of a dense substrate", "actuator.substrate.young_modulus", speed),
        ("wave speed of the ceramic", "actuator.ceramic.in_plane_stiffness", ceramic),
        ("field in the ceramic", "drive.voltage", 30.0 / 0.8e-3),
        ("expected frequency", "actuator.nodal_lines", seen.nearest_frequency),
    ]
    assert_listed(found[: len(of_plate)], *of_plate)


def test_of_what_is_expected_of_a_plate_at_a_voltage() -> None:
    display = load_display("biet2008-plate")
    seen = expectation(display.actuator)
    assert seen is not None
    assert seen.half_wavelength_over_thickness is not None
    assert seen.amplitude_per_volt is not None
    assert seen.power_per_mass is not None
    expected = (
        ("expected frequency", "actuator.nodal_lines", seen.nearest_frequency),
        (
            "half wave over plate thickness",
            "actuator.nodal_lines",
            seen.half_wavelength_over_thickness,
        ),
        ("expected amplitude", "drive.voltage", 30.0 * seen.amplitude_per_volt),
        ("expected power per mass", "drive.voltage", 900.0 * seen.power_per_mass),
    )
    found = listed(display, 30.0)
    names = [of for of, *_ in found]
    begin = names.index("expected frequency")
    assert_listed(found[begin : begin + 4], *expected)
    assert listed(display)[begin - 1][2] == pytest.approx(display.drive.voltage / 1e-3)


def test_of_finger_and_gas() -> None:
    display, _ = plate_display()
    finger = display.finger
    gas = Gas(2e-5, 90e3, 1.1, 70e-9)
    found = listed(dataclasses.replace(display, gas=gas))
    # Maxwell's mean free path: µ/p √(π R T/2) with R T = p/ρ.
    kinetic = 2e-5 / 90e3 * math.sqrt(math.pi * 90e3 / 1.1 / 2)
    assert_listed(
        found[-4:],
        (
            "plateau over ridge period",
            "finger.plateau_width",
            finger.plateau_width / finger.ridge_period,
        ),
        ("pressure under the finger", "finger.contact_length", finger.mean_pressure),
        ("gas density over pressure", "gas.density", 1.1 / 90e3),
        ("mean free path over the kinetic one", "gas.mean_free_path", 70e-9 / kinetic),
    )


def test_of_a_disc_and_a_stator() -> None:
    disc: Any = load_display("winfield2007-tpad")
    thick = disc.actuator.ceramic_thickness
    found = listed(disc)
    assert_listed(
        found[:2],
        (
            "ceramic over plate thickness",
            "actuator.ceramic_thickness",
            thick / disc.actuator.thickness,
        ),
        (
            "plate thickness over its shorter side",
            "actuator.thickness",
            disc.actuator.thickness / disc.actuator.diameter,
        ),
    )
    volts = {of: value for of, _, value in found}["field in the ceramic"]
    assert volts == pytest.approx(disc.drive.voltage / thick)
    stator: Any = load_display("biet2008-stator")
    ring = stator.actuator
    assert_listed(
        listed(stator)[:2],
        (
            "speed of the stator's wave",
            "actuator.wavelength",
            ring.wavelength * ring.resonance_frequency,
        ),
        (
            "radial width over mean diameter",
            "actuator.radial_width",
            ring.radial_width / ring.mean_diameter,
        ),
    )
