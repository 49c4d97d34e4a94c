"""Terminal output of descriptions: presets, materials, values with their sources, actuators."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from typing import Any, get_args, get_type_hints

from squeezefilm.actuators.report import page
from squeezefilm.cli.app import answer, option_of, read_option, working
from squeezefilm.core.errors import InputError
from squeezefilm.core.kit.folder import require_folder
from squeezefilm.core.kit.numbers import dotted
from squeezefilm.core.kit.terminal import heading, say, table

_MARKS = {"assumed": "* ", "unstated": "? "}
_STYLES = {"*": "yellow", "?": "red"}


DISPLAY_VERBS = "every verb for displays"
ACTUATOR_VERBS = "analyze and show"


def preset_list() -> list[dict[str, Any]]:
    """The displays, motors and skin-stretch arrays that come with the package: name, title, type,
    which verbs take it, how many values have a source and how many of these are assumed."""
    from squeezefilm.actuators.described import KINDS, load_actuator
    from squeezefilm.core import presets
    from squeezefilm.physics.display import load_display

    listing = []
    for name in presets.display_names():
        display = load_display(name)
        listing.append(_preset(display, display.actuator.type, DISPLAY_VERBS))
    for name in presets.names("actuator"):
        actuator = load_actuator(name)
        kind = next(kind for kind in KINDS if hasattr(actuator, kind))
        listing.append(_preset(actuator, kind, ACTUATOR_VERBS))
    return listing


def _preset(described: Any, kind: str, verbs: str) -> dict[str, Any]:
    """An entry of the list of presets."""
    evidence = [item.evidence for item in described.provenance.values()]
    return {
        "name": described.name,
        "title": described.title,
        "type": kind,
        "taken_by": verbs,
        "values_with_source": len(evidence),
        "values_assumed": evidence.count("assumed"),
    }


def show_presets(listing: Sequence[dict[str, Any]]) -> None:
    """Print the list of presets."""
    rows = [
        (
            preset["name"],
            preset["title"],
            preset["taken_by"],
            f"{preset['values_assumed']} of {preset['values_with_source']}",
        )
        for preset in listing
    ]
    table(("preset", "what it is", "taken by", "assumed"), rows, fixed=(0, 3))
    say("squeezefilm show NAME lists the values; squeezefilm analyze NAME works them out")


def display_values(target: str) -> list[dict[str, Any]]:
    """Every value that the file of a display or an actuator states, or takes from the library of
    materials: path, text as written, source and evidence.

    Members of lists are counted from 1. `source` and `evidence` are None where nothing is
    said; the evidence of a number without a source is "unstated". Raises `ConfigError` for a file
    that is not right.
    """
    from squeezefilm.actuators.described import actuator_class, is_actuator
    from squeezefilm.core import presets
    from squeezefilm.core.config.load import written_values
    from squeezefilm.core.regular_file import read_toml_text
    from squeezefilm.physics.display import Display

    other = is_actuator(target)
    file = presets.resolve(target, "actuator") if other else presets.resolve(target)
    text = read_toml_text(file)
    described = actuator_class(text, file) if other else Display
    return [
        {
            "path": dotted(path),
            "text": said,
            "source": (origin and origin.source) or None,
            "evidence": origin and origin.evidence,
        }
        for path, said, origin in written_values(described, text, file=file)
    ]


def show_values(values: Sequence[dict[str, Any]]) -> None:
    """Print the values of a display by table of its file, with their sources; a star marks what is
    assumed, a question mark what has no source."""
    groups: dict[str, list[tuple[str, str, str]]] = {}
    for item in values:
        group, _, key = item["path"].rpartition(".")
        mark = _MARKS.get(item["evidence"] or "", "  ")
        groups.setdefault(group, []).append((mark + key, item["text"], _origin(item)))
    for group, rows in groups.items():
        if group:
            heading(group)
        _marked_table(("", "", ""), rows)
    sourced = [item["evidence"] for item in values if item["evidence"] is not None]
    say(f"\n* assumed: {sourced.count('assumed')} of {len(sourced)} values")
    if bare := sourced.count("unstated"):
        say(
            f"? without a source: {bare} of {len(sourced)} values; say where each is from, like "
            'thickness = { value = "2 mm", source = "caliper", evidence = "measured" }, or once '
            'for a table: source = "drawing 17"'
        )


def _marked_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print values in the colour of the mark that each begins with."""
    table(head, rows, fixed=(0,), styles=lambda row: _STYLES.get(row[0][:1], ""))


