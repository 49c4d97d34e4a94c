"""A value moved to both sides, one at a time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pytest

from squeezefilm.actuators.analysis.effects import MOVED, effects
from squeezefilm.core import quantities as si
from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.distributions import Uniform
from squeezefilm.core.errors import InputError


@si.checked_numbers
@dataclass(frozen=True)
class Spring:
    """A spring under a force."""

    stiffness: si.NewtonPerMetre
    force: si.Newton
    turns: int = 4


@dataclass(frozen=True)
class Described:
    """What a file describes."""

    spring: Spring


KNOWN = {
    "spring.stiffness": Provenance("a guess", "assumed"),
    "spring.force": Provenance("a balance", "measured", Uniform(1.0, 3.0)),
    "spring.turns": Provenance("counted", "assumed"),
}


def stretch(described: Described) -> Mapping[str, float]:
    if described.spring.stiffness > 115:
        raise InputError("it breaks")
    return {"stretch": described.spring.force / described.spring.stiffness}


def test_assumed_values_move_by_a_share_and_others_over_their_range() -> None:
    described = Described(Spring(100.0, 2.0))
    stiff, force = effects(described, KNOWN, stretch, lambda _: True)
    assert (stiff.low, stiff.high) == pytest.approx((100 * (1 - MOVED), 100 * (1 + MOVED)))
    assert not stiff.is_range
    assert stiff.answers["stretch"][0] == pytest.approx(2 / stiff.low)
    assert np.isnan(stiff.answers["stretch"][1])
    assert force.is_range
    assert (force.low, force.high) == pytest.approx((1.1, 2.9))
    assert force.answers["stretch"] == pytest.approx((0.011, 0.029))


def test_what_is_not_to_be_tried_is_left_out_unless_it_has_a_range() -> None:
    found = effects(Described(Spring(100.0, 2.0)), KNOWN, stretch, lambda _: False)
    assert [one.path for one in found] == ["spring.force"]
