"""The names, units and values of a sweep as people read them."""

from __future__ import annotations

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.report.kit.numbers import micro, shown
from squeezefilm.search.axes import Axis
from squeezefilm.search.swept import Column


def name_of(one: Axis | Column) -> str:
    """A name without its unit, words apart: ``resonance frequency``."""
    if isinstance(one, Axis):
        return ", ".join(name.replace("_", " ") for name in one.names)
    name = one.name.removesuffix(one.unit.suffix)
    if name.startswith("followed."):
        name = f"{name.rpartition('.')[2]} of followed modes"
    return name.replace("_", " ")


def step_words(axis: Axis, number: int) -> str:
    """One step of an axis in words: ``1.5 mm``."""
    return ", ".join(
        str(value) if unit is None else shown(float(value), unit)
        for value, unit in zip(axis.steps[number], axis.units, strict=True)
    )


def value_words(value: float, unit: si.Unit) -> str:
    """A number of a column in words; a dash where there is none."""
    return "–" if np.isnan(value) else shown(value, unit)


def scaled(values: si.FloatArray, unit: si.Unit | None) -> tuple[float, str]:
    """A factor and a unit in which all of the values are read easily."""
    known = np.abs(values[np.isfinite(values)])
    most = float(known.max()) if known.size else 0.0
    if unit is None or unit.symbol == "1" or most == 0:
        return 1.0, "" if unit is None or unit.symbol == "1" else unit.symbol
    number, _, symbol = micro(si.format_quantity(most, unit, 17)).partition(" ")
    return float(number) / most, symbol
