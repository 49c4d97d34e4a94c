"""Which measurement would tell most of friction, by what it is expected to leave of its interval.

For each candidate every draw of the posterior takes its turn as the truth: what it would give is
drawn with noise, all draws are weighted by how well they agree, and the interval of µ′/µ of the
weighted draws is what would be left (nested Monte Carlo by reweighting; Ryan et al. 2016,
10.1111/insr.12107). The accuracies are **assumed**, of what such instruments usually do.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.measure.calibration.calibration import NextMeasurement
from squeezefilm.physics.uncertainty.intervals import LEVEL

ACCURACIES: dict[str, tuple[si.Dimensionless, str]] = {
    "resonance_frequency": (5e-4, "resonance frequency by an impedance sweep"),
    "parallel_resonance_frequency": (5e-4, "open-circuit (parallel) resonance"),
    "mode_frequency": (5e-4, "frequency of a neighbouring mode"),
    "static_capacitance": (0.01, "static capacitance by an impedance sweep"),
    "quality_factor": (0.05, "quality factor"),
    "amplitude_per_volt": (0.05, "amplitude by a vibrometer"),
    "mass": (1e-3, "mass on a balance"),
    "half_wavelength": (3e-3, "half wavelength by a line scan"),
    "actuator.thickness": (2.5e-3, "plate thickness by micrometer"),
    "actuator.patches.*.thickness": (5e-3, "ceramic thickness by micrometer"),
    "actuator.ceramic_thickness": (5e-3, "ceramic thickness by micrometer"),
    "actuator.glue.thickness": (0.1, "glue thickness by microscope"),
    "finger.normal_force": (0.03, "normal force by a load cell"),
    "finger.plateau_width": (0.1, "width of the ridges' plateaus by an imprint"),
    "finger.contact_length": (0.05, "size of the contact by an imprint"),
    "finger.asperities.roughness": (0.1, "roughness of the skin by a replica"),
    "finger.asperities.modulus": (0.2, "modulus of the outermost skin"),
    "surfaces.0.roughness": (0.05, "roughness of the surface by a profilometer"),
    "surfaces.0.friction_coefficient": (0.05, "friction at rest of the vibration"),
}
"""Relative standard errors (assumed), and the measurement in words."""
FRICTION_ACCURACY: si.Dimensionless = 0.05
"""Of a measured µ′/µ (assumed): between strokes of one finger."""
_TRUTHS = 96
_NEAREST = 0.06
_TAILS = ((1 - LEVEL) / 2, (1 + LEVEL) / 2)


@dataclass(frozen=True, eq=False)
class Candidate:
    """A measurement that could be made: what it would give in every draw, shape (draws,), and its
    standard error in the same unit; both said in words by `accuracy`."""

    name: str
    accuracy: str
    values: si.FloatArray
    standard_error: float


def candidates(answers: Mapping[str, si.FloatArray]) -> list[Candidate]:
    """Those of `ACCURACIES` among draws of answers and parameters by name."""
    found = []
    for name, values in answers.items():
        if name in ACCURACIES:
            share, words = ACCURACIES[name]
            found.append(Candidate(words, f"{100 * share:.3g} %", np.log(np.abs(values)), share))
    return found


def friction_candidate(values: si.DimensionlessArray, amplitude: si.Metre) -> Candidate:
    """µ′/µ measured at one amplitude (m), as the draws have it there."""
    return Candidate(
        f"µ′/µ on a friction bench at {1e6 * amplitude:.2g} µm",
        f"±{FRICTION_ACCURACY:g}",
        values,
        FRICTION_ACCURACY,
    )


def ranked(
    friction: si.DimensionlessArray, options: list[Candidate], *, seed: int
) -> tuple[NextMeasurement, ...]:
    """The candidates, that which is expected to leave least of the interval of `friction` (draws,)
    first."""
    random = np.random.default_rng(seed)
    known = np.isfinite(friction)
    rows = random.choice(np.flatnonzero(known), min(_TRUTHS, int(known.sum())), replace=False)
    width = float(np.diff(np.quantile(friction[known], _TAILS))[0])
    noise = random.normal(size=rows.size)
    found = [
        NextMeasurement(
            one.name, one.accuracy, min(_left(friction, one, rows, noise, known) / width, 1.0)
        )
        for one in options
    ]
    return tuple(sorted(found, key=lambda one: one.left))


def _left(
    friction: si.DimensionlessArray,
    option: Candidate,
    rows: si.IntArray,
    noise: si.FloatArray,
    known: np.ndarray[tuple[int], np.dtype[np.bool]],
) -> si.Dimensionless:
    """The width of friction's interval that a measurement is expected to leave."""
    # Of finitely many draws some must agree: nearer than this nothing can be told apart.
    error_used = max(option.standard_error, _NEAREST * float(np.std(option.values[known])))
    order = np.argsort(np.where(known, friction, np.inf))[: int(known.sum())]
    sorted_friction, values = friction[order], option.values[order]
    widths = []
    for row, error in zip(rows, noise, strict=True):
        seen = option.values[row] + option.standard_error * error
        weight = np.exp(-(((values - seen) / error_used) ** 2) / 2)
        if not weight.sum() > 0:
            weight = (np.abs(values - seen) == np.min(np.abs(values - seen))).astype(float)
        ends = np.interp(_TAILS, (np.cumsum(weight) - weight / 2) / weight.sum(), sorted_friction)
        widths.append(float(ends[1] - ends[0]))
    return float(np.mean(widths))
