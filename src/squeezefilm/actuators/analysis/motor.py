"""Results of `squeezefilm analyze` for a planar standing-wave motor."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np

from squeezefilm.actuators.analysis.drawn import DrawnAnswers, Usual, drawn_answers
from squeezefilm.actuators.motor.assembled import AssembledMotor, Working, assembled
from squeezefilm.actuators.motor.averaged import (
    AveragedMotor,
    averaged,
    free_amplitude,
    no_load_speed,
    stall_force,
)
from squeezefilm.actuators.motor.closed_loop import TrackedForce, inverted_law, track_force
from squeezefilm.actuators.motor.curves import (
    MotorMap,
    motor_map,
    over_foot_position,
    speed_force_curve,
)
from squeezefilm.actuators.motor.description import MotorDescription
from squeezefilm.actuators.motor.in_time import MotorMotion, simulate
from squeezefilm.actuators.motor.plane import PlaneMotion, simulate_plane
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, UnreachableError
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import Result, to_json, values_of

# Where the mean over a period is off by more than this of µ times the preload, it is warned of.
_APART = 0.05
_MAP, _RESOLVED = 10, 5
_PERIODS = 600
_DETUNED, _POINTS = 0.04, 29
_FREE, _FREE_STEPS = 4000, 64
_STEP = (0.3, 0.7)
_STEPS = 60
_Q = "motor.plate.quality_factor"
# None was measured on a motor. The plate's own frequency and shape are for its analysis as a
# display, and solving it for each draw would take minutes.
_USUAL = {
    "motor.contact.normal_stiffness": Usual(0.5, 1.5, "of foot, slider and contact; a guess"),
    "motor.contact.tangential_stiffness": Usual(
        0.5, 1.05, "up to Mindlin's 0.82 of the normal one; softer legs; a guess"
    ),
    "motor.contact.friction_coefficient": Usual(0.7, 1.3, "dry pairs scatter so; a guess"),
    "motor.contact.damping": Usual(0.0, 2.0, "from none to twice; a guess"),
    "motor.cradle.preload": Usual(0.95, 1.05, "as springs or weights are set; a guess"),
    "motor.cradle.friction": Usual(0.5, 1.5, "of a guide; a guess"),
    _Q: Usual(0.7, 1.3, "the losses of a bonded assembly; as for displays"),
}


@dataclass(frozen=True, eq=False, repr=False)
class MotorAnalysis(Result):
    """A motor at its voltage.

    Attributes:
        described: the motor as its file describes it.
        motor: with its plate solved.
        curve: from rest to no load.
        best: the point of it with the largest efficiency.
        map: over preload and amplitude, about those that it has.
        motion: resolved in time at the speed of `best`.
        resolved: speed (m/s) and force left for a load (N) of the motor resolved in time, from
            rest to no load, shape (speeds, 2).
        tracked: the force law's answer to a step, at that speed; None where a force cannot be
            commanded.
        drawn: stall force and speed without a load where what is uncertain is drawn together.
        tuned: at rest, at frequencies about the resonance.
        shifts, shifted: of all feet along the wave (m), and the motor at rest there; None over a
            node, or beside the plate.
        plane: the slider free in the plane from rest, both plates at the voltage; None without a
            second one.
        warnings: in sentences.
    """

    described: MotorDescription
    motor: AssembledMotor
    voltage: si.Volt
    curve: tuple[AveragedMotor, ...]
    best: AveragedMotor
    map: MotorMap
    motion: MotorMotion
    resolved: si.FloatArray
    tracked: TrackedForce | None
    drawn: DrawnAnswers
    tuned: tuple[AveragedMotor, ...]
    shifts: si.MetreArray
    shifted: tuple[AveragedMotor | None, ...]
    plane: PlaneMotion | None
    warnings: tuple[str, ...]
    _shown: ClassVar[str] = "described.name voltage stall_force no_load_speed"

    @property
    def rest(self) -> AveragedMotor:
        """The motor stalled."""
        return self.curve[0]

    @property
    def stall_force(self) -> si.Newton:
        """The load that just stops it (N)."""
        return self.rest.force

    @property
    def no_load_speed(self) -> si.MetrePerSecond:
        """Speed where nothing is left for a load (m/s)."""
        return self.curve[-1].speed

    @property
    def free_amplitude(self) -> si.Metre:
        """Amplitude of the lobe at this voltage without a slider (m)."""
        return free_amplitude(self.motor, Working(voltage=self.voltage))

    @property
    def input_power(self) -> si.Watt:
        """Input of the drive at `best` (W)."""
        return self.best.input_power

    @property
    def best_of_map(self) -> tuple[si.Dimensionless, si.Newton, si.Metre]:
        """The largest efficiency over preload and amplitude, and where (N, m)."""
        at = np.unravel_index(np.nanargmax(self.map.efficiency), self.map.efficiency.shape)
        values = self.map.efficiency[at], self.map.preload[at[0]], self.map.amplitude[at[1]]
        return float(values[0]), float(values[1]), float(values[2])

    @property
    def thrust_apart(self) -> si.Dimensionless:
        """Averaged less resolved thrust at the speed of `best`, over µ times the preload (1)."""
        described = self.motor.motor
        most = described.contact.friction_coefficient * described.cradle.preload
        return (self.best.thrust - self.motion.thrust) / most

    def summary(self) -> dict[str, Any]:
        """Numbers as plain JSON values, with units in the keys."""
        return {
            "actuator": self.described.name,
            "kind": "motor",
            "amplitude_under_the_slider_m": self.rest.amplitude,
            "holding_force_unpowered_N": self.motor.quiescent_force,
            **values_of(
                self,
                "voltage free_amplitude motor.motor.cradle.preload stall_force no_load_speed "
                "rest.contact_share input_power motion.energy_residual motor.highest_voltage "
                "drawn warnings",
            ),
            **values_of(self.motor.modes[0].working, "resonance_frequency quality_factor"),
            "best": to_json(self.best) | {"efficiency": self.best.efficiency},
            "best_of_map": dict(
                zip(("efficiency", "preload_N", "amplitude_m"), self.best_of_map, strict=True)
            ),
            "thrust_in_time_N": self.motion.thrust,
            "resolved_curve": [
                {"speed_m_per_s": speed, "force_N": force}
                for speed, force in self.resolved.tolist()
            ],
            "averaged_less_resolved_thrust": self.thrust_apart,
            "speed_force_curve": [
                values_of(point, "speed force efficiency") for point in self.curve
            ],
            "over_frequency": [
                values_of(point, "working.frequency force amplitude") for point in self.tuned
            ],
            "over_place_of_the_feet": [
                {"shift_m": shift, "force_N": None if shifted is None else shifted.force}
                for shift, shifted in zip(self.shifts.tolist(), self.shifted, strict=True)
            ],
            "velocity_in_the_plane_m_per_s": None
            if self.plane is None
            else self.plane.final_velocity.tolist(),
        }


@si.checked_numbers
def analyze_motor(
    described: MotorDescription,
    *,
    voltage: Annotated[si.Volt, si.Above(0.0)] | None = None,
    progress: SayProgress | None = None,
) -> MotorAnalysis:
    """A described motor at a voltage (V, zero-to-peak; its own if None): averaged, resolved in
    time at its best load, over preload and amplitude, and under its force law.

    Valid as the models are, see `averaged` and `simulate`. Raises what they raise:
    `OutOfRangeError` for a preload under which it stalls, a foot over a node, or a voltage at which
    the ceramic loses its poling.
    """
    tell = progress or (lambda _: None)
    volts = described.motor.voltage if voltage is None else voltage
    tell("modes of the plate")
    motor = assembled(described.motor)
    working = Working(voltage=volts)
    tell("speed and force")
    curve = speed_force_curve(motor, working)
    best = max(curve, key=lambda point: point.efficiency)
    tell("in time")
    motion = simulate(motor, working, speed=best.speed, periods=_PERIODS)
    resolved = _resolved(motor, working, curve)
    tell("preload and amplitude")
    cradle, amplitude = described.motor.cradle, curve[0].amplitude
    over = motor_map(
        motor,
        cradle.preload * np.geomspace(0.1, 2.5, _MAP),
        amplitude * np.linspace(0.2, 2.0, _MAP),
        progress=lambda done, of: None if done % _MAP else tell(f"{done} of {of} points"),
    )
    tell("frequency and place of the feet")
    tuned = _tuned(motor, volts)
    shifts, shifted = _shifted(motor, amplitude)
    tell("force law")
    tracked, why_not = _step(motor, best.speed, amplitude)
    tell("how sure that is")
    sure = drawn_answers(
        described,
        described.provenance,
        _USUAL,
        lambda drawn: _drawn(described, motor, drawn, volts),
        progress=lambda done, of: None if done % 16 else tell(f"{done} of {of} draws"),
    )
    analysis = MotorAnalysis(
        described,
        motor,
        volts,
        curve,
        best,
        over,
        motion,
        resolved,
        tracked,
        sure,
        tuned,
        shifts,
        shifted,
        _plane(motor, volts),
        (),
    )
    return dataclasses.replace(analysis, warnings=tuple(_warnings(analysis, why_not)))


def _tuned(motor: AssembledMotor, voltage: si.Volt) -> tuple[AveragedMotor, ...]:
    """Motors about the resonance, as far as the drive moves the plate under the slider."""
    motors = []
    for share in np.linspace(1 - _DETUNED, 1 + _DETUNED, _POINTS).tolist():
        working = Working(voltage=voltage, frequency=share * motor.resonance_frequency)
        try:
            motors.append(averaged(motor, working))
        except UnreachableError:
            continue
    return tuple(motors)


def _shifted(
    motor: AssembledMotor, amplitude: si.Metre
) -> tuple[si.MetreArray, tuple[AveragedMotor | None, ...]]:
    """Feet moved by up to half a wave to either side, at the amplitude that the motor has."""
    described, half = motor.motor, motor.modes[0].working.half_wavelength
    along_width = described.plate.lines_across == "width"
    places = [foot.y if along_width else foot.x for foot in described.feet]
    span = described.plate.width if along_width else described.plate.length
    shifts = np.linspace(max(-half, -min(places)), min(half, span - max(places)), 2 * _POINTS)
    return shifts, over_foot_position(described, Working(amplitude=amplitude), shifts)


def _plane(motor: AssembledMotor, voltage: si.Volt) -> PlaneMotion | None:
    if len(motor.modes) == 1:
        return None
    working = Working(voltage=voltage, second=1.0)
    return simulate_plane(motor, working, periods=_FREE, steps=_FREE_STEPS)


def _resolved(
    motor: AssembledMotor, working: Working, curve: tuple[AveragedMotor, ...]
) -> si.FloatArray:
    """Speed and force left for a load, in time, at every so many points of an averaged curve."""
    points = []
    for point in curve[:: len(curve) // _RESOLVED]:
        there = simulate(motor, working, speed=point.speed, periods=_PERIODS)
        points.append((point.speed, there.thrust - (point.thrust - point.force)))
    return np.array(points)


def _step(
    motor: AssembledMotor, speed: si.MetrePerSecond, amplitude: si.Metre
) -> tuple[TrackedForce | None, str]:
    """The force law's answer to a step between two shares of the largest force at a speed."""
    try:
        law = inverted_law(motor, np.array([speed]), amplitude * np.linspace(0.3, 1.0, 12))
    except InputError as error:
        return None, f"no force can be commanded at the best load's speed: {error}"
    low, high = (share * float(law.thrust.max()) for share in _STEP)
    wanted = np.repeat([low, high], _STEPS // 2)
    return track_force(motor, law, wanted, speed), ""


def _drawn(
    nominal: MotorDescription, solved: AssembledMotor, drawn: MotorDescription, voltage: si.Volt
) -> Mapping[str, float]:
    """The answers of a drawn motor on the solved plate; losses scale a mode at its resonance."""
    share = drawn.motor.plate.quality_factor / nominal.motor.plate.quality_factor
    modes = tuple(
        dataclasses.replace(
            mode,
            working=dataclasses.replace(
                mode.working,
                quality_factor=share * mode.working.quality_factor,
                amplitude_per_volt=share * mode.working.amplitude_per_volt,
            ),
        )
        for mode in solved.modes
    )
    motor, working = assembled(drawn.motor, modes=modes), Working(voltage=voltage)
    return {
        "stall_force_N": stall_force(motor, working),
        "no_load_speed_m_per_s": no_load_speed(motor, working),
    }


def _warnings(analysis: MotorAnalysis, why_no_force: str) -> list[str]:
    said = []
    if abs(analysis.thrust_apart) > _APART:
        said.append(
            f"At its best load the mean over a period gives {analysis.best.thrust:.3g} N and the "
            f"motion in time {analysis.motion.thrust:.3g} N: the slider jumps for several periods, "
            "which the mean does not know. Press it harder, or take the numbers in time."
        )
    share = analysis.voltage / analysis.motor.highest_voltage
    if share > 0.8:
        said.append(
            f"The voltage is {100 * share:.0f} % of that at which the ceramic begins to lose its "
            "poling."
        )
    if analysis.no_load_speed < 0:
        said.append("It moves against the direction that its cradle names: its feet push back.")
    return [*said, *([why_no_force] if why_no_force else [])]
