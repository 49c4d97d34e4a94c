"""Stevens' exponent of few people and trials, by least squares written out."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy import stats

from squeezefilm.core.errors import InputError
from squeezefilm.study.psychometric.magnitude_estimation import (
    equalised_estimates,
    fit_power_law,
    geometric_means,
)

INTENSITY = [1.0, 2.0, 4.0, 8.0, 1.0, 3.0, 9.0, 2.0, 5.0]
WHO = ["b", "b", "b", "b", "a", "a", "a", "c", "c"]
NUMBERS = [2.0, 2.5, 6.0, 7.0, 10.0, 22.0, 31.0, 1.0, 2.1]


def test_one_persons_interval_is_that_of_his_line() -> None:
    x, y = [1.0, 2.0, 4.0, 8.0], [3.0, 3.5, 7.0, 8.0]
    law = fit_power_law(x, y, ["p"] * 4, level=0.9)
    line = stats.linregress(np.log(x), np.log(y))
    assert law.exponent == pytest.approx(line.slope)
    assert law.pooled_exponent == pytest.approx(line.slope)
    assert law.moduli == pytest.approx([math.exp(line.intercept)])
    assert law.degrees_of_freedom == 2
    reach = stats.t.ppf(0.95, 2) * line.stderr
    assert law.interval == pytest.approx((line.slope - reach, line.slope + reach))
    assert law.level == 0.9


def test_three_trials_of_one_person_are_enough_and_two_are_not() -> None:
    assert fit_power_law([1.0, 2.0, 4.0], [1.0, 2.5, 4.0], ["p"] * 3).degrees_of_freedom == 1
    with pytest.raises(InputError, match="give three or more"):
        fit_power_law([1.0, 2.0], [1.0, 2.5], ["p"] * 2)


def test_people_are_the_sample_and_each_has_a_line() -> None:
    law = fit_power_law(INTENSITY, NUMBERS, WHO)
    assert law.participants == ("a", "b", "c")
    x, y, who = np.log(INTENSITY), np.log(NUMBERS), np.array(WHO)
    slopes, moduli, squares = [], [], 0.0
    up = down = 0.0
    for name in law.participants:
        own = who == name
        slope, start = np.polyfit(x[own], y[own], 1)
        slopes.append(slope)
        moduli.append(math.exp(start))
        squares += float(np.sum((y[own] - start - slope * x[own]) ** 2))
        dx = x[own] - x[own].mean()
        up, down = up + float(dx @ y[own]), down + float(dx @ dx)
    assert law.exponents == pytest.approx(slopes)
    assert law.moduli == pytest.approx(moduli)
    assert law.exponent == pytest.approx(np.mean(slopes))
    assert law.pooled_exponent == pytest.approx(up / down)
    # Nine trials less two of each of three lines.
    assert law.residual == pytest.approx(math.sqrt(squares / 3))
    assert law.degrees_of_freedom == 2
    reach = stats.t.ppf(0.975, 2) * np.std(slopes, ddof=1) / math.sqrt(3)
    assert law.interval == pytest.approx((law.exponent - reach, law.exponent + reach))


def test_two_trials_each_leave_no_residual() -> None:
    law = fit_power_law([1.0, 2.0, 1.0, 2.0], [1.0, 2.0, 1.0, 4.0], ["a", "a", "b", "b"])
    assert law.residual == 0.0
    assert law.exponents == pytest.approx([1.0, 2.0])


def test_people_weigh_the_same_when_their_numbers_are_brought_together() -> None:
    # Geometric means 2 (of one trial) and 32 (of three): 8 between them.
    found = equalised_estimates([2.0, 16.0, 32.0, 64.0], ["a", "b", "b", "b"])
    assert found == pytest.approx([8.0, 4.0, 8.0, 16.0])
    places, means = geometric_means([3.0, 1.0, 3.0], [2.0, 5.0, 8.0])
    assert places.tolist() == [1.0, 3.0]
    assert means == pytest.approx([5.0, 4.0])


@pytest.mark.parametrize(
    ("rows", "says"),
    [
        (([1.0, 0.0], [1.0, 2.0], ["a", "a"]), "intensity = 0"),
        (([1.0, 2.0], [1.0, -2.0], ["a", "a"]), "estimate = -2"),
        (([1.0, 2.0], [1.0], ["a", "a"]), "shapes"),
        (([1.0, 2.0], [1.0, 2.0], ["a"]), "shapes"),
        (([[1.0, 2.0]], [[1.0, 2.0]], [["a", "a"]]), "one-dimensional"),
        (([], [], []), "at least one row"),
    ],
)
def test_numbers_that_are_none_are_refused(rows: Any, says: str) -> None:
    with pytest.raises(InputError, match=says):
        fit_power_law(*rows)


@pytest.mark.parametrize("level", [0.0, 1.0])
def test_a_level_is_between_none_and_all(level: float) -> None:
    with pytest.raises(InputError, match="level"):
        fit_power_law(INTENSITY, NUMBERS, WHO, level=level)
