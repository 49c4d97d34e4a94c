"""A display: actuator, surfaces, finger, gas and drive, read from a TOML file or a preset."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, ClassVar

from squeezefilm.core import presets
from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import ReadBy
from squeezefilm.core.calibration_record import CalibrationRecord, JointSpread
from squeezefilm.core.config.provenance import Provenance, References
from squeezefilm.core.config.schema import text_of
from squeezefilm.core.drive_limits import HIGHEST_VOLTAGE, TOUCH_VOLTAGE, Limits
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import FREQUENCY, ROUGHNESS
from squeezefilm.core.materials import Gas
from squeezefilm.core.results import Result, write_named, write_new
from squeezefilm.physics.contact.finger.fingertip import Finger
from squeezefilm.physics.plate.layout import Actuator
from squeezefilm.physics.plate.thermal import Thermal

DECAY_LENGTH = "finger.contact_decay_length"
"""The dotted path of the length by which fingers differ."""


@si.checked_numbers
@dataclass(frozen=True)
class Surface:
    """A surface the finger touches: its average roughness and its friction without vibration."""

    name: str
    roughness: Annotated[si.Metre, ROUGHNESS]
    friction_coefficient: Annotated[si.Dimensionless, si.Above(0), si.AtMost(10)]


_SECONDS_OF_HEAT = 10.0
_FREQUENCY_WINDOW = 0.05


@si.checked_numbers
@dataclass(frozen=True)
class Drive:
    """The electrical drive: the voltage's amplitude (zero-to-peak) at resonance, and its limits.

    The limits are what a device is told never to exceed when a texture is played. Those left out
    are assumed, see `limits`: give your own for hardware.

    Args:
        voltage: of the display's analysis, and the most that is ever played (V, zero-to-peak).
        insulation: names the insulation on the side that is touched; needed above 42 V to play.
        slew: fastest change of the amplitude (V/s); a full rise in 1 ms without one.
        continuous_voltage: amplitude that may stay for ever (V); `voltage` without one.
        heat: above it, the sum of V² − continuous_voltage² over time (V²·s); 10 s at `voltage`.
        lowest_frequency, highest_frequency: of the carrier (Hz); 5 % around its resonance.
        duty: share of the time with output (1).
        duty_window: over which the duty counts (s).

    Raises:
        InputError: a value outside its range; `limits` checks how they fit each other.
    """

    voltage: Annotated[si.Volt, si.AtLeast(0), si.AtMost(HIGHEST_VOLTAGE)]
    insulation: str = ""
    slew: Annotated[si.VoltPerSecond, si.AtLeast(0)] | None = None
    continuous_voltage: Annotated[si.Volt, si.AtLeast(0)] | None = None
    heat: Annotated[si.SquareVoltSecond, si.AtLeast(0)] | None = None
    lowest_frequency: Annotated[si.Hertz, si.AtLeast(0)] | None = None
    highest_frequency: Annotated[si.Hertz, si.AtLeast(0)] | None = None
    duty: Annotated[si.Dimensionless, si.AtLeast(0.001), si.AtMost(1)] = 1.0
    duty_window: Annotated[si.Second, si.AtLeast(0.001), si.AtMost(3600)] = 10.0

    def limits(self, frequency: si.Hertz, voltage: si.Volt | None = None) -> Limits:
        """Limits of what a device may be asked for at a carrier near `frequency` (Hz).

        `voltage` (V) asks for less than the drive's own. What the drive does not say is assumed:
        `assumed_limits` names it.

        Raises:
            InputError: more voltage than the drive's own, above 42 V without insulation, or limits
                that contradict each other.
        """
        most = self.voltage if voltage is None else voltage
        si.require("voltage", most, si.Unit("V"), above=0, at_most=self.voltage)
        limits = self._assumed(frequency)
        for name in limits:
            if (given := getattr(self, name)) is not None:
                limits[name] = given
        limits["continuous_voltage"] = min(limits["continuous_voltage"], most)
        return Limits(
            voltage=most,
            **limits,
            duty=self.duty,
            duty_window=self.duty_window,
            insulation=self.insulation,
        )

    def _assumed(self, frequency: si.Hertz) -> dict[str, float]:
        """Values of the limits that the display does not give."""
        return {
            "slew": max(1.0, 1e3 * self.voltage),
            "continuous_voltage": self.voltage,
            "heat": _SECONDS_OF_HEAT * self.voltage**2,
            "lowest_frequency": (1 - _FREQUENCY_WINDOW) * frequency,
            "highest_frequency": (1 + _FREQUENCY_WINDOW) * frequency,
        }

    @property
    def assumed_limits(self) -> tuple[str, ...]:
        """The limits that the display does not give and `limits` assumes."""
        return tuple(name for name in self._assumed(1.0) if getattr(self, name) is None)


_FACE = (si.AtLeast(-10.0), si.AtMost(10.0))


@si.checked_numbers
@dataclass(frozen=True)
class ActiveRegion:
    """The rectangle of places of the finger's centre that a display is judged on.

    From the corner of a plate, the middle of a disc, or, of a stator, x along the mean
    circumference from an antinode and y from the track's inner edge. A finger at its rim may
    overhang the face. Raises `InputError` where a side ends before it begins.
    """

    x_from: Annotated[si.Metre, *_FACE]
    x_to: Annotated[si.Metre, *_FACE, si.AtLeast("x_from")]
    y_from: Annotated[si.Metre, *_FACE]
    y_to: Annotated[si.Metre, *_FACE, si.AtLeast("y_from")]


@si.checked_numbers
@dataclass(frozen=True)
class Measured:
    """Measurements of the real display without a finger, to stand beside what is computed.

    Nothing is computed from it. Each value may say where it is from and how sure it is, as any
    value does; what is left out was not measured.

    Args:
        resonance_frequency: of the working mode (Hz).
        vibration_amplitude: zero-to-peak at the antinode and at resonance (m), at `voltage`.
        voltage: amplitude of the drive at which `vibration_amplitude` was measured (V, peak).
        quality_factor: of the working mode.

    Raises:
        InputError: an amplitude without its voltage.
    """

    resonance_frequency: Annotated[si.Hertz, FREQUENCY] | None = None
    vibration_amplitude: Annotated[si.Metre, si.Above(0), si.AtMost(1e-3)] | None = None
    voltage: Annotated[si.Volt, si.Above(0), si.AtMost(HIGHEST_VOLTAGE)] | None = None
    quality_factor: Annotated[si.Dimensionless, si.Above(0.5)] | None = None

    def __post_init__(self) -> None:
        if self.vibration_amplitude is not None and self.voltage is None:
            raise InputError(
                "measured.vibration_amplitude stands without its voltage; add the amplitude of "
                'the drive\'s voltage, like voltage = "15 V"',
                quantity="voltage",
            )


# Frozen, so that all displays may share it.
_STILL_AIR = Thermal()


@dataclass(frozen=True, repr=False)
class Display(Result):
    """A friction-modulation display, complete enough to be analysed.

    Read one with `load_display`. The first of `surfaces` is the default. `active_area` is where
    fingers are meant to be; without one all of the face that a contact does not overhang.
    `joint` and `calibration` stand in a calibrated display: what its measurements say of its values
    together, and what they were. `measured` is what was measured of the real display, and belongs
    to its body: a copy with another body must be without.
    `provenance` says where each value is from, by its dotted path in the file. In a file
    `references` are resolved: a material by its name, and the preset that it is a changed copy of.
    """

    references: ClassVar[References] = References(
        original=lambda name: preset_display(name),
        parts={
            f"actuator.{part}": functools.partial(presets.materials.table, kind=part)
            for part in presets.materials.KINDS
        },
    )

    name: str
    title: str
    actuator: Actuator
    drive: Drive
    surfaces: tuple[Surface, ...]
    finger: Finger
    gas: Gas
    thermal: Thermal = _STILL_AIR
    active_area: ActiveRegion | None = None
    measured: Measured | None = field(default=None, metadata={"found": True})
    joint: JointSpread | None = field(default=None, metadata={"found": True})
    calibration: CalibrationRecord | None = field(default=None, metadata={"found": True})
    provenance: Mapping[str, Provenance] = field(
        default_factory=dict, metadata={"loader": True}, compare=False, repr=False
    )
    _shown: ClassVar[str] = "name title actuator.type drive.voltage finger.normal_force"

    def __post_init__(self) -> None:
        if not self.surfaces:
            raise InputError("surfaces is empty; give at least one", quantity="surfaces")
        names = [surface.name for surface in self.surfaces]
        if len(set(names)) < len(names):
            raise InputError(
                f"surfaces have the same name twice ({', '.join(names)}); name each differently",
                quantity="surfaces",
            )

    @property
    def whose_finger(self) -> str:
        """Words for the finger that the display is described for: a new person's, unless the decay
        length has a source."""
        stated = self.provenance.get(DECAY_LENGTH)
        return (stated.source if stated else "") or "a new person's, as described"

    def surface(self, name: str | None = None) -> Surface:
        """The surface of that name, the first without one. Raises `InputError` if unknown."""
        if name is None:
            return self.surfaces[0]
        known = [surface.name for surface in self.surfaces]
        for surface in self.surfaces:
            if surface.name == name:
                return surface
        raise InputError(
            f"display '{self.name}' has no surface '{name}'.{si.did_you_mean(name, known)} "
            f"It has: {', '.join(known)}"
        )

    def limits(self, frequency: si.Hertz, voltage: si.Volt | None = None, *, twin: bool) -> Limits:
        """Limits of what this display's device, or its twin, may be asked for. See `Drive.limits`.

        Raises:
            InputError: as `Drive.limits` and `require_insulation`.
        """
        self.require_insulation(voltage, twin=twin)
        return self.drive.limits(frequency, voltage)

    def require_insulation(self, voltage: si.Volt | None = None, *, twin: bool) -> None:
        """Refuse more than 42 V (`voltage`, or the drive's own) without insulation at the touched
        side. One that is marked as assumed is nobody's claim yet: nobody can touch a twin, so there
        it counts, and for no other device.

        Raises:
            InputError: no insulation is named, or only an assumed one.
        """
        most = self.drive.voltage if voltage is None else voltage
        named = self.drive.insulation.strip()
        stated = self.provenance.get("drive.insulation")
        assumed = stated is not None and stated.evidence == "assumed"
        if most <= TOUCH_VOLTAGE or (named and (twin or not assumed)):
            return
        raise InputError(
            f"voltage is {most:g} V; above {TOUCH_VOLTAGE:g} V peak the display '{self.name}' must "
            "name its touch-side insulation, "
            + (
                f"and '{named}' is assumed, which counts for the twin only; say in a file of your "
                "own (squeezefilm new) where yours is from, with evidence other than assumed"
                if named
                else 'e.g. insulation = "0.5 mm glass, 4 kV tested"'
            ),
            quantity="insulation",
        )


def load_display(name_or_path: str | Path) -> Display:
    """The display of a preset's name or of a TOML file. Raises `ConfigError` if it can't be."""
    from squeezefilm.core import config

    return config.load(Display, presets.resolve(name_or_path))


def preset_display(name: str) -> Display:
    """The display of a preset's name. Raises `ConfigError` for a name that is not known."""
    return _read_once(presets.path(name))


@functools.cache
def _read_once(path: Path) -> Display:
    return load_display(path)


NamedDisplay = Annotated[Display, ReadBy(load_display)]
"""A display, or in its place the name of a preset or the path of a file (see `reads_text`)."""


def new_display_file(file: Path, preset: str, *, replace: bool = False) -> None:
    """Write a commented TOML file that starts from a preset, named for the file.

    Raises `InputError` if the file exists and is not to be replaced, `ConfigError` for a preset
    that is not known.
    """
    import re

    text = presets.path(preset).read_text(encoding="utf-8")
    # What was measured of the preset's device was not measured of this one.
    own = re.sub(r"(?m)^# [^\n]*\n\[measured\]\n(?:.+\n)*\n?", "", text)
    header = (
        f"# Started from the preset {preset}: change what is yours, the title too, "
        "and say where it is from.\n"
        "# While the next line stands, a number that you change loses the source beside it, until\n"
        f'# the words of the source are yours too.\ncopied_from = "{preset}"\n\n'
    )
    write_named(file, header + own, replace=replace)


def save_display(display: Display, path: str | Path) -> None:
    """Write a display to a TOML file, each value with its unit and its source; `load_display` reads
    the same display from it.

    Raises:
        InputError: a file that exists already or cannot be written.
    """
    write_new(Path(path), text_of(display, display.provenance))
