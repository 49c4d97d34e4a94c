"""Criteria of a design: one table of numbers, how each is computed and which limit it has."""

from __future__ import annotations

import contextlib
import functools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.core.materials import VACUUM_PERMITTIVITY
from squeezefilm.design.analysis.ears import ear_exposure
from squeezefilm.design.search.requirements import Limits, Requirements
from squeezefilm.physics.chain.area_map import active_area
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.display import Display
from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.physics.perception.senses import (
    Rubbed,
    grating_evidence,
    switched_amplitude,
    tried_periods,
)
from squeezefilm.physics.plate.beam_response import patch_capacitance
from squeezefilm.physics.plate.electronics import load_of_mode
from squeezefilm.physics.plate.laminate import (
    Laminate,
    bending_stress,
    ceramics_of,
    plate_laminate,
    pressed_deflection,
    pressed_disc_deflection,
)
from squeezefilm.physics.plate.layout import DiscPlate, RectangularPlate
from squeezefilm.physics.plate.parts import parts_of
from squeezefilm.physics.plate.thermal import driven_thickness
from squeezefilm.physics.plate.working_mode import CROWDED
from squeezefilm.physics.uncertainty.uncertainty import uncertain_friction

# Periods tried from 0.125 to 20 mm: steps of 2 %, and between them a line.
_PERIODS = 251


_INFINITE = {"finest_period": "none", "neighbour": "none takes part"}


@dataclass(frozen=True)
class Criterion:
    """A number that designs are judged by: its key, unit, what people call it, and the field of
    `Limits` that bounds it from above ("most_…") or below ("least_…"); "" where none does. One that
    bounds a number which another bounds from the other side has that one's key as `of`."""

    key: str
    unit: si.Unit
    said: str
    limit: str = ""
    of: str = ""

    def value(self, numbers: Mapping[str, float]) -> float:
        """Value among a design's numbers (SI); NaN where it is not known."""
        return numbers.get(self.of or self.key, math.nan)

    @property
    def is_floor(self) -> bool:
        """True where its limit is a least."""
        return self.limit.startswith("least_")

    def shown(self, value: float | None) -> str:
        """A value of it (SI), for people."""
        if value is None or math.isnan(value):
            return "not known"
        if math.isinf(value):
            return _INFINITE.get(self.key, "no limit")
        if self.key == "area":
            return si.percent(value)
        if self.key == "mass":
            return f"{1e3 * value:.3g} g"
        return si.format_quantity(value, self.unit, 3)

    def bound_said(self, bound: float) -> str:
        """A limit on it (SI), for people, without its name."""
        return f"at {'least' if self.is_floor else 'most'} {self.shown(bound)}"

    def limit_said(self, bound: float) -> str:
        """A limit on it (SI), for people."""
        return f"{self.said} {self.bound_said(bound)}"


def _one(key: str, unit: str, said: str, limit: str = "", of: str = "") -> tuple[str, Criterion]:
    return key, Criterion(key, si.Unit(unit), said, limit, of)


CRITERIA: Mapping[str, Criterion] = dict(
    (
        _one("relative_friction", "1", "µ′/µ at the best place", "most_relative_friction"),
        _one("finest_period", "m", "finest grating felt", "most_finest_period"),
        _one("resonance_frequency", "Hz", "resonance", "least_frequency"),
        _one("highest_frequency", "Hz", "resonance", "most_frequency", "resonance_frequency"),
        _one("squeeze_number", "1", "squeeze number", "least_squeeze_number"),
        _one("vibration_amplitude", "m", "amplitude at the antinode, finger on"),
        _one("half_wavelength", "m", "half wavelength"),
        _one("current", "A", "current", "most_current"),
        _one("power", "W", "power", "most_power"),
        _one("temperature_rise", "K", "temperature rise", "most_temperature_rise"),
        _one("mass", "kg", "mass", "most_mass"),
        _one("total_thickness", "m", "thickness with ceramics", "most_thickness"),
        _one("field", "V/m", "field in the ceramic", "most_field"),
        _one("stress", "Pa", "stress in the ceramic", "most_stress"),
        _one("deflection", "m", "deflection when pressed", "most_deflection"),
        _one("cost", "1", "class of cost", "most_cost"),
        _one("neighbour", "1", "half-bandwidths to the nearest mode", "least_neighbour"),
        _one("area", "1", "share of the area below the wanted µ′/µ", "least_area"),
        _one("sound_level", "dB", "sound level at 0.5 m", "most_sound_level"),
        _one("surest_friction", "1", "µ′/µ with 95 % confidence"),
    )
)
"""Criteria by key, in the order in which they are told."""

