"""What a march in time refuses before it begins."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.film.transient.march import solve_transient


@pytest.mark.parametrize(
    ("changes", "quantity"),
    [
        ({"end": 0.0}, "end"),
        ({"steps": 0}, "steps"),
        ({"cells": 3}, "cells"),
        ({"snapshots": 21}, "snapshots"),
        ({"initial_pressure": 0.0}, "initial_pressure"),
        ({"initial_pressure": np.ones(7)}, "initial_pressure"),
    ],
)
def test_a_march_that_cannot_be_is_refused(changes: dict[str, Any], quantity: str) -> None:
    good: dict[str, Any] = {"end": 2 * math.pi, "steps": 19, "cells": 8, "snapshots": 0}
    with pytest.raises(InputError) as caught:
        solve_transient(lambda X, T: 1 + 0.3 * np.cos(T) + 0 * X, 10.0, **{**good, **changes})
    assert caught.value.quantity == quantity
