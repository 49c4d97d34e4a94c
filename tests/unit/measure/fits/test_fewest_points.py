"""Every fit takes the fewest points that it says it needs, and of one less it says how many."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.complex_fit import require_passive
from squeezefilm.measure.fits.friction.friction_bench import sliding_strokes
from squeezefilm.measure.fits.vibration.frequency_response import fit_frequency_response
from squeezefilm.measure.fits.vibration.line_scan import fit_line_scan
from squeezefilm.measure.fits.vibration.raw_signals import fit_raw_signals
from squeezefilm.measure.fits.vibration.ring_down import fit_ring_down
from squeezefilm.measure.fits.vibration.solved_shapes import fit_grid_scan
from squeezefilm.measure.fits.vibration.voltage_sweeps import fit_voltage_sweeps
from squeezefilm.measure.recordings import kinds


def resonance(count: int, volts: float = 1.0) -> kinds.FrequencyResponse:
    f = np.linspace(29.5e3, 30.5e3, count)
    return kinds.FrequencyResponse(f, 1e-7 / (1 - (f / 30e3) ** 2 + 1j / 60), volts)


def swept(count: int) -> kinds.ImpedanceSweep:
    f = np.linspace(29e3, 31e3, count)
    return kinds.ImpedanceSweep(f, 1e-5 + 2j * np.pi * f * 1e-9)


def sweeps(count: int) -> kinds.VoltageSweeps:
    halves = resonance(count // 2, 1.0), resonance(count - count // 2, 4.0)
    return kinds.VoltageSweeps(halves, ("up", "up"))


def line(count: int) -> kinds.LineScan:
    x = np.linspace(0.0, 15e-3, count)
    return kinds.LineScan(x, 1e-6 * np.cos(2 * np.pi * x / 16e-3 + 0.3) + 0j, 3e4)


def grid(count: int) -> kinds.GridScan:
    x = np.linspace(0.0, 1.0, count)
    return kinds.GridScan(x, x, np.cos(3 * x) + 0j, 3e4)


def fit_grid(scan: kinds.GridScan) -> Any:
    return fit_grid_scan(scan, {"a": np.cos(3 * scan.x), "b": np.sin(2 * scan.x)})


def ringing(count: int) -> kinds.RingDown:
    t = np.arange(count) / 2e5
    return kinds.RingDown(t, 1e-6 * np.exp(-t / 1e-4) * np.cos(2 * np.pi * 3e4 * t))


def signals(count: int) -> kinds.RawSignals:
    t = np.arange(count) / 4e5
    phase = 2 * np.pi * (28e3 * t + 0.5 * 4e3 * t**2 / t[-1])
    return kinds.RawSignals(t, 5 * np.cos(phase), 1e-6 * np.cos(phase - 1.0))


def strokes(count: int) -> kinds.FrictionBench:
    t = np.linspace(0.0, 2.0, count)
    back = np.abs((t % 1.0) - 0.5)
    way = np.sign(np.gradient(back))
    return kinds.FrictionBench(t, 0.5 + 0 * t, 0.3 * way, 0.05 * back, 0 * t)


@pytest.mark.parametrize(
    ("fewest", "made", "fit"),
    [
        (12, resonance, fit_frequency_response),
        (12, line, fit_line_scan),
        (12, grid, fit_grid),
        (16, swept, require_passive),
        (30, sweeps, fit_voltage_sweeps),
        (40, ringing, fit_ring_down),
        (100, strokes, sliding_strokes),
        (256, signals, fit_raw_signals),
    ],
)
def test_the_fewest_points_are_enough(
    fewest: int, made: Callable[[int], Any], fit: Callable[[Any], Any]
) -> None:
    fit(made(fewest))
    with pytest.raises(InputError, match=rf" {fewest - 1} (usable )?points; .*at least {fewest}\b"):
        fit(made(fewest - 1))