OF_SOLVED = ("neighbour", "area", "sound_level", "surest_friction")
"""The keys of those that are known of solved plates alone."""


def criterion_of(objective: str) -> Criterion:
    """The criterion that an objective is."""
    return CRITERIA["total_thickness" if objective == "thickness" else objective]


@dataclass(frozen=True)
class Breach:
    """A limit that a design does not keep: the criterion's key, its value and the limit (SI), and
    by how much it is exceeded, as a share of the limit."""

    key: str
    value: float
    limit: float
    excess: si.Dimensionless

    @property
    def sentence(self) -> str:
        """The breach for people."""
        limited = CRITERIA[self.key]
        value, bound = limited.shown(self.value), limited.bound_said(self.limit)
        return f"{limited.said} is {value}, {bound} is wanted"


def bounded(limits: Limits) -> Iterator[tuple[Criterion, float]]:
    """The criteria that limits bound, each with its bound (SI)."""
    for criterion in CRITERIA.values():
        bound = getattr(limits, criterion.limit) if criterion.limit else None
        if bound is None:
            continue
        if criterion.key == "relative_friction" and limits.confidence == "95 %":
            criterion = CRITERIA["surest_friction"]
        yield criterion, float(bound)


def breaches(numbers: Mapping[str, float], limits: Limits) -> tuple[Breach, ...]:
    """The limits that a design's numbers do not keep, the worst first; of numbers that are not
    there nothing is said."""
    broken = []
    for criterion, bound in bounded(limits):
        value = criterion.value(numbers)
        if math.isnan(value):
            continue
        excess = excess_of(criterion, value, bound)
        if excess > 0:
            broken.append(Breach(criterion.key, value, bound, excess))
    return tuple(sorted(broken, key=lambda breach: -breach.excess))


def excess_of(criterion: Criterion, value: float, bound: float) -> float:
    """Share of a bound by which a value exceeds it; negative where there is a margin."""
    if math.isinf(value):
        return math.inf if (value > 0) != criterion.is_floor else -1.0
    return (bound - value) / bound if criterion.is_floor else (value - bound) / bound


def numbers_of_prediction(
    requirements: Requirements, display: Display, p: Prediction, cost: int | None = None
) -> dict[str, float]:
    """The criteria that any prediction tells, of a beam as of a solved plate (SI)."""
    actuator = display.actuator
    assert isinstance(actuator, RectangularPlate | DiscPlate), "shapes make no others"
    section = plate_laminate(actuator)
    free = p.touch.free_amplitude
    numbers = {
        "relative_friction": float(p.relative_friction),
        "finest_period": finest_period_felt(display, p),
        "resonance_frequency": p.mode.resonance_frequency,
        "squeeze_number": p.squeeze_number,
        "vibration_amplitude": p.vibration_amplitude,
        "half_wavelength": p.mode.half_wavelength,
        "mass": math.fsum(part.mass for part in parts_of(actuator)),
        "total_thickness": sum(layer.thickness for layer in section.layers),
        "deflection": _deflection(requirements, display, p, section),
        "stress": _stress(actuator, p, section, free),
    }
    if cost is not None:
        numbers["cost"] = float(cost)
    if p.heat is not None:
        numbers["power"] = p.heat.cold_power
        numbers["temperature_rise"] = p.heat.tracked.temperature_rise
    thickness = driven_thickness(actuator)
    if p.voltage and thickness:
        numbers["field"] = p.voltage / thickness
    if p.voltage and p.heat is not None:
        # Of its capacitance and its losses; that of a solved plate takes its place.
        reactive = 2 * math.pi * p.frequency * _capacitance(actuator) * p.voltage
        numbers["current"] = math.hypot(reactive, 2 * p.heat.cold_power / p.voltage)
    return numbers


