"""The over-pressure of a plateau's film as a table of solved films, fast enough for load balances.

A plateau of width w between ambient grooves is a strip film under H = 1 + ε cos T. With the length
ℓ = w √(12 η ω/p0) its squeeze number is (ℓ/u)² and its Knudsen number (Λ/ℓ)(ℓ/u), Λ the mean free
path: at given frequency, width and gas it depends on the mean gap u and on ε = a/u alone. The
table holds ln((W − 1)/ε²), ln of stiffness and of damping over ln(u/ℓ) and −ln(1 − ε²), as
Chebyshev interpolants in panels that are solved when first needed. Nothing is fitted: every node
is a solved film, and each panel is checked against films solved between its nodes. Solved panels
are kept on disk (`kept.store`): a display that is asked again finds them. A panel depends on the
frequency by Λ/ℓ alone, and smoothly: `across_frequencies`, for thousands of displays each at one of
its own, panels are interpolated over it, so that two octaves are solved once.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache
from typing import TYPE_CHECKING, Annotated, NamedTuple

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.errors import ConvergenceError
from squeezefilm.film.gas import slip_law
from squeezefilm.film.periodic.batch import solve_films
from squeezefilm.kept.store import Kept
from squeezefilm.materials import Gas

if TYPE_CHECKING:
    from scipy.interpolate import KroghInterpolator

    from squeezefilm.contact.sharing.kernel import CompiledFilms

DEEPEST_EXCURSION: si.Dimensionless = 0.993
"""The deepest excursion a/u the table holds; the gap then closes to 0.7 % of its mean."""

_SHALLOWEST = 3e-3
_EXCURSIONS = (_SHALLOWEST, 0.8, 0.95, 0.985, DEEPEST_EXCURSION)
_EDGES = -np.log1p(-(np.array(_EXCURSIONS) ** 2))
_FIRST_COLUMN, _COLUMNS = -6, 10
_START = (8, 8)
_MOST = (41, 38)
_SMOOTH_LAWS = ("first", "second", "veijola")
# ln(Λ/ℓ) over two octaves of frequency, in which panels are interpolated between so many Chebyshev
# nodes: that errs by 2e-5 at most, of the over-pressure.
_SPAN = float(np.log(2.0))
_SPAN_NODES = 4
_ACROSS: ContextVar[bool] = ContextVar("across_frequencies", default=False)
_PANELS: Kept[si.FloatArray] = Kept("film-panels", si.FloatArray)


def default_tolerance(slip: str) -> float:
    """The relative tolerance of a table where none is asked: 5e-4, and 5e-3 with a slip law that
    has joints ("fukui-kaneko"), along which no smooth interpolant converges fast."""
    return 5e-4 if slip in _SMOOTH_LAWS else 5e-3


@si.checked_numbers
class FilmTable:
    """The film of a plateau at one frequency, width and gas, over mean gap and amplitude.

    `tolerance` is relative on the over-pressure (None: see `default_tolerance`). Panels of a table
    `across` frequencies are interpolated between those that other frequencies have, too. `error` is
    the largest deviation found between the table and films solved between its nodes, doubled, plus
    the solver's own estimate; None before the first panel is solved. `solved` counts the films
    of its panels.
    """

    def __init__(
        self,
        frequency: Annotated[si.Hertz, si.Above(0.0)],
        width: Annotated[si.Metre, si.Above(0.0)],
        gas: Gas,
        slip: str = "first",
        tolerance: Annotated[float, si.AtLeast(1e-6), si.AtMost(1e-2)] | None = None,
        *,
        across: bool = False,
    ) -> None:
        tolerance = default_tolerance(slip) if tolerance is None else tolerance
        slip_law(slip, 1.0)
        # A law with joints is not smooth in Λ/ℓ either.
        self._across = across and slip in _SMOOTH_LAWS
        self.frequency, self.width, self.gas = frequency, width, gas
        self.slip, self.tolerance = slip, tolerance
        self.length: si.Metre = width * float(
            np.sqrt(24 * np.pi * gas.viscosity * frequency / gas.ambient_pressure)
        )
        self.error: si.Dimensionless | None = None
        self.solved = 0
        self._nodes = _START
        self._scale = np.array([self.length, gas.ambient_pressure, float(_FIRST_COLUMN)])
        self._lock = threading.Lock()
        self._empty()

    def _empty(self) -> None:
        rows = len(_EXCURSIONS) - 1
        self._built = np.zeros((_COLUMNS, rows), dtype=np.int64)
        self._panels = np.zeros((_COLUMNS, rows, 3, *self._nodes))
        self.error = None

    @property
    def compiled(self) -> CompiledFilms:
        """The table as the compiled code takes it."""
        from squeezefilm.contact.sharing.kernel import CompiledFilms

        return CompiledFilms(self._scale, _EDGES, self._built, self._panels)

    @property
    def relative_error(self) -> si.Dimensionless:
        """The bound on the relative error of the over-pressure; 0 where no film was needed."""
        return 0.0 if self.error is None else self.error

    @si.checked_numbers
    def over_pressure(self, mean_gap: si.MetreLike, amplitude: si.MetreLike) -> si.PascalLike:
        """⟨p_gas⟩ − p0 (Pa), mean over plateau and period; broadcasts.

        Raises `InputError` for an amplitude above `DEEPEST_EXCURSION` of the gap or a gap off
        the table.
        """
        from squeezefilm.contact.sharing.kernel import film_value

        u, a = np.broadcast_arrays(np.asarray(mean_gap, float), np.asarray(amplitude, float))
        si.require("mean_gap", u, si.Unit("m"), above=0)
        si.require("amplitude", a, si.Unit("m"), at_least=0)
        si.require("amplitude / mean_gap", a / u, at_most=DEEPEST_EXCURSION)
        lowest, highest = np.exp([_FIRST_COLUMN, _FIRST_COLUMN + _COLUMNS]) * self.length
        si.require("mean_gap", u, si.Unit("m"), at_least=float(lowest), below=float(highest))
        out = np.empty(u.size)
        for k, (gap, swing) in enumerate(zip(u.ravel().tolist(), a.ravel().tolist(), strict=True)):
            value, lack = film_value(0, gap, swing, self.compiled)
            while lack >= 0:
                self.build(lack)
                value, lack = film_value(0, gap, swing, self.compiled)
            out[k] = value
        return out.reshape(u.shape)[()]

    def build(self, panel: int) -> None:
        """Solve the films of one panel (by its number), with more nodes until its check holds.

        Raises `ConvergenceError` where the largest number of nodes does not reach the tolerance.
        """
        with self._lock:
            while not self._built.flat[panel]:
                worst = self._solve(panel)
                if worst <= self.tolerance:
                    return
                if self._nodes >= _MOST:
                    raise ConvergenceError(
                        f"the film table of a plateau of {self.width * 1e6:.4g} µm at "
                        f"{self.frequency:.5g} Hz misses its tolerance {self.tolerance:g}: "
                        f"{worst:.3g} between nodes. Ask a larger tolerance",
                        residual=worst,
                    )
                # All panels have the same nodes, so that they meet without a step. The others are
                # solved again where they are asked for again: for a gap of a tenth of a millimetre
                # and the nodes that it takes all of them would take minutes.
                nx, nt = self._nodes
                self._nodes = (min(nx + 4, _MOST[0]), min(nt + 4, _MOST[1]))
                self._empty()

    def _solve(self, panel: int) -> float:
        """Fill a panel with what is kept of it, or else solved; the bound on its error."""
        nx, nt = self._nodes
        slip_length = float(self.gas.mean_free_path / self.length)
        which = _Panel(self.slip, self.tolerance, self._nodes, panel)
        solved = _interpolated if self._across else _kept
        found = solved(slip_length, which)
        self.solved += nx * nt + len(which.between()[0])
        self._panels.reshape(-1, 3, nx, nt)[panel] = found[:-1].reshape(3, nx, nt)
        self._built.flat[panel] = 1
        error = float(found[-1])
        self.error = max(self.relative_error, error)
        return error


class _Panel(NamedTuple):
    """A panel of a table, but for Λ/ℓ; nothing else of gas, width and frequency is in it."""

    slip: str
    tolerance: float
    nodes: tuple[int, int]
    number: int

    def between(self) -> tuple[si.FloatArray, si.FloatArray]:
        """Points between nodes where a panel is checked: a lattice that meets every line. A slip
        law with joints leaves its mark somewhere along them: there, between all nodes."""
        nx, nt = self.nodes
        lines = 1 if self.slip in _SMOOTH_LAWS else nt - 1
        i = np.tile(np.arange(nx - 1), lines)
        j = (3 * i + np.repeat(np.arange(lines), nx - 1)) % (nt - 1)
        return np.cos(np.pi * (i + 0.5) / (nx - 1)), np.cos(np.pi * (j + 0.5) / (nt - 1))

    def films(
        self, slip_length: float, x: si.FloatArray, y: si.FloatArray
    ) -> tuple[si.FloatArray, float]:
        """The logarithms of the panel's three quantities at points of it, shape (3, points), and
        the relative error of the over-pressure."""
        column, row = divmod(self.number, len(_EXCURSIONS) - 1)
        low, high = _EDGES[row], _EDGES[row + 1]
        gap = np.exp(_FIRST_COLUMN + column + 0.5 * (x + 1.0))
        excursion = np.sqrt(-np.expm1(-(low + 0.5 * (y + 1.0) * (high - low))))
        # Errors of films on grids of their own look like noise between nodes, which no further node
        # takes away; the bound on a panel is some three times as large.
        share = 1 / 6 if self.slip in _SMOOTH_LAWS else 1 / 10
        films = solve_films(
            gap**-2.0,
            excursion,
            knudsen_number=slip_length / gap,
            slip=self.slip,
            tolerance=self.tolerance * share,
            workers=1,
        )
        values = (
            films.over_pressure / excursion**2,
            films.stiffness_relative,
            films.damping_relative,
        )
        return np.log(values), float(np.max(films.over_pressure_error / films.over_pressure))


def _kept(slip_length: float, which: _Panel) -> si.FloatArray:
    """The coefficients of a panel's three quantities, and the bound on its error."""
    asked = repr((slip_length.hex(), *which))
    return _PANELS.found(asked, lambda: _solved(slip_length, which))


