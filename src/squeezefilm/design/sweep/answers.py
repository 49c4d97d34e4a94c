"""Numbers that a sweep can ask for: every number in the JSON of the verbs, by its dotted name.

`answers.toml` holds the names by verb; `tools/sweep_answers.py` writes it, and a test compares it
with what the verbs say.
"""

from __future__ import annotations

import functools
import math
import re
import tomllib
import typing
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from typing import Any

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.design.sweep.verbs import VERBS

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
        return self.key if self._plain else f"{self.verb}.{self.key}"

    @property
    def _plain(self) -> bool:
        """True where the key alone asks this verb."""
        verbs = (verb for verb in VERBS if verb != FOLLOWED and _known(verb, self.key))
        return next(verbs, None) == self.verb

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
        exact = [wanted] if any(_pattern(key).fullmatch(wanted) for key in keys) else []
        plain = exact or _spelled_out(wanted, keys)
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
