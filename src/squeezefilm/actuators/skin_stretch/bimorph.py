"""The bending actuator of a skin-stretch array: solved as a piezoelectric solid, and on the skin.

The published closed forms are those of a narrow beam, whose layers are each free across its width;
in a beam as wide as it is built one ceramic widens where the other narrows, and the narrow beam
deflects 7 to 11 % too much.
"""

from __future__ import annotations

import functools
import itertools
import math
from dataclasses import dataclass
from typing import Annotated, Literal, cast

import numpy as np

from squeezefilm.core import hard_limits as hard
from squeezefilm.core import quantities as si
from squeezefilm.core.blas_threads import one_blas_thread
from squeezefilm.core.errors import GeometryError, OutOfRangeError
from squeezefilm.core.materials import ElasticMaterial, Piezoceramic
from squeezefilm.physics.contact.finger.fingertip import FingerpadDynamics
from squeezefilm.physics.plate.elements.box_model import (
    BoxModel,
    ModelElectrode,
    isotropic_solid,
    piezoceramic_solid,
)
from squeezefilm.physics.plate.elements.lobatto import LineMesh, gauss_points
from squeezefilm.physics.plate.elements.slab_modes import SlabFactor, modes_near
from squeezefilm.physics.plate.elements.slabs import Slabs

Wiring = Literal["parallel", "series"]

LEAST_SLENDERNESS = 4.0
"""Length over width, and over thickness, from which beams are answered for: the rigid clamp is felt
over about a width, and at 10 widths adds some 2 % to the deflection by voltage."""

_M, _V = si.Unit("m"), si.Unit("V")


@si.checked_numbers
@dataclass(frozen=True)
class Bender:
    """Bending actuator as seen at its tip: `deflection_per_volt` (free, quasi-static) and
    `stiffness` and `resonance_frequency` with the voltage held; `capacitance` of the free
    actuator."""

    deflection_per_volt: Annotated[si.MetrePerVolt, si.Above(0)]
    stiffness: Annotated[si.NewtonPerMetre, si.Above(0)]
    resonance_frequency: Annotated[si.Hertz, si.Above(0)]
    capacitance: Annotated[si.Farad, si.Above(0)]

    @property
    def force_per_volt(self) -> si.NewtonPerVolt:
        """The blocked force at the tip."""
        return self.deflection_per_volt * self.stiffness

    @property
    def effective_mass(self) -> si.Kilogram:
        """k/(2π f1)²: the mass at the tip that resonates with its stiffness at f1."""
        return self.stiffness / (2 * math.pi * self.resonance_frequency) ** 2


