"""Values of a display that are uncertain, and the display with other values in their place."""

from __future__ import annotations

import dataclasses
import math
import typing
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, TypeVar

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.distributions import Distribution, LogNormal, Uniform
from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import Piezoceramic
from squeezefilm.physics.contact.finger.fingertip import DECAY_LENGTH_SPREAD
from squeezefilm.physics.display import DECAY_LENGTH, Display, NamedDisplay
from squeezefilm.physics.plate.layout import DiscPlate, RectangularPlate, resized
from squeezefilm.physics.plausibility.checks import described_numbers

_Whole = TypeVar("_Whole")
Origin = Literal["given", "assumed"]
Knowledge = Literal["measurable", "unknown"]
"""Knowledge: an experiment on finger or display could settle it, or nobody knows."""

SKIN_COMPLIANCE = "skin_compliance"
"""Position of the pad between all ridges at one mean gap (0) and each at its own balance (1)."""
FORCE = "finger.normal_force"


_NAMES = {
    "finger.asperities.roughness": "roughness of skin and surface",
    "finger.asperities.modulus": "modulus of the outermost skin",
    "finger.asperities.hurst_exponent": "Hurst exponent of the roughness",
    "finger.asperities.longest_wavelength": "longest wave of the roughness",
    "finger.asperities.shortest_wavelength": "shortest wave of the roughness",
    "finger.asperities.reference_gap": "gap of the asperities",
    "finger.asperities.decay_length": "decay length of the asperities",
    "finger.plateau_width": "width of a ridge's plateau",
    "finger.contact_length": "length of the contact",
    "finger.contact_decay_length": "decay length of the contact's pressure",
    "finger.decay_speed_exponent": "growth of the decay length with speed",
    "finger.contact_area_exponent": "growth of the contact with force",
    "finger.normal_force": "force of the finger",
    "finger.moisture": "moisture of the finger",
    "height_law": "law of the heights",
    "gas.slip": "slip law of the gas",
    "actuator.quality_factor": "quality factor",
    "skin_compliance": "softness of the pad",
}


def parameter_name(path: str) -> str:
    """The name for people of an uncertain value by its dotted path."""
    if path.startswith("surfaces."):
        return "roughness of the surface"
    return _NAMES.get(path, path.split(".", 1)[-1].replace("_", " "))


@dataclass(frozen=True)
class Parameter:
    """An uncertain value: its dotted path in the display, nominal value, distribution and origin.

    "given" distributions stand in the description; "assumed" ones are this package's, for values
    that control the friction and that nobody gave a spread. A value is drawn in `steps` of equal
    probability, each at its middle (None: any value), where every other one costs a table.
    """

    path: str
    nominal: float
    unit: si.Unit
    distribution: Distribution
    origin: Origin
    source: str
    knowledge: Knowledge = "measurable"
    steps: int | None = None

    @si.checked_numbers
    def drawn(self, share: si.DimensionlessArray) -> list[float]:
        """The values (in its unit) that are not exceeded with probabilities `share` (0 to 1)."""
        if self.steps is not None:
            share = (np.minimum(np.floor(share * self.steps), self.steps - 1) + 0.5) / self.steps
        return [float(quantile) for quantile in self.distribution.quantile(share)]

    @property
    def spread(self) -> tuple[str, ...]:
        """Least and largest value, in words."""
        return tuple(si.format_quantity(v, self.unit, 3) for v in self.distribution.support)


class _Assumed(NamedTuple):
    """A range in shares of the nominal value (or absolute), at most `most`, and why; with a
    `log_deviation` log-normal around the nominal value instead."""

    low: float
    high: float
    why: str
    most: float = math.inf
    absolute: bool = False
    log_deviation: float | None = None


_CHARGE, _STRESS = (f"actuator.ceramic.{kind}_coefficient" for kind in ("charge", "stress"))
_MAKERS = "APC International, Piezo Technologies"
_GRANT = "makers grant ±20 % on d33 (APC International) or ±10 % (Piezo Technologies)"

