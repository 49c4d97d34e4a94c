"""A display: actuator, surfaces, finger, gas and drive, read from a TOML file or a preset."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from squeezefilm.config.provenance import Provenance
from squeezefilm.contact.finger import Finger
from squeezefilm.errors import InputError
from squeezefilm.materials import Gas
from squeezefilm.plate.layout import Actuator
from squeezefilm.quantities import (
    Dimensionless,
    Metre,
    Unit,
    Volt,
    did_you_mean,
    require,
)


@dataclass(frozen=True)
class Surface:
    """A surface the finger touches: its average roughness and its friction without vibration."""

    name: str
    roughness: Metre
    friction_coefficient: Dimensionless

    def __post_init__(self) -> None:
        require("roughness", self.roughness, Unit("m"), above=0)
        require("friction_coefficient", self.friction_coefficient, above=0, at_most=10)


HIGHEST_VOLTAGE: Volt = 2000.0


@dataclass(frozen=True)
class Drive:
    """The electrical drive: the voltage's amplitude (zero-to-peak) at resonance."""

    voltage: Volt

    def __post_init__(self) -> None:
        require("voltage", self.voltage, Unit("V"), at_least=0, at_most=HIGHEST_VOLTAGE)


@dataclass(frozen=True)
class Display:
    """A friction-modulation display, complete enough to be analysed.

    Read one with `load_display`. The first of `surfaces` is the default. `provenance` says where
    each value is from, by its dotted path in the file.
    """

    name: str
    title: str
    actuator: Actuator
    drive: Drive
    surfaces: tuple[Surface, ...]
    finger: Finger
    gas: Gas
    provenance: Mapping[str, Provenance] = field(
        default_factory=dict, metadata={"loader": True}, compare=False, repr=False
    )

    def __post_init__(self) -> None:
        if not self.surfaces:
            raise InputError("surfaces is empty; give at least one", quantity="surfaces")
        names = [surface.name for surface in self.surfaces]
        if len(set(names)) < len(names):
            raise InputError(
                f"surfaces have the same name twice ({', '.join(names)}); name each differently",
                quantity="surfaces",
            )

    def surface(self, name: str | None = None) -> Surface:
        """The surface of that name, the first without one. Raises `InputError` if unknown."""
        if name is None:
            return self.surfaces[0]
        known = [surface.name for surface in self.surfaces]
        for surface in self.surfaces:
            if surface.name == name:
                return surface
        raise InputError(
            f"display '{self.name}' has no surface '{name}'.{did_you_mean(name, known)} "
            f"It has: {', '.join(known)}"
        )


def load_display(name_or_path: str | Path) -> Display:
    """The display of a preset's name or of a TOML file. Raises `ConfigError` if it can't be."""
    from squeezefilm import config, presets

    return config.load(Display, presets.resolve(name_or_path))


def new_display_file(file: Path, preset: str, *, replace: bool = False) -> None:
    """Write a commented TOML file that starts from a preset, named for the file.

    Raises `InputError` if the file exists and is not to be replaced, `ConfigError` for a preset
    that is not known.
    """
    import re

    from squeezefilm import presets
    from squeezefilm.results import write_whole

    text = presets.path(preset).read_text(encoding="utf-8")
    if file.is_dir():
        raise InputError(f"{file} is a directory; give the name of a TOML file to write")
    if file.exists() and not replace:
        raise InputError(f"{file} exists; give another name, or --force to replace it")
    name = re.sub(r"[^A-Za-z0-9._-]+", "-", file.stem) or "display"
    own = re.sub(r'(?m)^name = ".*"$', f'name = "{name}"', text, count=1)
    header = (
        f"# Started from the preset {preset}: change what is yours, and say where it is from.\n"
    )
    write_whole(file, header + own)
