"""Answers of an actuator that a bench could measure, by the full solver, and kept on disk.

A calibration asks some hundred plates. Each answer is kept in the cache folder under all that it
depends on, so that a calibration that was stopped goes on, and a second one costs nothing.
"""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.kept.store import Kept, in_passing
from squeezefilm.core.progress import SayProgress, ShareProgress, said_with_time_left, within
from squeezefilm.core.results import to_json
from squeezefilm.measure.fits.estimate import Observation
from squeezefilm.physics.plate.electronics import ring_admittance
from squeezefilm.physics.plate.layout import Actuator, AnnularStator, DiscPlate, RectangularPlate
from squeezefilm.physics.plate.parts import assembly_mass
from squeezefilm.physics.plate.ring.body import ring_body
from squeezefilm.physics.plate.ring.modes import clamped_capacitance
from squeezefilm.physics.plate.solid.solve import solve_modes
from squeezefilm.physics.plate.solid.working import SolidMode, solid_mode
from squeezefilm.physics.plate.working_mode import working_mode

MODE_FREQUENCY, LINES = "mode_frequency", ("lines_across_length", "lines_across_width")
FRICTION = "relative_friction"
PLATE_ANSWERS = (
    "resonance_frequency",
    "parallel_resonance_frequency",
    "coupling_coefficient",
    "static_capacitance",
    "quality_factor",
    "amplitude_per_volt",
    "half_wavelength",
    "mass",
    "modal_mass",
)
"""Answers in SI units: of working mode, circuit, and the body's mass (kg, ceramics included)."""

# What a bench's impedance sweep usually is: half-bandwidths on each side, points, noise.
_BAND, _READ_POINTS, _READ_NOISE = 8.0, 161, 0.01

_KEPT: Kept[si.FloatArray] = Kept("plate_answers", si.FloatArray)

PLATE_TAKES, DRAW_TAKES = 1.5, 0.008
"""Seconds of one solved plate, and of one drawn finger."""


def in_parts(say: SayProgress | None, seconds: Sequence[float]) -> Iterator[ShareProgress]:
    """The listeners to parts of some work, each expected to take so long (s), which tell the time
    that is left of all."""
    tell = said_with_time_left(say or (lambda _: None))
    ends = (np.cumsum([0.0, *seconds]) / (sum(seconds) or 1.0)).tolist()
    return (within(tell, *pair) for pair in itertools.pairwise(ends))


class Asked(NamedTuple):
    """An answer of an actuator: its name, and the nodal lines of another mode than the working
    one."""

    name: str
    lines: tuple[int, int] | None = None

    @property
    def said(self) -> str:
        """Answer in words."""
        words = self.name.replace("_", " ")
        return words if self.lines is None else f"{words} ({self.lines[0]},{self.lines[1]})"


def asked_by(observation: Observation) -> Asked:
    """The answer that an observation is of.

    Raises `InputError` for one that the solver has no answer to, or a `mode_frequency` without the
    nodal lines of its mode.
    """
    if observation.answer == MODE_FREQUENCY:
        if not set(LINES) <= set(observation.conditions):
            raise InputError(
                f"a {MODE_FREQUENCY} was observed without the mode it is of; give "
                f"{' and '.join(LINES)} in its conditions",
                quantity="observations",
            )
        return Asked(
            MODE_FREQUENCY,
            (round(observation.conditions[LINES[0]]), round(observation.conditions[LINES[1]])),
        )
    if observation.answer not in PLATE_ANSWERS:
        known = (*PLATE_ANSWERS, MODE_FREQUENCY, FRICTION)
        raise InputError(
            f"there is no answer '{observation.answer}'."
            f"{si.did_you_mean(observation.answer, known)} A calibration may use: "
            f"{', '.join(known)}",
            quantity="observations",
        )
    return Asked(observation.answer)