_PEOPLE = "a new person: log-normal, as seventy strokes of 14 people on glass spread"
# None was measured on a display: they keep an interval from being narrow for want of anybody's
# saying how wide it is.
_ASSUMED: dict[str, _Assumed] = {
    "finger.plateau_width": _Assumed(0.6, 1.4, "150 to 350 µm are reported; illustrative"),
    "finger.contact_length": _Assumed(0.8, 1.2, "fingers differ; illustrative"),
    "finger.contact_area_exponent": _Assumed(
        0.0, 0.5, "0 to 0.5 of the load is reported of soft pads; illustrative", absolute=True
    ),
    FORCE: _Assumed(0.6, 1.4, "0.3 to 0.7 N around 0.5 N (the paper's), and in proportion"),
    "finger.asperities.roughness": _Assumed(0.5, 1.5, "never measured on a display"),
    "finger.asperities.modulus": _Assumed(0.4, 1.6, "of the outermost skin; illustrative"),
    "finger.asperities.hurst_exponent": _Assumed(0.75, 1.25, "0.6 to 1; illustrative", 1.0),
    "finger.asperities.longest_wavelength": _Assumed(0.4, 1.0, "at most a plateau's width"),
    "finger.asperities.shortest_wavelength": _Assumed(0.4, 1.6, "where roughness ends: a guess"),
    "finger.asperities.decay_length": _Assumed(0.5, 1.5, "never measured on a display"),
    "finger.asperities.reference_gap": _Assumed(0.75, 1.25, "never measured on a display"),
    "finger.skin.mass_per_area": _Assumed(
        0.4, 1.5, "as the moving mass of 43 fingertips spreads, 5 to 95 %"
    ),
    "surface.roughness": _Assumed(0.75, 1.25, "one average for a whole surface; illustrative"),
    "surface.friction_coefficient": _Assumed(0.7, 1.3, "of skin at rest; illustrative"),
    "actuator.quality_factor": _Assumed(0.7, 1.3, "the losses of a bonded assembly; illustrative"),
    "actuator.ceramic.in_plane_stiffness": _Assumed(
        0.9, 1.1, f"makers grant ±5 % on frequencies ({_MAKERS}), twice that"
    ),
    _CHARGE: _Assumed(0.8, 1.2, _GRANT),
    _STRESS: _Assumed(0.8, 1.2, f"of d31: {_GRANT}"),
    DECAY_LENGTH: _Assumed(0.0, math.inf, _PEOPLE, log_deviation=DECAY_LENGTH_SPREAD),
    "finger.decay_speed_exponent": _Assumed(
        0.0,
        0.46,
        "speed was never varied alone: none to twice what two laboratories differ by",
        absolute=True,
    ),
}
# Each other width takes a table of solved films, each other shape of a spectrum its law.
_STEPS = {
    "finger.plateau_width": 8,
    "finger.asperities.hurst_exponent": 3,
    "finger.asperities.longest_wavelength": 3,
    "finger.asperities.shortest_wavelength": 3,
}


def uncertain_parameters(
    display: Display,
    surface: str | None = None,
    *,
    driven: bool,
    normal_force: si.Newton | None = None,
) -> tuple[Parameter, ...]:
    """The parameters that make the friction of a display on one of its surfaces uncertain.

    Every value that the description gives a distribution, and the assumed ones of what controls
    the friction. What belongs to the actuator counts only where it is `driven` by a voltage. A
    `normal_force` (N) that was asked for is uncertain in proportion.
    """
    at = [item.name for item in display.surfaces].index(display.surface(surface).name)
    own = display.finger.normal_force
    force = own if normal_force is None else normal_force
    parameters: dict[str, Parameter] = {}
    for path, origin in display.provenance.items():
        if origin.distribution is None or not _matters(path, at, driven):
            continue
        if path == FORCE and force != own:
            continue
        nominal, unit = value_at(display, path)
        path = _of_batch(display, path)
        parameters[path] = Parameter(
            path, nominal, unit, origin.distribution, "given", origin.source, steps=_STEPS.get(path)
        )
    for name, known in _ASSUMED.items():
        path = name.replace("surface.", f"surfaces.{at}.")
        if path in parameters or not _matters(path, at, driven) or not _has(display, path):
            continue
        nominal, unit = value_at(display, path)
        if nominal == 0 and not known.absolute:
            continue
        nominal = force if path == FORCE else nominal
        low, high = sorted(end if known.absolute else end * nominal for end in known[:2])
        most = display.finger.ridge_period if name == "finger.plateau_width" else known.most
        spread: Distribution = (
            Uniform(low, min(high, most))
            if known.log_deviation is None
            else LogNormal(nominal, known.log_deviation)
        )
        parameters[path] = Parameter(
            path, nominal, unit, spread, "assumed", known.why, steps=_STEPS.get(path)
        )
    parameters[SKIN_COMPLIANCE] = Parameter(
        SKIN_COMPLIANCE,
        1.0,
        si.Unit("1"),
        Uniform(0.0, 1.0),
        "assumed",
        "between all ridges at one mean gap (0) and each at its own balance (1)",
        "unknown",
    )
    return tuple(parameters.values())


def _of_batch(display: Display, path: str) -> str:
    """The path, with ``*`` for the number of a ceramic whose thickness all have, as sure: they are
    of one batch, and each draw is of all."""
    before, patches, end = path.rpartition(".patches.")
    if not patches or not end.endswith(".thickness"):
        return path
    ceramics = f"{before}{patches}"
    alike = [
        (value_at(display, other)[0], origin.distribution)
        for other, origin in display.provenance.items()
        if other.startswith(ceramics) and other.endswith(".thickness")
    ]
    is_whole = len(alike) == len(getattr(display.actuator, "patches", ()))
    return f"{ceramics}*.thickness" if is_whole and len(set(alike)) == 1 else path


