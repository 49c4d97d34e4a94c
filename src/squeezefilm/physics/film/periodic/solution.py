"""The solution of a periodic film, and how it is put together from the pressure on two grids."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError
from squeezefilm.physics.film.periodic.profile import GapProfile, evaluate, interpolant

_FIELD_TIMES = 64
HARMONICS = 8
"""Number of harmonics of the force beyond its mean that are given back."""


@dataclass(frozen=True)
class FilmQuestion:
    """Question about a film; `profile` is None where H = 1 + ε cos T."""

    shape: str
    squeeze_number: si.Dimensionless
    excursion_ratio: si.Dimensionless
    polytropic_exponent: si.Dimensionless
    knudsen_number: si.Dimensionless
    slip: str
    tolerance: float
    profile: GapProfile | None

    @property
    def equation(self) -> str:
        """Words for the equation that is solved."""
        n = self.polytropic_exponent
        name = "isothermal" if n == 1.0 else f"polytropic (n = {n:g})"
        law = f"slip {self.slip} at local Kn" if self.knudsen_number > 0.0 else "no slip"
        return f"periodic compressible Reynolds film, {name}, {law}"


@dataclass(frozen=True, eq=False)
class SolvedFilm:
    """The load of a film and the harmonics of its force over a period, with estimated absolute
    errors.

    `mean_load` W is over p0 A, as the force is; `over_pressure` is W − 1. The area mean of P − 1 is
    Re Σ F_k e^{ikT}: `force_harmonics` are the complex F_k, `force_harmonics_error` their errors
    |ΔF_k|. F_1 = −(stiffness_relative + i damping_relative)·excursion, so that the film pushes back
    with stiffness and damping of that many p0·A per unit of H0; `force_error` is that of stiffness
    + i damping, and so of either. `residual` is what Newton's method leaves, relative.
    """

    mean_load: si.Dimensionless
    over_pressure: si.Dimensionless
    over_pressure_error: si.Dimensionless
    stiffness_relative: si.Dimensionless
    damping_relative: si.Dimensionless
    force_error: si.Dimensionless
    force_harmonics: si.ComplexArray
    force_harmonics_error: si.DimensionlessArray
    iterations: int
    residual: si.Dimensionless
    status: str


@dataclass(frozen=True)
class FilmSolution(SolvedFilm, FilmQuestion):
    """A period of a gas film, with the inputs and the model that made it.

    Pressures are relative to ambient, gaps to the reference gap, T = ωt in radians. `position`
    is X = x/l0 from −1/2 to 1/2 for a strip or a profile, r/R from 0 to 1 for a disc.
    `pressure[i, j]` and `gap[i, j]` are at position i and time j; `mean_pressure[i]` is the mean
    over the period. `force_harmonics` (9,) begin with that of the mean, k = 0. The tolerance holds
    for the mean relative to itself, and for every harmonic k > 0 relative to the largest of them,
    as a rule the first: |ΔF_k| ≤ tolerance·|F_1|.
    """

    position: si.DimensionlessArray
    time: si.DimensionlessArray
    gap: si.DimensionlessArray
    pressure: si.DimensionlessArray
    mean_pressure: si.DimensionlessArray
    cells: int
    times: int
    model: str


@dataclass(frozen=True)
class Found:
    """Result of a solve; the force's harmonics and their errors, both (9,), are NaN where the load
    alone was asked for. `force` is stiffness + i damping, and its error, where a closed form gave
    it."""

    over: float
    error: float
    met: bool
    iterations: int
    residual: float
    cells: int
    times: int
    harmonics: si.ComplexArray
    harmonics_error: si.FloatArray
    force: tuple[complex, float] | None = None

    @property
    def closed(self) -> bool:
        """True where it is the closed form of a small vibration."""
        return self.force is not None

    @property
    def _known(self) -> str:
        largest = float(np.abs(self.harmonics[1:]).max())
        known = f"within {self.error:.1g}"
        if largest > 0.0:
            relative = self.harmonics_error[1:].max() / largest
            known += f", the force's harmonics within {relative:.1g} of the largest"
        return known

    def later(self) -> Found:
        """The same film half a period later, which is that of −ε."""
        return replace(self, harmonics=self.harmonics * (-1.0) ** np.arange(HARMONICS + 1))

    def status(self, asked: FilmQuestion) -> str:
        """Words for how well it went."""
        effort = f"{self.cells} cells and {self.times} times in {self.iterations} Newton steps"
        if self.closed:
            effort = "the closed form of a small vibration"
        if self.met:
            return f"converged: over-pressure {self.over:.4g} {self._known} with {effort}"
        return (
            f"not converged: over-pressure {self.over:.4g} is only known {self._known}, "
            f"asked was {asked.tolerance:g} of it, with {effort}"
        )


class Field(NamedTuple):
    """Places X, times T, and the gap and P − 1 there, both (places, times)."""

    position: si.FloatArray
    time: si.FloatArray
    gap: si.FloatArray
    over: si.FloatArray

    def later(self) -> Field:
        """Field half a period later."""
        turned = (np.roll(rows, -len(self.time) // 2, axis=1) for rows in (self.gap, self.over))
        return Field(self.position, self.time, *turned)


NO_FIELD = Field(np.empty(0), np.empty(0), np.empty((0, 0)), np.empty((0, 0)))
"""Empty field where the load alone is asked for."""


def assembled(asked: FilmQuestion, found: Found, field: Field) -> FilmSolution:
    """Assemble the result. Raises `ConvergenceError`, with it, where the tolerance was not met."""
    over, harmonics, excursion = found.over, found.harmonics.copy(), asked.excursion_ratio
    harmonics[0] = over
    first, first_error = complex(np.nan, np.nan), np.nan
    if found.force is not None:
        first, first_error = found.force
    elif excursion != 0.0:
        first = -harmonics[1] / excursion
        first_error = float(found.harmonics_error[1]) / abs(excursion)
    solution = FilmSolution(
        mean_load=1.0 + over,
        over_pressure=over,
        over_pressure_error=found.error,
        stiffness_relative=float(first.real),
        damping_relative=float(first.imag),
        force_error=first_error,
        force_harmonics=harmonics,
        force_harmonics_error=found.harmonics_error,
        position=field.position,
        time=field.time,
        gap=field.gap,
        pressure=1.0 + field.over,
        mean_pressure=1.0 + (field.over.mean(axis=1) if len(field.time) else field.position),
        iterations=found.iterations,
        residual=found.residual,
        cells=found.cells,
        times=found.times,
        status=found.status(asked),
        model=asked.equation + (", closed form of small vibration" if found.closed else ""),
        **vars(asked),
    )
    if not found.met:
        raise ConvergenceError(
            f"the film with squeeze_number {asked.squeeze_number:.4g} and excursion_ratio "
            f"{asked.excursion_ratio:.4g} did not converge: {solution.status}. Ask a larger "
            "tolerance",
            partial=solution,
            residual=found.residual,
            iterations=found.iterations,
        )
    return solution


def extrapolated_field(
    levels: Sequence[tuple[si.FloatArray, si.FloatArray]],
    x: si.FloatArray,
    harmonics: si.ComplexArray,
    n: float,
    *,
    mirrored: bool,
) -> Field:
    """The field on the finest of the levels (P − 1 and the nodes' shares), extrapolated from the
    last two like the load; `mirrored` from half a film to the whole."""
    (coarse, _), (p, _) = levels[-2:]
    times = p.shape[1]
    count = max(_FIELD_TIMES, 2 * times)
    T = 2.0 * np.pi * np.arange(count) / count
    nodes = 2.0 * np.pi * np.arange(times) / times
    gap_nodes, gap = evaluate(harmonics, nodes), evaluate(harmonics, T)
    powered = gap**n

    def resampled(values: si.FloatArray, every: int) -> si.FloatArray:
        psi = values * gap_nodes[::every] ** n
        return np.asarray(psi @ interpolant(times, count)) / powered[::every]

    fine, rough = resampled(p, 1), resampled(coarse, 2)
    correction = (fine[::2] - rough) / 3.0
    index = np.arange(len(fine)) / 2.0
    lower = np.floor(index).astype(int)
    upper = np.minimum(lower + 1, len(correction) - 1)
    fine = fine + 0.5 * (correction[lower] + correction[np.where(index > lower, upper, lower)])
    if mirrored:
        x = np.concatenate([-x[:0:-1], x])
        fine, gap = (np.concatenate([rows[:0:-1], rows]) for rows in (fine, gap))
    return Field(x, T, gap, fine)
