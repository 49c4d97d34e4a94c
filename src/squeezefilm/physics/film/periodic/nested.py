"""Film on nested grids, refined until its mean load and its force's harmonics are known.

Where the field is asked for, the harmonics are read off it on every grid, each is extrapolated like
the mean, and judged by the same rule: what the extrapolated value changed by from grid to grid, and
what more times change on the coarsest grid.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.film.periodic.batch import ROUNDS
from squeezefilm.physics.film.periodic.profile import evaluate, interpolant
from squeezefilm.physics.film.periodic.resolution import FilmResolution, refined, resolution_of
from squeezefilm.physics.film.periodic.solution import HARMONICS, Found

NEWTON_SHARE = 0.03
"""Share of the tolerance for Newton's method where the harmonics are judged too: it converges so
fast that this costs a step at most, and what it leaves no longer blurs the estimate."""


class Level(NamedTuple):
    """P − 1 at the nodes of one grid, edges included, and the nodes' shares of the area."""

    pressure: si.FloatArray
    share: si.FloatArray


class Nested(NamedTuple):
    """A film on three nested grids: places X and the gap's harmonics at the nodes of the finest,
    the result row (columns in `uniform`), and the levels: the coarsest grid with the times that
    check, then the three grids; none where the load alone is asked for."""

    resolution: FilmResolution
    x: si.FloatArray
    harmonics: si.ComplexArray
    row: si.FloatArray
    levels: list[Level]


class Kind(NamedTuple):
    """Inputs of the estimate of the error: σ of the gas as it flows, the deepest relative
    excursion, the cells of the finest grid over those from the centre to an edge, the shape as
    compiled code knows it, the margins in space and in time, polytropic exponent, and σ itself."""

    local_squeeze_number: float
    depth: float
    sides: int
    shape: int
    margins: tuple[float, float]
    polytropic_exponent: float
    squeeze_number: float


UNIFORM_MARGINS, PROFILE_MARGINS = (0.15, 2.5), (0.16, 4.5)
"""Share of the last change of the extrapolated value that is its error, and multiple of the change
by more times on the coarsest grid that is the error in time: where the gap varies, the coarsest
grid sees less of it."""


