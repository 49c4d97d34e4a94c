"""Made sweeps with what a fixture and an analyser do to them, and how often fits hold the truth."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from scipy import stats

from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.measure.fits.circuit.impedance import fit_impedance
from squeezefilm.measure.recordings.circuits_read import with_phase
from squeezefilm.measure.recordings.kinds import ImpedanceSweep

from .circuit_sweeps import MadeSweep, Random, compared, made_sweep

ASKED = ("static_capacitance", "series_resonance", "parallel_resonance", "quality_factor")


def _proportional(random: Random) -> MadeSweep:
    return made_sweep(random, 0.02)


def _clean(random: Random) -> MadeSweep:
    return made_sweep(random, 0.0005)


def _additive(random: Random) -> MadeSweep:
    """Noise of one size everywhere, a hundredth of the median admittance."""
    made = made_sweep(random, 0.0)
    y = made.sweep.admittance
    white = random.standard_normal((2, y.size))
    noise = 0.01 * np.median(np.abs(y)) * (white[0] + 1j * white[1])
    return replace(made, sweep=replace(made.sweep, admittance=y + noise))


def _leads(random: Random, compensated: bool | None = None) -> MadeSweep:
    """Leads of 1 to 20 % of the impedance at resonance, with up to .3 of that as reactance."""
    made = made_sweep(random, 0.0)
    y, f = made.sweep.admittance, made.sweep.frequency
    ohms = random.uniform(0.01, 0.2) / np.max(y.real)
    henries = random.uniform(0, 0.3) * ohms / (2 * math.pi * f[0])
    y = y / (1 + y * (ohms + 2j * math.pi * f * henries))
    white = random.standard_normal((2, y.size))
    y = y * (1 + 0.005 * (white[0] + 1j * white[1]))
    return replace(made, sweep=replace(made.sweep, admittance=y, compensated=compensated))


def _leads_told(random: Random) -> MadeSweep:
    return _leads(random, compensated=False)


def _drifting(random: Random) -> MadeSweep:
    return made_sweep(random, 0.005, drift=complex(*random.normal(0, 0.02, 2)))


def _without_phase(random: Random) -> MadeSweep:
    """Sizes alone, behind a shunt of up to half of the least impedance."""
    made = made_sweep(random, 0.0)
    y, f = made.sweep.admittance, made.sweep.frequency
    ohms = random.uniform(0, 0.5) / float(np.max(np.abs(y)))
    size = np.abs(y / (1 + y * ohms)) * (1 + 0.01 * random.standard_normal(y.size))
    both = with_phase(f, size)
    return replace(made, sweep=ImpedanceSweep(
        f, both / (1 - both * ohms), phase_recorded=False, in_series=ohms
    ))  # fmt: skip


MAKERS: dict[str, Callable[[Random], MadeSweep]] = {
    "clean": _clean,
    "proportional noise": _proportional,
    "additive noise": _additive,
    "leads": _leads,
    "leads told": _leads_told,
    "drift": _drifting,
    "without phase": _without_phase,
}


@dataclass
class Coverage:
    """Of fits that call themselves adequate, how many intervals of 90 % hold the truth; and how
    many have a mode too many, are refused, or say that they are inadequate."""

    fits: int = 0
    held: dict[str, int] = field(default_factory=lambda: dict.fromkeys(ASKED, 0))
    false_modes: int = 0
    refused: int = 0
    inadequate: int = 0

    def share(self, name: str) -> float:
        """The share of intervals of one quantity that hold the truth."""
        return self.held[name] / max(self.fits, 1)


def coverage_of(make: Callable[[Random], MadeSweep], runs: int, seed: int) -> Coverage:
    """What fits to `runs` made sweeps hold."""
    random = np.random.default_rng(seed)
    found, reach = Coverage(), float(stats.norm.ppf(0.95))
    for _ in range(runs):
        made = make(random)
        try:
            fit = fit_impedance(made.sweep)
        except SqueezefilmError:
            found.refused += 1
            continue
        if len(fit.branches) != made.layout.branches:
            found.false_modes += 1
            continue
        if not fit.adequacy.adequate:
            found.inadequate += 1
            continue
        found.fits += 1
        for name, (true, one) in compared(made, fit).items():
            if name in ASKED:
                found.held[name] += abs(one.value - true) <= reach * one.standard_error
    return found
