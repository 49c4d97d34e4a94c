"""A plate and its ceramic as one thin section, per unit width, from the free face upwards; the
press of a finger on it, and the stress of its wave.

Classical lamination theory: the layers bend about a common neutral axis (paper eq 16 and 17, with
the width in both the stiffness and the mass or, as here, in neither).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np

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


# Terms of the series; the last changes the sum by less than 1e-5 of it.
_TERMS = 199


@si.checked_numbers
def pressed_deflection(
    force: Annotated[si.Newton, si.AtLeast(0.0)],
    span: Annotated[si.Metre, si.Above(0.0)],
    width: Annotated[si.Metre, si.Above(0.0)],
    bending_stiffness: Annotated[si.NewtonMetre, si.Above(0.0)],
    poisson_ratio: Annotated[si.Dimensionless, si.AtLeast(0.0), si.Below(0.5)] = 0.3,
    contact_length: Annotated[si.Metre, si.Above(0.0)] | None = None,
) -> si.Metre:
    """The static deflection (m) at the middle of a plate that is held along two lines and pressed.

    A uniform plate of `bending_stiffness` D (N·m, per unit width) lies on two knife edges `span`
    apart, its other two edges free, `width` apart; the force (N) acts in the middle, spread over
    `contact_length` (m) along the span (a point without one). Levy's series: of each sine along the
    span four exponentials across the width, D ∇⁴w = 0 with the force as a step of the shear at the
    middle line (Timoshenko and Woinowsky-Krieger, Theory of Plates and Shells, 1959, section 28).

    Its limits are the beam, F a³/(48 D (1 − ν²) b) for b ≪ a, and the infinitely wide plate,
    0.01695 F a²/D. Valid for small deflections of a thin plate; what overhangs the knife edges is
    left out, and so what it adds in stiffness.
    """
    m = np.arange(1, _TERMS + 1, 2)
    k = m * math.pi / span
    along = np.ones(m.size)
    if contact_length is not None and (side := min(contact_length, span)) > 0:
        along = np.sinc(k * side / (2 * math.pi))
    # Amplitude of the line load over the sines; at the middle every odd sine is ±1 twice.
    load = 2 * force / span * along
    middle = _middle(k * width / 2, poisson_ratio)
    return float(np.sum(load * middle / (bending_stiffness * k**3)))


def _middle(half: si.FloatArray, nu: float) -> si.FloatArray:
    """D k³ W(0) / q of each sine, 4 W = (1 + t) e⁻ᵗ + a cosh t + b t sinh t with t = k y.

    The first term, the infinitely wide plate's, has the step of the shear; the others are even, and
    with a and b there is no moment and no edge force at t = h. Written so that no exponential
    grows.
    """
    e, r = np.exp(-2 * half), 1 - nu
    cosh, sinh, free = (1 + e) / 2, (1 - e) / 2, r * half  # both times e⁻ʰ
    wanted = (1 + nu - free) * ((1 + nu) * sinh - free * cosh)
    wanted += (2 + free) * (2 * cosh + free * sinh)
    a = e * wanted / (r * ((3 + nu) * cosh * sinh - free * e))
    return np.asarray((1 + a) / 4)


@si.closed_form(positive="radius bending_stiffness", nonnegative="force")
def pressed_disc_deflection(
    force: si.NewtonLike,
    radius: si.MetreLike,
    bending_stiffness: si.NewtonMetre,
    poisson_ratio: si.Dimensionless,
) -> si.MetreLike:
    """The static deflection (m) in the middle of a disc held along a circle of `radius` (m).

    F r² (3 + ν) / (16 π (1 + ν) D), of a point force on a disc that ends at that circle; what
    overhangs it makes it stiffer. Broadcasts. Source: Timoshenko and Woinowsky-Krieger, Theory of
    Plates and Shells, 1959, section 19.
    """
    shape = (3 + poisson_ratio) / (16 * np.pi * (1 + poisson_ratio))
    deflection: si.MetreLike = force * radius**2 * shape / bending_stiffness
    return deflection


@si.closed_form(positive="half_wavelength modulus", nonnegative="amplitude distance")
def bending_stress(
    amplitude: si.MetreLike,
    half_wavelength: si.MetreLike,
    distance: si.MetreLike,
    modulus: si.Pascal,
) -> si.PascalLike:
    """The amplitude of the stress (Pa) of a flexural wave, `distance` (m) from the neutral axis.

    E (π/(λ/2))² z A of a plate that bends to a cylinder, with `modulus` E that of a wide strip, and
    A the zero-to-peak `amplitude` (m) of an antinode. Broadcasts. The wave of the working mode
    alone: what the ends of a ceramic add (a solved plate's stress is singular there), and the
    drive's own field, are left out.
    """
    stress: si.PascalLike = modulus * (np.pi / half_wavelength) ** 2 * distance * amplitude
    return stress
