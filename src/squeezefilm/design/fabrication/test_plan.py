"""The plan of a bench for a display that was just built: steps in the order of the day, each with
the numbers it should give."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from squeezefilm.core import quantities as si
from squeezefilm.core.kit.numbers import HZ, M, N, V
from squeezefilm.design.fabrication.wiring import NodalLines
from squeezefilm.measure.calibration.blind import BlindPrediction, Predicted
from squeezefilm.measure.calibration.calibration import UNITS
from squeezefilm.measure.calibration.solved_answers import FRICTION
from squeezefilm.physics.chain.pad_place import place_words
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.plate.electronics import ElectricalLoad
from squeezefilm.physics.plate.parts import Part
from squeezefilm.physics.uncertainty.uncertainty import UncertainFriction

SMALL_SIGNAL: si.Dimensionless = 0.1
"""Share of the drive's voltage for what is to be linear."""
_BAND, _POINTS = 8.0, 201


@dataclass(frozen=True)
class Check:
    """A number to be read: `answer` is its name for a calibration ("" where it has none) under
    `conditions` (SI); `value` is that of the display as described, `interval` holds `level` of what
    is expected of the built one (None where that is not known)."""

    what: str
    answer: str
    unit: str
    value: float | None
    interval: tuple[float, float] | None = None
    level: si.Dimensionless | None = None
    conditions: tuple[tuple[str, float], ...] = ()
    remark: str = ""


@dataclass(frozen=True)
class TestStep:
    """A step: what to do, in sentences; the `kind` of recording and the `file` named after it (both
    "" where none is kept), and what to read."""

    __test__ = False

    name: str
    do: str
    kind: str
    file: str = field(init=False)
    checks: tuple[Check, ...]

    def __post_init__(self) -> None:
        file = f"{self.kind.replace(' ', '-')}.csv" if self.kind else ""
        object.__setattr__(self, "file", file)


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class BenchFacts:
    """Base of what is known of a display that is to be built: its solid `parts`, and `blind`, what
    is expected of it with intervals (None where nothing can be drawn)."""

    prediction: Prediction
    uncertainty: UncertainFriction | None
    parts: tuple[Part, ...]
    nodal: NodalLines
    load: ElectricalLoad | None
    blind: BlindPrediction | None

    @property
    def mass(self) -> float:
        """Mass of all bodies together (kg)."""
        return math.fsum(part.mass for part in self.parts)

    @property
    def expected(self) -> tuple[Predicted, ...]:
        """The numbers of `blind`; none without it."""
        return () if self.blind is None else self.blind.predictions


_OF_DRAWS = "zero-to-peak; as friction's interval, which allows no error of the plate's model"


def test_plan(known: BenchFacts) -> tuple[TestStep, ...]:
    """The steps, each recording named as `squeezefilm measure calibrate` finds it in its folder."""
    weigh = "Weigh the assembly with its glue cured, before leads are soldered."
    steps = [
        TestStep("Weigh it", weigh, "", (_of(known, "mass", "Mass", known.mass),)),
        _impedance(known),
        _response(known),
        _line(known),
        _grid(known),
        _decay(known),
        _voltages(known),
        _strokes(known),
    ]
    return tuple(step for step in steps if step is not None)


test_plan.__test__ = False  # type: ignore[attr-defined] # pytest collects by name


def _of(known: BenchFacts, answer: str, what: str, value: float | None, remark: str = "") -> Check:
    """A check of an answer, with the interval that was drawn of it."""
    matching = [predicted for predicted in known.expected if predicted.answer == answer]
    interval, level = (matching[0].interval, matching[0].level) if matching else (None, None)
    if value is None and matching:
        value = matching[0].median
    return Check(what, answer, UNITS.get(answer, "1"), value, interval, level, (), remark)


def _volts(volts: si.Volt) -> str:
    return si.format_quantity(volts, V, 3)