@si.checked_numbers
@dataclass(frozen=True)
class Bimorph:
    """Two equal ceramics on a shim, clamped at one end; the free end pulls the skin.

    `length` is the free length. `wiring`: "parallel" puts the whole voltage on each ceramic (the
    shim is an electrode), "series" half of it. `electrode_thickness` is that of the metal on each
    outer face, of `electrode` (None: its stiffness and mass are neglected). A `shim_thickness` of 0
    is a bimorph without one. `depolarising_field` (V/m) is the field against its poling that a
    ceramic may see: soft ceramics lose their poling at some 0.5 kV/mm (assumed: a typical figure,
    take the maker's); one of the two ceramics is always driven against it. `loss_tangent` (1) is
    dielectric, at the voltage used (assumed 2 %, small signals; strong fields double or treble it).

    Raises `GeometryError` for a beam too short for its width or thickness.
    """

    length: Annotated[si.Metre, hard.SIDE]
    width: Annotated[si.Metre, hard.SIDE]
    ceramic: Piezoceramic
    ceramic_thickness: Annotated[si.Metre, hard.LAYER]
    shim: ElasticMaterial
    shim_thickness: Annotated[si.Metre, si.AtLeast(0), si.AtMost(hard.LAYER.most)] = 0.0
    wiring: Wiring = "parallel"
    electrode: ElasticMaterial | None = None
    electrode_thickness: Annotated[si.Metre, si.AtLeast(0), si.AtMost(hard.LAYER.most)] = 0.0
    depolarising_field: Annotated[si.VoltPerMetre, si.Above(0)] = 5e5
    loss_tangent: Annotated[si.Dimensionless, si.AtLeast(0), si.Below(1)] = 0.02

    def __post_init__(self) -> None:
        for name, across in (("width", self.width), ("thickness", self.thickness)):
            if self.length < LEAST_SLENDERNESS * across:
                raise GeometryError(
                    f"a bending actuator of length {si.format_quantity(self.length, _M)} has a "
                    f"{name} of {si.format_quantity(across, _M)}; as a beam it must be at least "
                    f"{LEAST_SLENDERNESS:.0f} times as long: make it longer, or that smaller"
                )

    @property
    def thickness(self) -> si.Metre:
        """Thickness of all layers together."""
        return 2 * (self.ceramic_thickness + self.electrode_thickness) + self.shim_thickness

    @property
    def ceramic_share(self) -> si.Dimensionless:
        """The voltage of one ceramic over that of the actuator: 1 in parallel, 1/2 in series."""
        return 1.0 if self.wiring == "parallel" else 0.5

    @property
    def mass(self) -> si.Kilogram:
        """Mass of the free length; electrodes without a material are left out."""
        layers = 2 * self.ceramic.density * self.ceramic_thickness
        layers += self.shim.density * self.shim_thickness
        if self.electrode is not None:
            layers += 2 * self.electrode.density * self.electrode_thickness
        return layers * self.length * self.width

    @property
    def largest_voltage(self) -> si.Volt:
        """The voltage at which the ceramic driven against its poling sees `depolarising_field`."""
        return self.depolarising_field * self.ceramic_thickness / self.ceramic_share

    @si.checked_numbers
    def require_voltage(self, voltage: si.Volt) -> None:
        """Refuse a voltage (V, either sign) that undoes the poling. Raises `OutOfRangeError`."""
        if abs(voltage) > self.largest_voltage:
            field = abs(voltage) * self.ceramic_share / self.ceramic_thickness
            raise OutOfRangeError(
                f"a voltage of {si.format_quantity(voltage, _V)} puts {field / 1e6:.3g} kV/mm on a "
                f"ceramic of {si.format_quantity(self.ceramic_thickness, _M)} against its poling; "
                f"at most {self.depolarising_field / 1e6:.3g} kV/mm is allowed, which is "
                f"{si.format_quantity(self.largest_voltage, _V)}: lower it, or take thicker "
                "ceramics",
                quantity="voltage",
            )


_GRADED = (0.1, 0.5, 2.0)
"""Element edges near the clamp, in thicknesses and in widths; with the orders below the deflection
of a usual section changes by less than 1e-3 if every order is raised by two (a test checks it)."""

MOST_SLENDER = 320.0
"""Length over thickness up to which digits are kept: at 300 raising all orders by four moves the
deflection by 2e-3, at 640 by 8 %."""


@si.checked_numbers
def solid_bender(
    actuator: Bimorph, more: Annotated[int, si.AtLeast(0), si.AtMost(6)] = 0
) -> Bender:
    """Deflection, stiffness, resonance and capacitance of a bending actuator in three dimensions.

    `more` raises the order of every element, to see what is left of their error. Electrodes' own
    thickness is neglected. Takes some tenths of a second. Raises `OutOfRangeError` for an actuator
    longer than `MOST_SLENDER` thicknesses.
    """
    if actuator.length > MOST_SLENDER * actuator.thickness:
        raise OutOfRangeError(
            f"an actuator {actuator.length / actuator.thickness:.0f} times as long as thick was "
            f"asked for as a solid, whose elements lose their digits above {MOST_SLENDER:.0f}; "
            "shorten it, or make its layers thicker",
            quantity="length",
        )
    return _solved(actuator, more)


