"""The names, units and values of a sweep as people read them."""

from __future__ import annotations

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.kit.numbers import shown
from squeezefilm.design.sweep.answers import FOLLOWED, without_units
from squeezefilm.design.sweep.axes import Axis
from squeezefilm.design.sweep.swept import SweptColumn


def name_of(column: Axis | SweptColumn) -> str:
    """A name without its unit, words apart: ``resonance frequency``."""
    if isinstance(column, Axis):
        return ", ".join(name.replace("_", " ") for name in column.names)
    mode = mode_of(column)
    return quantity_of(column) if mode is None else f"{mode} {quantity_of(column)}"


def mode_of(column: SweptColumn) -> str | None:
    """The label of the mode that was followed; None of any other number."""
    parts = column.name.split(".")
    return parts[1] if parts[0] == FOLLOWED else None


def quantity_of(column: SweptColumn) -> str:
    """Quantity of a column, without the mode."""
    name = without_units(column.name)
    return (name if mode_of(column) is None else name.rpartition(".")[2]).replace("_", " ")


def each_name(axis: Axis) -> list[Axis]:
    """An axis on which several values change together as one for each of them."""
    return [
        Axis((name,), (unit,), tuple((step[k],) for step in axis.steps))
        for k, (name, unit) in enumerate(zip(axis.names, axis.units, strict=True))
    ]


def step_words(axis: Axis, number: int) -> str:
    """Words for a step of an axis: ``1.5 mm``."""
    return ", ".join(
        str(value) if unit is None else shown(float(value), unit)
        for value, unit in zip(axis.steps[number], axis.units, strict=True)
    )


def cells(values: si.FloatArray, unit: si.Unit) -> tuple[str, list[str]]:
    """The unit in which numbers are read easily, and the numbers in it; a dash where there is
    none."""
    factor, symbol = scaled(values, unit)
    return symbol, ["–" if np.isnan(v) else f"{factor * v:.4g}" for v in values.tolist()]


def labelled(name: str, symbol: str) -> str:
    """A name with its unit behind it, where it has one."""
    return f"{name} ({symbol})" if symbol else name


def scaled(values: si.FloatArray, unit: si.Unit | None) -> tuple[float, str]:
    """A factor and a unit in which all of the values are read easily."""
    known = np.abs(values[np.isfinite(values)])
    most = float(known.max()) if known.size else 0.0
    if unit is None or unit.symbol == "1" or most == 0:
        return 1.0, "" if unit is None or unit.symbol == "1" else unit.symbol
    number, _, symbol = si.format_quantity(most, unit, 17).partition(" ")
    return float(number) / most, symbol