def _band(known: BenchFacts) -> str:
    mode = known.prediction.mode
    half = mode.resonance_frequency / (2 * mode.quality_factor)
    low, high = (mode.resonance_frequency + side * _BAND * half for side in (-1, 1))
    # As far as the resonance may lie, the band goes along.
    for predicted in known.expected:
        if predicted.answer in ("resonance_frequency", "parallel_resonance_frequency"):
            low, high = (
                min(low, predicted.interval[0] - 2 * half),
                max(high, predicted.interval[1] + 2 * half),
            )
    points = max(_POINTS, 8 * math.ceil((high - low) / half))
    ends = " to ".join(si.format_quantity(end, HZ, 4) for end in (low, high))
    return f"from {ends} in {points} points"


def _impedance(known: BenchFacts) -> TestStep:
    p, load = known.prediction, known.load
    static = None if load is None else load.capacitance
    checks = [
        _of(known, "resonance_frequency", "Resonance", p.mode.resonance_frequency),
        _of(known, "parallel_resonance_frequency", "Parallel resonance", None),
        _of(
            known,
            "coupling_coefficient",
            "Coupling coefficient",
            None,
            "√(1 − fs²/fp²): follows from the two above",
        ),
        _of(known, "static_capacitance", "Static capacitance", static),
        _of(known, "quality_factor", "Quality factor", p.mode.quality_factor),
    ]
    return TestStep(
        "Impedance sweep",
        f"Sweep all driven electrodes together, joined as in operation, at 1 V or less, "
        f"{_band(known)}, without a finger and held as in operation.",
        "impedance",
        tuple(check for check in checks if check.value is not None),
    )


def _response(known: BenchFacts) -> TestStep:
    p = known.prediction
    volts = SMALL_SIGNAL * (p.voltage or 0.0)
    at = place_words(p.mode.lobe)
    return TestStep(
        "Frequency response",
        f"Point the vibrometer at the best antinode, {at}; sweep at {_volts(volts)} "
        f"(zero-to-peak), {_band(known)}.",
        "frequency response",
        (
            _of(known, "resonance_frequency", "Resonance", p.mode.resonance_frequency),
            _of(known, "quality_factor", "Quality factor", p.mode.quality_factor),
            _of(known, "amplitude_per_volt", "Amplitude per volt", p.mode.amplitude_per_volt),
        ),
    )


def _line(known: BenchFacts) -> TestStep:
    p, nodal = known.prediction, known.nodal
    half = p.mode.half_wavelength
    checks = [_of(known, "half_wavelength", "Half wavelength", half)]
    of_shape = "of the shape as described; no interval was computed"
    checks += [
        Check(f"Nodal line {n} at {nodal.axis}", "", "m", at, remark=of_shape)
        for n, at in enumerate(nodal.positions, 1)
    ]
    checks += [
        Check(f"Nodal circle {n}, radius", "", "m", at, remark=of_shape)
        for n, at in enumerate(nodal.radii, 1)
    ]
    along = "across the nodal lines, through the best antinode, from the plate's edge"
    if nodal.radii:
        along = "along a diameter"
    elif nodal.angles:
        along = "along the mean circumference"
    step = si.format_quantity(half / 10, M, 2)
    return TestStep(
        "Line scan",
        f"At the measured resonance, scan {along} in steps of {step} or less.",
        "line scan",
        tuple(checks),
    )


def _grid(known: BenchFacts) -> TestStep | None:
    mode = known.prediction.mode
    if mode.solid is None:
        return None
    step = si.format_quantity(mode.half_wavelength / 4, M, 2)
    likeness = Check(
        f"Likeness with {mode.label}",
        "",
        "1",
        1.0,
        (0.95, 1.0),
        remark="modal assurance criterion; below 0.95 the fit calls it none of the shapes",
    )
    return TestStep(
        "Grid scan",
        f"At the measured resonance, scan the whole face in steps of {step} or less.",
        "grid scan",
        (likeness,),
    )


