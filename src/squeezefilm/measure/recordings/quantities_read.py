"""Columns of a file as quantities: units and conventions turned into SI and zero-to-peak, each with
a sentence that says so, and what cannot be right refused at its line; and the order of rows."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConfigError, QuantityError
from squeezefilm.core.hard_limits import (
    FINGER_SPEED,
    FORCE,
    FREQUENCY,
    SIDE,
    TOUCHED_VIBRATION,
    VIBRATION,
)
from squeezefilm.measure.recordings.described import CONVENTIONS, MOST_VOLTAGE, Column, Given
from squeezefilm.measure.recordings.description import Description
from squeezefilm.measure.recordings.files.raw_table import RawTable, parted
from squeezefilm.measure.recordings.kinds import Told

_SCALE = re.compile(r"\s*([+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?)\s*(\S.*?)\s*")
_DECIBELS = re.compile(r"\s*dB\s+re\s+(\S.*?)\s*")
# Of two alike 0 dB stand for 1.
_RATIOS = ("reflection", "transmission", "gain")
_IN_DECIBELS = (
    "magnitude",
    "admittance_magnitude",
    "displacement",
    "velocity",
    "reflection",
    "transmission",
    "gain",
)
_MOST_DECIBELS = 600.0
_LEAST_ROWS = 3


class Quantity(NamedTuple):
    """Bounds of what a column may hold: its unit, the largest magnitude that is believed, the least
    value."""

    unit: si.Unit
    most: float
    least: float = -math.inf


_M, _HZ, _S, _N, _V = (si.Unit(symbol) for symbol in ("m", "Hz", "s", "N", "V"))
_FARAD, _HENRY = si.Unit("F"), si.Unit("H")
_OHM, _SIEMENS, _RAD, _ONE = (si.Unit(symbol) for symbol in ("ohm", "S", "rad", "1"))
_SPEED, _PER_VOLT, _SPEED_PER_VOLT = si.Unit("m/s"), si.Unit("m/V"), si.Unit("m/s/V")

QUANTITIES: dict[str, Quantity] = {
    "frequency": Quantity(_HZ, FREQUENCY.most, FREQUENCY.least),
    "magnitude": Quantity(_OHM, 1e12, 1e-6),
    "admittance_magnitude": Quantity(_SIEMENS, 1e6, 1e-12),
    **dict.fromkeys(("resistance", "reactance"), Quantity(_OHM, 1e12)),
    **dict.fromkeys(("conductance", "susceptance"), Quantity(_SIEMENS, 1e6)),
    **dict.fromkeys(("series_capacitance", "parallel_capacitance"), Quantity(_FARAD, 1.0)),
    **dict.fromkeys(("series_inductance", "parallel_inductance"), Quantity(_HENRY, 1e6)),
    "parallel_resistance": Quantity(_OHM, 1e15),
    **dict.fromkeys(("quality_factor", "dissipation_factor"), Quantity(_ONE, 1e9)),
    **dict.fromkeys(("reflection", "reflection_imaginary"), Quantity(_ONE, 10.0)),
    **dict.fromkeys(("transmission", "transmission_imaginary"), Quantity(_ONE, 10.0)),
    "gain": Quantity(_ONE, 1e6),
    "shunt_voltage": Quantity(_V, MOST_VOLTAGE),
    "phase": Quantity(_RAD, 1e6),
    "displacement": Quantity(_M, VIBRATION.most),
    # A millimetre at 30 kHz; nothing that is meant here moves faster.
    "velocity": Quantity(_SPEED, 200.0),
    "voltage": Quantity(_V, MOST_VOLTAGE),
    "coherence": Quantity(_ONE, 1.000001, 0.0),
    **dict.fromkeys(("position", "x", "y"), Quantity(_M, SIDE.most)),
    "spatial_period": Quantity(_M, SIDE.most, 1e-6),
    "time": Quantity(_S, 1e9),
    **dict.fromkeys(
        ("normal_force", "tangential_force", "friction_force"), Quantity(_N, FORCE.most)
    ),
    **dict.fromkeys(
        ("vibration_amplitude", "decay_amplitude"), Quantity(_M, TOUCHED_VIBRATION.most, 0.0)
    ),
    **dict.fromkeys(("friction_coefficient", "relative_friction"), Quantity(_ONE, 1e3)),
    "spread": Quantity(_ONE, 1e3, 0.0),
    "speed": Quantity(_SPEED, FINGER_SPEED.most, FINGER_SPEED.least),
    "damping": Quantity(si.Unit("N*s/m"), 1e4),
    "mass": Quantity(si.Unit("kg"), 1.0),
}
_PER_VOLT_OF = {
    "displacement": Quantity(_PER_VOLT, VIBRATION.most),
    "velocity": Quantity(_SPEED_PER_VOLT, 200.0),
}
"""The same over the voltage of the drive."""
for _known in (QUANTITIES, _PER_VOLT_OF):
    _known |= {f"{name}_imaginary": _known[name] for name in ("displacement", "velocity")}


@dataclass
class Reading:
    """A table as it is taken apart by its description; facts and doubts are kept on the way."""

    description: Description
    table: RawTable
    columns: Any
    facts: list[tuple[str, str]] = field(default_factory=list)
    doubts: list[str] = field(default_factory=list)

    @property
    def said(self) -> Any:
        """The keys of the description, as those of its kind."""
        return self.description.said

    def has(self, name: str) -> bool:
        """True where the description names a column for a quantity."""
        return getattr(self.columns, name, None) is not None

    def told(self) -> Told:
        """Words of the description on the recording itself."""
        return self.description.said.told(self.table.file)

    def wanting(self, name: str, why: str) -> ConfigError:
        """The error of a quantity for which no column is named."""
        unit = QUANTITIES[name].unit.symbol
        return self.description.error(
            f"no column is named for the {words(name)}: {why}; write {name} = {{ column = …, "
            f'unit = "{unit}" }} (the file has {self.table.columns_in_words})',
            ["columns"],
        )

    def refuse(self, name: str, message: str, row: int | None = None) -> ConfigError:
        """An error in the column of a quantity, at a row."""
        return self.table.error(f"{words(name)}: {message}", row, self._place(name))

    def per_volt(self, name: str) -> bool:
        """True where the unit of a motion is one over volts."""
        _, dimension = self._scale(name)
        return name in _PER_VOLT_OF and dimension == _PER_VOLT_OF[name].unit.dimension

    def take(self, name: str, *, amplitude: bool = False, like: str = "") -> si.FloatArray:
        """The SI values of a quantity, shape (rows,); with `amplitude` zero-to-peak ones, of which
        the description must say how they are given. A spread is `like` the quantity it is of.

        Raises `ConfigError`: a column that is not there, a unit of another dimension or other than
        the file's own, a convention that is missing or has no place, a value that cannot be.
        """
        if not self.has(name):
            raise self.wanting(name, "it is needed")
        column, place = self._column(name), self._place(name)
        count = self.table.values.shape[0]
        # At rest and vibrating: the least that compares friction.
        if count < (2 if self.said.kind == "friction curve" else _LEAST_ROWS):
            raise self.table.error(
                f"has {count} rows, too few for a recording; give the whole file"
            )
        scale, dimension = self._scale(name)
        meant = QUANTITIES[like]._replace(least=0.0) if like else QUANTITIES[name]
        if self.per_volt(name):
            meant = _PER_VOLT_OF[name]
        if dimension != meant.unit.dimension:
            wanted = si.allowed_units(meant.unit)
            raise self.description.error(
                f"{self._unit_words(column)} is no unit of a {words(name)}; write one of {wanted}",
                ["columns", name, "unit"],
            )
        values = scale * self._linear(name, column, place)
        self._require_own_unit(name, column, place)
        said = f"column {place + 1}"
        said += f" '{self.table.names[place]}'" if self.table.names[place] else ""
        said += f" in {self._unit_words(column)}"
        if amplitude:
            values = values * self._convention(name, column)
            said += f", given as {column.given_as}"
        elif column.given_as is not None:
            raise self.description.error(
                f'given_as = "{column.given_as}" has no place here: the {words(name)} is '
                + ("over volts of the same kind" if self.per_volt(name) else "no amplitude")
                + "; delete it",
                ["columns", name, "given_as"],
            )
        self._require_believable(name, values, meant)
        ends = values.min(), values.max()
        low, high = (quantity(value, meant.unit) for value in ends)
        if name == "phase":
            low, high = (f"{np.degrees(value):.1f} deg" for value in ends)
            if scale < 1 and np.max(np.abs(values)) < scale * np.pi:
                self.doubts.append(f"the phase stays within {low} and {high}: is its unit rad?")
        self.facts.append((words(name), f"{low} to {high}, from {said}"))
        return np.asarray(values)

    def take_any(self, name: str) -> tuple[si.FloatArray, str]:
        """The values of a column in the unit that the description names, whichever that is."""
        column, place = self._column(name), self._place(name)
        self._require_own_unit(name, column, place)
        self.facts.append((words(name), f"from column {place + 1} in {column.unit}"))
        return self.table.values[:, place], column.unit

    def given_voltage(self, given: Given) -> si.Volt:
        """The zero-to-peak amplitude (V) of a voltage that was the same throughout."""
        volts = given.amplitude * CONVENTIONS[given.given_as]
        shown = quantity(volts, _V)
        self.facts.append(("drive voltage", f"{shown} zero-to-peak, given as {given.given_as}"))
        return volts

    def _column(self, name: str) -> Column:
        column: Column = getattr(self.columns, name)
        if column.unit.strip() == "dB" and name in _RATIOS:
            return replace(column, unit="dB re 1 1")
        return column

    def _place(self, name: str) -> int:
        wanted = self._column(name).column
        place = self.table.index(wanted)
        if place is None:
            names = self.table.names
            # Their units may be left out.
            near = si.did_you_mean(str(wanted), (*(parted(name)[0] for name in names), *names))
            raise self.description.error(
                f"the file has no column {wanted!r}.{near} It has {self.table.columns_in_words}",
                ["columns", name, "column"],
            )
        return place

    def _scale(self, name: str) -> tuple[float, si.Dimension]:
        """The scale to SI and the dimension of a column's unit, times its scale."""
        column = self._column(name)
        factor, total = 1.0, None
        decibels = _DECIBELS.fullmatch(column.unit)
        unit = column.unit if decibels is None else decibels[1]
        for key, text in (("unit", unit), ("scale", column.scale)):
            if text is None:
                continue
            scaled = key == "scale" or decibels is not None
            match = _SCALE.fullmatch(text) if scaled else None
            if key == "scale" and match is None:
                raise self.description.error(
                    f"'{text}' is no scale; write what one recorded unit stands for, like "
                    '"125 mm/s/V"',
                    ["columns", name, key],
                )
            number, text = (1.0, text) if match is None else (float(match[1]), match[2])
            try:
                scale, dimension = si.parse_unit(text)
            except QuantityError as error:
                si_unit, allowed = QUANTITIES[name].unit, si.allowed_units(QUANTITIES[name].unit)
                message = f"{error}; units of a {words(name)}: {allowed}"
                if text.strip().startswith("dB"):
                    message = (
                        f"'{text}' does not say what 0 dB stands for; write unit = "
                        f'"dB re 1 {si_unit.symbol}", or another {words(name)} in its place'
                    )
                raise self.description.error(message, ["columns", name, key]) from error
            factor *= number * float(scale)
            total = dimension if total is None else _sum(total, dimension)
        assert total is not None
        return factor, total

    def _linear(self, name: str, column: Column, place: int) -> si.FloatArray:
        """The column's numbers over its unit: those in decibels, 20 log10 of an amplitude over what
        0 dB stands for, made linear. Raises `ConfigError` for what is no amplitude."""
        values = self.table.values[:, place]
        if _DECIBELS.fullmatch(column.unit) is None:
            return values
        if (
            name not in _IN_DECIBELS
            or self.has(f"{name}_imaginary")
            or hasattr(self.columns, "time")
        ):
            raise self.description.error(
                f"the {words(name)} is no amplitude here, and only amplitudes have decibels; "
                "export linear values",
                ["columns", name, "unit"],
            )
        if np.any(values > _MOST_DECIBELS):
            row = int(np.argmax(values))
            raise self.refuse(name, f"{values[row]:.6g} dB cannot be right: are these dB?", row)
        self.facts.append((words(name), "decibels made linear, 20 dB for each factor of 10"))
        return np.asarray(10 ** (values / 20))

    def _unit_words(self, column: Column) -> str:
        return column.unit if column.scale is None else f"{column.unit} times {column.scale}"

    def _require_own_unit(self, name: str, column: Column, place: int) -> None:
        """Refuse a unit other than the one that the file's own header has in brackets."""
        moved = self.table.moved[place] if self.table.moved else ""
        if moved and moved != name.removesuffix("_imaginary"):
            acceleration = moved == "acceleration"
            advice = "export velocity or displacement" if acceleration else f"write {moved} = …"
            raise self.description.error(
                f"the description says {words(name)}, and the file that column {place + 1} holds "
                f"{moved}; {advice}, or name another column",
                ["columns", name, "column"],
            )
        own = self.table.unit_in_name(place)
        # Seconds and siemens, both "(S)" in one maker's files.
        if own is None or column.unit == own or (name, own) == ("time", "S"):
            return
        if _DECIBELS.fullmatch(column.unit) is None and si.parse_unit(own) == si.parse_unit(
            column.unit
        ):
            return
        where = "" if self.table.header_line is None else f" (line {self.table.header_line})"
        raise self.description.error(
            f"the description says {column.unit}, and the file{where}, column {place + 1}, "
            f"'{self.table.names[place]}'; write unit = \"{own}\", or mend the file's header",
            ["columns", name, "unit"],
        )

    def _convention(self, name: str, column: Column) -> float:
        if column.given_as is None:
            raise self.description.error(
                f"it must be said how the amplitude of the {words(name)} is given, since that "
                'changes it twofold; write given_as = "zero-to-peak", "peak-to-peak" or "rms" in '
                "its braces",
                ["columns", name],
            )
        return CONVENTIONS[column.given_as]

    def _require_believable(self, name: str, values: si.FloatArray, meant: Quantity) -> None:
        bad = np.flatnonzero((np.abs(values) > meant.most) | (values < meant.least))
        if not bad.size:
            return
        row = int(bad[0])
        least = "" if meant.least == -math.inf else f"from {quantity(meant.least, meant.unit)} "
        raise self.refuse(
            name,
            f"{quantity(values[row], meant.unit)} cannot be right; {least}up to "
            f"{quantity(meant.most, meant.unit)} are believed: is "
            f"{self._unit_words(self._column(name))} the unit of this column, and is it the column "
            "that is meant?",
            row,
        )


