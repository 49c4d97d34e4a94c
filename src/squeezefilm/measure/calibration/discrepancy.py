"""Distance of a right-looking model from a real bench, and how observations judge it: of a plate's
answers, and of µ′/µ.

A solved plate is not the plate: glue is uneven, a mode nobody modelled is near, a law of contact
is another one. Such errors are sampled beside the parameters (Kennedy and O'Hagan 2001,
10.1111/1467-9868.00294). Every answer of a plate may be off by its `BELIEVED` share times the
unknown scale of its kind. One or two answers of a kind say next to nothing of that scale, since the
parameters take up what is wrong: it stays about 1 however well the data fit, so that an answer
that was not measured is never predicted better than the model is believed to be. Where the data do
not fit, it grows. A law's error is a continuous function of amplitude, force and speed: a Gaussian
process over their logarithms with an exponential correlation, so that many points along one curve
do not count as many independent judges of the law, and beyond them it is soon unknown again. **All
shares and scales here are assumed.**
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.calibration.solved_answers import FRICTION
from squeezefilm.measure.fits.estimate import Observation

BELIEVED: dict[str, si.Dimensionless] = {
    "resonance_frequency": 0.01,
    "parallel_resonance_frequency": 0.01,
    "mode_frequency": 0.01,
    "half_wavelength": 0.01,
    "mass": 0.005,
    "coupling_coefficient": 0.03,
    "static_capacitance": 0.05,
    "modal_mass": 0.1,
    "quality_factor": 0.05,
    "amplitude_per_volt": 0.15,
    "relative_friction": 0.06,
}
"""**Assumed**: what a solved plate may be off by, as a share of the answer (of µ′/µ absolute).

Of the size that solved plates of the paper's kind are changed by what no description has: a ceramic
without its wire, one loose at an end, ceramics of unlike thickness, a plate cut 1 % too large, a
support of foam (`tests/recovery/wrong_plates.py`; resonance to 2.5 %, coupling to 19 %, capacitance
to 15 %, amplitude to 16 %, most of them to less than half of it; what a calibration takes for a
thicker plate or a weaker ceramic is not to be counted twice). A quality factor is fitted itself, so
that little of its error is left. The mesh adds less (0.1 % in frequency, 1 % in amplitude). The
paper's own plate lies further from its maker's model, 14 % in frequency and 64 % in amplitude: such
a bench is a misfit here, and its scales large. Published friction on glass lies 0.057 from the
default law, nothing but the friction at rest fitted."""

READ_ALONE: dict[str, si.Dimensionless] = {
    "resonance_frequency": 2e-4,
    "parallel_resonance_frequency": 2e-4,
    "mode_frequency": 2e-4,
    "half_wavelength": 5e-4,
    "coupling_coefficient": 2e-3,
    "static_capacitance": 5e-3,
    "quality_factor": 5e-3,
    "amplitude_per_volt": 5e-3,
}
"""**Assumed**: what one recording's reading of an answer may be off by beyond its noise, as a
share, each recording by itself: another temperature, another mounting, another way of fitting. Of
the size by which recordings of one made-up bench differ (raw signals read its resonance 0.025 %
beside the frequency response, amplitudes lie up to 1 % apart); a real one does hardly better."""

FREQUENCIES = ("resonance_frequency", "parallel_resonance_frequency", "mode_frequency")
KINDS: tuple[tuple[str, ...], ...] = (
    FREQUENCIES,
    ("coupling_coefficient", "static_capacitance"),
    ("quality_factor", "amplitude_per_volt"),
    ("half_wavelength", "mass", "modal_mass"),
)
"""Answers of a plate whose errors have one scale: of frequency, of electricity, of vibration, of
body and shape."""
SHARED: si.Dimensionless = 0.75
"""Share of the variance of a frequency's error that all frequencies of one plate have in common
(assumed): a plate that is stiffer or heavier than modelled moves them together. What the mesh adds
they have in common altogether."""
SPREAD: float = 0.42
"""Spread of the logarithm of a kind's scale, whose median is 1: between a half and twice in nine of
ten benches (assumed)."""
ALIKE: si.Dimensionless = 0.5
"""The correlation of the scales' logarithms between kinds (assumed): a plate that is not as
modelled in one kind is less trusted in all."""
FRICTION_SCALES = (0.3, 3.0)
"""The scale of µ′/µ, anywhere between these on a logarithmic axis: no law was ever compared with a
display, so none is believed to be nearly right however well it fits. Chosen so that curves of other
shapes than any law here are held mostly (`tests/recovery/test_calibration_benches.py`)."""
MISFIT: si.Dimensionless = 0.01
"""Data that the model would give so seldom or less are called a misfit."""

Judgement = Literal["fits", "misfit"]


def scales_of(scores: si.DimensionlessArray) -> si.DimensionlessArray:
    """The discrepancy's scales of standard normal scores, both of shape (points, kinds)."""
    # The symmetric root of a correlation that is the same between all kinds.
    count = len(KINDS)
    own, all_ = np.sqrt(1 - ALIKE), np.sqrt(1 + (count - 1) * ALIKE)
    mixed = own * scores + (all_ - own) * scores.mean(axis=1, keepdims=True)
    return np.asarray(np.exp(SPREAD * mixed))


