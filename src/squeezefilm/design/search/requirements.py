"""Requirements of a display, from a TOML file: what it must do, what it may take, and what it may
be built from."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Literal

from squeezefilm.core import hard_limits as hard
from squeezefilm.core import presets
from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import ReadBy
from squeezefilm.core.drive_limits import HIGHEST_VOLTAGE
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.design.search.shapes import AnyShape, Ring, shape_called
from squeezefilm.design.search.space import VOLTAGE, Space, number
from squeezefilm.design.search.stock import OWN, Body, PlateRoom
from squeezefilm.measure.fits.friction.friction_scores import with_finger
from squeezefilm.physics.contact.finger.fingertip import EXPLORING_SPEED
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.plate.layout import DiscPlate, RectangularPlate

Objective = Literal[
    "relative_friction",
    "finest_period",
    "power",
    "current",
    "temperature_rise",
    "mass",
    "thickness",
]

_SHARE = (si.Above(0.0), si.AtMost(1.0))


@si.checked_numbers
@dataclass(frozen=True)
class Workspace:
    """Workspace of a finger: `length` along the wave and `width` (m) that the centre of its contact
    explores; a plate may be up to `largest_length` and `largest_width` (no larger than that needs,
    if not given)."""

    length: Annotated[si.Metre, hard.SIDE]
    width: Annotated[si.Metre, hard.SIDE]
    largest_length: Annotated[si.Metre, hard.SIDE] | None = None
    largest_width: Annotated[si.Metre, hard.SIDE] | None = None

    def room(self, contact: si.Metre) -> PlateRoom:
        """The least and the most of a plate's sides under a contact that is so long (m), half of
        which lies beyond the workspace at either end. Raises `InputError` where most is less."""
        asked = {"length": self.length, "width": self.width}
        # To 0.1 mm, as sides are chosen; a rounding error is no step.
        least = {
            name: math.ceil(1e4 * (side + contact) - 1e-6) / 1e4 for name, side in asked.items()
        }
        most = {name: getattr(self, f"largest_{name}") or side for name, side in least.items()}
        for name, side in asked.items():
            if most[name] < least[name]:
                allowed, needed, wanted, beyond = (
                    si.format_quantity(metres, si.Unit("m"), 4)
                    for metres in (most[name], least[name], side, contact / 2)
                )
                raise InputError(
                    f"largest_{name} is {allowed}; a finger's centre that explores {wanted} needs "
                    f"{needed}, {beyond} more at either end for half its contact. Allow more, or "
                    f"ask for less {name}",
                    quantity=f"largest_{name}",
                )
        return PlateRoom((least["length"], least["width"]), (most["length"], most["width"]))


@si.checked_numbers
@dataclass(frozen=True)
class AskedTouch:
    """The finger that the requirements are about: its speed (m/s), force (N; None: that of the
    display which the search starts from), and the surface's name (None: the first)."""

    speed: Annotated[si.MetrePerSecond, hard.FINGER_SPEED] = EXPLORING_SPEED
    normal_force: Annotated[si.Newton, hard.FORCE] | None = None
    surface: str | None = None


@si.checked_numbers
@dataclass(frozen=True)
class Source:
    """The drive: the highest `voltage` (V, zero-to-peak), and the least that a design may choose
    (None: always the highest)."""

    voltage: Annotated[si.Volt, si.Above(0), si.AtMost(HIGHEST_VOLTAGE)]
    least_voltage: Annotated[si.Volt, si.Above(0), si.AtMost("voltage")] | None = None


