"""Harmonic response of a plate: amplitude per volt, admittance, power."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Literal

import numpy as np
from scipy.linalg import eigh

from squeezefilm.core import quantities as si
from squeezefilm.core.blas_threads import one_blas_thread
from squeezefilm.core.errors import GeometryError, InputError
from squeezefilm.core.hard_limits import FREQUENCY
from squeezefilm.physics.plate.circuit import DrivenResponse
from squeezefilm.physics.plate.elements.again import SolvedAgain
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.layers import COARSE, NORMAL, Resolution
from squeezefilm.physics.plate.solid.modes import MODEL, check_band
from squeezefilm.physics.plate.solid.reduced import (
    ReducedClass,
    class_slices,
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
    all_classes,
    drive_classes,
    drive_signs,
    told_of,
)

_GRID = (121, 81)
# A mode's relative change of frequency that is taken for none.
_SETTLED = 1e-3


@si.checked_numbers
@dataclass(frozen=True)
class SurfaceLoad:
    """A finger or film on a rectangle of the upper face: mass, damping and stiffness per area."""

    x: si.Metre
    y: si.Metre
    length: si.Metre
    width: si.Metre
    mass: si.KilogramPerSquareMetre = 0.0
    damping: si.PascalSecondPerMetre = 0.0
    stiffness: si.PascalPerMetre = 0.0

    def points(self) -> tuple[si.FloatArray, si.FloatArray, si.FloatArray]:
        """Gauss points along x and y and their weights (m²), shape (x, y)."""
        nodes, weights = np.polynomial.legendre.leggauss(8)
        x = self.x + self.length * (nodes + 1) / 2
        y = self.y + self.width * (nodes + 1) / 2
        return x, y, np.outer(weights, weights) * self.length * self.width / 4


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
    _loads: tuple[SurfaceLoad, ...] = field(repr=False, default=())
    _again: Callable[[], HarmonicResponse] | None = field(repr=False, default=None)
    _bulk: ClassVar[tuple[str, ...]] = ("_parts", "_coordinates", "_potentials")

    @si.checked_numbers
    def displacement(self, x: si.MetreArray, y: si.MetreArray) -> si.ComplexArray:
        """Complex w per volt (m/V) on the grid of `x` × `y` of the upper face, shape (frequencies,
        x, y)."""
        si.require("x", x, si.Unit("m"), axes=1)
        si.require("y", y, si.Unit("m"), axes=1)
        values = surface_values(self._parts, x, y, self.plate.thickness)
        return np.asarray(np.tensordot(self._coordinates, values, 1))

    @si.checked_numbers
    def motion(self, at: int, x: si.MetreArray, y: si.MetreArray) -> si.ComplexArray:
        """Complex w per volt (m/V) as `displacement` has it, at frequency number `at` only, shape
        (x, y)."""
        si.require("at", at, at_least=-self.frequencies.size, at_most=self.frequencies.size - 1)
        si.require("x", x, si.Unit("m"), axes=1)
        si.require("y", y, si.Unit("m"), axes=1)
        values = surface_values(self._parts, x, y, self.plate.thickness)
        return np.asarray(np.tensordot(self._coordinates[at], values, 1))

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
            added = _load_stiffness(self.plate, parts, self._loads, omega) if self._loads else None
            q, potentials, charge = harmonic_solution(parts, omega, added, None, 1.0)
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
        found: list[DrivenMode] = []
        for part in self._parts:
            shorter = _shortened(part)
            squares = eigh(shorter.stiffness, shorter.mass, eigvals_only=True)
            before = np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi)
            found += [
                mode
                for mode in driven_modes(part, band)
                if np.min(np.abs(before / mode.frequency - 1)) < _SETTLED
            ]
        return sorted(found, key=lambda mode: mode.frequency)

    def _face(self) -> si.FloatArray:
        """w of each coordinate on a grid over the upper face, shape (coordinates, points)."""
        x = np.linspace(0, self.plate.length, _GRID[0])
        y = np.linspace(0, self.plate.width, _GRID[1])
        values = surface_values(self._parts, x, y, self.plate.thickness)
        return np.asarray(values.reshape(self._coordinates.shape[1], -1))

    @si.checked_numbers
    def largest(self, at: int) -> si.MetrePerVolt:
        """The largest |w| per volt (m/V) anywhere on the upper face, at frequency number `at`."""
        si.require("at", at, at_least=-self.frequencies.size, at_most=self.frequencies.size - 1)
        return _largest(self._coordinates[at], self._face())

    @functools.cached_property
    def maximum(self) -> si.FloatArray:
        """The largest |w| per volt (m/V) anywhere on the upper face, for every frequency."""
        values = self._face()
        return np.array([_largest(row, values) for row in self._coordinates])

    @si.checked_numbers
    def dissipated_power(self, voltage: si.Volt) -> si.FloatArray:
        """Mean power (W) lost in materials, supports, shunts and loads; equals the input power."""
        omega = 2 * np.pi * self.frequencies
        out = omega / 2 * self._quadratic_form("loss")
        for part, V in zip(self._parts, self._potentials, strict=True):
            for number, resistance, share in part.circuit:
                if np.isfinite(resistance):
                    patches = part.solved.copies / share
                    out += patches * np.abs(V[:, number]) ** 2 / (2 * resistance)
        for load in self._loads:
            x, y, area = load.points()
            w = self.displacement(x, y)
            out += omega**2 / 2 * load.damping * np.sum(np.abs(w) ** 2 * area, axis=(1, 2))
        return out * voltage**2

    @si.checked_numbers
    def stored_energy(self, voltage: si.Volt) -> tuple[si.FloatArray, si.FloatArray]:
        """Mean kinetic and mean potential energy (J; elastic and of supports, less the electric)
        of the plate at a voltage amplitude."""
        kinetic = (2 * np.pi * self.frequencies) ** 2 / 4 * self._quadratic_form("mass")
        return kinetic * voltage**2, self._quadratic_form("stiffness") / 4 * voltage**2

    def _quadratic_form(self, matrix: Literal["mass", "stiffness", "loss"]) -> si.FloatArray:
        """qᴴ A q of the coordinates q per volt and one matrix of all classes, by frequency."""
        out = np.zeros(self.frequencies.size)
        for part, at in zip(self._parts, class_slices(self._parts), strict=True):
            q = self._coordinates[:, at]
            out += np.einsum("fi,ij,fj->f", q.conj(), getattr(part, matrix), q).real
        return out


def _largest(coordinates: si.ComplexArray, face: si.FloatArray) -> float:
    """The largest |w| of complex coordinates of shapes over the face, real arrays multiplied apart:
    the shapes would be copied as complex ones."""
    return float(np.sqrt(np.max((coordinates.real @ face) ** 2 + (coordinates.imag @ face) ** 2)))


@si.checked_numbers
def harmonic_response(
    plate: RectangularPlate,
    frequencies: si.HertzArray,
    *,
    loads: Sequence[SurfaceLoad] = (),
    steps: int | None = None,
    resolution: Resolution = NORMAL,
    extrapolate: bool = True,
    progress: Callable[[str, float], None] | None = None,
    solved: Sequence[RefinedModes] = (),
    again: Callable[[], HarmonicResponse] | None = None,
) -> HarmonicResponse:
    """The response to one volt on the drive over a band of frequencies (Hz, ascending).

    Reduced by a Krylov space about the band's centre, which holds the modes near it and the
    quasi-static answer of all others; `steps` is its length (chosen by the band if None), and
    the truncation error is reported. Losses are structural (constant 1/Q of each material).

    The stiffness is scaled, by a few 1e-4, so that the most strongly driven mode in or near the
    band stands at its frequency extrapolated from two meshes, where `solve_modes` has it (the
    largest amplitude lies a little beside it, by damping and other modes). Without `extrapolate`,
    or on a mesh other than NORMAL and FINE, resonances lie where the mesh has them. `solved` are
    modes in the band as `solve_for_response` has them: their meshes and factors serve again, and
    `again` is then how the same is had without them (see `SolvedAgain`).

    Raises `InputError` for frequencies that are not ascending and positive or a plate without a
    driven electrode, `GeometryError` for a load beside the plate.
    """
    f = np.atleast_1d(np.asarray(frequencies, dtype=float))
    _require_answered(plate, f, loads)
    band = float(f[0]), float(f[-1])
    if steps is None:
        # With the modes about its middle known few are left that the space must find.
        least, wider = (8, 10) if solved else (14, 40)
        steps = min(int(least + wider * (band[1] - band[0]) / band[1]), 60)
    si.require("steps", steps, at_least=1)
    with one_blas_thread():
        parts = _reduced(plate, loads, band, steps, resolution, extrapolate, progress, solved)
        omega = 2 * np.pi * f
        added = _load_stiffness(plate, parts, loads, omega) if loads else None
        q, potentials, charge = harmonic_solution(parts, omega, added, None, 1.0)
        admittance = 1j * omega * charge
        error = _truncation(parts, omega, added, admittance)
    return HarmonicResponse(
        plate,
        f,
        admittance,
        f"reduced to {q.shape[1]} coordinates",
        error,
        MODEL,
        parts,
        q,
        potentials,
        tuple(loads),
        again
        or functools.partial(
            harmonic_response,
            plate,
            f,
            loads=tuple(loads),
            steps=steps,
            resolution=resolution,
            extrapolate=extrapolate,
        ),
    )


def _require_answered(
    plate: RectangularPlate, frequencies: si.HertzArray, loads: Sequence[SurfaceLoad]
) -> None:
    """Refuse frequencies, a drive or a load to which there is no response."""
    si.require("frequencies", frequencies, si.Unit("Hz"), above=0)
    if frequencies.size > 1 and np.any(np.diff(frequencies) <= 0):
        raise InputError("frequencies must ascend", quantity="frequencies")
    if not np.any(drive_signs(plate)):
        raise InputError("no electrode is driven; give at least one patch electrode = 'driven'")
    for load in loads:
        if load.x + load.length > plate.length + 1e-9 or load.y + load.width > plate.width + 1e-9:
            raise GeometryError("a surface load overhangs the plate; move it or make it smaller")


def _reduced(
    plate: RectangularPlate,
    loads: Sequence[SurfaceLoad],
    band: tuple[float, float],
    steps: int,
    resolution: Resolution,
    extrapolate: bool,
    progress: Callable[[str, float], None] | None,
    solved: Sequence[RefinedModes],
) -> list[ReducedClass]:
    """The classes of symmetry that answer, reduced; raises `InputError` where nothing drives."""
    # A load breaks the symmetry of the drive: then every class answers.
    classes = all_classes(plate) if loads else drive_classes(plate)
    pressures = [load.points() for load in loads]
    parts = []
    for number, parity in enumerate(classes):
        if progress is not None:
            progress(f"response, {told_of(parity)}", number / len(classes))
        known = next((piece for piece in solved if piece.found.parity == parity), None)
        if known is None or known.factor is None:
            part = reduced_class(plate, parity, band, steps, pressures, resolution)
        else:
            mesh = COARSE if known.level == UNREFINED else LEVELS[known.level]
            modes = with_coarse_modes(known)
            part = reduced_model(known.solved, known.factor, mesh, steps, pressures, modes)
        if not part.basis.shape[1]:
            raise InputError(
                "the driven ceramics exert no force on the plate, so no resonance answers to "
                "the voltage; give them a charge_coefficient (d31) other than 0",
                quantity="charge_coefficient",
            )
        parts.append(extrapolated_class(part, band, known) if extrapolate else part)
    return parts


def _load_stiffness(
    plate: RectangularPlate,
    parts: list[ReducedClass],
    loads: Sequence[SurfaceLoad],
    omega: si.FloatArray,
) -> si.ComplexArray:
    total = sum(part.basis.shape[1] for part in parts)
    out = np.zeros((omega.size, total, total), dtype=complex)
    for load in loads:
        x, y, area = load.points()
        w = surface_values(parts, x, y, plate.thickness).reshape(total, -1)
        overlap = (w * area.ravel()) @ w.T
        dynamic = load.stiffness + 1j * omega * load.damping - omega**2 * load.mass
        out += dynamic[:, None, None] * overlap
    return out


def _truncation(
    parts: list[ReducedClass],
    omega: si.FloatArray,
    added: si.ComplexArray | None,
    admittance: si.ComplexArray,
) -> float:
    """Change of the admittance when each space loses its last quarter."""
    pick = np.arange(0, omega.size, max(1, omega.size // 12))
    shorter = [_shortened(part) for part in parts]
    kept = np.concatenate(
        [
            np.arange(at.start, at.start + short.basis.shape[1])
            for short, at in zip(shorter, class_slices(parts), strict=True)
        ]
    )
    less = None if added is None else added[np.ix_(pick, kept, kept)]
    _, _, charge = harmonic_solution(shorter, omega[pick], less, None, 1.0)
    change = np.abs(1j * omega[pick] * charge - admittance[pick])
    return float(np.max(change / np.max(np.abs(admittance))))


def _shortened(one: ReducedClass) -> ReducedClass:
    """A class without the last quarter of its space."""
    n = max(1, (3 * one.basis.shape[1]) // 4)
    return dataclasses.replace(
        one,
        basis=one.basis[:, :n],
        mass=one.mass[:n, :n],
        stiffness=one.stiffness[:n, :n],
        loss=one.loss[:n, :n],
        coupling=one.coupling[:n],
    )
