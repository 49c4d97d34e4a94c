"""What a plate or a stator is made of and where: geometry, checked when it is built."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from squeezefilm.errors import GeometryError
from squeezefilm.materials import ElasticMaterial, Piezoceramic
from squeezefilm.quantities import (
    Dimensionless,
    Hertz,
    Metre,
    SquareMetre,
    Unit,
    Volt,
    format_quantity,
    require,
)

_M = Unit("m")


@dataclass(frozen=True)
class CeramicPatch:
    """One rectangular ceramic on the lower face.

    `x` and `y` are the distances of its near edges from the plate's corner; `polarity` is the sign
    with which it follows the drive.
    """

    x: Metre
    y: Metre
    length: Metre
    width: Metre
    thickness: Metre
    polarity: Literal[1, -1] = 1

    def __post_init__(self) -> None:
        require("x", self.x, _M, at_least=0)
        require("y", self.y, _M, at_least=0)
        for name in ("length", "width", "thickness"):
            require(name, getattr(self, name), _M, above=0)


@dataclass(frozen=True)
class RectangularPlate:
    """A rectangular plate with ceramics bonded to its lower face, free on all edges.

    `nodal_lines` picks the working mode: that many nodal lines across the length, none along it.
    `quality_factor` is that of the whole assembly.

    Raises `GeometryError` for ceramics that overlap each other or overhang the plate.
    """

    length: Metre
    width: Metre
    thickness: Metre
    nodal_lines: int
    quality_factor: Dimensionless
    substrate: ElasticMaterial
    ceramic: Piezoceramic
    patches: tuple[CeramicPatch, ...]
    type: Literal["rectangular_plate"] = "rectangular_plate"

    def __post_init__(self) -> None:
        for name in ("length", "width", "thickness"):
            require(name, getattr(self, name), _M, above=0)
        require("nodal_lines", self.nodal_lines, at_least=2)
        require("quality_factor", self.quality_factor, above=0.5)
        if not self.patches:
            raise GeometryError("patches is empty; a plate needs at least one ceramic to drive it")
        if len({patch.thickness for patch in self.patches}) > 1:
            raise GeometryError(
                "patches have different thicknesses; one thickness for all of them is allowed"
            )
        self._check_overhang()
        self._check_overlap()

    def _check_overhang(self) -> None:
        # A nanometre of slack, so that 7 × 11 mm + 6 × 1 mm is not longer than 83 mm in floats.
        for number, patch in enumerate(self.patches, 1):
            for axis, start, extent, limit in (
                ("length", patch.x, patch.length, self.length),
                ("width", patch.y, patch.width, self.width),
            ):
                if start + extent > limit + 1e-9:
                    raise GeometryError(
                        f"ceramic {number} overhangs the plate: it ends at "
                        f"{format_quantity(start + extent, _M)} along its {axis}, the plate at "
                        f"{format_quantity(limit, _M)}; move it or make it shorter"
                    )

    def _check_overlap(self) -> None:
        for i, a in enumerate(self.patches):
            for j, b in enumerate(self.patches[:i]):
                overlap_x = min(a.x + a.length, b.x + b.length) - max(a.x, b.x)
                overlap_y = min(a.y + a.width, b.y + b.width) - max(a.y, b.y)
                if overlap_x > 1e-9 and overlap_y > 1e-9:
                    raise GeometryError(
                        f"ceramics {j + 1} and {i + 1} overlap by "
                        f"{format_quantity(overlap_x, _M)} × {format_quantity(overlap_y, _M)}; "
                        "move one of them"
                    )

    @property
    def area(self) -> SquareMetre:
        """The surface a finger can explore."""
        return self.length * self.width

    @property
    def ceramic_thickness(self) -> Metre:
        """The thickness that all ceramics share."""
        return self.patches[0].thickness

    @property
    def coverage(self) -> Dimensionless:
        """The fraction of the lower face that carries ceramic."""
        return sum(patch.length * patch.width for patch in self.patches) / self.area


@dataclass(frozen=True)
class AnnularStator:
    """The ring of an ultrasonic motor fed on one channel: a standing wave of known frequency and
    length. Its amplitude is not computed but measured, at `reference_voltage`, and scales with it.
    The surface may be toothed: `tooth_pitch` along the circumference, slots of `slot_width`.
    """

    mean_diameter: Metre
    radial_width: Metre
    wavelength: Metre
    resonance_frequency: Hertz
    quality_factor: Dimensionless
    reference_amplitude: Metre
    reference_voltage: Volt
    tooth_pitch: Metre | None = None
    slot_width: Metre | None = None
    type: Literal["annular_stator"] = "annular_stator"

    def __post_init__(self) -> None:
        for name in ("mean_diameter", "radial_width", "wavelength", "reference_amplitude"):
            require(name, getattr(self, name), _M, above=0)
        require("resonance_frequency", self.resonance_frequency, Unit("Hz"), above=0)
        require("quality_factor", self.quality_factor, above=0.5)
        require("reference_voltage", self.reference_voltage, Unit("V"), above=0)
        if self.radial_width >= self.mean_diameter:
            raise GeometryError(
                f"radial_width = {format_quantity(self.radial_width, _M)} is not smaller than "
                f"mean_diameter = {format_quantity(self.mean_diameter, _M)}; a ring needs a hole"
            )
        if (self.tooth_pitch is None) != (self.slot_width is None):
            raise GeometryError(
                "tooth_pitch and slot_width belong together; give both, or neither for a plain ring"
            )
        if self.tooth_pitch is not None and self.slot_width is not None:
            require("tooth_pitch", self.tooth_pitch, _M, above=0)
            require("slot_width", self.slot_width, _M, above=0, below=self.tooth_pitch)
        waves = self.wavelengths_around
        if abs(waves - round(waves)) > 0.05 or round(waves) < 1:
            raise GeometryError(
                f"{waves:.2f} wavelengths of {format_quantity(self.wavelength, _M)} fit on the "
                f"mean diameter of {format_quantity(self.mean_diameter, _M)}; a standing wave "
                "needs a whole number (within 0.05)"
            )

    @property
    def wavelengths_around(self) -> Dimensionless:
        """How many wavelengths fit on the mean circumference."""
        return math.pi * self.mean_diameter / self.wavelength


Actuator = RectangularPlate | AnnularStator
