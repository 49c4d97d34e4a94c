"""Every option that takes a quantity: read from text in its unit, before anything is computed."""

from __future__ import annotations

import inspect
import typing
from collections.abc import Iterator
from typing import Any

import pytest

from squeezefilm.cli import app
from squeezefilm.cli.app import In, given, read_option
from squeezefilm.cli.describe import AnalyzeOptions, FilmOptions
from squeezefilm.core.errors import InputError
from squeezefilm.core.quantities import Unit, allowed_units


def options() -> Iterator[tuple[str, Any]]:
    """Every option of every command, with its annotation."""
    todo = [("", app)]
    while todo:
        name, program = todo.pop()
        todo += [
            (f"{name} {group.name}", group.typer_instance) for group in program.registered_groups
        ]
        for command in program.registered_commands:
            for option, parameter in inspect.signature(command.callback).parameters.items():
                yield f"{name} {command.callback.__name__} {option}", parameter.annotation


OPTIONS = dict(options())


def test_no_option_is_a_bare_number() -> None:
    of_floats = [name for name, hint in OPTIONS.items() if float in (hint, *parts(hint))]
    assert of_floats == []


def parts(hint: Any) -> Iterator[Any]:
    """All that an annotation is made of."""
    for part in typing.get_args(hint):
        yield part
        yield from parts(part)


def test_every_option_is_read_in_every_unit_offered_and_named_where_it_is_refused() -> None:
    units = {
        name.split()[-1]: mark.unit
        for name, hint in OPTIONS.items()
        for mark in parts(hint)
        if isinstance(mark, In)
    }
    assert len(units) >= 20
    for option, unit in units.items():
        for symbol in allowed_units(Unit(unit)).split(", "):
            assert read_option(f"2 {symbol}", option, unit) > 0
        with pytest.raises(InputError, match=f"--{option.replace('_', '-')}: "):
            read_option("2 furlongs", option, unit)


def test_a_share_may_be_given_in_percent() -> None:
    asked = AnalyzeOptions(target="biet2008-plate", wanted_friction="50 %")
    assert given(asked, leave="target")["wanted_friction"] == 0.5
    assert given(FilmOptions(excursion="30 %", tolerance="0.1 %"), leave="")["excursion"] == 0.3
