"""A design of a search: what was chosen, the display that follows, and what it does; and the
display that the front is set beside, asked the same."""

from __future__ import annotations

import hashlib
import json
import math
import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.design.search.criteria import (
    Breach,
    breaches,
    criterion_of,
    numbers_of_prediction,
    numbers_of_solved,
)
from squeezefilm.design.search.requirements import Requirements
from squeezefilm.design.search.sources import plate_sources, shared_sources
from squeezefilm.design.search.space import VOLTAGE, Setting
from squeezefilm.design.sweep.tasks import NoAnswer, tried
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.plate.beam_modes import timoshenko_frequency
from squeezefilm.physics.plate.laminate import plate_laminate, section_with
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.working_mode import PlateTheory

Level = Literal["screened", "solved"]

_SCREENING: Mapping[str, PlateTheory | None] = {
    "strips": "timoshenko",
    "edge_strips": "timoshenko",
    "disc": None,
    "ring": None,
}
"""Theory by which a shape is screened; None: as it is solved, since a ring's solver is quick."""


# Voltages, from the least to the most, at which a plate that was solved is judged beside its own: a
# tenth of the time of solving another, but where an interval is asked of each.
_VOLTAGES: Mapping[str, int] = {"nominal": 5, "95 %": 3}


@dataclass(frozen=True)
class Design:
    """Choices of a design: the number of the shape in the requirements, and a value for each of its
    variables."""

    shape: int
    values: tuple[tuple[str, Setting], ...]

    @property
    def settings(self) -> dict[str, Setting]:
        """The values by name (SI)."""
        return dict(self.values)

    @property
    def address(self) -> str:
        """A short name that no other design has."""
        text = json.dumps([self.shape, sorted(self.values)])
        return hashlib.sha256(text.encode()).hexdigest()[:10]

    @property
    def plate(self) -> Design:
        """Plate that is built and solved: the design without its voltage."""
        return Design(self.shape, tuple(value for value in self.values if value[0] != VOLTAGE))

    def at_voltage(self, voltage: si.Volt) -> Design:
        """The same plate driven with another voltage (V)."""
        return design_of(self.shape, {**self.settings, VOLTAGE: voltage})


def plates_of(designs: Iterable[Design]) -> dict[Design, tuple[Design, ...]]:
    """The plates of designs, each with its designs in their order: whoever solves a plate has it
    for all its voltages."""
    plates: dict[Design, tuple[Design, ...]] = {}
    for design in designs:
        plate = design.plate
        plates[plate] = (*plates.get(plate, ()), design)
    return plates


def design_of(shape: int, values: Mapping[str, Setting]) -> Design:
    """A design of values by name; numbers to eleven digits, so that equal ones have one address."""
    plain = {
        name: float(f"{value:.11g}") if isinstance(value, int | float) else value
        for name, value in values.items()
    }
    return Design(shape, tuple(plain.items()))


@dataclass(frozen=True)
class Evaluated:
    """Result of a design: its criteria by key (SI), whether by the screening theory or solved in
    three dimensions, the limits that it breaks, why it cannot be built ("" where it can), and what
    it took (s). `lasting` is what would be the same another time."""

    design: Design
    level: Level
    numbers: Mapping[str, float]
    broken: tuple[Breach, ...] = ()
    reason: str = ""
    seconds: float = field(default=0.0, compare=False)
    warnings: tuple[str, ...] = ()
    lasting: bool = field(default=True, compare=False)

    @property
    def is_feasible(self) -> bool:
        """True where it can be built and keeps all limits that are known of it."""
        return not self.reason and not self.broken

    def objectives(self, names: tuple[str, ...]) -> tuple[float, ...]:
        """Values to be made small, in the order of names; infinite where it is not known."""
        values = (self.numbers.get(criterion_of(name).key, float("inf")) for name in names)
        return tuple(float("inf") if value != value else value for value in values)


def display_of(requirements: Requirements, design: Design) -> Display:
    """The display of a design. Raises `GeometryError` for one that cannot be built."""
    shape, settings = requirements.shapes[design.shape], design.settings
    base = requirements.base
    body = shape.body(
        settings, requirements.own, requirements.assembly_quality, requirements.room_of(shape)
    )
    return replace(
        base,
        name=f"{requirements.name}-{design.address}",
        title=f"{requirements.title}: {shape.type} {design.address}",
        actuator=body,
        drive=replace(base.drive, voltage=float(settings[VOLTAGE])),
        provenance={},
    )


def sourced_display_of(requirements: Requirements, design: Design) -> Display:
    """Display of a design as by `display_of`, with every number's source and, where that is known,
    its range: what an interval of its friction rests on."""
    display = display_of(requirements, design)
    sources = plate_sources(requirements, display, design.shape, design.settings)
    return replace(display, provenance=sources)


