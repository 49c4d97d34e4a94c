"""Sources of the numbers of a plate that a search made, with the ranges that these give."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator, Mapping

from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.config.schema import Leaf, leaves
from squeezefilm.core.distributions import Normal
from squeezefilm.core.presets.materials import Kind
from squeezefilm.design.search.requirements import Requirements, toleranced
from squeezefilm.design.search.space import VOLTAGE, Setting
from squeezefilm.design.search.stock import OWN, of_library
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.layout import DiscPlate, RectangularPlate
from squeezefilm.physics.uncertainty.parameters import value_at

_PARTS: tuple[Kind, ...] = ("substrate", "ceramic")
# Of the body, what the requirements say once for all plates.
_GIVEN = ("glue", "supports")


def plate_sources(
    requirements: Requirements, display: Display, shape: int, settings: Mapping[str, Setting]
) -> dict[str, Provenance]:
    """Source of each number of a plate's display, by its dotted path: chosen by the search among
    what the shape of a number allows (the `settings` by name), asked for or given by the
    requirements, of the library of materials, or of the display that the search started from."""
    sources = shared_sources(requirements)
    own = f"the requirements '{requirements.name}'"
    chosen = Provenance(f"chosen by squeezefilm design for {own}", "derived")
    given = Provenance(f"given by {own}", "assumed")
    of_fixed = {variable.name for variable in requirements.spaces[shape] if variable.is_fixed}
    sources["drive.voltage"] = given if VOLTAGE in of_fixed else chosen
    for leaf in _stated(display):
        name = leaf.path[1]
        path = ".".join(map(str, leaf.path))
        if name in _GIVEN or name in of_fixed:
            sources[path] = given
        elif name == "quality_factor":
            sources[path] = _quality(requirements, given)
        elif name not in _PARTS:
            sources[path] = chosen
    sources |= dict(_tolerances(requirements, display, sources))
    base = requirements.started_from
    for part in _PARTS:
        sources |= _of_material(base, part, str(settings[part]))
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


def _stated(display: Display) -> Iterator[Leaf]:
    """The numbers of the body that are not as everywhere."""
    for leaf in leaves(display):
        if leaf.path[0] != "actuator" or isinstance(leaf.value, str | bool):
            continue
        if leaf.value != leaf.field.default:
            yield leaf


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
            yield at, dataclasses.replace(source, distribution=Normal(value, deviation))


def _quality(requirements: Requirements, given: Provenance) -> Provenance:
    if requirements.quality_factor is not None:
        return given
    return Provenance(
        f"that of {requirements.start_from}, taken for every assembly: only a measurement says it",
        "assumed",
    )


def _of_material(base: Display, part: Kind, name: str) -> dict[str, Provenance]:
    """The sources of a material's values: those of the display, or of the library with the ranges
    that it gives."""
    if name == OWN:
        at = f"actuator.{part}."
        return {path: origin for path, origin in base.provenance.items() if path.startswith(at)}
    library = of_library(name, part).provenance
    return {f"actuator.{path}": source for path, source in library.items()}
