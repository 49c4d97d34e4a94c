"""Description of a planar standing-wave motor: plate, feet, contact, slider and cradle."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, ClassVar

from squeezefilm.core import hard_limits as hard
from squeezefilm.core import presets
from squeezefilm.core import quantities as si
from squeezefilm.core.config.load import load
from squeezefilm.core.config.provenance import Provenance, References
from squeezefilm.core.errors import GeometryError, InputError, OutOfRangeError
from squeezefilm.core.results import Result
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.loaded_mode import FreePlate
from squeezefilm.physics.plate.thermal import Thermal

_M = si.Unit("m")


@si.checked_numbers
@dataclass(frozen=True)
class Foot:
    """A foot on the plate's free face at (x, y) from its corner, on which the slider lies.

    `inclination` is the lean of its leg from the normal, towards the cradle's direction: a leg that
    leans answers a push across with a motion along.
    """

    x: Annotated[si.Metre, hard.PLACE]
    y: Annotated[si.Metre, hard.PLACE]
    inclination: Annotated[si.Radian, si.AtLeast(-1.2), si.AtMost(1.2)] = 0.0


@si.checked_numbers
@dataclass(frozen=True)
class FootContact:
    """Contact between a foot and the slider: springs along and across the leg, loss and friction.

    `damping` χ makes the normal force k δ (1 + χ δ'), which never pulls (Hunt and Crossley 1975,
    10.1115/1.3423596); the friction is Coulomb's with one coefficient. The stiffnesses are of foot,
    slider and the contact between them, in series.
    """

    normal_stiffness: Annotated[si.NewtonPerMetre, si.AtLeast(1.0), si.AtMost(1e12)]
    tangential_stiffness: Annotated[si.NewtonPerMetre, si.AtLeast(1.0), si.AtMost(1e12)]
    friction_coefficient: Annotated[si.Dimensionless, si.Above(0.0), si.AtMost(10.0)]
    damping: Annotated[si.SecondPerMetre, si.AtLeast(0.0), si.AtMost(100.0)] = 0.0

    @si.checked_numbers
    def stiffnesses(
        self, inclination: Annotated[si.Radian, si.AtLeast(-1.2), si.AtMost(1.2)]
    ) -> tuple[si.NewtonPerMetre, si.NewtonPerMetre, si.NewtonPerMetre]:
        """k_nn, k_nt and k_tt (N/m) of a leg that leans by `inclination` (rad).

        The two springs, turned. Raises `OutOfRangeError` for a leg that leans so far that friction
        would jam it: it needs k_tt > µ |k_nt|.
        """
        c, s = math.cos(inclination), math.sin(inclination)
        own, side = self.normal_stiffness, self.tangential_stiffness
        k_nn, k_tt = own * c * c + side * s * s, own * s * s + side * c * c
        k_nt = (own - side) * s * c
        if k_tt <= self.friction_coefficient * abs(k_nt):
            raise OutOfRangeError(
                f"a leg that leans by {math.degrees(inclination):.3g}° with µ = "
                f"{self.friction_coefficient:g} jams: its stiffness along, {k_tt:.3g} N/m, must be "
                f"above µ times the cross stiffness, {abs(k_nt):.3g} N/m; lean it less or give it "
                "more tangential_stiffness",
                quantity="inclination",
            )
        return k_nn, k_nt, k_tt


@si.checked_numbers
@dataclass(frozen=True)
class Cradle:
    """Cradle that presses the slider on the feet and guides it.

    `preload` stays the same however the slider bounces; `direction` is where the guide lets it go,
    counted from the length towards the width; `damping` resists its motion across, `friction` is
    the guide's own dry friction along.
    """

    preload: Annotated[si.Newton, si.Above(0.0), si.AtMost(1e5)]
    direction: Annotated[si.Radian, si.AtLeast(-6.3), si.AtMost(6.3)] = 0.0
    damping: Annotated[si.NewtonSecondPerMetre, si.AtLeast(0.0), si.AtMost(1e6)] = 0.0
    friction: Annotated[si.Newton, si.AtLeast(0.0), si.AtMost(1e5)] = 0.0


_COOL = Thermal()
_LINEAR = FreePlate()


@si.checked_numbers
@dataclass(frozen=True)
class Motor:
    """A slider on the feet of a plate that vibrates in one mode, or in two.

    `second_plate` is the same plate as its other electrodes drive it, for motion along the other
    side. `thermal` has the coercive field, a share of which the drive must not pass;
    `free_plate` how resonance and losses follow the amplitude.

    Raises `GeometryError` for no feet, or feet beside the plate; `InputError` for a second plate of
    another size.
    """

    plate: RectangularPlate
    feet: tuple[Foot, ...]
    contact: FootContact
    cradle: Cradle
    slider_mass: Annotated[si.Kilogram, si.AtLeast(1e-6), si.AtMost(1e3)]
    voltage: Annotated[si.Volt, si.Above(0.0), si.AtMost(1e4)]
    second_plate: RectangularPlate | None = None
    thermal: Thermal = _COOL
    free_plate: FreePlate = _LINEAR

    def __post_init__(self) -> None:
        if not self.feet:
            raise GeometryError("feet is empty; a motor needs at least one foot under its slider")
        hard.require_within(hard.PARTS_OF_A_PLATE, len(self.feet), "number of feet")
        for number, foot in enumerate(self.feet, 1):
            for name, at, limit in (
                ("length", foot.x, self.plate.length),
                ("width", foot.y, self.plate.width),
            ):
                if not 0 <= at <= limit:
                    raise GeometryError(
                        f"foot {number} stands beside the plate: at "
                        f"{si.format_quantity(at, _M)} along its {name}, which goes from 0 to "
                        f"{si.format_quantity(limit, _M)}; move it"
                    )
        other = self.second_plate
        if other is not None and other.extent != self.plate.extent:
            raise InputError(
                "second_plate is the same plate with its other electrodes driven, and must have "
                "the same length and width",
                quantity="second_plate",
            )


@dataclass(frozen=True, repr=False)
class MotorDescription(Result):
    """A motor as a file describes it; `provenance` says where each value is from.

    Read one with `load_actuator`. `motor.plate` may name its materials, as a display's plate does.
    """

    references: ClassVar[References] = References(
        original=lambda name: preset_motor(name),
        parts={
            f"motor.{plate}.{part}": functools.partial(presets.materials.table, kind=part)
            for plate in ("plate", "second_plate")
            for part in presets.materials.KINDS
        },
    )

    name: str
    title: str
    motor: Motor
    provenance: Mapping[str, Provenance] = field(
        default_factory=dict, metadata={"loader": True}, compare=False, repr=False
    )
    _shown: ClassVar[str] = "name title motor.voltage motor.cradle.preload"

    def __post_init__(self) -> None:
        if not isinstance(self.motor, Motor):
            raise InputError(f"motor = {self.motor!r:.60} is no Motor", quantity="motor")


def preset_motor(name: str) -> MotorDescription:
    """The motor of a preset's name. Raises `ConfigError` for a name that is not known."""
    return load(MotorDescription, presets.resolve(name, "actuator"))
