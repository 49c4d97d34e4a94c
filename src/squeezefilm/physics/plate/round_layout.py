"""The round bodies, a motor's stator and a disc, and the glue under any ceramic: geometry, checked
when it is built."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

from squeezefilm.core import hard_limits as hard
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import GeometryError, InputError
from squeezefilm.core.materials import ElasticMaterial, Piezoceramic

_M = si.Unit("m")


@si.checked_numbers
@dataclass(frozen=True)
class GlueLayer:
    """The glue between every ceramic and the plate, as an isotropic layer."""

    name: ClassVar[str] = "glue"

    thickness: Annotated[si.Metre, hard.LAYER]
    young_modulus: Annotated[si.Pascal, hard.MODULUS]
    poisson_ratio: Annotated[si.Dimensionless, si.Above(-1), si.Below(0.5)] = 0.38
    density: Annotated[si.KilogramPerCubicMetre, hard.DENSITY] = 1150.0
    quality_factor: Annotated[si.Dimensionless, hard.QUALITY] = 20.0


@si.checked_numbers
@dataclass(frozen=True)
class AnnularStator:
    """The ring of an ultrasonic motor fed on one channel: a standing wave of known frequency and
    length. Its amplitude is not computed but measured, at `reference_voltage`, and scales with it.
    The surface may be toothed: `tooth_pitch` along the circumference, slots of `slot_width`.
    """

    mean_diameter: Annotated[si.Metre, hard.SIDE]
    radial_width: Annotated[si.Metre, hard.SIDE, si.Below("mean_diameter")]
    wavelength: Annotated[si.Metre, hard.SIDE]
    resonance_frequency: Annotated[si.Hertz, hard.FREQUENCY]
    quality_factor: Annotated[si.Dimensionless, hard.QUALITY]
    reference_amplitude: Annotated[si.Metre, si.Above(0), hard.VIBRATION]
    reference_voltage: Annotated[si.Volt, si.Above(0)]
    tooth_pitch: Annotated[si.Metre, si.Above(0)] | None = None
    slot_width: Annotated[si.Metre, si.Above(0), si.Below("tooth_pitch")] | None = None
    type: Literal["annular_stator"] = "annular_stator"
    lines_across: ClassVar[Literal["length", "width"]] = "length"

    def __post_init__(self) -> None:
        if (self.tooth_pitch is None) != (self.slot_width is None):
            raise GeometryError(
                "tooth_pitch and slot_width belong together; give both, or neither for a plain ring"
            )
        waves = self.wavelengths_around
        if abs(waves - round(waves)) > 0.05 or round(waves) < 1:
            raise GeometryError(
                f"{waves:.2f} wavelengths of {si.format_quantity(self.wavelength, _M)} fit on the "
                f"mean diameter of {si.format_quantity(self.mean_diameter, _M)}; a standing wave "
                "needs a whole number (within 0.05)"
            )

    @property
    def extent(self) -> tuple[si.Metre, si.Metre]:
        """Extent of what there is to touch once round, along x, and across it (m)."""
        return math.pi * self.mean_diameter, self.radial_width

    @property
    def wavelengths_around(self) -> si.Dimensionless:
        """Number of wavelengths on the mean circumference."""
        return math.pi * self.mean_diameter / self.wavelength


@si.checked_numbers
@dataclass(frozen=True)
class DiscPlate:
    """A disc (or an annulus, with an `inner_diameter`) with a ceramic disc or ring bonded below.

    The working mode B(`nodal_circles`, `nodal_diameters`) is solved, nothing of it is measured.
    Without nodal diameters one electrode covers the whole ceramic; with m of them the ceramic has
    `sectors` neighbouring sectors of π/m, poled in turn (2m go all round). `quality_factor` is that
    of the whole assembly; it holds for every material unless the substrate has its own. The disc is
    free everywhere.

    Raises `GeometryError` for a ceramic that overhangs, `InputError` for sectors that do not fit.
    """

    diameter: Annotated[si.Metre, hard.SIDE]
    thickness: Annotated[si.Metre, hard.LAYER]
    quality_factor: Annotated[si.Dimensionless, hard.QUALITY]
    substrate: ElasticMaterial
    ceramic: Piezoceramic
    ceramic_outer_diameter: Annotated[si.Metre, hard.SIDE]
    ceramic_thickness: Annotated[si.Metre, hard.LAYER]
    inner_diameter: Annotated[si.Metre, si.AtLeast(0), si.Below("diameter")] = 0.0
    ceramic_inner_diameter: Annotated[
        si.Metre, si.AtLeast(0), si.Below("ceramic_outer_diameter")
    ] = 0.0
    nodal_circles: Annotated[int, hard.NODAL_CIRCLES] = 1
    nodal_diameters: Annotated[int, hard.NODAL_CIRCLES] = 0
    sectors: int = 0
    glue: GlueLayer | None = None
    type: Literal["disc"] = "disc"
    lines_across: ClassVar[Literal["length", "width"]] = "length"

    def __post_init__(self) -> None:
        self._check_ceramic()
        m = self.nodal_diameters
        if m == 0 and self.sectors:
            raise InputError(
                f"sectors = {self.sectors} drive no mode without nodal diameters; leave them out "
                "for one electrode all round, or give nodal_diameters",
                quantity="sectors",
            )
        if m > 0 and not 1 <= self.sectors <= 2 * m:
            raise InputError(
                f"sectors = {self.sectors} is not allowed with {m} nodal diameters: from 1 to "
                f"{2 * m} sectors of half a wave fit round the disc",
                quantity="sectors",
            )
        if self.nodal_circles == 0 and m < 2:
            raise InputError(
                f"B(0,{m}) is a motion of the rigid disc; give a nodal circle, or two nodal "
                "diameters",
                quantity="nodal_circles",
            )

    def _check_ceramic(self) -> None:
        if self.ceramic_outer_diameter > self.diameter + 1e-9:
            raise GeometryError(
                f"the ceramic of {si.format_quantity(self.ceramic_outer_diameter, _M)} overhangs "
                f"the disc of {si.format_quantity(self.diameter, _M)}; make it smaller",
                quantity="ceramic_outer_diameter",
            )
        if self.ceramic_inner_diameter < self.inner_diameter - 1e-9:
            raise GeometryError(
                f"the ceramic begins at a diameter of "
                f"{si.format_quantity(self.ceramic_inner_diameter, _M)} and overhangs the hole of "
                f"{si.format_quantity(self.inner_diameter, _M)}; give it a larger "
                "ceramic_inner_diameter",
                quantity="ceramic_inner_diameter",
            )

    @property
    def extent(self) -> tuple[si.Metre, si.Metre]:
        """Extent of what there is to touch along x and along y (m), at the widest."""
        return self.diameter, self.diameter

    @property
    def nodal_lines(self) -> int:
        """Nodal circles and diameters together."""
        return self.nodal_circles + self.nodal_diameters
