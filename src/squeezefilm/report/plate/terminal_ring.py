"""What is said of a stator that was fitted."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squeezefilm.report.kit.numbers import HZ, M, shown

if TYPE_CHECKING:
    from squeezefilm.plate.ring.stator import StatorFit


def fit_sentences(fit: StatorFit) -> tuple[str, ...]:
    """What was fitted of a stator, what the teeth leave uncertain, and what is assumed."""
    a = fit.assumptions
    said = [
        f"Fitted: {shown(fit.ring_thickness, M, 4)} of metal under the teeth, so that "
        f"{fit.mode.label} falls on {shown(fit.mode.frequency, HZ)}, with the mean diameter of "
        f"{shown(fit.derived['mean_diameter'], M, 4)} from the wavelength. One frequency fits one "
        "dimension and validates nothing."
    ]
    if a.tooth_height > 0:
        low, high = fit.frequency_bounds
        said.append(
            f"Teeth: an equivalent layer of {a.tooth_fill:.0%} metal ({a.tooth_model}). Between "
            f"teeth without hoop stiffness and teeth as stiff as their share of metal, this body "
            f"lies between {shown(low, HZ)} and {shown(high, HZ)}; real teeth are 7 to 13 % of "
            "the way up."
        )
    said.append(
        f"Assumed: {a.metal.name}, {a.ceramic.name} of {shown(a.ceramic_thickness, M)}, teeth of "
        f"{shown(a.tooth_height, M)}, {a.driven_sectors} half-wave sectors on the channel."
    )
    return tuple(said)
