"""The ellipse on straight lines that end on its boundary, for fingers with ridges.

Ridges that run straight across a pad need lines along them; confocal coordinates would cross them
at every angle. Here the lines follow the ridges, and each ends on the ellipse itself, at its true
distance from the last node (Shortley and Weller), not on a staircase.
"""

from __future__ import annotations

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.film.planar.grid import PlanarGrid, joined

_Mask = np.ndarray[tuple[int, ...], np.dtype[np.bool_]]


def cut_ellipse_grid(
    x: si.FloatArray, y: si.FloatArray, aspect_ratio: float, *, quarter: bool = True
) -> PlanarGrid:
    """The ellipse X² + (Y/aspect)² ≤ 1 on lines; `x`, `y` as in `rectangle_grid`, to its ends.

    Nodes outside keep their place in the numbering, hold ambient gas and have no area. Second
    order, but less regularly so than the fitted grids: where the boundary falls between the lines
    differs from one resolution to the next.
    """
    x_node, y_node, dx, dy = x[1::2], y[1::2], np.diff(x[::2]), np.diff(y[::2])
    rows, columns = x_node.size, y_node.size
    X, Y = np.meshgrid(x_node, y_node, indexing="ij")
    inside = X**2 + (Y / aspect_ratio) ** 2 < 1.0
    index = np.arange(rows * columns).reshape(rows, columns)
    edges = _edges(x, y, aspect_ratio, inside, quarter)
    row_open, column_open = inside[1:] & inside[:-1], inside[:, 1:] & inside[:, :-1]
    row_X = np.broadcast_to(x[2:-1:2, None], (rows - 1, columns))
    column_Y = np.broadcast_to(y[2:-1:2], (rows, columns - 1))
    return PlanarGrid(
        rows=rows,
        columns=columns,
        quarter=quarter,
        X=X.ravel(),
        Y=Y.ravel(),
        area=_areas(x, y, aspect_ratio, inside, quarter).ravel(),
        row_X=np.ascontiguousarray(row_X).ravel(),
        row_Y=Y[1:].ravel(),
        row_conductance=(row_open * dy / np.diff(x_node)[:, None]).ravel(),
        column_from=index[:, :-1].ravel(),
        column_to=index[:, 1:].ravel(),
        column_X=X[:, 1:].ravel(),
        column_Y=np.ascontiguousarray(column_Y).ravel(),
        column_conductance=(column_open * dx[:, None] / np.diff(y_node)).ravel(),
        **joined("edge", ("node", "X", "Y", "conductance"), edges),
    )


def _edges(
    x: si.FloatArray, y: si.FloatArray, aspect_ratio: float, inside: _Mask, quarter: bool
) -> list[tuple[si.IntArray, si.FloatArray, si.FloatArray, si.FloatArray]]:
    """Node, X, Y and conductance of the faces between a line's last node and its end, and of one
    for every node outside, which holds it at ambient pressure."""
    X, Y = np.meshgrid(x[1::2], y[1::2], indexing="ij")
    index = np.arange(X.size).reshape(X.shape)
    outside = ~inside
    edges = [(index[outside], X[outside], Y[outside], np.ones(int(outside.sum())))]
    end_x = np.sqrt(np.maximum(1.0 - (Y / aspect_ratio) ** 2, 0.0))
    end_y = aspect_ratio * np.sqrt(np.maximum(1.0 - X**2, 0.0))
    for axis, place, end, across in (
        (0, X, end_x, np.broadcast_to(np.diff(y[::2]), X.shape)),
        (1, Y, end_y, np.broadcast_to(np.diff(x[::2])[:, None], X.shape)),
    ):
        for side in (1,) if quarter else (1, -1):
            near = np.roll(inside, -side, axis)
            np.moveaxis(near, axis, 0)[-1 if side > 0 else 0] = False
            last = inside & ~near & (side * place > 0)
            edge_X = side * end[last] if axis == 0 else X[last]
            edge_Y = side * end[last] if axis == 1 else Y[last]
            # A node on the boundary to rounding is ambient, not infinitely well connected.
            distance = np.maximum(end - side * place, 1e-6 * end)
            edges.append((index[last], edge_X, edge_Y, (across / distance)[last]))
    return edges


def _areas(
    x: si.FloatArray, y: si.FloatArray, aspect_ratio: float, inside: _Mask, quarter: bool
) -> si.FloatArray:
    """The ellipse's area shared out: whole cells within, a strip's rest to its last node."""
    u = np.clip(x[::2], -1.0, 1.0)
    # Area under the upper arc between two lines, from its antiderivative.
    strip = aspect_ratio * np.diff(0.5 * (u * np.sqrt(1.0 - u**2) + np.arcsin(u)))
    dx, y_face, dy = np.diff(x[::2]), y[::2], np.diff(y[::2])
    area = np.where(inside, dx[:, None] * dy, 0.0)
    upper = y[1::2] > 0
    for i in range(dx.size):
        for half in (upper,) if quarter else (upper, ~upper):
            nodes = np.flatnonzero(inside[i] & half)
            if not nodes.size:
                continue
            last = nodes[-1] if half is upper else nodes[0]
            reach = y_face[last] if half is upper else -y_face[last + 1]
            area[i, last] = max(strip[i] - dx[i] * max(reach, 0.0), 0.05 * dx[i] * dy[last])
    whole = np.pi * aspect_ratio / (4.0 if quarter else 1.0)
    return np.asarray(area * (whole / area.sum()))
