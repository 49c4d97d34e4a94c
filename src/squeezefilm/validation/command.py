"""`reproduce`: every published claim recomputed, with a verdict that is computed, not recited."""

from __future__ import annotations

import functools
import math
import operator
from dataclasses import dataclass
from typing import Any

from squeezefilm.actuators.described import load_actuator
from squeezefilm.actuators.motor.assembled import Working, assembled
from squeezefilm.actuators.motor.averaged import averaged, no_load_speed
from squeezefilm.actuators.skin_stretch.array import SkinStretchArray
from squeezefilm.actuators.skin_stretch.bimorph import loaded_tip
from squeezefilm.core import presets
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConfigError
from squeezefilm.core.kept.store import Kept
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import stamp, to_json
from squeezefilm.design.analysis.paper_procedure import PaperDesign
from squeezefilm.design.analysis.published_claims import (
    VERDICT_OF_GROUNDS,
    Claim,
    Erratum,
    Verdict,
    read_claims,
)
from squeezefilm.validation.explanations import PrototypeStudy, prototype_study
from squeezefilm.validation.frozen import DIRECTION_VALUES
from squeezefilm.validation.values import CLAIM_VALUES, ClaimValue, paper_design, value_of

_PRELOADS, _AMPLITUDES = (10.0, 20.0), (1.5e-6, 4e-6)
_PRINTED_SURFACE = 10e-6


def _array() -> SkinStretchArray:
    described: SkinStretchArray = load_actuator("biet2008-skin-stretch").skin_stretch  # type: ignore[union-attr]
    return described


@value_of("skin-stretch-free")
def _() -> ClaimValue:
    array, volts = _array(), _array().actuator.largest_voltage
    return ClaimValue((array.bender.deflection_per_volt * volts,), note=f"at {volts:.3g} V")


@value_of("skin-stretch-blocked")
def _() -> ClaimValue:
    array, volts = _array(), _array().actuator.largest_voltage
    return ClaimValue((array.bender.force_per_volt * volts,), note=f"at {volts:.3g} V")


@value_of("skin-stretch-loaded")
def _() -> ClaimValue:
    array = _array()
    skin = array.tissue.under_contactor(*array.cradle.size)
    tip = loaded_tip(array.bender, skin, array.actuator.largest_voltage)
    return ClaimValue((tip.deflection,), note=f"with {1e3 * tip.force:.3g} mN on the skin")


@value_of("skin-stretch-surface")
def _() -> ClaimValue:
    array = _array()
    apart = math.sqrt(_PRINTED_SURFACE / array.cradle.count)
    return ClaimValue(
        (array.cradle.active_area,),
        (_PRINTED_SURFACE,),
        note=f"60 contactors on 10 mm² would stand {1e3 * apart:.2g} mm apart",
    )


@value_of("skin-stretch-mass")
def _() -> ClaimValue:
    return ClaimValue((_array().budget.mass,), note="of the actuators alone, without clamps")


@value_of("skin-stretch-count")
def _() -> ClaimValue:
    return ClaimValue((float(_array().cradle.count),), note="in 10 columns and 6 rows")


@value_of("skin-stretch-volume")
def _() -> ClaimValue:
    return ClaimValue((_array().budget.volume,), note="of the actuators alone, without clamps")


@value_of("motor-tangential")
def _() -> ClaimValue:
    motor = assembled(load_actuator("biet2008-motor").motor)  # type: ignore[union-attr]
    small, large = (Working(amplitude=amplitude) for amplitude in _AMPLITUDES)
    faster = no_load_speed(motor, large) - no_load_speed(motor, small)
    # Where feet hardly leave the slider, they drag it back after they pushed it.
    slow = no_load_speed(motor, small)
    stronger = averaged(motor, large, speed=slow).thrust - averaged(motor, small, speed=slow).thrust
    return ClaimValue(
        (faster, stronger),
        note="faster without a load (m/s), and a larger thrust at the same speed (N), at 4 µm "
        "than at 1.5 µm",
    )


