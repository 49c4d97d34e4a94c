"""Every documented key of every kind of file, once: read with its unit, and written as it is read.

The keys are those of the schema, so that a new one is tried here with no line added. Its value is
that of an example which has it, or one within its bounds.
"""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import json
import math
import types
import typing
from collections.abc import Iterator
from typing import Any, NamedTuple

import pytest

from squeezefilm.actuators.described import KINDS as ACTUATORS
from squeezefilm.actuators.described import load_actuator
from squeezefilm.core import presets
from squeezefilm.core import quantities as si
from squeezefilm.core.config import load, load_text
from squeezefilm.core.config.schema import family, reads_from_file, text_of
from squeezefilm.core.errors import ConfigError, InputError, QuantityError
from squeezefilm.core.quantities.require import bounds_of
from squeezefilm.design.search.requirements import Requirements, load_requirements
from squeezefilm.instruments.twin.settings import TwinSettings
from squeezefilm.measure.recordings.description import KINDS as RECORDINGS
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.perception.observer import Observer, load_observer
from squeezefilm.physics.render.texture.levels import RelativeFriction
from squeezefilm.physics.render.texture.shapes import SineWave
from squeezefilm.physics.texture_files.texture_file import TextureFile
from squeezefilm.study.conduct.sessions import SessionConditions
from squeezefilm.study.design.study_design import StudyDesign

FILES: tuple[type[Any], ...] = (
    Display,
    Requirements,
    TextureFile,
    StudyDesign,
    SessionConditions,
    Observer,
    TwinSettings,
    *ACTUATORS.values(),
    *RECORDINGS.values(),
)


# Where values depend on one another, and no file that comes with the package has them.
TOGETHER: dict[str, dict[str, Any]] = {
    "CeramicPatch": {"electrode": "shunted", "shunt_resistance": 1e3},
    "Measured": {"voltage": 15.0},
    "CeramicBar": {"length": 25e-3, "width": 3e-3, "thickness": 1e-3},
    "Image": {"values": ((0.25, 1.0), (0.0, 0.5))},
    "Ramp": {"start": 1e-3, "end": 5e-3},
    "SensorModel": {"noise": 1e-6},
    "Sequence": {"textures": (RelativeFriction(SineWave(2e-3), 0.5, 0.9),) * 2, "edges": (0.01,)},
    "SessionConditions": {"skin_moisture_method": "Corneometer CM 825, arbitrary units"},
    "SpeedGate": {"above": 0.05},
}
GIVEN: dict[str, Any] = {
    "PiezoConstants.stress_coefficient_31": -5.35,
    "PiezoConstants.stress_coefficient_33": 15.78,
    "PiezoConstants.stress_coefficient_15": 12.29,
    "Motor.second_plate": load_actuator("biet2008-motor").motor.plate,
    "ComparedAnswer.before": (0.9, 1.0, 1.1),
    "ComparedAnswer.after": (0.9, 1.0, 1.1),
}


PARTS = 8
"""The keys are tried in as many tests, so that each is quick."""


class Key(NamedTuple):
    """A key of a file: the dataclass of its table, its name, and its annotation."""

    owner: type[Any]
    name: str
    hint: Any

    def __str__(self) -> str:
        return f"{self.owner.__name__}.{self.name}"


def tables_in(hint: Any) -> Iterator[type[Any]]:
    """The dataclasses that a value of an annotation may hold."""
    if dataclasses.is_dataclass(hint):
        yield typing.cast("type[Any]", hint)
    elif si.unit_of(hint) is None:
        yield from family(hint)
        parts = typing.get_args(hint)
        for part in parts[:1] if typing.get_origin(hint) is typing.Annotated else parts:
            yield from tables_in(part)


def documented_keys() -> list[Key]:
    """The keys that the files may have, table by table."""
    keys: dict[type[Any], list[Key]] = {}
    todo = list(FILES)
    while todo:
        if (cls := todo.pop(0)) in keys:
            continue
        hints = si.hints_of(cls)
        fields = [field for field in dataclasses.fields(cls) if reads_from_file(field)]
        keys[cls] = [Key(cls, field.name, hints[field.name]) for field in fields]
        todo += [table for key in keys[cls] for table in tables_in(key.hint)]
    return [key for of_table in keys.values() for key in of_table]


