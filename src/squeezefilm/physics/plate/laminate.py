"""A plate and its ceramic as one beam section, per unit width, from the free face upwards.

Classical lamination theory: the layers bend about a common neutral axis (paper eq 16 and 17, with
the width in both the stiffness and the mass or, as here, in neither).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.plate.layout import DiscPlate, Face, RectangularPlate

CrossSection = Literal["paper", "plane_stress", "plane_strain"]
SHEAR_CORRECTION = 5 / 6


@si.checked_numbers
@dataclass(frozen=True)
class LaminateLayer:
    """A layer of a laminate: its thickness, bending modulus, shear modulus and density."""

    thickness: Annotated[si.Metre, si.Above(0)]
    modulus: Annotated[si.Pascal, si.Above(0)]
    shear_modulus: Annotated[si.Pascal, si.Above(0)]
    density: Annotated[si.KilogramPerCubicMetre, si.Above(0)]


@si.checked_numbers
@dataclass(frozen=True)
class Laminate:
    """The section constants of a laminate per unit width.

    `bending_stiffness` G in N·m, `mass_per_area` M in kg/m², `rotary_inertia` J in kg,
    `shear_stiffness` S in N/m (Reissner's 5/6 of the sum of layers); `neutral_axis` is measured
    from the free face.
    """

    neutral_axis: si.Metre
    bending_stiffness: si.NewtonMetre
    mass_per_area: si.KilogramPerSquareMetre
    rotary_inertia: si.Kilogram
    shear_stiffness: si.NewtonPerMetre
    layers: tuple[LaminateLayer, ...]

    @si.checked_numbers
    def moment_arm(self, layer: int) -> si.Metre:
        """The distance of a layer's mid-plane from the neutral axis, positive upwards."""
        si.require("layer", layer, at_least=0, at_most=len(self.layers) - 1)
        below = sum(other.thickness for other in self.layers[:layer])
        return below + self.layers[layer].thickness / 2 - self.neutral_axis


def laminate(layers: Sequence[LaminateLayer]) -> Laminate:
    """The section constants of a stack of layers, the first at the free face.

    Valid for layers thin against the wavelength and perfectly bonded. Source: paper eq 16 and 17;
    any text on classical lamination theory. Raises `InputError` for an empty stack.
    """
    if not layers:
        raise InputError("a laminate of no layers was asked for; give at least one")
    bottoms = [sum(layer.thickness for layer in layers[:i]) for i in range(len(layers))]
    spans = [(x, b, b + x.thickness) for x, b in zip(layers, bottoms, strict=True)]
    stretch = sum(layer.modulus * layer.thickness for layer in layers)
    neutral = sum(layer.modulus * (t**2 - b**2) / 2 for layer, b, t in spans) / stretch
    thirds = [(layer, ((t - neutral) ** 3 - (b - neutral) ** 3) / 3) for layer, b, t in spans]
    return Laminate(
        neutral_axis=neutral,
        bending_stiffness=sum(layer.modulus * third for layer, third in thirds),
        mass_per_area=sum(layer.density * layer.thickness for layer in layers),
        rotary_inertia=sum(layer.density * third for layer, third in thirds),
        shear_stiffness=SHEAR_CORRECTION
        * sum(layer.shear_modulus * layer.thickness for layer in layers),
        layers=tuple(layers),
    )


def plate_laminate(
    plate: RectangularPlate | DiscPlate, cross_section: CrossSection = "plane_strain"
) -> Laminate:
    """The section of a plate where it carries ceramic, on one face or on both; the gaps between
    ceramics are neglected. `cross_section` as in `section_with`."""
    return section_with(plate, cross_section, *ceramics_of(plate))


@si.checked_numbers
def section_with(
    plate: RectangularPlate | DiscPlate,
    cross_section: CrossSection,
    above: Annotated[si.Metre, si.AtLeast(0.0)],
    below: Annotated[si.Metre, si.AtLeast(0.0)],
) -> Laminate:
    """The section of a plate with ceramic of a thickness on its upper and on its lower face; 0 is
    none.

    `cross_section` says how the strip deforms across its width: not at all ("plane_strain", for
    plates wide against λ/2: E/(1 − ν²) and c11_p), freely ("plane_stress", for narrow ones: E and
    1/s11), or as the paper has it, which mixes the two ("paper": E and c11_p).
    Raises `InputError` for a thickness below 0.
    """
    substrate, ceramic = plate.substrate, plate.ceramic
    wide = cross_section == "plane_strain"
    narrow = cross_section == "plane_stress"
    metal = LaminateLayer(
        plate.thickness,
        substrate.plane_strain_modulus if wide else substrate.young_modulus,
        substrate.shear_modulus,
        substrate.density,
    )
    upper, lower = (
        [
            LaminateLayer(
                thickness,
                1 / ceramic.compliance_11 if narrow else ceramic.in_plane_stiffness,
                ceramic.shear_modulus,
                ceramic.density,
            )
        ]
        if thickness
        else []
        for thickness in (above, below)
    )
    return laminate([*upper, metal, *lower])


def ceramics_of(plate: RectangularPlate | DiscPlate) -> tuple[si.Metre, si.Metre]:
    """The thickness (m) of the ceramics on the upper and on the lower face, their mean by area; 0
    where a face carries none."""
    if isinstance(plate, DiscPlate):
        return 0.0, plate.ceramic_thickness
    return plate.ceramic_thickness_on("top"), plate.ceramic_thickness_on("bottom")


def moment_per_volt(
    plate: RectangularPlate,
    section: Laminate,
    cross_section: CrossSection = "plane_strain",
    face: Face = "bottom",
) -> si.NewtonPerVolt:
    """The bending moment per unit width that one volt makes in the ceramic of one face: e31 × its
    arm (N/V), of the other sign on the other face.

    From M = ∫ e31 E z dz with E = V/h_p over the ceramic's thickness h_p. A strip free across its
    width ("plane_stress") has e31_p (1 − ν_p) = d31/s11 in place of e31_p.
    """
    coefficient = plate.ceramic.effective_stress_coefficient
    if cross_section == "plane_stress":
        coefficient *= 1 - plate.ceramic.in_plane_poisson_ratio
    return coefficient * section.moment_arm(0 if face == "top" else len(section.layers) - 1)
