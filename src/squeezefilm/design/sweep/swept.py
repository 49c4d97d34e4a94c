"""Result of a sweep: a row for each point, with what was varied, what was asked, and the reason
where there is no answer; and how much of each answer's variance follows which varied value."""

from __future__ import annotations

import collections
import itertools
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.results import Result
from squeezefilm.design.sweep.axes import Axis
from squeezefilm.design.sweep.followed import FollowedMode

NOT_YET = "not computed"
"""The reason of a point to which a sweep that was stopped did not come."""


def counted(texts: Iterable[str]) -> tuple[tuple[str, int], ...]:
    """Texts with how often each is said, the most common first; of those that differ in their
    numbers only, one stands for all."""
    alike: dict[str, str] = {}
    counts: collections.Counter[str] = collections.Counter()
    for text in texts:
        plain = re.sub(r"[-+]?\d[\d.e+-]*( [a-zµ%]?[A-Za-z%]+\b)?", "#", text)
        alike.setdefault(plain, text)
        counts[plain] += 1
    return tuple((alike[plain], count) for plain, count in counts.most_common())


@dataclass(frozen=True)
class SweptColumn:
    """A number over the points: its name with its unit, the unit, the values (SI; NaN for none),
    shape (points,). Of words that were varied the unit is 1, the values number the `words`."""

    name: str
    unit: si.Unit
    values: si.FloatArray
    words: tuple[str, ...] = ()
    logarithmic: bool = False


@dataclass(frozen=True, eq=False, repr=False)
class Sweep(Result):
    """Result of a sweep: a row for each point, in the order of its axes, the last varying fastest.

    Attributes:
        title: of what was swept.
        verbs: which verbs answered.
        axes: what was varied.
        columns: what was asked for.
        reasons: of each point, why it has no answer; empty where it has one.
        warnings: what was warned of at any point, with the number of points, the most common first.
        computed, kept: how many answers were computed now, and how many were there before.
        follows: the modes that were followed, where they were asked for.
    """

    title: str
    verbs: tuple[str, ...]
    axes: tuple[Axis, ...]
    columns: tuple[SweptColumn, ...]
    reasons: tuple[str, ...]
    warnings: tuple[tuple[str, int], ...]
    computed: int
    kept: int
    provenance: Mapping[str, Any]
    follows: tuple[FollowedMode, ...] = ()
    _shown: ClassVar[str] = "title shape names answered missing"

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of steps that each axis has."""
        return tuple(len(axis) for axis in self.axes)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the columns that were asked for."""
        return tuple(column.name for column in self.columns)

    @property
    def answered(self) -> int:
        """Number of points that have answers."""
        return sum(not reason for reason in self.reasons)

    @property
    def missing(self) -> int:
        """Number of points that were not computed, because the sweep was stopped."""
        return sum(reason == NOT_YET for reason in self.reasons)

    def settings(self) -> dict[str, list[Any]]:
        """Values varied at each point, by column; numbers are SI with the unit in the name."""
        steps = list(itertools.product(*(axis.steps for axis in self.axes)))
        names = [name for axis in self.axes for name in axis.columns]
        rows = [[value for step in point for value in step] for point in steps]
        return {name: [row[number] for row in rows] for number, name in enumerate(names)}

    def column(self, name: str) -> si.FloatArray:
        """The values (SI) of what was asked for, NaN where there is none, shape (points,). Raises
        `InputError` for a name that was not asked for."""
        for column in self.columns:
            if name in (column.name, column.name.removesuffix(column.unit.suffix)):
                return column.values
        raise InputError(
            f"the sweep has no column '{name}'.{si.did_you_mean(name, self.names)} It has: "
            f"{', '.join(self.names)}"
        )

    def grid(self, name: str) -> si.FloatArray:
        """The values of `column` on the grid of the axes, of the sweep's shape."""
        return self.column(name).reshape(self.shape)

    def table(self) -> dict[str, list[Any]]:
        """Table of what was varied, what was asked for (None without an answer), and the reason."""
        values = {
            column.name: [None if math.isnan(v) else v for v in column.values.tolist()]
            for column in self.columns
        }
        return {**self.settings(), **values, "reason": list(self.reasons)}

    _table = table

    def summary(self) -> dict[str, Any]:
        """Mapping of plain JSON values."""
        table = self.table()
        return {
            "title": self.title,
            "verbs": list(self.verbs),
            "axes": [
                {"names": list(axis.columns), "steps": [list(step) for step in axis.steps]}
                for axis in self.axes
            ],
            "asked": list(self.names),
            "rows": [
                dict(zip(table, row, strict=True)) for row in zip(*table.values(), strict=True)
            ],
            "warnings": [{"text": text, "points": points} for text, points in self.warnings],
            "followed": [
                {
                    "mode": follow.label,
                    "driven": follow.driven,
                    "likeness": follow.likeness.tolist(),
                }
                for follow in self.follows
            ],
            "answers_computed": self.computed,
            "answers_kept": self.kept,
            "provenance": dict(self.provenance),
        }


