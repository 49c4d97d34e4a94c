"""The operating options of a sweep: what is asked of a display beside what the display is."""

from __future__ import annotations

import typing
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.design.plate.command import parse_band
from squeezefilm.physics.chain.friction_models import FrictionModel
from squeezefilm.physics.chain.standing_wave import WAVES
from squeezefilm.physics.plate.working_mode import PLATE_THEORIES
from squeezefilm.physics.render.motion.sensor import sensor_named
from squeezefilm.physics.render.resonator.compensation import COMPENSATIONS
from squeezefilm.physics.texture_files.texture_file import load_texture
from squeezefilm.physics.texture_files.trajectories import motion_from


@dataclass(frozen=True)
class Option:
    """One operating option: the unit of its numbers, or for words what reads one.

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


def _one_of(name: str, allowed: Sequence[str]) -> Option:
    def read(word: str) -> str:
        si.require_one_of(name, word, allowed)
        return word

    return Option(name, read=read)


def _yes_or_no(word: str) -> bool:
    si.require_one_of("braking", word, ("true", "false"))
    return word == "true"


OPTIONS: dict[str, Option] = {
    one.name: one
    for one in (
        Option("voltage", si.Unit("V"), {"at_least": 0}),
        Option("frequency", si.Unit("Hz"), {"above": 0}),
        Option("vibration_amplitude", si.Unit("m"), {"at_least": 0}),
        Option("normal_force", si.Unit("N"), {"above": 0}),
        Option("speed", si.Unit("m/s"), {"above": 0}),
        Option("position", si.Unit("m")),
        Option("ambient_pressure", si.Unit("Pa"), {"above": 0}),
        Option("wanted_friction", si.Unit("1"), {"at_least": 0, "at_most": 1}),
        Option("surface"),
        _one_of("model", typing.get_args(FrictionModel)),
        _one_of("theory", PLATE_THEORIES),
        Option("band", read=parse_band),
        Option("texture", read=load_texture, of_file=True),
        Option("motion", read=motion_from, between=";", of_file=True),
        Option("sensor", read=sensor_named),
        _one_of("compensation", COMPENSATIONS),
        Option("braking", read=_yes_or_no),
        _one_of("wave", WAVES),
    )
}
"""By name; they are the arguments of the functions behind the verbs, under the same names."""
