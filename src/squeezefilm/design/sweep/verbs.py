"""The verbs that a sweep may ask of each point, from the quickest to the slowest."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from squeezefilm.core.errors import InputError
from squeezefilm.design.analysis.analyze import analyze
from squeezefilm.design.friction.command import analyze_friction
from squeezefilm.design.plate.command import solve_plate
from squeezefilm.design.sweep.followed import modes_to_follow
from squeezefilm.design.sweep.options import OPTIONS
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.chain.rendered_texture import render_texture
from squeezefilm.physics.display import Display
from squeezefilm.physics.uncertainty.parameters import with_values

USUAL_MOTION = "60 mm/s over 4 cm, 2 passes"


@dataclass(frozen=True)
class Verb:
    """What answers: its name, what is called with a display and the options that it `takes`, the
    options that leave its answers as they are, and whether it draws an interval (`samples`)."""

    name: str
    call: Callable[..., Any]
    takes: frozenset[str]
    unmoved: frozenset[str]
    draws: bool = False

    def knows(self, option: str) -> bool:
        """True where an option may stand beside this verb: it takes it, or is not moved by it."""
        return option in self.takes | self.unmoved | {"voltage", "ambient_pressure"}

    def settings(self, options: Mapping[str, Any]) -> dict[str, Any]:
        """Those of a point's options that the verb is called with."""
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
        """What the verb says of a display, as its JSON. Raises what the verb raises."""
        arguments = {name: OPTIONS[name].argument(value) for name, value in settings.items()}
        if self.draws:
            arguments["samples"] = samples
        found: dict[str, Any] = self.call(display, **arguments).summary()
        return found


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
    one.name: one
    for one in (
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
"""By name, the quickest first: what several verbs answer is asked of the first of them."""
