"""Modes of discs and annuli, and what one channel of their ceramic makes of a volt.

Three-dimensional elasticity and piezoelectricity; the angle is solved by Fourier harmonics, the
(r, z) half section by high-order elements. A mode B(n, m) bends with n nodal circles and m nodal
diameters.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.plate.elements.box_model import require_half_wave
from squeezefilm.physics.plate.ring.elements import (
    HarmonicSystem,
    harmonic_system,
    nearest_modes,
    ring_mesh,
    shift_near,
    shifted_inverse,
)
from squeezefilm.physics.plate.ring.section import AnnularSection, SectorDrive

DEFAULT_DEGREE = 5


@dataclass(frozen=True, eq=False)
class AnnularMode:
    """A mode of a free ring or disc.

    `frequency_error` estimates the discretisation error, which is towards too high. The shape is
    u_r = U cos mθ, u_θ = V sin mθ, u_z = W cos mθ: `displacement` (nodes, 3) holds U, V, W at
    `node_radius` and `node_height`, scaled so that the largest |W| on the surface is 1;
    `surface_shape` is W at `surface_radius`. `modal_mass` belongs to that scale.
    `modal_force_all_round` is the force of one volt for the polarity cos mθ ↦ 1, per radian of
    ∫ s cos mθ dθ. `axial_share` is the share of the kinetic energy in u_z.
    """

    harmonic: int
    label: str
    frequency: si.Hertz
    frequency_error: si.Hertz
    quality_factor: si.Dimensionless
    modal_mass: si.Kilogram
    modal_force_all_round: si.NewtonPerVolt
    half_wavelength: si.Metre | None
    axial_share: si.Dimensionless
    node_radius: si.MetreArray
    node_height: si.MetreArray
    displacement: si.DimensionlessArray
    surface_radius: si.MetreArray
    surface_shape: si.DimensionlessArray
    model: str = "annular_3d"

    @property
    def is_rigid(self) -> bool:
        """True where the body moves without deforming."""
        return self.label == "rigid"

    def modal_force(self, drive: SectorDrive) -> si.NewtonPerVolt:
        """The force of one volt on the mode turned to where `drive` moves it most (N/V)."""
        return abs(self.modal_force_all_round * drive.coefficient(self.harmonic))

    def amplitude_per_volt(self, drive: SectorDrive) -> si.MetrePerVolt:
        """Zero-to-peak u_z at the surface's highest antinode, per volt at resonance (m/V).

        Q F / (ω² M): exact for structural damping 1/Q of one mode. Raises `InputError` for a
        rigid-body motion, which has no resonance.
        """
        if self.is_rigid:
            raise InputError("a rigid-body motion has no resonance; choose an elastic mode")
        stiffness = (2 * math.pi * self.frequency) ** 2 * self.modal_mass
        return self.quality_factor * self.modal_force(drive) / stiffness

    @si.checked_numbers
    def coupling_coefficient(
        self, drive: SectorDrive, capacitance: Annotated[si.Farad, si.Above(0.0)]
    ) -> si.Dimensionless:
        """Effective coupling k of the mode on `drive`: k² = F²/(F² + ω² M C), with C clamped."""
        stiffness = (2 * math.pi * self.frequency) ** 2 * self.modal_mass
        force = self.modal_force(drive)
        return force / math.sqrt(force**2 + stiffness * capacitance)


@si.checked_numbers
def annular_modes(
    section: AnnularSection,
    harmonic: Annotated[int, si.AtLeast(0)],
    *,
    near: Annotated[si.Hertz, si.AtLeast(0.0)] = 0.0,
    count: Annotated[int, si.AtLeast(1)] = 4,
    degree: Annotated[int, si.AtLeast(3), si.AtMost(12)] = DEFAULT_DEGREE,
    quality_factor: Annotated[si.Dimensionless, si.Above(0.5)] | None = None,
) -> tuple[AnnularMode, ...]:
    """The `count` modes of one Fourier harmonic nearest to a frequency, in rising order.

    Electrodes are shorted. `quality_factor` is that of the assembly; without it each mode's Q
    follows from the layers' loss factors and strain energies. The error estimate compares with one
    degree less and presumes the slowest convergence that the corners allow, 1/degree².
    Range: linear, perfectly bonded, ceramics all round (see `harmonic_system` for sectors).
    Raises `InputError` for a harmonic or degree that cannot be, or if no Q can be found;
    `OutOfRangeError` for a frequency of waves across a layer; `ConvergenceError` if the eigenvalues
    do not converge.
    """
    require_half_wave(near, section.shear_times, "near =")
    mesh = ring_mesh(section)
    fine = harmonic_system(section, harmonic, degree, mesh)
    coarse = harmonic_system(section, harmonic, degree - 1, mesh)
    squares, vectors = nearest_modes(fine, near, count)
    # A mode at the rim of the list may be another one at the lower degree: ask for two more.
    rough, _ = nearest_modes(coarse, near, count + 2)
    growth = 1 / ((degree / (degree - 1)) ** 2 - 1)
    modes = []
    for square, vector in zip(squares, vectors.T, strict=True):
        nearest = rough[np.argmin(np.abs(rough - square))]
        mode = _mode(section, fine, float(square), vector, quality_factor)
        error = 0.0
        if not mode.is_rigid:
            error = growth * abs(math.sqrt(max(nearest, 0.0)) / (2 * math.pi) - mode.frequency)
        modes.append(replace(mode, frequency_error=error))
    return tuple(modes)


@si.checked_numbers
def bending_mode(
    section: AnnularSection,
    diameters: int,
    circles: int = 0,
    *,
    degree: int = DEFAULT_DEGREE,
    quality_factor: si.Dimensionless | None = None,
) -> AnnularMode:
    """The mode B(`circles`, `diameters`): the lowest of that label that moves the surface.

    A thin web has modes of its own in which the surface hardly moves; they are passed over (modal
    mass above the body's mass, or in-plane motion). Arguments as in `annular_modes`.
    Raises `InputError` if there is none among the lowest modes.
    """
    label = f"B({circles},{diameters})"
    modes = annular_modes(
        section, diameters, count=6 + 2 * circles, degree=degree, quality_factor=quality_factor
    )
    return _labelled(section, modes, label)


@si.checked_numbers
def bending_frequency(
    section: AnnularSection,
    diameters: Annotated[int, si.AtLeast(0)],
    *,
    degree: Annotated[int, si.AtLeast(3), si.AtMost(12)] = DEFAULT_DEGREE,
) -> si.Hertz:
    """The frequency of B(0, `diameters`) (Hz), as `bending_mode` has it, without an estimate of its
    error: at half the cost. Raises what `bending_mode` raises."""
    system = harmonic_system(section, diameters, degree)
    squares, vectors = nearest_modes(system, 0.0, 6)
    modes = [
        _mode(section, system, float(square), vector, 1.0)
        for square, vector in zip(squares, vectors.T, strict=True)
    ]
    return _labelled(section, modes, f"B(0,{diameters})").frequency


def _labelled(section: AnnularSection, modes: Sequence[AnnularMode], label: str) -> AnnularMode:
    """The lowest of some modes with a label that moves the surface."""
    for mode in modes:
        if mode.label == label and mode.modal_mass <= section.mass:
            return mode
    raise InputError(
        f"no mode {label} among the lowest {len(modes)} with {modes[0].harmonic} nodal diameters "
        f"({', '.join(dict.fromkeys(mode.label for mode in modes))}); ask annular_modes near its "
        "frequency"
    )


def clamped_capacitance(section: AnnularSection, drive: SectorDrive) -> si.Farad:
    """The capacitance of the driven sectors with the ceramic held (F): ε33S A/h, no fringes.

    Raises `InputError` if no layer is piezoelectric.
    """
    total = 0.0
    for layer in section.layers:
        if layer.solid.permittivity is not None and layer.solid.piezoelectric:
            area = (layer.outer_radius**2 - layer.inner_radius**2) / 2
            total += layer.solid.permittivity[2, 2] * area / layer.thickness
    if total == 0:
        raise InputError("no layer is piezoelectric; add a ceramic to have an admittance")
    return float(total * drive.angle)


@si.checked_numbers
def annular_admittance(
    section: AnnularSection,
    drive: SectorDrive,
    frequency: Annotated[si.HertzArray, si.Above(0.0)],
    *,
    harmonics: Sequence[int],
    quality_factor: si.Dimensionless | None = None,
    modes: int = 6,
    degree: int = DEFAULT_DEGREE,
) -> si.ComplexArray:
    """The admittance of one channel (A/V), shape of `frequency`, by modes and their remainder.

    Each harmonic in `harmonics` enters with its `modes` modes nearest to the band and a static
    remainder; harmonics left out take their (small, capacitive) share away. Near a resonance its
    own harmonic suffices; a channel of a few sectors also drives the harmonics beside it.
    Damping is structural; the ceramic's dielectric loss is left out.
    Raises `InputError` for an empty list of harmonics or frequencies that are not positive,
    `OutOfRangeError` for a frequency of waves across a layer.
    """
    if not len(harmonics):
        raise InputError("harmonics is empty; name at least the one of the mode wanted")
    require_half_wave(float(frequency.max()), section.shear_times, "an admittance at")
    omega = 2 * np.pi * frequency
    charge = np.full(frequency.shape, clamped_capacitance(section, drive), dtype=complex)
    middle = float(frequency.mean())
    mesh = ring_mesh(section)
    for m in harmonics:
        system = harmonic_system(section, m, degree, mesh)
        squares, vectors = nearest_modes(system, middle, modes)
        weight = abs(drive.coefficient(m)) ** 2
        # What the modes left out add hardly depends on frequency: take it in the middle, from a
        # direct solve, at a point moved off the resonances by the shift.
        shift = shift_near(system, middle)
        inverse = shifted_inverse(system, shift)
        static = float(system.force @ inverse(system.force))
        for square, vector in zip(squares, vectors.T, strict=True):
            force2 = float(vector @ system.force) ** 2  # vectors have unit modal mass
            static -= force2 / (square - shift)
            mode = _mode(section, system, float(square), vector, quality_factor)
            loss = 0.0 if mode.is_rigid else 1 / mode.quality_factor
            charge += weight * force2 / (square * (1 + 1j * loss) - omega**2)
        charge += weight * static
    admittance: si.ComplexArray = 1j * omega * charge
    return admittance


def _mode(
    section: AnnularSection,
    system: HarmonicSystem,
    square: float,
    vector: si.FloatArray,
    quality_factor: si.Dimensionless | None,
) -> AnnularMode:
    field = system.field(vector)
    surface = np.flatnonzero(np.abs(system.z - section.surface_height) <= 5e-10)
    surface = surface[np.argsort(system.r[surface])]
    shape = field[surface, 2]
    peak = float(shape[np.argmax(np.abs(shape))])
    # In-plane motions hardly lift the surface: scale them by their largest component instead.
    largest = float(field.flat[np.argmax(np.abs(field))])
    scale = peak if abs(peak) > 1e-6 * abs(largest) else largest
    axial = system.unknown[:, 2]
    axial = axial[axial >= 0]
    share = float(vector[axial] @ (system.mass @ vector)[axial])
    energies = np.array([vector @ (part @ vector) for part in system.layer_stiffness])
    rigid = _rigid_share(system, vector) > 0.5
    m, mean = system.harmonic, section.mean_diameter
    return AnnularMode(
        harmonic=m,
        label="rigid" if rigid else _label(m, share, field, shape),
        frequency=0.0 if rigid else math.sqrt(max(square, 0.0)) / (2 * math.pi),
        frequency_error=0.0,
        quality_factor=math.inf if rigid else _quality(section, energies, quality_factor),
        modal_mass=1 / scale**2,
        modal_force_all_round=float(vector @ system.force) / scale,
        half_wavelength=math.pi * mean / (2 * m) if m > 0 else None,
        axial_share=share,
        node_radius=system.r,
        node_height=system.z,
        displacement=field / scale,
        surface_radius=system.r[surface],
        surface_shape=shape / scale,
    )


def _rigid_share(system: HarmonicSystem, vector: si.FloatArray) -> si.Dimensionless:
    """The share of a mode (of unit modal mass) that is motion without deformation: 1 or 0 but for
    rounding, since modes that deform have none of it.

    Told by its shape, since the frequency of a rigid motion is rounding, and that of a thin ring is
    hardly above it. Along z and around it for m = 0, across and a tilt for m = 1.
    """
    if system.harmonic > 1:
        return 0.0
    r, z, none = system.r, system.z, np.zeros_like(system.r)
    one = np.ones_like(r)
    around = ((none, none, one), (none, r, none))
    across = ((one, -one, none), (-z, z, r))
    fields = np.array(around if system.harmonic == 0 else across).transpose(0, 2, 1)
    rows = system.unknown[:, :3]
    motions = np.zeros((system.displacements, 2))
    for column, field in enumerate(fields):
        motions[rows[rows >= 0], column] = (field * system.sign[:, :3])[rows >= 0]
    weighted = system.mass @ motions
    moments = weighted.T @ vector
    return float(moments @ np.linalg.solve(motions.T @ weighted, moments))


def _label(m: int, axial_share: float, field: si.FloatArray, shape: si.FloatArray) -> str:
    """B(n, m) for bending; R or T in the plane, by whether it is more radial or more hoop."""
    if axial_share < 0.5:
        radial, hoop = np.abs(field[:, 0]).max(), np.abs(field[:, 1]).max()
        return f"{'R' if radial >= hoop else 'T'}({m})"
    strong = shape[np.abs(shape) > 0.02 * np.abs(shape).max()]
    return f"B({int(np.count_nonzero(np.diff(np.sign(strong))))},{m})"


def _quality(
    section: AnnularSection, energies: si.FloatArray, quality_factor: si.Dimensionless | None
) -> float:
    if quality_factor is not None:
        return quality_factor
    losses = [layer.solid.loss for layer in section.layers]
    if any(loss is None for loss in losses):
        raise InputError(
            "quality_factor is not given, and not every layer has a loss_factor; give either",
            quantity="quality_factor",
        )
    loss = float(np.dot(energies, np.array(losses, dtype=float)) / energies.sum())
    return 1 / loss if loss > 0 else math.inf
