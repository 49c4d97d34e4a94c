"""Recordings out of tables and descriptions, one function a kind."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.measure.recordings import assembled_friction, kinds
from squeezefilm.measure.recordings.circuits_read import (
    IMPEDANCES,
    SIZES,
    Fixture,
    with_phase,
)
from squeezefilm.measure.recordings.described import Column
from squeezefilm.measure.recordings.description import Description, ImpedanceColumns
from squeezefilm.measure.recordings.files.raw_table import RawTable
from squeezefilm.measure.recordings.kinds import CeramicBar
from squeezefilm.measure.recordings.motions import moment_by_moment, motion_of, motion_per_volt
from squeezefilm.measure.recordings.quantities_read import (
    QUANTITIES,
    Reading,
    both_rows,
    quantity,
    require_rising,
    rising_order,
    words,
)
from squeezefilm.physics.plate.ring.ceramic_disc import CeramicDisc

_HZ, _S = si.Unit("Hz"), si.Unit("s")
_REFLECTED = ("reflection", "transmission")
# Times are printed with few digits; half a sample off is another sample's time.
_UNEVEN = 0.5


def assembled(description: Description, table: RawTable) -> tuple[kinds.Recording, Reading]:
    """The recording in a table, and what was taken on the way.

    Raises `ConfigError`, with file, line and column or key, for whatever does not fit.
    """
    said: Any = description.said
    columns = said.columns
    if columns is None:
        columns = _own_columns(description, table)
    if said.points is not None and said.points != table.values.shape[0]:
        raise description.error(
            f"points = {said.points}, and the file has {table.values.shape[0]} rows: it is cut "
            "short, or another one",
            ["points"],
        )
    reading = Reading(description, table, columns)
    reading.doubts += table.doubts
    return _OF_KIND[said.kind](reading), reading


def _own_columns(description: Description, table: RawTable) -> ImpedanceColumns:
    """The columns of a file that describes itself."""
    if not table.described:
        raise description.error(
            "the table [columns] is missing, and the file does not say itself what its columns "
            'hold; write [columns] with lines like frequency = { column = 1, unit = "Hz" } (the '
            f"file has {table.columns_in_words})",
            ["columns"],
        )
    return ImpedanceColumns(
        **{name: Column(column, unit) for name, column, unit in table.described}
    )


def _impedance(reading: Reading) -> kinds.ImpedanceSweep:
    frequency = reading.take("frequency")
    named = _named(reading)
    named |= {"gain"} if reading.has("shunt_voltage") else set()
    alone = len(named) == 1 and named < set(SIZES)
    value: Any = _size(reading, min(named), frequency) if alone else _admittance(reading, frequency)
    order = rising_order(reading, "frequency", frequency)
    kept = _in_band(reading, frequency[order])
    frequency, value = frequency[order][kept], value[order][kept]
    outside = reading.table.outside(frequency)
    reading.doubts += [] if outside is None else [outside]
    in_series = (reading.said.shunt or 0.0) if alone else 0.0
    if alone:
        value = with_phase(frequency, value)
        value = value / (1 - value * in_series)
    return kinds.ImpedanceSweep(
        frequency,
        value,
        reading.told(),
        _ceramic(reading),
        reading.said.compensated,
        phase_recorded=not alone,
        in_series=in_series,
    )


def _size(reading: Reading, name: str, frequency: si.HertzArray) -> si.FloatArray:
    """The size of the admittance (S) where no phase was recorded, with a shunt that was told."""
    for key in ("correct", "bar", "disc", "open", "short"):
        if getattr(reading.said, key):
            raise reading.description.error(
                f"only the {words(name)} is named, and {key} asks for the phase too; record it, "
                f"or leave {key} out to have a circuit fitted to the sizes",
                [key],
            )
    if name == "gain":
        return _gain(reading) / _fixture(reading, name, frequency).shunt
    value = reading.take(name)
    return 1 / value if name == "magnitude" else value


def _admittance(reading: Reading, frequency: si.HertzArray) -> si.ComplexArray:
    """The admittance (S) that the pair of columns makes."""
    pair, first, second = _first_and_second(reading)
    fixture = _fixture(reading, pair[0], frequency)
    with np.errstate(divide="ignore", invalid="ignore"):
        value = IMPEDANCES[pair](first, second, fixture)
    zero = np.flatnonzero(~(np.abs(value) >= QUANTITIES["magnitude"].least))
    if zero.size:
        raise reading.refuse(pair[0], "an impedance of zero cannot be", int(zero[0]))
    endless = np.flatnonzero(~np.isfinite(value))
    if endless.size:
        raise reading.refuse(pair[0], "this makes no finite impedance", int(endless[0]))
    return _corrected(reading, 1 / value)


def _named(reading: Reading) -> set[str]:
    """Quantities of an impedance that are named."""
    return {name for pair in IMPEDANCES for name in pair if reading.has(name)}


def _first_and_second(
    reading: Reading,
) -> tuple[tuple[str, ...], si.FloatArray, si.FloatArray]:
    """The pair that is named and its values; two voltages are the pair of their quotient."""
    if reading.has("shunt_voltage"):
        return ("gain", "phase"), _gain(reading), reading.take("phase")
    named = _named(reading)
    for pair in IMPEDANCES:
        if named == set(pair):
            first, second = (reading.take(name) for name in pair)
            return pair, first, second
    shown = "; ".join(" with ".join(pair) for pair in IMPEDANCES)
    raise reading.description.error(
        f"one pair must be named of an impedance: {shown}; named are "
        f"{', '.join(sorted(named)) or 'none'}",
        ["columns"],
    )


def _gain(reading: Reading) -> si.FloatArray:
    """The gain that was recorded, or the quotient of the two voltages that were."""
    if not reading.has("shunt_voltage"):
        return reading.take("gain")
    over, whole = (reading.take(name, amplitude=True) for name in ("shunt_voltage", "voltage"))
    still = np.flatnonzero(np.abs(whole) < np.finfo(float).tiny)
    if still.size:
        raise reading.refuse("voltage", "nothing was driven here", int(still[0]))
    return over / whole


def _fixture(reading: Reading, first: str, frequency: si.HertzArray) -> Fixture:
    """Quantities beside the pair, with a fact that says so."""
    reference = reading.said.reference or reading.table.reference
    if first in _REFLECTED:
        where = "at the port" if first == "reflection" else "in series between the ports"
        reading.facts.append(("assumed", f"the device is {where}, of {reference:g} ohm"))
    if first == "gain" and reading.said.shunt is None:
        raise reading.description.error(
            "a gain makes an impedance with the resistor that it was taken over: the device "
            "between drive and resistor, the other channel across the resistor; write shunt = "
            '"100 ohm"',
            ["shunt"],
        )
    return Fixture(2 * np.pi * frequency, reference, reading.said.shunt or 1.0)


def _in_band(reading: Reading, frequency: si.HertzArray) -> slice:
    """The rows of the band that is told, with a fact that says how many are left."""
    band = getattr(reading.said, "band", None)
    if band is None:
        return slice(None)
    first, last = (
        np.searchsorted(frequency, band.low),
        np.searchsorted(frequency, band.high, side="right"),
    )
    ends = f"{quantity(band.low, _HZ)} to {quantity(band.high, _HZ)}"
    if last - first < 3:
        raise reading.description.error(f"the band {ends} holds {last - first} rows", ["band"])
    reading.facts.append(("band", f"{ends}, as the description asks: {last - first} rows"))
    return slice(int(first), int(last))


def _ceramic(reading: Reading) -> CeramicBar | CeramicDisc | None:
    """The bare ceramic that was swept, with a fact that says so; None for what is none."""
    if reading.said.bar is not None and reading.said.disc is not None:
        raise reading.description.error("a body is a bar or a disc; give one of them", ["disc"])
    body: CeramicBar | CeramicDisc | None = reading.said.bar or reading.said.disc
    if body is not None:
        *sides, density = dataclasses.astuple(body)
        shown = " × ".join(quantity(side, si.Unit("m")) for side in sides)
        weight = quantity(density, si.Unit("kg/m3"))
        name = "bar" if reading.said.bar else "disc"
        reading.facts.append(("body", f"a bare ceramic {name}, {shown}, {weight}"))
    return body


def _corrected(reading: Reading, value: si.ComplexArray) -> si.ComplexArray:
    """A value whose phase was asked to be corrected, and a fact that says so."""
    correct = getattr(reading.said, "correct", None)
    if correct == "phase 180 deg":
        reading.facts.append(("corrected", "the phase by 180 deg, as the description asks"))
        return -value
    if correct == "phase sign":
        reading.facts.append(("corrected", "the sign of the phase, as the description asks"))
        return np.conj(value)
    return value


def _response(reading: Reading) -> kinds.FrequencyResponse:
    frequency = reading.take("frequency")
    motion, voltage = motion_per_volt(reading, frequency)
    coherence = reading.take("coherence") if reading.has("coherence") else None
    motion = _corrected(reading, motion)
    volts = None if voltage is None else float(np.median(np.abs(voltage)))
    order = rising_order(reading, "frequency", frequency)
    kept = _in_band(reading, frequency[order])
    return kinds.FrequencyResponse(
        frequency[order][kept],
        motion[order][kept],
        volts,
        None if coherence is None else coherence[order][kept],
        reading.told(),
        _place(reading),
    )


def _place(reading: Reading) -> tuple[si.Metre, si.Metre] | None:
    """Place on the plate (x, y in m) a response was recorded, where that is told."""
    if (reading.said.x is None) != (reading.said.y is None):
        given = "y" if reading.said.x is None else "x"
        raise reading.description.error("x and y go together; give both, or none", [given])
    if reading.said.x is None:
        return None
    shown = ", ".join(quantity(side, si.Unit("m")) for side in (reading.said.x, reading.said.y))
    reading.facts.append(("place", f"x, y = {shown}"))
    return reading.said.x, reading.said.y


def _line(reading: Reading) -> kinds.LineScan:
    position = reading.take("position")
    motion = motion_of(reading, reading.said.frequency, amplitude=True)
    order = np.argsort(position, kind="stable")
    same = np.flatnonzero(np.diff(position[order]) == 0)
    if same.size:
        first, second = (int(order[same[0] + k]) for k in (0, 1))
        raise reading.refuse(
            "position", f"{both_rows(reading, first, second)} have one place", second
        )
    given = None if reading.said.voltage is None else reading.given_voltage(reading.said.voltage)
    reading.facts.append(("frequency", quantity(reading.said.frequency, _HZ)))
    return kinds.LineScan(
        position[order], motion[order], reading.said.frequency, given, reading.told()
    )


def _grid(reading: Reading) -> kinds.GridScan:
    x, y = reading.take("x"), reading.take("y")
    motion = motion_of(reading, reading.said.frequency, amplitude=True)
    seen: dict[tuple[float, float], int] = {}
    for row, place in enumerate(zip(x.tolist(), y.tolist(), strict=True)):
        if place in seen:
            raise reading.refuse("x", f"{both_rows(reading, seen[place], row)} have one place", row)
        seen[place] = row
    given = None if reading.said.voltage is None else reading.given_voltage(reading.said.voltage)
    reading.facts.append(("frequency", quantity(reading.said.frequency, _HZ)))
    return kinds.GridScan(x, y, motion, reading.said.frequency, given, reading.told())


def _ring_down(reading: Reading) -> kinds.RingDown:
    time = reading.take("time")
    unit = "m"
    if reading.has("signal"):
        motion, unit = reading.take_any("signal")
    else:
        motion = moment_by_moment(reading, time)
    require_rising(reading, "time", time)
    return kinds.RingDown(time, motion, reading.told(), unit)


def _signals(reading: Reading) -> kinds.RawSignals:
    time = reading.take("time")
    voltage = reading.take("voltage")
    require_rising(reading, "time", time)
    even = np.linspace(time[0], time[-1], time.size)
    step = even[1] - even[0]
    off = np.abs(time - even)
    gap = np.flatnonzero(np.diff(time) > (1 + _UNEVEN) * step)
    if off.max() > _UNEVEN * step:
        row = int(gap[0]) + 1 if gap.size else int(off.argmax())
        raise reading.refuse(
            "time",
            f"the samples are not evenly spaced ({quantity(step, _S)} on average): samples are "
            "missing before this row; give a record without a gap",
            row,
        )
    motion = moment_by_moment(reading, even)
    return kinds.RawSignals(even, voltage, motion, reading.told())


def _sweeps(reading: Reading) -> kinds.VoltageSweeps:
    frequency = reading.take("frequency")
    if not reading.has("voltage"):
        raise reading.wanting("voltage", "sweeps at several voltages are told apart by it")
    motion, voltage = motion_per_volt(reading, frequency)
    assert voltage is not None
    sweeps, directions = [], []
    for start, stop in _runs(frequency, voltage):
        rows = slice(start, stop)
        if stop - start < 3:
            raise reading.refuse(
                "frequency",
                "a sweep begins here that has fewer than three rows; a sweep ends where the "
                "voltage changes or the frequency turns around",
                start,
            )
        up = frequency[stop - 1] > frequency[start]
        step = slice(None, None, 1 if up else -1)
        sweeps.append(
            kinds.FrequencyResponse(
                frequency[rows][step],
                motion[rows][step],
                float(voltage[start]),
                None,
                reading.told(),
            )
        )
        directions.append("up" if up else "down")
    told = (
        f"{quantity(float(sweep.voltage or 0), si.Unit('V'))} {way}"
        for sweep, way in zip(sweeps, directions, strict=True)
    )
    reading.facts.append(("sweeps", ", ".join(told)))
    return kinds.VoltageSweeps(tuple(sweeps), tuple(directions), reading.told())


def _runs(frequency: si.HertzArray, voltage: si.VoltArray) -> list[tuple[int, int]]:
    """Rows where sweeps begin and end: at one voltage, the frequency going one way."""
    starts, way = [0], 0.0
    for row in range(1, frequency.size):
        step = np.sign(frequency[row] - frequency[row - 1])
        turned = step == 0 or (way != 0 and step != way)
        if voltage[row] != voltage[row - 1] or turned:
            starts.append(row)
            way = 0.0
        else:
            way = float(step)
    return list(zip(starts, [*starts[1:], frequency.size], strict=True))


_OF_KIND: Mapping[str, Callable[[Reading], kinds.Recording]] = {
    "impedance": _impedance,
    "frequency response": _response,
    "line scan": _line,
    "grid scan": _grid,
    "ring-down": _ring_down,
    "voltage sweeps": _sweeps,
    "raw signals": _signals,
    "friction bench": assembled_friction.bench,
    "friction curve": assembled_friction.curve,
    "friction decays": assembled_friction.decays,
    "fingertip impedances": assembled_friction.touches,
    "detection thresholds": assembled_friction.detection,
}
