"""Body of a described disc or stator, ready to be solved, and its response around a mode.

Of a motor's stator only frequency and wavelength are known: the rest is fitted and assumed.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import UnreachableError
from squeezefilm.core.materials import ElasticMaterial, Piezoceramic
from squeezefilm.physics.plate.circuit import (
    DrivenResponse,
    EquivalentCircuit,
    motional_branch,
    with_static_capacitance,
)
from squeezefilm.physics.plate.elements.box_model import isotropic_solid, piezoceramic_solid
from squeezefilm.physics.plate.elements.nodal_lines import zero_crossings
from squeezefilm.physics.plate.layout import AnnularStator, DiscPlate
from squeezefilm.physics.plate.ring.modes import (
    AnnularMode,
    annular_admittance,
    annular_modes,
    bending_frequency,
    bending_mode,
    clamped_capacitance,
)
from squeezefilm.physics.plate.ring.section import (
    AnnularSection,
    RingLayer,
    SectorDrive,
    alternate_sectors,
    bonded_disc,
    full_drive,
    soft_teeth,
    stiff_teeth,
)

ToothModel = Literal["soft", "stiff"]
# Between these thicknesses (m) the fitted one lies, and so near it comes to it.
_ENDS, _NEAR = (0.3e-3, 10e-3), 1e-9
_M, _HZ = si.Unit("m"), si.Unit("Hz")
_RADII = 121
PHOSPHOR_BRONZE = ElasticMaterial("phosphor bronze", 112e9, 0.33, 8800.0)
"""Material of most motor stators; handbook values (C51900), assumed for the USR60."""

HARD_PZT = Piezoceramic(
    name="hard PZT (assumed)",
    in_plane_stiffness=90e9,
    in_plane_poisson_ratio=0.2897,
    shear_modulus=30e9,
    density=7700.0,
    charge_coefficient=-120e-12,
    relative_permittivity=700.0,
    quality_factor=500.0,
)
"""A hard ceramic of the kind motors use, in round numbers; assumed for the USR60."""


@si.checked_numbers
@dataclass(frozen=True)
class StatorAssumptions:
    """Assumptions for what the paper does not give of its USR60 stator. Every default is assumed.

    `outer_diameter` 60 mm is read off the motor's name; ceramic, teeth and materials are of the
    usual size and kind for such motors. A channel of 8 half-wave sectors is what a 9-wave motor
    with 4 + 4 waves driven, a quarter and three quarters of a wave left over, has (Sashida and
    Kenjo, An Introduction to Ultrasonic Motors, 1993; from memory, to be checked).
    """

    outer_diameter: si.Metre = 60e-3
    ceramic_thickness: si.Metre = 0.5e-3
    tooth_height: si.Metre = 1.5e-3
    tooth_fill: si.Dimensionless = 0.8
    metal: ElasticMaterial = PHOSPHOR_BRONZE
    ceramic: Piezoceramic = HARD_PZT
    quality_factor: si.Dimensionless = 200.0
    driven_sectors: int = 8


@dataclass(frozen=True, eq=False)
class StatorFit:
    """A stator whose `ring_thickness` (metal between ceramic and teeth) was fitted.

    `assumptions` name what was assumed, in SI units; the section's mean diameter follows from the
    given wavelength. Its teeth are soft; `frequency_bounds` are the frequencies (Hz) that this
    thickness has with the teeth soft (no hoop stiffness) and stiff (fill × E).
    """

    section: AnnularSection
    mode: AnnularMode
    drive: SectorDrive
    ring_thickness: si.Metre
    assumptions: StatorAssumptions
    frequency_bounds: tuple[si.Hertz, si.Hertz]


@si.checked_numbers
def stator_section(
    mean_diameter: si.Metre,
    ring_thickness: Annotated[si.Metre, si.Above(0.0)],
    assumptions: StatorAssumptions,
    tooth_model: ToothModel,
) -> AnnularSection:
    """The section of a travelling-wave motor's stator: ceramic below, metal ring, teeth on top.

    `tooth_model` is one of the two bounds of the tooth layer. Raises `InputError` if the outer
    diameter does not exceed the mean diameter.
    """
    a = assumptions
    si.require("outer_diameter", a.outer_diameter, _M, above=mean_diameter, below=2 * mean_diameter)
    si.require("tooth_height", a.tooth_height, _M, at_least=0)
    radial_width, loss_factor = a.outer_diameter - mean_diameter, 1 / a.quality_factor
    inner, outer = (mean_diameter - radial_width) / 2, (mean_diameter + radial_width) / 2
    solid = isotropic_solid(a.metal, loss_factor)
    base = a.ceramic_thickness
    layers = [
        RingLayer(inner, outer, 0.0, base, piezoceramic_solid(a.ceramic, loss_factor)),
        RingLayer(inner, outer, base, base + ring_thickness, solid),
    ]
    if a.tooth_height > 0:
        low = base + ring_thickness
        teeth = (stiff_teeth if tooth_model == "stiff" else soft_teeth)(solid, a.tooth_fill)
        layers.append(RingLayer(inner, outer, low, low + a.tooth_height, teeth))
    return AnnularSection(tuple(layers), wave_diameter=mean_diameter)


@si.checked_numbers
def fit_stator(
    frequency: Annotated[si.Hertz, si.Above(0.0)] = 40.5e3,
    wavelength: Annotated[si.Metre, si.Above(0.0)] = 18.7e-3,
    waves: Annotated[int, si.AtLeast(2)] = 9,
    assumptions: StatorAssumptions | None = None,
) -> StatorFit:
    """Fit the metal's thickness so that B(0, `waves`) falls on `frequency`.

    The mean diameter is `waves` × `wavelength`/π; everything else is assumed (see
    `StatorAssumptions`) and listed in the result. One frequency fits one dimension and validates
    nothing: the amplitude that follows is a prediction under these assumptions.
    Raises `UnreachableError` if no thickness of 0.3 to 10 mm has the frequency.
    """
    from scipy.optimize import brentq

    assumed = assumptions or StatorAssumptions()
    mean_diameter = waves * wavelength / math.pi

    def section(thickness: float, teeth: ToothModel) -> AnnularSection:
        return stator_section(mean_diameter, thickness, assumed, teeth)

    # The ends are asked for twice.
    @functools.cache
    def above(thickness: float) -> float:
        return bending_frequency(section(thickness, "soft"), waves) - frequency

    low, high = (above(thickness) for thickness in _ENDS)
    if low * high > 0:
        raise UnreachableError(
            f"no ring thickness from {si.format_quantity(_ENDS[0], _M)} to "
            f"{si.format_quantity(_ENDS[1], _M)} puts B(0,{waves}) on "
            f"{si.format_quantity(frequency, _HZ)}: it lies between "
            f"{si.format_quantity(low + frequency, _HZ)} and "
            f"{si.format_quantity(high + frequency, _HZ)}; change the assumptions",
            quantity="frequency",
        )
    thickness = float(brentq(above, *_ENDS, xtol=_NEAR))
    fitted = section(thickness, "soft")
    mode = bending_mode(fitted, waves, quality_factor=assumed.quality_factor)
    stiff = mode.frequency
    if assumed.tooth_height > 0:
        stiff = bending_frequency(section(thickness, "stiff"), waves)
    return StatorFit(
        section=fitted,
        mode=mode,
        drive=alternate_sectors(assumed.driven_sectors, math.pi / waves),
        ring_thickness=thickness,
        assumptions=assumed,
        frequency_bounds=(mode.frequency, stiff),
    )


Direction = Literal["circumference", "diameter"]


@dataclass(frozen=True, eq=False)
class RingBody:
    """A ring or a disc ready to be solved.

    `label` is (nodal circles, nodal diameters) of its working mode. `quality_factor` is None where
    every material has its own. `fit` says what was fitted and assumed of a stator.
    """

    section: AnnularSection
    drive: SectorDrive
    label: tuple[int, int]
    quality_factor: si.Dimensionless | None
    fit: StatorFit | None = None

    @si.checked_numbers
    def mode(self, label: tuple[int, int] | None = None) -> AnnularMode:
        """The mode B(circles, diameters), by default the working mode. Raises `InputError`."""
        circles, diameters = label or self.label
        if self.fit is not None and (circles, diameters) == self.label:
            return self.fit.mode
        return bending_mode(self.section, diameters, circles, quality_factor=self.quality_factor)

    def drives(self, mode: AnnularMode) -> bool:
        """True where the channel moves a mode; over its sectors the waves of others cancel."""
        return mode.modal_force(self.drive) > 1e-9 * abs(mode.modal_force_all_round)


@functools.lru_cache(maxsize=8)
def ring_body(actuator: AnnularStator | DiscPlate) -> RingBody:
    """The body of a described actuator; a stator's thickness is fitted to its frequency.

    Raises `UnreachableError` for a stator whose frequency no thickness reaches.
    """
    if isinstance(actuator, DiscPlate):
        m, own = actuator.nodal_diameters, actuator.substrate.quality_factor
        drive = alternate_sectors(actuator.sectors, math.pi / m) if m else full_drive()
        quality = actuator.quality_factor if own is None else None
        return RingBody(bonded_disc(actuator), drive, (actuator.nodal_circles, m), quality)
    fit = fit_stator(
        actuator.resonance_frequency,
        actuator.wavelength,
        round(actuator.wavelengths_around),
        stator_assumptions(actuator),
    )
    return RingBody(
        fit.section,
        fit.drive,
        (0, round(actuator.wavelengths_around)),
        actuator.quality_factor,
        fit,
    )


def stator_assumptions(actuator: AnnularStator) -> StatorAssumptions:
    """Assumptions for what is not described of a stator, with what is described put in its place.

    Its outer diameter, Q and the teeth's fill are its own; a stator described without teeth has
    none. Materials, ceramic, height of the teeth and the channel stay assumed.
    """
    toothed = actuator.tooth_pitch is not None and actuator.slot_width is not None
    return StatorAssumptions(
        outer_diameter=actuator.mean_diameter + actuator.radial_width,
        quality_factor=actuator.quality_factor,
        tooth_height=StatorAssumptions.tooth_height if toothed else 0.0,
        tooth_fill=1 - (actuator.slot_width or 0.0) / (actuator.tooth_pitch or 1.0),
        driven_sectors=min(
            StatorAssumptions.driven_sectors, 2 * round(actuator.wavelengths_around)
        ),
    )


@si.checked_numbers
def surface_profile(mode: AnnularMode, radius: si.MetreArray) -> si.DimensionlessArray:
    """The mode's u_z on the surface at radii (m), between its nodes by a cubic spline."""
    # Imports that a list of modes has no use for.
    from scipy.interpolate import CubicSpline

    values: si.DimensionlessArray = CubicSpline(mode.surface_radius, mode.surface_shape)(radius)
    return values


