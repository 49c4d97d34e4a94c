"""The solution of a periodic film, and how it is put together from the pressure on two grids."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.errors import ConvergenceError
from squeezefilm.film.periodic.profile import GapProfile, evaluate

_FIELD_TIMES = 64
_HARMONICS = 8


@dataclass(frozen=True)
class Asked:
    """What a film is asked for; `profile` is None where H = 1 + ε cos T."""

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
        """What is solved, in words."""
        n = self.polytropic_exponent
        name = "isothermal" if n == 1.0 else f"polytropic (n = {n:g})"
        law = f"slip {self.slip} at local Kn" if self.knudsen_number > 0.0 else "no slip"
        return f"periodic compressible Reynolds film, {name}, {law}"


@dataclass(frozen=True)
class FilmSolution(Asked):
    """One period of a gas film, with the inputs and the model that made it.

    Pressures are relative to ambient, gaps to the reference gap, T = ωt in radians. `position`
    is X = x/l0 from −1/2 to 1/2 for a strip or a profile, r/R from 0 to 1 for a disc.
    `pressure[i, j]` and `gap[i, j]` are at position i and time j; `mean_pressure[i]` is the mean
    over the period. `force_harmonics[k]` are complex: the area mean of P − 1 is
    Re Σ F_k e^{ikT}. F_1 = −(stiffness_relative + i damping_relative)·excursion, so that the
    film pushes back with stiffness and damping of that many p0·A per unit of H0.
    `over_pressure_error` estimates the absolute error of `over_pressure` = W − 1.
    """

    mean_load: si.Dimensionless
    over_pressure: si.Dimensionless
    over_pressure_error: si.Dimensionless
    stiffness_relative: si.Dimensionless
    damping_relative: si.Dimensionless
    force_harmonics: si.ComplexArray
    position: si.DimensionlessArray
    time: si.DimensionlessArray
    gap: si.DimensionlessArray
    pressure: si.DimensionlessArray
    mean_pressure: si.DimensionlessArray
    iterations: int
    residual: float
    cells: int
    times: int
    status: str
    model: str


@dataclass(frozen=True)
class Found:
    """What a solve came to."""

    over: float
    error: float
    met: bool
    iterations: int
    residual: float
    cells: int
    times: int

    def status(self, asked: Asked) -> str:
        """How well it went."""
        effort = f"{self.cells} cells and {self.times} times in {self.iterations} Newton steps"
        if self.met:
            return f"converged: over-pressure {self.over:.4g} within {self.error:.1g} with {effort}"
        return (
            f"not converged: over-pressure {self.over:.4g} is only known within {self.error:.1g}, "
            f"asked was {asked.tolerance:g} of it, with {effort}"
        )


def assembled(
    asked: Asked,
    found: Found,
    levels: list[tuple[si.FloatArray, si.FloatArray]],
    harmonics: si.ComplexArray,
    x: si.FloatArray,
    shift: float,
    mirrored: bool,
    excursion: float,
) -> FilmSolution:
    """Assemble the result from p on the two finer grids, extrapolated like the load."""
    over, error = found.over, found.error
    if levels:
        T, gap, fine, spectrum = _field(levels, harmonics, found.times, asked.polytropic_exponent)
    else:
        x, T, gap, fine = np.empty(0), np.empty(0), np.empty((0, 0)), np.empty((0, 0))
        spectrum = np.full(_HARMONICS + 1, complex(np.nan, np.nan))
        mirrored = False
    force_harmonics = spectrum[: _HARMONICS + 1] * np.exp(1j * np.arange(_HARMONICS + 1) * shift)
    force_harmonics[0] = over
    if shift:
        fine, gap = (np.roll(rows, -len(T) // 2, axis=1) for rows in (fine, gap))
    if mirrored:
        x = np.concatenate([-x[:0:-1], x])
        fine, gap = (np.concatenate([rows[:0:-1], rows]) for rows in (fine, gap))
    first = spectrum[1] / excursion if excursion > 0.0 else complex(np.nan, np.nan)
    if asked.excursion_ratio == 0.0 and asked.profile is None:
        force_harmonics[:] = 0.0
        fine[:] = 0.0
        gap[:] = 1.0
    solution = FilmSolution(
        mean_load=1.0 + over,
        over_pressure=over,
        over_pressure_error=error,
        stiffness_relative=float(-first.real),
        damping_relative=float(-first.imag),
        force_harmonics=force_harmonics,
        position=x,
        time=T,
        gap=gap,
        pressure=1.0 + fine,
        mean_pressure=1.0 + (fine.mean(axis=1) if levels else x),
        iterations=found.iterations,
        residual=found.residual,
        cells=found.cells,
        times=found.times,
        status=found.status(asked),
        model=asked.equation,
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


def _field(
    levels: list[tuple[si.FloatArray, si.FloatArray]],
    harmonics: si.ComplexArray,
    times: int,
    n: float,
) -> tuple[si.FloatArray, si.FloatArray, si.FloatArray, si.ComplexArray]:
    """Times, gap, P − 1 on the finest grid, and the harmonics of the area mean of P − 1."""
    count = max(_FIELD_TIMES, 2 * times)
    T = 2.0 * np.pi * np.arange(count) / count
    nodes = 2.0 * np.pi * np.arange(times) / times
    gap_nodes, gap = evaluate(harmonics, nodes), evaluate(harmonics, T)
    coarse, share_coarse = levels[0]
    p, share = levels[1]
    powered = gap**n

    def resampled(values: si.FloatArray, every: int) -> si.FloatArray:
        psi = values * gap_nodes[::every] ** n
        spectrum = np.zeros((len(psi), count // 2 + 1), dtype=complex)
        spectrum[:, : times // 2 + 1] = np.fft.rfft(psi, axis=1) * (count / times)
        return np.asarray(np.fft.irfft(spectrum, count, axis=1)) / powered[::every]

    fine, rough = resampled(p, 1), resampled(coarse, 2)
    force = share @ fine
    force += (force - share_coarse @ rough) / 3.0
    spectrum = np.fft.rfft(force) / count
    spectrum[1:] *= 2.0
    correction = (fine[::2] - rough) / 3.0
    index = np.arange(len(fine)) / 2.0
    lower = np.floor(index).astype(int)
    upper = np.minimum(lower + 1, len(correction) - 1)
    fine = fine + 0.5 * (correction[lower] + correction[np.where(index > lower, upper, lower)])
    return T, gap, fine, spectrum
