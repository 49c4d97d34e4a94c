"""Which mode of a bare body a sweep is taken to be of, of fits that are made up."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.ceramic.constants import DECISIVE, RecordedMode, recorded_mode

PRIOR: Any = SimpleNamespace(mean=np.zeros(2), spread=np.array([1.0, 2.0]))


def fitted(at: float, spread: float, width: float = 0.1) -> Any:
    """A fit that ends at this ln s11, and leaves so much of the data."""
    return SimpleNamespace(
        parameters=np.array([at, 0.5]), spread=spread, covariance=width**2 * np.eye(2),
        degrees_of_freedom=40,
    )  # fmt: skip


def evidence(fit: Any) -> float:
    """ln of e^(−d²/2) √det(C/s²) / spread^freedom."""
    d2 = fit.parameters[0] ** 2 + (fit.parameters[1] / 2.0) ** 2
    volume = math.sqrt(np.linalg.det(fit.covariance) / (1.0 * 2.0) ** 2)
    return -d2 / 2 + math.log(volume) - 40 * math.log(fit.spread)


STARTS = [np.array([at, 0.0]) for at in (0.0, 1.0, 2.0, 9.0)]


def test_the_likeliest_fit_is_taken_and_how_much_it_is_preferred() -> None:
    fits = {1: fitted(0.1, 1.1), 2: fitted(1.1, 1.0, 0.3), 3: fitted(2.1, 1.3)}
    asked: list[int] = []

    def fit(number: int) -> Any:
        asked.append(number)
        return fits[number]

    found, mode = recorded_mode(STARTS, fit, PRIOR)
    # 9 spreads off no ceramic is: 40.5 beyond the nearest.
    assert asked == [1, 2, 3]
    assert found is fits[2]
    assert (mode.number, mode.other) == (2, 1)
    assert mode.preference == pytest.approx(evidence(fits[2]) - evidence(fits[1]))


def test_a_fit_that_ends_at_another_mode_counts_as_that_one_where_it_is_the_better() -> None:
    begun = {1: fitted(1.02, 0.9), 2: fitted(0.98, 1.0), 3: fitted(2.0, 2.0)}
    found, mode = recorded_mode(STARTS, begun.__getitem__, PRIOR)
    assert found is begun[1]
    assert mode.number == 2
    # Nobody ended at the first: it is behind by its distance alone.
    assert (mode.other, mode.preference) == (1, 0.0)


def test_modes_whose_fit_fails_are_left_out_unless_all_do() -> None:
    def fit(number: int) -> Any:
        if number != 3:
            raise InputError(f"no fit of mode {number}")
        return fitted(2.0, 1.0)

    _, mode = recorded_mode(STARTS, fit, PRIOR)
    assert mode.number == 3

    def none(number: int) -> Any:
        raise InputError(f"no fit of mode {number}")

    with pytest.raises(InputError, match="no fit of mode 1"):
        recorded_mode(STARTS, none, PRIOR)


def test_a_mode_says_how_sure_it_is_told() -> None:
    sure = RecordedMode(2, 1, DECISIVE).sentence
    assert sure.startswith("It was taken for mode 2 of its kind")
    assert "preferred over mode 1 by 3 " in sure
    assert sure.endswith("lean on what is usual of ceramics.")
    assert "Above the lowest" not in RecordedMode(1, 2, DECISIVE).sentence
    assert "which decides nothing" in RecordedMode(1, 2, 0.99 * DECISIVE).sentence
