"""The verbs that a sweep may ask of each point, from the quickest to the slowest."""

from __future__ import annotations

import dataclasses
import typing
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.design.analysis.analyze import analyze
from squeezefilm.design.friction import analyze_friction
from squeezefilm.design.plate.command import parse_band, solve_plate
from squeezefilm.design.sweep.followed import modes_to_follow
from squeezefilm.physics.chain.friction_models import FrictionModel
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.chain.rendered_texture import render_texture
from squeezefilm.physics.chain.standing_wave import WAVES
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.working_mode import PLATE_THEORIES
from squeezefilm.physics.render.motion.sensor import sensor_named
from squeezefilm.physics.render.resonator.compensation import COMPENSATIONS
from squeezefilm.physics.texture_files.texture_file import load_texture
from squeezefilm.physics.texture_files.trajectories import motion_from
from squeezefilm.physics.uncertainty.parameters import with_values


@dataclass(frozen=True)
class VerbOption:
    """An operating option: the unit of its numbers, or for words what reads one.

    Numbers are `bounds`, words for `si.require`; `between` separates several words in a text. A
    word may name a file where `of_file` says so.
    """

    name: str
    unit: si.Unit | None = None
    bounds: Mapping[str, Any] = field(default_factory=dict)
    read: Callable[[str], Any] = str
    between: str = ","
    of_file: bool = False

    def number(self, value: float) -> float:
        """A number of this option. Raises `InputError` for one outside its bounds."""
        si.require(self.name, value, self.unit or si.Unit("1"), **self.bounds)
        return value

    def word(self, given: Any) -> str:
        """A word of this option as it stands in a table. Raises `InputError` for one that is not
        known."""
        if not isinstance(given, str):
            raise InputError(f"{self.name} = {given!r:.60} is no text; write a name")
        self.read(given)
        return given

    def argument(self, value: Any) -> Any:
        """The value as an argument of a verb."""
        return value if self.unit is not None else self.read(value)


def _one_of(name: str, allowed: Sequence[str]) -> VerbOption:
    def read(word: str) -> str:
        si.require_one_of(name, word, allowed)
        return word

    return VerbOption(name, read=read)


def _yes_or_no(word: str) -> bool:
    si.require_one_of("braking", word, ("true", "false"))
    return word == "true"


OPTIONS: dict[str, VerbOption] = {
    option.name: option
    for option in (
        VerbOption("voltage", si.Unit("V"), {"at_least": 0}),
        VerbOption("frequency", si.Unit("Hz"), {"above": 0}),
        VerbOption("vibration_amplitude", si.Unit("m"), {"at_least": 0}),
        VerbOption("normal_force", si.Unit("N"), {"above": 0}),
        VerbOption("speed", si.Unit("m/s"), {"above": 0}),
        VerbOption("position", si.Unit("m")),
        VerbOption("ambient_pressure", si.Unit("Pa"), {"above": 0}),
        VerbOption("wanted_friction", si.Unit("1"), {"at_least": 0, "at_most": 1}),
        VerbOption("surface"),
        _one_of("model", typing.get_args(FrictionModel)),
        _one_of("theory", PLATE_THEORIES),
        VerbOption("band", read=parse_band),
        VerbOption("texture", read=load_texture, of_file=True),
        VerbOption("motion", read=motion_from, between=";", of_file=True),
        VerbOption("sensor", read=sensor_named),
        _one_of("compensation", COMPENSATIONS),
        VerbOption("braking", read=_yes_or_no),
        _one_of("wave", WAVES),
    )
}
"""Options by name; arguments of the functions behind the verbs have the same names."""


USUAL_MOTION = "60 mm/s over 4 cm, 2 passes"


@dataclass(frozen=True)
class Verb:
    """A verb that answers: its name, what is called with a display and the options that it `takes`,
    the options that leave its answers as they are, and whether it draws an interval (`samples`)."""

    name: str
    call: Callable[..., Any]
    takes: frozenset[str]
    unmoved: frozenset[str]
    draws: bool = False

    def knows(self, option: str) -> bool:
        """True where an option may stand beside this verb: it takes it, or is not moved by it."""
        return option in self.takes | self.unmoved | {"voltage", "ambient_pressure"}

    def settings(self, options: Mapping[str, Any]) -> dict[str, Any]:
        """Options of a point that the verb is called with."""
        return {name: value for name, value in options.items() if name in self.takes}

    def display(self, display: Display, options: Mapping[str, Any]) -> Display:
        """The display with those options that the verb knows only as values of it."""
        volts, pressure = options.get("voltage"), options.get("ambient_pressure")
        if volts is not None and "voltage" not in self.takes:
            display = with_values(display, {"drive.voltage": volts})
        if pressure is not None:
            display = dataclasses.replace(display, gas=display.gas.at_pressure(pressure))
        return display

    def answer(self, display: Display, settings: Mapping[str, Any], samples: int) -> dict[str, Any]:
        """Answer of the verb about a display, as its JSON. Raises what the verb raises."""
        arguments = {name: OPTIONS[name].argument(value) for name, value in settings.items()}
        if self.draws:
            arguments["samples"] = samples
        summary: dict[str, Any] = self.call(display, **arguments).summary()
        return summary


def _render(display: Display, **options: Any) -> Any:
    if "texture" not in options:
        raise InputError('render needs a texture; give vary = "texture=sine-3mm"')
    return render_texture(display, **{"motion": USUAL_MOTION, **options})


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


_OF_POINT = _words("voltage frequency vibration_amplitude normal_force surface model speed")
_OF_TEXTURES = _words("texture motion sensor compensation braking wave")
_FELT = _words("normal_force speed surface model position")
_OF_OTHERS = _OF_TEXTURES | {"band", "wanted_friction"}

VERBS: dict[str, Verb] = {
    verb.name: verb
    for verb in (
        Verb("predict", predict, _OF_POINT | {"position", "theory"}, _OF_OTHERS),
        Verb(
            "render",
            _render,
            _OF_TEXTURES | _words("voltage normal_force surface model"),
            _words("band wanted_friction"),
        ),
        Verb("followed", modes_to_follow, _words("band"), _OF_OTHERS | _FELT),
        Verb("plate", solve_plate, _words("band"), _OF_OTHERS | _FELT),
        Verb(
            "friction",
            analyze_friction,
            _OF_POINT | {"position", "wanted_friction"},
            _OF_OTHERS,
            draws=True,
        ),
        Verb("analyze", analyze, _OF_POINT | {"theory"}, _OF_OTHERS, draws=True),
    )
}
"""Verbs by name, the quickest first: what several verbs answer is asked of the first of them."""
