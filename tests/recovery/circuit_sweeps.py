"""Made sweeps of circuits whose values are known, and how often fits of them hold the truth."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.measure.fits.circuit.branches import Layout, circuit_curve
from squeezefilm.measure.fits.circuit.impedance import (
    ImpedanceFit,
    fit_impedance,
    parallel_resonance,
)
from squeezefilm.measure.fits.estimate import Estimate
from squeezefilm.measure.recordings.kinds import ImpedanceSweep

Random = np.random.Generator


@dataclass(frozen=True, eq=False)
class MadeSweep:
    """A sweep, the circuit it was made of and its parameters."""

    sweep: ImpedanceSweep
    layout: Layout
    truth: si.FloatArray


def made_sweep(
    random: Random,
    noise: float,
    *,
    branches: int = 1,
    drift: complex = 0,
    missing: float = 0.0,
    gap: float = 0.0,
    points: int = 301,
) -> MadeSweep:
    """A sweep of a circuit drawn at random: 25 to 70 kHz, Q 40 to 300, k 0.1 to 0.5, 0.2 to 50 nF.

    `noise` is relative, of each component; `drift` the change of the gain along the sweep;
    `missing` the share of points left out at random and `gap` that of a whole stretch.
    """
    layout = Layout(branches)
    f = math.exp(random.uniform(math.log(25e3), math.log(70e3)))
    quality = math.exp(random.uniform(math.log(40), math.log(300)))
    coupling = random.uniform(0.1, 0.5)
    static = math.exp(random.uniform(math.log(0.2e-9), math.log(50e-9)))
    truth = np.zeros(layout.size)
    truth[:2] = math.log(static), random.uniform(0.001, 0.03)
    ratio = coupling**2 / (1 - coupling**2)
    truth[layout.branch(0)] = math.log(f), math.log(quality), math.log(static * ratio)
    if branches == 2:
        # Split by 1.5 to 5 widths, as the modes of a plate that is nearly square.
        apart = random.uniform(1.5, 5) / quality
        truth[layout.branch(1)] = (
            math.log(f * (1 + apart)),
            math.log(quality * random.uniform(0.7, 1.4)),
            math.log(static * ratio * random.uniform(0.3, 1.5)),
        )
    width = f / quality
    above = parallel_resonance(layout, truth, branches - 1) - f
    frequency = np.linspace(f - 8 * width, f + above + 8 * width, points)
    keep = np.ones(points, dtype=bool)
    if missing:
        keep &= random.random(points) > missing
    if gap:
        first = int(random.integers(0, int(points * (1 - gap))))
        keep[first : first + int(gap * points)] = False
    curve = circuit_curve(layout, truth, frequency)[0]
    curve = curve * (1 + drift * np.linspace(-0.5, 0.5, points))
    white = random.standard_normal((2, points))
    curve = curve * (1 + noise * (white[0] + 1j * white[1]))
    return MadeSweep(ImpedanceSweep(frequency[keep], curve[keep]), layout, truth)


def _clean(random: Random) -> MadeSweep:
    return made_sweep(random, 0.0005)


def _noisy(random: Random) -> MadeSweep:
    return made_sweep(random, 0.03)


def _drifting(random: Random) -> MadeSweep:
    drift = complex(*random.normal(0, 0.04, 2))
    return made_sweep(random, 0.005, drift=drift)


def _double(random: Random) -> MadeSweep:
    return made_sweep(random, 0.005, branches=2)


def _missing(random: Random) -> MadeSweep:
    return made_sweep(random, 0.01, missing=0.3, gap=0.06)


@dataclass(frozen=True)
class Kind:
    """How sweeps of one kind are made, and whether a drift is fitted too."""

    make: Callable[[Random], MadeSweep]
    drift: bool = False


KINDS = {
    "clean": Kind(_clean),
    "noise": Kind(_noisy),
    "drift": Kind(_drifting, drift=True),
    "double modes": Kind(_double),
    "missing samples": Kind(_missing),
}


@dataclass
class Held:
    """Of how many runs an interval held the truth, and its half widths relative to it."""

    inside: int = 0
    half_widths: list[float] = field(default_factory=list)


def coverage(kind: Kind, runs: int, seed: int) -> tuple[dict[str, Held], int]:
    """What the intervals of `runs` fits held, by quantity; the strongest made branch counts. And
    how many fits gave another number of branches or none: their intervals hold nothing."""
    random = np.random.default_rng(seed)
    held: dict[str, Held] = {}
    failed = 0
    for _ in range(runs):
        made = kind.make(random)
        try:
            fit = fit_impedance(made.sweep, drift=kind.drift)
        except SqueezefilmError:
            failed += 1
            continue
        if len(fit.branches) != made.layout.branches:
            failed += 1
            continue
        for name, (true, estimate) in compared(made, fit).items():
            low, high = estimate.interval
            one = held.setdefault(name, Held())
            one.inside += low <= true <= high
            one.half_widths.append((high - low) / 2 / abs(true))
    return held, failed


def compared(made: MadeSweep, fit: ImpedanceFit) -> dict[str, tuple[float, Estimate]]:
    """Truth and estimate of every quantity of the made sweep's strongest branch."""
    layout, truth = made.layout, made.truth
    strongest = int(np.argmax([truth[layout.branch(k)][2] for k in range(layout.branches)]))
    f, quality, capacitance = np.exp(truth[layout.branch(strongest)])
    parallel = parallel_resonance(layout, truth, strongest)
    branch = fit.branches[strongest]
    omega = 2 * math.pi * f
    return {
        "static_capacitance": (math.exp(truth[0]), fit.static_capacitance),
        "series_resonance": (f, branch.series_resonance),
        "parallel_resonance": (parallel, branch.parallel_resonance),
        "coupling_coefficient": (math.sqrt(1 - (f / parallel) ** 2), branch.coupling_coefficient),
        "quality_factor": (quality, branch.quality_factor),
        "motional_resistance": (1 / (omega * capacitance * quality), branch.motional_resistance),
        "motional_inductance": (1 / (omega**2 * capacitance), branch.motional_inductance),
        "motional_capacitance": (capacitance, branch.motional_capacitance),
    }
