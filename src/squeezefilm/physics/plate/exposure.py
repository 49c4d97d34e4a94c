"""Published guidance on airborne ultrasound: one table of limits, each with how well we know it.

What the texts agree about: a limit in one-third-octave bands that rises by 30 dB or more from the
20 kHz band, which some people hear, to the 25 kHz band and beyond, which nobody does. What they do
not: who it is for (the public has the lower values, workers the higher), how levels that last less
than a working day count, and whether a limit may be 30 dB higher where the source does not touch
the body (Howard, Hansen and Zander 2004 report that the American recommendations were raised by as
much "under certain conditions", which were not read: it is not counted on here). The ICNIRP
reviewed the oldest ones in 2024 and found that they may be "too low or too high":
10.1097/HP.0000000000001800. Canada's Safety Code 24 (1991) and the reports of the British HSE
(CRR 343/2001) have tables too, whose numbers could not be read and are not here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from squeezefilm.core import quantities as si

EAR_DISTANCE: si.Metre = 0.5
"""Distance from the plate to the ear of somebody seated at it (assumed)."""

Audience = Literal["public", "occupational"]


@dataclass(frozen=True)
class ExposureGuidance:
    """A recommended limit of sound pressure level, with how well we know it.

    It holds in one-third-octave bands between `low` and `high`. `evidence` says what was seen:
    a limit marked "to be checked" was not read in its own text.
    """

    level_dB: float
    low: si.Hertz
    high: si.Hertz
    audience: Audience
    name: str
    source: str
    evidence: str


_IRPA = (
    "IRPA 1984",
    "IRPA/INIRC 1984, Interim guidelines on limits of human exposure to airborne ultrasound, "
    "Health Physics 46(4), 969-974; still the guideline in 2024: 10.1097/HP.0000000000001800",
    "to be checked: quoted second-hand, the guideline's own text was not read",
)
_HOWARD = (
    "Howard et al. 2004",
    "Howard, Hansen and Zander 2004, A review of current ultrasound exposure limits, J. Occup. "
    "Health Saf. Aust. N. Z. 21(3), 253-257: the consensus of the limits reviewed, below 4 hours",
    "to be checked: read as a quotation of the review, not in the limits themselves",
)
GUIDANCE = (
    ExposureGuidance(70.0, 17.8e3, 22.4e3, "public", *_IRPA),
    ExposureGuidance(100.0, 22.4e3, 112e3, "public", *_IRPA),
    ExposureGuidance(75.0, 17.8e3, 22.4e3, "occupational", *_HOWARD),
    ExposureGuidance(110.0, 22.4e3, 56e3, "occupational", *_HOWARD),
)
"""Published guidance, one entry per band and audience; the reviews call its basis thin."""


@si.checked_numbers
def exposure_guidance(
    frequency: Annotated[si.Hertz, si.Above(0.0)],
    audience: Audience = "public",
) -> ExposureGuidance | None:
    """The guidance for a tone, or None where there is none."""
    for entry in GUIDANCE:
        if entry.audience == audience and entry.low <= frequency < entry.high:
            return entry
    return None
