"""The histogram of lateness and what is read off it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from squeezefilm.instruments.session.loop.shared import (
    CLASSES,
    Lateness,
    class_ends,
    lateness_class,
)


def _of(late_ns: np.ndarray, lost: int = 0) -> Lateness:
    counts = np.zeros(CLASSES, dtype=np.int64)
    for one in late_ns:
        counts[lateness_class(float(one))] += 1
    return Lateness(1e3, late_ns.size, lost, float(np.max(late_ns)) * 1e-9, counts)


def test_every_lateness_lies_between_the_ends_of_its_class() -> None:
    ends = class_ends()
    assert ends.shape == (CLASSES,)
    assert ends[-1] == math.inf
    for late in np.geomspace(1.0, 1e11, 997):
        place = lateness_class(late)
        below = ends[place - 1] if place else 0.0
        assert below * (1 - 1e-12) <= late * 1e-9 < ends[place] * (1 + 1e-12)
    assert lateness_class(math.nan) == 0


@pytest.mark.parametrize("share", [0.01, 0.5, 0.9, 0.99, 0.999, 1.0])
def test_a_quantile_is_never_too_low_and_at_most_one_class_too_high(share: float) -> None:
    late = np.random.default_rng(1).lognormal(np.log(2e4), 1.5, 20_000)
    found = _of(late).quantile(share)
    true = float(np.sort(late)[math.ceil(share * late.size) - 1]) * 1e-9
    assert true * (1 - 1e-12) <= found <= true * 10 ** (1 / 20) * (1 + 1e-12)


def test_figures_are_in_its_json() -> None:
    lateness = _of(np.array([50.0, 2e3, 3e6]), lost=2)
    assert lateness.share_made == 3 / 5
    text = lateness.to_json()
    assert text["p99_9_s"] == lateness.quantile(0.999) == 3e-3
    assert text["rate_Hz"] == 1000.0


def test_before_the_first_tick_nothing_is_a_number() -> None:
    nothing = Lateness(1e3, 0, 0, 0.0, np.zeros(CLASSES, dtype=np.int64))
    assert math.isnan(nothing.quantile(0.5))
    assert math.isnan(nothing.share_made)
    assert nothing.to_json()["p50_s"] is None
