"""Materials and places of a ring or a disc in its (r, z) half section, and its drive.

Solids are in their own axes (r, θ, z), with components in Voigt order rr, θθ, zz, θz, rz, rθ and
engineering shear strains.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.plate.elements.box_model import Medium, isotropic_solid, piezoceramic_solid
from squeezefilm.physics.plate.layout import DiscPlate


@si.checked_numbers
def stiff_teeth(
    solid: Medium, fill: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(1.0)]
) -> Medium:
    """A layer of radial teeth, smeared, at its upper bound: everything times `fill`.

    `fill` is the share of the circumference that is metal. A smooth motion of the filled layer is
    admissible for the teeth, so (Rayleigh) a frequency computed with this layer is not below the
    true one of a ring with many teeth per half wave.
    """
    return Medium(
        f"{solid.name} teeth, stiff",
        fill * solid.stiffness,
        fill * solid.density,
        solid.loss,
    )


@si.checked_numbers
def soft_teeth(
    solid: Medium, fill: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(1.0)]
) -> Medium:
    """A layer of radial teeth, smeared, at its lower bound: no hoop stiffness at all.

    Each tooth is solid in r and z with its flanks free (plane stress in θ), stands upright and
    shears over its height (Grz and Gθz times `fill`), but hands no hoop stress (Eθ = 0) and no
    in-plane shear (Grθ = 0) on to its neighbours. Valid well below the teeth's own bending
    resonance. Teeth modelled one by one (72 of 80 % fill, 1.5–2.5 mm on a ring of 2–2.9 mm) lie 7
    to 13 % of the way from this bound to `stiff_teeth`.

    Radial stiffness cannot be dropped as well: a tooth is one piece from the inner to the outer
    edge, and without it the layer has waves of any shortness at any frequency.
    """
    compliance = np.linalg.inv(solid.stiffness)
    meridian = np.ix_([0, 2], [0, 2])
    stiffness = np.zeros((6, 6))
    stiffness[meridian] = np.linalg.inv(compliance[meridian])
    stiffness[3, 3], stiffness[4, 4] = solid.stiffness[3, 3], solid.stiffness[4, 4]
    return Medium(
        f"{solid.name} teeth, soft",
        fill * stiffness,
        fill * solid.density,
        solid.loss,
    )


# Half a nanometre: what two edges may differ by and still be the same edge.
_SAME = 5e-10


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class RingLayer:
    """A rectangle of the (r, z) section, revolved: radii and heights in metres.

    Its solid has a mirror plane normal to θ, as metals and ceramics poled along z do: others would
    mix Fourier harmonics. A piezoelectric layer has electrodes on the whole of its lower and upper
    face, and is bonded, earthed, at its upper face.
    """

    inner_radius: Annotated[si.Metre, si.AtLeast(0)]
    outer_radius: Annotated[si.Metre, si.Above("inner_radius")]
    bottom: si.Metre
    top: Annotated[si.Metre, si.Above("bottom")]
    solid: Medium

    @property
    def thickness(self) -> si.Metre:
        """Top minus bottom."""
        return self.top - self.bottom


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class AnnularSection:
    """Layers that share faces and together make a ring or a disc, free everywhere.

    `wave_diameter` is where wavelengths are measured: by default twice the mean radius of the
    surface.
    """

    layers: tuple[RingLayer, ...]
    wave_diameter: Annotated[si.Metre, si.Above(0)] | None = None

    @property
    def thickness(self) -> si.Metre:
        """Overall height."""
        return self.surface_height - min(layer.bottom for layer in self.layers)

    @property
    def mass(self) -> si.Kilogram:
        """The mass of the whole body."""
        return math.pi * sum(
            a.solid.density * a.thickness * (a.outer_radius**2 - a.inner_radius**2)
            for a in self.layers
        )

    @property
    def shear_times(self) -> dict[str, si.Second]:
        """Time that shear takes through each layer (s), by the name of its medium; the thickest of
        several of a name."""
        times: dict[str, si.Second] = {}
        for layer in self.layers:
            solid = layer.solid
            stiffness = max(solid.stiffness[3, 3], solid.stiffness[4, 4])
            time = layer.thickness * math.sqrt(solid.density / stiffness)
            times[solid.name] = max(time, times.get(solid.name, 0.0))
        return times

    @property
    def surface_height(self) -> si.Metre:
        """The z of the surface that is touched: the highest one."""
        return max(layer.top for layer in self.layers)

    @property
    def surface_radii(self) -> tuple[si.Metre, si.Metre]:
        """Inner and outer radius of the surface that is touched."""
        at = [x for x in self.layers if abs(x.top - self.surface_height) <= _SAME]
        return min(x.inner_radius for x in at), max(x.outer_radius for x in at)

    @property
    def mean_diameter(self) -> si.Metre:
        """Diameter of the circle on which wavelengths are measured (m)."""
        return self.wave_diameter or sum(self.surface_radii)


@si.checked_numbers
@dataclass(frozen=True)
class SectorDrive:
    """Sectors of the ceramic ring that one channel drives: (start, end, polarity) in radians.

    They do not overlap. Polarity is the direction of poling (+1 or −1) under one common electrode,
    or the sign of its voltage.
    """

    sectors: tuple[tuple[si.Radian, si.Radian, int], ...]

    @property
    def angle(self) -> si.Radian:
        """The angle that the electrodes cover."""
        return sum(end - start for start, end, _ in self.sectors)

    @si.checked_numbers
    def coefficient(self, harmonic: int) -> complex:
        """∫ s(θ) exp(−i m θ) dθ of the polarity s; its size is what drives cos m(θ − θ0).

        Alternate sectors all round give 4 for their own harmonic, one of full poling 2π for m = 0.
        """
        if harmonic == 0:
            return complex(sum(sign * (end - start) for start, end, sign in self.sectors))
        total = sum(
            sign * (np.exp(-1j * harmonic * end) - np.exp(-1j * harmonic * start))
            for start, end, sign in self.sectors
        )
        return complex(total * 1j / harmonic)


@si.checked_numbers
def alternate_sectors(
    count: Annotated[int, si.AtLeast(1)], width: Annotated[si.Radian, si.Above(0.0)]
) -> SectorDrive:
    """`count` neighbouring sectors of one width, of alternate poling: the channel of a motor.

    A motor in B(0, m) has sectors of π/m; its one channel has fewer than 2m of them, since the
    other channel and the gaps between the two take the rest.
    """
    return SectorDrive(
        tuple((k * width, (k + 1) * width, 1 if k % 2 == 0 else -1) for k in range(count))
    )


def full_drive() -> SectorDrive:
    """Drive by one electrode all round: drives the axisymmetric modes of a disc."""
    return SectorDrive(((0.0, 2 * math.pi, 1),))


def bonded_disc(disc: DiscPlate) -> AnnularSection:
    """The section of a disc display (T-PaD): a glass disc with a ceramic disc or ring below.

    The bond is perfect, or a layer of glue. The loss of the whole assembly counts in every
    material, unless the substrate has its own.
    """
    loss_factor = 1 / disc.quality_factor if disc.substrate.quality_factor is None else None
    inner, outer = disc.ceramic_inner_diameter / 2, disc.ceramic_outer_diameter / 2
    base, glue = disc.ceramic_thickness, disc.glue
    piezo = piezoceramic_solid(disc.ceramic, loss_factor)
    layers = [RingLayer(inner, outer, 0.0, base, piezo)]
    if glue is not None:
        top = base + glue.thickness
        layers.append(RingLayer(inner, outer, base, top, isotropic_solid(glue, loss_factor)))
        base = top
    solid, half = isotropic_solid(disc.substrate, loss_factor), disc.inner_diameter / 2
    layers.append(RingLayer(half, disc.diameter / 2, base, base + disc.thickness, solid))
    return AnnularSection(tuple(layers), wave_diameter=disc.diameter)
