"""A motor ready to be computed: its plate solved, its feet on the solved shape, and its modes, feet
and slider as the plain arrays and numbers that compiled code takes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from squeezefilm.actuators.motor.description import Motor
from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import compiled
from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.warming import FIELD_SHARE
from squeezefilm.physics.plate.working_mode import PlateTheory, WorkingMode, working_mode


@si.checked_numbers
class Stator(NamedTuple):
    """Modes of a stator, of each: modal mass (kg), stiffness (N/m), damping (N·s/m), amplitude of
    the drive's force (N), angular frequency (rad/s), phase (rad), and the amplitude (m) at which it
    is held where `held` is 1. `bend` (1/m), `cube` (1/m²) and `rise` (1/m) are what the freely
    vibrating plate adds: see `spring_at` and `damping_at`."""

    mass: si.FloatArray
    stiffness: si.FloatArray
    damping: si.FloatArray
    force: si.FloatArray
    omega: si.FloatArray
    phase: si.FloatArray
    amplitude: si.FloatArray
    bend: si.FloatArray
    cube: si.FloatArray
    rise: si.FloatArray
    held: bool


@si.checked_numbers
class Feet(NamedTuple):
    """Feet, of each and each mode the motion across and along the face for 1 m of the mode, (feet,
    modes); per foot the stiffnesses (N/m), χ (s/m) and µ."""

    across: si.FloatArray
    along: si.FloatArray
    k_nn: si.FloatArray
    k_nt: si.FloatArray
    k_tt: si.FloatArray
    chi: si.FloatArray
    mu: si.FloatArray


@si.checked_numbers
class Slider(NamedTuple):
    """Mass (kg), preload (N), damping of the guide across (N·s/m), its dry friction along (N), the
    load against +x (N), and whether the speed along is imposed."""

    mass: float
    preload: float
    damping: float
    guide: float
    load: float
    imposed: bool


@compiled()
def spring_at(stator: Stator, j: int, q: float) -> float:
    """The stiffness (N/m) of a mode at its deflection q (m): k (1 + bend |q| + cube q²), a spring
    that keeps its energy."""
    return float(stator.stiffness[j] * (1.0 + stator.bend[j] * abs(q) + stator.cube[j] * q * q))


@compiled()
def mode_energy(stator: Stator, q: si.Array, speed: si.Array) -> float:
    """Kinetic and elastic energy (J) of all modes at deflections (m) and speeds (m/s)."""
    energy = 0.0
    for j in range(q.size):
        size = abs(q[j])
        bent = 0.5 + stator.bend[j] * size / 3.0 + stator.cube[j] * size * size / 4.0
        energy += 0.5 * stator.mass[j] * speed[j] ** 2 + stator.stiffness[j] * size * size * bent
    return energy


@compiled()
def damping_at(stator: Stator, j: int, q: float, speed: float) -> float:
    """The damping (N·s/m) of a mode at deflection (m) and speed (m/s): it rises with the amplitude
    that these two make."""
    return float(
        stator.damping[j] * (1.0 + stator.rise[j] * math.hypot(q, speed / stator.omega[j]))
    )


@compiled(error_model="numpy")
def _yielding(
    depth: float, pull: float, Fx: float, limit: float, springs: tuple[float, float, float]
) -> float:
    """The share that friction leaves of a tangential force that is too large.

    In its own direction, back to where it is `limit` times the elastic normal force, which a
    leaning leg loses or gains as it yields.
    """
    k_nn, k_nt, k_tt = springs
    own = (k_nn - k_nt * k_nt / k_tt) * depth
    return limit * own / (pull - limit * k_nt * Fx / k_tt)


@compiled(error_model="numpy")
def followed(
    i: int, feet: Feet, depth: float, speed: float, moved: tuple[float, float], stretch: si.Array
) -> tuple[float, float, float, float, float]:
    """A foot pressed in by `depth` (m, at `speed`, m/s) that `moved` (m) along and sideways in an
    instant: its forces along and sideways, its elastic normal force (N), and how far it slipped
    along and sideways (m). `stretch` (feet, 2) follows: as it would stick, and back to the limit,
    along the force, where that is more than friction gives."""
    k_nn, k_nt, k_tt = feet.k_nn[i], feet.k_nt[i], feet.k_tt[i]
    limit = feet.mu[i] * (1.0 + feet.chi[i] * speed)
    ex, ey = stretch[i, 0] + moved[0], stretch[i, 1] + moved[1]
    Fx, Fy = k_nt * depth + k_tt * ex, k_tt * ey
    pull = math.hypot(Fx, Fy)
    slip_x, slip_y = 0.0, 0.0
    if pull > limit * (k_nn * depth + k_nt * ex):
        back = _yielding(depth, pull, Fx, limit, (k_nn, k_nt, k_tt))
        Fx, Fy = back * Fx, back * Fy
        slip_x, slip_y = ex - (Fx - k_nt * depth) / k_tt, ey - Fy / k_tt
        ex, ey = ex - slip_x, ey - slip_y
    stretch[i, 0], stretch[i, 1] = ex, ey
    return Fx, Fy, k_nn * depth + k_nt * ex, slip_x, slip_y


@dataclass(frozen=True, eq=False)
class FaceMode:
    """A plate's working mode on the middle line of its free face, along its wave.

    `across` and `along` are the motions at `position` (m) for a mode of 1 at its lobe. The mode is
    taken alike along its nodal lines: feet far from the middle line move as those on it.
    `along_width` says that the wave runs along the plate's width.
    """

    working: WorkingMode
    position: si.MetreArray
    across: si.FloatArray
    along: si.FloatArray
    along_width: bool

    @property
    def modal_mass(self) -> si.Kilogram:
        """Modal mass for 1 m at the mode's lobe (kg)."""
        mass = self.working.modal_mass
        assert mass is not None  # every plate's mode has one
        return mass

    @si.checked_numbers
    def at(
        self, place: Annotated[si.MetreArray, si.AtLeast(0.0)]
    ) -> tuple[si.FloatArray, si.FloatArray]:
        """The motion across and along at places on the wave's line (m, from the plate's edge)."""
        si.require("place", place, si.Unit("m"), at_most=float(self.position[-1]) + 1e-9)
        return (
            np.asarray(CubicSpline(self.position, self.across)(place)),
            np.asarray(CubicSpline(self.position, self.along)(place)),
        )