def _solved(slip_length: float, which: _Panel) -> si.FloatArray:
    nx, nt = which.nodes
    xi, eta = (np.cos(np.pi * np.arange(n) / (n - 1)) for n in (nx, nt))
    XI, ETA = np.meshgrid(xi, eta, indexing="ij")
    between = which.between()
    x, y = (
        np.concatenate([nodes.ravel(), points])
        for nodes, points in zip((XI, ETA), between, strict=True)
    )
    values, films_error = which.films(slip_length, x, y)
    panels = np.stack([_coefficients(one[: nx * nt].reshape(nx, nt)) for one in values])
    deviation = _deviation(panels[0], between, values[0][nx * nt :])
    return np.append(panels.ravel(), 2.0 * deviation + films_error)


def _deviation(
    panel: si.FloatArray, points: tuple[si.FloatArray, si.FloatArray], values: si.FloatArray
) -> float:
    """The largest relative deviation of a panel from logarithms of films at points of it."""
    from numpy.polynomial import chebyshev

    return float(np.max(np.abs(np.expm1(chebyshev.chebval2d(*points, panel) - values))))


def _interpolated(slip_length: float, which: _Panel) -> si.FloatArray:
    """As `_kept`, interpolated over the span in which Λ/ℓ lies."""
    span, place = divmod(float(np.log(slip_length)) / _SPAN, 1.0)
    panel, error = _span(int(span), which)
    return np.append(panel(place), error)


