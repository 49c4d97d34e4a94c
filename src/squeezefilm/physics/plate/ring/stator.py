"""A motor stator of which only frequency and wavelength are known: fit the rest, and say so."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, field
from typing import Annotated, Literal

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import UnreachableError
from squeezefilm.core.materials import ElasticMaterial, Piezoceramic
from squeezefilm.physics.plate.elements.box_model import isotropic_solid, piezoceramic_solid
from squeezefilm.physics.plate.ring.modes import (
    DEFAULT_DEGREE,
    AnnularMode,
    bending_frequency,
    bending_mode,
)
from squeezefilm.physics.plate.ring.section import (
    AnnularSection,
    RingLayer,
    SectorDrive,
    alternate_sectors,
    soft_teeth,
    stiff_teeth,
)

ToothModel = Literal["soft", "stiff"]
# Elements to begin a fit with, and how near it comes to the thickness (m).
_ROUGH, _NEAR = 3, 1e-9
_M, _HZ = si.Unit("m"), si.Unit("Hz")
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
    tooth_model: ToothModel = "soft"


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class StatorFit:
    """A stator whose `ring_thickness` (metal between ceramic and teeth) was fitted.

    `assumptions` name what was assumed, in SI units; the section's mean diameter follows from the
    given wavelength. How far the tooth layer is uncertain, `frequency_bounds` and
    `thickness_bounds` say; they are computed when they are first asked for.
    """

    section: AnnularSection
    mode: AnnularMode
    drive: SectorDrive
    ring_thickness: si.Metre
    assumptions: StatorAssumptions
    _ring: _Ring = field(repr=False)

    @functools.cached_property
    def frequency_bounds(self) -> tuple[si.Hertz, si.Hertz]:
        """The frequencies (Hz) that this thickness would have with the teeth soft (no hoop
        stiffness) and stiff (fill × E)."""

        def of(teeth: ToothModel) -> si.Hertz:
            if teeth == self.assumptions.tooth_model:
                return self.mode.frequency
            return self._ring.frequency_of(self.ring_thickness, teeth)

        return of("soft"), of("stiff")

    @functools.cached_property
    def thickness_bounds(self) -> tuple[si.Metre, si.Metre]:
        """The thicknesses (m) that would have been fitted with the teeth stiff and soft: the
        thinnest allowed where the stiff teeth's frequency is too high even so, the thickest where
        the soft teeth's is too low."""
        toothless = self.assumptions.tooth_height == 0

        def of(teeth: ToothModel, without: si.Metre) -> si.Metre:
            if toothless or teeth == self.assumptions.tooth_model:
                return self.ring_thickness
            try:
                return self._ring.thickness(teeth)
            except UnreachableError:
                return without

        thinnest, thickest = self._ring.ends
        return of("stiff", thinnest), of("soft", thickest)

    @si.checked_numbers
    def amplitude(self, voltage: si.Volt) -> si.Metre:
        """Zero-to-peak amplitude at resonance at a voltage amplitude (m), linear in it."""
        return self.mode.amplitude_per_volt(self.drive) * voltage


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
    *,
    thinnest: Annotated[si.Metre, si.Above(0.0)] = 0.3e-3,
    thickest: si.Metre = 10e-3,
    degree: int = DEFAULT_DEGREE,
) -> StatorFit:
    """Fit the metal's thickness so that B(0, `waves`) falls on `frequency`.

    The mean diameter is `waves` × `wavelength`/π; everything else is assumed (see
    `StatorAssumptions`) and listed in the result. One frequency fits one dimension and validates
    nothing: the amplitude that follows is a prediction under these assumptions.
    Raises `UnreachableError` if no thickness between `thinnest` and `thickest` has the frequency.
    """
    a = assumptions or StatorAssumptions()
    si.require("thickest", thickest, _M, above=thinnest)
    mean_diameter = waves * wavelength / math.pi
    ring = _Ring(frequency, waves, mean_diameter, (thinnest, thickest), degree, a)
    thickness = ring.thickness(a.tooth_model if a.tooth_height > 0 else "soft")
    return StatorFit(
        section=stator_section(mean_diameter, thickness, a, a.tooth_model),
        mode=ring.mode(thickness, a.tooth_model),
        drive=alternate_sectors(a.driven_sectors, math.pi / waves),
        ring_thickness=thickness,
        assumptions=a,
        _ring=ring,
    )


@dataclass(frozen=True)
class _Ring:
    """A stator but for its metal's thickness, which lies between `ends` (m) and is fitted to put
    B(0, `waves`) on the frequency (Hz)."""

    frequency: float
    waves: int
    mean_diameter: float
    ends: tuple[float, float]
    degree: int
    assumptions: StatorAssumptions

    def mode(self, thickness: float, teeth: ToothModel) -> AnnularMode:
        """The mode with a thickness (m) and one bound of the teeth."""
        section = stator_section(self.mean_diameter, thickness, self.assumptions, teeth)
        quality = self.assumptions.quality_factor
        return bending_mode(section, self.waves, degree=self.degree, quality_factor=quality)

    def frequency_of(self, thickness: float, teeth: ToothModel, degree: int | None = None) -> float:
        """Frequency (Hz), by elements of this degree or another."""
        section = stator_section(self.mean_diameter, thickness, self.assumptions, teeth)
        return bending_frequency(section, self.waves, degree=degree or self.degree)

    def thickness(self, teeth: ToothModel) -> float:
        """The thickness (m) that has the frequency; raises `UnreachableError` where none does.

        Sought with elements of a low degree, and from there with those of this one.
        """
        from scipy.optimize import root_scalar

        if self.degree <= _ROUGH:
            return self._crossing(teeth, self.degree, _NEAR)
        try:
            first = self._crossing(teeth, _ROUGH, 1e3 * _NEAR)
        except UnreachableError:
            # At the ends the two degrees may differ.
            return self._crossing(teeth, self.degree, _NEAR)
        root = root_scalar(
            lambda t: self.frequency_of(t, teeth) - self.frequency,
            method="secant",
            x0=first,
            # Towards the inside, whichever end is near.
            x1=first + 1e-3 * (sum(self.ends) / 2 - first),
            xtol=_NEAR,
            maxiter=8,
        )
        inside = self.ends[0] <= root.root <= self.ends[1]
        if root.converged and inside:
            return float(root.root)
        return self._crossing(teeth, self.degree, _NEAR)

    def _crossing(self, teeth: ToothModel, degree: int, near: float) -> float:
        """The same with elements of one degree, between the ends and to so many metres."""

        from scipy.optimize import brentq

        # The ends are asked for twice.
        @functools.cache
        def above(thickness: float) -> float:
            return self.frequency_of(thickness, teeth, degree) - self.frequency

        ends = [above(t) for t in self.ends]
        if ends[0] * ends[1] > 0:
            raise UnreachableError(
                f"no ring thickness from {si.format_quantity(self.ends[0], _M)} to "
                f"{si.format_quantity(self.ends[1], _M)} puts B(0,{self.waves}) with {teeth} teeth "
                f"on {si.format_quantity(self.frequency, _HZ)}: it lies between "
                f"{si.format_quantity(ends[0] + self.frequency, _HZ)} and "
                f"{si.format_quantity(ends[1] + self.frequency, _HZ)}; change the assumptions",
                quantity="frequency",
            )
        return float(brentq(above, *self.ends, xtol=near))