# Over a whole grid the shares are exact for its points (analysis of variance: first order, total,
# pairs). Over samples, or a grid with gaps, the answer is fitted by orthogonal polynomials of the
# varied values (polynomial chaos: Sudret 2008, doi:10.1016/j.ress.2007.04.002), of the degree that
# predicts left-out points best; the shares are those of the fit, their errors come from drawing the
# points again (bootstrap), and what the fit does not explain of points left out is told.
_DEGREES = range(1, 7)
_REDRAWN = 100
_FEWEST = 8
"""Smallest number of points that tell of shares."""


Share = tuple[si.Dimensionless, si.Dimensionless]
"""A share of the variance, and its standard error (0 where it is exact for the points)."""


@dataclass(frozen=True, eq=False)
class Effects:
    """Shares of what decides one answer: of each varied value the share that it explains by itself
    (`first`) and with all interactions (`total`), and of each pair what only both together explain;
    `explained` is what the fit explains of points left out (None where nothing was fitted: the
    whole grid)."""

    column: SweptColumn
    first: Sequence[Share]
    total: Sequence[Share]
    pairs: Mapping[tuple[int, int], Share]
    explained: si.Dimensionless | None
    points: int


def varied_values(sweep: Sweep) -> tuple[SweptColumn, ...]:
    """The values that were varied and take several values."""
    made, settings = list[SweptColumn](), sweep.settings()
    for axis in sweep.axes:
        for k, (name, unit) in enumerate(zip(axis.columns, axis.units, strict=True)):
            said = settings[name]
            if len(set(said)) < 2:
                continue
            if unit is None:
                words = tuple(dict.fromkeys(str(word) for word in said))
                values = np.array([float(words.index(str(word))) for word in said])
                made.append(SweptColumn(name, si.Unit("1"), values, words))
            else:
                log = axis.sampled[k] == "log" if axis.sampled else axis.logarithmic
                made.append(SweptColumn(name, unit, np.array(said, float), (), log))
    return tuple(made)


def effects_of(sweep: Sweep) -> tuple[Effects, ...]:
    """Effects on each of a sweep's answers that varies; empty where nothing can be said."""
    varied = varied_values(sweep)
    out = []
    for column in sweep.columns:
        there = np.isfinite(column.values)
        values = column.values[there]
        if not varied or len(values) < _FEWEST or np.ptp(values) <= 1e-12 * np.abs(values).max():
            continue
        whole = there.all() and len(varied) == sum(len(axis) > 1 for axis in sweep.axes)
        if whole:
            shape = tuple(len(axis) for axis in sweep.axes if len(axis) > 1)
            out.append(_of_grid(column, column.values.reshape(shape)))
        elif (fitted := _of_points(column, varied, there)) is not None:
            out.append(fitted)
    return tuple(out)


def _of_grid(column: SweptColumn, grid: si.FloatArray) -> Effects:
    """The analysis of variance of a whole grid, one point in each cell."""
    count = grid.ndim
    variance = float(grid.var())

    def explained(axes: Sequence[int]) -> float:
        """The share of the variance that the means over all other axes have."""
        others = tuple(k for k in range(count) if k not in axes)
        return float(grid.mean(axis=others).var() / variance) if axes else 0.0

    first = [explained([k]) for k in range(count)]
    total = [1.0 - explained([j for j in range(count) if j != k]) for k in range(count)]
    pairs = {
        (i, j): (max(explained([i, j]) - first[i] - first[j], 0.0), 0.0)
        for i, j in itertools.combinations(range(count), 2)
    }
    alone, whole = ([(share, 0.0) for share in shares] for shares in (first, total))
    return Effects(column, alone, whole, pairs, None, grid.size)


