"""Bodies as triangles: closed, without a double wall, and of the volume that they stand for."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import squeezefilm as sf
from squeezefilm.core.quantities import FloatArray
from squeezefilm.design.fabrication.step_file import (
    CHORD_ERROR,
    facets_round,
    triangles_of,
    volume_error,
)
from squeezefilm.physics.plate.parts import Part, Rectangle, Sector, parts_of


def body(footprint: Rectangle | Sector, thickness: float = 1e-3) -> Part:
    return Part("ceramic", 1, "PZT", 7700.0, footprint, -thickness, 0.0)


def is_closed(triangles: FloatArray) -> bool:
    """Whether each edge is met once in each direction, so that two triangles share it."""
    corners = [tuple(corner) for corner in triangles.reshape(-1, 3).tolist()]
    edges = Counter(
        (corners[3 * k + i], corners[3 * k + (i + 1) % 3])
        for k in range(len(triangles))
        for i in range(3)
    )
    return all(n == 1 and edges[b, a] == 1 for (a, b), n in edges.items())


def characteristic(triangles: FloatArray) -> int:
    """Euler's: corners less edges plus faces."""
    corners = {tuple(one) for one in triangles.reshape(-1, 3).tolist()}
    return len(corners) - 3 * len(triangles) // 2 + len(triangles)


def enclosed_volume(triangles: FloatArray) -> float:
    """By the divergence theorem; negative for a surface that looks inwards."""
    # About a corner of the body: far from the origin the terms would cancel.
    a, b, c = np.moveaxis(triangles - triangles[0, 0], 1, 0)
    return float(np.sum(a * np.cross(b, c)) / 6)


shapes = st.one_of(
    st.builds(
        Rectangle,
        st.floats(0, 0.1),
        st.floats(0, 0.1),
        st.floats(1e-4, 0.2),
        st.floats(1e-4, 0.2),
    ),
    st.builds(
        lambda outer, share, start, turn: Sector(share * outer, outer, start, start + turn),
        st.floats(1e-3, 0.05),
        st.one_of(st.just(0.0), st.floats(0.05, 0.95)),
        st.floats(-3, 3),
        st.one_of(st.just(2 * math.pi), st.floats(0.05, 6.0)),
    ),
)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(shapes, st.floats(1e-5, 5e-3))
def test_any_body_is_closed_and_holds_its_volume(
    footprint: Rectangle | Sector, thickness: float
) -> None:
    part = body(footprint, thickness)
    triangles = triangles_of(part)
    assert is_closed(triangles)
    holed = isinstance(footprint, Sector) and footprint.is_whole and footprint.inner_radius > 0
    assert characteristic(triangles) == (0 if holed else 2)
    left_out = volume_error(part)
    assert enclosed_volume(triangles) == pytest.approx(part.volume * (1 - left_out), rel=1e-9)


def test_a_circle_is_missed_by_less_than_said() -> None:
    for radius in (1e-3, 12.5e-3, 0.1):
        count = facets_round(radius)
        assert radius * (1 - math.cos(math.pi / count)) <= CHORD_ERROR * (1 + 1e-9)
        assert count % 4 == 0
    assert volume_error(body(Rectangle(0.0, 0.0, 1e-2, 1e-2))) == 0.0
    assert 0 < volume_error(body(Sector(0.0, 12.5e-3))) < 5e-4


@pytest.mark.parametrize("name", sf.display_names())
def test_every_preset_is_closed_bodies_that_fill_its_volume(name: str) -> None:
    parts = parts_of(sf.load_display(name).actuator)
    surfaces = [triangles_of(one) for one in parts]
    assert all(is_closed(one) for one in surfaces)
    whole = sum(enclosed_volume(one) for one in surfaces)
    assert whole == pytest.approx(sum(one.volume for one in parts), rel=5e-4)


def test_a_missing_triangle_and_one_turned_around_are_noticed() -> None:
    triangles = triangles_of(body(Rectangle(0.0, 0.0, 1e-2, 1e-2)))
    assert not is_closed(triangles[1:])
    turned = triangles.copy()
    turned[0] = turned[0, ::-1]
    assert not is_closed(turned)
    assert enclosed_volume(triangles[:, ::-1]) == pytest.approx(-enclosed_volume(triangles))
    assert np.isfinite(triangles).all()