def unit_covariances(names: Sequence[str]) -> si.DimensionlessArray:
    """Covariances of what the model may be off by (relative), of every kind at a scale of 1, shape
    (kinds, answers, answers), for answers by `names`."""
    covariances = np.zeros((len(KINDS), len(names), len(names)))
    shares = np.array([BELIEVED[name] for name in names])
    for number, kind in enumerate(KINDS):
        own = np.array([name in kind for name in names])
        shared = SHARED if kind == FREQUENCIES else 0.0
        alike = np.where(np.eye(len(names), dtype=bool), 1.0, shared)
        covariances[number] = np.outer(own * shares, own * shares) * alike
    return covariances


def solver_covariance(names: Sequence[str], errors: si.DimensionlessArray) -> si.DimensionlessArray:
    """The covariance of the solver's own relative `errors` (answers,): one mesh moves all
    frequencies alike. Shape (answers, answers)."""
    frequency = np.array([name in FREQUENCIES for name in names])
    alike = np.outer(frequency, frequency) | np.eye(len(names), dtype=bool)
    return np.asarray(np.outer(errors, errors) * alike)


@dataclass(frozen=True)
class Misfit:
    """Judgement of how well the best parameters explain what was observed.

    `chi_square` is that of the best fit, its parameters' pull away from their priors included, over
    as many `degrees` as there are observations; `probability` is how often a right model would fit
    as badly. `worst` names the observation that fits worst, `off` by how many standard errors.
    """

    chi_square: float
    degrees: int
    probability: si.Dimensionless
    worst: str
    off: float

    @property
    def judgement(self) -> Judgement:
        """Judgement by how often a right model would fit as badly."""
        return "misfit" if self.probability < MISFIT else "fits"

    @property
    def sentence(self) -> str:
        """The judgement as one says it."""
        if self.degrees == 0:
            return "Nothing was observed, so nothing is judged."
        how = (
            f"chi-square {self.chi_square:.1f} over {self.degrees} observations, which a right "
            f"model would exceed in {_percent(self.probability)} of all benches"
        )
        if self.judgement == "fits":
            return f"The model explains what was observed ({how})."
        return (
            f"The model does not explain what was observed ({how}). Worst is the {self.worst}, "
            f"{abs(self.off):.1f} standard errors {'above' if self.off > 0 else 'below'} what the "
            "best parameters give. Something is not modelled: the intervals were widened by the "
            "discrepancy that was sampled, and no parameter should be read as measured."
        )


def _percent(share: si.Dimensionless) -> str:
    return "less than 0.01 %" if share < 1e-4 else si.percent(share, 2)


def misfit_of(chi_square: float, names: list[str], off: si.FloatArray) -> Misfit:
    """The judgement of a best fit by its chi-square and how far it is off each observation, in
    standard errors (observed minus fitted)."""
    from scipy.stats import chi2

    if not names:
        return Misfit(0.0, 0, 1.0, "", 0.0)
    at = int(np.argmax(np.abs(off)))
    return Misfit(
        float(chi_square),
        len(names),
        float(chi2.sf(chi_square, len(names))),
        names[at],
        float(off[at]),
    )


GRID = np.geomspace(*FRICTION_SCALES, 7)
"""Scales of the discrepancy that are summed over."""
# As a difference of logarithms: at twice the amplitude the error is mostly another.
_FORGOTTEN = 0.7


class Touching(NamedTuple):
    """Conditions under which µ′/µ is observed or predicted: vibration amplitude (m, with the finger
    on), normal force (N) and speed (m/s); None where it is the display's own, the force as
    uncertain as it is there."""

    amplitude: si.Metre
    force: si.Newton | None = None
    speed: si.MetrePerSecond | None = None

    @property
    def said(self) -> str:
        """Conditions in words."""
        words = f"relative friction at {1e6 * self.amplitude:.3g} µm"
        if self.force is not None:
            words += f", {self.force:.3g} N"
        return words + (f", {1e3 * self.speed:.3g} mm/s" if self.speed is not None else "")


