"""Body of `analyze` for the file of a motor or of a skin-stretch array."""

from __future__ import annotations

from dataclasses import fields
from typing import Any, get_args, get_type_hints

from typer.models import OptionInfo

from squeezefilm.actuators.report import dispatch
from squeezefilm.cli.app import answer, read_option, working
from squeezefilm.core.errors import InputError
from squeezefilm.core.kit.folder import require_folder

_TAKEN = ("target", "voltage", "out", "as_json")


def analyze_actuator(asked: Any) -> None:
    """Analyse an actuator by `analyze`'s options. Raises `InputError` for those that only a display
    has."""
    usual = type(asked)(asked.target)
    other = [
        _flag(type(asked), field.name)
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
        analyzed = dispatch.analyze_actuator(asked.target, voltage, step)
        written = None
        if asked.out is not None:
            step("figures")
            written = analyzed.write(analyzed.analysis, asked.out)
    answer(asked.as_json, analyzed.analysis, analyzed.show, report=written)


def _flag(options: type, name: str) -> str:
    """The option as it is typed."""
    for mark in get_args(get_type_hints(options, include_extras=True)[name]):
        if isinstance(mark, OptionInfo):
            for said in (mark.default, *(mark.param_decls or ())):
                if isinstance(said, str) and said.startswith("--"):
                    return said
    return f"--{name.replace('_', '-')}"
