"""Boundary-fitted finite volumes for the film in the plane: rectangle, disc, ellipse.

Every grid is a product of two coordinates, row by row: `rows` × `columns` nodes, node (i, j) at
index i · columns + j. Rows are eliminated one after the other, so the columns take the direction
with fewer nodes. The coordinates are orthogonal (Cartesian, polar, confocal elliptic), so that a
cell exchanges gas with its four neighbours only, and the boundary is a coordinate line: no
staircase. On a quarter, the lines of symmetry are walls.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from squeezefilm.film.line_grid import edge_graded, edge_layer
from squeezefilm.quantities import FloatArray, IntArray, require


@dataclass(frozen=True)
class PlanarGrid:
    """Nodes, the faces between them, and the faces on the open edge.

    Per node (rows·columns,): `X`, `Y`, `area`. Per face between two rows, of the same column,
    ((rows−1)·columns,): `row_*`, the first belonging to the lower row. Per face within a row (k,):
    `column_*` and the nodes `column_from`, `column_to`. Per face on the edge, where P = 1:
    `edge_*` and the node `edge_node`. A conductance is face length over distance between nodes.
    """

    rows: int
    columns: int
    quarter: bool
    X: FloatArray
    Y: FloatArray
    area: FloatArray
    row_X: FloatArray
    row_Y: FloatArray
    row_conductance: FloatArray
    column_from: IntArray
    column_to: IntArray
    column_X: FloatArray
    column_Y: FloatArray
    column_conductance: FloatArray
    edge_node: IntArray
    edge_X: FloatArray
    edge_Y: FloatArray
    edge_conductance: FloatArray


def _build(
    u: FloatArray,
    v: FloatArray,
    place: Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]],
    across_rows: Callable[[FloatArray], FloatArray],
    across_columns: Callable[[FloatArray], FloatArray],
    area: FloatArray,
    *,
    quarter: bool,
    first_row_open: bool,
    first_column_open: bool,
    last_column_open: bool,
    join: str = "",
) -> PlanarGrid:
    """A grid from its coordinate lines: `u` (2 rows + 1,), `v` (2 columns + 1,), faces at even
    places and nodes at odd ones. `across_rows(u)` multiplies Δv/Δu in the conductance of a face
    between rows, `across_columns(u)` multiplies Δu/Δv. The last row is always open.
    """
    u_face, u_node, v_face, v_node = u[::2], u[1::2], v[::2], v[1::2]
    rows, columns = u_node.size, v_node.size
    du, dv = np.diff(u_face), np.diff(v_face)
    index = np.arange(rows * columns).reshape(rows, columns)

    def grid(a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
        x, y = place(a[:, None], b[None, :])
        shape = (a.size, b.size)
        return (
            np.ascontiguousarray(np.broadcast_to(x, shape)).ravel(),
            np.ascontiguousarray(np.broadcast_to(y, shape)).ravel(),
        )

    X, Y = grid(u_node, v_node)
    row_X, row_Y = grid(u_face[1:-1], v_node)
    row_G = (across_rows(u_face[1:-1]) / np.diff(u_node))[:, None] * dv
    col_X, col_Y = grid(u_node, v_face[1:-1])
    weight = across_columns(u_node) * du
    col_G = weight[:, None] / np.diff(v_node)
    pieces_from, pieces_to = [index[:, :-1].ravel()], [index[:, 1:].ravel()]
    pieces = [(col_X, col_Y, col_G.ravel())]
    if join:
        # A full turn: the last column meets the first.
        x, y = grid(u_node, v_face[-1:])
        turn = v_node[0] - v_node[-1] + 2 * np.pi
        pieces_from.append(index[:, -1])
        pieces_to.append(index[:, 0])
        pieces.append((x, y, weight / turn))
    if join == "segment":
        # The line between the foci: above and below it lie columns ν and −ν of the first row.
        half = columns // 2
        x, y = grid(u_face[:1], v_node[:half])
        pieces_from.append(index[0, :half])
        pieces_to.append(index[0, ::-1][:half])
        pieces.append((x, y, dv[:half] / (2 * u_node[0])))
    edges = [
        (
            index[-1],
            grid(u_face[-1:], v_node),
            across_rows(u_face[-1:]) / (u_face[-1] - u_node[-1]) * dv,
        )
    ]
    if first_row_open:
        edges.append(
            (
                index[0],
                grid(u_face[:1], v_node),
                across_rows(u_face[:1]) / (u_node[0] - u_face[0]) * dv,
            )
        )
    if last_column_open:
        edges.append((index[:, -1], grid(u_node, v_face[-1:]), weight / (v_face[-1] - v_node[-1])))
    if first_column_open:
        edges.append((index[:, 0], grid(u_node, v_face[:1]), weight / (v_node[0] - v_face[0])))
    return PlanarGrid(
        rows=rows,
        columns=columns,
        quarter=quarter,
        X=X,
        Y=Y,
        area=area.ravel(),
        row_X=row_X,
        row_Y=row_Y,
        row_conductance=row_G.ravel(),
        column_from=np.concatenate(pieces_from),
        column_to=np.concatenate(pieces_to),
        column_X=np.concatenate([p[0] for p in pieces]),
        column_Y=np.concatenate([p[1] for p in pieces]),
        column_conductance=np.concatenate([p[2] for p in pieces]),
        edge_node=np.concatenate([e[0] for e in edges]),
        edge_X=np.concatenate([e[1][0] for e in edges]),
        edge_Y=np.concatenate([e[1][1] for e in edges]),
        edge_conductance=np.concatenate([e[2] for e in edges]),
    )


def graded_line(
    count: int, half: float, squeeze_number: float, *, mirror: bool, least: float = 2e-3
) -> FloatArray:
    """2 count + 1 points (faces and nodes in turn) from 0 or −half to half, graded to the edge.

    `squeeze_number` is on the length that `half` is measured in. `least` bounds from below the
    share of the half width that takes half the cells.
    """
    layer = edge_layer(squeeze_number * half**2, least)
    if not mirror:
        return half * edge_graded(2 * count, layer)
    fine = half * edge_graded(count, layer)
    return np.concatenate([-fine[:0:-1], fine])


def rectangle_grid(x: FloatArray, y: FloatArray, *, quarter: bool = True) -> PlanarGrid:
    """A rectangle with open sides; `x`, `y` give faces and nodes in turn (2 cells + 1,).

    On a quarter both start at 0, which is then a line of symmetry. Rows lie along X.
    """
    area = np.diff(x[::2])[:, None] * np.diff(y[::2])
    return _build(
        x,
        y,
        lambda a, b: (a, b),
        np.ones_like,
        np.ones_like,
        area,
        quarter=quarter,
        first_row_open=not quarter,
        first_column_open=not quarter,
        last_column_open=True,
    )


def _turn(count: int, quarter: bool) -> FloatArray:
    return np.asarray(np.linspace(0.0, np.pi / 2 if quarter else 2 * np.pi, 2 * count + 1))


def disc_grid(
    squeeze_number: float, counts: tuple[int, int], *, quarter: bool = True, least: float = 2e-3
) -> PlanarGrid:
    """The disc R ≤ 1 in polar coordinates; `counts` cells along the radius and around.

    The face at the centre has no length, so nothing has to be said there.
    """
    r = graded_line(counts[0], 1.0, squeeze_number, mirror=False, least=least)
    angle = _turn(counts[1], quarter)
    area = (np.diff(r[::2] ** 2) / 2)[:, None] * np.diff(angle[::2])
    return _build(
        r,
        angle,
        lambda a, b: (a * np.cos(b), a * np.sin(b)),
        lambda u: u,
        lambda u: 1.0 / u,
        area,
        quarter=quarter,
        first_row_open=False,
        first_column_open=False,
        last_column_open=False,
        join="" if quarter else "turn",
    )


def ellipse_grid(
    aspect_ratio: float,
    squeeze_number: float,
    counts: tuple[int, int],
    *,
    quarter: bool = True,
    least: float = 2e-3,
) -> PlanarGrid:
    """The ellipse X² + (Y/aspect)² ≤ 1 in confocal elliptic coordinates.

    They are conformal: the metric drops out of every conductance. The rows are spaced along the
    minor axis as the disc's along its radius, so that aspect → 1 passes into the disc.
    """
    require("aspect_ratio", aspect_ratio, above=0.0)
    tall = aspect_ratio > 1.0
    major, minor = max(1.0, aspect_ratio), min(1.0, aspect_ratio)
    if major / minor - 1.0 < 1e-6:
        return disc_grid(squeeze_number, counts, quarter=quarter, least=least)
    focus = np.sqrt(major**2 - minor**2)
    line = graded_line(counts[0], minor, squeeze_number, mirror=False, least=least)
    mu = np.arcsinh(line / focus)
    nu = _turn(counts[1], quarter)
    u, v = mu[::2], nu[::2]
    area = focus**2 * (
        np.diff(np.sinh(2 * u) / 4 - u / 2)[:, None] * np.diff(v)
        + np.diff(u)[:, None] * np.diff(v / 2 - np.sin(2 * v) / 4)
    )

    def place(a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
        along, across = focus * np.cosh(a) * np.cos(b), focus * np.sinh(a) * np.sin(b)
        return (across, along) if tall else (along, across)

    return _build(
        mu,
        nu,
        place,
        np.ones_like,
        np.ones_like,
        area,
        quarter=quarter,
        first_row_open=False,
        first_column_open=False,
        last_column_open=False,
        join="" if quarter else "segment",
    )
