"""Laws and mechanisms among which nobody can choose yet, each with the weight it is given.

No measurement tells them apart, so an interval draws them beside the parameters. **The weights are
assumed**: they say how much this package would bet, and why. Of a calibrated display its plate's
amplitude as a whole and its law's own error are drawn beside them.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.calibration_record import JointSpread
from squeezefilm.core.distributions import Normal
from squeezefilm.physics.contact.asperities import AsperityLaw
from squeezefilm.physics.contact.rough_contact import LEAST_GAP, ContactLaw, RoughContact
from squeezefilm.physics.display import Display
from squeezefilm.physics.uncertainty.parameters import Knowledge, Origin, Parameter

AMPLITUDE_SHARE, FRICTION_OFFSET = "joint.amplitude_share", "joint.friction_offset"
"""The amplitude per volt relative to the solved one, and what is added to the law's friction."""


def calibrated_inputs(
    inputs: tuple[Parameter | LawChoice, ...], joint: JointSpread | None, *, driven: bool
) -> tuple[Parameter | LawChoice, ...]:
    """The inputs of a display with what its calibration found; as they are without one.

    What the plate's own values make of the amplitude is known as a whole then, and better than they
    are, so that one input stands for all of them.
    """
    if joint is None:
        return inputs
    known = joint.amplitude_share_deviation > 0
    kept = tuple(input_ for input_ in inputs if not (known and input_.path.startswith("actuator.")))
    spreads = (
        (AMPLITUDE_SHARE, joint.amplitude_share, joint.amplitude_share_deviation, driven),
        (FRICTION_OFFSET, joint.friction_offset, joint.friction_offset_deviation, True),
    )
    return kept + tuple(
        Parameter(path, middle, si.Unit("1"), Normal(middle, deviation), "given", "the calibration")
        for path, middle, deviation, counts in spreads
        if counts and deviation > 0
    )


HEIGHT_LAW, MOISTURE, SLIP = "height_law", "finger.moisture", "gas.slip"
MECHANISM = "friction_model"


@dataclass(frozen=True)
class LawOption:
    """A law of several by its name, the probability that it is given, and why."""

    name: str
    weight: si.Dimensionless
    why: str


@dataclass(frozen=True)
class LawChoice:
    """Laws or states of which one is drawn; `weights` are assumed.

    `knowledge` says whether an experiment could settle it today.
    """

    path: str
    options: tuple[LawOption, ...]
    source: str
    knowledge: Knowledge = "unknown"
    origin: Origin = "assumed"

    @si.checked_numbers
    def drawn(self, share: si.DimensionlessArray) -> list[str]:
        """The options that shares of the probability (0 to 1) fall to."""
        ends = np.cumsum([option.weight for option in self.options])
        at = np.searchsorted(ends, np.asarray(share) * ends[-1], side="right")
        return [self.options[k].name for k in np.minimum(at, len(self.options) - 1).tolist()]

    @property
    def spread(self) -> tuple[str, ...]:
        """Options with their weights, in words."""
        return tuple(f"{option.name} {si.percent(option.weight)}" for option in self.options)


_HEIGHTS = LawChoice(
    HEIGHT_LAW,
    (
        LawOption(
            "persson",
            0.6,
            "its constants can be measured, it agrees with exact contact calculations and holds up "
            "to full contact",
        ),
        LawOption(
            "exponential",
            0.25,
            "what every rough elastic contact becomes at small pressure; it has a finite strength",
        ),
        LawOption(
            "gaussian",
            0.15,
            "heights of a skin are nearer to Gaussian, but asperities that do not feel one another "
            "fill too late",
        ),
    ),
    "the contact of skin on a surface was measured under no display",
)
_SLIP = LawChoice(
    SLIP,
    (
        LawOption("fukui-kaneko", 0.5, "the linearised Boltzmann equation, full accommodation"),
        LawOption("veijola", 0.25, "a fit over all Knudsen numbers, made for microsystems"),
        LawOption("first", 0.25, "good where the gap is more than ten free paths"),
    ),
    "accommodation of air on skin is not known",
)
LIFTS = LawChoice(
    MECHANISM,
    (
        LawOption("levitation", 0.43, "off by 0.057 from the friction at rest of published curves"),
        LawOption("levitation-ridges", 0.57, "off by 0.055, and in range in near-vacuum"),
    ),
    "published friction cannot refuse either; weights in proportion to the density that each puts "
    "on four fingers and papers, a mean log of 1.35 and 1.42 (decision 0018)",
)
"""The models fitted to people that published friction could not tell apart."""

_MOISTURES = {
    "dry": "a hard outermost skin",
    "normal": "as the moduli are meant",
    "moist": "a soft one",
}


def model_choices(display: Display) -> tuple[LawChoice, ...]:
    """Choices drawn beside the parameters of a display.

    The moisture described gets one half, the others a quarter each. What the description gives as
    measured (``evidence = "measured"``) stands.
    """
    described = display.finger.moisture
    moistures = tuple(
        LawOption(name, 0.5 if name == described else 0.25, why) for name, why in _MOISTURES.items()
    )
    moisture = LawChoice(MOISTURE, moistures, "how moist a finger is on the day", "measurable")
    measured = {
        path for path, origin in display.provenance.items() if origin.evidence == "measured"
    }
    if "finger.asperities.type" in measured:
        measured.add(HEIGHT_LAW)
    return tuple(choice for choice in (_HEIGHTS, moisture, _SLIP) if choice.path not in measured)


def same_interface(law: ContactLaw, name: str, pressure: si.Pascal) -> ContactLaw:
    """The interface of a law of contact by another one, "persson", "exponential" or "gaussian".

    Both carry `pressure` (Pa) at the same gap, so that they differ in shape alone. Heights have one
    standard deviation: an exponential law falls by e over Persson's decay length, Gaussian
    asperities deviate by h_rms.
    """
    if isinstance(law, RoughContact):
        if name == "persson":
            return law
        length = law.roughness if name == "gaussian" else law.decay_length
        return AsperityLaw(
            pressure,
            gap_of(law, pressure),
            length,
            "gaussian" if name == "gaussian" else "exponential",
        )
    if name == law.heights:
        return law
    gap, rough = gap_of(law, pressure), RoughContact()
    deviation = law.decay_length
    if law.heights == "exponential":
        deviation *= rough.roughness / rough.decay_length
    if name == "gaussian":
        return AsperityLaw(pressure, gap, deviation, "gaussian")
    rough = dataclasses.replace(rough, roughness=deviation)
    if name == "exponential":
        return AsperityLaw(pressure, gap, rough.decay_length)
    gap = max(gap, 2 * LEAST_GAP * deviation)
    return rough.stiffened(pressure / float(rough.pressure(gap)))


def gap_of(law: ContactLaw, pressure: si.Pascal) -> si.Metre:
    """The mean gap (m) at which a law of contact carries a pressure (Pa), nothing vibrating.

    Where separate asperities carry less even at no gap it is that; a rough elastic interface is
    held at the least gap of its law.
    """
    if isinstance(law, AsperityLaw) and law.heights == "exponential":
        fall = law.decay_length * float(np.log(pressure / law.reference_pressure))
        return max(law.reference_gap - fall, 1e-3 * law.decay_length)
    unit = law.roughness if isinstance(law, RoughContact) else law.decay_length
    gaps = unit * np.linspace(1.001 * LEAST_GAP, 11.9, 400)
    carried = np.log(np.asarray(law.pressure(gaps)))
    return float(np.interp(-np.log(pressure), -carried, gaps))
