from __future__ import annotations

import itertools
import math
from typing import Any

import pytest
from tests.unit.design.search.made_up import TEXT, drawn, requirements

from squeezefilm.core import config
from squeezefilm.core.errors import GeometryError, InputError
from squeezefilm.design.search.candidate import design_of, display_of
from squeezefilm.design.search.requirements import Requirements, load_requirements
from squeezefilm.design.search.shapes import EdgeStrips
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import RectangularPlate

_STOCK = 'thicknesses = ["0.5 mm", "1 mm"]'


def test_strips_are_one_fewer_than_the_lines_and_fill_the_plate() -> None:
    for plate in drawn(requirements(), 0):
        assert isinstance(plate, RectangularPlate)
        assert len(plate.patches) == plate.nodal_lines - 1
        assert plate.patches[0].x == pytest.approx(0, abs=1e-12)
        last = plate.patches[-1]
        assert last.x + last.length == pytest.approx(plate.length)
        signs = [one.polarity for one in plate.patches]
        assert signs == [(-1) ** k for k in range(len(signs))]


def test_every_length_is_a_whole_number_of_steps_and_the_plate_is_its_own_mirror_image() -> None:
    """As a workshop reads it: no 15.237500000000001 mm, in whatever file it is written."""
    wanted = requirements(**{"most_lines = 9": "most_lines = 9\nleast_cover = 0.5"})
    for one in (wanted, load_requirements("touchpad-glass")):
        for plate in drawn(one, 0):
            assert isinstance(plate, RectangularPlate)
            for patch in plate.patches:
                for length in (patch.x, patch.y, patch.length, patch.width):
                    assert length == round(length * 20_000) / 20_000
            begins = sorted(patch.x for patch in plate.patches)
            ends = sorted(plate.length - patch.x - patch.length for patch in plate.patches)
            assert begins == pytest.approx(ends, abs=1e-12)
            in_row = [patch for patch in plate.patches if patch.y == 0]
            for before, after in itertools.pairwise(in_row):
                assert after.x - before.x - before.length > 1e-3 - 5.1e-5


def test_the_papers_own_plate_is_in_its_space() -> None:
    wanted, paper = load_requirements("biet2008-plate"), load_display("biet2008-plate").actuator
    values = {
        "substrate": "as described",
        "thickness": 2e-3,
        "ceramic": "as described",
        "ceramic_thickness": 1e-3,
        "nodal_lines": 8.0,
        "width": 0.049,
        "length": 0.083,
        "cover": 1.0,
        "voltage": 15.0,
    }
    found = display_of(wanted, design_of(0, values)).actuator
    assert isinstance(found, RectangularPlate)
    assert isinstance(paper, RectangularPlate)
    assert found.substrate == paper.substrate
    for ours, theirs in zip(found.patches, paper.patches, strict=True):
        assert (ours.x, ours.length, ours.polarity) == pytest.approx(
            (theirs.x, theirs.length, theirs.polarity)
        )


def test_a_bimorphs_upper_ceramics_are_driven_against_the_lower_ones() -> None:
    wanted = requirements(**{'type = "strips"': 'type = "strips"\nboth_faces = true'})
    for plate in drawn(wanted, 0, 5):
        assert isinstance(plate, RectangularPlate)
        half = len(plate.patches) // 2
        for below, above in zip(plate.patches[:half], plate.patches[half:], strict=True):
            assert (above.face, above.x, above.polarity) == ("top", below.x, -below.polarity)


def test_edge_strips_go_with_the_number_of_lines() -> None:
    wanted = load_requirements("touchpad-glass")
    plates = drawn(wanted, 0, 12)
    assert plates
    for plate in plates:
        assert isinstance(plate, RectangularPlate)
        low, high = plate.patches
        assert high.polarity == (1 if plate.nodal_lines % 2 == 0 else -1)
        assert high.y + high.width == pytest.approx(plate.width)
        assert low.length == pytest.approx(plate.length)
        rim = sum(one.length * one.width for one in plate.supports)
        w = 1e-3
        assert rim == pytest.approx(2 * w * (plate.length + plate.width - 2 * w))


def test_a_catalogue_makes_the_length() -> None:
    wanted = requirements(**{_STOCK: 'thicknesses = ["1 mm"]\nlengths = ["9 mm", "11 mm"]'})
    plates = drawn(wanted, 0)
    assert plates
    for plate in plates:
        assert isinstance(plate, RectangularPlate)
        assert plate.patches[0].length in (0.009, 0.011)
        assert 0.06 - 1e-9 <= plate.length <= 0.09 + 1e-9


def test_no_ceramic_begins_before_the_plate_by_a_rounding_error() -> None:
    # Cut to 0.1 mm, a piece may fill its pitch to the last bit and one more.
    wanted = requirements()
    space = wanted.spaces[0]
    base = space.at({one.name: 0.5 for one in space.free})
    built = 0
    for lines, tenths in itertools.product((5.0, 6.0, 7.0, 8.0, 9.0), range(300, 900, 3)):
        values = {**base, "nodal_lines": lines, "length": tenths * 1e-4, "cover": 0.99}
        try:
            plate = display_of(wanted, design_of(0, values)).actuator
        except GeometryError:
            continue  # A cut piece leaves too little of a gap.
        assert isinstance(plate, RectangularPlate)
        assert plate.patches[0].x >= 0
        built += 1
    assert built > 300


def test_ceramics_that_do_not_fit_say_so() -> None:
    wanted = requirements(**{_STOCK: 'thicknesses = ["1 mm"]\nlengths = ["40 mm"]'})
    space = wanted.spaces[0]
    values = space.at({one.name: 0.99 for one in space.free})
    with pytest.raises(GeometryError, match="8 ceramics of 40 mm"):
        display_of(wanted, design_of(0, values))


def test_lengths_for_some_ceramics_only_are_refused() -> None:
    text = (
        TEXT
        + '[[shapes.ceramics]]\nmaterial = "PZT-5A"\nthicknesses = ["1 mm"]\nlengths = ["9 mm"]'
    )
    with pytest.raises(InputError, match="some ceramics have lengths"):
        config.load_text(Requirements, text)


def test_people_can_tell_shapes_of_one_type_apart() -> None:
    names = [one.shape for one in load_requirements("biet2008-plate").spaces]
    assert names == ["strips on one face", "strips on both faces"]
    (glass,) = load_requirements("touchpad-glass").spaces
    assert glass.shape == "edge strips"


@pytest.mark.parametrize("name", ["biet2008-plate", "touchpad-glass"])
def test_a_fingers_centre_explores_the_workspace(name: str) -> None:
    """Whatever is drawn, half of the contact is on the plate beyond the workspace."""
    wanted = load_requirements(name)
    contact = math.sqrt(wanted.base.finger.contact_area())
    plates = drawn(wanted, 0)
    assert plates
    for plate in plates:
        assert plate.length - contact >= wanted.workspace.length - 1e-9
        assert plate.width - contact >= wanted.workspace.width - 1e-9


def test_two_strips_that_leave_nothing_between_them_are_refused() -> None:
    own: Any = requirements().shapes[0]
    glass = EdgeStrips(own.sheets, own.ceramics, 5, 9)
    values = {
        "nodal_lines": 5, "strip": 20e-3, "length": 100e-3, "width": 40e-3,
        "ceramic_thickness": 1e-3,
    }  # fmt: skip
    unused: Any = None
    with pytest.raises(GeometryError, match=r"two strips of 20 mm leave nothing of .* 40 mm"):
        glass.body(values, unused, 1.0, unused)
