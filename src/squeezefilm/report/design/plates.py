"""The plates of a front as files of displays, every value with its source."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping

from squeezefilm import presets
from squeezefilm.analysis.parameters import value_at
from squeezefilm.config.provenance import Provenance, distribution_of, split_provenance
from squeezefilm.config.write import text_of
from squeezefilm.display import Display, load_display
from squeezefilm.presets.materials import Kind
from squeezefilm.report.design.words import chosen_words
from squeezefilm.report.kit.numbers import Leaf, leaves, printable
from squeezefilm.search.design.found import DesignSearch, FrontMember
from squeezefilm.search.design.requirements import Requirements
from squeezefilm.search.design.stock import OWN

_PARTS: Mapping[str, Kind] = {"substrate": "substrate", "ceramic": "ceramic"}
# Of the body, what the requirements say once for all plates.
_GIVEN = ("glue", "supports")


def plate_file(found: DesignSearch, member: FrontMember) -> str:
    """The text of a TOML file from which `load_display` reads the plate: the same values, and of
    each where it is from.

    Raises `InputError` as `found.display` and `text_of`.
    """
    requirements, display = found.requirements, found.display(member.name)
    design = member.evaluated.design
    said = printable(chosen_words(requirements, design))
    head = (
        f"# A plate of the front that squeezefilm design found for the requirements "
        f"'{printable(requirements.name)}', seed {found.seed}:\n# {said}.\n"
        "# It was computed and never built. squeezefilm analyze works it out.\n\n"
    )
    return head + text_of(display, plate_sources(requirements, display, member, found.seed))


def plate_sources(
    requirements: Requirements, display: Display, member: FrontMember, seed: int
) -> dict[str, Provenance]:
    """Where each number of a plate's display is from, by its dotted path: chosen by the search,
    asked for by the requirements, of the library of materials, or of the display that the search
    started from."""
    base = load_display(requirements.start_from)
    found = dict(_kept(requirements, base))
    asked = f"asked for by the requirements '{requirements.name}'"
    found |= {"finger.speed": Provenance(asked, "assumed")}
    # Where the display does not say it, the contact's size is that at the display's own force.
    own = base.provenance.get("finger.normal_force")
    if display.finger.contact_area_force is not None and own is not None:
        found.setdefault("finger.contact_area_force", own)
    if requirements.touch.normal_force is not None:
        found["finger.normal_force"] = Provenance(asked, "assumed")
    chosen = Provenance(
        f"chosen by squeezefilm design for the requirements '{requirements.name}', seed {seed}",
        "derived",
    )
    found["drive.voltage"] = chosen
    given = Provenance(f"given by the requirements '{requirements.name}'", "assumed")
    for leaf in _stated(display):
        name = leaf.path[1]
        path = ".".join(map(str, leaf.path))
        if name in _GIVEN:
            found[path] = given
        elif name == "quality_factor":
            found[path] = _quality(requirements, given)
        elif name not in _PARTS:
            found[path] = chosen
    settings = member.evaluated.design.settings
    for part, kind in _PARTS.items():
        found |= _of_material(base, part, str(settings[part]), kind, display)
    return found


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
    for path, one in base.provenance.items():
        head, *rest = path.split(".")
        if head in ("actuator", "joint", "calibration", "active_area"):
            continue
        if head == "surfaces":
            rest[0] = places[rest[0]]
        yield ".".join([head, *rest]), one


def _quality(requirements: Requirements, given: Provenance) -> Provenance:
    if requirements.quality_factor is not None:
        return given
    return Provenance(
        f"that of {requirements.start_from}, taken for every assembly: only a measurement says it",
        "assumed",
    )


def _of_material(
    base: Display, part: str, name: str, kind: Kind, display: Display
) -> dict[str, Provenance]:
    """The sources of a material's values: those of the display, or of the library with the ranges
    that it gives."""
    at = f"actuator.{part}."
    if name == OWN:
        return {path: one for path, one in base.provenance.items() if path.startswith(at)}
    split = split_provenance(presets.materials.table(name, kind))
    found = {}
    for path, source in split.sources.items():
        spread = split.spreads.get(path)
        if spread is not None:
            value, unit = value_at(display, f"{at}{path}")
            source = dataclasses.replace(source, distribution=distribution_of(value, unit, spread))
        found[at + path] = source
    return found
