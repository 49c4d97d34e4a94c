"""A solid made of boxes on a tensor-product grid: what the plate solver solves.

Knows nothing of plates and displays. Each cell of the grid is empty or filled by a `Medium`;
cells of one ceramic carry its number, so that its potential is its own.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import OutOfRangeError
from squeezefilm.core.materials import ElasticMaterial, Piezoceramic, isotropic_stiffness
from squeezefilm.physics.plate.elements.lobatto import LineMesh
from squeezefilm.physics.plate.layout import GlueLayer

Loss = Annotated[si.Dimensionless, si.AtLeast(0), si.Below(2)]
EndCondition = Literal["free", "symmetric", "antisymmetric", "clamped"]


def held_components(condition: EndCondition, normal: int) -> list[int]:
    """The components (0–2 displacement, 3 potential) that vanish on a side across `normal`."""
    if condition in ("free", "clamped"):
        return [] if condition == "free" else [0, 1, 2]
    return [normal] if condition == "symmetric" else [a for a in range(4) if a != normal]


# The Voigt row of each displacement gradient (component, direction).
_VOIGT = {
    (0, 0): 0, (1, 1): 1, (2, 2): 2, (1, 2): 3, (2, 1): 3, (0, 2): 4, (2, 0): 4, (0, 1): 5,
    (1, 0): 5,
}  # fmt: skip


# Half waves of shear across a layer.
_MOST_ACROSS = 1.0
# Unknown potentials are counted in this unit (V), so that dielectric and elastic entries of the
# matrices are alike in size; without it elimination loses most digits.
POTENTIAL_UNIT = 3e9


@dataclass(frozen=True, eq=False)
class Medium:
    """Medium of a cell: `stiffness` c at constant field (6 × 6, Pa), `stress_matrix` e (3 × 6,
    C/m²), `permittivity` ε at constant strain (3 × 3, F/m), density and `loss` (the structural loss
    factor 1/Q of c; None if only the assembly's is known). Voigt order xx, yy, zz, yz, xz, xy; of
    rings r, θ, z in place of x, y, z."""

    name: str
    stiffness: si.FloatArray
    density: si.KilogramPerCubicMetre
    loss: si.Dimensionless | None = 0.0
    stress_matrix: si.FloatArray | None = None
    permittivity: si.FloatArray | None = None

    @property
    def piezoelectric(self) -> bool:
        """True where the medium carries a potential."""
        return self.stress_matrix is not None

    def gradient_matrix(self, mechanical: float = 1.0, electrical: float = 1.0) -> si.FloatArray:
        """The symmetric 4·3 × 4·3 matrix between gradients of (u, v, w, φ) and their fluxes.

        Potentials count in `POTENTIAL_UNIT`. Index (component, direction), shape (4, 3, 4, 3). The
        quadratic form of it is the elastic energy minus the electric one, twice. `mechanical`
        scales c, `electrical` e and ε.
        """
        out = np.zeros((4, 3, 4, 3))
        for (a, c), row in _VOIGT.items():
            for (b, d), column in _VOIGT.items():
                out[a, c, b, d] = mechanical * self.stiffness[row, column]
            if self.stress_matrix is not None:
                for d in range(3):
                    out[a, c, 3, d] = out[3, d, a, c] = (
                        electrical * POTENTIAL_UNIT * self.stress_matrix[d, row]
                    )
        if self.permittivity is not None:
            out[3, :, 3, :] = -electrical * POTENTIAL_UNIT**2 * self.permittivity
        return out


@si.checked_numbers
def isotropic_solid(
    material: ElasticMaterial | GlueLayer, loss: Loss | None = None, name: str = ""
) -> Medium:
    """A metal, a glass or glue as a medium, with its own 1/Q (None if it has none) unless `loss` is
    given."""
    own = None if material.quality_factor is None else 1 / material.quality_factor
    return Medium(
        name or material.name,
        isotropic_stiffness(material.young_modulus, material.poisson_ratio),
        material.density,
        own if loss is None else loss,
    )


@si.checked_numbers
def piezoceramic_solid(
    ceramic: Piezoceramic,
    loss: Loss | None = None,
    name: str = "",
    poling: Literal[1, -1] = 1,
) -> Medium:
    """A ceramic poled along +z or −z: its `full_constants`, isotropic across the poling (6mm) as
    `PiezoConstants` checks, so that x and y may be r and θ. Its own 1/Q unless `loss` is given."""
    constants = ceramic.full_constants
    return Medium(
        name or ceramic.name,
        constants.stiffness_matrix,
        ceramic.density,
        1 / ceramic.quality_factor if loss is None else loss,
        poling * constants.stress_matrix,
        constants.permittivity_matrix,
    )


@dataclass(frozen=True)
class ModelElectrode:
    """The electrodes of one ceramic: z-node planes of the driven and of the grounded face."""

    driven_plane: int
    grounded_plane: int


@dataclass(frozen=True)
class Foundation:
    """Springs under a rectangle of grid cells, on one z-node plane.

    `stiffness` per area (Pa/m) along x, y, z; `loss` its loss factor.
    """

    x_elements: tuple[int, int]
    y_elements: tuple[int, int]
    z_plane: int
    stiffness: tuple[float, float, float]
    loss: si.Dimensionless = 0.0


def require_aspect(name: str, height: float, on: str, extent: float, most: float) -> None:
    """Refuse a layer or body of `height` (m) whose extent is more than `most` times that."""
    if extent > most * height:
        raise OutOfRangeError(
            f"a {name} of {si.format_quantity(height, si.Unit('m'))} on a {on} of "
            f"{si.format_quantity(extent, si.Unit('m'))} has an aspect ratio above {most:.0f}, "
            "where three-dimensional elements lose their digits; use a plate theory"
        )


def require_half_wave(frequency: float, times: Mapping[str, float], asked: str) -> None:
    """Refuse a frequency (Hz) at which more than half a wave of shear stands across a layer.

    `times` are those that shear takes through each layer (s), `asked` what the frequency is told
    as. An element of order 3 across a layer (the plate's coarsest) has a standing wave of one half
    wave 3e-4 too high, and of two 23 %; plate theory has one within 1 % and no second.
    """
    layer = max(times, key=lambda name: times[name])
    across = 2 * frequency * times[layer]
    if across > _MOST_ACROSS:
        hertz = si.Unit("Hz")
        most = _MOST_ACROSS / (2 * times[layer])
        raise OutOfRangeError(
            f"{asked} {si.format_quantity(frequency, hertz)} meets {across:.3g} half waves of "
            f"shear across {layer}, and no more than {_MOST_ACROSS:g} is resolved; ask for "
            f"{si.format_quantity(most, hertz)} at most, or for a thinner body",
            quantity="frequency",
        )


def kept_products(y: LineMesh, z: LineMesh, trunk: float) -> NDArray[np.bool_]:
    """True for products of functions along y and z that a `trunk` keeps, (y, z functions)."""

    def relative(mesh: LineMesh) -> si.FloatArray:
        highest = max(mesh.orders)
        return (mesh.function_orders - 1) / max(highest - 1, 1)

    total = relative(y)[:, None] + relative(z)[None, :]
    return np.asarray(total <= trunk + 1e-9)


@dataclass(frozen=True, eq=False)
class BoxModel:
    """A solid of boxes: three line meshes, the medium of each cell (−1: empty) and the number of
    the ceramic it belongs to (−1: none), both of shape (x, y, z elements).

    Every piezoelectric cell belongs to a ceramic with electrodes: a potential held nowhere would
    leave the matrix singular.

    `ends` are the conditions on the four sides x−, x+, y−, y+. `trunk` leaves out functions of
    high order along y and z at once: those with a sum of relative orders (q − 1)/(p − 1) above it
    (infinite: the full tensor product).
    """

    x: LineMesh
    y: LineMesh
    z: LineMesh
    media: tuple[Medium, ...]
    medium: si.IntArray
    ceramic: si.IntArray
    electrodes: tuple[ModelElectrode, ...] = ()
    ends: tuple[EndCondition, EndCondition, EndCondition, EndCondition] = ("free",) * 4
    foundations: tuple[Foundation, ...] = field(default=())
    trunk: float = np.inf

    @property
    def spring_losses(self) -> list[float]:
        """The loss factor of each foundation."""
        return [foundation.loss for foundation in self.foundations]

    @functools.cached_property
    def kept(self) -> NDArray[np.bool_]:
        """True for the products of y and z functions that are used, shape (y, z functions)."""
        return kept_products(self.y, self.z, self.trunk)