def within(value: Any) -> Iterator[Any]:
    """The tables within a value, itself first."""
    if isinstance(value, tuple):
        for item in value:
            yield from within(item)
    elif dataclasses.is_dataclass(value):
        yield value
        for field in dataclasses.fields(value):
            yield from within(getattr(value, field.name))


@functools.cache
def described() -> dict[type[Any], list[Any]]:
    """The tables of the files that come with the package, by their dataclass."""
    files = (
        *map(load_display, presets.display_names()),
        *map(load_requirements, presets.names("requirements")),
        *(load(TextureFile, presets.resolve(name, "texture")) for name in presets.texture_names()),
        *(load(StudyDesign, presets.resolve(name, "study")) for name in presets.study_names()),
        *map(load_actuator, presets.names("actuator")),
        load_observer("fingertip"),
    )
    tables: dict[type[Any], list[Any]] = {}
    for file in files:
        for table in within(file):
            tables.setdefault(type(table), []).append(table)
    return tables


@functools.cache
def made(cls: type[Any]) -> Any:
    """A table of the keys that it needs, with values within their bounds."""
    hints = si.hints_of(cls)
    values = dict(TOGETHER.get(cls.__name__, {}))
    for field in dataclasses.fields(cls):
        needed = field.default is field.default_factory is dataclasses.MISSING
        if needed and field.init and field.name not in values:
            values[field.name] = next(good_values(hints[field.name]))
    return cls(**values)


def examples(cls: type[Any]) -> Iterator[Any]:
    """Tables of a dataclass: the package's own, else one that is made."""
    yield from described().get(cls, ())
    if cls.__name__ in TOGETHER or cls not in described():
        yield made(cls)


def good_values(hint: Any) -> Iterator[Any]:
    """Values that an annotation allows."""
    origin = typing.get_origin(hint)
    if hint is bool:
        yield from (True, False)
    elif hint is str:
        yield "words"
    elif origin is typing.Literal:
        yield from typing.get_args(hint)
    elif (hint.__origin__ if origin is typing.Annotated else hint) in (int, float):
        yield from numbers_within(hint)
    elif origin is typing.Annotated:
        yield from good_values(hint.__origin__)
    elif origin in (typing.Union, types.UnionType):
        for part in typing.get_args(hint):
            yield from good_values(part)
    elif origin is tuple:
        inner = [part for part in typing.get_args(hint) if part is not Ellipsis]
        yield tuple(next(good_values(part)) for part in inner)
    else:
        # Those that come with the package first: others may hold one of the same kind.
        for cls in sorted(tables_in(hint), key=lambda cls: cls not in described()):
            yield next(examples(cls))


def numbers_within(hint: Any) -> Iterator[Any]:
    """Numbers within the bounds of an annotation, whole ones where it wants them."""
    bounds, _, limits = bounds_of(hint)
    ends = [(getattr(limit, "least"), getattr(limit, "most")) for limit in limits]  # noqa: B009
    low = max(bounds.get("above", -1e3), bounds.get("at_least", -1e3), *(low for low, _ in ends))
    high = min(bounds.get("below", 1e3), bounds.get("at_most", 1e3), *(high for _, high in ends))
    shares = (0.5, 0.01, 1e-3, 1e-6, 0.9)
    numbers = [low + share * (high - low) for share in shares]
    if low > 0:
        numbers.insert(0, math.sqrt(low * high))
    is_count = hint is int or getattr(hint, "__origin__", None) is int
    yield from (math.ceil(number) for number in numbers) if is_count else numbers


def with_value(key: Key) -> Any:
    """A table that has the key: with a value that the example does not have, where one can be."""
    for table in examples(key.owner):
        values = [GIVEN[str(key)]] if str(key) in GIVEN else good_values(key.hint)
        for value in values:
            if value == getattr(table, key.name):
                continue
            with contextlib.suppress(InputError):
                return dataclasses.replace(table, **{key.name: value})
    for table in examples(key.owner):
        if getattr(table, key.name) is not None:
            return table
    raise LookupError(f"{key} has no example; give one in TOGETHER or GIVEN")