def _decay(known: BenchFacts) -> TestStep:
    p = known.prediction
    quality = _of(known, "quality_factor", "Quality factor", p.mode.quality_factor)
    ends = None
    if quality.interval is not None:
        scale = p.envelope_time_constant / p.mode.quality_factor
        ends = (quality.interval[0] * scale, quality.interval[1] * scale)
    tau = Check(
        "Time constant of the envelope",
        "",
        "s",
        p.envelope_time_constant,
        ends,
        quality.level,
        remark="Q/(π f0), with Q's interval",
    )
    return TestStep(
        "Ring-down",
        "Drive at the measured resonance, switch the drive off (electrodes shorted, not open), and "
        "record at the best antinode with 13 samples a period or more.",
        "ring-down",
        (quality, tau),
    )


def _voltages(known: BenchFacts) -> TestStep | None:
    p, load, unsure = known.prediction, known.load, known.uncertainty
    if not p.voltage:
        return None
    levels = ", ".join(_volts(share * p.voltage) for share in (SMALL_SIGNAL, 0.3, 0.6, 1.0))
    per_volt = _of(known, "amplitude_per_volt", "", None).interval
    ends = None if per_volt is None else (per_volt[0] * p.voltage, per_volt[1] * p.voltage)
    free = p.mode.amplitude_per_volt * p.voltage
    level = known.expected[0].level if known.expected else None
    linear = "linear in the voltage: a plate that softens or warms gives less"
    checks = [
        Check(f"Free amplitude at {_volts(p.voltage)}", "", "m", free, ends, level, (), linear)
    ]
    if load is not None:
        said = "zero-to-peak; as described, no interval was computed"
        checks.append(Check("Drive current", "", "A", load.current, remark=said))
        checks.append(Check("Drive power", "", "W", load.real_power, remark="without a finger"))
    if unsure is not None and unsure.power is not None:
        ends, level = unsure.power_interval, unsure.level
        checks.append(Check("Power with a finger", "", "W", unsure.power, ends, level))
    if p.heat is not None:
        rise, said = p.heat.tracked.temperature_rise, "where the drive follows the resonance"
        checks.append(Check("Temperature rise", "", "K", rise, remark=said))
    return TestStep(
        "Voltage sweeps",
        f"Repeat the frequency response at {levels} in a mixed order, up and down.",
        "voltage sweeps",
        tuple(checks),
    )


def _strokes(known: BenchFacts) -> TestStep:
    p, unsure = known.prediction, known.uncertainty
    ends = None if unsure is None else unsure.amplitude_interval
    if ends is not None and ends[0] == ends[1]:
        ends = None  # a stator's amplitude is what its description says, and nothing moves it
    level = None if unsure is None else unsure.level
    force, speed = si.format_quantity(p.normal_force, N, 3), 1e3 * p.speed
    checks = [
        Check(
            "Friction coefficient without vibration",
            "",
            "1",
            p.friction_coefficient,
            remark=f"of '{p.surface.name}', as described",
        ),
        Check(
            "Amplitude at the antinode, finger on",
            "",
            "m",
            p.vibration_amplitude,
            ends,
            level,
            (),
            "zero-to-peak" if ends is None else _OF_DRAWS,
        ),
    ]
    for predicted in known.expected:
        if predicted.answer == FRICTION:
            amplitude = predicted.conditions["vibration_amplitude"]
            here = math.isclose(amplitude, p.vibration_amplitude, rel_tol=1e-3)
            what = f"µ′/µ at {si.format_quantity(amplitude, M, 3)}"
            value = p.relative_friction if here else p.law.at(amplitude)
            under = tuple(predicted.conditions.items())
            checks.append(
                Check(what, FRICTION, "1", float(value), predicted.interval, predicted.level, under)
            )
    if not any(predicted.answer == FRICTION for predicted in known.expected):
        ends = None if unsure is None else unsure.interval
        checks.append(Check("µ′/µ", FRICTION, "1", p.relative_friction, ends, level))
    return TestStep(
        "Friction bench",
        f"Strokes at {speed:.3g} mm/s with {force} on '{p.surface.name}', at these amplitudes "
        "(with the finger on) and without vibration, in a mixed order, ten strokes each or more.",
        "friction bench",
        tuple(checks),
    )
