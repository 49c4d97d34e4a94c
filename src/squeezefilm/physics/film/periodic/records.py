"""What the compiled solvers of periodic films are given, in records."""

from __future__ import annotations

from typing import NamedTuple

from squeezefilm.core import quantities as si


class Times(NamedTuple):
    """The collocation times of a period: how many, the length of their padded row, the transposed
    Fourier differentiation matrix, and one minus the unit matrix, both flattened."""

    number: int
    row: int
    derivative: si.FloatArray
    mask: si.FloatArray


class Cells(NamedTuple):
    """Conductance of the faces, σ × volume of the cells, and the share of the area of each node."""

    conductance: si.FloatArray
    volume: si.FloatArray
    share: si.FloatArray


class Gap(NamedTuple):
    """The gap at nodes and faces, its cube there, and the weights of p in the mean load; rows of
    times with `stride` from one node to the next, 0 where the gap does not depend on position."""

    node: si.FloatArray
    face: si.FloatArray
    face_cubed: si.FloatArray
    weight: si.FloatArray
    stride: int


class Room(NamedTuple):
    """Memory for a solve: rows of times, and the inverses of the diagonal blocks."""

    rows: si.FloatArray
    blocks: si.FloatArray


class Resolution(NamedTuple):
    """Cells of the finest grid, its times, and the times that check them on the coarsest grid."""

    cells: int
    times: Times
    check: Times