# Its blocks are too small to gain by a second thread.
@functools.lru_cache(maxsize=8)
@one_blas_thread()
def _solved(actuator: Bimorph, more: int) -> Bender:
    slabs = Slabs(_boxes(actuator, more))
    solve = SlabFactor(slabs, 0.0).solve
    G, C = slabs.electrode_columns
    drive = np.full(2, actuator.ceramic_share)
    tip = _end_face(slabs)
    answers = solve(np.stack([-(G @ drive), tip], axis=1))
    charge = -drive @ (G.T @ answers[:, 0] + C @ drive)
    lowest = modes_near(
        slabs, solve, 0.0, lambda values: np.argsort(values)[:1], answers[:, 1:], tolerance=1e-8
    )
    # Half of the width was solved: a newton on it is two on the whole.
    return Bender(
        abs(float(tip @ answers[:, 0])),
        2 / float(tip @ answers[:, 1]),
        float(np.sqrt(np.min(lowest.values)) / (2 * np.pi)),
        2 * float(charge),
    )


def _boxes(actuator: Bimorph, more: int) -> BoxModel:
    length, width, thickness = actuator.length, actuator.width, actuator.thickness
    # What the clamp disturbs decays over the larger of thickness and width, from the smaller.
    near = sorted({at * side for at in _GRADED for side in (thickness, width)})
    near = [at for at in near if at < 0.3 * length]
    x = LineMesh((0.0, *near, 0.5 * length, length), (*(4 + more,) * len(near), *(6 + more,) * 2))
    # The free side has a layer as thick as the plate in which its ceramics strain apart.
    edge = thickness if width > 2.5 * thickness else 0.5 * width
    sides = (0.0, width / 2 - edge, width / 2) if edge < 0.5 * width else (0.0, width / 2)
    y = LineMesh(sides, (5 + more,) * (len(sides) - 1))
    own, shim = actuator.ceramic_thickness, actuator.shim_thickness
    # Of a beam much narrower than its ceramics they strain apart within a width of the middle.
    split = [own - width, width] if 2 * width < own else [own]
    heights = [*split, *([shim] if shim > 0 else []), *split[::-1]]
    pieces, core = len(split), [-1] * (shim > 0)
    numbers = [*(0,) * pieces, *core, *(1,) * pieces]
    z = LineMesh((0.0, *itertools.accumulate(heights)), (4 + more,) * len(heights))
    shape = (x.elements, y.elements, len(heights))
    inner = int(z.first_node[pieces]), int(z.first_node[len(heights) - pieces])
    return BoxModel(
        x,
        y,
        z,
        (piezoceramic_solid(actuator.ceramic, 0.0), isotropic_solid(actuator.shim, 0.0)),
        np.broadcast_to(np.array([1 if number < 0 else 0 for number in numbers]), shape).copy(),
        np.broadcast_to(np.array(numbers), shape).copy(),
        (ModelElectrode(0, inner[0]), ModelElectrode(z.nodes.size - 1, inner[1])),
        ("clamped", "free", "symmetric", "free"),
    )


def _end_face(slabs: Slabs) -> si.FloatArray:
    """Row that takes a solution to the mean deflection of the end face; it is also the load of one
    newton spread over that face."""
    points, weights = gauss_points(12)
    means = []
    for mesh in (slabs.model.y, slabs.model.z):
        total = np.zeros(mesh.nodes.size)
        for a, b in itertools.pairwise(mesh.edges):
            at = a + (b - a) * (points + 1) / 2
            total += weights @ mesh.interpolation(at, hierarchic=True) * (b - a) / 2
        means.append(total / (mesh.edges[-1] - mesh.edges[0]))
    component, iy, iz = slabs.parts[-1]
    out = np.zeros(slabs.unknowns)
    out[slabs.offsets[-2] :] = np.where(component == 2, means[0][iy] * means[1][iz], 0.0)
    return out


# The actuator gives way as a spring: F = F_blocked − k x. The skin under one contactor is the
# contact room's lumped fingertip (`FingerpadDynamics`: stiffness, damping, mass), here of one
# contactor.
#
# What is published of the skin and could be read: it is linearly viscoelastic in loading and
# relaxes for 12 s with the logarithm of time, and its stiffness grows with the normal force
# (Pataky, Latash and Zatsiorsky 2005, J. Biomech. 38(7) 1441–1449, abstract); under large local
# traction it stiffens, is more elastic across its ridges, and loses 80 % in a cycle (Wang and
# Hayward 2007, J. Biomech. 40(4) 851–860, abstract). No number of newtons per metre could be read
# there: `IMPLIED_STIFFNESS` follows from what the source paper says of its array.
PUBLISHED_FREE: si.Metre = 0.1e-3
PUBLISHED_BLOCKED: si.Newton = 0.15
PUBLISHED_LOADED: si.Metre = 0.075e-3
"""Deflection of each of the paper's 60 actuators: free, blocked, and against a load whose force
stands in no text that could be read (the sentence breaks off after "0.075 mm and")."""

