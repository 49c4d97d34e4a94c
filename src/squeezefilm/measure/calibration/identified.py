"""Identification by the draws of a calibration: which values and combinations are identified, and
which measurement would narrow the interval of friction most."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.uncertainty.intervals import LEVEL

Standing = Literal["identified", "narrowed", "not told"]
IDENTIFIED, NOT_TOLD = 0.35, 0.9
"""A spread of at most so much of the prior's is identified; of more than so much is not told."""
_FIXED, _ALONE, _NAMED = 0.35, 0.8, 0.08


@dataclass(frozen=True)
class Known:
    """Knowledge of one parameter: the share of its prior spread that is left (1: nothing was
    learned), in scores."""

    path: str
    left: si.Dimensionless

    @property
    def standing(self) -> Standing:
        """Standing in one word or two."""
        if self.left <= IDENTIFIED:
            return "identified"
        return "not told" if self.left > NOT_TOLD else "narrowed"


@dataclass(frozen=True)
class Combination:
    """A combination of parameters that the data fixed to a share (`left`) of its prior spread.

    `parts` are the parameters with their weights (their squares sum to less than 1), the largest
    first; positive ones make up for negative ones.
    """

    left: si.Dimensionless
    parts: tuple[tuple[str, float], ...]

    @property
    def sentence(self) -> str:
        """Sentence about one of two parameters and more."""
        to = f"to {si.percent(self.left, 1 if self.left < 0.1 else 0)} of their prior spread"
        up = [name for name, weight in self.parts if weight > 0]
        down = [name for name, weight in self.parts if weight < 0]
        if not down or not up:
            return (
                f"Only together are fixed {to}: {_and(up or down)}: more of one is less of another."
            )
        return (
            f"Only together are fixed {to}: {_and(up)} against {_and(down)}: more of the first "
            "goes with more of the second."
        )


@dataclass(frozen=True)
class Identification:
    """Findings on parameters: each by itself, and the combinations that are fixed."""

    known: tuple[Known, ...]
    combinations: tuple[Combination, ...]

    @property
    def sentences(self) -> tuple[str, ...]:
        """Sentences about it."""
        said = []
        words = {
            "identified": "The data identify",
            "narrowed": "The data narrow",
            "not told": "The data say next to nothing of",
        }
        for standing, verb in words.items():
            told = [known for known in self.known if known.standing == standing]
            names = [
                known.path
                if standing == "not told"
                else f"{known.path} ({si.percent(known.left)} of its prior spread is left)"
                for known in told
            ]
            if names:
                said.append(f"{verb} {_and(names)}.")
        said += [known.sentence for known in self.combinations if len(known.parts) > 1]
        return tuple(said)


def identification(
    paths: tuple[str, ...],
    scores: si.DimensionlessArray,
    weights: si.DimensionlessArray | None = None,
) -> Identification:
    """Identification of parameters by draws of scores (draws, parameters), weighted (draws,)."""
    if not paths:
        return Identification((), ())
    share = np.full(len(scores), 1 / len(scores)) if weights is None else weights / weights.sum()
    off = scores - share @ scores
    covariance = off.T @ (share[:, None] * off)
    known = tuple(Known(path, float(np.sqrt(covariance[k, k]))) for k, path in enumerate(paths))
    values, vectors = np.linalg.eigh(covariance)
    combinations = []
    for value, vector in zip(values, vectors.T, strict=True):
        left = float(np.sqrt(max(value, 0.0)))
        if left > _FIXED:
            break
        order = np.argsort(-(vector**2))
        vector = vector * np.sign(vector[order[0]])
        alone = vector[order[0]] ** 2 > _ALONE
        parts = order[:1] if alone else [k for k in order if vector[k] ** 2 > _NAMED]
        combinations.append(Combination(left, tuple((paths[k], float(vector[k])) for k in parts)))
    return Identification(known, tuple(combinations))


def _and(names: list[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


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
"""Accuracy of a measured µ′/µ (assumed): between strokes of one finger."""
_TRUTHS = 96
_NEAREST = 0.06
_TAILS = ((1 - LEVEL) / 2, (1 + LEVEL) / 2)


@dataclass(frozen=True)
class NextMeasurement:
    """A measurement that could be made next: what, how well (in its own unit, in words), and what
    share of friction's interval it is expected to leave."""

    name: str
    accuracy: str
    left: si.Dimensionless

    @property
    def sentence(self) -> str:
        """Sentence about it."""
        return (
            f"{self.name} (to {self.accuracy}) is expected to leave {si.percent(self.left)} of the "
            "interval of friction"
        )


@dataclass(frozen=True, eq=False)
class Candidate:
    """A measurement that could be made: what it would give in every draw, shape (draws,), and its
    standard error in the same unit; both said in words by `accuracy`."""

    name: str
    accuracy: str
    values: si.FloatArray
    standard_error: float


def candidates(answers: Mapping[str, si.FloatArray]) -> list[Candidate]:
    """Candidates of `ACCURACIES` among draws of answers and parameters by name."""
    options = []
    for name, values in answers.items():
        if name in ACCURACIES:
            share, words = ACCURACIES[name]
            options.append(Candidate(words, f"{100 * share:.3g} %", np.log(np.abs(values)), share))
    return options


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
    measurements = [
        NextMeasurement(
            option.name,
            option.accuracy,
            min(_left(friction, option, rows, noise, known) / width, 1.0),
        )
        for option in options
    ]
    return tuple(sorted(measurements, key=lambda option: option.left))


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
