"""The display that a front is set beside, by the same questions."""

from __future__ import annotations

from dataclasses import replace

from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.design.search.candidate import Design, Evaluated
from squeezefilm.design.search.criteria import (
    breaches,
    numbers_of_prediction,
    numbers_of_solved,
)
from squeezefilm.design.search.requirements import Requirements
from squeezefilm.design.search.sources import shared_sources
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import load_display

_NONE = Design(0, ())
"""In place of a design, since nobody chose it."""


def reference_of(requirements: Requirements) -> Evaluated:
    """What the display of `compare_with` does at the requirements' voltage, under their finger, on
    their surface, cooled as theirs are; solved in three dimensions.

    It has no class of cost, since nobody says what it is built from. Where it cannot be judged, its
    reason says why.
    """
    base, own = requirements.base, load_display(requirements.compare_with)
    of_body = {at: one for at, one in own.provenance.items() if at.startswith("actuator.")}
    display = replace(
        own,
        finger=base.finger,
        surfaces=base.surfaces,
        gas=base.gas,
        thermal=base.thermal,
        active_area=None,
        provenance=shared_sources(requirements) | of_body,
    )
    try:
        found = predict(display, voltage=requirements.drive.voltage)
        if not found.mode.has_shape:
            return _not_judged(found.objections[-1])
        numbers = numbers_of_prediction(requirements, display, found)
        numbers |= numbers_of_solved(requirements, display, found)
    except SqueezefilmError as error:
        return _not_judged(str(error))
    del numbers["cost"]
    return Evaluated(_NONE, "solved", numbers, breaches(numbers, requirements.limits))


def _not_judged(reason: str) -> Evaluated:
    return Evaluated(_NONE, "solved", {}, reason=reason)
