"""Finite volumes on a line (strip or disc), and the gap tabulated on them.

The grid is graded to the edge layer, whose thickness goes with σ^-1/2.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import GeometryError, InputError

Shape = Literal["strip", "disc"]
Gap = Callable[[si.FloatArray, si.FloatArray], si.FloatArray]
"""H(X, T): takes arrays X (1, cells) and T (times, 1), returns what broadcasts with both."""
Profile = Callable[[si.FloatArray], si.FloatArray]


@dataclass(frozen=True)
class LineGrid:
    """Finite volumes on a line: `centre` (N,), `face` and `conductance` (N+1,), `volume` (N,)."""

    centre: si.FloatArray
    face: si.FloatArray
    volume: si.FloatArray
    conductance: si.FloatArray


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


def refined_line(line: si.FloatArray, mean_gap: Profile) -> si.FloatArray:
    """As many points as `line`, drawn also to where the mean gap is small.

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


def line_grid(
    shape: Shape, cells: int, squeeze_number: float, mean_gap: Profile | None = None
) -> LineGrid:
    """Cells over the strip X ∈ [−½, ½] or the disc R ∈ [0, 1], graded to the edge layer,
    and to where `mean_gap` is small."""
    layer = edge_layer(squeeze_number if shape == "disc" else squeeze_number / 4)
    if shape == "disc":
        # Centres are the images of the half-points, so the grid stays smooth up to the edge.
        fine = edge_graded(2 * cells, layer)
        fine = fine if mean_gap is None else refined_line(fine, mean_gap)
        face, centre = fine[::2], fine[1::2]
        weight, volume = face, np.diff(face**2) / 2
    else:
        fine = edge_graded(cells, layer) / 2
        fine = np.concatenate([-fine[:0:-1], fine])
        fine = fine if mean_gap is None else refined_line(fine, mean_gap)
        face, centre = fine[::2], fine[1::2]
        weight, volume = np.ones_like(face), np.diff(face)
    distance = np.diff(np.concatenate([face[:1], centre, face[-1:]]))
    return LineGrid(centre, face, volume, weight / distance)


def uniform_gap(excursion_ratio: float) -> Gap:
    """The gap H = 1 + ε cos T of two flat surfaces."""
    si.require("excursion_ratio", excursion_ratio, above=0.0, below=1.0)

    def gap(X: si.FloatArray, T: si.FloatArray) -> si.FloatArray:
        return 1.0 + excursion_ratio * np.cos(T)

    return gap


def tabulated(
    gap: Callable[..., si.FloatArray], axes: dict[str, tuple[si.FloatArray, int]], enough: str
) -> si.FloatArray:
    """H at every place and time, checked: finite and open. Each of the gap's arguments is given
    with the axis, 0 or 1, that it runs along; `enough` says what keeps the gap open."""
    shape = tuple(max(v.size for v, along in axes.values() if along == axis) for axis in (0, 1))
    given = [v[:, None] if axis == 0 else v[None, :] for v, axis in axes.values()]
    try:
        H = np.broadcast_to(np.asarray(gap(*given), dtype=float), shape)
    except ValueError as error:
        asked = ", ".join(f"{name} {v.shape}" for name, v in zip(axes, given, strict=True))
        raise InputError(
            f"the gap must return what broadcasts to {shape} for {asked}: {error}"
        ) from error
    # One pass on the way through; the place is looked for only where something is wrong.
    if H.min() > 0.0 and H.max() < np.inf:
        return np.ascontiguousarray(H)
    finite = np.isfinite(H)
    worst = np.unravel_index(int(np.argmin(np.where(finite, H, -np.inf))), shape)
    place = ", ".join(f"{name} = {v[worst[axis]]:.4g}" for name, (v, axis) in axes.items())
    if not finite.all():
        raise InputError(f"gap = {H[worst]} at {place} cannot be used: it must be finite")
    raise GeometryError(
        f"the gap closes: H = {H[worst]:.4g} at {place}; it must stay above 0. {enough}"
    )


def gap_table(gap: Gap, X: si.FloatArray, T: si.FloatArray) -> si.FloatArray:
    """H at every time and place, (times, places), checked: finite and open."""
    enough = "Reduce the vibration or raise the mean gap."
    return tabulated(gap, {"X": (X, 1), "T": (T, 0)}, enough)


def mean_over(gap: Gap, T: si.FloatArray) -> Profile:
    """The gap's mean over the times `T`, as a function of X."""
    return lambda X: np.asarray(gap_table(gap, X, T).mean(axis=0))
