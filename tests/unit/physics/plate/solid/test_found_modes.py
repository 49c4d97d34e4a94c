"""Which of a plate's solved modes is meant by nodal lines, and which one follows a change."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.plate.solid.modes import PlateModes


def found(label: tuple[int, int], wanted: float | None = None) -> int:
    modes: Any = SimpleNamespace(
        labels=[(7, 0), (8, 0), None, (8, 0), (9, 0), (8, 0)],
        frequencies=np.array([20e3, 29.5e3, 30e3, 33e3, 40e3, 60e3]),
        drive_forces=np.array([1.0, 0.5, 0.0, 3.0, 2.0, 1.0]),
        plate=SimpleNamespace(working_frequency=wanted, working_label=(8, 0)),
    )
    return PlateModes.index(modes, label)


def test_of_several_with_the_lines_the_most_strongly_driven_is_meant() -> None:
    assert found((8, 0)) == 3
    assert found((9, 0)) == 4


def test_the_working_mode_is_the_one_nearest_to_where_the_plate_works() -> None:
    # Within 3 % of it; of other lines the frequency says nothing.
    assert found((8, 0), 29e3) == 1
    assert found((8, 0), 59e3) == 5
    assert found((9, 0), 29e3) == 4
    # Where none with its lines is as near: of all that are driven, so not the one at 30 kHz.
    assert found((8, 0), 30.6e3) == 1
    assert found((8, 0), 41e3) == 4
    assert found((8, 0), 21e3) == 0


def test_lines_that_no_mode_has_are_told_with_those_there_are() -> None:
    with pytest.raises(InputError, match=r"no mode \(6, 0\) is among those solved \(\(7, 0\), \(8"):
        found((6, 0))
