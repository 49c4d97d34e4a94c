from __future__ import annotations

from typing import Any

import numpy as np

HOSTILE: dict[str, Any] = {
    "nan": float("nan"),
    "inf": float("inf"),
    "-inf": float("-inf"),
    "0": 0.0,
    "-1": -1.0,
    "1e300": 1e300,
    "-1e300": -1e300,
    "1e-300": 1e-300,
    "the least float": 5e-324,
    "nothing": None,
    "text": "2 um",
    "complex": 1j,
    "an object": object(),
    "an integer too large for a float": 10**400,
    "an empty array": np.array([]),
    "an array of objects": np.array([object(), None], dtype=object),
    "an array of texts": np.array(["1", "2"]),
    "an array of integers": np.array([1, 2, 3]),
    "an array with nan": np.array([0.5, np.nan, 0.5]),
    "another shape": np.full((2, 3, 4), 0.5),
    "ragged": [[1.0], [1.0, 2.0]],
}


def not_finite(value: Any, depth: int = 0) -> str:
    if isinstance(value, (int, float, complex, np.number, np.ndarray)):
        a = np.asarray(value)
        if a.dtype.kind in "fc" and not np.all(np.isfinite(a)):
            return "not finite"
        return ""
    if isinstance(value, tuple | list) and depth < 3:
        for item in value:
            if text := not_finite(item, depth + 1):
                return text
    return ""
