"""What actuators refuse because it cannot be, in a word of each message."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from squeezefilm.actuators.described import actuator_class, load_actuator
from squeezefilm.actuators.motor.description import MotorDescription, preset_motor
from squeezefilm.actuators.skin_stretch.array import held_forces
from squeezefilm.actuators.skin_stretch.bimorph import MOST_SLENDER, solid_bender
from squeezefilm.actuators.skin_stretch.cradle import pattern_voltages
from squeezefilm.actuators.skin_stretch.tissue import _rows, together
from squeezefilm.core.errors import ConfigError, InputError, OutOfRangeError
from squeezefilm.physics.render.texture.shapes import SineWave

ONES = np.ones(3)


def bimorph(**changes: Any) -> Any:
    array: Any = load_actuator("biet2008-skin-stretch")
    return dataclasses.replace(array.skin_stretch.actuator, **changes)


def voltages(times: Any) -> Any:
    array: Any = load_actuator("biet2008-skin-stretch")
    wave = SineWave(4e-3)
    return pattern_voltages(wave, array.skin_stretch.cradle, times, (0.05, 0.0), 100.0)


@pytest.mark.parametrize(
    ("build", "word"),
    [
        (lambda: held_forces(np.eye(2), ONES, ONES), "3 contactors have"),
        (lambda: held_forces(np.eye(3), ONES, np.ones(2)), "held"),
        (lambda: held_forces(-np.eye(3), 2 * ONES, ONES), "positive definite"),
        # Also where all contactors stick, or none touches.
        (lambda: held_forces(-np.eye(3), 0.5 * ONES, ONES), "positive definite"),
        (lambda: held_forces(-np.eye(3), ONES, 0 * ONES), "positive definite"),
        (
            lambda: solid_bender(bimorph(length=1.01 * MOST_SLENDER * bimorph().thickness)),
            "times as long as thick",
        ),
        (lambda: together(np.zeros(2), np.zeros(3)), "do not go together"),
        (lambda: _rows(np.zeros(2), np.zeros(3)), r"shapes \(2,\) and \(3,\)"),
        (lambda: _rows(np.zeros(0), np.zeros(0)), "at least one"),
        (lambda: voltages(np.zeros(0)), "times is empty"),
        (lambda: MotorDescription("a", "", "", 1.0), "no Motor"),  # type: ignore[arg-type]
        (lambda: actuator_class("[motor]\n[skin_stretch]\n"), "two files"),
        (lambda: actuator_class("[other]\n"), "motor"),
    ],
)
def test_what_cannot_be_is_refused(build: Callable[[], object], word: str) -> None:
    with pytest.raises((InputError, OutOfRangeError, ConfigError), match=word):
        build()


def test_a_bending_actuator_weighs_its_layers() -> None:
    bare = bimorph(electrode=None)
    shim = bare.shim.density * bare.shim_thickness
    layers = 2 * bare.ceramic.density * bare.ceramic_thickness + shim
    assert bare.mass == pytest.approx(layers * bare.length * bare.width)
    plated = bimorph(electrode=bare.shim, electrode_thickness=10e-6)
    layers += 2 * 10e-6 * bare.shim.density
    assert plated.mass == pytest.approx(layers * bare.length * bare.width)


def test_a_voltage_against_the_poling_has_its_limit() -> None:
    actuator = bimorph()
    most = actuator.largest_voltage
    for volts in (most, -most, 0.0):
        actuator.require_voltage(volts)
    for volts in (1.01 * most, -1.01 * most):
        with pytest.raises(OutOfRangeError, match="against its poling") as refused:
            actuator.require_voltage(volts)
        field = 1.01 * actuator.depolarising_field / 1e6
        assert f"puts {field:.3g} kV/mm on a" in str(refused.value)


def test_a_preset_of_a_motor_is_the_described_one() -> None:
    found = preset_motor("biet2008-motor")
    described: Any = load_actuator("biet2008-motor")
    assert found.motor == described.motor
    assert found.name == "biet2008-motor"
