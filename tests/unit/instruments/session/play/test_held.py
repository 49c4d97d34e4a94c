"""What a device says of its loops becomes SI, words and columns of the record."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from squeezefilm.instruments.device.wire import messages as m
from squeezefilm.instruments.session.play.plan import HELD_COLUMNS, HeldState, held_columns

SAID = m.Loops(
    time=5, mode=2, flags=m.LOOPS_ON | m.TEMPERATURE_KNOWN, lost=0, false_locks=0,
    frequency=30_000_000, detuning=-6554, target=200_000, error=1_000, reserve=12_500_000,
    load=32_768, temperature=31_500,
)  # fmt: skip


def test_an_answer_in_si_and_in_words() -> None:
    held = HeldState.of(SAID)
    assert held.locked
    assert held.words == (
        "loops locked, detuning -0.10 half-bandwidths, amplitude +0.5 %, reserve 12.5 V, "
        "finger 0.50, 31.5 °C"
    )
    row = held_columns(held, 2)
    assert row.shape == (2, len(HELD_COLUMNS))
    assert row[1].tolist() == pytest.approx([1.0, -0.1, 0.005, 12.5, 0.5, 31.5], abs=1e-4)


def test_what_is_not_known_is_not_a_number() -> None:
    quiet = dataclasses.replace(SAID, mode=0, flags=m.LOOPS_ON, target=0)
    held = HeldState.of(quiet)
    assert not held.locked
    assert math.isnan(held.amplitude_error)
    assert held.words.startswith("loops searching")
    assert "amplitude –" in held.words
    assert "°C" not in held.words
    assert np.isnan(held_columns(held, 1)[0]).tolist() == [False, False, True, False, False, True]
    assert np.isnan(held_columns(None, 3)).all()
    assert HeldState.of(dataclasses.replace(SAID, mode=9)).mode == "9"
