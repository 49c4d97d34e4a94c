"""A design of a search: what was chosen, the display that follows, with the source of each of its
numbers, and what it does; and the display that the front is set beside, asked the same."""

from __future__ import annotations

import hashlib
import json
import math
import re
import time
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.config.schema import leaves
from squeezefilm.core.distributions import Normal
from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.core.presets.materials import Kind
from squeezefilm.design.search.criteria import (
    Breach,
    breaches,
    criterion_of,
    numbers_of_prediction,
    numbers_of_solved,
)
from squeezefilm.design.search.requirements import Requirements, toleranced
from squeezefilm.design.search.space import VOLTAGE, Setting
from squeezefilm.design.search.stock import OWN, of_library
from squeezefilm.design.sweep.tasks import NoAnswer, tried
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.plate.beam_modes import timoshenko_frequency
from squeezefilm.physics.plate.laminate import plate_laminate, section_with
from squeezefilm.physics.plate.layout import DiscPlate, RectangularPlate
from squeezefilm.physics.plate.working_mode import PlateTheory
from squeezefilm.physics.uncertainty.parameters import value_at

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
    return replace(display, provenance=_plate_sources(requirements, display, design))


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
    return [
        design_of(design.shape, {**design.settings, VOLTAGE: volts.at(share, {})})
        for share in shares
    ]


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


_PARTS: tuple[Kind, ...] = ("substrate", "ceramic")
# Of the body, what the requirements say once for all plates.
_GIVEN = ("glue", "supports")


def _plate_sources(
    requirements: Requirements, display: Display, design: Design
) -> dict[str, Provenance]:
    """Source of each number of a plate's display, by its dotted path: chosen by the search among
    what the shape of a number allows, asked for or given by the requirements, of the library of
    materials, or of the display that the search started from."""
    sources, base = shared_sources(requirements), requirements.started_from
    own = f"the requirements '{requirements.name}'"
    chosen = Provenance(f"chosen by squeezefilm design for {own}", "derived")
    given = Provenance(f"given by {own}", "assumed")
    quality = given
    if requirements.quality_factor is None:
        start = f"that of {requirements.start_from}, taken for every assembly"
        quality = Provenance(f"{start}: only a measurement says it", "assumed")
    space = requirements.spaces[design.shape]
    of_fixed = {variable.name for variable in space if variable.is_fixed}
    sources["drive.voltage"] = given if VOLTAGE in of_fixed else chosen
    for leaf in leaves(display.actuator, ("actuator",)):
        if isinstance(leaf.value, str | bool) or leaf.value == leaf.field.default:
            continue  # no number, or as everywhere
        name = leaf.path[1]
        path = ".".join(map(str, leaf.path))
        if name in _GIVEN or name in of_fixed:
            sources[path] = given
        elif name == "quality_factor":
            sources[path] = quality
        elif name not in _PARTS:
            sources[path] = chosen
    sources |= dict(_tolerances(requirements, display, sources))
    for part in _PARTS:
        material, origins = str(design.settings[part]), base.provenance
        if material != OWN:
            library = of_library(material, part).provenance
            origins = {f"actuator.{path}": source for path, source in library.items()}
        at = f"actuator.{part}."
        sources |= {path: source for path, source in origins.items() if path.startswith(at)}
    # As a file has them: what is uncertain is drawn in this order.
    order = {".".join(map(str, leaf.path)): n for n, leaf in enumerate(leaves(display))}
    return {at: sources[at] for at in sorted(sources, key=lambda at: order.get(at, len(order)))}


def shared_sources(requirements: Requirements) -> dict[str, Provenance]:
    """Sources of all numbers but those of body and drive, which every plate of a search shares:
    finger, gas, surfaces and cooling."""
    base = requirements.started_from
    sources = dict(_kept(requirements, base))
    asked = Provenance(f"asked for by the requirements '{requirements.name}'", "assumed")
    sources["finger.speed"] = asked
    # Where the display does not say it, the contact's size is that at the display's own force.
    own = base.provenance.get("finger.normal_force")
    if requirements.base.finger.contact_area_force is not None and own is not None:
        sources.setdefault("finger.contact_area_force", own)
    if requirements.touch.normal_force is not None:
        sources["finger.normal_force"] = asked
    return sources


def _kept(requirements: Requirements, base: Display) -> Iterator[tuple[str, Provenance]]:
    """The sources of all but the body, of the display that the search started from; the surface
    that was asked for stands first."""
    first = base.surfaces.index(base.surface(requirements.touch.surface))
    order = [first, *(k for k in range(len(base.surfaces)) if k != first)]
    places = {str(old): str(new) for new, old in enumerate(order)}
    for path, origin in base.provenance.items():
        head, *rest = path.split(".")
        if head in ("actuator", "measured", "joint", "calibration", "active_area"):
            continue
        if head == "surfaces":
            rest[0] = places[rest[0]]
        yield ".".join([head, *rest]), origin


def _tolerances(
    requirements: Requirements, display: Display, sources: Mapping[str, Provenance]
) -> Iterator[tuple[str, Provenance]]:
    """The sources of what a workshop makes, with how well it does."""
    body = display.actuator
    assert isinstance(body, RectangularPlate | DiscPlate), "shapes make no others"
    names = toleranced(body)
    for at, source in sources.items():
        # A tolerance is of all ceramics, whatever their number.
        path = re.sub(r"\.\d+\.", ".*.", at.removeprefix("actuator."))
        if not at.startswith("actuator.") or path not in names:
            continue
        deviation, (value, _) = getattr(requirements.tolerances, names[path]), value_at(body, path)
        # A description's value stays above 0 within three standard deviations.
        if 0 < 3 * deviation < value:
            yield at, replace(source, distribution=Normal(value, deviation))