def _of_points(
    column: SweptColumn, varied: Sequence[SweptColumn], there: NDArray[np.bool_]
) -> Effects | None:
    """The shares of a fit by orthogonal polynomials; None where the points are too few."""
    y = column.values[there]
    y = (y - y.mean()) / y.std()
    single = [_functions(value, there) for value in varied]
    best: tuple[float, si.FloatArray, list[tuple[int, ...]]] | None = None
    for degree in _DEGREES:
        most = len(y) // 2
        counts = [len(functions) for functions in single]
        terms = list(itertools.islice(_terms(counts, degree, varied), most + 1))
        if len(terms) > most:
            break
        matrix = _matrix(single, terms, len(y))
        left = _left_out_error(matrix, y)
        if best is None or left < best[0]:
            best = left, matrix, terms
    if best is None:
        return None
    left, matrix, terms = best
    own = _sums(_coefficients(matrix, y), terms, len(varied))
    random = np.random.default_rng(0)
    again = []
    for _ in range(_REDRAWN):
        rows = random.integers(len(y), size=len(y))
        again.append(_sums(_coefficients(matrix[rows], y[rows]), terms, len(varied)))
    first, total, both = (
        list(zip(shares.tolist(), np.std(drawn, axis=0).tolist(), strict=True))
        for shares, *drawn in zip(own, *again, strict=True)
    )
    pairs = dict(zip(itertools.combinations(range(len(varied)), 2), both, strict=True))
    return Effects(column, first, total, pairs, max(1.0 - left, 0.0), len(y))


def _functions(value: SweptColumn, there: NDArray[np.bool_]) -> list[si.FloatArray]:
    """Functions of one varied value that are orthonormal over its range: Legendre's polynomials of
    numbers, contrasts of words; none of a value that is the same at all points."""
    x = np.log(value.values[there]) if value.logarithmic else value.values[there]
    if np.ptp(x) == 0:
        return []
    if value.words:
        basis, _ = np.linalg.qr(
            np.column_stack([np.ones(len(value.words)), np.eye(len(value.words))[:, 1:]])
        )
        scaled = basis[:, 1:] * math.sqrt(len(value.words))
        return [scaled[x.astype(int), k] for k in range(scaled.shape[1])]
    u = 2 * (x - x.min()) / np.ptp(x) - 1
    most = min(max(_DEGREES), len(np.unique(x)) - 1)
    polynomials = np.polynomial.legendre.legvander(u, most) * np.sqrt(2 * np.arange(most + 1) + 1)
    return list(polynomials.T[1:])


def _terms(
    counts: Sequence[int], degree: int, varied: Sequence[SweptColumn]
) -> Iterator[tuple[int, ...]]:
    """Terms, each by the function of each value that it multiplies (0: none), of a total degree; a
    contrast of words counts as degree 1."""
    if not counts:
        yield ()
        return
    words = bool(varied[0].words)
    for k in range(min(counts[0], counts[0] if words else degree) + 1):
        size = min(k, 1) if words else k
        if size <= degree:
            for rest in _terms(counts[1:], degree - size, varied[1:]):
                yield (k, *rest)


def _matrix(
    single: Sequence[Sequence[si.FloatArray]], terms: Sequence[tuple[int, ...]], count: int
) -> si.FloatArray:
    columns = []
    for term in terms:
        used = [functions[k - 1] for functions, k in zip(single, term, strict=True) if k]
        columns.append(np.prod([np.ones(count), *used], axis=0))
    return np.column_stack(columns)


def _coefficients(matrix: si.FloatArray, y: si.FloatArray) -> si.FloatArray:
    return np.asarray(np.linalg.lstsq(matrix, y, rcond=None)[0])


def _left_out_error(matrix: si.FloatArray, y: si.FloatArray) -> float:
    """The mean squared error of each point predicted from all others, over the variance."""
    q, _ = np.linalg.qr(matrix)
    leverage = np.clip((q**2).sum(axis=1), 0.0, 1.0 - 1e-9)
    residual = y - q @ (q.T @ y)
    return float(np.mean((residual / (1.0 - leverage)) ** 2))


def _sums(
    coefficients: si.FloatArray, terms: Sequence[tuple[int, ...]], count: int
) -> tuple[si.FloatArray, si.FloatArray, si.FloatArray]:
    """Shares of the fit's variance: of each value alone, with others, of pairs alone."""
    powers, used = coefficients**2, np.array(terms, dtype=bool)
    several = used.sum(axis=1)
    powers = powers / (powers[several > 0].sum() or 1.0)
    pairs = [
        powers[(several == 2) & used[:, pair].all(axis=1)].sum()
        for pair in itertools.combinations(range(count), 2)
    ]
    return powers[several == 1] @ used[several == 1], powers @ used, np.array(pairs)