@si.checked_numbers
@dataclass(frozen=True)
class Limits:
    """Limits that a design must not exceed, or must reach; None where it may be anything.

    `most_relative_friction` is µ′/µ at the best place, with `confidence` "nominal" as described, or
    "95 %" that of the upper end of its interval. `least_area` is the share of the active area on
    which that friction must be reached. `most_finest_period` is that of the finest square grating
    felt at the finger's speed (m). `least_neighbour` is how far the nearest driven mode that takes
    part must be, in half-bandwidths. `most_field` (V/m) and `most_stress` (Pa) are of the ceramic,
    the stress that of the working mode's wave. `most_deflection` (m) is that under `press` (N) on
    the middle of a plate held along its outermost nodal lines. `most_sound_level` is in dB re
    20 µPa at 0.5 m in the loudest direction. `most_cost` is the highest class of cost of its
    materials. `least_yield` is the share of plates, made with the tolerances, that meet all
    other limits.
    """

    most_relative_friction: Annotated[si.Dimensionless, *_SHARE] | None = None
    confidence: Literal["nominal", "95 %"] = "nominal"
    least_area: Annotated[si.Dimensionless, *_SHARE] | None = None
    most_finest_period: Annotated[si.Metre, hard.SIDE] | None = None
    least_frequency: Annotated[si.Hertz, hard.FREQUENCY, si.AtMost("most_frequency")] | None = None
    most_frequency: Annotated[si.Hertz, hard.FREQUENCY] | None = None
    least_squeeze_number: Annotated[si.Dimensionless, si.Above(0.0)] | None = None
    most_current: Annotated[si.Ampere, si.Above(0.0)] | None = None
    most_power: Annotated[si.Watt, si.Above(0.0)] | None = None
    most_temperature_rise: Annotated[si.Kelvin, si.Above(0.0)] | None = None
    most_mass: Annotated[si.Kilogram, si.Above(0.0)] | None = None
    most_thickness: Annotated[si.Metre, hard.LAYER] | None = None
    least_neighbour: Annotated[si.Dimensionless, si.Above(0.0)] | None = None
    most_field: Annotated[si.VoltPerMetre, si.Above(0.0)] | None = None
    most_stress: Annotated[si.Pascal, si.Above(0.0)] | None = None
    press: Annotated[si.Newton, hard.FORCE] = 5.0
    most_deflection: Annotated[si.Metre, si.Above(0.0)] | None = None
    most_sound_level: Annotated[si.Decibel, si.Above(0.0)] | None = None
    most_cost: Annotated[int, si.AtLeast(1), si.AtMost(9)] | None = None
    least_yield: Annotated[si.Dimensionless, *_SHARE] | None = None

    @property
    def unasked_of_made(self) -> tuple[str, ...]:
        """The limits given that plates made of a drawing are not judged by: only plates solved in
        three dimensions have what they bound."""
        alone = ("least_area", "least_neighbour", "most_sound_level")
        unasked = tuple(name for name in alone if getattr(self, name) is not None)
        sure = self.confidence == "95 %" and self.most_relative_friction is not None
        return (*unasked, *(("most_relative_friction",) if sure else ()))


@si.checked_numbers
@dataclass(frozen=True)
class Tolerances:
    """Tolerances between what is drawn and what is made: standard deviations, of lengths in m, of
    material constants as shares of their values."""

    thickness: Annotated[si.Metre, si.AtLeast(0.0)] = 20e-6
    ceramic_thickness: Annotated[si.Metre, si.AtLeast(0.0)] = 20e-6
    sides: Annotated[si.Metre, si.AtLeast(0.0)] = 50e-6
    young_modulus: Annotated[si.Dimensionless, si.AtLeast(0.0), si.Below(0.3)] = 0.02
    ceramic_stiffness: Annotated[si.Dimensionless, si.AtLeast(0.0), si.Below(0.3)] = 0.05
    charge_coefficient: Annotated[si.Dimensionless, si.AtLeast(0.0), si.Below(0.3)] = 0.1
    quality_factor: Annotated[si.Dimensionless, si.AtLeast(0.0), si.Below(0.5)] = 0.1


def toleranced(body: Body) -> dict[str, str]:
    """Dotted paths of the lengths that a workshop makes of a body, each with its tolerance's name
    in `Tolerances`. All ceramics are of one batch."""
    if isinstance(body, DiscPlate):
        own = {"ceramic_thickness": "ceramic_thickness", "diameter": "sides"}
    else:
        own = {"patches.*.thickness": "ceramic_thickness", "length": "sides", "width": "sides"}
    return {"thickness": "thickness", **own}


# Frozen, so that all requirements may share them.
_TOUCH, _LIMITS, _TOLERANCES = AskedTouch(), Limits(), Tolerances()