IMPLIED_STIFFNESS: si.NewtonPerMetre = 500.0
"""The skin's stiffness that a linear actuator of the three figures above works against: derived,
0.15 N (1 − 0.075/0.1) = 0.0375 N at 0.075 mm."""


@si.closed_form(positive="free_deflection actuator_stiffness", nonnegative="load_stiffness")
def loaded_deflection(
    free_deflection: si.MetreLike,
    actuator_stiffness: si.NewtonPerMetreLike,
    load_stiffness: si.NewtonPerMetreLike,
) -> si.MetreLike:
    """x = δ k/(k + k_s): where a linear actuator's load line meets that of a spring (m).

    Arguments (m, N/m, N/m) broadcast; the force there is k_s x. Raises `InputError` for a
    deflection or an actuator's stiffness not above 0, or a negative load. Source: statics.
    """
    return free_deflection * actuator_stiffness / (actuator_stiffness + load_stiffness)


@si.checked_numbers
@dataclass(frozen=True)
class LoadedTip:
    """An actuator with the skin at its tip: quasi-static `deflection` and `force` on the skin,
    `resonance_frequency` (undamped) and `bandwidth`, up to which the deflection stays within 3 dB
    of the quasi-static one; one mode, so for frequencies below the actuator's second (6 times its
    first)."""

    deflection: si.Metre
    force: si.Newton
    resonance_frequency: si.Hertz
    bandwidth: si.Hertz


@si.checked_numbers
def loaded_tip(bender: Bender, load: FingerpadDynamics, voltage: si.Volt) -> LoadedTip:
    """Tip of an actuator on the skin at a voltage (V, either sign).

    Whether the voltage undoes the poling is asked of `Bimorph.require_voltage`.
    """
    free = bender.deflection_per_volt * voltage
    x = math.copysign(
        float(loaded_deflection(abs(free), bender.stiffness, load.stiffness)) if free else 0.0, free
    )
    stiffness, mass = bender.stiffness + load.stiffness, bender.effective_mass + load.mass
    square = stiffness / mass
    damping = (load.damping / mass) ** 2
    crossings = []
    # |K/(K − Mω² + icω)|² is 1/2 or 2: two quadratics in ω², of which the least root counts.
    for share in (2.0, 0.5):
        middle, rest = damping - 2 * square, square**2 * (1 - share)
        root = middle**2 - 4 * rest
        if root >= 0:
            crossings += [(-middle - math.sqrt(root)) / 2, (-middle + math.sqrt(root)) / 2]
    first = min((crossing for crossing in crossings if crossing > 0), default=math.nan)
    return LoadedTip(
        x,
        load.stiffness * x,
        math.sqrt(square) / (2 * math.pi),
        math.sqrt(first) / (2 * math.pi),
    )


@si.checked_numbers
def tip_motion(
    bender: Bender,
    load: FingerpadDynamics,
    voltage: si.Volt,
    frequency: Annotated[si.HertzArray, si.AtLeast(0)],
) -> si.ComplexArray:
    """The complex amplitude of the tip (m) at frequencies (Hz) of a sinusoidal voltage (V).

    δ k/(k + k_s − (m + m_s) ω² + iωc), in the shape of `frequency`. One mode.
    """
    omega = 2 * np.pi * frequency
    mass = bender.effective_mass + load.mass
    dynamic = bender.stiffness + load.stiffness - mass * omega**2 + 1j * omega * load.damping
    drive = bender.deflection_per_volt * voltage * bender.stiffness
    return cast(si.ComplexArray, np.asarray(drive / dynamic))
