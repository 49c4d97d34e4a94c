"""The circle that one mode draws in the complex plane, and the mode that draws it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si


@dataclass(frozen=True)
class ModalCircle:
    """One mode by the circle through its response (m/V): centre, diameter, and how round it is.

    `roundness` is the mean distance of the points from the circle over its radius; `points` lay
    within the stretch that was used. A negative `quality_factor` is that of a phase recorded with
    the other sign.
    """

    frequency: si.Hertz
    quality_factor: si.Dimensionless
    centre: complex
    diameter: si.MetrePerVolt
    roundness: si.Dimensionless
    points: int


def modal_circle(frequency: si.HertzArray, response: si.ComplexArray) -> ModalCircle | None:
    """The mode at the largest response (m/V, complex) among frequencies (Hz), both (points,).

    H = R + A f0²/(f0²(1 + i/Q) − f²) maps the frequencies onto a circle (Kennedy and Pancu 1947,
    10.2514/8.1535); H f² = p H − (A f0² + R p) + R f² with p = f0²(1 + i/Q) is linear in its three
    complex numbers, so it needs no starting value. Taken within twice the half-power band of the
    peak; noise biases it, so that it serves as a start and a check. None where fewer than 6
    points lie there or no resonance comes out.
    """
    peak = int(np.argmax(np.abs(response)))
    near = _around(np.abs(response), peak, 0.45)
    if near.size < 6:
        near = np.arange(max(peak - 4, 0), min(peak + 5, frequency.size))
    if near.size < 6:
        return None
    middle, size = float(frequency[peak]), float(np.abs(response[peak]))
    if size == 0:
        return None
    f, H = frequency[near] / middle, response[near] / size
    # In distances from the peak, as f² hardly changes over the band.
    s = f**2 - 1
    matrix = np.stack([H, -np.ones_like(H), s.astype(complex)], axis=1)
    (p, c, R), *_ = np.linalg.lstsq(matrix, H * s, rcond=None)
    squared = 1 + p.real
    if squared <= 0 or p.imag == 0:
        return None
    A = c - R * p
    diameter = abs(A / p.imag)
    centre = R + A / (2j * p.imag)
    distance = np.abs(H - centre)
    roundness = float(np.mean(np.abs(distance - diameter / 2)) / (diameter / 2))
    return ModalCircle(
        frequency=middle * float(np.sqrt(squared)),
        quality_factor=float(squared / p.imag),
        centre=complex(centre * size),
        diameter=float(diameter * size),
        roundness=roundness,
        points=int(near.size),
    )


def _around(size: si.FloatArray, peak: int, share: float) -> si.IntArray:
    """The points next to a peak that are above a share of it, without a gap."""
    low = high = peak
    while low > 0 and size[low - 1] > share * size[peak]:
        low -= 1
    while high < size.size - 1 and size[high + 1] > share * size[peak]:
        high += 1
    return np.arange(low, high + 1)