def face_mode(plate: RectangularPlate, theory: PlateTheory = "solid") -> FaceMode:
    """The working mode of a plate on its free face, see `FaceMode`.

    Raises what `working_mode` raises, and `OutOfRangeError` for a mode without a shape.
    """
    mode = working_mode(plate, theory)
    wide = plate.lines_across == "width"
    if mode.solid is not None:
        solid = mode.solid
        x, middle = solid.position, np.array([(plate.length if wide else plate.width) / 2])
        lengths, widths = (middle, x) if wide else (x, middle)
        field = solid.modes.field(solid.index, lengths, widths, plate.thickness)
        line = field[0] if wide else field[:, 0]
        scale = line[int(np.argmin(np.abs(x - mode.lobe[1 if wide else 0]))), 2]
        along = np.real(line[:, 1 if wide else 0] / scale)
        return FaceMode(mode, x, np.real(line[:, 2] / scale), along, wide)
    beam = mode.beam
    if beam is None or mode.line is None:
        raise OutOfRangeError(f"the model '{mode.model}' has no shape over the face")
    # The feet stand on the substrate: what is bonded beside them lies above that face.
    h = beam.section.neutral_axis - plate.ceramic_thickness_on("top")
    shape = beam.mode
    top = float(shape.deflection_at(mode.lobe[1 if wide else 0]))
    return FaceMode(mode, shape.position, shape.deflection / top, -h * shape.rotation / top, wide)