def words(name: str) -> str:
    """A quantity's name as a person reads it."""
    return {"magnitude": "impedance magnitude"}.get(name, name.replace("_", " "))


def quantity(value: float, unit: si.Unit) -> str:
    """A value with its unit."""
    if unit == _OHM and abs(value) >= 1e4:
        return f"{value / 1e3:.4g} kohm"
    return si.format_quantity(float(value), unit)


def _sum(first: si.Dimension, second: si.Dimension) -> si.Dimension:
    a, b, c, d, e, f = (x + y for x, y in zip(first, second, strict=True))
    return a, b, c, d, e, f


def rising_order(reading: Reading, name: str, values: si.FloatArray) -> slice:
    """The rows in which a quantity rises: as they are, or turned around where all of them fall."""
    if np.all(np.diff(values) < 0):
        reading.facts.append((words(name), "swept downwards; the rows were turned around"))
        return slice(None, None, -1)
    require_rising(reading, name, values)
    return slice(None)


def require_rising(reading: Reading, name: str, values: si.FloatArray) -> None:
    """Refuse values that do not rise from row to row, with the row."""
    still = np.flatnonzero(np.diff(values) <= 0)
    if not still.size:
        return
    row, unit = int(still[0]) + 1, QUANTITIES[name].unit
    now, before = (quantity(values[k], unit) for k in (row, row - 1))
    if values[row] == values[row - 1]:
        raise reading.refuse(
            name, f"{now} stands twice, in {both_rows(reading, row - 1, row)}; delete one row", row
        )
    table = reading.table.values
    others = [
        k
        for k in range(table.shape[1])
        if np.all(np.diff(table[:, k]) > 0) and not np.array_equal(table[:, k], values)
    ]
    hint = "give the rows in order"
    if others:
        called = reading.table.names[others[0]]
        hint = f"column {others[0] + 1} '{called}' does: are columns swapped in the description?"
    raise reading.refuse(
        name, f"{now} follows {before}, and must rise from row to row; {hint}", row
    )


def both_rows(reading: Reading, first: int, second: int) -> str:
    """Two rows by their lines."""
    lines = reading.table.lines
    if lines is None:
        return f"values {first + 1} and {second + 1}"
    return f"lines {lines[first]} and {lines[second]}"
