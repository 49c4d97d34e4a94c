"""The over-pressure of a plateau's film as a table of solved films, fast enough for load balances.

A plateau of width w between ambient grooves is a strip film under H = 1 + ε cos T. With the length
ℓ = w √(12 η ω/p0) its squeeze number is (ℓ/u)² and its Knudsen number (Λ/ℓ)(ℓ/u), Λ the mean free
path: at given frequency, width and gas it depends on the mean gap u and on ε = a/u alone. The
table holds ln((W − 1)/ε²), ln of stiffness and of damping over ln(u/ℓ) and −ln(1 − ε²), as
Chebyshev interpolants in panels that are made when first needed (`film_panels`). Nothing is fitted:
every node is a solved film, and each panel is checked against films solved between its nodes.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError
from squeezefilm.core.kept.store import Kept
from squeezefilm.core.materials import Gas
from squeezefilm.physics.film.gas import slip_law
from squeezefilm.physics.film.periodic.batch import solve_films

if TYPE_CHECKING:
    from squeezefilm.physics.contact.sharing.kernel import CompiledFilms

# A panel depends on gas, width and frequency through the slip length Λ/ℓ alone, and smoothly (see
# `gas_table`). Those of usual laws at their tolerance for .002 < Λ/ℓ < .0625 come with the package
# (`tools/film_panels.py` writes them): plateaus of 100 to 500 µm at 20 to 100 kHz in air. They are
# solved at Chebyshev nodes of each octave of Λ/ℓ and interpolated between them, which errs by some
# 1e-5 of the over-pressure with a smooth slip law and by up to 5e-3 with one that has joints.
# Others are solved at their own Λ/ℓ when first asked for, and kept (`core.kept.store`).
DEEPEST_EXCURSION: si.Dimensionless = 0.993
"""The deepest excursion a/u the table holds; the gap then closes to 0.7 % of its mean."""

FIRST_COLUMN, COLUMNS = -6, 10
"""The first power of e of u/ℓ, and how many powers there are: a column of panels each."""
EXCURSIONS = (3e-3, 0.8, 0.95, 0.985, DEEPEST_EXCURSION)
ROWS = len(EXCURSIONS) - 1
EDGES: si.FloatArray = -np.log1p(-(np.array(EXCURSIONS) ** 2))
"""The edges of the rows of panels, as excursions and as −ln(1 − ε²)."""
SMOOTH_LAWS = ("first", "second", "veijola")
START = (8, 8)
"""The numbers of nodes of a panel that is first tried."""
SHIPPED = Path(__file__).with_name("film_panels.npz")
SHIPPED_OCTAVES = range(-9, -4)
"""The octaves log2(Λ/ℓ) of the panels that come with the package."""
SHIPPED_PANELS: Mapping[str, tuple[int, ...]] = {
    "first": tuple(range(COLUMNS * ROWS)),
    "veijola": tuple(range(COLUMNS * ROWS)),
    # The deepest row takes seconds an octave and misses the tolerance of 1e-2.
    "fukui-kaneko": tuple(n for n in range(COLUMNS * ROWS) if n % ROWS < ROWS - 1),
}
"""Their numbers, by the slip law: the default one and those that intervals draw."""

_PLACES = 0.5 * (1.0 - np.cos(np.pi * np.arange(5) / 4))
_POWERS = np.arange(_PLACES.size)
_TO_POWERS = np.linalg.inv(_PLACES[:, None] ** _POWERS)
_PANELS: Kept[si.FloatArray] = Kept("film-panels", si.FloatArray)


def default_tolerance(slip: str) -> float:
    """The relative tolerance of a table where none is asked: 5e-4, and 1e-2 with a slip law that
    has joints ("fukui-kaneko"), along which no smooth interpolant converges fast."""
    return 5e-4 if slip in SMOOTH_LAWS else 1e-2


class Panel(NamedTuple):
    """A panel of a table, but for Λ/ℓ; nothing else of gas, width and frequency is in it."""

    slip: str
    tolerance: float
    nodes: tuple[int, int]
    number: int

    def at(self, slip_length: si.Dimensionless) -> si.FloatArray:
        """The coefficients of the panel's three quantities at Λ/ℓ, and the bound on their relative
        error. Raises `ConvergenceError` for films that are not solved."""
        octave, place = divmod(float(np.log2(slip_length)), 1.0)
        known = _shipped().get((int(octave), self))
        if known is None:
            asked = repr((slip_length.hex(), *self))
            return _PANELS.found(asked, lambda: self.solved(slip_length))
        return np.append(
            (place**_POWERS @ _TO_POWERS) @ known[:-1].reshape(_POWERS.size, -1), known[-1]
        )

    def octave_solved(self, octave: int) -> si.FloatArray:
        """The coefficients at the nodes of an octave of Λ/ℓ, and the bound on the error within."""
        rows = np.array([self.solved(2.0 ** (octave + place)) for place in _PLACES.tolist()])
        points = self.between()
        # Between the second and the third node it errs most.
        values, films_error = self.films(2.0 ** (octave + 0.32), *points)
        middle = (0.32**_POWERS @ _TO_POWERS) @ rows[:, :-1]
        deviation = _deviation(middle.reshape(3, *self.nodes)[0], points, values[0])
        bound = max(2.0 * deviation + films_error, *rows[:, -1].tolist())
        return np.append(rows[:, :-1], bound)

    def solved(self, slip_length: si.Dimensionless) -> si.FloatArray:
        """Panel as by `at`, all films of it solved at this Λ/ℓ."""
        nx, nt = self.nodes
        xi, eta = (np.cos(np.pi * np.arange(n) / (n - 1)) for n in (nx, nt))
        XI, ETA = np.meshgrid(xi, eta, indexing="ij")
        between = self.between()
        x, y = (
            np.concatenate([nodes.ravel(), points])
            for nodes, points in zip((XI, ETA), between, strict=True)
        )
        values, films_error = self.films(slip_length, x, y)
        panels = np.stack([_coefficients(row[: nx * nt].reshape(nx, nt)) for row in values])
        deviation = _deviation(panels[0], between, values[0][nx * nt :])
        return np.append(panels.ravel(), 2.0 * deviation + films_error)

    def between(self) -> tuple[si.FloatArray, si.FloatArray]:
        """Points between nodes where a panel is checked: a lattice that meets every line. A slip
        law with joints leaves its mark somewhere along them: there, between all nodes."""
        nx, nt = self.nodes
        lines = 1 if self.slip in SMOOTH_LAWS else nt - 1
        i = np.tile(np.arange(nx - 1), lines)
        j = (3 * i + np.repeat(np.arange(lines), nx - 1)) % (nt - 1)
        return np.cos(np.pi * (i + 0.5) / (nx - 1)), np.cos(np.pi * (j + 0.5) / (nt - 1))

    def films(
        self, slip_length: float, x: si.FloatArray, y: si.FloatArray
    ) -> tuple[si.FloatArray, float]:
        """The logarithms of the panel's three quantities at points of it, shape (3, points), and
        the relative error of the over-pressure."""
        column, row = divmod(self.number, ROWS)
        low, high = EDGES[row], EDGES[row + 1]
        gap = np.exp(FIRST_COLUMN + column + 0.5 * (x + 1.0))
        excursion = np.sqrt(-np.expm1(-(low + 0.5 * (y + 1.0) * (high - low))))
        # Errors of films on grids of their own look like noise between nodes, which no further node
        # takes away; the bound on a panel is some three times as large.
        share = 1 / 6 if self.slip in SMOOTH_LAWS else 1 / 10
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


def _deviation(
    panel: si.FloatArray, points: tuple[si.FloatArray, si.FloatArray], values: si.FloatArray
) -> float:
    """The largest relative deviation of a panel from logarithms of films at points of it."""
    from numpy.polynomial import chebyshev

    return float(np.max(np.abs(np.expm1(chebyshev.chebval2d(*points, panel) - values))))


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


@lru_cache(maxsize=1)
def _shipped() -> dict[tuple[int, Panel], si.FloatArray]:
    """The panels that come with the package, less those that miss their tolerance in an octave."""
    steps, known = _POWERS.size - 1, {}
    with np.load(SHIPPED) as file:
        for slip, numbers in SHIPPED_PANELS.items():
            rows, bounds = file[f"{slip}_rows"], file[f"{slip}_bounds"]
            for number, row, bound in zip(numbers, rows, bounds, strict=True):
                panel = Panel(slip, default_tolerance(slip), START, number)
                for k, octave in enumerate(SHIPPED_OCTAVES):
                    if bound[k] > panel.tolerance:
                        continue
                    within = row[k * steps : (k + 1) * steps + 1]
                    known[octave, panel] = np.append(within, bound[k])
    return known


_MOST = (41, 38)


@si.checked_numbers
class FilmTable:
    """The film of a plateau at one frequency, width and gas, over mean gap and amplitude.

    `tolerance` is relative on the over-pressure (None: see `default_tolerance`). `error` is the
    largest deviation found between the table and films solved between its nodes, doubled, plus
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
    ) -> None:
        tolerance = default_tolerance(slip) if tolerance is None else tolerance
        slip_law(slip, 1.0)
        self.frequency, self.width, self.gas = frequency, width, gas
        self.slip, self.tolerance = slip, tolerance
        self.length: si.Metre = width * float(
            np.sqrt(24 * np.pi * gas.viscosity * frequency / gas.ambient_pressure)
        )
        self.error: si.Dimensionless | None = None
        self.solved = 0
        self._nodes = START
        self._scale = np.array([self.length, gas.ambient_pressure, float(FIRST_COLUMN)])
        self._lock = threading.Lock()
        self._empty()

    def _empty(self) -> None:
        self._built = np.zeros((COLUMNS, ROWS), dtype=np.int64)
        self._panels = np.zeros((COLUMNS, ROWS, 3, *self._nodes))
        self.error = None

    @property
    def compiled(self) -> CompiledFilms:
        """The table as the compiled code takes it."""
        from squeezefilm.physics.contact.sharing.kernel import CompiledFilms

        return CompiledFilms(self._scale, EDGES, self._built, self._panels)

    @property
    def relative_error(self) -> si.Dimensionless:
        """The bound on the relative error of the over-pressure; 0 where no film was needed."""
        return 0.0 if self.error is None else self.error

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
        """Fill a panel; the bound on its error."""
        nx, nt = self._nodes
        slip_length = float(self.gas.mean_free_path / self.length)
        which = Panel(self.slip, self.tolerance, self._nodes, panel)
        coefficients = which.at(slip_length)
        self.solved += nx * nt + len(which.between()[0])
        self._panels.reshape(-1, 3, nx, nt)[panel] = coefficients[:-1].reshape(3, nx, nt)
        self._built.flat[panel] = 1
        error = float(coefficients[-1])
        self.error = max(self.relative_error, error)
        return error


@si.checked_numbers
def film_table(
    frequency: si.Hertz,
    width: si.Metre,
    gas: Gas,
    slip: str = "first",
    tolerance: float | None = None,
) -> FilmTable:
    """The table of a plateau's film (kept, so that each is made once). See `FilmTable`."""
    return _table(frequency, width, gas, slip, tolerance)


_table = lru_cache(maxsize=256)(FilmTable)


def complete(table: FilmTable, solve: Callable[[CompiledFilms], int]) -> None:
    """Solve by a table until no panel of it lacks; `solve` tells the number of one that does, or
    −1. Raises as `FilmTable.build`."""
    while (lacking := solve(table.compiled)) >= 0:
        table.build(lacking)