_M, _V = si.Unit("m"), si.Unit("V")
# A foot that moves less than this share of the lobe stands over a node.
_NODE = 0.05


@si.checked_numbers
@dataclass(frozen=True)
class Working:
    """State in which a motor is driven, pressed and held.

    Either `voltage` (V) drives the modes, which the feet then load, or they are held at `amplitude`
    (m, zero-to-peak at the lobe), as a loop around the amplitude does. With two modes `second` is
    the share of that which the second gets. `frequency` (Hz) is of the first mode (at its resonance
    without one), the second is at its own resonance. `preload` (N) stands in place of the cradle's,
    `load` (N) is a force against the motion along.
    """

    amplitude: Annotated[si.Metre, si.Above(0.0), si.AtMost(1e-4)] | None = None
    voltage: Annotated[si.Volt, si.AtLeast(0.0), si.AtMost(1e4)] | None = None
    frequency: Annotated[si.Hertz, si.Above(0.0), si.AtMost(1e7)] | None = None
    preload: Annotated[si.Newton, si.Above(0.0), si.AtMost(1e5)] | None = None
    load: Annotated[si.Newton, si.AtLeast(-1e5), si.AtMost(1e5)] = 0.0
    second: Annotated[si.Dimensionless, si.AtLeast(-10.0), si.AtMost(10.0)] = 0.0

    def __post_init__(self) -> None:
        if (self.amplitude is None) == (self.voltage is None):
            raise InputError(
                "a motor is driven by a voltage or held at an amplitude: give one of the two"
            )


@dataclass(frozen=True, eq=False)
class AssembledMotor:
    """A described motor with its one or two modes; make one with `assembled`."""

    motor: Motor
    modes: tuple[FaceMode, ...]
    feet: Feet
    sideways: si.Array

    @property
    def resonance_frequency(self) -> si.Hertz:
        """Resonance frequency of the first mode without the slider (Hz)."""
        return self.modes[0].working.resonance_frequency

    @property
    def highest_voltage(self) -> si.Volt:
        """Voltage at which the field in the thinnest ceramic reaches the share of the coercive
        field that ceramics bear again and again (V)."""
        thinnest = min(patch.thickness for patch in self.motor.plate.patches)
        return FIELD_SHARE * self.motor.thermal.coercive_field * thinnest

    @property
    def quiescent_force(self) -> si.Newton:
        """Force that moves the slider at rest, unpowered (N): friction of feet and guide."""
        cradle = self.motor.cradle
        return self.motor.contact.friction_coefficient * cradle.preload + cradle.friction

    @si.checked_numbers
    def stator(self, working: Working, *, held: bool | None = None) -> Stator:
        """The modes under a drive, for the kernels. With `held` an amplitude is wanted in any case.

        Raises `InputError` for a voltage at which the ceramic loses its poling, or a second mode
        where the motor has none.
        """
        if working.second and len(self.modes) == 1:
            raise InputError(
                "a share for the second mode was asked for, and the motor has no second_plate",
                quantity="second",
            )
        voltage = working.voltage
        if voltage is not None and voltage > self.highest_voltage:
            raise OutOfRangeError(
                f"voltage is {si.format_quantity(voltage, _V)}; from "
                f"{si.format_quantity(self.highest_voltage, _V)} on the field in the ceramic is "
                f"above {FIELD_SHARE:.2g} of its coercive field, and it loses its poling: use "
                "less, a thicker ceramic, or state its coercive_field in [motor.thermal]",
                quantity="voltage",
            )
        shares = np.array([1.0, working.second])[: len(self.modes)]
        mass = np.array([mode.modal_mass for mode in self.modes])
        own = 2 * np.pi * np.array([mode.working.resonance_frequency for mode in self.modes])
        loss = np.array([1 / mode.working.quality_factor for mode in self.modes])
        per_volt = np.array([mode.working.amplitude_per_volt for mode in self.modes])
        omega = own.copy()
        if working.frequency is not None:
            omega[0] = 2 * np.pi * working.frequency
        is_held = voltage is None if held is None else held
        amplitude = shares * (working.amplitude or 0.0)
        force = shares * (voltage or 0.0) * per_volt * mass * own**2 * loss
        if voltage is not None:
            amplitude = force / np.hypot(mass * (own**2 - omega**2), mass * own * omega * loss)
        bend, cube, rise = self.motor.free_plate.terms(float(np.max(np.abs(amplitude), initial=0)))
        ones = np.ones(mass.size)
        return Stator(
            mass,
            mass * own**2,
            mass * own * loss,
            force,
            omega,
            np.zeros(mass.size),
            amplitude,
            bend * ones,
            cube * ones,
            rise * ones,
            is_held,
        )

    def slider(self, working: Working, *, imposed: bool) -> Slider:
        """The slider for the kernels; with `imposed` its speed along stays as it is."""
        cradle = self.motor.cradle
        preload = cradle.preload if working.preload is None else working.preload
        return Slider(
            self.motor.slider_mass, preload, cradle.damping, cradle.friction, working.load, imposed
        )


