"""A made-up bench on disk: CSV and TOML beside, as an engineer would leave them."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.measure.recordings import kinds

_AMPLITUDE = 'given_as = "zero-to-peak"'


class _Column(NamedTuple):
    """A column's key in the description, its unit in the file, its values in that, and what more
    is said of it."""

    key: str
    unit: str
    values: si.FloatArray
    more: str = ""


class _File(NamedTuple):
    kind: str
    columns: list[_Column]
    keys: list[str]


def write_bench(folder: Path, recordings: Mapping[str, kinds.Recording]) -> list[Path]:
    """Write recordings into a folder as CSV with TOML beside, and answer with the CSV's paths."""
    folder.mkdir(exist_ok=True)
    paths = []
    for name, recording in recordings.items():
        path, made = folder / f"{name}.csv", _OF_KIND[type(recording)](recording)
        path.write_text(_csv(made.columns), "utf-8")
        path.with_suffix(".toml").write_text(_toml(made, recording.told), "utf-8")
        paths.append(path)
    return paths


def _csv(columns: list[_Column]) -> str:
    names = ",".join(f"{one.key} ({one.unit})" for one in columns)
    rows = np.column_stack([one.values for one in columns])
    return "\n".join([names, *(",".join(f"{v:.9g}" for v in row) for row in rows)]) + "\n"


def _toml(file: _File, told: kinds.Told) -> str:
    lines = [
        f'kind = "{file.kind}"',
        *(f"{key} = {json.dumps(text)}" for key, text in (
            ("name", told.name), ("instrument", told.instrument), ("source", told.source)
        )),
        *file.keys,
        "",
        "[columns]",
    ]  # fmt: skip
    for number, one in enumerate(file.columns, 1):
        more = f", {one.more}" if one.more else ""
        lines.append(f'{one.key} = {{ column = {number}, unit = "{one.unit}"{more} }}')
    return "\n".join(lines) + "\n"


def _volts(voltage: si.Volt | None) -> list[str]:
    return [f'voltage = {{ amplitude = "{voltage:.9g} V", {_AMPLITUDE} }}'] if voltage else []


def _frequency(frequency: si.Hertz) -> str:
    return f'frequency = "{frequency:.9g} Hz"'


def _per_volt(motion: si.ComplexArray) -> list[_Column]:
    return [
        _Column("displacement", "nm/V", 1e9 * motion.real),
        _Column("displacement_imaginary", "nm/V", 1e9 * motion.imag),
    ]


def _swinging(motion: si.Array) -> list[_Column]:
    return [
        _Column("displacement", "um", 1e6 * motion.real, _AMPLITUDE),
        _Column("displacement_imaginary", "um", 1e6 * motion.imag, _AMPLITUDE),
    ]


def _impedance(one: kinds.ImpedanceSweep) -> _File:
    columns = [
        _Column("frequency", "Hz", one.frequency),
        _Column("conductance", "mS", 1e3 * one.admittance.real),
        _Column("susceptance", "mS", 1e3 * one.admittance.imag),
    ]
    return _File("impedance", columns, [])


def _response(one: kinds.FrequencyResponse) -> _File:
    columns = [_Column("frequency", "Hz", one.frequency), *_per_volt(one.displacement_per_volt)]
    return _File("frequency response", columns, _volts(one.voltage))


def _line(one: kinds.LineScan) -> _File:
    columns = [_Column("position", "mm", 1e3 * one.position), *_swinging(one.displacement)]
    return _File("line scan", columns, [_frequency(one.frequency), *_volts(one.voltage)])


def _grid(one: kinds.GridScan) -> _File:
    columns = [
        _Column("x", "mm", 1e3 * one.x),
        _Column("y", "mm", 1e3 * one.y),
        *_swinging(one.displacement),
    ]
    return _File("grid scan", columns, [_frequency(one.frequency), *_volts(one.voltage)])


def _ring_down(one: kinds.RingDown) -> _File:
    columns = [
        _Column("time", "ms", 1e3 * one.time),
        _Column("displacement", "um", 1e6 * one.displacement),
    ]
    return _File("ring-down", columns, [])


def _signals(one: kinds.RawSignals) -> _File:
    columns = [
        _Column("time", "ms", 1e3 * one.time),
        _Column("voltage", "V", one.voltage),
        _Column("displacement", "um", 1e6 * one.displacement),
    ]
    return _File("raw signals", columns, [])


def _sweeps(one: kinds.VoltageSweeps) -> _File:
    f = np.concatenate([sweep.frequency for sweep in one.sweeps])
    H = np.concatenate([sweep.displacement_per_volt for sweep in one.sweeps])
    volts = np.concatenate(
        [np.full(sweep.frequency.size, sweep.voltage or 0.0) for sweep in one.sweeps]
    )
    columns = [
        _Column("frequency", "Hz", f),
        _Column("voltage", "V", volts, _AMPLITUDE),
        *_per_volt(H),
    ]
    return _File("voltage sweeps", columns, [])


def _bench(one: kinds.FrictionBench) -> _File:
    columns = [
        _Column("time", "s", one.time),
        _Column("normal_force", "N", one.normal_force),
        _Column("tangential_force", "N", one.tangential_force),
        _Column("position", "mm", 1e3 * one.position),
        _Column("vibration_amplitude", "um", 1e6 * one.vibration_amplitude, _AMPLITUDE),
    ]
    return _File("friction bench", columns, [])


def _curve(one: kinds.FrictionCurve) -> _File:
    columns = [
        _Column("vibration_amplitude", "um", 1e6 * one.vibration_amplitude, _AMPLITUDE),
        _Column("relative_friction", "1", one.friction),
        _Column("spread", "1", np.asarray(one.spread)),
    ]
    conditions = (
        ("frequency", one.frequency, "Hz"),
        ("normal_force", one.normal_force, "N"),
        ("speed", one.speed, "m/s"),
    )
    lines = [f'{name} = "{value:.9g} {unit}"' for name, value, unit in conditions]
    return _File("friction curve", columns, lines)


_OF_KIND: Mapping[type, Callable[[Any], _File]] = {
    kinds.ImpedanceSweep: _impedance,
    kinds.FrequencyResponse: _response,
    kinds.LineScan: _line,
    kinds.GridScan: _grid,
    kinds.RingDown: _ring_down,
    kinds.RawSignals: _signals,
    kinds.VoltageSweeps: _sweeps,
    kinds.FrictionBench: _bench,
    kinds.FrictionCurve: _curve,
}
