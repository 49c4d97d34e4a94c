"""Where the following of modes begins: at the point nearest to the display's own values."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.design.sweep import sweep
from squeezefilm.design.sweep.answers import OPTIONS
from squeezefilm.design.sweep.sweep import Plan


def axis(name: str, *numbers: float) -> Any:
    return SimpleNamespace(names=(name,), numbers=np.array(numbers) if numbers else None)


@pytest.mark.parametrize(
    ("axes", "shape", "begin"),
    [
        ([axis("a", 1.0, 2.0, 3.0)], (3,), 1),
        ([axis("b", 1.0, 2.0, 3.0)], (3,), 2),
        ([axis("a", 1.0, 2.0, 3.0), axis("b", 5.0, 4.0, 3.0, 2.0)], (3, 4), 1 * 4 + 1),
        # A choice by name, what the display does not have, and a verb's option begin at the first.
        ([axis("c"), axis("a", 2.2, 9.0)], (4, 2), 0),
        ([axis("c", 1.0, 2.0, 3.0), axis("a", 9.0, 2.2)], (3, 2), 1),
        ([axis(next(iter(OPTIONS)), 1.0, 2.1, 3.0), axis("b", 1.0, 4.0)], (3, 2), 1),
    ],
)
def test_following_begins_nearest_to_the_displays_own_values(
    axes: Any, shape: tuple[int, ...], begin: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    own = {"a": 2.1, "b": 3.9, "c": None, next(iter(OPTIONS)): 2.1}
    monkeypatch.setattr(sweep, "value_at", lambda display, path: (own[path], None))
    asked: Any = SimpleNamespace(axes=axes, displays=["display"], shape=shape)
    assert Plan.begin(asked) == begin