CONDITIONS: dict[str, si.Unit] = {
    "vibration_amplitude": si.Unit("m"),
    "normal_force": si.Unit("N"),
    "finger_speed": si.Unit("m/s"),
    LINES[0]: si.Unit("1"),
    LINES[1]: si.Unit("1"),
}
"""Units of what may be said of the conditions."""


def question(text: str) -> Observation:
    """An answer with its conditions, such as ``"relative_friction: vibration_amplitude=1.7 um"``;
    conditions are parted by commas. The value is left at 0.

    Raises `InputError` for a condition that is not known or has no number with its unit.
    """
    answer, _, rest = text.partition(":")
    conditions: dict[str, float] = {}
    for part in filter(None, (piece.strip() for piece in rest.split(","))):
        name, equals, value = (piece.strip() for piece in part.partition("="))
        if name not in CONDITIONS or not equals:
            raise InputError(
                f"'{part}' is no condition of {answer.strip()}."
                f'{si.did_you_mean(name, tuple(CONDITIONS))} Write them as in "relative_friction: '
                f'vibration_amplitude=1.7 um, normal_force=0.5 N"; known are '
                f"{', '.join(CONDITIONS)}",
                quantity="ask",
            )
        conditions[name] = si.parse_quantity(value, CONDITIONS[name])
    return Observation(answer.strip(), 0.0, 0.0, conditions)


class SolvedAnswers(NamedTuple):
    """Answers of one actuator (SI), NaN where it has none, and the solver's own relative errors of
    them where it estimates one (else 0), in the order that they were asked in.

    `readings` is by how much, relative, a fit of one circuit to this body's own admittance reads an
    answer beside what it is, since the neighbours of the mode are in the band; 0 where that is not
    known. Every such fit errs alike.
    """

    values: si.FloatArray
    errors: si.DimensionlessArray
    readings: si.DimensionlessArray


def solved_answers(actuator: Actuator, asked: tuple[Asked, ...]) -> SolvedAnswers:
    """The answers of a plate or disc by the full solver, kept on disk.

    One to two seconds for a plate that was not asked before. Raises `InputError` for a stator or an
    answer that such a body has not, and what the solvers raise.
    """
    if isinstance(actuator, AnnularStator):
        raise InputError("a stator's answers are measured values; ask for a plate or a disc")
    for answer in asked:
        if answer.name not in PLATE_ANSWERS and not (
            answer.lines is not None and isinstance(actuator, RectangularPlate)
        ):
            raise InputError(
                f"the solved {actuator.type} has no answer '{answer.said}'; it has: "
                f"{', '.join(PLATE_ANSWERS)}"
            )
    working = _KEPT.found(_question(actuator, "working"), partial(_working, actuator))
    answers = dict(zip(map(Asked, PLATE_ANSWERS), working, strict=True))
    for answer in asked:
        if answer.lines is not None and isinstance(actuator, RectangularPlate):
            question = _question(actuator, list(answer.lines))
            solve = partial(_other_mode, actuator, answer.lines)
            answers[answer] = _KEPT.found(question, solve)
    rows = np.array([answers[answer] for answer in asked]).reshape(-1, 3)
    return SolvedAnswers(rows[:, 0], rows[:, 1], rows[:, 2])


def _question(actuator: Actuator, mode: object) -> str:
    return json.dumps([to_json(actuator), mode], sort_keys=True)


_Named = Mapping[str, float]


def _working(actuator: RectangularPlate | DiscPlate) -> si.FloatArray:
    """`PLATE_ANSWERS` of the working mode, each a row of its value and its relative errors, of
    solver and reading."""
    values, errors, read = (
        _of_plate(actuator) if isinstance(actuator, RectangularPlate) else _of_disc(actuator)
    )
    return np.array(
        [(values[name], errors.get(name, 0.0), read.get(name, 0.0)) for name in PLATE_ANSWERS]
    )