@si.checked_numbers
@dataclass(frozen=True)
class Requirements:
    """Demands on a display, and what it may be built from. Read them with `load_requirements`.

    Attributes:
        name, title: what it is called, in files and for people.
        start_from: a preset or a file of a display: finger, gas, surfaces, cooling, and the
            materials "as described" are its own.
        compare_with: a display that the front is set beside, by the same questions; "" for none.
        objectives: what is made small, two or three: "relative_friction" is µ′/µ at the best
            place, "finest_period" the finest square grating felt at the finger's speed.
        quality_factor: of the whole assembly (None: that of the display which it starts from);
            nothing a plate's drawing says tells it, so that it is assumed until measured.
        finger: whose finger it is for, see `with_finger`; asked for beside the file.
    """

    name: str
    title: str
    start_from: str
    workspace: Workspace
    drive: Source
    shapes: tuple[AnyShape, ...]
    touch: AskedTouch = _TOUCH
    limits: Limits = _LIMITS
    tolerances: Tolerances = _TOLERANCES
    objectives: tuple[Objective, ...] = ("relative_friction", "finest_period")
    compare_with: str = ""
    quality_factor: Annotated[si.Dimensionless, hard.QUALITY] | None = None
    note: str = ""
    finger: str = field(default="new", metadata={"loader": True})

    def __post_init__(self) -> None:
        if not self.shapes:
            raise InputError("shapes is empty; give at least one", quantity="shapes")
        if not 2 <= len(set(self.objectives)) <= 3 or len(set(self.objectives)) < len(
            self.objectives
        ):
            raise InputError(
                f"objectives = {list(self.objectives)}; give two or three that differ: with one "
                "there is no front to choose from",
                quantity="objectives",
            )
        self._require_plate("start_from")
        if self.compare_with:
            self._require_plate("compare_with")
        base = self.base
        base.surface(self.touch.surface)
        # So that what cannot be chosen is refused here, before anything is computed.
        _ = self.spaces

    def _require_plate(self, key: str) -> None:
        """Refuse a display that is none, or of which no material is known."""
        name = getattr(self, key)
        try:
            display = load_display(name)
        except ConfigError as error:
            raise InputError(f"{key} = '{name}': {error}", quantity=key) from error
        if not isinstance(display.actuator, RectangularPlate | DiscPlate):
            raise InputError(
                f"{key} = '{name}' is a measured ring, of which no material is known; give a "
                "plate or a disc",
                quantity=key,
            )

    @functools.cached_property
    def started_from(self) -> Display:
        """The display of `start_from`, as its file has it, under the finger."""
        return with_finger(load_display(self.start_from), self.finger)

    @functools.cached_property
    def base(self) -> Display:
        """The display that the search starts from, with the finger that the requirements name."""
        display = self.started_from
        touch, finger = self.touch, display.finger
        force = finger.normal_force if touch.normal_force is None else touch.normal_force
        area_at = finger.contact_area_force or finger.normal_force
        finger = replace(finger, normal_force=force, speed=touch.speed, contact_area_force=area_at)
        first = display.surface(touch.surface)
        others = tuple(surface for surface in display.surfaces if surface is not first)
        return replace(
            display,
            finger=finger,
            surfaces=(first, *others),
            active_area=None,
            measured=None,
            joint=None,
            calibration=None,
        )

    @property
    def own(self) -> Body:
        """The body whose materials are those "as described"."""
        actuator = self.base.actuator
        assert isinstance(actuator, RectangularPlate | DiscPlate), "checked when it was built"
        return actuator

    @property
    def assembly_quality(self) -> si.Dimensionless:
        """The quality factor that every design is taken to have."""
        return self.own.quality_factor if self.quality_factor is None else self.quality_factor

    def room_of(self, shape: AnyShape) -> PlateRoom:
        """Room that a shape must give and may take: half the finger's contact more than the
        workspace at every edge; round a ring, whose track the finger follows, the workspace."""
        contact = math.sqrt(self.base.finger.contact_area())
        return self.workspace.room(0.0 if isinstance(shape, Ring) else contact)

    @functools.cached_property
    def spaces(self) -> tuple[Space, ...]:
        """Choices that there are, shape by shape. Raises `InputError` for ranges that are none."""
        least = self.drive.least_voltage or self.drive.voltage
        volts = number(VOLTAGE, least, self.drive.voltage, "V")
        names = [shape_called(shape) for shape in self.shapes]
        return tuple(
            Space(
                name if names.count(name) == 1 else f"{name} {1 + names[:k].count(name)}",
                (*shape.variables(self.room_of(shape)), volts),
            )
            for k, (name, shape) in enumerate(zip(names, self.shapes, strict=True))
        )

    @property
    def assumed(self) -> tuple[str, ...]:
        """Assumptions that every answer of the search rests on and nobody measured."""
        own = f"materials {OWN} are those of {self.start_from}"
        return (
            f"a quality factor of {self.assembly_quality:g} for every assembly, whatever it is "
            "made of: only a measurement says it",
            f"finger, surface and cooling of {self.start_from}; {own}",
            f"finger: {self.base.whose_finger}",
            "the contact's constants (asperities and plateaus), which decide the friction",
            "tolerances as the file has them, normal and independent",
            *(
                f"the yield asks nothing of {name}: only a solved plate can be asked"
                for name in self.limits.unasked_of_made
            ),
        )


def load_requirements(name_or_path: str | Path) -> Requirements:
    """The requirements of a preset's name or of a TOML file. Raises `ConfigError` if they can't be.

    A display's file named in them is looked for from where the program runs.
    """
    from squeezefilm.core import config

    return config.load(Requirements, presets.resolve(name_or_path, "requirements"))


NamedRequirements = Annotated[Requirements, ReadBy(load_requirements)]
"""Requirements, or in their place the name of a preset or the path of a file (see `reads_text`)."""