def numbers_of_solved(
    requirements: Requirements, display: Display, p: Prediction
) -> dict[str, float]:
    """The criteria that only a solved plate has; those that take long where a limit asks."""
    limits = requirements.limits
    numbers: dict[str, float] = {}
    load = load_of_mode(display.actuator, p.mode, p.voltage, p.frequency)
    if load is not None:
        numbers["current"] = load.current
    beside = p.mode.neighbour
    numbers["neighbour"] = (
        math.inf if beside is None or beside.share < CROWDED else abs(beside.distance)
    )
    if limits.least_area is not None or limits.most_relative_friction is not None:
        area = active_area(display, p.mode, p.law, p.drive)
        wanted = limits.most_relative_friction or 0.7
        share = None if area is None else area.share_below(wanted)
        if share is not None:
            numbers["area"] = share
    if limits.most_sound_level is not None:
        with contextlib.suppress(SqueezefilmError):
            heard = ear_exposure(display, p)
            if heard is not None:
                numbers["sound_level"] = heard.level_dB
    if limits.confidence == "95 %":
        numbers["surest_friction"] = uncertain_friction(display, p).interval[1]
    return numbers


_observer = functools.cache(load_observer)


def finest_period_felt(display: Display, p: Prediction) -> si.Metre:
    """The finest square grating (m) that is felt at the finger's speed, by
    `physics.perception.senses`; between the periods tried by a line in logarithms, so that it
    changes smoothly. Infinite where none is felt."""
    if p.vibration_amplitude == 0 or p.relative_friction >= 1:
        return math.inf
    senses, period = _observer(), tried_periods(_PERIODS)
    tau = p.envelope_time_constant
    rubbed = Rubbed(p.friction_coefficient * p.normal_force, display.finger.fingerpad, p.speed)
    # Denser at small amplitudes, where the law bends; `p.friction` would ask it at 48 more speeds.
    knots = p.vibration_amplitude * np.linspace(0, 1, 65) ** 2
    values = p.law.over_speeds(knots, np.array([p.speed]))[0]

    def friction(amplitude: si.MetreArray) -> si.DimensionlessArray:
        return np.asarray(np.interp(amplitude, knots, values))

    amplitude = switched_amplitude(period / rubbed.speed, tau, p.vibration_amplitude)
    d_prime = grating_evidence(senses, period, amplitude, friction, rubbed)
    felt = np.flatnonzero(d_prime >= senses.detection_criterion)
    if not felt.size:
        return math.inf
    at = int(felt[0])
    if at == 0:
        return float(period[0])
    rise = np.log(d_prime[at] / d_prime[at - 1])
    part = np.log(senses.detection_criterion / d_prime[at - 1]) / rise
    return float(period[at - 1] * (period[at] / period[at - 1]) ** part)


def _capacitance(body: RectangularPlate | DiscPlate) -> si.Farad:
    """Capacitance of all ceramics in parallel, fringes neglected."""
    if isinstance(body, RectangularPlate):
        return patch_capacitance(body)
    area = math.pi / 4 * (body.ceramic_outer_diameter**2 - body.ceramic_inner_diameter**2)
    permittivity = body.ceramic.relative_permittivity * VACUUM_PERMITTIVITY
    return permittivity * area / body.ceramic_thickness


def _deflection(
    requirements: Requirements, display: Display, p: Prediction, section: Laminate
) -> float:
    """Deflection under the press, of a plate that is held along its outermost nodal lines."""
    press, body = requirements.limits.press, display.actuator
    stiffness = section.bending_stiffness
    if isinstance(body, DiscPlate):
        if body.inner_diameter > 0 or p.mode.line is None:
            return math.nan
        held = float(np.max(np.abs(p.mode.line.nodal_positions), initial=0.0))
        radius = held or body.diameter / 2
        poisson = body.substrate.poisson_ratio
        return float(pressed_disc_deflection(press, radius, stiffness, poisson))
    if p.mode.line is None or not isinstance(body, RectangularPlate):
        return math.nan
    nodes = p.mode.line.nodal_positions
    across = body.width if body.lines_across == "length" else body.length
    if body.lines_across == "width":
        # Between strips at its edges the plate is bare.
        metal = body.substrate
        stiffness = metal.plane_strain_modulus * body.thickness**3 / 12
    span = float(nodes[-1] - nodes[0])
    side = display.finger.contact_length
    return pressed_deflection(press, span, across, stiffness, body.substrate.poisson_ratio, side)


def _stress(
    body: RectangularPlate | DiscPlate, p: Prediction, section: Laminate, free: si.Metre
) -> float:
    """Stress at the ceramic's outer face, of the working mode's wave without a finger."""
    total = sum(layer.thickness for layer in section.layers)
    above, below = ceramics_of(body)
    distance = max(
        section.neutral_axis if above else 0.0,
        total - section.neutral_axis if below or not above else 0.0,
    )
    modulus = body.ceramic.in_plane_stiffness
    return float(bending_stress(free, p.mode.half_wavelength, distance, modulus))
