"""A posterior that has not died away at a bound of the prior is said to be cut by it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.study.psychometric.fit import _bounded

PRIOR: Any = SimpleNamespace(threshold=(1.0, 5.0), width=(2.0, 9.0))
# The densities of unlike cells: chances are these times the widths.
WIDTHS = np.array([0.5, 1.5, 1.5, 0.5])
DEAD = [0.04, 0.5, 1.0, 0.04]


def posterior(threshold: list[float], width: list[float], low: float = 1.0) -> Any:
    edges = low + np.append(0.0, np.cumsum(WIDTHS))
    known = {"threshold": np.array(threshold) * WIDTHS, "width": np.array(width) * WIDTHS * 1.75}
    return SimpleNamespace(edges=[edges, 2.0 + 1.75 * (edges - low)], marginal=known.__getitem__)


@pytest.mark.parametrize(
    ("given", "names"),
    [
        (posterior(DEAD, DEAD), ()),
        (posterior([0.06, 0.5, 1.0, 0.04], DEAD), ("threshold",)),
        (posterior([0.04, 0.5, 1.0, 0.06], DEAD), ("threshold",)),
        (posterior(DEAD, [0.06, 0.5, 1.0, 0.04]), ("width",)),
        (posterior([0.06] * 3 + [1.0], [1.0] + [0.06] * 3), ("threshold", "width")),
        # Where the grid ends before the prior does, nothing is cut.
        (posterior([0.06, 0.5, 1.0, 0.06], DEAD, low=1.5), ()),
    ],
)
def test_a_bound_that_cuts_is_named(given: Any, names: tuple[str, ...]) -> None:
    assert _bounded(PRIOR, given) == names
