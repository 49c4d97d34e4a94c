"""Requirements for tests, and made-up evaluations by a formula in place of a plate."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from squeezefilm.core import config
from squeezefilm.core.errors import GeometryError
from squeezefilm.design.search.candidate import Design, Evaluated, Level, design_of, display_of
from squeezefilm.design.search.criteria import breaches
from squeezefilm.design.search.requirements import Requirements

TEXT = """
name = "small"
title = "A small search"
start_from = "biet2008-plate"
compare_with = ""
workspace = { length = "50 mm", width = "20 mm", largest_length = "90 mm" }
drive = { voltage = "15 V", least_voltage = "5 V" }

[limits]
most_relative_friction = 0.7
least_frequency = "20 kHz"
most_temperature_rise = "60 K"

[[shapes]]
type = "strips"
least_lines = 5
most_lines = 9
[[shapes.sheets]]
material = "as described"
thicknesses = ["1 mm", "2 mm"]
[[shapes.sheets]]
material = "aluminium 6061"
thicknesses = ["1.5 mm", "3 mm"]
cost_class = 2
[[shapes.ceramics]]
material = "as described"
thicknesses = ["0.5 mm", "1 mm"]
"""


@functools.cache
def requirements(**changes: str) -> Requirements:
    """The requirements of `TEXT`, with texts in it replaced by others."""
    text = TEXT
    for old, new in changes.items():
        assert old in text or old.replace("_", " ") in text
        text = text.replace(old, new)
    return config.load_text(Requirements, text)


def formula(wanted: Requirements, design: Design, level: Level) -> Evaluated:
    """Numbers with a known front: friction falls with the voltage, what is felt with the lines;
    heat grows with both. Solved numbers are a smooth factor off the screened ones."""
    x = design.settings
    volts, lines = float(x["voltage"]), float(x["nodal_lines"])
    factor = 1.0 if level == "screened" else 1.1 * (float(x["length"]) / 0.075) ** 0.5
    numbers: dict[str, float] = {
        "relative_friction": factor * (0.9 - 0.04 * volts + 0.03 * lines),
        "finest_period": factor * (2e-3 / lines + 5e-6 * volts),
        "resonance_frequency": 3e3 * lines / factor,
        "temperature_rise": 0.045 * volts**2 * lines,
        "half_wavelength": float(x["length"]) / lines,
        "total_thickness": 3e-3,
        "vibration_amplitude": 1e-6,
    }
    return Evaluated(design, level, numbers, breaches(numbers, wanted.limits), seconds=0.01)


def evaluated_by_formula(
    wanted: Requirements, designs: tuple[Design, ...], level: Level
) -> list[Evaluated]:
    """In place of `evaluate_all`."""
    return [formula(wanted, design, level) for design in designs]


def random_designs(wanted: Requirements, count: int, seed: int = 1) -> list[Design]:
    """Designs of the first shape, drawn evenly."""
    space, draw = wanted.spaces[0], np.random.default_rng(seed)
    shares: Any = ({one.name: draw.random() for one in space.free} for _ in range(count))
    return [design_of(0, space.at(one)) for one in shares]


def drawn(wanted: Requirements, shape: int, count: int = 30) -> list[Any]:
    """Bodies of random designs of a shape, those that can be built."""
    draw, space, found = np.random.default_rng(5), wanted.spaces[shape], []
    for _ in range(count):
        values = space.at({one.name: draw.random() for one in space.free})
        try:
            found.append(display_of(wanted, design_of(shape, values)).actuator)
        except GeometryError:
            continue
    return found
