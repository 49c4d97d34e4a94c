"""Effect of each uncertain or toleranced value of a display on frequency, amplitude, friction.

One value at a time goes from the 5 % to the 95 % quantile of its range, all else as described: the
range that the description gives, that of the friction's interval
(`physics.uncertainty.parameters`), or of a part of the plate that nobody gave one, a usual
tolerance that is assumed here.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, Literal, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.distributions import Uniform
from squeezefilm.core.errors import InputError, OutOfRangeError, SqueezefilmError
from squeezefilm.core.results import Result
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.chain.touch import TOLERANCE
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.beam_response import beam_response
from squeezefilm.physics.plate.layout import Actuator, DiscPlate, RectangularPlate
from squeezefilm.physics.plate.solid.layers import COARSE
from squeezefilm.physics.plate.solid.response import HarmonicResponse, harmonic_response
from squeezefilm.physics.plate.working_mode import WorkingMode, working_mode
from squeezefilm.physics.uncertainty.draws import Mixture, as_drawn, outcome_of
from squeezefilm.physics.uncertainty.parameters import (
    Origin,
    Parameter,
    uncertain_parameters,
    value_at,
    with_values,
)

Effort = Literal["quick", "solved"]
"""Way to compute a changed plate: "quick" by the beam, in milliseconds, and where its glue changes
by the solid on its coarse mesh (0.1 to 0.4 s), or "solved" in three dimensions, twice for each
value. A disc is solved either way (0.1 s a time)."""

_ENDS = np.array([0.05, 0.95])


class _Usual(NamedTuple):
    """A usual tolerance either way, in shares of the value (or absolute), and why."""

    either_way: float
    why: str
    absolute: bool = False


_USUAL: dict[str, _Usual] = {
    "actuator.length": _Usual(0.002, "as cut, ceramics in proportion; assumed"),
    "actuator.width": _Usual(0.002, "as cut, ceramics in proportion; assumed"),
    "actuator.diameter": _Usual(0.002, "as turned, ceramics in proportion; assumed"),
    "actuator.thickness": _Usual(0.025, "sheet as it is sold; assumed"),
    "actuator.patches.*.thickness": _Usual(0.05, "ceramic as it is sold; assumed"),
    "actuator.ceramic_thickness": _Usual(0.05, "ceramic as it is sold; assumed"),
    "actuator.substrate.young_modulus": _Usual(0.065, "alloys and glasses by handbooks; assumed"),
    "actuator.substrate.density": _Usual(0.013, "alloys and glasses by handbooks; assumed"),
    "actuator.substrate.poisson_ratio": _Usual(0.03, "by handbooks; assumed", absolute=True),
    "actuator.glue.thickness": _Usual(0.5, "pressed by hand; assumed"),
    "actuator.glue.young_modulus": _Usual(0.5, "by cure and temperature; assumed"),
    "actuator.reference_amplitude": _Usual(0.1, "a vibrometer on one specimen; assumed"),
}
_SIDES = {"actuator.length": ("x", "length"), "actuator.width": ("y", "width")}
_GLUE = "actuator.glue."


@dataclass(frozen=True)
class Shift:
    """Effect of one end of a value's range: the relative change of the resonance frequency and of
    the amplitude per volt without a finger (None where the theory does not know), and µ′/µ (None
    where it is refused). `why_not` says why something is None."""

    value: float
    frequency_shift: si.Dimensionless | None
    amplitude_shift: si.Dimensionless | None
    relative_friction: si.Dimensionless | None
    why_not: str = ""


@dataclass(frozen=True)
class DisplaySensitivity:
    """A value of a display, by its dotted path, at the low and the high end of its range."""

    path: str
    nominal: float
    unit: str
    origin: Origin
    source: str
    low: Shift
    high: Shift

    @property
    def known(self) -> bool:
        """True where both ends have a friction."""
        return None not in (self.low.relative_friction, self.high.relative_friction)

    @property
    def friction_change(self) -> si.Dimensionless:
        """Difference of µ′/µ between the two ends (0 where one is refused)."""
        low, high = self.low.relative_friction, self.high.relative_friction
        return 0.0 if low is None or high is None else abs(high - low)


@dataclass(frozen=True)
class DisplaySensitivities(Result):
    """All rows, what changes the friction most first and what is not known last;
    `relative_friction` is that as described, by the model that rows are made with, `plate_model`
    what made the shifts of a changed plate."""

    relative_friction: si.Dimensionless
    effort: Effort
    plate_model: str
    rows: tuple[DisplaySensitivity, ...]
    _shown: ClassVar[str] = "relative_friction effort plate_model"


@as_drawn()
def display_sensitivities(
    display: Display, prediction: Prediction, effort: Effort = "quick"
) -> DisplaySensitivities:
    """Effect of each uncertain or toleranced value where a prediction was made, its voltage kept.

    The drive follows the resonance. A plate's own values move frequency and amplitude as the beam
    says, those of its glue as the solid on its coarse mesh ("quick": some 10 ms a value, 0.2 to
    0.8 s a value of the glue; the film's dependence on the frequency left out), or as the changed
    plate is solved ("solved": twice as long a value as `predict` takes for the plate). What is not
    the plate's costs 10 ms a value, and what it needs of film tables. Where the amplitude was
    given, the plate's values are left out. Raises `InputError` for another
    effort.
    """
    si.require_one_of("effort", effort, ("quick", "solved"))
    p = prediction
    mixture = Mixture(display, p, driven=p.voltage is not None)
    bench = _Bench(display, p, mixture, effort)
    nominal = bench.friction(display, p.mode)
    rows = []
    for known in _every(display, mixture):
        low, high = (bench.shift(known.path, value) for value in known.drawn(_ENDS))
        rows.append(
            DisplaySensitivity(
                known.path, known.nominal, known.unit.symbol, known.origin, known.source, low, high
            )
        )
    rows.sort(key=lambda row: (not row.known, -row.friction_change))
    return DisplaySensitivities(nominal, effort, bench.model, tuple(rows))


def _every(display: Display, mixture: Mixture) -> Iterator[Parameter]:
    """Ranges that the interval draws, and usual tolerances of the plate where there are none."""
    yield from (drawn for drawn in mixture.inputs if isinstance(drawn, Parameter))
    if mixture.prediction.voltage is None:
        return
    # Of a calibrated plate, whose amplitude is drawn as a whole, what its own values may be.
    of_plate = uncertain_parameters(display, mixture.prediction.surface.name, driven=True)
    for parameter in of_plate:
        if parameter.path.startswith("actuator.") and parameter.path not in mixture.paths:
            yield parameter
    known_paths = {*mixture.paths, *(parameter.path for parameter in of_plate)}
    known_paths |= {path.replace(".0.", ".*.") for path in known_paths}
    for path, usual in _USUAL.items():
        try:
            nominal, unit = value_at(display, path)
        except InputError:
            continue
        if path in known_paths:
            continue
        reach = usual.either_way * (1 if usual.absolute else abs(nominal))
        spread = Uniform(nominal - reach, nominal + reach)
        yield Parameter(path, nominal, unit, spread, "assumed", usual.why)


def _with(display: Display, path: str, value: float) -> Display:
    """The display with another value at a path; ceramics and supports keep to the plate's size."""
    actuator, nominal = display.actuator, value_at(display, path)[0]
    return with_values(display, {path: value, **_along(actuator, path, value / nominal)})


def _along(actuator: Actuator, path: str, share: float) -> dict[str, float]:
    """Lengths that grow with a plate's length, width or diameter, by paths in the display."""
    lengths: dict[str, float] = {}
    if isinstance(actuator, RectangularPlate) and path in _SIDES:
        for group in ("patches", "supports"):
            for number, part in enumerate(getattr(actuator, group)):
                for name in _SIDES[path]:
                    lengths[f"actuator.{group}.{number}.{name}"] = share * getattr(part, name)
    elif isinstance(actuator, DiscPlate) and path == "actuator.diameter":
        for name in ("inner_diameter", "ceramic_outer_diameter", "ceramic_inner_diameter"):
            lengths[f"actuator.{name}"] = share * getattr(actuator, name)
    return lengths


# A beam has no glue, and a solve on two meshes takes seconds. The coarse mesh lacks as much of the
# changed plate as of the described one, so that what differs between the two is right to a few
# percent of itself.
#
# The band around the mode (a share of its frequency either way) that is searched, its frequencies,
# and the steps of the reduction: with 14 steps the shifts of the presets stay within 1e-4.
_REACH, _POINTS, _STEPS = 0.06, 1201, 6
# The coarse mesh is up to a percent too stiff: so far off the described mode is looked for.
_NEAR = 0.015
_GRID = (25, 17)


class ModeShift(NamedTuple):
    """Relative changes of the resonance frequency and of the amplitude per volt at the lobe."""

    frequency: si.Dimensionless
    amplitude: si.Dimensionless


class CoarseShifts:
    """Shifts of one plate's mode with another glue, by its solid on the coarse mesh; the plate as
    described is solved when the first is asked for."""

    def __init__(self, plate: RectangularPlate, mode: WorkingMode) -> None:
        self.plate, self.mode = plate, mode
        self._described: tuple[si.ComplexArray, float, float] | None = None

    def to(self, changed: RectangularPlate) -> ModeShift:
        """The shifts from the plate as described to another one of the same sides.

        The mode is found again as the largest answer in the shape that it has as described. 0.1 to
        0.4 s for each plate (processor time, presets). Within 8 % of the shift of the frequency and
        within 3 % of that of the amplitude of plates solved on two meshes
        (`tests/verification/test_plate_sensitivity.py`). Raises `OutOfRangeError` where the mode
        leaves 6 % of its frequency or is not driven, and what `harmonic_response` raises.
        """
        if self._described is None:
            response = self._response(self.plate)
            f0 = self.mode.resonance_frequency
            answer = response.amplitude_at(*self.mode.lobe)
            near = np.flatnonzero(np.abs(response.frequencies / f0 - 1) < _NEAR)
            at = int(near[np.argmax(answer[near])])
            if at in (near[0], near[-1]):
                raise OutOfRangeError(
                    "the drive does not move this mode, so that there is no amplitude to compare; "
                    "choose a mode that it drives (squeezefilm modes lists them)"
                )
            shape = self._surface(response)[at]
            self._described = shape, *self._peak(response, shape)
        shape, frequency, amplitude = self._described
        there, moves = self._peak(self._response(changed), shape)
        return ModeShift(there / frequency - 1, moves / amplitude - 1)

    def _response(self, plate: RectangularPlate) -> HarmonicResponse:
        band = self.mode.resonance_frequency * np.linspace(1 - _REACH, 1 + _REACH, _POINTS)
        return harmonic_response(plate, band, steps=_STEPS, resolution=COARSE, extrapolate=False)

    def _surface(self, response: HarmonicResponse) -> si.ComplexArray:
        """The motion of the upper face, shape (frequencies, places)."""
        x, y = (
            np.linspace(0, side, count)
            for side, count in zip((self.plate.length, self.plate.width), _GRID, strict=True)
        )
        return response.displacement(x, y).reshape(response.frequencies.size, -1)

    def _peak(
        self, response: HarmonicResponse, shape: si.ComplexArray
    ) -> tuple[si.Hertz, si.MetrePerVolt]:
        """Frequency of the largest motion in a shape (Hz), and the lobe's amplitude there (m/V)."""
        f = response.frequencies
        alike = np.abs(self._surface(response) @ shape.conj())
        at = int(np.argmax(alike))
        if not 0 < at < f.size - 1:
            raise OutOfRangeError(
                f"this glue moves the mode by more than {si.percent(_REACH)}; ask for the solved "
                "plate (sensitivities solved)"
            )
        # A resonance is a parabola in 1/|w|², near its top between the points of the band too.
        low, top, high = 1 / alike[at - 1 : at + 2] ** 2
        off = (low - high) / (2 * (low - 2 * top + high))
        frequency = float(f[at] + off * (f[1] - f[0]))
        lobe = response.at(np.array([frequency])).amplitude_at(*self.mode.lobe)
        return frequency, float(lobe[0])


class _Bench:
    """A prediction with one thing different at a time."""

    def __init__(self, display: Display, p: Prediction, mixture: Mixture, effort: Effort) -> None:
        self.display, self.prediction, self.mixture, self.effort = display, p, mixture, effort
        actuator = display.actuator
        self.by_beam = (
            isinstance(actuator, RectangularPlate)
            and p.voltage is not None
            and (effort == "quick" or p.mode.solid is None)
        )
        # A beam of what is described, that the shifts are of.
        self.beam = beam_response(actuator) if self.by_beam else None  # type: ignore[arg-type]
        self.model, self.glued = p.mode.model, None
        if self.beam is not None and isinstance(actuator, RectangularPlate):
            self.model = self.beam.model
            if actuator.glue is not None and p.mode.solid is not None:
                self.glued = CoarseShifts(actuator, p.mode)
                self.model += ", with another glue by the solid on its coarse mesh"

    def shift(self, path: str, value: float) -> Shift:
        """Effect of one value in the place of the described one."""
        of_plate = path.startswith("actuator.")
        changed = _with(self.display, path, value) if of_plate else self.display
        frequency = amplitude = None if of_plate else 0.0
        try:
            if of_plate:
                frequency, amplitude, mode = self._moved(changed, path)
                friction = self.friction(changed, mode)
            else:
                friction = self._outcome({path: value})
        except SqueezefilmError as error:
            return Shift(value, frequency, amplitude, None, str(error))
        return Shift(value, frequency, amplitude, friction)

    def _moved(self, changed: Display, path: str) -> tuple[float, float, WorkingMode]:
        """Relative shifts of frequency and amplitude per volt, and the mode that has them."""
        if self.by_beam and self.glued is None and path.startswith(_GLUE):
            raise OutOfRangeError("a beam knows no glue: leave the theory out, or allow more time")
        before, actuator = self.prediction.mode, changed.actuator
        if self.beam is not None and isinstance(actuator, RectangularPlate):
            quality = before.quality_factor
            if self.glued is not None and path.startswith(_GLUE):
                f, a = self.glued.to(actuator)
            else:
                self.beam.require_driven()
                there = beam_response(actuator)
                f = there.mode.frequency / self.beam.mode.frequency - 1
                a = there.amplitude_per_volt / self.beam.amplitude_per_volt - 1
                share = actuator.quality_factor / self.display.actuator.quality_factor
                if actuator.substrate.quality_factor is None:
                    quality *= share
                else:
                    # The solved plate's losses are its materials', the beam's the assembly's.
                    a = (1 + a) / share - 1
            # The film is asked at the frequency described: another one takes another table.
            amplitude = (1 + a) * before.amplitude_per_volt
            mode = dataclasses.replace(before, amplitude_per_volt=amplitude, quality_factor=quality)
            return f, a, mode
        moved = mode = working_mode(actuator)
        if self.effort == "quick":
            mode = dataclasses.replace(
                moved,
                resonance_frequency=before.resonance_frequency,
                half_wavelength=before.half_wavelength,
            )
        f = moved.resonance_frequency / before.resonance_frequency - 1
        return f, moved.amplitude_per_volt / before.amplitude_per_volt - 1, mode

    def friction(self, changed: Display, mode: WorkingMode) -> si.Dimensionless:
        """µ′/µ of a display whose plate moves by another mode, at the prediction's voltage."""
        p, before = self.prediction, self.prediction.mode
        share = mode.amplitude_per_volt / before.amplitude_per_volt
        detuning = p.frequency / before.resonance_frequency
        there = dataclasses.replace(p, mode=mode, frequency=mode.resonance_frequency * detuning)
        mixture = self.mixture.at(there, changed)
        draw = mixture.made({}, {})
        free = p.held_amplitude * share
        return float(outcome_of(mixture, draw, free, settled=TOLERANCE).friction)

    def _outcome(self, values: dict[str, float]) -> si.Dimensionless:
        """µ′/µ with other values of finger, surface, gas or drive."""
        p = self.prediction
        draw = self.mixture.made(values, {})
        nominal, here = self.display.drive.voltage, draw.display.drive.voltage
        share = here / nominal if p.voltage is not None and nominal > 0 else 1.0
        free = p.held_amplitude * share
        return float(outcome_of(self.mixture, draw, free, settled=TOLERANCE).friction)
