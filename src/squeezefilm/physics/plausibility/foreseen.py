"""What is said of a display before its solve begins: doubts, what to expect, how long it takes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from squeezefilm.core import presets
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.progress import about
from squeezefilm.core.regular_file import read_toml_text
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.size import SolveSize, solve_size
from squeezefilm.physics.plausibility.checks import require_plausible
from squeezefilm.physics.plausibility.expected import Expectation, expectation


@dataclass(frozen=True)
class Foreseen:
    """Of a display that nothing speaks against: `doubts` in sentences, the closed estimate and the
    size of the solve, None where there is none."""

    display: Display
    doubts: tuple[str, ...]
    expected: Expectation | None
    size: SolveSize | None

    @property
    def sentence(self) -> str:
        """What to expect and how long it takes; empty where nothing is known."""
        if self.expected is None:
            return ""
        said = f"expected {self.expected.sentence}"
        if self.size is None:
            return said
        return (
            f"{said}; solving it in three dimensions ({_thousands(self.size.unknowns)} unknowns) "
            f"takes {about(self.size.seconds)}"
        )


def _thousands(count: int) -> str:
    return f"{count:,}".replace(",", " ")


def foreseen(name_or_path: str | Path, voltage: si.Volt | None = None) -> Foreseen:
    """A display of a preset's name or a file, checked before anything is solved.

    `voltage` (V, zero-to-peak) is what it will be driven with, its own without one. Raises
    `ConfigError` for a file that cannot be read or a display that cannot be right, with the lines.
    """
    display = load_display(name_or_path)
    file = presets.resolve(name_or_path)
    text = read_toml_text(file)
    doubts = require_plausible(display, voltage, text=text, file=str(file))
    expected = expectation(display.actuator)
    return Foreseen(display, doubts, expected, _size(display, expected))


def _size(display: Display, expected: Expectation | None) -> SolveSize | None:
    plate = display.actuator
    if expected is None or not isinstance(plate, RectangularPlate):
        return None
    try:
        return solve_size(plate, plate.working_label, expected.frequency)
    except InputError:
        # Too thin or too large for solid elements: the solve says so itself.
        return None
