"""Cells of a row of slices: every element once, every inner unknown once, ends shared by two."""

import numpy as np

from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.elements.slab_cells import cut
from squeezefilm.physics.plate.elements.slab_factor import SlabFactor
from squeezefilm.physics.plate.elements.slabs import Slabs
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.layers import COARSE
from squeezefilm.physics.plate.solid.mesh import plate_model
from squeezefilm.physics.plate.solid.symmetry import drive_classes


def paper() -> Slabs:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    (parity, *_) = drive_classes(plate)
    return plate_model(plate, 40e3, COARSE, parity).slabs


def test_a_plate_is_cut_into_every_element_once() -> None:
    slabs = paper()
    cells = cut(slabs)
    assert [e for cell in cells for e in cell] == list(range(slabs.model.x.elements))
    assert max(len(cell) for cell in cells) > 1


def test_places_of_a_cell_have_its_unknowns_in_its_order() -> None:
    slabs = paper()
    groups = SlabFactor(slabs, (2 * np.pi * 33e3) ** 2)._groups
    assert max(group.count for group in groups) >= 3
    seen = np.zeros(slabs.unknowns, dtype=int)
    mirrored = 0
    for group in groups:
        first, last = group.ends
        inner = group.at[first.stop : last.start]
        assert group.inside(0, len(group.stops) - 2) == slice(first.stop, last.start)
        np.add.at(seen, inner.ravel(), 1)
        for number in range(group.count):
            at, signs = group.at[:, number], group.signs[:, number, 0]
            if at[0] > at[-1]:
                mirrored += 1
                # Turned around along x, u changes its sign and nothing else does.
                np.testing.assert_array_equal(signs < 0, slabs.components[at] == 0)
            else:
                assert np.all(signs == 1)
    ends = np.flatnonzero(seen == 0)
    nodes = np.searchsorted(slabs.offsets, ends, side="right") - 1
    assert np.all(seen <= 1)
    assert np.unique(nodes).size == sum(group.count for group in groups) + 1
    assert mirrored > 0