def touching(observation: Observation) -> Touching:
    """The conditions of an observed µ′/µ.

    Raises `InputError` for one without its amplitude, or conditions that are not above 0.
    """
    given = observation.conditions
    if observation.answer != FRICTION or "vibration_amplitude" not in given:
        raise InputError(
            f"a {FRICTION} was observed without its vibration_amplitude; give it in its conditions "
            "(m, zero to peak, with the finger on)",
            quantity="observations",
        )
    for name in ("vibration_amplitude", "normal_force", "finger_speed"):
        si.require(name, given.get(name, 1.0), above=0)
    if not observation.standard_error > 0:
        raise InputError(f"a {FRICTION} needs a standard error above 0", quantity="observations")
    return Touching(
        given["vibration_amplitude"], given.get("normal_force"), given.get("finger_speed")
    )


@dataclass(frozen=True, eq=False)
class FrictionLikelihood:
    """Observations of µ′/µ, as judges of curves: µ′/µ of draws at the same conditions, shape
    (draws, observations)."""

    observations: tuple[Observation, ...]

    @cached_property
    def where(self) -> tuple[Touching, ...]:
        """The conditions, in the order of the observations."""
        return tuple(touching(seen) for seen in self.observations)

    @cached_property
    def observed(self) -> si.DimensionlessArray:
        """Observed values, shape (observations,)."""
        return np.array([seen.value for seen in self.observations])

    @cached_property
    def noise(self) -> si.DimensionlessArray:
        """Standard errors, shape (observations,)."""
        return np.array([seen.standard_error for seen in self.observations])

    def _covariance(self, scale: float) -> si.FloatArray:
        error = scale * BELIEVED[FRICTION]
        return error**2 * _likeness(self.where, self.where) + np.diag(self.noise**2)

    def logarithms(self, curves: si.DimensionlessArray) -> si.FloatArray:
        """The logarithm of the likelihood of every draw under every scale of `GRID`, shape (draws,
        scales); −∞ for a draw that has no friction somewhere."""
        from scipy.stats import multivariate_normal

        off = self.observed - curves
        known = np.isfinite(off).all(axis=1)
        logarithms = np.full((len(curves), GRID.size), -math.inf)
        for k, scale in enumerate(GRID):
            normal = multivariate_normal(cov=self._covariance(float(scale)))
            logarithms[known, k] = normal.logpdf(off[known])
        return logarithms

    def errors(
        self,
        curves: si.DimensionlessArray,
        scales: si.DimensionlessArray,
        at: tuple[Touching, ...],
        seed: int,
    ) -> si.DimensionlessArray:
        """Draws of the law's error at other conditions, given what it was at those observed: for
        draws with their scales, shape (draws, conditions), correlated between the conditions. With
        one seed the first conditions are the same whatever follows them."""
        own, far = _likeness(at, at), _likeness(self.where, at)
        noise = np.random.default_rng(seed).normal(size=(len(at), len(curves))).T
        errors = np.zeros((len(curves), len(at)))
        for scale in np.unique(scales):
            rows = scales == scale
            error = (scale * BELIEVED[FRICTION]) ** 2
            gain = np.linalg.solve(self._covariance(float(scale)), error * far)
            left = error * (own - far.T @ gain)
            # A condition named twice has no error of its own: a hair keeps the factor.
            root = np.linalg.cholesky(left + 1e-9 * error * np.eye(len(at)))
            errors[rows] = (self.observed - curves[rows]) @ gain + noise[rows] @ root.T
        return errors

    def misfit(self, curves: si.DimensionlessArray) -> Misfit:
        """Judgement of how well the best of the draws explains what was observed, without a
        discrepancy."""
        off = (self.observed - curves) / self.noise
        squares = np.where(np.isfinite(off).all(axis=1), np.sum(off**2, axis=1), math.inf)
        at = int(np.argmin(squares))
        pairs = zip(self.observations, self.where, strict=True)
        names = [seen.in_words(where.said) for seen, where in pairs]
        return misfit_of(float(squares[at]), names, off[at])


def _likeness(a: tuple[Touching, ...], b: tuple[Touching, ...]) -> si.DimensionlessArray:
    """The correlation of the law's error between conditions, shape (a, b). A condition that is the
    display's own on one side only counts as another one."""
    # What is not told is NaN.
    mine = np.log(np.array(a, dtype=float).reshape(-1, 1, 3))
    other = np.log(np.array(b, dtype=float).reshape(1, -1, 3))
    apart = np.nan_to_num(np.abs(mine - other) / _FORGOTTEN, nan=0.3)
    apart[np.isnan(mine) & np.isnan(other)] = 0.0
    return np.asarray(np.exp(-np.sum(apart, axis=2)))