def evaluate(requirements: Requirements, design: Design, level: Level) -> Evaluated:
    """Evaluate a design, by the screening theory or solved. What is refused is an answer, too."""
    began = time.perf_counter()

    def asked() -> Evaluated:
        if level == "solved":
            return _solved(requirements, sourced_display_of(requirements, design), design)
        numbers = screened(requirements, display_of(requirements, design), design)
        return Evaluated(design, level, numbers, breaches(numbers, requirements.limits))

    answer = tried(asked)
    if isinstance(answer, NoAnswer):
        answer = not_evaluated(design, level, answer)
    return replace(answer, seconds=time.perf_counter() - began)


def not_evaluated(design: Design, level: Level, why: NoAnswer) -> Evaluated:
    """Entry of a design of which nothing is known."""
    return Evaluated(design, level, {}, reason=why.reason, lasting=why.lasting)


def _solved(
    requirements: Requirements, display: Display, design: Design, voltage: si.Volt | None = None
) -> Evaluated:
    """Result of a design's display solved in three dimensions, at a voltage if not its own."""
    prediction = predict(display, voltage=voltage)
    if not prediction.mode.has_shape:
        return Evaluated(design, "solved", {}, reason=prediction.objections[-1])
    numbers = _judged(requirements, display, prediction, design)
    numbers |= numbers_of_solved(requirements, display, prediction)
    broken = breaches(numbers, requirements.limits)
    return Evaluated(design, "solved", numbers, broken, warnings=prediction.warnings)


def evaluate_all(
    requirements: Requirements, designs: tuple[Design, ...], level: Level
) -> list[Evaluated]:
    """Evaluate several designs, in their order: one task of a search."""
    return [evaluate(requirements, design, level) for design in designs]


def at_other_voltages(requirements: Requirements, design: Design) -> list[Design]:
    """The plate of a design at voltages from the least to the most; none where none is chosen."""
    volts = requirements.spaces[design.shape].variable(VOLTAGE)
    if volts.is_fixed:
        return []
    shares = np.linspace(0, 1, _VOLTAGES[requirements.limits.confidence]).tolist()
    return [design.at_voltage(float(volts.at(share, {}))) for share in shares]


def screened(requirements: Requirements, display: Display, design: Design) -> dict[str, float]:
    """The criteria of a display by the theory by which its design is screened."""
    theory = _SCREENING[requirements.shapes[design.shape].type]
    return _judged(requirements, display, predict(display, theory=theory), design)


def rough_frequency(requirements: Requirements, design: Design) -> si.Hertz:
    """Rough resonance (Hz) of a plate of strips: between the waves in the bare plate and in one
    that ceramics cover, a fiftieth of the time of screening it. NaN for another shape, and for what
    cannot be built."""
    if requirements.shapes[design.shape].type != "strips":
        return math.nan
    try:
        body = display_of(requirements, design).actuator
    except SqueezefilmError:
        return math.nan
    assert isinstance(body, RectangularPlate), "strips are on a plate"
    half, covered = body.length / (body.nodal_lines - 0.5), body.coverage
    bare = timoshenko_frequency(half, section_with(body, "plane_strain", 0.0, 0.0))
    return float(
        bare ** (1 - covered) * timoshenko_frequency(half, plate_laminate(body)) ** covered
    )


def _judged(
    requirements: Requirements, display: Display, prediction: Prediction, design: Design
) -> dict[str, float]:
    # Nobody says what a display is built from that nobody chose.
    shape = requirements.shapes[design.shape]
    cost = shape.cost_class(design.settings) if design.values else None
    return numbers_of_prediction(requirements, display, prediction, cost)


_NOT_CHOSEN = Design(0, ())
"""Entry in place of a design, since nobody chose it."""


def reference_of(requirements: Requirements) -> Evaluated:
    """Result of the display of `compare_with` at the requirements' voltage, under their finger, on
    their surface, cooled as theirs are; solved in three dimensions.

    It has no class of cost, since nobody says what it is built from. Where it cannot be judged, its
    reason says why.
    """
    base, own = requirements.base, load_display(requirements.compare_with)
    of_body = {at: origin for at, origin in own.provenance.items() if at.startswith("actuator.")}
    display = replace(
        own,
        finger=base.finger,
        surfaces=base.surfaces,
        gas=base.gas,
        thermal=base.thermal,
        active_area=None,
        provenance=shared_sources(requirements) | of_body,
    )
    try:
        return _solved(requirements, display, _NOT_CHOSEN, requirements.drive.voltage)
    except SqueezefilmError as error:
        return Evaluated(_NOT_CHOSEN, "solved", {}, reason=str(error))
