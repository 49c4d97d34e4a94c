"""Which modes of a coarse mesh are refined: those asked for, nearest to the guess."""

from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.plate.solid.coarse_modes import CoarseModes, chosen_modes


def made(labels: list[Any], frequencies: list[float]) -> CoarseModes:
    values = (2 * np.pi * np.array(frequencies)) ** 2
    unused: Any = None
    return CoarseModes(unused, values, np.zeros((0, len(labels))), labels, unused)


def test_the_mode_with_the_wanted_lines_is_refined_in_its_class_only() -> None:
    classes = [made([(5, 0), (7, 0)], [20e3, 33e3]), made([(2, 1)], [30e3])]
    chosen = chosen_modes(classes, 33e3, None, (7, 0), 1)
    assert [each.tolist() for each in chosen] == [[1], []]


def test_of_several_with_these_lines_the_three_nearest_to_the_guess_are() -> None:
    classes = [made([(7, 0)] * 4, [20e3, 31e3, 34e3, 36e3])]
    chosen = chosen_modes(classes, 33e3, None, (7, 0), 1)
    assert chosen[0].tolist() == [1, 2, 3]


@pytest.mark.parametrize(("near", "says"), [(33e3, "found near 33000 Hz"), (None, "was found \\(")])
def test_lines_that_no_mode_has_are_refused_with_those_there_are(
    near: float | None, says: str
) -> None:
    with pytest.raises(InputError, match=says) as refused:
        chosen_modes([made([(5, 0), None], [20e3, 21e3])], near, None, (7, 0), 1)
    assert "there are (5, 0)" in str(refused.value)


def test_all_of_a_band_or_those_nearest_of_all_classes_are_refined() -> None:
    classes = [
        made([(8, 0), None, (9, 0), (9, 0), (9, 0)], [20e3, 30e3, 33e3, 50e3, 70e3]),
        made([(8, 1), (9, 0)], [29e3, 80e3]),
    ]

    def chosen(near: float | None, band: tuple[float, float] | None, count: int) -> list[list[int]]:
        return [one.tolist() for one in chosen_modes(classes, near, band, None, count)]

    assert chosen(None, (0.0, 1e5), 1) == [[0, 1, 2, 3, 4], [0, 1]]
    assert chosen(31e3, None, 3) == [[1, 2], [0]]
    assert chosen(31e3, None, 1) == [[1], []]
    # Without a guess the lowest.
    assert chosen(None, None, 3) == [[0, 1], [0]]
