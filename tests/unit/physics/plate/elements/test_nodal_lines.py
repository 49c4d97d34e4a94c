"""Nodal lines of shapes that are products of one along and one across, or nearly so."""

from __future__ import annotations

import numpy as np
import pytest

from squeezefilm.physics.plate.elements.nodal_lines import line_counts, profiles, zero_crossings


def test_a_shape_is_split_into_its_nearest_product() -> None:
    along, across = np.array([1.0, -2.0, 3.0]), np.array([0.6, 0.8])
    shape = np.outer(along, across)
    x, y, share = profiles(shape)
    assert np.outer(x, y) == pytest.approx(shape)
    assert share == pytest.approx(1.0)
    # A second product at right angles to it, of a third of its size, takes its square's share.
    other = np.outer([2.0, 1.0, 0.0], [-0.8, 0.6])
    other *= np.linalg.norm(shape) / 3 / np.linalg.norm(other)
    x, y, share = profiles(shape + other)
    assert np.outer(x, y) == pytest.approx(shape)
    assert share == pytest.approx(0.9)
    assert profiles(np.zeros((3, 2)))[2] == 0.0


def test_a_profile_crosses_zero_between_two_points() -> None:
    x = np.array([0.0, 1.0, 2.0, 3.0, 4.0])
    crossed = zero_crossings(x, np.array([1.0, -3.0, 1e-9, -1.0, 2.0]))
    assert crossed == pytest.approx([0.25, 3 + 1 / 3])


@pytest.mark.parametrize("lines", [(0, 19), (7, 0), (2, 3)])
@pytest.mark.parametrize("seed", range(8))
def test_lines_are_counted_where_two_modes_share_their_motions(
    lines: tuple[int, int], seed: int
) -> None:
    """Of a mixture of two modes the one with the larger share names it, though its own lines bend
    and may end: cosines stand for the shapes of a plate on rollers."""
    x, y = np.linspace(0, 0.12, 97), np.linspace(0, 0.088, 65)
    draws = np.random.default_rng(seed)
    other = (lines[0] + 1 + int(draws.integers(12)), lines[1] + 1 + int(draws.integers(12)))

    def shape(counts: tuple[int, int]) -> np.ndarray:
        along, across = (
            np.cos(count * np.pi * line / line[-1])
            for count, line in zip(counts, (x, y), strict=True)
        )
        product = np.outer(along, across)
        return np.asarray(product / np.linalg.norm(product))

    mixed = shape(lines) + draws.uniform(-0.9, 0.9) * shape(other)
    assert line_counts(mixed, x, y) == lines
    assert line_counts(mixed.T, y, x) == lines[::-1]
