"""Points that nobody would give for another, which are the front, and how much they command."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si


def non_dominated(values: si.FloatArray) -> NDArray[np.bool_]:
    """True of the points, of several numbers of which less is better, shape (points, numbers), for
    which no other is at least as good in all numbers and better in one. Points with a NaN are not
    among them."""
    known = np.isfinite(values).all(axis=1)
    out = np.zeros(len(values), bool)
    left = np.flatnonzero(known)
    # In the order of the sum none is dominated by one that comes later.
    order = left[np.argsort(values[left].sum(axis=1), kind="stable")]
    front: list[int] = []
    for row in order:
        others = values[front]
        worse = (others <= values[row]).all(axis=1) & (others < values[row]).any(axis=1)
        if not worse.any():
            front.append(int(row))
    out[front] = True
    return out


def dominates(a: si.FloatArray, b: si.FloatArray) -> bool:
    """True where `a` is at least as small as `b` in everything and smaller in something; either may
    be infinite."""
    return bool(np.all(a <= b) and np.any(a < b))


def front_of(objectives: si.FloatArray) -> si.IntArray:
    """The numbers of the rows (designs, objectives) that no other dominates, of equal ones the
    first; rows that are not finite are never among them."""
    rows = np.flatnonzero(non_dominated(objectives))
    _, first = np.unique(objectives[rows], axis=0, return_index=True)
    return np.sort(rows[first])


def layers_of(objectives: si.FloatArray, count: int) -> si.IntArray:
    """Rows, at least `count` if there are so many finite ones: the front, then what is the front
    without it, and so on, each layer whole."""
    left = np.flatnonzero(np.isfinite(objectives).all(axis=1))
    taken: list[int] = []
    while left.size and len(taken) < count:
        here = left[front_of(objectives[left])]
        taken += here.tolist()
        left = np.setdiff1d(left, here)
    return np.array(taken, dtype=np.intp)


def hypervolume(objectives: si.FloatArray, worst: si.FloatArray) -> si.Dimensionless:
    """The share of the box from 0 to `worst` that rows (designs, objectives) dominate, 0 to 1.

    All objectives are made small and not negative. By slicing along the last objective (Fleischer
    2003; exact, in time that grows with the power of the number of objectives, of which there are
    two or three).
    """
    inside = objectives[np.all(objectives < worst, axis=1) & np.isfinite(objectives).all(axis=1)]
    if not inside.size:
        return 0.0
    return _volume(inside[front_of(inside)] / worst, np.ones(worst.size))


def _volume(rows: si.FloatArray, worst: si.FloatArray) -> float:
    if rows.shape[1] == 1:
        return float(worst[0] - rows.min())
    order = rows[np.argsort(rows[:, -1])]
    ends = np.append(order[1:, -1], worst[-1])
    total = 0.0
    for number, (begins, end) in enumerate(zip(order[:, -1], ends, strict=True)):
        if end > begins:
            total += (end - begins) * _volume(order[: number + 1, :-1], worst[:-1])
    return total


def knee_of(objectives: si.FloatArray) -> int:
    """The row of a front (designs, objectives) that is nearest to the best of everything, each
    objective measured from the front's best to its worst."""
    low, high = objectives.min(axis=0), objectives.max(axis=0)
    share = (objectives - low) / np.where(high > low, high - low, 1.0)
    return int(np.argmin(np.sum(share**2, axis=1)))