def _of_plate(plate: RectangularPlate) -> tuple[_Named, _Named, _Named]:
    # Of a hundred plates only these numbers are asked for again.
    with in_passing():
        mode = solid_mode(plate)
        modes, at = mode.modes, mode.index
        error = mode.frequency_error / mode.frequency
    static = math.nan if mode.circuit is None else mode.circuit.static_capacitance
    coupling = float(modes.couplings[at])
    values = {
        "resonance_frequency": mode.frequency,
        "parallel_resonance_frequency": float(modes.open_frequencies[at]),
        "coupling_coefficient": coupling,
        "static_capacitance": static,
        "quality_factor": mode.quality_factor,
        "amplitude_per_volt": mode.amplitude_per_volt,
        "half_wavelength": mode.half_wavelength,
        "mass": assembly_mass(plate),
        "modal_mass": mode.modal_mass,
    }
    errors = {
        "resonance_frequency": error,
        "parallel_resonance_frequency": error,
        "coupling_coefficient": float(modes.coupling_errors[at]) / coupling if coupling else 0.0,
        "amplitude_per_volt": mode.amplitude_error / mode.amplitude_per_volt,
    }
    return values, errors, _read_beside(mode, values)


def _read_beside(mode: SolidMode, named: _Named) -> _Named:
    """Shares by which a bench's fit of a plate's admittance reads its answers beside what they
    are: over the usual band, with the usual noise, which weighs the points."""
    from squeezefilm.measure.fits.circuit.impedance import fit_impedance
    from squeezefilm.measure.recordings.kinds import ImpedanceSweep

    half, known = mode.frequency / (2 * mode.quality_factor), mode.response.frequencies
    ends = mode.frequency - _BAND * half, mode.frequency + _BAND * half
    band = np.linspace(max(ends[0], known[0]), min(ends[1], known[-1]), _READ_POINTS)
    admittance = mode.response.at(band).admittance
    noise = np.random.default_rng(0).standard_normal((2, band.size)) / math.sqrt(2)
    size = _READ_NOISE * float(np.max(np.abs(admittance)))
    try:
        fit = fit_impedance(ImpedanceSweep(band, admittance + size * (noise[0] + 1j * noise[1])))
    except InputError:
        return {}
    return {
        seen.answer: abs(seen.value / named[seen.answer] - 1)
        for seen in fit.observations
        if named[seen.answer] > 0
    }


def _of_disc(disc: DiscPlate) -> tuple[_Named, _Named, _Named]:
    mode, body = working_mode(disc), ring_body(disc)
    annular = mode.disc
    assert annular is not None
    assert mode.modal_mass is not None
    # Beside the mode, as a sweep reads it: all other modes are in it, not the clamped body's alone.
    circuit = ring_admittance(disc).circuit
    if circuit is None:
        static = clamped_capacitance(body.section, body.drive)
        coupling = annular.coupling_coefficient(body.drive, static)
    else:
        static, moving = circuit.static_capacitance, circuit.motional_capacitance
        coupling = math.sqrt(moving / (moving + static))
    error = (mode.frequency_error or 0.0) / mode.resonance_frequency
    values = {
        "resonance_frequency": mode.resonance_frequency,
        "parallel_resonance_frequency": mode.resonance_frequency / math.sqrt(1 - coupling**2),
        "coupling_coefficient": coupling,
        "static_capacitance": static,
        "quality_factor": mode.quality_factor,
        "amplitude_per_volt": mode.amplitude_per_volt,
        "half_wavelength": mode.half_wavelength,
        "mass": assembly_mass(disc),
        "modal_mass": mode.modal_mass,
    }
    # Its modes are far apart, and none is solved beside the working one.
    return values, {"resonance_frequency": error, "parallel_resonance_frequency": error}, {}


def _other_mode(plate: RectangularPlate, lines: tuple[int, int]) -> si.FloatArray:
    """The row of another mode's frequency."""
    try:
        modes = solve_modes(plate, mode=lines)
        at = modes.index(lines)
    except InputError:
        # Where two modes meet, neither may have these lines.
        return np.array([math.nan, 0.0, 0.0])
    frequency = float(modes.frequencies[at])
    return np.array([frequency, float(modes.errors[at]) / frequency, 0.0])
