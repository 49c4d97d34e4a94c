"""Draws from all that is uncertain of a display: parameters, laws and mechanisms, at one point."""

from __future__ import annotations

import contextlib
import copy
import dataclasses
import functools
import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple, cast

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.errors import OutOfRangeWarning, SqueezefilmError
from squeezefilm.physics.chain.friction import LAWS, FrictionLaw
from squeezefilm.physics.chain.pad_law import DEFAULT_MODEL, MODEL_KINDS, FrictionModel
from squeezefilm.physics.chain.prediction import Prediction
from squeezefilm.physics.chain.touch import Touch, touch
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.loaded_mode import LoadedMode
from squeezefilm.physics.plate.warming import heat_source
from squeezefilm.physics.plate.working_mode import WorkingMode
from squeezefilm.physics.uncertainty.free_amplitude import FreeAmplitude
from squeezefilm.physics.uncertainty.model_choices import (
    AMPLITUDE_SHARE,
    FRICTION_OFFSET,
    HEIGHT_LAW,
    LIFTS,
    MECHANISM,
    MOISTURE,
    SLIP,
    LawChoice,
    calibrated_inputs,
    model_choices,
    same_interface,
)
from squeezefilm.physics.uncertainty.parameters import (
    FORCE,
    SKIN_COMPLIANCE,
    Parameter,
    made_with,
    uncertain_parameters,
)

Input = Parameter | LawChoice


@contextlib.contextmanager
def as_drawn() -> Iterator[None]:
    """Let a draw beyond the range of its law count as it is, without a warning for each, and check
    once what is made of a draw."""
    with warnings.catch_warnings(), si.outermost_checked():
        warnings.simplefilter("ignore", OutOfRangeWarning)
        yield


@dataclass(frozen=True)
class Draw:
    """A display of those that it may be: with other values and laws, its force (N), the pad's
    softness (0: all ridges at one mean gap, 1: each at its own balance), the slip of its gas and
    the friction model; of a calibrated one the amplitude relative to the solved one, and what is
    added to friction."""

    display: Display
    normal_force: si.Newton
    skin_compliance: si.Dimensionless
    slip: str
    heights: str
    model: FrictionModel
    amplitude_share: si.Dimensionless = 1.0
    friction_offset: si.Dimensionless = 0.0


@dataclass(eq=False)
class Refusals:
    """Draws that have no friction, of how many `evaluations`: why (with how often), under which
    law of heights, and what the first of them said."""

    evaluations: int
    reasons: Counter[str] = field(default_factory=Counter)
    heights: Counter[str] = field(default_factory=Counter)
    example: str = ""

    def refuse(self, draw_of: str, error: SqueezefilmError) -> None:
        """Count one, under a law of heights."""
        words = str(error)
        known = {
            "pressed through": "pressed through its asperities",
            "nearly everything into contact": "pressed nearly flat",
            "film is not tabulated": "outside of the film's table",
        }
        why = [short for part, short in known.items() if part in words]
        self.reasons[why[0] if why else type(error).__name__] += 1
        self.heights[draw_of] += 1
        self.example = self.example or words

    @property
    def count(self) -> int:
        """Number of draws that are refused."""
        return sum(self.reasons.values())

    @property
    def share(self) -> si.Dimensionless:
        """Share of all draws."""
        return self.count / self.evaluations

    def together_with(self, more: Refusals) -> Refusals:
        """Refusals of these and of other draws."""
        return Refusals(
            self.evaluations + more.evaluations,
            self.reasons + more.reasons,
            self.heights + more.heights,
            self.example or more.example,
        )

    @property
    def sentence(self) -> str:
        """Sentence of how many were refused and why."""
        why = ", ".join(f"{why} ({count})" for why, count in self.reasons.most_common())
        laws = ", ".join(f"{name} ({count})" for name, count in self.heights.most_common())
        return (
            f"{self.count} of {self.evaluations} draws ({si.percent(self.share, 1)}) are refused: "
            f"{why}; by the law of heights {laws}"
        )


