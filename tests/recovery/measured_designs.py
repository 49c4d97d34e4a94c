"""Recordings of known truth, drawn by a seed, for every cheap fit of the measure room.

Each is made by a formula or a march of its own, apart from the fits. Designs were fixed before any
coverage was computed, and none was left out since.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
from tests.made_bench.duffing import SofteningResonance
from tests.made_bench.strokes import PlannedStrokes, recorded_strokes

from squeezefilm.measure.fits.estimate import Estimate
from squeezefilm.measure.fits.friction.friction_bench import fit_friction_bench
from squeezefilm.measure.fits.vibration.frequency_response import fit_frequency_response
from squeezefilm.measure.fits.vibration.line_scan import fit_line_scan
from squeezefilm.measure.fits.vibration.ring_down import fit_ring_down
from squeezefilm.measure.fits.vibration.solved_shapes import fit_grid_scan
from squeezefilm.measure.fits.vibration.voltage_sweeps import fit_voltage_sweeps
from squeezefilm.measure.recordings import kinds

Random = np.random.Generator
Checked = dict[str, tuple[Estimate, float]]
"""Estimates beside what is true, by name."""


class Wrong(NamedTuple):
    """What is wrong with a recording: a `drift`, a second mode (`double`), a share of points that
    is `missing`, the phase's sign."""

    drift: bool = False
    double: bool = False
    missing: float = 0.0
    phase_reversed: bool = False


def _noisy(w: Any, noise: float, random: Random) -> Any:
    """With noise, of a share of the largest value."""
    size = noise * np.max(np.abs(w))
    if not np.iscomplexobj(w):
        return w + size * random.standard_normal(w.shape)
    parts = size / np.sqrt(2) * random.standard_normal((2, *w.shape))
    return w + parts[0] + 1j * parts[1]


