"""Shares of the variance, against functions whose shares are known."""

import dataclasses
import itertools
import math
from typing import Any

import numpy as np
import pytest

from squeezefilm.core import quantities as si
from squeezefilm.design.sweep.axes import Axis
from squeezefilm.design.sweep.swept import Sweep, SweptColumn, effects_of, varied_values


def swept(axes: tuple[Axis, ...], values: Any) -> Sweep:
    """A sweep with one answer that has these values."""
    count = math.prod(len(axis) for axis in axes)
    column = SweptColumn("y", si.Unit("1"), np.array(values, float))
    return Sweep("made", ("predict",), axes, (column,), ("",) * count, (), count, 0, {})


def sampled(count: int, names: str, low: float, high: float) -> Axis:
    from scipy.stats import qmc

    shares = qmc.Sobol(len(names), rng=1).random_base2(math.ceil(math.log2(count)))[:count]
    rows = tuple(map(tuple, (low + (high - low) * shares).tolist()))
    units = (si.Unit("1"),) * len(names)
    return Axis(tuple(names), units, rows, sampled=("linear",) * len(names))


def test_a_whole_grid_has_the_exact_analysis_of_variance() -> None:
    """y = 3 a + b + 2 a b of a, b = -1, 0, 1: the variances of the parts are 9, 1 and 4·(2/3)."""
    steps = ((-1.0,), (0.0,), (1.0,))
    axes = tuple(Axis((name,), (si.Unit("1"),), steps) for name in "ab")
    points = itertools.product((-1.0, 0.0, 1.0), repeat=2)
    (found,) = effects_of(swept(axes, [3 * a + b + 2 * a * b for a, b in points]))
    whole = 9 + 1 + 4 * 2 / 3
    assert found.explained is None
    assert [share for share, _ in found.first] == pytest.approx([9 / whole, 1 / whole])
    assert [share for share, _ in found.total] == pytest.approx([1 - 1 / whole, 1 - 9 / whole])
    assert found.pairs[0, 1][0] == pytest.approx(4 * 2 / 3 / whole)
    assert found.first[0][1] == 0


def test_samples_recover_the_known_shares_of_ishigami_within_their_errors() -> None:
    """sin a + 7 sin² b + 0.1 c⁴ sin a over ±π (Ishigami & Homma 1990)."""
    axis = sampled(512, "abc", -math.pi, math.pi)
    x = np.array(axis.steps)
    y = np.sin(x[:, 0]) + 7 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])
    (found,) = effects_of(swept((axis,), y))
    # A fit of degree 6 leaves out a little of sin².
    assert found.explained is not None
    assert found.explained > 0.9
    for shares, known in (
        (found.first, (0.3139, 0.4424, 0.0)),
        (found.total, (0.5576, 0.4424, 0.2437)),
    ):
        for (share, error), right in zip(shares, known, strict=True):
            assert share == pytest.approx(right, abs=0.04 + 2 * error)
    assert found.pairs[0, 2][0] == pytest.approx(0.2437, abs=0.04 + 2 * found.pairs[0, 2][1])
    assert found.pairs[0, 1][0] < 0.03


def test_noise_is_not_explained_and_has_wide_errors() -> None:
    axis = sampled(64, "ab", 0, 1)
    (found,) = effects_of(swept((axis,), np.random.default_rng(3).normal(size=64)))
    assert found.explained is not None
    assert found.explained < 0.3
    assert max(error for _, error in found.total) > 0.1


def test_words_and_gaps_are_fitted_too() -> None:
    """Two surfaces that differ by 2 and a slope of 1 over 0 to 1, one point without an answer."""
    words = Axis(("surface",), (None,), (("bare",), ("adhesive",)))
    slope = Axis(("x",), (si.Unit("1"),), tuple((k / 10,) for k in range(11)))
    values = [2.0 * word + x / 10 for word in (0, 1) for x in range(11)]
    values[4] = math.nan
    found = swept((words, slope), values)
    assert [one.words for one in varied_values(found)] == [("bare", "adhesive"), ()]
    (effects,) = effects_of(found)
    # Over the range the slope has the variance 1/12, the words 1.
    assert effects.first[0][0] == pytest.approx(12 / 13, abs=0.01)
    assert effects.pairs[0, 1][0] < 1e-9
    assert effects.points == 21


def test_what_says_nothing_has_no_effects() -> None:
    axis = sampled(16, "a", 0, 1)
    assert effects_of(swept((axis,), np.ones(16))) == ()
    few = dataclasses.replace(axis, steps=axis.steps[:4])
    assert effects_of(swept((few,), [1, 2, 3, 4])) == ()


def test_a_value_that_has_one_step_left_among_the_answers_decides_nothing() -> None:
    """Wherever it stands: of the first thickness, or word, every point is answered, of the other
    none."""
    slope = Axis(("x",), (si.Unit("1"),), tuple((k / 10,) for k in range(11)))
    values = [k / 10 for k in range(11)] + [math.nan] * 11
    for unit, steps in ((si.Unit("1"), ((1.0,), (2.0,))), (None, (("bare",), ("adhesive",)))):
        first = Axis(("first",), (unit,), steps)
        (found,) = effects_of(swept((first, slope), values))
        assert [share for share, _ in found.total] == pytest.approx([0, 1])
        turned = np.array(values).reshape(2, 11).T.ravel()
        (found,) = effects_of(swept((slope, first), turned))
        assert [share for share, _ in found.total] == pytest.approx([1, 0])
