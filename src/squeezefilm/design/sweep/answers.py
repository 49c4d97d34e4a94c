"""Verbs that a sweep may ask of each point, from the quickest to the slowest, and the numbers that
they answer with.

`answers.toml` holds the dotted name of every number in the JSON of each verb;
`tools/sweep_answers.py` writes it, and a test compares it with what the verbs say.
"""

from __future__ import annotations

import dataclasses
import functools
import math
import re
import tomllib
import typing
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import resources
from typing import Any

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.design.analysis.analyze import analyze
from squeezefilm.design.friction import analyze_friction
from squeezefilm.design.plate.command import parse_band, solve_plate
from squeezefilm.design.sweep.followed import modes_to_follow
from squeezefilm.physics.chain.pad_law import FrictionModel
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.chain.rendered_texture import render_texture
from squeezefilm.physics.chain.standing_wave import WAVES
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.working_mode import PLATE_THEORIES
from squeezefilm.physics.render.motion.estimator import sensor_named
from squeezefilm.physics.render.resonator.envelope import COMPENSATIONS
from squeezefilm.physics.texture_files.texture_file import load_texture
from squeezefilm.physics.texture_files.trajectories import motion_from
from squeezefilm.physics.uncertainty.parameters import with_values


@dataclass(frozen=True)
class VerbOption:
    """An operating option: the unit of its numbers, or for words what reads one. A number of a
    display that a sweep varies is one too, maybe a `whole` one.

    Numbers are `bounds`, words for `si.require`; `between` separates several words in a text. A
    word may name a file where `of_file` says so.
    """

    name: str
    unit: si.Unit | None = None
    bounds: Mapping[str, Any] = field(default_factory=dict)
    read: Callable[[str], Any] = str
    between: str = ","
    of_file: bool = False
    whole: bool = False

    def value(self, given: Any) -> float | str:
        """A value as it stands in a table: a word, or the number (SI) of a text or a number.
        Raises `InputError` for one that is none, of another dimension, or not allowed."""
        if self.unit is not None:
            return self.number(self.quantity(given) if isinstance(given, str) else given)
        if not isinstance(given, str):
            raise InputError(f"{self.name} = {given!r:.60} is no text; write a name")
        self.read(given)
        return given

    def quantity(self, text: str) -> float:
        """The number (SI) that a text says. Raises `InputError` for what is none of its unit."""
        try:
            return si.parse_quantity(text, self.unit or si.Unit("1"))
        except InputError as error:
            raise InputError(f"{self.name}: {error}", quantity=self.name) from error

    def number(self, value: float) -> float:
        """A number (SI) of this option. Raises `InputError` for what is none, and for one outside
        its bounds."""
        si.require(self.name, value, self.unit or si.Unit("1"), **self.bounds, axes=0)
        value = float(value)
        if not self.whole:
            return value
        if not value.is_integer():
            raise InputError(f"{self.name} = {value} must be a whole number; choose steps that are")
        return int(value)

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
    the options that may not stand beside it, since they would move its answers (`strange`; all
    others leave them as they are), and whether it draws an interval (`samples`)."""

    name: str
    call: Callable[..., Any]
    takes: frozenset[str]
    strange: frozenset[str] = frozenset()
    draws: bool = False

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
_OF_MODES = _words("frequency vibration_amplitude theory")

VERBS: dict[str, Verb] = {
    verb.name: verb
    for verb in (
        Verb("predict", predict, _OF_POINT | {"position", "theory"}),
        Verb(
            "render",
            _render,
            _words("texture motion sensor compensation braking wave")
            | _words("voltage normal_force surface model"),
            _OF_MODES | {"speed", "position"},
        ),
        Verb("followed", modes_to_follow, _words("band"), _OF_MODES),
        Verb("plate", solve_plate, _words("band"), _OF_MODES),
        Verb(
            "friction",
            analyze_friction,
            _OF_POINT | {"position", "wanted_friction"},
            _words("theory"),
            draws=True,
        ),
        Verb("analyze", analyze, _OF_POINT | {"theory"}, _words("position"), draws=True),
    )
}
"""Verbs by name, the quickest first: what several verbs answer is asked of the first of them."""


FOLLOWED = "followed"
"""The verb whose modes are followed over the points; its answers are a column for each mode."""


@dataclass(frozen=True)
class AskedNumber:
    """A number that is asked for: the verb that answers, and its key in the verb's JSON."""

    verb: str
    key: str

    @property
    def column(self) -> str:
        """The name of its column: the key, with the verb before it where another is asked first."""
        verbs = (verb for verb in VERBS if verb != FOLLOWED and _known(verb, self.key))
        return self.key if next(verbs, None) == self.verb else f"{self.verb}.{self.key}"

    @property
    def unit(self) -> si.Unit:
        """The unit that the key says, "1" where it says none."""
        return unit_in(self.key)

    @property
    def draws(self) -> bool:
        """True where it is part of an interval, for which the verb draws samples."""
        return _DRAWN.search(self.key) is not None


_DRAWN = re.compile(
    r"interval|^uncertainty|^power_W|_median|^active_area\.odds|share_(never|beyond_drive)"
)


def _units() -> dict[str, si.Unit]:
    """The units of the house by the suffix that a key has for them, and two beside SI."""
    marks = (si.unit_of(value) for value in vars(si).values() if typing.get_args(value))
    units = [mark for mark in marks if mark is not None and mark.suffix]
    others = {"_per_m": si.Unit("1/m")}
    return others | {unit.suffix: unit for unit in (*units, si.Unit("dB"), si.Unit("VA"))}