def _kept(count: int, wrong: Wrong, random: Random) -> Any:
    keep = random.random(count) >= wrong.missing
    if wrong.missing:
        # And a gap.
        keep[count // 5 : count // 5 + count // 25] = False
    return keep


def frequency_response(wrong: Wrong, random: Random) -> Checked:
    f = np.linspace(29e3, 31.5e3, 150)
    own, quality = random.uniform(29.8e3, 30.6e3), random.uniform(40, 120)
    constant = 2e-9 * np.exp(2j * np.pi * random.random())

    def mode(A: complex, f0: float, Q: float) -> Any:
        return A * f0**2 / (f0**2 * (1 + 1j / Q) - f**2)

    H = mode(constant, own, quality)
    if wrong.double:
        H = H + mode(0.4 * constant, own + 1.5 * own / quality, 1.1 * quality)
    if wrong.drift:
        H = H + 0.1 * np.max(np.abs(H)) * (1 + 0.5j) * (f - 29.5e3) / 2.5e3
    H = _noisy(H, 0.01, random)
    keep = _kept(f.size, wrong, random)
    H = H.conj() if wrong.phase_reversed else H
    fit = fit_frequency_response(kinds.FrequencyResponse(f[keep], H[keep]))
    assert fit.phase_reversed is wrong.phase_reversed
    first = fit.modes[0]
    return {
        "frequency": (first.frequency, own),
        "quality factor": (first.quality_factor, quality),
        "amplitude per volt": (first.amplitude_per_volt, abs(constant) * quality),
    }


def line_scan(wrong: Wrong, random: Random) -> Checked:
    x = np.linspace(0.5e-3, 82.5e-3, 90)
    x = x[_kept(x.size, wrong, random)]
    half, loss = random.uniform(9e-3, 13e-3), random.uniform(0.02, 0.05)
    k, middle = np.pi / half, (x[0] + x[-1]) / 2
    back = 0.9 * np.exp(2j * np.pi * random.random())
    ends = random.uniform(-1, 1, 2)

    def wave(x: Any) -> Any:
        turn = (1j * k + k * loss / 4) * (x - middle)
        w = np.exp(-turn) + back * np.exp(turn)
        return w + ends[0] * np.exp(-k * (x - x0)) + ends[1] * np.exp(-k * (x1 - x))

    x0, x1 = x[0], x[-1]
    w = _noisy(1e-6 * wave(x), 0.015, random)
    w = w.conj() if wrong.phase_reversed else w
    fit = fit_line_scan(kinds.LineScan(x, w, 33e3, 15.0))
    dense = np.linspace(x0, x1, 20001)
    size = np.abs(wave(dense))
    nodes = dense[1:-1][(size[1:-1] < size[:-2]) & (size[1:-1] <= size[2:])]
    third = nodes[2]
    node = min(fit.nodal_lines, key=lambda one: abs(one.value - third))
    assert fit.loss_factor is not None
    assert fit.standing_wave_ratio is not None
    amplitude = 1e-6 * float(np.interp(fit.antinode, dense, size))
    return {
        "half wavelength": (fit.half_wavelength, half),
        "loss factor": (fit.loss_factor, loss),
        "standing-wave ratio": (fit.standing_wave_ratio, 1.9 / 0.1),
        "third nodal line": (node, float(third)),
        "amplitude": (fit.antinode_amplitude, amplitude),
    }


def size_of_a_line(wrong: Wrong, random: Random) -> Checked:
    """A standing wave whose phase was not recorded, but its sign."""
    x = np.linspace(0.5e-3, 82.5e-3, 120)
    x = x[_kept(x.size, wrong, random)]
    half = random.uniform(9e-3, 13e-3)
    w = 1e-6 * np.cos(np.pi * (x - 40e-3) / half + random.uniform(0, np.pi))
    fit = fit_line_scan(kinds.LineScan(x, _noisy(w, 0.015, random), 33e3, 15.0), free_ends=False)
    return {
        "half wavelength": (fit.half_wavelength, half),
        "amplitude": (fit.antinode_amplitude, 1e-6),
    }


def grid_scan(wrong: Wrong, random: Random) -> Checked:
    x, y = (one.ravel() for one in np.meshgrid(np.linspace(0, 1, 24), np.linspace(0, 1, 12)))
    keep = _kept(x.size, wrong, random)
    x, y = x[keep], y[keep]
    shapes = {
        "(8,0)": np.cos(8 * np.pi * x),
        "(6,3)": np.cos(6 * np.pi * x) * np.cos(3 * np.pi * y),
        "(8,1)": np.cos(8 * np.pi * x) * np.cos(np.pi * y),
    }
    amplitude = random.uniform(0.5e-6, 2e-6)
    w = -1j * amplitude * shapes["(8,0)"]
    if wrong.double:
        w = w + 0.2j * amplitude * shapes["(8,1)"]
    w = _noisy(w, 0.03, random)
    w = w.conj() if wrong.phase_reversed else w
    fit = fit_grid_scan(kinds.GridScan(x, y, w, 33e3, 15.0), shapes)
    found = {"amplitude": (fit.amplitude, amplitude)}
    if wrong.double:
        found["second shape"] = (fit.parts["(8,1)"], 0.2 * amplitude)
    return found


def ring_down(wrong: Wrong, random: Random, bent: bool = False) -> Checked:
    rate, count = 500e3, 1500
    f, quality, size = random.uniform(30e3, 36e3), random.uniform(40, 90), 1.5e-6
    t = np.arange(count)[_kept(count, wrong, random)] / rate
    t = t - t[0]
    phase = 2 * np.pi * random.random()
    rise, bend = (0.3 / size, -0.004 / size**2) if bent else (0.0, 0.0)
    resonance = SofteningResonance(f, quality, 1e-7, bend, rise)
    if bent:
        # In steps of a quarter period and less, of which the march makes 1e-7.
        w = resonance.ringing(t, size, phase)
    else:
        w = size * np.exp(-np.pi * f / quality * t) * np.cos(2 * np.pi * f * t + phase)
    if wrong.double:
        w = w + 0.2 * size * np.exp(-0.8 * np.pi * f / quality * t) * np.cos(
            2 * np.pi * (f + 900) * t
        )
    if wrong.drift:
        w = w + size * 0.1 * (1 + t / t[-1])
    fit = fit_ring_down(kinds.RingDown(t, _noisy(w, 0.02, random)))
    found = {
        "frequency": (fit.frequency, f),
        "quality factor": (fit.quality_factor, quality),
        "amplitude": (fit.amplitude, size),
    }
    if bent:
        assert fit.damping_rise is not None
        assert fit.frequency_rise is not None
        found |= {
            "damping rise": (fit.damping_rise, rise),
            "frequency rise": (fit.frequency_rise, bend),
        }
    return found


def bent_ring_down(wrong: Wrong, random: Random) -> Checked:
    return ring_down(wrong, random, bent=True)


_SWEPT: dict[int, tuple[SofteningResonance, list[Any], list[float], list[str]]] = {}


def _swept(
    number: int,
) -> tuple[SofteningResonance, list[Any], list[float], list[str]]:
    """One of eight softening resonances, swept without noise: the slow part, kept."""
    if number not in _SWEPT:
        random = np.random.default_rng(number)
        quality, size = random.uniform(50, 80), 2e-6
        backbone = -random.uniform(0.004, 0.02) / size**2
        true = SofteningResonance(33.2e3, quality, size / 15, backbone, 0.1 / size)
        f = np.linspace(31.5e3, 34.5e3, 90)
        rows, volts, ways = [], [], []
        for V in (2.0, 5.0, 10.0, 15.0):
            for way in ("up", "down"):
                along = f if way == "up" else f[::-1]
                rows.append((along, true.swept(along, V)))
                volts.append(V)
                ways.append(way)
        _SWEPT[number] = true, rows, volts, ways
    return _SWEPT[number]


def voltage_sweeps(wrong: Wrong, random: Random) -> Checked:
    true, rows, volts, ways = _swept(int(random.integers(8)))
    size, sweeps = 0.01 * 2e-6 / np.sqrt(2), []
    for (f, x), V in zip(rows, volts, strict=True):
        noise = size * random.standard_normal((2, f.size))
        keep = _kept(f.size, wrong, random)
        H = (x + noise[0] + 1j * noise[1]) / V
        H = H.conj() if wrong.phase_reversed else H
        sweeps.append(kinds.FrequencyResponse(f[keep], H[keep], V))
    recording = kinds.VoltageSweeps(tuple(sweeps), tuple(ways))
    fit = fit_voltage_sweeps(recording)
    return {
        "frequency": (fit.frequency, true.frequency),
        "quality factor": (fit.quality_factor, true.quality_factor),
        "amplitude per volt": (fit.amplitude_per_volt, true.amplitude_per_volt),
        "backbone": (fit.backbone, true.backbone),
        "damping rise": (fit.damping_rise, true.damping_rise),
    }


def friction_bench(wrong: Wrong, random: Random) -> Checked:
    levels = np.array([0.0, 0.5e-6, 1e-6, 2e-6])
    number = np.repeat(np.arange(4), 10)
    random.shuffle(number)
    relative = 0.2 + 0.8 * np.exp(-levels / 0.8e-6)
    speed = 0.07 * np.exp(0.25 * random.standard_normal(40).clip(-2, 2))
    force = 0.5 * np.exp(0.2 * random.standard_normal(40).clip(-2, 2))
    spread = 0.08 * random.standard_normal(40)
    sweat = 0.4 * np.linspace(-0.5, 0.5, 40) ** 2 + 0.3 * np.linspace(-0.5, 0.5, 40)
    mu = 0.8 * relative[number] * (speed / 0.07) ** 0.1 * (force / 0.5) ** -0.15
    mu = mu * np.exp(spread + (sweat if wrong.drift else 0.0))
    made = recorded_strokes(PlannedStrokes(levels[number], speed, force, mu), random)
    keep = _kept(made.time.size, wrong, random) if wrong.missing else slice(None)
    recording = kinds.FrictionBench(
        made.time[keep],
        made.normal_force[keep],
        made.tangential_force[keep],
        made.position[keep],
        made.vibration_amplitude[keep],
        frequency=33e3,
    )
    fit = fit_friction_bench(recording)
    assert fit.speed_exponent is not None
    assert fit.force_exponent is not None
    found = {
        f"relative friction at {1e6 * level:g} µm": (one, float(true))
        for level, one, true in zip(levels[1:], fit.relative_friction, relative[1:], strict=True)
    }
    return found | {
        "speed exponent": (fit.speed_exponent, 0.1),
        "force exponent": (fit.force_exponent, -0.15),
    }


CLEAN, DRIFT, DOUBLE = Wrong(), Wrong(drift=True), Wrong(double=True)
MISSING, REVERSED = Wrong(missing=0.2), Wrong(phase_reversed=True)
WRONGS = {
    "noise": CLEAN, "drift": DRIFT, "double mode": DOUBLE, "missing points": MISSING,
    "phase reversed": REVERSED,
}  # fmt: skip

_MADE: Mapping[str, tuple[Callable[[Wrong, Random], Checked], str]] = {
    "frequency response": (
        frequency_response, "noise, drift, double mode, missing points, phase reversed"
    ),
    "line scan": (line_scan, "noise, missing points, phase reversed"),
    "line scan without phase": (size_of_a_line, "noise, missing points"),
    "grid scan": (grid_scan, "noise, double mode, missing points, phase reversed"),
    "ring-down": (ring_down, "noise, drift, double mode, missing points"),
    "ring-down that depends on its amplitude": (bent_ring_down, "noise, missing points"),
    "voltage sweeps": (voltage_sweeps, "noise, missing points, phase reversed"),
    "friction bench": (friction_bench, "noise, drift, missing points"),
}  # fmt: skip

DESIGNS: dict[str, tuple[Callable[[Wrong, Random], Checked], Wrong]] = {
    f"{kind}, {name}": (make, WRONGS[name])
    for kind, (make, names) in _MADE.items()
    for name in names.split(", ")
}


class Coverage(NamedTuple):
    """Share of runs whose interval held the truth, and the intervals' median length over the
    truth's size."""

    share: float
    length: float


def coverage(design: str, runs: int, first: int = 0) -> dict[str, Coverage]:
    """Coverage of every estimate of a design."""
    make, wrong = DESIGNS[design]
    rows: dict[str, list[tuple[bool, float]]] = {}
    for seed in range(first, first + runs):
        for name, (one, true) in make(wrong, np.random.default_rng([seed, 3])).items():
            low, high = one.interval
            rows.setdefault(name, []).append((low <= true <= high, (high - low) / abs(true)))
    return {
        name: Coverage(
            float(np.mean([held for held, _ in row])),
            float(np.median([length for _, length in row])),
        )
        for name, row in rows.items()
    }
