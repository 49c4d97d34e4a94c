"""The spatial frequencies at which a texture without a period is judged."""

from __future__ import annotations

import math

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.render.fidelity.rendered_stroke import RenderedStroke

_MOST_LINES = 6
_FAINT = 0.01


def strongest_lines(stroke: RenderedStroke, period: si.Metre | None) -> si.FloatArray | None:
    """Spatial frequencies (1/m) at which a texture without a period has its contrast.

    The strongest lines of the first pass's spectrum, at most six; elsewhere a share of next to
    nothing would be measured. None where `fidelity_report` knows better.
    """
    turns = np.flatnonzero(np.diff(np.sign(np.diff(stroke.position))) != 0)
    end = int(turns[0]) + 2 if turns.size else stroke.position.size
    way, wanted = stroke.position[:end], stroke.relative_friction_wanted[:end]
    length = abs(float(way[-1] - way[0]))
    if period is not None or length == 0.0 or way.size < 64:
        return None
    rising = 1 if way[-1] > way[0] else -1
    even = np.linspace(way.min(), way.max(), 8192)
    values = np.interp(even, way[::rising], wanted[::rising])
    power = np.abs(np.fft.rfft((values - values.mean()) * np.hanning(even.size))) ** 2
    # A pass whose start is left out must still show four periods.
    least = math.ceil(5 / (1 - 0.2))
    lines = np.arange(least, power.size - 1)
    peaks = lines[(power[lines] >= power[lines - 1]) & (power[lines] > power[lines + 1])]
    strong = peaks[power[peaks] > _FAINT * power[least:].max(initial=0.0)]
    best = np.sort(strong[np.argsort(power[strong])[::-1][:_MOST_LINES]])
    return np.asarray(best / length, dtype=float) if best.size else None
