"""The laminate of a plate with ceramics, cell by cell, for first-order shear theory.

Lengths z are taken from the substrate's mid-plane, positive towards the free (touched) face.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.materials import VACUUM_PERMITTIVITY, ElasticMaterial, Piezoceramic
from squeezefilm.physics.plate.laminate import SHEAR_CORRECTION
from squeezefilm.physics.plate.layout import RectangularPlate

_SAME = 1e-9


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class ShearSection:
    """One laminate per unit area: N = A ε + B κ, M = B ε + D κ, Q = S γ.

    `membrane` A in N/m, `coupling` B in N, `bending` D in N·m, all (3, 3) in the order xx, yy, xy;
    `shear` S in N/m; `inertia` the density's moments ∫ρ(1, z, z²)dz; one volt makes the membrane
    force `stress_coefficient` (N/m per V = C/m²) in all directions at the height `piezo_arm`.
    """

    membrane: si.FloatArray
    coupling: si.FloatArray
    bending: si.FloatArray
    shear: si.NewtonPerMetre
    inertia: si.FloatArray
    stress_coefficient: si.CoulombPerSquareMetre = 0.0
    piezo_arm: si.Metre = 0.0

    @property
    def shear_time(self) -> si.Second:
        """Half the period at which the section shears across its thickness, ω² = S/I (s)."""
        mass, first, second = self.inertia
        return math.pi * math.sqrt((second - first**2 / mass) / self.shear)

    @property
    def stiffness(self) -> si.FloatArray:
        """All of it, (8, 8): three membrane strains, three curvatures, two shears."""
        law = np.zeros((8, 8))
        law[:3, :3], law[3:6, 3:6] = self.membrane, self.bending
        law[:3, 3:6] = law[3:6, :3] = self.coupling
        law[6, 6] = law[7, 7] = self.shear
        return law


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class ShearLayout:
    """A rectangular plate cut into cells by `x_edges` and `y_edges` (m), each of one section.

    `section` (cells along x, along y) indexes `sections`; `polarity` is +1, −1 or 0 per cell.
    """

    x_edges: si.FloatArray
    y_edges: si.FloatArray
    sections: tuple[ShearSection, ...]
    section: np.ndarray
    polarity: si.FloatArray

    @property
    def extent(self) -> si.Metre:
        """The longer side."""
        return float(max(np.ptp(self.x_edges), np.ptp(self.y_edges)))

    @property
    def softest(self) -> float:
        """The least bending stiffness over mass per area of all sections (m⁴/s²)."""
        return float(min(s.bending[0, 0] / s.inertia[0] for s in self.sections))

    @property
    def mass(self) -> si.Kilogram:
        """The mass of the whole plate."""
        areas = np.outer(np.diff(self.x_edges), np.diff(self.y_edges))
        per_area = np.array([s.inertia[0] for s in self.sections])[self.section]
        return float((areas * per_area).sum())

    @si.checked_numbers
    def parity_of(self, nodal_lines: tuple[int, int]) -> tuple[int, int]:
        """The class of symmetry of modes with these nodal lines: ±1, or 0 where there is none."""
        x, y = (1 if lines % 2 == 0 else -1 for lines in nodal_lines)
        return x if self.mirrored(0) else 0, y if self.mirrored(1) else 0

    def mirrored(self, axis: int) -> bool:
        """True where the laminate (not its polarity) is its own mirror image along x (0) or y
        (1)."""
        edges = (self.x_edges, self.y_edges)[axis]
        middle = edges[0] + edges[-1]
        same_edges = np.allclose(edges, middle - edges[::-1], rtol=0, atol=_SAME)
        return bool(same_edges and np.array_equal(self.section, np.flip(self.section, axis)))


@si.checked_numbers
def isotropic_section(
    material: ElasticMaterial, thickness: Annotated[si.Metre, si.Above(0.0)]
) -> ShearSection:
    """A bare plate of one material (plane stress, Reissner's shear factor 5/6)."""
    reduced = _plane_stress(material.plane_strain_modulus, material.poisson_ratio)
    return ShearSection(
        membrane=reduced * thickness,
        coupling=np.zeros((3, 3)),
        bending=reduced * thickness**3 / 12,
        shear=SHEAR_CORRECTION * material.shear_modulus * thickness,
        inertia=material.density * np.array([thickness, 0.0, thickness**3 / 12]),
    )


@si.checked_numbers
def monomorph_section(
    substrate: ElasticMaterial,
    thickness: si.Metre,
    ceramic: Piezoceramic,
    ceramic_thickness: Annotated[si.Metre, si.Above(0.0)],
) -> ShearSection:
    """A substrate with a shorted ceramic perfectly bonded to its lower face.

    The ceramic is in plane stress; its coupling is that of the data set believed.
    Bending raises a parabolic potential between the shorted faces, which stiffens the ceramic's own
    bending by e31_p²/ε33_p (the field is linear in z, its mean zero).
    Valid for layers thin against the wavelength; source: classical lamination with Mindlin's shear
    (1951, 10.1115/1.4010217), shear factor 5/6 for the sum of the layers.
    """
    bare = isotropic_section(substrate, thickness)
    reduced = _plane_stress(ceramic.in_plane_stiffness, ceramic.in_plane_poisson_ratio)
    h = ceramic_thickness
    arm = -(thickness + h) / 2
    bending = reduced * (h * arm**2 + h**3 / 12)
    e = ceramic.effective_stress_coefficient
    permittivity = ceramic.relative_permittivity * VACUUM_PERMITTIVITY
    bending[:2, :2] += e**2 / permittivity * h**3 / 12
    moments = np.array([h, h * arm, h * arm**2 + h**3 / 12])
    return ShearSection(
        membrane=bare.membrane + reduced * h,
        coupling=reduced * h * arm,
        bending=bare.bending + bending,
        shear=bare.shear + SHEAR_CORRECTION * ceramic.shear_modulus * h,
        inertia=bare.inertia + ceramic.density * moments,
        stress_coefficient=e,
        piezo_arm=arm,
    )


def shear_layout(plate: RectangularPlate) -> ShearLayout:
    """The cells of a plate with ceramics: bare where there is none, laminate where there is."""
    xs = [0.0, plate.length, *(e for p in plate.patches for e in (p.x, p.x + p.length))]
    ys = [0.0, plate.width, *(e for p in plate.patches for e in (p.y, p.y + p.width))]
    x_edges, y_edges = _merged(xs, plate.length), _merged(ys, plate.width)
    xm, ym = (x_edges[1:] + x_edges[:-1]) / 2, (y_edges[1:] + y_edges[:-1]) / 2
    polarity = np.zeros((xm.size, ym.size))
    for p in plate.patches:
        across = (xm > p.x) & (xm < p.x + p.length)
        polarity[np.ix_(across, (ym > p.y) & (ym < p.y + p.width))] = p.polarity
    sections = (
        isotropic_section(plate.substrate, plate.thickness),
        monomorph_section(plate.substrate, plate.thickness, plate.ceramic, plate.ceramic_thickness),
    )
    return ShearLayout(x_edges, y_edges, sections, (polarity != 0).astype(int), polarity)


def _plane_stress(modulus: float, poisson: float) -> si.FloatArray:
    return modulus * np.array([[1, poisson, 0], [poisson, 1, 0], [0, 0, (1 - poisson) / 2]])


def _merged(values: list[float], end: float) -> si.FloatArray:
    ordered = sorted(min(max(v, 0.0), end) for v in values)
    return np.array([v for k, v in enumerate(ordered) if k == 0 or v - ordered[k - 1] > _SAME])