# Parts of drawn displays that are kept: those of some rows of the design.
_MOST_PARTS = 64

_OF_LIFT = ("finger.contact_decay_length", "finger.decay_speed_exponent")
_OF_BALANCE = ("finger.asperities", "roughness")


class Mixture:
    """All that a display may be at a prediction's working point: `inputs`, each with a coordinate
    from 0 to 1 that says which value or law is drawn.

    `driven` is whether a voltage moves it, so that its actuator is uncertain too. The model is
    partial levitation where that was asked for, else drawn from the two that are fitted to people:
    those of the paper and of 2016 have constants of their own.
    """

    def __init__(self, display: Display, prediction: Prediction, *, driven: bool) -> None:
        self.display, self.prediction = display, prediction
        law = prediction.law
        self.model: FrictionModel = law.model if law.kind.friction == "load" else DEFAULT_MODEL
        parameters = uncertain_parameters(
            display,
            prediction.surface.name,
            driven=driven,
            normal_force=prediction.normal_force,
        )
        lifted = MODEL_KINDS[self.model].friction == "lift"
        # µ′/µ does not depend on µ.
        without = ["friction_coefficient", *(() if lifted else _OF_LIFT)]
        choices = model_choices(display)
        if lifted and not driven:
            # Asperities decide what the plate feels of the finger, and nothing else.
            without += _OF_BALANCE
            choices = tuple(choice for choice in choices if choice.path == SLIP)
        if lifted:
            choices += (LIFTS,)
        parameters = tuple(
            parameter
            for parameter in parameters
            if not any(part in parameter.path for part in without)
        )
        self.inputs: tuple[Input, ...] = calibrated_inputs(
            parameters + choices, display.joint, driven=driven
        )
        # Laws of contact are compared at what a plateau carries as described.
        self._pressure = display.finger.plateau_pressure()
        self.paths = tuple(input_.path for input_ in self.inputs)
        self._known: dict[bytes, Outcome] = {}
        self._parts: dict[tuple[str, frozenset[tuple[str, float]]], Any] = {}

    def at(self, prediction: Prediction, display: Display) -> Mixture:
        """The same inputs around another working point, of a display with another actuator."""
        other = copy.copy(self)
        vars(other).pop("free", None)
        other.prediction, other.display = prediction, display
        other._known, other._parts = {}, {}
        return other

    @functools.cached_property
    def free(self) -> FreeAmplitude:
        """The amplitude without a finger of whatever is drawn; it keeps what it solved for that."""
        return FreeAmplitude(self.display, self.prediction)

    def outcome(self, point: si.DimensionlessArray, draw: Draw) -> Outcome:
        """Outcome of the draw at a point of the unit cube, kept: whatever is asked of a display is
        asked of the same points."""
        key = point.tobytes()
        if key not in self._known:
            self._known[key] = outcome_of(self, draw, self.free(draw.display))
        return self._known[key]

    def known(self, points: si.DimensionlessArray) -> si.FloatArray:
        """Outcomes found at points before, shape (n, 3), NaN where nothing was."""
        unknown = Outcome(np.nan, np.nan, np.nan)
        return np.array([self._known.get(point.tobytes(), unknown) for point in points], float)

    def learn(self, points: si.DimensionlessArray, found: si.FloatArray) -> None:
        """Keep what another process found at points, shape (n, 3), where it was not refused."""
        for point, row in zip(points, found, strict=True):
            if np.isfinite(row[0]):
                self._known[point.tobytes()] = Outcome(*row.tolist())

    def __getstate__(self) -> dict[str, Any]:
        # What comes of draws is many times larger than what they are drawn from.
        return vars(self) | {"_known": {}, "_parts": {}}

    def draws(self, points: si.DimensionlessArray) -> Iterator[Draw]:
        """The draws at points of the unit cube, shape (n, inputs)."""
        for values, chosen in self.values(points):
            yield self.made(values, chosen)

    def values(
        self, points: si.DimensionlessArray
    ) -> Iterator[tuple[dict[str, float], dict[str, str]]]:
        """Values by path and options by path of points of the unit cube, shape (n, inputs)."""
        columns = [input_.drawn(points[:, k]) for k, input_ in enumerate(self.inputs)]
        numbers = [isinstance(input_, Parameter) for input_ in self.inputs]
        for row in zip(*columns, strict=True):
            named = list(zip(self.paths, row, numbers, strict=True))
            yield (
                {path: value for path, value, number in named if number},
                {path: value for path, value, number in named if not number},
            )

    def made(self, values: dict[str, float], chosen: dict[str, str]) -> Draw:
        """The draw with values by path and choices by path; what is left out is as described."""
        p = self.prediction
        force = values.get(FORCE, p.normal_force)
        compliance = values.get(SKIN_COMPLIANCE, 1.0)
        beside = (FORCE, SKIN_COMPLIANCE, AMPLITUDE_SHARE, FRICTION_OFFSET)
        by_part: dict[str, dict[str, float]] = {}
        for path, value in values.items():
            if path not in beside:
                name, _, rest = path.partition(".")
                by_part.setdefault(name, {})[rest] = value
        parts = {name: self._part(name, changed) for name, changed in by_part.items()}
        finger = parts.pop("finger", self.display.finger)
        changes: dict[str, object] = {"moisture": chosen[MOISTURE]} if MOISTURE in chosen else {}
        asperities = finger.asperities
        heights = chosen.get(HEIGHT_LAW, getattr(asperities, "heights", "persson"))
        changes["asperities"] = same_interface(asperities, heights, self._pressure)
        if not hasattr(changes["asperities"], "modulus"):
            # Of separate asperities no real contact area is known: µ is as described.
            changes["shear_strength"] = None
        finger = dataclasses.replace(finger, **changes)
        here = dataclasses.replace(self.display, finger=finger, **parts)
        joint = self.display.joint
        return Draw(
            here,
            force,
            compliance,
            chosen.get(SLIP, p.law.slip),
            heights,
            cast(FrictionModel, chosen.get(MECHANISM, self.model)),
            values.get(AMPLITUDE_SHARE, 1.0 if joint is None else joint.amplitude_share),
            values.get(FRICTION_OFFSET, 0.0 if joint is None else joint.friction_offset),
        )

    def _part(self, name: str, values: dict[str, float]) -> Any:
        """A part of the display with other values, kept: in a design of one change at a time most
        parts are those of the row's first draw."""
        key = name, frozenset(values.items())
        if key not in self._parts:
            if len(self._parts) >= _MOST_PARTS:
                self._parts.clear()
            self._parts[key] = made_with(getattr(self.display, name), values)
        return self._parts[key]

    def mode(self, draw: Draw) -> WorkingMode:
        """The working mode of a draw: as predicted, its quality factor changed in proportion to
        the assembly's (materials with losses of their own give the mode another one)."""
        mode = self.prediction.mode
        share = draw.display.actuator.quality_factor / self.display.actuator.quality_factor
        return dataclasses.replace(mode, quality_factor=share * mode.quality_factor)

    def power(self, felt: Touch, drawn_voltage: si.Volt | None = None) -> si.Watt | None:
        """Power that plate and finger take of the drive (W, mean), cold: lost in the materials of
        the plate as `LoadedMode.power` has it, in the ceramics' capacitance (`heat_source`), and in
        the finger. Modal mass and frequency are as described. None where nothing is driven or the
        modal mass is not known. A `drawn_voltage` stands for the description's own, where that is
        uncertain."""
        p = self.prediction
        mass, nominal = p.mode.modal_mass, self.display.drive.voltage
        if p.voltage is None or mass is None:
            return None
        volts = p.voltage
        if drawn_voltage is not None and nominal > 0:
            volts *= drawn_voltage / nominal
        loaded = felt.mode or LoadedMode(p.mode.resonance_frequency, p.mode.quality_factor, 0j)
        source = heat_source(
            self.display.actuator, volts, p.frequency, p.mode.quality_factor, felt.amplitude, 0.0
        )
        return loaded.power(mass, p.frequency, felt.amplitude) + source.dielectric_power

    def law(self, draw: Draw) -> FrictionLaw:
        """The friction law of a draw, at the prediction's frequency, place and speed."""
        p = self.prediction
        return LAWS[draw.model](
            surface=draw.display.surface(p.surface.name),
            finger=draw.display.finger,
            gas=draw.display.gas,
            half_wavelength=p.mode.half_wavelength,
            frequency=p.frequency,
            normal_force=draw.normal_force,
            model=draw.model,
            position=p.law.position,
            speed=p.law.speed,
            slip=draw.slip,
            place=p.law.place,
        )