def nodal_circles(mode: AnnularMode) -> si.MetreArray:
    """The radii (m) at which the surface stands still, rising."""
    r = np.linspace(mode.surface_radius[0], mode.surface_radius[-1], 801)
    return zero_crossings(r, surface_profile(mode, r))


def half_wavelength_of(mode: AnnularMode) -> tuple[si.Metre | None, Direction]:
    """The half wavelength (m) that a finger meets, and along what it is measured.

    With nodal diameters along the circumference on which wavelengths are measured. Without, along a
    diameter: the mean distance at which it crosses nodal circles, through the middle too, so twice
    the radius where there is one circle only. None where nothing is crossed twice.
    """
    if mode.half_wavelength is not None:
        return mode.half_wavelength, "circumference"
    circles = nodal_circles(mode)
    if not circles.size:
        return None, "diameter"
    return float(2 * circles[-1] / (2 * circles.size - 1)), "diameter"


@dataclass(frozen=True, eq=False)
class RingResponse(DrivenResponse):
    """The response to one volt (zero to peak) on the channel, at `frequencies` (Hz).

    `motion` is u_z per volt (m/V, complex) on the surface at θ of an antinode, shape (frequencies,
    radii), by superposition of `terms` modes of one harmonic; it varies as cos mθ around.
    `admittance` (S), time factor e^{iωt}, of the harmonics `harmonics`.
    """

    frequencies: si.HertzArray
    radius: si.MetreArray
    motion: si.ComplexArray
    admittance: si.ComplexArray
    harmonics: tuple[int, ...]
    terms: int
    model: str = "annular_3d"

    @functools.cached_property
    def maximum(self) -> si.FloatArray:
        """The largest |u_z| per volt (m/V) on the surface, for every frequency."""
        return np.asarray(np.max(np.abs(self.motion), axis=1))


