"""Rows about models and about what is uncertain: beside the numbers that one decides from."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.console import Console

from squeezefilm.core import quantities as si
from squeezefilm.core.kit.numbers import HZ, M, shown
from squeezefilm.core.kit.terminal import bullets, heading
from squeezefilm.design.analysis.published_claims import missed_by

if TYPE_CHECKING:
    from squeezefilm.design.analysis.analysis import Analysis
    from squeezefilm.physics.uncertainty.intervals import GroupInfluence
    from squeezefilm.physics.uncertainty.parameters import Knowledge
    from squeezefilm.physics.uncertainty.uncertainty import UncertainFriction

MISSED_HEADING = "What measurements say and '{}' does not"


def models(analysis: Analysis) -> list[tuple[str, str]]:
    """Names of what was computed and of its models, as pairs."""
    p = analysis.prediction
    rows = [
        ("Resonance and mode shape", p.mode.model),
        ("Vibration amplitude", p.amplitude_model),
        ("Pressure and friction", p.model),
    ]
    if analysis.fidelity is not None:
        rows.append(("Envelope and textures", "first-order envelope at resonance, open loop"))
    return rows


def missed_directions(model: str, *, why: bool = False) -> list[str]:
    """The published directions that a friction model misses, as sentences with their sources, and
    `why` where asked for; from the claims on record."""
    missed = missed_by(model)
    if missed is None:
        return [f"Published directions were not asked of the model '{model}'."]
    if not missed:
        return ["None of those on record; `squeezefilm reproduce` lists them."]
    return [
        f"{claim.says} ({cited(claim.where)})." + (f" In the model: {claim.why}." if why else "")
        for claim in missed
    ]


def cited(where: str) -> str:
    """A place in the source paper by the paper's name; another source as it stands."""
    return f"Biet et al., {where}" if where.startswith("section") else where


def theory_rows(analysis: Analysis) -> list[tuple[str, str, str, str]]:
    """Model, resonance, half wavelength and amplitude without a finger, driven at that resonance:
    as used, then by each other theory."""
    p = analysis.prediction
    free = p.touch.free_amplitude
    used = (
        p.mode.model + " (used)",
        p.mode.resonance_frequency,
        p.mode.half_wavelength,
        free if p.voltage is None else p.voltage * p.mode.amplitude_per_volt,
    )
    others = [
        (other.model, other.resonance_frequency, other.half_wavelength, other.vibration_amplitude)
        for other in analysis.other_models
    ]
    return [
        (
            model,
            shown(frequency, HZ),
            shown(half, M),
            shown(amplitude, M, 3),
        )
        for model, frequency, half, amplitude in (used, *others)
    ]


def influence_rows(unsure: UncertainFriction, knowledge: Knowledge, most: int) -> list[list[str]]:
    """Rows of what in a group makes a friction uncertain, the most important first: path, what is
    drawn of it, its share of the variance with all its company, and whose range or weights these
    are."""
    group = [
        influence for influence in unsure.influences if influence.parameter.knowledge == knowledge
    ]
    return [
        [
            influence.parameter.path,
            spread_words(influence.parameter.spread, law=hasattr(influence.parameter, "options")),
            f"{100 * influence.total:.0f} ± {si.percent(influence.total_error)}",
            "as described"
            if influence.parameter.origin == "given"
            else "assumed weights"
            if hasattr(influence.parameter, "options")
            else "assumed range",
        ]
        for influence in group[:most]
    ]


def spread_words(spread: tuple[str, ...], *, law: bool) -> str:
    """Options with their weights, or from where to where a value is drawn."""
    return ", ".join(spread) if law else " to ".join(spread)


def group_words(influence: GroupInfluence) -> str:
    """Heading that names a group of inputs, and what it carries of the width."""
    what = {"measurable": "Could be measured", "unknown": "Nobody knows"}[influence.knowledge]
    return (
        f"{what}: {100 * influence.total:.0f} ± {si.percent(influence.error)} of the variance, "
        f"{100 * max(influence.alone, 0):.0f} ± {si.percent(influence.alone_error)} by itself"
    )


def weight_rows(unsure: UncertainFriction) -> list[list[str]]:
    """The laws and states that are drawn, each with its assumed weight and why."""
    choices = [
        influence.parameter
        for influence in unsure.influences
        if hasattr(influence.parameter, "options")
    ]
    return [
        [choice.path, option.name, si.percent(option.weight), option.why]
        for choice in sorted(choices, key=lambda choice: choice.path)
        for option in choice.options
    ]


def show_missed(console: Console, model: str) -> None:
    """Print what measurements say and a friction model does not."""
    heading(console, MISSED_HEADING.format(model))
    bullets(console, [("–", text, "yellow") for text in missed_directions(model)])