_UNITS = _units()
_SUFFIX = re.compile(
    f"({'|'.join(sorted(map(re.escape, _UNITS), key=len, reverse=True))})(?=\\.|$)"
)


@functools.cache
def catalogue() -> Mapping[str, tuple[str, ...]]:
    """The keys that each verb answers; ``*`` stands for a number from 0 on in a list."""
    text = resources.files("squeezefilm.design.sweep").joinpath("answers.toml").read_text("utf-8")
    known: dict[str, tuple[str, ...]] = {}
    for verb, lines in tomllib.loads(text).items():
        keys: list[str] = []
        for line in lines:
            group, alike, other = line.partition(": ")
            theirs = known[other] if alike else (line,)
            keys += [
                key for key in theirs if not alike or f"{key}.".startswith(group and f"{group}.")
            ]
        known[verb] = tuple(keys)
    return known


def numbers_of(summary: Any, path: str = "") -> Iterator[tuple[str, float]]:
    """Every number of a JSON summary with its dotted key; yes and no are 1 and 0, none is NaN."""
    if isinstance(summary, Mapping):
        for key, item in summary.items():
            if key != "provenance":
                yield from numbers_of(item, f"{path}.{key}" if path else key)
    elif isinstance(summary, list):
        for number, item in enumerate(summary):
            yield from numbers_of(item, f"{path}.{number}")
    elif isinstance(summary, int | float):
        yield path, float(summary)
    elif summary is None:
        yield path, math.nan


def unit_in(key: str) -> si.Unit:
    """The unit that a key or a column's name says, "1" where it says none."""
    suffixes = _SUFFIX.findall(key)
    return _UNITS[suffixes[-1]] if suffixes else si.Unit("1")


def without_units(key: str) -> str:
    """A key as it may be asked for: without the units in it."""
    return _SUFFIX.sub("", key)


@functools.cache
def _pattern(known: str) -> re.Pattern[str]:
    return re.compile(re.escape(known).replace(r"\*", r"\d{1,4}"))


def _known(verb: str, key: str) -> bool:
    return any(_pattern(pattern).fullmatch(key) for pattern in catalogue()[verb])


def asked_for(texts: Sequence[str]) -> tuple[AskedNumber, ...]:
    """Numbers that texts ask for, in their order, each once: names with commas between them.

    A name is a dotted key, with its unit or without, with the verb before it or without; the name
    of a group asks for all numbers in it. Raises `InputError` for a name that no verb knows, or
    that stands for two quantities.
    """
    wanted: dict[AskedNumber, None] = {}
    for text in texts:
        for name in text.split(","):
            if name.strip():
                wanted.update(dict.fromkeys(_asked_by(name.strip())))
    if not wanted:
        raise InputError(
            "nothing is asked for; give ask = relative_friction,resonance_frequency",
            quantity="ask",
        )
    return tuple(wanted)


def _asked_by(name: str) -> list[AskedNumber]:
    head, _, rest = name.partition(".")
    if name == FOLLOWED:
        return [AskedNumber(FOLLOWED, "frequency_Hz")]
    verbs = [head] if head in VERBS and rest else [verb for verb in VERBS if verb != FOLLOWED]
    wanted = rest if verbs == [head] else name
    for verb in verbs:
        keys = catalogue()[verb]
        plain = [wanted] if _known(verb, wanted) else _spelled_out(wanted, keys)
        if len(plain) > 1:
            raise InputError(f"ask {name} may be {' or '.join(plain)}; say which", quantity="ask")
        group = [key for key in keys if without_units(key).startswith(f"{without_units(wanted)}.")]
        if meant := plain or [key for key in group if "*" not in key]:
            return [AskedNumber(verb, key) for key in meant]
        if group:
            raise InputError(
                f"ask {name} is a list of {verb}; say which of it, like "
                f"{without_units(group[0]).replace('*', '0')}",
                quantity="ask",
            )
    raise _unknown(name, verbs, wanted)


def _spelled_out(wanted: str, keys: Sequence[str]) -> list[str]:
    """The keys that a name without units stands for, the numbers of lists as they are in it."""
    meant = []
    for key in keys:
        if _pattern(without_units(key)).fullmatch(wanted):
            numbers = iter(re.findall(r"(?<=\.)\d{1,4}(?=\.|$)", wanted))
            meant.append(re.sub(r"\*", lambda _, rest=numbers: next(rest), key))  # type: ignore[misc]
    return meant


def _unknown(name: str, verbs: Sequence[str], wanted: str) -> InputError:
    plain = {verb: [without_units(known_key) for known_key in catalogue()[verb]] for verb in verbs}
    every = [key for verb in verbs for key in plain[verb]]
    inside = [known_key for known_key in every if wanted.lower() in known_key.lower()]
    near = f" Did you mean {', '.join(dict.fromkeys(inside[:5]))}?" if inside else ""
    told: dict[str, str] = {}
    for verb in verbs:
        for key in plain[verb]:
            told.setdefault(key.partition(".")[0], verb)
    heads = "; ".join(
        f"{verb}: {', '.join(head for head, of in told.items() if of == verb)}" for verb in verbs
    )
    return InputError(
        f"ask {name}: no verb answers that.{near or si.did_you_mean(wanted, every)} There are, "
        f"by the verb that is asked first: {heads}. squeezefilm sweep --answers lists all",
        quantity="ask",
    )
