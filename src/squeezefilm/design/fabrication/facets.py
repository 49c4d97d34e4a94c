"""Bodies as triangles, closed and looking outwards, and as STL; how far a circle is missed."""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.plate.parts import WHOLE_TURN, Part, Rectangle, Sector

CHORD_ERROR: si.Metre = 1e-6
"""Largest distance between the middle of a facet and the circle that it stands for, inside it."""
_MOST_FACETS = 4000
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


@si.checked_numbers
def facets_round(radius: Annotated[si.Metre, si.Above(0.0)]) -> int:
    """Number of facets round a circle so that none is further than `CHORD_ERROR` inside of it; a
    multiple of 4, at most 4000."""
    ratio = min(CHORD_ERROR / radius, 1.0)
    count = math.ceil(math.pi / math.acos(1 - ratio) / 4) * 4
    return min(max(count, 16), _MOST_FACETS)


@si.checked_numbers
def volume_error(part: Part) -> si.Dimensionless:
    """The share of a part's volume that its facets leave out: 1 − sin φ/φ for facets of an angle φ;
    0 for a rectangle."""
    shape = part.footprint
    if isinstance(shape, Rectangle):
        return 0.0
    angle = (shape.end - shape.start) / _steps(shape)
    return 1 - math.sin(angle) / angle


def triangles_of(part: Part) -> si.FloatArray:
    """A part's surface as triangles, shape (triangles, corners 3, coordinates 3) (m), each going
    round anticlockwise as seen from outside."""
    rim, hole = _outline(part.footprint)
    whole = isinstance(part.footprint, Sector) and part.footprint.is_whole
    closed = isinstance(part.footprint, Rectangle) or whole
    lids = _lid(rim, hole, closed)
    low, high = (np.full(len(lids), z) for z in (part.bottom, part.top))
    faces = [_at(lids, high), _at(lids[:, ::-1], low)]
    # Walls: around the rim with it, around the hole against it, and the two ends of a sector.
    loops = [(rim, closed)]
    if hole is not None and len(hole) > 1:
        loops.append((hole[::-1], closed))
        if not closed:
            loops += [(np.array([rim[-1], hole[-1]]), False), (np.array([hole[0], rim[0]]), False)]
    elif hole is not None:
        loops += [(np.array([rim[-1], hole[0]]), False), (np.array([hole[0], rim[0]]), False)]
    for points, goes_round in loops:
        faces.append(_wall(points, goes_round, part.bottom, part.top))
    return np.concatenate(faces)


def _steps(shape: Sector) -> int:
    share = (shape.end - shape.start) / WHOLE_TURN
    return max(2, math.ceil(share * facets_round(shape.outer_radius) * (1 - 1e-12)))


def _outline(shape: Rectangle | Sector) -> tuple[si.FloatArray, si.FloatArray | None]:
    """The rim anticlockwise, shape (points, 2), and the hole's rim facet by facet beside it: None
    without a hole, one point where a sector comes to one."""
    if isinstance(shape, Rectangle):
        x, y = (shape.x, shape.x + shape.length), (shape.y, shape.y + shape.width)
        return np.array([(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])]), None
    count = _steps(shape)
    angles = shape.start + (shape.end - shape.start) * np.arange(count + 1) / count
    turn = np.column_stack([np.cos(angles), np.sin(angles)])
    turn = turn[:-1] if shape.is_whole else turn
    if shape.inner_radius > 0:
        return shape.outer_radius * turn, shape.inner_radius * turn
    return shape.outer_radius * turn, None if shape.is_whole else np.zeros((1, 2))


def _lid(rim: si.FloatArray, hole: si.FloatArray | None, closed: bool) -> si.FloatArray:
    """The face seen from above, shape (triangles, 3, 2)."""
    if hole is None:
        return np.stack([np.broadcast_to(rim[0], rim[2:].shape), rim[1:-1], rim[2:]], axis=1)
    after = np.roll(rim, -1, axis=0) if closed else rim[1:]
    before = rim if closed else rim[:-1]
    if len(hole) == 1:
        return np.stack([np.broadcast_to(hole[0], before.shape), before, after], axis=1)
    within = np.roll(hole, -1, axis=0) if closed else hole[1:]
    inner = hole if closed else hole[:-1]
    return np.concatenate(
        [np.stack([inner, before, after], axis=1), np.stack([inner, after, within], axis=1)]
    )


def _at(flat: si.FloatArray, height: si.FloatArray) -> si.FloatArray:
    z = np.broadcast_to(height[:, None, None], (len(flat), 3, 1))
    return np.concatenate([flat, z], axis=2)


def _wall(points: si.FloatArray, closed: bool, bottom: si.Metre, top: si.Metre) -> si.FloatArray:
    """The upright wall along points that go anticlockwise about the body."""
    after = np.roll(points, -1, axis=0) if closed else points[1:]
    before = points if closed else points[:-1]
    z = (np.full((len(before), 1), bottom), np.full((len(before), 1), top))
    low, high = (np.hstack([before, height]) for height in z)
    low_after, high_after = (np.hstack([after, height]) for height in z)
    return np.concatenate(
        [np.stack([low, low_after, high_after], axis=1), np.stack([low, high_after, high], axis=1)]
    )


@si.checked_numbers
def stl_bytes(triangles: si.MetreArray, title: str) -> bytes:
    """A binary STL of triangles (m), shape (triangles, 3, 3), each anticlockwise from outside.

    `title` stands in the header, 80 bytes of ASCII. Single precision: corners within 6e-8 of their
    size. Raises `InputError` for another shape.
    """
    if triangles.ndim != 3 or triangles.shape[1:] != (3, 3):
        raise InputError(
            f"triangles of the shape {triangles.shape} are none; give corners by coordinates, "
            "(triangles, 3, 3)",
            quantity="triangles",
        )
    scaled = 1e3 * np.asarray(triangles, dtype=float)
    normal = np.cross(scaled[:, 1] - scaled[:, 0], scaled[:, 2] - scaled[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    records = np.zeros(len(scaled), dtype=_RECORD)
    records["normal"] = normal / np.where(length > 0, length, 1.0)
    records["corners"] = scaled
    # A header that begins with "solid" would be taken for a file in words.
    head = f"millimetres; {title}".encode("ascii", "replace")[:80].ljust(80)
    return head + len(records).to_bytes(4, "little") + records.tobytes()
