"""The whole array on a fingertip: from volts to forces, displacements and strain of the skin; and
its budget of mass, volume, power and lines, checked against stated limits.

Actuator i gives x_i = δ V_i − F_i/k, the skin x = C F with the tissue's influence C; where every
contactor sticks, (C + 1/k) F = δ V. Linear and quasi-static: what comes of 60 voltages is a product
with a matrix that is made once.

Contactors that ask for more than their friction h slip. With s how far each has slid, sticking asks
A F = w − s for A = C + 1/k and w = δ V; among forces within ±h those of least energy
½ Fᵀ A F − Fᵀ (w − s) stick where they can and slip in their own direction where they cannot
(Coulomb's law with the normal forces known, which the pull sideways is taken not to change).
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, ClassVar, Literal

import numpy as np
from scipy.linalg import cho_solve, solve_triangular
from scipy.optimize import lsq_linear

from squeezefilm.actuators.skin_stretch.bimorph import Bender, Bimorph, solid_bender
from squeezefilm.actuators.skin_stretch.cradle import FingerCradle, Fingertip, seat
from squeezefilm.actuators.skin_stretch.tissue import Tissue, influence_matrix, strain_matrices
from squeezefilm.core import hard_limits as hard
from squeezefilm.core import presets
from squeezefilm.core import quantities as si
from squeezefilm.core.config.provenance import Provenance, References
from squeezefilm.core.errors import ConvergenceError, GeometryError, InputError
from squeezefilm.core.results import Result

Lines = Literal["direct", "matrix", "daisy_chain"]

CubicMetre = Annotated[float, si.Unit("m3")]

PUBLISHED_MASS: si.Kilogram = 60e-3
PUBLISHED_VOLUME: CubicMetre = 150e-6
PUBLISHED_AREA: si.SquareMetre = 1e-4
"""Area of the source paper's array of 60. It prints "150 cm2" for the volume and "10 mm2" for the
surface; 150 cm³ and about 1 cm² are taken, since 60 g fill no area, and 60 contactors a millimetre
apart span 1 cm², not 10 mm²."""


@si.checked_numbers
def lines_needed(count: Annotated[int, si.AtLeast(1)], lines: Lines) -> int:
    """Number of wires to the array that drive `count` actuators: each its own and a common one
    ("direct"); rows and columns of a matrix as square as can be, which holds only what is refreshed
    one row at a time; or clock, data, enable and two of supply for a daisy chain of driver chips,
    whatever the number."""
    if lines == "direct":
        return count + 1
    if lines == "matrix":
        rows = math.isqrt(count)
        while count % rows:
            rows -= 1
        return rows + count // rows
    return 5


@si.checked_numbers
def charging_power(
    bender: Bender,
    count: Annotated[int, si.AtLeast(1)],
    voltage: si.Volt,
    rate: Annotated[si.Hertz, si.AtLeast(0)],
) -> si.Watt:
    """Power that drivers which do not recover charge burn (W) when every actuator goes from
    −`voltage` to +`voltage` (V) and back `rate` times a second: count · C (2V)² · rate."""
    return count * bender.capacitance * (2 * voltage) ** 2 * rate


@si.checked_numbers
def loss_power(
    actuator: Bimorph,
    bender: Bender,
    voltage: si.Volt,
    frequency: Annotated[si.Hertz, si.AtLeast(0)],
) -> si.Watt:
    """The heat in one actuator (W) of a sinusoidal voltage (V, zero to peak), π f C tan δ V².

    Well below its resonance. Raises `OutOfRangeError` beyond the voltage that undoes the poling.
    """
    actuator.require_voltage(voltage)
    return math.pi * frequency * bender.capacitance * actuator.loss_tangent * voltage**2


@si.checked_numbers
@dataclass(frozen=True)
class Budget:
    """The actuators' own `mass` and `volume`, the `area` that they serve, and limits on these, by
    default those of the published array. `over` names, in sentences, what is exceeded. What is left
    is for clamps, cradle, drivers and housing, which are not modelled."""

    mass: si.Kilogram
    volume: CubicMetre
    area: si.SquareMetre
    most_mass: Annotated[si.Kilogram, si.Above(0)] = PUBLISHED_MASS
    most_volume: Annotated[CubicMetre, si.Above(0)] = PUBLISHED_VOLUME
    wanted_area: Annotated[si.SquareMetre, si.Above(0)] = PUBLISHED_AREA

    @property
    def over(self) -> tuple[str, ...]:
        """Sentences on what does not fit, one each."""
        sentences = []
        if self.mass > self.most_mass:
            sentences.append(
                f"The actuators weigh {1e3 * self.mass:.3g} g; {1e3 * self.most_mass:.3g} g are "
                "allowed for all."
            )
        if self.volume > self.most_volume:
            sentences.append(
                f"The actuators fill {1e6 * self.volume:.3g} cm³; {1e6 * self.most_volume:.3g} cm³ "
                "are allowed for all."
            )
        if not 0.5 <= self.area / self.wanted_area <= 2:
            sentences.append(
                f"The contactors span {1e4 * self.area:.3g} cm² where about "
                f"{1e4 * self.wanted_area:.3g} cm² are wanted."
            )
        return tuple(sentences)


# Friction below this share of the largest holds nothing.
_HELD = 1e-9


@si.checked_numbers
def held_forces(
    compliance: Annotated[si.FloatArray, si.Unit("m/N")],
    wanted: si.MetreArray,
    held: Annotated[si.NewtonArray, si.AtLeast(0.0)],
) -> si.NewtonArray:
    """The forces (N) of contactors that friction holds with at most `held` (N).

    `compliance` (contactors × contactors, m/N, symmetric and positive definite) is A, `wanted` (m)
    the way that sticking asks for. Raises `InputError` for shapes that do not fit,
    `OutOfRangeError` for a compliance that is not positive definite, and `ConvergenceError` where
    no forces are found.
    """
    si.require_alike(wanted=wanted, held=held)
    if compliance.shape != (wanted.size, wanted.size):
        raise InputError(
            f"compliance has the shape {compliance.shape}; {wanted.size} contactors have "
            f"{(wanted.size, wanted.size)}",
            quantity="compliance",
        )
    # Of all contactors, so that a compliance that is none is refused also where nothing slips.
    whole = np.linalg.cholesky(compliance)
    forces = np.asarray(cho_solve((whole, True), wanted), dtype=float)
    if np.all(np.abs(forces) <= held):
        return forces
    touching = held > _HELD * float(np.max(held, initial=0.0))
    forces = np.zeros(wanted.size)
    if not touching.any():
        return forces
    lower = np.linalg.cholesky(compliance[np.ix_(touching, touching)])
    limit = held[touching]
    # As least squares |Lᵀ F − L⁻¹ w|, in shares of each limit.
    solution = lsq_linear(
        lower.T * limit,
        solve_triangular(lower, wanted[touching], lower=True),
        bounds=(-1.0, 1.0),
        method="bvls",
        tol=1e-12,
    )
    if not solution.success:
        raise ConvergenceError(
            f"the forces of {touching.sum()} contactors that stick and slip were not found: "
            f"{solution.message}",
            iterations=int(solution.nit),
        )
    forces[touching] = solution.x * limit
    return forces


_M = si.Unit("m")
# Frozen, so that every array may share them.
_TISSUE, _PULP, _FINGERTIP = Tissue(), Tissue(shear_modulus=20e3), Fingertip()
ForceMatrix = Annotated[si.FloatArray, si.Unit("N/V")]


@si.checked_numbers
@dataclass(frozen=True)
class SkinStretchArray:
    """Bending actuators on a cradle under a fingertip: what `[skin_stretch]` of a file describes.

    `tissue` is what is pulled sideways, `pulp` what gives way when the finger is pressed on: a
    stiff skin on soft pulp is softer to a broad push than to a local pull, and one modulus will not
    do for both (20 kPa assumed, an order of magnitude). `normal_force` is that of the finger;
    `friction_coefficient` that of contactors on skin, which decides whether they stick (assumed).
    Raises `GeometryError` for actuators thicker or wider than the pitch leaves room for.
    """

    actuator: Bimorph
    cradle: FingerCradle
    tissue: Tissue = _TISSUE
    pulp: Tissue = _PULP
    finger: Fingertip = _FINGERTIP
    normal_force: Annotated[si.Newton, hard.FORCE] = 2.0
    friction_coefficient: Annotated[si.Dimensionless, si.Above(0), si.AtMost(20)] = 1.0

    def __post_init__(self) -> None:
        for name, side, pitch in (
            ("thick", self.actuator.thickness, self.cradle.pitch_along),
            ("wide", self.actuator.width, self.cradle.pitch_across),
        ):
            if side >= pitch:
                raise GeometryError(
                    f"actuators {si.format_quantity(side, _M)} {name} stand at a pitch of "
                    f"{si.format_quantity(pitch, _M)} and would touch; make them smaller or the "
                    "pitch larger",
                    quantity="actuator",
                )

    @property
    def bender(self) -> Bender:
        """Deflection, stiffness and resonance of one actuator."""
        return solid_bender(self.actuator)

    @functools.cached_property
    def influence(self) -> si.FloatArray:
        """Displacement of the skin under each contactor by a newton on one (m/N)."""
        return influence_matrix(self.tissue, *self.cradle.places, self.cradle.size)

    @functools.cached_property
    def force_per_volt(self) -> ForceMatrix:
        """The forces on the skin (N) per volt on each actuator that all stick, (C + 1/k)⁻¹ δ."""
        solved = np.linalg.solve(self._compliance, np.eye(self.cradle.count))
        return np.asarray(solved * self.bender.deflection_per_volt)

    @functools.cached_property
    def _compliance(self) -> si.FloatArray:
        """C + 1/k (m/N)."""
        return np.asarray(self.influence + np.eye(self.cradle.count) / self.bender.stiffness)

    @si.checked_numbers
    def strain_per_force(
        self, cell: Annotated[si.Metre, hard.SIDE] = 0.3e-3
    ) -> tuple[si.MetreArray, si.MetreArray, si.FloatArray]:
        """Edges of square cells along x and y (m), and the mean strains ε_xx, ε_yy, γ_xy in each
        per newton on each contactor, shape (3, cells x, cells y, contactors)."""
        x, y = self.cradle.places
        return strain_matrices(self.tissue, x, y, self.cradle.size, cell)

    @si.checked_numbers
    def answer(self, voltages: Annotated[si.FloatArray, si.Unit("V")]) -> ArrayPull:
        """Forces and displacements of all contactors at voltages (V), one an actuator, raised
        together from none; those that friction does not hold slip.

        Raises `InputError` for another number of voltages, `OutOfRangeError` for one that would
        undo the poling.
        """
        if voltages.shape != (self.cradle.count,):
            raise InputError(
                f"voltages of shape {voltages.shape} were given for {self.cradle.count} actuators; "
                "give one for each",
                quantity="voltages",
            )
        return self.answers(voltages[None, :])[0]

    @si.checked_numbers
    def answers(self, voltages: Annotated[si.FloatArray, si.Unit("V")]) -> tuple[ArrayPull, ...]:
        """`answer` to voltages (V) that follow one another, shape (instants, actuators): what has
        slid stays slid. Steps so small that a contactor slips one way in each; some milliseconds an
        instant where any slips.

        Raises as `answer`.
        """
        if voltages.ndim != 2 or voltages.shape[1] != self.cradle.count or not voltages.size:
            raise InputError(
                f"voltages of shape {voltages.shape} were given; give a row for each instant, with "
                f"{self.cradle.count} voltages, one for each actuator",
                quantity="voltages",
            )
        worst = float(voltages.flat[int(np.argmax(np.abs(voltages)))])
        self.actuator.require_voltage(worst)
        slid, pulls = np.zeros(self.cradle.count), []
        for row in voltages:
            wanted = self.bender.deflection_per_volt * row
            forces = held_forces(self._compliance, wanted - slid, self._held)
            left = wanted - slid - self._compliance @ forces
            # What sticks has nothing left but rounding.
            slid = slid + np.where(np.abs(forces) >= (1 - 1e-9) * self._held, left, 0.0)
            pulls.append(ArrayPull(row, forces, self.influence @ forces, self._held, slid))
        return tuple(pulls)

    @functools.cached_property
    def _held(self) -> si.FloatArray:
        """The friction that may hold each contactor (N)."""
        seated = seat(self.cradle, self.finger, self.pulp, self.normal_force)
        return np.asarray(self.friction_coefficient * seated.forces)

    @property
    def budget(self) -> Budget:
        """Mass, volume and surface against those of the published array."""
        actuator, count = self.actuator, self.cradle.count
        volume = count * actuator.length * actuator.width * actuator.thickness
        return Budget(count * actuator.mass, volume, self.cradle.active_area)

    @property
    def crosstalk_shares(self) -> si.DimensionlessArray:
        """Displacements that an actuator driven alone (column) gives the skin of the others (row),
        over its own, which stands as 0, with all others holding still as the springs they are."""
        moved = self.influence @ self.force_per_volt
        shares = np.abs(moved / np.diag(moved))
        np.fill_diagonal(shares, 0.0)
        return shares

    @property
    def crosstalk(self) -> si.Dimensionless:
        """Largest of the `crosstalk_shares`."""
        return float(self.crosstalk_shares.max(initial=0.0))


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class ArrayPull:
    """Pull of an array at some `voltages`: `forces` on the skin, `displacements` of the skin under
    the contactors, `held`, the friction that may hold each, and how far each has `slid`."""

    voltages: Annotated[si.FloatArray, si.Unit("V")]
    forces: si.NewtonArray
    displacements: si.MetreArray
    held: si.NewtonArray
    slid: si.MetreArray

    @property
    def slips(self) -> np.ndarray[tuple[int, ...], np.dtype[np.bool]]:
        """True of the contactors that pull with all of their friction."""
        return np.asarray(np.abs(self.forces) >= (1 - 1e-9) * self.held)

    @property
    def slipping(self) -> int:
        """Number of those."""
        return int(np.count_nonzero(self.slips))


@dataclass(frozen=True, repr=False)
class SkinStretchDescription(Result):
    """Content of a file with the table ``[skin_stretch]``; read one with `described.load_actuator`.

    Ceramic, shim and electrode may be named as materials of the library.
    """

    references: ClassVar[References] = References(
        original=lambda name: _preset(name),
        parts={
            "skin_stretch.actuator.ceramic": functools.partial(
                presets.materials.table, kind="ceramic"
            ),
            "skin_stretch.actuator.shim": functools.partial(
                presets.materials.table, kind="substrate"
            ),
            "skin_stretch.actuator.electrode": functools.partial(
                presets.materials.table, kind="substrate"
            ),
        },
    )

    name: str
    title: str
    skin_stretch: SkinStretchArray
    provenance: Mapping[str, Provenance] = field(
        default_factory=dict, metadata={"loader": True}, compare=False, repr=False
    )
    _shown: ClassVar[str] = "name title skin_stretch.cradle.count skin_stretch.normal_force"


def _preset(name: str) -> SkinStretchDescription:
    from squeezefilm.core import config

    return config.load(SkinStretchDescription, presets.resolve(name, "actuator"))
