"""The over-pressure of a plateau's film as a table of solved films, fast enough for load balances.

A plateau of width w between ambient grooves is a strip film under H = 1 + ε cos T. With the length
ℓ = w √(12 η ω/p0) its squeeze number is (ℓ/u)² and its Knudsen number (Λ/ℓ)(ℓ/u), Λ the mean free
path: at given frequency, width and gas it depends on the mean gap u and on ε = a/u alone. The
table holds ln((W − 1)/ε²), ln of stiffness and of damping over ln(u/ℓ) and −ln(1 − ε²), as
Chebyshev interpolants in panels that are made when first needed (`film_panels`). Nothing is fitted:
every node is a solved film, and each panel is checked against films solved between its nodes.
"""

from __future__ import annotations

import math
import threading
from functools import lru_cache
from typing import TYPE_CHECKING, Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError
from squeezefilm.core.materials import Gas
from squeezefilm.physics.contact.sharing.film_panels import (
    COLUMNS,
    DEEPEST_EXCURSION,
    EDGES,
    FIRST_COLUMN,
    ROWS,
    START,
    Panel,
    default_tolerance,
)
from squeezefilm.physics.film.gas import slip_law

if TYPE_CHECKING:
    from squeezefilm.physics.contact.sharing.kernel import CompiledFilms

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

    @property
    def least_gap(self) -> si.Metre:
        """The least mean gap of the table (m)."""
        return math.exp(FIRST_COLUMN) * self.length

    @property
    def largest_gap(self) -> si.Metre:
        """The mean gap (m) that is the table's end."""
        return math.exp(FIRST_COLUMN + COLUMNS) * self.length

    @si.checked_numbers
    def over_pressure(self, mean_gap: si.MetreLike, amplitude: si.MetreLike) -> si.PascalLike:
        """⟨p_gas⟩ − p0 (Pa), mean over plateau and period; broadcasts.

        Raises `InputError` for an amplitude above `DEEPEST_EXCURSION` of the gap or a gap off
        the table.
        """
        from squeezefilm.physics.contact.sharing.kernel import film_value

        u, a = np.broadcast_arrays(np.asarray(mean_gap, float), np.asarray(amplitude, float))
        si.require("mean_gap", u, si.Unit("m"), above=0)
        si.require("amplitude", a, si.Unit("m"), at_least=0)
        si.require("amplitude / mean_gap", a / u, at_most=DEEPEST_EXCURSION)
        least, most = self.least_gap, self.largest_gap
        si.require("mean_gap", u, si.Unit("m"), at_least=least, below=most)
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
