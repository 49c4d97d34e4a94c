"""Gap and boundary-fitted finite volumes for the film in the plane: rectangle, disc, ellipse.

Every grid is a product of two coordinates, row by row: `rows` × `columns` nodes, node (i, j) at
index i · columns + j. Rows are eliminated one after the other, so the columns take the direction
with fewer nodes. The coordinates are orthogonal (Cartesian, polar, confocal elliptic), so that a
cell exchanges gas with its four neighbours only, and the boundary is a coordinate line: no
staircase. The gap is even in X and in Y, so that a quarter is enough: the lines of symmetry are
walls.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import GeometryError


class Faces(NamedTuple):
    """Faces of a grid with `columns` nodes in a row, and their conductances, face length over
    distance between nodes: between two rows, of the same column, ((rows−1)·columns,); within a row,
    row by row, (rows·(columns−1),); and on the edge, where P = 1, with the nodes there."""

    columns: int
    row_conductance: si.Array
    column_conductance: si.Array
    edge_node: si.Array
    edge_conductance: si.Array


@dataclass(frozen=True)
class PlanarGrid:
    """Nodes, the faces between them, and the faces on the open edge.

    Per node (rows·columns,): `X`, `Y`, `area`. `faces_X` is X at the faces between rows, within
    rows and on the edge, one after the other.
    """

    rows: int
    X: si.FloatArray
    Y: si.FloatArray
    area: si.FloatArray
    faces: Faces
    faces_X: si.FloatArray

    @property
    def columns(self) -> int:
        """Number of nodes in a row."""
        return self.faces.columns


@dataclass(frozen=True)
class _Lines:
    """Coordinate lines `u` (2 rows + 1,) and `v` (2 columns + 1,), faces at even places and nodes
    at odd ones, with the map to X and Y.

    `across_rows(u)` multiplies Δv/Δu in the conductance of a face between rows,
    `across_columns(u)` multiplies Δu/Δv.
    """

    u: si.FloatArray
    v: si.FloatArray
    place: Callable[[si.FloatArray, si.FloatArray], tuple[si.FloatArray, si.FloatArray]]
    across_rows: Callable[[si.FloatArray], si.FloatArray]
    across_columns: Callable[[si.FloatArray], si.FloatArray]

    def at(self, a: si.FloatArray, b: si.FloatArray) -> tuple[si.FloatArray, si.FloatArray]:
        """X and Y where some lines cross, row by row."""
        x, y = self.place(a[:, None], b[None, :])
        shape = (a.size, b.size)
        return (
            np.ascontiguousarray(np.broadcast_to(x, shape)).ravel(),
            np.ascontiguousarray(np.broadcast_to(y, shape)).ravel(),
        )


def _build(lines: _Lines, area: si.FloatArray, *, open_sides: bool = False) -> PlanarGrid:
    """A grid from its coordinate lines. The first row and column are walls, the last row is open,
    and so is the last column where there are `open_sides`."""
    u_face, u_node, v_face, v_node = lines.u[::2], lines.u[1::2], lines.v[::2], lines.v[1::2]
    rows, columns = u_node.size, v_node.size
    index = np.arange(rows * columns).reshape(rows, columns)
    X, Y = lines.at(u_node, v_node)
    dv = np.diff(v_face)
    row_G = (lines.across_rows(u_face[1:-1]) / np.diff(u_node))[:, None] * dv
    # Of 1/Δv in the conductance of a face, for each row.
    weight = lines.across_columns(u_node) * np.diff(u_face)
    column_G = weight[:, None] / np.diff(v_node)
    last = lines.across_rows(u_face[-1:]) / (u_face[-1] - u_node[-1]) * dv
    edges = [(index[-1], lines.at(u_face[-1:], v_node)[0], last)]
    if open_sides:
        last = weight / (v_face[-1] - v_node[-1])
        edges.append((index[:, -1], lines.at(u_node, v_face[-1:])[0], last))
    edge_node, edge_X, edge_G = (np.concatenate(part) for part in zip(*edges, strict=True))
    return PlanarGrid(
        rows,
        X,
        Y,
        area.ravel(),
        Faces(columns, row_G.ravel(), column_G.ravel(), edge_node, edge_G),
        np.concatenate(
            [lines.at(u_face[1:-1], v_node)[0], lines.at(u_node, v_face[1:-1])[0], edge_X]
        ),
    )


def edge_graded(count: int, layer: float) -> si.FloatArray:
    """`count` + 1 points from 0 to 1, denser towards 1: half of them lie within `layer` of 1.

    The map is smooth, so that second-order differences on it stay second order.
    """
    s = np.linspace(0.0, 1.0, count + 1)
    if layer >= 0.499:
        return s
    beta = 2.0 * np.arccosh(0.5 / layer)
    return np.asarray(1.0 - np.sinh(beta * (1.0 - s)) / np.sinh(beta))


def edge_layer(squeeze_number: float, least: float = 2e-3) -> float:
    """The distance from an edge, on a half width of 1, within which half the cells should lie."""
    return float(min(0.5, max(4.0 / np.sqrt(squeeze_number), least)))


def refined_line(
    line: si.FloatArray, mean_gap: Callable[[si.FloatArray], si.FloatArray]
) -> si.FloatArray:
    """Points as many as `line` has, drawn also to where the mean gap is small.

    The density added goes with 1/√H: over a crest, where H = a + b x², that is the map x ~ sinh s,
    which resolves the crest and the groove alike. A gap that hardly varies leaves `line` as it is.
    """
    fine = np.linspace(line[0], line[-1], 64 * line.size + 1)
    middle = (fine[1:] + fine[:-1]) / 2
    H = mean_gap(middle)
    if H.max() < 1.5 * H.min():
        return line
    s = np.linspace(0.0, 1.0, line.size)
    crowd = np.diff(np.interp(fine, line, s))
    crest = np.diff(fine) / np.sqrt(H)
    total = np.concatenate([[0.0], np.cumsum(0.3 * crowd + 0.7 * crest / crest.sum())])
    placed = np.interp(s * total[-1], total, fine)
    placed[0], placed[-1] = line[0], line[-1]
    return np.asarray(placed)


def graded_line(
    count: int, half: float, squeeze_number: float, least: float = 2e-3
) -> si.FloatArray:
    """2 count + 1 points (faces and nodes in turn) from 0 to half, graded to the edge.

    `squeeze_number` is on the length that `half` is measured in. `least` bounds from below the
    share of the half width that takes half the cells.
    """
    return half * edge_graded(2 * count, edge_layer(squeeze_number * half**2, least))


def rectangle_grid(x: si.FloatArray, y: si.FloatArray) -> PlanarGrid:
    """A rectangle with open sides; `x`, `y` give faces and nodes in turn (2 cells + 1,) from its
    middle on. Rows lie along X."""
    area = np.diff(x[::2])[:, None] * np.diff(y[::2])
    lines = _Lines(x, y, lambda a, b: (a, b), np.ones_like, np.ones_like)
    return _build(lines, area, open_sides=True)


def disc_grid(squeeze_number: float, counts: tuple[int, int], *, least: float = 2e-3) -> PlanarGrid:
    """The disc R ≤ 1 in polar coordinates; `counts` cells along the radius and around.

    The face at the centre has no length, so nothing has to be said there.
    """
    r = graded_line(counts[0], 1.0, squeeze_number, least)
    angle = np.linspace(0.0, np.pi / 2, 2 * counts[1] + 1)
    area = (np.diff(r[::2] ** 2) / 2)[:, None] * np.diff(angle[::2])
    lines = _Lines(
        r,
        angle,
        lambda a, b: (a * np.cos(b), a * np.sin(b)),
        lambda u: u,
        lambda u: 1.0 / u,
    )
    return _build(lines, area)


def ellipse_grid(
    aspect_ratio: float,
    squeeze_number: float,
    counts: tuple[int, int],
    *,
    least: float = 2e-3,
) -> PlanarGrid:
    """The ellipse X² + (Y/aspect)² ≤ 1 in confocal elliptic coordinates.

    They are conformal: the metric drops out of every conductance. The rows are spaced along the
    minor axis as the disc's along its radius, so that aspect → 1 passes into the disc.
    """
    si.require("aspect_ratio", aspect_ratio, above=0.0)
    tall = aspect_ratio > 1.0
    major, minor = max(1.0, aspect_ratio), min(1.0, aspect_ratio)
    if major / minor - 1.0 < 1e-6:
        return disc_grid(squeeze_number, counts, least=least)
    focus = np.sqrt(major**2 - minor**2)
    line = graded_line(counts[0], minor, squeeze_number, least)
    mu = np.arcsinh(line / focus)
    nu = np.linspace(0.0, np.pi / 2, 2 * counts[1] + 1)
    u, v = mu[::2], nu[::2]
    area = focus**2 * (
        np.diff(np.sinh(2 * u) / 4 - u / 2)[:, None] * np.diff(v)
        + np.diff(u)[:, None] * np.diff(v / 2 - np.sin(2 * v) / 4)
    )

    def place(a: si.FloatArray, b: si.FloatArray) -> tuple[si.FloatArray, si.FloatArray]:
        along, across = focus * np.cosh(a) * np.cos(b), focus * np.sinh(a) * np.sin(b)
        return (across, along) if tall else (along, across)

    lines = _Lines(mu, nu, place, np.ones_like, np.ones_like)
    return _build(lines, area)


# A thousand waves on the surface; some twenty cells a wave make a grid of it.
_HIGHEST_WAVE_NUMBER = 2000 * np.pi


@si.checked_numbers
@dataclass(frozen=True)
class PlanarGap:
    """H = 1 + ε cos(k1 X) cos T + δ cos(k2 X): a standing wave under static ridges.

    `excursion_ratio` ε (0 < ε < 1), `wave_number` k1 (0: the surface moves as one),
    `ridge_height` δ and `ridge_wave_number` k2, all in units of H0 and of the reference length.
    Grooves run along Y and are open where the surface ends. Even in X and in Y.
    Raises `InputError` for values out of range, `GeometryError` where the gap would close.
    """

    excursion_ratio: Annotated[si.Dimensionless, si.Above(0.0), si.Below(1.0)]
    wave_number: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(_HIGHEST_WAVE_NUMBER)] = 0.0
    ridge_height: Annotated[si.Dimensionless, si.AtLeast(0.0), si.Below(1.0)] = 0.0
    ridge_wave_number: Annotated[
        si.Dimensionless, si.AtLeast(0.0), si.AtMost(_HIGHEST_WAVE_NUMBER)
    ] = 0.0

    @si.checked_numbers
    def __call__(self, X: si.DimensionlessLike, T: si.DimensionlessLike) -> si.FloatArray:
        """H at places X, whatever Y, and times T, broadcast."""
        return self._at(np.asarray(X), np.asarray(T))

    @si.checked_numbers
    def mean(self, X: si.DimensionlessArray) -> si.DimensionlessArray:
        """The mean of H over a period at places X."""
        return np.asarray(1.0 + self.ridge_height * np.cos(self.ridge_wave_number * X))

    def _at(self, X: si.FloatArray, T: si.FloatArray) -> si.FloatArray:
        """The same for a grid's own places and times, of which it is called dozens of times."""
        wave = np.cos(self.wave_number * X) * np.cos(T)
        ridges = np.cos(self.ridge_wave_number * X)
        return np.asarray(1.0 + self.excursion_ratio * wave + self.ridge_height * ridges)


def gap_values(gap: PlanarGap, X: si.FloatArray, T: si.FloatArray) -> si.FloatArray:
    """H at every place and time, (places, times). Raises `GeometryError` where it closes."""
    H = gap._at(X[:, None], T[None, :])
    if H.min() > 0.0:
        return np.ascontiguousarray(H)
    k, j = np.unravel_index(int(np.argmin(H)), H.shape)
    raise GeometryError(
        f"the gap closes: H = {H[k, j]:.4g} at X = {X[k]:.4g}, T = {T[j]:.4g}; it must stay above "
        "0. Reduce the vibration or the ridges, or raise the mean gap."
    )
