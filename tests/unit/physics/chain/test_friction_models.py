"""Every model of friction says what it makes of the film."""

from __future__ import annotations

from typing import get_args

from squeezefilm.physics.chain.pad_law import DEFAULT_MODEL, MODEL_KINDS, FrictionModel


def test_every_model_has_a_kind() -> None:
    assert set(MODEL_KINDS) == set(get_args(FrictionModel))
    assert MODEL_KINDS[DEFAULT_MODEL].shares_load
    closed = {name for name, kind in MODEL_KINDS.items() if not kind.shares_load}
    assert closed == {"paper2008", "paper2008-printed"}
    timed = {name for name, kind in MODEL_KINDS.items() if kind.fitted}
    assert timed == {"levitation", "levitation-ridges"}