@si.checked_numbers
def ring_response(
    body: RingBody,
    mode: AnnularMode,
    frequencies: si.HertzArray,
    harmonics: Sequence[int],
    terms: int = 6,
) -> RingResponse:
    """The response around `mode` at `frequencies` (Hz).

    Motion comes from the `terms` modes of the mode's harmonic nearest to it; the admittance from
    all of `harmonics`. Structural damping. Linear; sectors' fringes and the ceramic's dielectric
    loss are left out. Raises `InputError` for frequencies that are not positive.
    """
    si.require("frequencies", frequencies, si.Unit("Hz"), above=0, axes=1)
    m, quality = mode.harmonic, body.quality_factor
    near = annular_modes(body.section, m, near=mode.frequency, count=terms, quality_factor=quality)
    omega2 = (2 * np.pi * frequencies) ** 2
    radius = np.linspace(mode.surface_radius[0], mode.surface_radius[-1], _RADII)
    motion = np.zeros((frequencies.size, radius.size), dtype=complex)
    polarity = body.drive.coefficient(m)
    for one in near:
        own = (2 * math.pi * one.frequency) ** 2
        loss = 0.0 if one.is_rigid else 1 / one.quality_factor
        force = one.modal_force_all_round * abs(polarity)
        receptance = force / (one.modal_mass * (own * (1 + 1j * loss) - omega2))
        motion += receptance[:, None] * surface_profile(one, radius)[None, :]
    admittance = annular_admittance(
        body.section,
        body.drive,
        frequencies,
        harmonics=tuple(harmonics),
        quality_factor=quality,
        modes=terms,
    )
    return RingResponse(frequencies, radius, motion, admittance, tuple(harmonics), len(near))


def modal_circuit(body: RingBody, mode: AnnularMode) -> EquivalentCircuit:
    """The motional branch of a mode from its modal mass and force, without a static capacitance.

    Raises `InputError` for a mode that the channel does not drive.
    """
    force = abs(mode.modal_force(body.drive))
    return motional_branch(mode.frequency, mode.quality_factor, mode.modal_mass, force)


def ring_circuit(body: RingBody, mode: AnnularMode, response: RingResponse) -> EquivalentCircuit:
    """Butterworth-Van Dyke around the mode: the motional branch of `modal_circuit`, the static
    capacitance from what the sweep's admittance has beside it. Raises as `modal_circuit`."""
    return with_static_capacitance(modal_circuit(body, mode), response)


def static_capacitance(body: RingBody, circuit: EquivalentCircuit | None) -> si.Farad:
    """The capacitance beside a mode (F): that of the circuit, which other modes add to, or of the
    held ceramic where no circuit is known."""
    if circuit is not None:
        return circuit.static_capacitance
    return clamped_capacitance(body.section, body.drive)