@value_of("motor-contact")
def _() -> ClaimValue:
    motor = assembled(load_actuator("biet2008-motor").motor)  # type: ignore[union-attr]

    def share(preload: float, amplitude: float) -> float:
        return averaged(motor, Working(amplitude=amplitude, preload=preload)).contact_share

    (light, hard), (small, large) = _PRELOADS, _AMPLITUDES
    pressed = share(hard, small) - share(light, small)
    swung = share(hard, small) - share(hard, large)
    return ClaimValue(
        (pressed, swung),
        note="how much longer feet touch under 20 N than under 10 N, and at 1.5 µm than at 4 µm",
    )


_VALUES: Kept[ClaimValue] = Kept("claims", ClaimValue)


@dataclass(frozen=True)
class ClaimResult:
    """A claim, what was found for it, and the verdict."""

    claim: Claim
    found: ClaimValue
    verdict: Verdict


@dataclass(frozen=True)
class Reproduction:
    """All claims recomputed, the errata, where the paper's design procedure leads, and the study of
    its prototype (None where none was made)."""

    results: tuple[ClaimResult, ...]
    errata: tuple[Erratum, ...]
    design: PaperDesign
    prototype: PrototypeStudy | None = None

    @property
    def changed(self) -> tuple[ClaimResult, ...]:
        """The claims whose verdict differs from the one on record."""
        return tuple(item for item in self.results if item.verdict != item.claim.verdict)

    def summary(self) -> dict[str, Any]:
        """Values as plain JSON: ``claims`` (values in the SI ``unit`` each names),
        ``errata``."""
        return {
            "claims": [
                {
                    **to_json(item.claim),
                    "model": item.claim.model or None,
                    **to_json(item.found),
                    "verdict": item.verdict,
                    "verdict_on_record": item.claim.verdict,
                }
                for item in self.results
            ],
            "errata": to_json(self.errata),
            "design_procedure": to_json(self.design),
            "prototype": to_json(self.prototype),
            "changed": [item.claim.id for item in self.changed],
            "provenance": stamp([item.claim for item in self.results]),
        }


def reproduce(
    claims: tuple[Claim, ...] | None = None,
    *,
    prototype: bool = False,
    progress: SayProgress | None = None,
) -> Reproduction:
    """Recompute every claim (those on record, or those given), and study the paper's `prototype`
    where that is asked. What was found until it was stopped is kept on disk.

    Raises `ConfigError` for a claim that nothing computes.
    """
    tell = progress or (lambda _: None)
    file = read_claims()
    results = []
    for claim in file.all_claims if claims is None else claims:
        tell(f"claim {claim.name}")
        results.append(judge(claim, _found(claim)))
    tell("the paper's design procedure")
    study = prototype_study(progress) if prototype else None
    return Reproduction(tuple(results), file.errata, paper_design(), study)


def _found(claim: Claim) -> ClaimValue:
    known = DIRECTION_VALUES if claim.model else CLAIM_VALUES
    if claim.id not in known:
        raise ConfigError(
            f"nothing computes the claim '{claim.id}'.{si.did_you_mean(claim.id, known)}",
            file=presets.claims_path(),
        )
    model = (claim.model,) if claim.model else ()
    return _VALUES.found(f"{claim.id} {claim.model}", functools.partial(known[claim.id], *model))


def judge(claim: Claim, value: ClaimValue) -> ClaimResult:
    """The verdict on a claim, from what was computed for it."""
    return ClaimResult(claim, value, _verdict(claim, value))


def _verdict(claim: Claim, found: ClaimValue) -> Verdict:
    passed = VERDICT_OF_GROUNDS.get(claim.grounds)
    if claim.relation == "equals":
        if _near(found.value, claim):
            return passed or "reproduces"
        if found.alternative is not None and _near(found.alternative, claim):
            return "misprint"
        return "does not reproduce"
    if claim.relation == "within":
        least, most = min(claim.printed), max(claim.printed)
        holds = all(least <= value <= most for value in found.value)
    else:
        compare = {"above": operator.gt, "at_least": operator.ge, "at_most": operator.le}
        pairs = zip(found.value, claim.printed, strict=True)
        holds = all(compare[claim.relation](value, bound) for value, bound in pairs)
    return (passed or "holds") if holds else "does not hold"


def _near(values: tuple[float, ...], claim: Claim) -> bool:
    return all(
        math.isclose(value, printed, rel_tol=claim.tolerance)
        for value, printed in zip(values, claim.printed, strict=True)
    )