def assembled(
    motor: Motor, theory: PlateTheory = "solid", modes: tuple[FaceMode, ...] | None = None
) -> AssembledMotor:
    """The motor with its plate solved (see `working_mode` for the theories) and its feet on it; on
    `modes` that are known the plate is not solved again.

    Raises `OutOfRangeError` for a foot over a node of every mode, a leg that jams, and what the
    solvers raise.
    """
    plates = [motor.plate] if motor.second_plate is None else [motor.plate, motor.second_plate]
    if modes is None:
        modes = tuple(face_mode(plate, theory) for plate in plates)
    x, y = np.array([foot.x for foot in motor.feet]), np.array([foot.y for foot in motor.feet])
    across, along, sideways = (np.zeros((x.size, len(modes))) for _ in range(3))
    c, s = math.cos(motor.cradle.direction), math.sin(motor.cradle.direction)
    for j, mode in enumerate(modes):
        across[:, j], moved = mode.at(y if mode.along_width else x)
        along[:, j] = moved * (s if mode.along_width else c)
        sideways[:, j] = moved * (c if mode.along_width else -s)
    for i in range(x.size):
        if np.max(np.abs(across[i])) < _NODE:
            raise _over_a_node(i, motor, modes, float(np.max(np.abs(across[i]))))
    contact = motor.contact
    springs = np.array([contact.stiffnesses(foot.inclination) for foot in motor.feet])
    count = np.ones(x.size)
    k_nn, k_nt, k_tt = (np.ascontiguousarray(spring) for spring in springs.T)
    feet = Feet(
        across,
        along,
        k_nn,
        k_nt,
        k_tt,
        contact.damping * count,
        contact.friction_coefficient * count,
    )
    return AssembledMotor(motor, modes, feet, sideways)


def _over_a_node(
    i: int, motor: Motor, modes: tuple[FaceMode, ...], moves: float
) -> OutOfRangeError:
    mode, foot = modes[0], motor.feet[i]
    line = mode.working.line
    nodes = np.array([]) if line is None else line.nodal_positions
    at = foot.y if mode.along_width else foot.x
    near = nodes[np.argmin(np.abs(nodes - at))] if nodes.size else at
    return OutOfRangeError(
        f"foot {i + 1} stands at {si.format_quantity(at, _M)}, over a nodal line (at "
        f"{si.format_quantity(float(near), _M)}): it moves {100 * moves:.2g} % of the antinode and "
        "never leaves the slider; put it between a node and an antinode, at least "
        f"{si.format_quantity(0.1 * mode.working.half_wavelength, _M)} from the node",
        quantity="feet",
    )
