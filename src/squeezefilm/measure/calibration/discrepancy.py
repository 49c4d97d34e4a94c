"""How far a right-looking model may be from a real bench, and how observations judge it.

A solved plate is not the plate: glue is uneven, a mode nobody modelled is near, a law of contact
is another one. Such errors are sampled beside the parameters: an answer may be off by its
`BELIEVED` share times one unknown scale, from a hundredth (the model is right) to three. Where the
data fit, the scale stays small; where they do not, it grows and every interval with it, so that a
calibration is not narrow and wrong.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from squeezefilm import quantities as si

BELIEVED: dict[str, si.Dimensionless] = {
    "resonance_frequency": 0.01,
    "parallel_resonance_frequency": 0.01,
    "mode_frequency": 0.01,
    "half_wavelength": 0.01,
    "mass": 0.01,
    "coupling_coefficient": 0.05,
    "static_capacitance": 0.05,
    "modal_mass": 0.1,
    "quality_factor": 0.2,
    "amplitude_per_volt": 0.2,
    "relative_friction": 0.2,
}
"""**Assumed**: what a solved plate may be off by, as a share of the answer (of µ′/µ absolute).
The paper's own plate lies further from its maker's model, 14 % in frequency and 64 % in amplitude:
such a bench is a misfit here, and its scale large."""

SCALES = (0.01, 3.0)
"""The unknown scale, anywhere between these on a logarithmic axis (assumed)."""
FRICTION_SCALES = (0.3, 3.0)
"""The same of µ′/µ: no law was ever compared with a display, so none is believed to be nearly right
however well it fits. Chosen so that curves of other shapes than any law here are held mostly
(`tests/recovery/test_calibration_benches.py`)."""
MISFIT: si.Dimensionless = 0.01
"""Data that the model would give so seldom or less are called a misfit."""

Judgement = Literal["fits", "misfit"]


def scale_of(score: si.DimensionlessArray) -> si.DimensionlessArray:
    """The scale of the discrepancy of standard normal scores."""
    from scipy.special import ndtr

    low, high = np.log(SCALES)
    return np.asarray(np.exp(low + (high - low) * ndtr(score)))


@dataclass(frozen=True)
class Misfit:
    """How well the best parameters explain what was observed.

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
        """Whether a right model would often enough fit as badly."""
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
