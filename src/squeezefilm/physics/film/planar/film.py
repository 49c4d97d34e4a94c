"""The periodic film in the plane: rectangle, disc, ellipse, with waves, ridges, open grooves.

Solves ∇·(H³ φ P^{1/n} ∇P) = σ ∂(P^{1/n}H)/∂T with P = 1 on the boundary, periodic in T, by
harmonic balance on boundary-fitted grids. The over-pressure is extrapolated from a ladder of
grids (second order, Richardson) and corrected for the number of harmonics on the coarsest; both
give the error estimate. P = p/p0, H = h/H0, lengths over the reference length l0.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import announce
from squeezefilm.core.errors import ConvergenceError, InputError
from squeezefilm.physics.film.gas import ISOTHERMAL, FilmGas, require_film
from squeezefilm.physics.film.periodic.solution import SolvedFilm
from squeezefilm.physics.film.planar.balance import Film, row_block
from squeezefilm.physics.film.planar.grid import PlanarGap
from squeezefilm.physics.film.planar.ladder import Climb, Ladder, PlanarShape, climb_to


@dataclass(frozen=True)
class FilmPlanar(SolvedFilm):
    """The periodic state of a film in the plane.

    `force_harmonics` (8,) begin with k = 1. `mean_pressure` is
    the period's mean at the nodes `X`, `Y` of the finest grid, with their `area`, all (nodes,) =
    rows × columns, of the quarter X ≥ 0, Y ≥ 0 of a symmetric film. `residual` is the last relative
    change of the gas.
    """

    X: si.DimensionlessArray
    Y: si.DimensionlessArray
    area: si.DimensionlessArray
    mean_pressure: si.DimensionlessArray
    rows: int
    columns: int
    time_points: int
    shape: PlanarShape
    aspect_ratio: si.Dimensionless
    gap: PlanarGap
    squeeze_number: si.Dimensionless
    polytropic_exponent: si.Dimensionless
    knudsen_number: si.Dimensionless
    slip: str
    tolerance: si.Dimensionless


@si.checked_numbers
def solve_planar(
    shape: PlanarShape,
    gap: PlanarGap,
    squeeze_number: si.Dimensionless,
    *,
    aspect_ratio: Annotated[si.Dimensionless, si.Above(0.0)] = 1.0,
    gas: FilmGas = ISOTHERMAL,
    tolerance: Annotated[si.Dimensionless, si.AtLeast(1e-5), si.AtMost(0.5)] = 5e-3,
) -> FilmPlanar:
    """The periodic film under a gap, to `tolerance` of W − 1.

    `shape`: "rectangle" (X ∈ [−½, ½], Y ∈ [−aspect/2, aspect/2]), "disc" (R ≤ 1) or "ellipse"
    (X² + (Y/aspect)² ≤ 1); `squeeze_number` on the length that is 1 there.

    Raises `InputError` for values out of range, `GeometryError` where the gap closes,
    `ConvergenceError` (with the best state had) where Newton's method does not converge or the
    tolerance would take more memory than 2 GB. Holds for isothermal (1) to adiabatic (1.4)
    viscous flow; slip by the local Knudsen number Kn/(PH). The tolerance is on the over-pressure,
    down to 1e-5 of it, and on every harmonic of the force, relative to the largest of them.
    Sources: Gross (1962); Blech, 10.1115/1.3254692 for the linear limit.
    """
    require_film(squeeze_number, gas.polytropic_exponent, gas.knudsen_number)
    if shape == "disc" and aspect_ratio != 1.0:
        raise InputError(f"a disc has aspect_ratio 1, not {aspect_ratio}; ask for an ellipse")
    announce(row_block, "film solver in the plane", 3)
    film = Film(gap, float(squeeze_number), gas.compiled())
    ladder = Ladder(shape, float(aspect_ratio), film)
    climb = climb_to(ladder, float(tolerance))
    result = _assembled(ladder, climb, gas, tolerance)
    if not climb.reached:
        raise ConvergenceError(
            f"the film in the plane was {climb.status}",
            partial=result,
            residual=climb.fine.residual,
            iterations=climb.iterations,
        )
    return result


def _assembled(ladder: Ladder, climb: Climb, gas: FilmGas, tolerance: float) -> FilmPlanar:
    """The result, from where a climb of the ladder ended."""
    best, fine = climb.best, climb.fine
    gap = ladder.film.gap
    first = best.amplitudes[1] / gap.excursion_ratio
    return FilmPlanar(
        mean_load=1.0 + best.over_pressure,
        over_pressure=best.over_pressure,
        over_pressure_error=float(best.errors[0]),
        stiffness_relative=-float(first.real),
        damping_relative=-float(first.imag),
        force_error=float(best.errors[1]) / gap.excursion_ratio,
        force_harmonics=best.amplitudes[1:],
        force_harmonics_error=best.errors[1:],
        X=fine.grid.X,
        Y=fine.grid.Y,
        area=fine.grid.area,
        mean_pressure=fine.mean_pressure,
        rows=fine.grid.rows,
        columns=fine.grid.columns,
        time_points=fine.gas.shape[1],
        iterations=climb.iterations,
        residual=fine.residual,
        status=climb.status,
        shape=ladder.shape,
        aspect_ratio=ladder.aspect,
        gap=gap,
        squeeze_number=ladder.film.squeeze_number,
        polytropic_exponent=gas.polytropic_exponent,
        knudsen_number=gas.knudsen_number,
        slip=gas.slip,
        tolerance=tolerance,
    )