def levels_of(keep: si.FloatArray, resolution: FilmResolution, closed: bool) -> list[Level]:
    """The levels that a compiled solve left in `keep`."""
    cells, times, levels, start = resolution.cells, resolution.times, [], 0
    grids = ((cells // 4, resolution.check), *((cells // part, times) for part in (4, 2, 1)))
    for m, now in grids:
        # At an edge p is 0, whatever its share.
        p, share, first = np.zeros((m + 1, now.number)), np.zeros(m + 1), 0 if closed else 1
        size = (m - first) * now.row
        p[first:m] = keep[start : start + size].reshape(-1, now.row)[:, : now.number]
        share[first:m] = keep[start + size : start + size + m - first]
        start += size + m - first
        levels.append(Level(p, share))
    return levels


def force_harmonics(
    levels: Sequence[Level], gap_harmonics: si.ComplexArray, n: float, depth: float
) -> list[si.ComplexArray]:
    """F_0 … F_8 of the area mean of P − 1 = Re Σ F_k e^{ikT} on each grid.

    (P − 1) Hⁿ is nearly constant in time, P − 1 is not: it is interpolated between the times, and
    divided by Hⁿ at as many as the harmonics of 1/H need.
    """
    most = max(level.pressure.shape[1] for level in levels)
    count = 2 * (max(64, 2 * most, load_times(most, depth) + HARMONICS) // 2)
    fine = 2.0 * np.pi * np.arange(count) / count
    inverse = evaluate(gap_harmonics, fine) ** -n
    # Only the first harmonics of the force are wanted: sums, and no transform of every node.
    wave = np.exp(-1j * np.outer(fine, np.arange(HARMONICS + 1))) / count
    wave[:, 1:] *= 2.0
    fields = []
    for level in levels:
        times = level.pressure.shape[1]
        every = (len(inverse) - 1) // (len(level.share) - 1)
        nodes = 2.0 * np.pi * np.arange(times) / times
        stored = level.pressure * evaluate(gap_harmonics[:, ::every], nodes) ** n
        # The force at a fine time is Σ_j (share · stored_j / Hⁿ) × the interpolant's weight.
        held = (stored * level.share[:, None]).T @ inverse[::every]
        fields.append(np.asarray((held * interpolant(times, count)).sum(axis=0) @ wave))
    return fields


def load_times(times: int, depth: float) -> int:
    """Number of times that the load integral over 1/H needs for a relative error below 1e-10.

    The harmonics of 1/H fall like r^k with r = ε/(1 + √(1 − ε²)).
    """
    ratio = depth / (1.0 + np.sqrt(1.0 - min(depth, 0.999) ** 2))
    decades = np.log(1e-10) / np.log(max(ratio, 1e-3))
    return int(times // 2 + 8 + decades)


class _Judged(NamedTuple):
    """The harmonics of a force, the mean first, their errors in space, in time and in all, and the
    rounding in them. NaN beyond the mean where the load alone was asked for."""

    value: si.ComplexArray
    space: si.FloatArray
    time: si.FloatArray
    error: si.FloatArray
    rounded: float


def _judged(film: Nested, kind: Kind) -> _Judged:
    from squeezefilm.physics.film.periodic import uniform as u

    row, n, over = film.row, kind.polytropic_exponent, film.row[u.OVER]
    rounded = float(u.rounding(kind.squeeze_number, n, over))
    if not film.levels or not np.isfinite(over):
        alone = np.full((4, HARMONICS + 1), np.nan)
        alone[:, 0] = over, row[u.SPACE], row[u.TIME], row[u.ERROR]
        return _Judged(alone[0].astype(complex), alone[1], alone[2], alone[3], rounded)
    check, coarse, middle, fine = force_harmonics(film.levels, film.harmonics, n, kind.depth)
    value = fine + (fine - middle) / 3.0
    # The mean has weights of its own in the solver.
    value[0] = over
    check[0], coarse[0], middle[0], fine[0] = row[[u.CHECK, u.COARSE, u.MIDDLE, u.FINE]]
    change = np.abs(4.0 * (fine - middle) - (middle - coarse)) / 3.0
    # Of `space_error`: the part of the last step that is its floor.
    cells = film.resolution.cells // kind.sides
    unsure = u.space_error(0.0, 4.0, 5.0, kind.local_squeeze_number, kind.depth, cells, kind.shape)
    unsure *= min(1.0, _UNSURE + unsure)
    space = np.maximum(kind.margins[0] * change, unsure * np.abs(fine - middle))
    time = kind.margins[1] * np.abs(check - coarse)
    size = np.abs(value)
    error = steadied(space + time, size) + film.row[u.RESIDUAL] * abs(over) + rounded
    # Both steadied as their sum is, so that what is too large is refined.
    space, time = steadied(space, size), steadied(time, size)
    return _Judged(value, space, time, error, rounded)


_STILL = 1e-12  # a depth below which a gap does not move
_UNSURE = 0.3
_LEAST_SHARE, _NEXT_SHARE, _NEXT_RELATIVE, _MEAN_SHARE = 0.02, 0.4, 1.5, 0.5


def steadied(error: si.FloatArray, size: si.FloatArray) -> si.FloatArray:
    """Errors of harmonics of the given size, none of them small by accident.

    Each change from grid to grid may pass through zero, those of all harmonics at once do not: an
    error is at least a part of the largest, of the one before it, absolute and relative to its
    harmonic, and that of the mean at least a part of the first's, relative to it. The parts are
    measured, on 700 random strips, discs and profiles. Both arrays have the mean first.
    """
    steady = np.maximum(error, _LEAST_SHARE * error[1:].max())
    for k in range(2, len(error)):
        relative = min(size[k] / size[k - 1], 1.0) if size[k - 1] > 0.0 else 0.0
        steady[k] = max(steady[k], steady[k - 1] * max(_NEXT_SHARE, _NEXT_RELATIVE * relative))
    relative = min(size[0] / size[1], 1.0) if size[1] > 0.0 else 0.0
    steady[0] = max(error[0], _MEAN_SHARE * relative * steady[1])
    return np.asarray(steady)


def refine(
    solve: Callable[[FilmResolution], Nested],
    kind: Kind,
    first: tuple[int, int],
    tolerance: float,
    most_cells: int,
) -> tuple[Nested, Found]:
    """Solve on finer grids and at more times until the tolerance is met: by the mean, relative to
    the over-pressure, and by every harmonic, relative to the largest. Stops where rounding alone is
    more, or where nothing more is to be gained. `first` are cells and the index of times."""
    from squeezefilm.physics.film.periodic import uniform as u

    cells, t, iterations = first[0], np.array([first[1]]), 0
    for turn in range(1, ROUNDS + 1):
        film = solve(resolution_of(cells, int(t[0])))
        iterations += int(film.row[u.ITERATIONS])
        judged = _judged(film, kind)
        lacking = None if kind.depth < _STILL else _lacking(judged, tolerance)
        if lacking is None or lacking.hopeless or cells > most_cells or turn == ROUNDS:
            break  # what is given back is of the grid that was solved
        more, t2 = refined(np.zeros(1, dtype=np.int64), t, *np.array(lacking[:3])[:, None])
        if more[0] > 0:
            ratio = max(lacking.space / lacking.allowed / 0.5, 1.0) ** 0.25
            cells = 4 * round(cells * min(max(1.3, ratio), 4.0) / 4)
        elif t2[0] == t[0]:
            break
        t = t2
    return film, Found(
        float(film.row[u.OVER]),
        float(judged.error[0]),
        lacking is None,
        iterations,
        float(film.row[u.RESIDUAL]),
        film.resolution.cells,
        film.resolution.times.number,
        judged.value,
        judged.error,
    )


class _Lacking(NamedTuple):
    """The errors in space and time of what misses the tolerance, what is allowed of them, and
    whether rounding alone is more."""

    space: float
    time: float
    allowed: float
    hopeless: bool


def _lacking(judged: _Judged, tolerance: float) -> _Lacking | None:
    """The mean if it misses the tolerance, otherwise the worst harmonic if that does."""
    value, space, time, error, rounded = judged
    size = np.abs(value)
    for k, norm in ((0, size[0]), (1 + int(np.argmax(error[1:])), size[1:].max())):
        allowed = tolerance * norm
        if (k == 0 and not error[0] <= allowed) or error[k] > allowed:
            allowed = max(allowed, 1e-300) if np.isfinite(allowed) else 1e-300
            hopeless = bool(rounded > allowed) and bool(np.isfinite(value[0]))
            return _Lacking(float(space[k]), float(time[k]), float(allowed), hopeless)
    return None