def mixture_of(display: Display, prediction: Prediction) -> Mixture:
    """All that a display may be where it was predicted, its actuator with it where a voltage drives
    it; kept, with what comes of its draws, for the next question of an analysis."""
    # Displays of equal values may have other ranges, which equality leaves out.
    return _mixture(display, prediction, frozenset(display.provenance.items()))


@functools.lru_cache(maxsize=4)
def _mixture(
    display: Display, prediction: Prediction, _: frozenset[tuple[str, Provenance]]
) -> Mixture:
    return Mixture(display, prediction, driven=prediction.voltage is not None)


class Outcome(NamedTuple):
    """Outcome of a draw, or of many: µ′/µ, the amplitude with the finger (m), and the power that
    plate and finger take, cold (W; NaN where the modal mass is not known)."""

    friction: Any
    amplitude: Any
    power: Any


# Of the amplitude under a drawn finger: it moves µ′/µ a hundred times less than the draws differ.
_SETTLED = 1e-4


def outcome_of(
    mixture: Mixture, draw: Draw, free_amplitude: si.Metre, *, settled: float = _SETTLED
) -> Outcome:
    """Outcome of a draw at an amplitude (m) without its finger; `settled` as `touch` has its
    tolerance."""
    law, free_amplitude = mixture.law(draw), free_amplitude * draw.amplitude_share
    amplitude, power = free_amplitude, None
    if mixture.prediction.voltage is not None and mixture.prediction.mode.modal_mass is not None:
        felt = touch(mixture.mode(draw), law, free_amplitude, tolerance=settled)
        amplitude = felt.amplitude
        power = mixture.power(felt, draw.display.drive.voltage)
    friction = float(between_limits(law, draw, np.array([amplitude]))[0])
    return Outcome(friction, amplitude, np.nan if power is None else power)


def between_limits(law: FrictionLaw, draw: Draw, amplitude: si.MetreArray) -> si.DimensionlessArray:
    """Relative friction µ′/µ at amplitudes (m) of a pad as soft as the draw has it.

    At a place what a stiff pad differs by from ridges that sink each by themselves is taken from an
    even wave of the same amplitude: on the solved shape the one ridge that moves most would press
    a pad at one mean gap through, and so refuse draws for what no real skin is. What a calibration
    found the laws to be off by is added where a finger still feels something.
    """
    friction, soft = law.friction_in("own", amplitude), draw.skin_compliance
    if soft < 1:
        even = law.on_even_wave
        alike = friction if even is law else even.friction_in("own", amplitude)
        tied = even.friction_in("one-gap", amplitude)
        friction = np.clip(friction + (1 - soft) * (tied - alike), 0.0, 1.0)
    if draw.friction_offset:
        friction = np.clip(friction + draw.friction_offset, 0.0, np.maximum(friction, 1.0))
    return friction