def _origin(item: dict[str, Any]) -> str:
    if item["evidence"] is None:
        return ""
    return f"{item['evidence']}: {item['source']}" if item["source"] else str(item["evidence"])


def material_list(name: str | None = None) -> list[dict[str, Any]]:
    """The materials of the library, or one of them by any of its names, with all their values.

    Each value has its text as a file may have it, source, evidence, and its range or None. Raises
    `InputError` for a name that is not known.
    """
    from squeezefilm.core.presets import materials
    from squeezefilm.core.results import values_of

    known = materials.materials() if name is None else (materials.named(name),)
    return [
        {
            **values_of(one, "name kind title also spread"),
            "values": [
                {
                    "path": path,
                    "text": str(value["value"]),
                    "source": value["source"],
                    "evidence": value.get("evidence", "published"),
                    "range": value.get("range"),
                }
                for path, value in one.leaves()
            ],
        }
        for one in known
    ]


def show_materials(listing: Sequence[dict[str, Any]]) -> None:
    """Print the materials by kind with what matters most of them; of a single one all values."""
    if len(listing) == 1:
        _show_material(listing[0])
        return
    for kind, columns in _COLUMNS.items():
        heading(f"{kind}: [actuator.{kind}] material = …")
        rows = []
        for one in (item for item in listing if item["kind"] == kind):
            texts = {value["path"]: value for value in one["values"]}
            rows.append((one["name"], *(_shown(texts[path]) for path in columns), one["title"]))
        table(("", *columns.values(), ""), rows, fixed=(0,))
    say(
        "\n* assumed. squeezefilm materials NAME lists all values with their sources. A file may "
        "state single values beside the name, in place of the library's."
    )


_COLUMNS: dict[str, dict[str, str]] = {
    "substrate": {"young_modulus": "E", "poisson_ratio": "ν", "density": "ρ"},
    "ceramic": {
        "charge_coefficient": "d31",
        "in_plane_stiffness": "c11_p",
        "density": "ρ",
        "quality_factor": "Q",
    },
    "glue": {"young_modulus": "E", "poisson_ratio": "ν", "density": "ρ"},
}


def _shown(value: dict[str, Any]) -> str:
    star = "*" if value["evidence"] == "assumed" else ""
    return f"{value['text']}{star}"


def _show_material(material: dict[str, Any]) -> None:
    say(f"{material['name']}: {material['title']} (a {material['kind']})")
    say(f"also: {', '.join(material['also'])}")
    say(f"spread: {material['spread']}")
    rows = []
    for value in material["values"]:
        mark = _MARKS.get(value["evidence"], "  ")
        between = "" if value["range"] is None else " to ".join(value["range"])
        rows.append((mark + value["path"], value["text"], between, _origin(value)))
    _marked_table(("", "", "range", "source"), rows)


_TAKEN = ("target", "voltage", "out", "as_json")


def analyze_actuator(asked: Any) -> None:
    """Analyse an actuator by `analyze`'s options. Raises `InputError` for those that only a display
    has."""
    usual, hints = type(asked)(asked.target), get_type_hints(type(asked), include_extras=True)
    other = [
        option_of(field.name, get_args(hints[field.name]))
        for field in fields(asked)
        if field.name not in _TAKEN and getattr(asked, field.name) != getattr(usual, field.name)
    ]
    if other:
        raise InputError(
            f"{', '.join(other)}: only a display has that; of an actuator, analyze takes "
            "--voltage, --out and --json. Its other values stand in its file"
        )
    voltage = read_option(asked.voltage, "voltage", "V")
    if asked.out is not None:
        require_folder(asked.out)
    with working(asked.as_json) as step:
        analyzed = page.analyze_actuator(asked.target, voltage, step)
        written = None
        if asked.out is not None:
            step("figures")
            written = analyzed.write(asked.out)
    answer(asked.as_json, analyzed.analysis, lambda _: analyzed.show(), report=written)
