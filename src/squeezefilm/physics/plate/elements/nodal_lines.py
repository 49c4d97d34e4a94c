"""Nodal lines of a vibration: nodal lines, how many, and the half wavelength that follows."""

from __future__ import annotations

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError


def zero_crossings(position: si.FloatArray, profile: si.FloatArray) -> si.FloatArray:
    """Places where a profile changes sign; values below 1e-6 of its largest count as none."""
    strong = np.abs(profile) > 1e-6 * np.max(np.abs(profile))
    x, w = position[strong], profile[strong]
    at = np.flatnonzero(np.signbit(w[1:]) != np.signbit(w[:-1]))
    return np.asarray(x[at] - w[at] * (x[at + 1] - x[at]) / (w[at + 1] - w[at]))


def profiles(shape: si.FloatArray) -> tuple[si.FloatArray, si.FloatArray, float]:
    """The product X(x) Y(y) nearest to a shape, and its share of the shape's square: 1 for straight
    nodal lines."""
    U, s, V = np.linalg.svd(shape, full_matrices=False)
    return U[:, 0] * s[0], V[0], float(s[0] ** 2 / np.sum(s**2)) if s[0] > 0 else 0.0


def line_counts(shape: si.FloatArray, x: si.MetreArray, y: si.MetreArray) -> tuple[int, int]:
    """Numbers of nodal lines across the length and across the width, of a deflection (x, y).

    They are counted on the nearest product X(x) Y(y). Where two modes are near one another and
    share their motions, the lines of the shape itself are not straight and cannot be counted; the
    product is that of the mode which has the larger share.
    """
    along, across, _ = profiles(shape)
    return zero_crossings(x, along).size, zero_crossings(y, across).size


def largest_lobe(position: si.FloatArray, profile: si.FloatArray) -> int:
    """The number of the place where a profile is largest between its outermost zeros, anywhere
    where it has fewer than two: free ends move further than any finger meets."""
    nodes, size = zero_crossings(position, profile), np.abs(profile)
    if nodes.size > 1:
        size = np.where((position > nodes[0]) & (position < nodes[-1]), size, -1.0)
    return int(np.argmax(size))


@si.checked_numbers
def line_distance(nodes: si.MetreArray) -> si.Metre:
    """The mean distance (m) of nodal lines at rising places (m).

    Of six or more, the outermost at each end is left out: the free edge's near field moves it.
    Raises `InputError` with fewer than two.
    """
    if nodes.ndim != 1 or nodes.size < 2:
        raise InputError(
            f"a half wavelength lies between two nodal lines or more, given are {nodes.size}; "
            "choose a mode with more",
            quantity="nodal_lines",
        )
    if nodes.size >= 6:
        nodes = nodes[1:-1]
    return float(np.mean(np.diff(nodes)))