def typed(value: Any, hint: Any, symbol: str | None = None) -> str:
    """A value as a person would type it, a quantity in the unit of that symbol, else in its own."""
    if dataclasses.is_dataclass(value):
        hints = si.hints_of(type(value))
        pairs = (f"{name} = {typed(item, hints[name])}" for name, item in stated(value).items())
        return "{" + ", ".join(pairs) + "}"
    if isinstance(value, tuple):
        inner = typing.get_args(hint)[0]
        return "[" + ", ".join(typed(item, inner) for item in value) + "]"
    unit = si.unit_of(hint)
    if unit is None or isinstance(value, str | bool):
        return json.dumps(value, ensure_ascii=False)
    if symbol is None:
        return repr(value) if unit.symbol == "1" else f'"{value!r} {unit.symbol}"'
    zero, one = (si.parse_quantity(f"{number} {symbol}", unit) for number in (0, 1))
    return f'"{(value - zero) / (one - zero)!r} {symbol}"'


def stated(table: Any) -> dict[str, Any]:
    """The keys of a table that are not left out, with their values."""
    fields = [field for field in dataclasses.fields(table) if reads_from_file(field)]
    values = {field.name: getattr(table, field.name) for field in fields}
    return {name: value for name, value in values.items() if value is not None}


def units(hint: Any) -> list[str | None]:
    """The units that are offered for a quantity, and none for the one it has."""
    unit = si.unit_of(hint)
    if unit is None:
        return [None]
    return [None, "%"] if unit.symbol == "1" else [None, *si.allowed_units(unit).split(", ")]


def same(value: Any, other: Any) -> bool:
    """Whether values are the same, numbers but for the rounding of another unit."""
    if isinstance(value, float) and isinstance(other, float):
        return math.isclose(value, other, rel_tol=1e-12)
    return bool(value == other)


def read_back(table: Any, key: Key, symbol: str | None) -> Any:
    """The value of a key, read from a file that says all of a table."""
    hints = si.hints_of(key.owner)
    lines = [
        f"{name} = {typed(value, hints[name], symbol if name == key.name else None)}"
        for name, value in stated(table).items()
    ]
    return getattr(load_text(key.owner, "\n".join(lines)), key.name)


KEYS = documented_keys()


def test_the_files_have_their_keys() -> None:
    assert len(KEYS) >= 839
    assert len({key.owner for key in KEYS}) >= 119
    assert {str(key) for key in KEYS} >= {"Limits.most_sound_level", "Thermal.ambient_temperature"}


@pytest.mark.parametrize("part", range(PARTS))
def test_every_key_is_read_with_its_unit_and_as_it_is_written(part: int) -> None:
    for number, key in list(enumerate(KEYS))[part::PARTS]:
        table = with_value(key)
        value = getattr(table, key.name)
        offered = units(key.hint)
        symbol = offered[number % len(offered)]
        assert same(read_back(table, key, symbol), value), f"{key} in {symbol}"
        assert getattr(load_text(key.owner, text_of(table)), key.name) == value, f"{key} written"


UNITS = dict.fromkeys(unit for key in KEYS if (unit := si.unit_of(key.hint)) is not None)


@pytest.mark.parametrize("unit", UNITS, ids=str)
def test_every_unit_that_is_offered_is_read_and_no_bare_number(unit: si.Unit) -> None:
    for symbol in si.allowed_units(unit).split(", "):
        value = si.parse_quantity(f"2.5 {symbol}", unit)
        for text in (si.format_quantity(value, unit, 17), si.typed_quantity(value, unit, 17)):
            assert si.parse_quantity(text, unit) == value
    if unit.symbol != "1":
        with pytest.raises(QuantityError, match="has no unit"):
            si.parse_quantity("2.5", unit)


def test_what_all_is_left_out_of_is_written_and_read() -> None:
    assert load_text(TwinSettings, text_of(TwinSettings())) == TwinSettings()
    with pytest.raises(ConfigError, match=r"is empty; a Display needs name"):
        load_text(Display, "")
