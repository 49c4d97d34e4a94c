"""Nodal lines for supports are those of the mode."""

from __future__ import annotations

import math

import numpy as np
import pytest

import squeezefilm as sf
from squeezefilm.design.fabrication.wiring import nodal_lines_of
from squeezefilm.physics.plate.layout import RectangularPlate, turned
from squeezefilm.physics.plate.working_mode import working_mode


def test_of_a_plate_as_many_as_its_mode_has_along_the_right_axis() -> None:
    plate = sf.load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    mode = working_mode(plate, "timoshenko")
    found = nodal_lines_of(plate, mode)
    assert (found.axis, len(found.positions)) == ("x", plate.nodal_lines)
    # The plate is the same from both ends.
    assert found.positions == pytest.approx(
        plate.length - np.array(found.positions)[::-1], abs=1e-6
    )
    other = turned(plate)
    assert nodal_lines_of(other, working_mode(other, "timoshenko")).axis == "y"


def test_of_a_disc_its_circle_lies_where_a_free_disc_has_it() -> None:
    disc = sf.load_display("winfield2007-tpad").actuator
    found = nodal_lines_of(disc, working_mode(disc))
    (radius,) = found.radii
    # A thin free disc has it at 0.68 of its radius (Leissa); this one is thick.
    assert radius / 12.5e-3 == pytest.approx(0.68, abs=0.02)
    assert found.angles == ()


def test_of_a_stator_two_for_each_wave() -> None:
    stator = sf.load_display("biet2008-stator").actuator
    angles = nodal_lines_of(stator, working_mode(stator)).angles
    assert len(angles) == 18
    assert np.diff(angles) == pytest.approx(math.pi / 9)