def _has(display: Display, path: str) -> bool:
    """True where there is such a value: laws of asperities have fields of their own, a stator has
    no ceramic of its own, and of d31 and e31 the one counts that is believed."""
    *_, part, name = path.split(".")
    if part == "ceramic":
        ceramic = getattr(display.actuator, "ceramic", None)
        believed = {"from_d31": _CHARGE, "printed_e31": _STRESS}
        return ceramic is not None and (
            path not in (_CHARGE, _STRESS) or path == believed[ceramic.data_set]
        )
    law = display.finger.asperities
    return part != "asperities" or name in {field.name for field in dataclasses.fields(law)}


def _matters(path: str, surface: int, driven: bool) -> bool:
    head = path.split(".")
    # The skin decides what a finger takes from the vibration, and the law takes it to be rigid.
    if head[0] in ("actuator", "drive") or head[:2] == ["finger", "skin"]:
        return driven
    if head[0] == "surfaces":
        return head[1] == str(surface) and head[2] in ("roughness", "friction_coefficient")
    # How fast a finger slides is what was asked, like the voltage.
    return head[0] in ("finger", "gas") and path != "finger.speed"


def value_at(whole: Any, path: str) -> tuple[float, si.Unit]:
    """The value at a dotted path of a display or a part of one, such as ``surfaces.0.roughness``,
    and its unit.

    Raises `InputError` for a path that leads to no number.
    """
    owner, name = _place(whole, path)
    hints = si.hints_of(type(owner))
    return float(getattr(owner, name)), si.unit_of(hints[name]) or si.Unit("1")


def unit_at(whole: Any, path: str) -> tuple[si.Unit, bool]:
    """The unit of the number at a dotted path, whether it is given or not, and whether it is a
    whole number.

    Raises `InputError` for a path that leads to no number.
    """
    owner, name = _place(whole, path)
    hint = si.hints_of(type(owner))[name]
    return si.unit_of(hint) or si.Unit("1"), isinstance(getattr(owner, name), int)


def number_paths(whole: Any) -> Iterator[str]:
    """The dotted paths of the numbers of a display or a part of one, as they are given."""
    return (".".join(map(str, path)) for _, path, _ in described_numbers(whole))


def _place(whole: Any, path: str) -> tuple[Any, str]:
    """Holder of the number at a dotted path, and its name there."""
    owner = whole
    *heads, name = path.split(".")
    for part in heads:
        owner = _inside(owner, part, path)
    value = _inside(owner, name, path)
    # An optional number that the description leaves out may be given.
    if isinstance(value, bool | str | tuple) or dataclasses.is_dataclass(value):
        raise InputError(f"'{path}' of a display is no number; write the path of one")
    return owner, name


def _inside(owner: Any, part: str, path: str) -> Any:
    if part == "*" and isinstance(owner, tuple) and owner:
        return owner[0]
    if part in getattr(owner, "__dataclass_fields__", ()):
        return getattr(owner, part)
    known = (
        [str(number) for number in range(len(owner))]
        if isinstance(owner, tuple)
        else [field.name for field in dataclasses.fields(owner)]
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

    ``*`` in a path stands for every one of a list: ``patches.*.thickness``. Of a ceramic with full
    constants another ``in_plane_stiffness`` or ``charge_coefficient`` takes all stiffnesses or all
    d along in proportion, see `Piezoceramic.scaled`. Raises as `replaced`.
    """
    tree: dict[str, Any] = {}
    for path, given in values.items():
        owner, name = _place(whole, path)
        value = given
        if isinstance(given, str):
            hints = si.hints_of(type(owner))
            value = si.parse_quantity(given, si.unit_of(hints[name]) or si.Unit("1"))
        node = tree
        *heads, last = path.split(".")
        for part in heads:
            node = node.setdefault(part, {})
        node[last] = value
    return typing.cast(_Whole, _with(whole, tree))


def made_with(part: _Whole, values: Mapping[str, float]) -> _Whole:
    """A part of a display as by `with_values`; what lies on a plate or disc goes with its sides,
    since ceramics may fill it."""
    if isinstance(part, RectangularPlate | DiscPlate):
        part = typing.cast(_Whole, resized(part, values))
    return with_values(part, values)


def _with(owner: Any, tree: Mapping[str, Any]) -> Any:
    if not isinstance(tree, Mapping):
        return tree
    if isinstance(owner, tuple):
        of_all = tree.get("*", {})
        return tuple(_with(item, tree.get(str(at), of_all)) for at, item in enumerate(owner))
    changes = {name: _with(getattr(owner, name), below) for name, below in tree.items()}
    if isinstance(owner, Piezoceramic) and owner.constants is not None:
        owner = _of_one_batch(owner, changes)
    return dataclasses.replace(owner, **changes)


def _of_one_batch(ceramic: Piezoceramic, changes: Mapping[str, Any]) -> Piezoceramic:
    """A ceramic whose full constants go along with another in-plane stiffness or another d31; what
    is not of the same sign, or changed beside its constants, stays to be refused."""
    shares = {}
    for argument, name in (("stiffness", "in_plane_stiffness"), ("charge", "charge_coefficient")):
        own = getattr(ceramic, name)
        if name in changes and "constants" not in changes and own * changes[name] > 0:
            shares[argument] = changes[name] / own
    return ceramic.scaled(**shares)
