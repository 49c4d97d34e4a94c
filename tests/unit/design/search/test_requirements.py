from __future__ import annotations

import dataclasses
import math

import pytest
from tests.unit.design.search.made_up import requirements

from squeezefilm.core import presets
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.design.search.candidate import shared_sources
from squeezefilm.design.search.requirements import load_requirements
from squeezefilm.design.search.stock import material_named
from squeezefilm.design.search.store import asked_hash
from squeezefilm.physics.display import DECAY_LENGTH


@pytest.mark.parametrize("name", presets.names("requirements"))
def test_the_presets_can_be_read(name: str) -> None:
    wanted = load_requirements(name)
    assert wanted.name == name
    assert all(space.free for space in wanted.spaces)
    assert wanted.base.finger.speed == wanted.touch.speed


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('least_frequency = "20 kHz"', 'least_frequencey = "20 kHz"', "least_frequency"),
        ('least_frequency = "20 kHz"', "least_frequency = 20", "Hz"),
        ('length = "50 mm"', 'length = "85 mm"', "needs 95 mm, 5 mm more at either end"),
        ('material = "aluminium 6061"', 'material = "aluminum 6060"', "no material"),
        ("most_lines = 9", "most_lines = 4", "which is least_lines"),
        ('least_voltage = "5 V"', 'least_voltage = "50 V"', "which is voltage"),
        ("[limits]", '[limits]\nmost_frequency = "19 kHz"', "which is most_frequency"),
        ('start_from = "biet2008-plate"', 'start_from = "biet2008-stator"', "measured ring"),
        ('compare_with = ""', 'compare_with = "biet2008-stator"', "compare_with.*measured ring"),
        ('compare_with = ""', 'compare_with = "biet2008-plat"', "compare_with.*Did you mean"),
        ('material = "aluminium 6061"', 'material = "as described"', "twice"),
        ("[limits]", 'objectives = ["power"]\n[limits]', "two or three"),
        ('type = "strips"', 'type = "hexagon"', "edge_strips"),
    ],
)
def test_what_cannot_be_meant_is_refused(old: str, new: str, said: str) -> None:
    with pytest.raises((ConfigError, InputError), match=said):
        requirements(**{old: new})


def test_a_name_that_is_none_is_answered_with_those_there_are() -> None:
    with pytest.raises(ConfigError, match="Did you mean 'biet2008-plate'"):
        load_requirements("biet2008-plat")


def test_materials_are_those_of_the_library_or_of_the_display() -> None:
    own = requirements().own
    assert material_named("as described", "substrate", own) is own.substrate
    assert material_named("aluminium 6061", "substrate", own).density == pytest.approx(2700)
    assert material_named("PZT-5A", "ceramic", own).density == pytest.approx(7750)


def test_a_search_may_be_for_the_mean_of_people() -> None:
    mean = dataclasses.replace(requirements(), finger="mean")
    assert mean.base.whose_finger.startswith("the mean of people")
    assert any("finger: the mean of people" in said for said in mean.assumed)
    # What was kept for a new person is not taken for the mean.
    assert asked_hash(mean, "solved") != asked_hash(requirements(), "solved")
    assert shared_sources(mean)[DECAY_LENGTH].source == mean.base.whose_finger


def test_the_finger_of_the_requirements_is_that_of_the_display() -> None:
    touched = requirements(**{"[limits]": 'touch = { normal_force = "1 N" }\n[limits]'})
    finger = touched.base.finger
    assert finger.normal_force == 1.0
    # The contact grows with the force from the area that the display's own force has.
    assert math.sqrt(finger.contact_area()) > finger.contact_length


def test_a_search_among_no_shapes_is_refused() -> None:
    with pytest.raises(InputError, match="shapes is empty; give at least one"):
        dataclasses.replace(requirements(), shapes=())
