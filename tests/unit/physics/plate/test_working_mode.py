"""The one mode a display works in, whatever body solved it."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.physics.plate.layout import DiscPlate
from squeezefilm.physics.plate.ring.body import nodal_circles, ring_body
from squeezefilm.physics.plate.working_mode import working_mode


def test_a_disc_moves_alike_on_both_sides_of_its_middle(disc: DiscPlate) -> None:
    line = working_mode(disc).line
    assert line is not None
    x, w = line.position, line.deflection
    assert x[0] == -x[-1]
    assert np.all(np.diff(x) > 0)
    assert np.abs(w).max() == pytest.approx(1.0, rel=1e-3)
    even = 1.0 if ring_body(disc).mode().harmonic % 2 == 0 else -1.0
    assert np.interp(-x, x, w) == pytest.approx(even * w, abs=1e-9)
    nodes = np.sort(line.nodal_positions)
    assert nodes == pytest.approx(-nodes[::-1])
    assert np.interp(nodes, x, w) == pytest.approx(np.zeros(nodes.size), abs=1e-3)
    assert nodes.size == 2 * nodal_circles(ring_body(disc).mode()).size
