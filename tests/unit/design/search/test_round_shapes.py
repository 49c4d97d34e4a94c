from __future__ import annotations

import math

import pytest
from tests.unit.design.search.made_up import TEXT, drawn

from squeezefilm.core import config
from squeezefilm.core.errors import GeometryError, InputError
from squeezefilm.design.search.candidate import design_of, display_of
from squeezefilm.design.search.requirements import Requirements, load_requirements
from squeezefilm.design.search.shapes import Ring
from squeezefilm.physics.plate.layout import DiscPlate

RING = """
[[shapes]]
type = "ring"
least_diameters = 6
most_diameters = 9
[[shapes.sheets]]
material = "as described"
thicknesses = ["2 mm"]
[[shapes.ceramics]]
material = "PZT-5A"
thicknesses = ["0.5 mm"]
"""


def ring_requirements(width: str = "5 mm") -> Requirements:
    """A ring in place of the strips."""
    text = TEXT[: TEXT.index("[[shapes]]")].replace('"20 mm"', f'"{width}"')
    return config.load_text(Requirements, text + RING)


def test_a_disc_gives_the_workspace_and_its_ceramic_fits() -> None:
    discs = drawn(load_requirements("winfield2007-tpad"), 0, 20)
    assert discs
    for disc in discs:
        assert isinstance(disc, DiscPlate)
        # 15 mm for the centre of a contact of 10 mm.
        assert 0.025 - 1e-9 <= disc.diameter <= 0.04 + 1e-9
        assert disc.ceramic_outer_diameter <= disc.diameter


def test_a_rings_workspace_goes_once_round() -> None:
    rings = drawn(ring_requirements(), 0, 20)
    assert rings
    for ring in rings:
        assert ring.sectors == 2 * ring.nodal_diameters
        mean = (ring.diameter + ring.inner_diameter) / 2
        assert math.pi * mean >= 0.05 - 1e-3
        assert (ring.diameter - ring.inner_diameter) / 2 == pytest.approx(0.005)
        assert ring.ceramic_inner_diameter == ring.inner_diameter


def test_a_ring_takes_no_lengths_from_a_catalogue() -> None:
    text = TEXT[: TEXT.index("[[shapes]]")] + RING + 'lengths = ["9 mm"]\n'
    with pytest.raises(InputError, match="leave lengths out"):
        config.load_text(Requirements, text)


def test_a_track_that_closes_the_ring_is_refused() -> None:
    wanted = ring_requirements("40 mm")
    assert isinstance(wanted.shapes[0], Ring)
    space = wanted.spaces[0]
    with pytest.raises(GeometryError, match="closes a ring"):
        display_of(wanted, design_of(0, space.at({one.name: 0.0 for one in space.free})))