@lru_cache(maxsize=2048)
def _span(number: int, which: _Panel) -> tuple[KroghInterpolator, float]:
    """A panel's coefficients over a span, from 0 to 1, and the bound on the error within."""
    from scipy.interpolate import KroghInterpolator

    places = 0.5 * (np.cos(np.pi * np.arange(_SPAN_NODES) / (_SPAN_NODES - 1)) + 1.0)
    rows = np.array([_kept(float(np.exp(_SPAN * (number + one))), which) for one in places])
    panel = KroghInterpolator(places, rows[:, :-1])
    points = which.between()
    # Midway between nodes the interpolation errs most.
    values, films_error = which.films(float(np.exp(_SPAN * (number + 0.5))), *points)
    deviation = _deviation(panel(0.5).reshape(3, *which.nodes)[0], points, values[0])
    return panel, max(2.0 * deviation + films_error, *rows[:, -1].tolist())


def _coefficients(values: si.FloatArray) -> si.FloatArray:
    """Chebyshev coefficients from values at the Lobatto nodes of both directions."""
    from scipy.fft import dct

    result = values
    for axis in (0, 1):
        n = values.shape[axis] - 1
        result = np.asarray(dct(result, type=1, axis=axis)) / n
        ends = [slice(None), slice(None)]
        for end in (0, n):
            ends[axis] = slice(end, end + 1)
            result[tuple(ends)] *= 0.5
    return np.ascontiguousarray(result)


@contextmanager
def across_frequencies() -> Iterator[None]:
    """While a search looks at thousands of displays: their film tables are interpolated between
    films that they share, within the same tolerance."""
    before = _ACROSS.set(True)
    try:
        yield
    finally:
        _ACROSS.reset(before)


@si.checked_numbers
def film_table(
    frequency: si.Hertz,
    width: si.Metre,
    gas: Gas,
    slip: str = "first",
    tolerance: float | None = None,
) -> FilmTable:
    """The table of a plateau's film (kept, so that each is solved once). See `FilmTable`."""
    return _table(frequency, width, gas, slip, tolerance, _ACROSS.get())


@lru_cache(maxsize=256)
def _table(
    frequency: si.Hertz,
    width: si.Metre,
    gas: Gas,
    slip: str,
    tolerance: float | None,
    across: bool,
) -> FilmTable:
    return FilmTable(frequency, width, gas, slip, tolerance, across=across)
