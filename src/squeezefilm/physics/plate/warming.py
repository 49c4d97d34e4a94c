"""Warming of a driven plate, and what that costs: at a fixed frequency, and where it follows.

First order in time, C dθ/dt = P(θ) − G(θ) θ, one temperature for ceramic and substrate. At a fixed
frequency the resonance moves away (or nearer) as the plate warms, which changes P: the state is
where both agree, and there may be several.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Annotated

from squeezefilm.core import quantities as si
from squeezefilm.physics.plate.beam_response import patch_capacitance
from squeezefilm.physics.plate.heat_states import (
    ASSUMED_EMISSIVITY,
    HOTTEST,
    HeatSource,
    WarmCase,
    WarmState,
    conductance,
    drifts_of,
    lost,
    warmth_ranges,
)
from squeezefilm.physics.plate.layout import Actuator, RectangularPlate
from squeezefilm.physics.plate.thermal import (
    LOSS_TANGENT,
    Thermal,
    ThermalBody,
    driven_thickness,
    thermal_body,
)
from squeezefilm.physics.plate.working_mode import WorkingMode

HARD_QUALITY = 200.0
"""Quality factor from which a ceramic counts as hard (assumed)."""
HARD_SPEED: si.MetrePerSecond = 0.3
"""R.m.s. speed at which hard ceramics level off: materials of more than 1 m/s have ten times the
power density of commercial hard ones (Uchino et al. 2006, 10.1007/s10853-005-7201-0), and power
goes with the square of the speed. Of the ceramic alone: a bending plate strains differently."""
SOFT_SPEED: si.MetrePerSecond = 0.1
"""Speed for soft ceramics (assumed, no figure found; at a tenth of the Q as much heat per
volume)."""
FIELD_SHARE = 1 / 3
"""Share of the coercive field from which a drive is warned of (assumed)."""
KNOWN_RISE: si.Kelvin = 60.0
"""Largest warmth up to which coefficients are taken to stay what they are (assumed)."""


@dataclass(frozen=True)
class Warming:
    """Effect of warmth on a driven plate without a finger.

    `frequency` is the drive's; `cold_amplitude` and `cold_power` are those there when it is
    switched on. `tracked` is the state where the frequency follows the resonance, `fixed` the one
    reached from cold where it does not, `other_fixed` the further stable ones there.
    `thermal_resistance` and `thermal_time` are at the tracked state.
    `rise_range` (K) and `drift_range` (Hz) are those of the tracked state over `EMISSIVITIES`
    where neither resistance nor emissivity is told (else no `rise_range`) and over
    `COEFFICIENT_SHARES` of the temperature coefficient, lower end first. `time_to_fall` is when
    the amplitude at the fixed frequency has fallen by a tenth, None where it does not. `speed`
    (r.m.s.) and `field` are at the resonance, cold. `assumed` and `doubts` are for people.
    """

    frequency: si.Hertz
    half_bandwidth: si.Hertz
    cold_amplitude: si.Metre
    cold_power: si.Watt
    thermal_resistance: si.KelvinPerWatt
    heat_capacity: si.JoulePerKelvin
    thermal_time: si.Second
    tracked: WarmState
    fixed: WarmState
    other_fixed: tuple[WarmState, ...]
    time_to_fall: si.Second | None
    speed: si.MetrePerSecond
    field: si.VoltPerMetre | None
    assumed: tuple[str, ...]
    doubts: tuple[str, ...]
    rise_range: tuple[si.Kelvin, si.Kelvin] | None = None
    drift_range: tuple[si.Hertz, si.Hertz] | None = None


@si.checked_numbers
def heat_source(
    actuator: Actuator,
    voltage: Annotated[si.Volt, si.AtLeast(0.0)],
    frequency: Annotated[si.Hertz, si.Above(0.0)],
    quality_factor: Annotated[si.Dimensionless, si.Above(0.5)],
    amplitude: Annotated[si.Metre, si.AtLeast(0.0)],
    mechanical_power: Annotated[si.Watt, si.AtLeast(0.0)],
) -> HeatSource:
    """A mode of an actuator at a voltage (V, zero-to-peak), as a source of heat.

    The dielectric loss ½ ω C tan δ V² is that of a rectangular plate's ceramics, with an assumed
    tan δ of `LOSS_TANGENT`; of others it is not counted (a percent or two of the mechanical one).
    """
    dielectric, quality = 0.0, None
    if isinstance(actuator, RectangularPlate):
        current = 2 * math.pi * frequency * patch_capacitance(actuator) * voltage
        dielectric = 0.5 * current * voltage * LOSS_TANGENT
    thickness = driven_thickness(actuator)
    if thickness is not None and hasattr(actuator, "ceramic"):
        quality = actuator.ceramic.quality_factor
    field = None if thickness is None else voltage / thickness
    return HeatSource(
        frequency, quality_factor, amplitude, mechanical_power, dielectric, quality, field
    )


@si.checked_numbers
def warming(
    source: HeatSource,
    actuator: Actuator,
    thermal: Thermal | None = None,
    frequency: Annotated[si.Hertz, si.Above(0.0)] | None = None,
) -> Warming:
    """Effect of warmth on a plate that is driven at a constant voltage.

    `frequency` (Hz) is the fixed one; the cold resonance without one. Coefficients are constant,
    which holds for some tens of kelvin, and neighbouring modes are left out. The plate is of one
    temperature, horizontal, free in still air: supports, leads, housing and finger take nothing.
    Equations and sources: `squeezefilm.physics.plate.heat_states`.

    A plate that finds no state below 2000 K is given as 2000 K warm, with a doubt.
    """
    thermal = Thermal() if thermal is None else thermal
    body, fixed = thermal_body(actuator), source.frequency if frequency is None else frequency
    case = WarmCase(source, thermal, body, drifts_of(thermal))
    tracked = case.states(0.0)[0]
    states = case.states(fixed)
    given = conductance(tracked.temperature_rise, case.cooling)
    resistance = 1 / given
    time = case.capacity * resistance if resistance else 0.0
    cold, power = lost(fixed, 0.0, case.driven, case.drifts)
    rises, drifts = warmth_ranges(source, thermal, body)
    warming = Warming(
        frequency=fixed,
        half_bandwidth=source.frequency / (2 * source.quality_factor),
        cold_amplitude=cold,
        cold_power=power,
        thermal_resistance=resistance,
        heat_capacity=case.capacity,
        thermal_time=time,
        tracked=tracked,
        fixed=states[0],
        other_fixed=states[1:],
        time_to_fall=case.time_to_fall(fixed, cold, time),
        speed=2 * math.pi * source.frequency * source.amplitude / math.sqrt(2),
        field=source.field,
        assumed=_assumed(thermal, body),
        doubts=(),
        rise_range=rises,
        drift_range=drifts,
    )
    return replace(warming, doubts=tuple(_doubts(warming, source, thermal)))


@si.checked_numbers
def warming_of_mode(
    actuator: Actuator,
    thermal: Thermal,
    mode: WorkingMode,
    voltage: Annotated[si.Volt, si.AtLeast(0.0)],
    frequency: Annotated[si.Hertz, si.Above(0.0)] | None = None,
) -> Warming | None:
    """Effect of warmth on a working mode at a voltage (V, zero-to-peak), see `warming`.

    It loses ½ M ω³ A²/Q in its materials, of its modal mass M, amplitude A and quality factor.
    None where the modal mass is not known, as of a measured stator, or nothing drives it.
    """
    if mode.modal_mass is None or not voltage > 0:
        return None
    amplitude = voltage * mode.amplitude_per_volt
    omega = 2 * math.pi * mode.resonance_frequency
    power = 0.5 * mode.modal_mass * omega**3 * amplitude**2 / mode.quality_factor
    source = heat_source(
        actuator, voltage, mode.resonance_frequency, mode.quality_factor, amplitude, power
    )
    return warming(source, actuator, thermal, frequency)


def _assumed(thermal: Thermal, body: ThermalBody) -> tuple[str, ...]:
    """Assumptions behind the numbers that nobody measured."""
    said = []
    if thermal.thermal_resistance is None:
        said.append(
            "still air at both faces, "
            + (f"an emissivity of {ASSUMED_EMISSIVITY:g}, " if thermal.emissivity is None else "")
            + "nothing through supports and leads"
        )
    if thermal.thermal_time is None:
        said += body.assumed
    said.append(f"a temperature coefficient of {thermal.temperature_coefficient:g} per K")
    if thermal.charge_temperature_coefficient == thermal.quality_temperature_coefficient == 0:
        said.append("charge coefficient and quality factor that do not depend on temperature")
    if thermal.rayleigh_softening == thermal.rayleigh_charge == 0:
        said.append("a ceramic that is linear (not measured)")
    return tuple(said)


def too_hot(warming: Warming) -> str | None:
    """Sentence that the plate gets warmer than the model knows; None where it does not."""
    rise = max(warming.tracked.temperature_rise, warming.fixed.temperature_rise)
    if warming.tracked.temperature_rise >= HOTTEST:
        return (
            f"There is no temperature below {HOTTEST:g} K at which the plate gives off the heat "
            "that it generates: driven for long it would be destroyed. Ask for a lower voltage."
        )
    if rise > KNOWN_RISE:
        return (
            f"Driven for long the plate warms by {rise:.0f} K, and only up to {KNOWN_RISE:g} K is "
            "its ceramic taken to stay what it is (assumed). The numbers are those of the cold "
            "plate: drive it in short bursts, or with a lower voltage."
        )
    return None


def _doubts(warm: Warming, source: HeatSource, thermal: Thermal) -> list[str]:
    """Sentences on what speaks against the cold, linear amplitude."""
    said = []
    rise, drift = warm.tracked.temperature_rise, warm.tracked.resonance_drift
    if abs(drift) > 0.5 * warm.half_bandwidth:
        kept = warm.fixed.amplitude / warm.cold_amplitude if warm.cold_amplitude > 0 else 1.0
        said.append(
            f"the plate warms by {rise:.0f} K where the drive follows its resonance, which then "
            f"drifts by {drift:+.0f} Hz; its half-bandwidth is {warm.half_bandwidth:.0f} Hz. A "
            f"drive that stays at its frequency is left with {si.percent(kept)} of the amplitude, "
            f"{warm.fixed.temperature_rise:.0f} K warm. Track the resonance, or drive in bursts. "
            "Thermal resistance and temperature coefficient are computed or assumed"
        )
    if warm.other_fixed:
        others = ", ".join(f"{1e6 * state.amplitude:.3g} µm" for state in warm.other_fixed)
        said.append(
            f"at a fixed {warm.frequency:.0f} Hz the warm plate has several states: "
            f"{1e6 * warm.fixed.amplitude:.3g} µm is reached from cold, {others} by coming down "
            "from a higher frequency or a warmer plate"
        )
    if (sentence := too_hot(warm)) is not None:
        said.append(sentence)
    hard = source.quality_of_ceramic is None or source.quality_of_ceramic >= HARD_QUALITY
    most = thermal.highest_speed or (HARD_SPEED if hard else SOFT_SPEED)
    if warm.speed > most and thermal.rayleigh_softening == 0:
        said.append(
            f"the surface moves at {warm.speed:.2g} m/s (r.m.s.), more than the {most:g} m/s at "
            f"which {'hard' if hard else 'soft'} ceramics begin to lose more and level off; the "
            "amplitude is linear in the voltage here, since nothing else was measured"
        )
    if warm.field is not None and warm.field > FIELD_SHARE * thermal.coercive_field:
        said.append(
            f"the field in the ceramic is {warm.field * 1e-6:.2g} kV/mm, more than a third of its "
            f"coercive field of {thermal.coercive_field * 1e-6:.2g} kV/mm; it may lose its poling"
        )
    return said
