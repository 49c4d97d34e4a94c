"""Which of many points nobody would give for another: better in one number is worse in another."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si


def non_dominated(values: si.FloatArray) -> NDArray[np.bool_]:
    """Of points with several numbers of which less is better, shape (points, numbers), those for
    which no other is at least as good in all numbers and better in one. Points with a NaN are not
    among them."""
    known = np.isfinite(values).all(axis=1)
    out = np.zeros(len(values), bool)
    left = np.flatnonzero(known)
    # In the order of the sum none is dominated by one that comes later.
    order = left[np.argsort(values[left].sum(axis=1), kind="stable")]
    front: list[int] = []
    for one in order:
        others = values[front]
        worse = (others <= values[one]).all(axis=1) & (others < values[one]).any(axis=1)
        if not worse.any():
            front.append(int(one))
    out[front] = True
    return out
