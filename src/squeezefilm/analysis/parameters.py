"""Which values of a display are uncertain, and the display with other values in their place."""

from __future__ import annotations

import dataclasses
import typing
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, TypeVar

from squeezefilm import quantities as si
from squeezefilm.display import Display, NamedDisplay
from squeezefilm.distributions import Distribution, Uniform
from squeezefilm.errors import InputError
from squeezefilm.from_text import reads_text

_Whole = TypeVar("_Whole")
Origin = Literal["given", "assumed"]

SKIN_COMPLIANCE = "skin_compliance"
"""Where the pad lies between all ridges at one mean gap (0) and each at its own balance (1)."""


@dataclass(frozen=True)
class Parameter:
    """One uncertain value: its dotted path in the display, nominal value, distribution and origin.

    "given" distributions stand in the description; "assumed" ones are this package's, for values
    that control the friction and that nobody gave a spread.
    """

    path: str
    nominal: float
    unit: si.Unit
    distribution: Distribution
    origin: Origin
    source: str


# Shares of the nominal value. None was measured on a display: they keep an interval from being
# narrow for want of anybody's saying how wide it is.
_ASSUMED: dict[str, tuple[float, float, str]] = {
    "finger.plateau_width": (0.6, 1.4, "150 to 350 µm are reported; illustrative"),
    "finger.contact_length": (0.8, 1.2, "fingers differ; illustrative"),
    "finger.asperities.decay_length": (0.5, 1.5, "illustrative, never measured on a display"),
    "finger.asperities.reference_gap": (0.75, 1.25, "illustrative, never measured on a display"),
    "finger.skin.damping_per_area": (0.4, 1.6, "from one published impedance, its area not known"),
    "surface.roughness": (0.75, 1.25, "one average roughness for a whole surface; illustrative"),
    "actuator.quality_factor": (0.7, 1.3, "the losses of a bonded assembly; illustrative"),
}


def uncertain_parameters(
    display: Display, surface: str | None = None, *, driven: bool
) -> tuple[Parameter, ...]:
    """The parameters that make the friction of a display on one of its surfaces uncertain.

    Every value that the description gives a distribution, and the assumed ones of what controls
    the friction. What belongs to the actuator counts only where it is `driven` by a voltage.
    """
    at = [item.name for item in display.surfaces].index(display.surface(surface).name)
    found: dict[str, Parameter] = {}
    for path, origin in display.provenance.items():
        if origin.distribution is None or not _matters(path, at, driven):
            continue
        nominal, unit = value_at(display, path)
        found[path] = Parameter(path, nominal, unit, origin.distribution, "given", origin.source)
    for name, (low, high, why) in _ASSUMED.items():
        path = name.replace("surface.", f"surfaces.{at}.")
        if path in found or not _matters(path, at, driven):
            continue
        nominal, unit = value_at(display, path)
        if nominal == 0:
            continue
        top = high * nominal
        if name == "finger.plateau_width":
            top = min(top, display.finger.ridge_period)
        found[path] = Parameter(path, nominal, unit, Uniform(low * nominal, top), "assumed", why)
    found[SKIN_COMPLIANCE] = Parameter(
        SKIN_COMPLIANCE,
        1.0,
        si.Unit("1"),
        Uniform(0.0, 1.0),
        "assumed",
        "between all ridges at one mean gap (0) and each at its own balance (1)",
    )
    return tuple(found.values())


def _matters(path: str, surface: int, driven: bool) -> bool:
    head = path.split(".")
    # The skin decides what a finger takes from the vibration, and the law takes it to be rigid.
    if head[0] in ("actuator", "drive") or head[:2] == ["finger", "skin"]:
        return driven
    if head[0] == "surfaces":
        # The base friction scales µ′ and not µ′/µ.
        return head[1] == str(surface) and head[2] == "roughness"
    return head[0] in ("finger", "gas")


def value_at(whole: Any, path: str) -> tuple[float, si.Unit]:
    """The value at a dotted path of a display or a part of one, such as ``surfaces.0.roughness``,
    and its unit.

    Raises `InputError` for a path that leads to no number.
    """
    owner, name = _place(whole, path)
    hints = typing.get_type_hints(type(owner), include_extras=True)
    return float(getattr(owner, name)), si.unit_of(hints[name]) or si.Unit("1")


def _place(whole: Any, path: str) -> tuple[Any, str]:
    """What holds the number at a dotted path, and its name there."""
    owner = whole
    *heads, name = path.split(".")
    for part in heads:
        owner = _inside(owner, part, path)
    found = _inside(owner, name, path)
    # An optional number that the description leaves out may be given.
    if isinstance(found, bool | str | tuple) or dataclasses.is_dataclass(found):
        raise InputError(f"'{path}' of a display is no number; write the path of one")
    return owner, name


def _inside(owner: Any, part: str, path: str) -> Any:
    if part == "*" and isinstance(owner, tuple) and owner:
        return owner[0]
    known = (
        [str(number) for number in range(len(owner))]
        if isinstance(owner, tuple)
        else [one.name for one in dataclasses.fields(owner)]
        if dataclasses.is_dataclass(owner)
        else []
    )
    if part not in known:
        raise InputError(
            f"a display has no '{path}': there is no '{part}'.{si.did_you_mean(part, known)} "
            f"There are: {', '.join(known) or 'no parts'}"
        )
    return owner[int(part)] if isinstance(owner, tuple) else getattr(owner, part)


@reads_text
def replaced(display: NamedDisplay, values: Mapping[str, float | str]) -> Display:
    """The display with other values at dotted paths: ``{"actuator.thickness": "1.5 mm"}``.

    Raises `InputError` for a path that leads to no number, and for what cannot be there.
    """
    return with_values(display, values)


def with_values(whole: _Whole, values: Mapping[str, float | str]) -> _Whole:
    """A display, or a part of one such as its plate, with other values at dotted paths.

    ``*`` in a path stands for every one of a list: ``patches.*.thickness``. Raises as `replaced`.
    """
    tree: dict[str, Any] = {}
    for path, given in values.items():
        owner, name = _place(whole, path)
        value = given
        if isinstance(given, str):
            hints = typing.get_type_hints(type(owner), include_extras=True)
            value = si.parse_quantity(given, si.unit_of(hints[name]) or si.Unit("1"))
        node = tree
        *heads, last = path.split(".")
        for part in heads:
            node = node.setdefault(part, {})
        node[last] = value
    return typing.cast(_Whole, _with(whole, tree))


def _with(owner: Any, tree: Mapping[str, Any]) -> Any:
    if not isinstance(tree, Mapping):
        return tree
    if isinstance(owner, tuple):
        of_all = tree.get("*", {})
        return tuple(_with(item, tree.get(str(at), of_all)) for at, item in enumerate(owner))
    changes = {name: _with(getattr(owner, name), below) for name, below in tree.items()}
    return dataclasses.replace(owner, **changes)
