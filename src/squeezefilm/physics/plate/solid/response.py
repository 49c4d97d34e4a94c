"""Harmonic response of a plate: amplitude per volt and admittance."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Annotated, ClassVar

import numpy as np
from scipy.linalg import eigh

from squeezefilm.core import quantities as si
from squeezefilm.core.blas_threads import one_blas_thread
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import FREQUENCY
from squeezefilm.physics.plate.circuit import DrivenResponse
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.layers import COARSE, NORMAL, Resolution
from squeezefilm.physics.plate.solid.modes import MODEL, SolvedAgain, check_band
from squeezefilm.physics.plate.solid.reduced import (
    ReducedClass,
    harmonic_solution,
    reduced_class,
    reduced_model,
    surface_values,
)
from squeezefilm.physics.plate.solid.refined_modes import (
    LEVELS,
    UNREFINED,
    RefinedModes,
    extrapolated_class,
    with_coarse_modes,
)
from squeezefilm.physics.plate.solid.resonances import DrivenMode, Moving, driven_modes
from squeezefilm.physics.plate.solid.symmetry import (
    drive_classes,
    drive_signs,
    told_of,
)

_GRID = (121, 81)
# A mode's relative change of frequency that is taken for none.
_SETTLED = 1e-3


@dataclass(frozen=True, eq=False)
class HarmonicResponse(SolvedAgain, DrivenResponse):
    """The response of a plate to one volt (zero to peak) on its drive, at `frequencies` (Hz).

    `admittance` in siemens, time factor e^{iωt}. `method` says how it was made and
    `truncation_error` the largest relative change of the admittance when the reduced space loses
    its last quarter.
    """

    plate: RectangularPlate
    frequencies: si.HertzArray
    admittance: si.ComplexArray
    method: str
    truncation_error: si.Dimensionless
    model: str
    _parts: list[ReducedClass] = field(repr=False)
    _coordinates: si.ComplexArray = field(repr=False)
    _potentials: list[si.ComplexArray] = field(repr=False)
    _again: Callable[[], HarmonicResponse] | None = field(repr=False, default=None)
    _bulk: ClassVar[tuple[str, ...]] = ("_parts", "_coordinates", "_potentials")

    @si.checked_numbers
    def displacement(self, x: si.MetreArray, y: si.MetreArray) -> si.ComplexArray:
        """Complex w per volt (m/V) on the grid of `x` × `y` of the upper face, shape (frequencies,
        x, y)."""
        return np.asarray(np.tensordot(self._coordinates, self._face(x, y), 1))

    @si.checked_numbers
    def motion(self, at: int, x: si.MetreArray, y: si.MetreArray) -> si.ComplexArray:
        """Complex w per volt (m/V) as `displacement` has it, at frequency number `at` only, shape
        (x, y)."""
        si.require("at", at, at_least=-self.frequencies.size, at_most=self.frequencies.size - 1)
        return np.asarray(np.tensordot(self._coordinates[at], self._face(x, y), 1))

    @si.checked_numbers
    def amplitude_at(self, x: si.Metre, y: si.Metre) -> si.FloatArray:
        """|w| per volt (m/V) at a point, for every frequency."""
        return np.abs(self.displacement(np.array([x]), np.array([y]))[:, 0, 0])

    @si.checked_numbers
    def at(self, frequencies: si.HertzArray) -> HarmonicResponse:
        """The same response at other frequencies (Hz, ascending) within its band: the plate is not
        solved again. Raises `InputError` for frequencies outside it."""
        first, last = float(self.frequencies[0]), float(self.frequencies[-1])
        f = np.asarray(frequencies, dtype=float)
        si.require("frequencies", f, si.Unit("Hz"), at_least=first, at_most=last, axes=1)
        omega, parts = 2 * np.pi * f, self._parts
        with one_blas_thread():
            q, potentials, charge = harmonic_solution(parts, omega)
        return dataclasses.replace(
            self,
            frequencies=f,
            admittance=1j * omega * charge,
            _coordinates=q,
            _potentials=potentials,
            _again=functools.partial(self.at, f),
        )

    @si.checked_numbers
    def beside(self, frequency: si.Hertz) -> list[Moving]:
        """The driven modes that this response is made of from half a frequency (Hz) to twice it,
        but for the one that is nearest to it."""
        si.require("frequency", frequency, si.Unit("Hz"), above=0, at_most=FREQUENCY.most / 2)
        around = 0.5 * frequency, 2 * frequency
        modes = [mode.moving for part in self._parts for mode in driven_modes(part, around)]
        nearest = min(modes, key=lambda mode: abs(mode.frequency - frequency), default=None)
        return [mode for mode in modes if mode is not nearest]

    @si.checked_numbers
    def settled_modes(self, band: tuple[si.Hertz, si.Hertz]) -> list[DrivenMode]:
        """The driven modes in a band (Hz) that this response is made of, ascending. Those whose
        frequency changes by more than 1e-3 when the space loses its last quarter are left out:
        each of them stands for several modes that the space does not tell apart.

        Raises `InputError` for a band that is none.
        """
        check_band(band)
        modes: list[DrivenMode] = []
        for part in self._parts:
            shorter = _shortened(part)
            squares = eigh(shorter.stiffness, shorter.mass, eigvals_only=True)
            before = np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi)
            modes += [
                mode
                for mode in driven_modes(part, band)
                if np.min(np.abs(before / mode.frequency - 1)) < _SETTLED
            ]
        return sorted(modes, key=lambda mode: mode.frequency)

    def _face(self, x: si.MetreArray, y: si.MetreArray) -> si.FloatArray:
        """w of each coordinate on a grid over the upper face, shape (coordinates, x, y)."""
        si.require("x", x, si.Unit("m"), axes=1)
        si.require("y", y, si.Unit("m"), axes=1)
        return surface_values(self._parts, x, y, self.plate.thickness)

    def _whole_face(self) -> si.FloatArray:
        """w of each coordinate all over the upper face, shape (coordinates, points)."""
        x = np.linspace(0, self.plate.length, _GRID[0])
        y = np.linspace(0, self.plate.width, _GRID[1])
        return self._face(x, y).reshape(self._coordinates.shape[1], -1)

    @si.checked_numbers
    def largest(self, at: int) -> si.MetrePerVolt:
        """The largest |w| per volt (m/V) anywhere on the upper face, at frequency number `at`."""
        si.require("at", at, at_least=-self.frequencies.size, at_most=self.frequencies.size - 1)
        return _largest(self._coordinates[at], self._whole_face())

    @functools.cached_property
    def maximum(self) -> si.FloatArray:
        """The largest |w| per volt (m/V) anywhere on the upper face, for every frequency."""
        values = self._whole_face()
        return np.array([_largest(row, values) for row in self._coordinates])


def _largest(coordinates: si.ComplexArray, face: si.FloatArray) -> float:
    """The largest |w| of complex coordinates of shapes over the face, real arrays multiplied apart:
    the shapes would be copied as complex ones."""
    return float(np.sqrt(np.max((coordinates.real @ face) ** 2 + (coordinates.imag @ face) ** 2)))


@si.checked_numbers
def harmonic_response(
    plate: RectangularPlate,
    frequencies: Annotated[si.HertzArray, si.Above(0.0), si.Rising()],
    *,
    steps: Annotated[int, si.AtLeast(1)] | None = None,
    resolution: Resolution = NORMAL,
    extrapolate: bool = True,
    progress: Callable[[str, float], None] | None = None,
    solved: Sequence[RefinedModes] = (),
) -> HarmonicResponse:
    """The response to one volt on the drive over a band of frequencies (Hz, ascending).

    Reduced by a Krylov space about the band's centre, which holds the modes near it and the
    quasi-static answer of all others; `steps` is its length (chosen by the band if None), and
    the truncation error is reported. Losses are structural (constant 1/Q of each material).

    The stiffness is scaled, by a few 1e-4, so that the most strongly driven mode in or near the
    band stands at its frequency extrapolated from two meshes, where `solve_modes` has it (the
    largest amplitude lies a little beside it, by damping and other modes). Without `extrapolate`,
    or on a mesh other than NORMAL and FINE, resonances lie where the mesh has them. `solved` are
    modes in the band as `solved_classes` has them: their meshes and factors serve again.

    Raises `InputError` for frequencies that are not ascending and positive or a plate without a
    driven electrode.
    """
    if not np.any(drive_signs(plate)):
        raise InputError("no electrode is driven; give at least one patch electrode = 'driven'")
    band = float(frequencies[0]), float(frequencies[-1])
    if steps is None:
        # With the modes about its middle known few are left that the space must find.
        least, wider = (8, 10) if solved else (14, 40)
        steps = min(int(least + wider * (band[1] - band[0]) / band[1]), 60)
    with one_blas_thread():
        parts = _reduced(plate, band, steps, resolution, extrapolate, progress, solved)
        omega = 2 * np.pi * frequencies
        q, potentials, charge = harmonic_solution(parts, omega)
        admittance = 1j * omega * charge
        error = _truncation(parts, omega, admittance)
    again = functools.partial(
        harmonic_response,
        plate,
        frequencies,
        steps=steps,
        resolution=resolution,
        extrapolate=extrapolate,
    )
    return HarmonicResponse(
        plate,
        frequencies,
        admittance,
        f"reduced to {q.shape[1]} coordinates",
        error,
        MODEL,
        parts,
        q,
        potentials,
        None if solved else again,
    )


def _reduced(
    plate: RectangularPlate,
    band: tuple[float, float],
    steps: int,
    resolution: Resolution,
    extrapolate: bool,
    progress: Callable[[str, float], None] | None,
    solved: Sequence[RefinedModes],
) -> list[ReducedClass]:
    """The classes of symmetry that answer, reduced; raises `InputError` where nothing drives."""
    classes, parts = drive_classes(plate), []
    for number, parity in enumerate(classes):
        if progress is not None:
            progress(f"response, {told_of(parity)}", number / len(classes))
        known = next((piece for piece in solved if piece.solved.parity == parity), None)
        if known is None or known.factor is None:
            part = reduced_class(plate, parity, band, steps, [], resolution)
        else:
            mesh = COARSE if known.level == UNREFINED else LEVELS[known.level]
            modes = with_coarse_modes(known)
            part = reduced_model(known.solved, known.factor, mesh, steps, [], modes)
        if not part.basis.shape[1]:
            raise InputError(
                "the driven ceramics exert no force on the plate, so no resonance answers to "
                "the voltage; give them a charge_coefficient (d31) other than 0",
                quantity="charge_coefficient",
            )
        parts.append(extrapolated_class(part, band, known) if extrapolate else part)
    return parts


def _truncation(
    parts: list[ReducedClass], omega: si.FloatArray, admittance: si.ComplexArray
) -> float:
    """Change of the admittance when each space loses its last quarter."""
    pick = np.arange(0, omega.size, max(1, omega.size // 12))
    _, _, charge = harmonic_solution([_shortened(part) for part in parts], omega[pick])
    change = np.abs(1j * omega[pick] * charge - admittance[pick])
    return float(np.max(change / np.max(np.abs(admittance))))


def _shortened(reduced: ReducedClass) -> ReducedClass:
    """A class without the last quarter of its space."""
    n = max(1, (3 * reduced.basis.shape[1]) // 4)
    return dataclasses.replace(
        reduced,
        basis=reduced.basis[:, :n],
        mass=reduced.mass[:n, :n],
        stiffness=reduced.stiffness[:n, :n],
        loss=reduced.loss[:n, :n],
        coupling=reduced.coupling[:n],
    )
