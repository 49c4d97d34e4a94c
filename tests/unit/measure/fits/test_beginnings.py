"""Where fits of a circuit begin, and what is said where two circuits fit alike."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.measure.fits.circuit import choice, impedance
from squeezefilm.measure.fits.estimate import Adequacy

F = np.linspace(28e3, 32e3, 401)


def admittance(*modes: tuple[float, float, float]) -> Any:
    """A capacitance beside branches of a frequency, a Q and a conductance at resonance (S)."""
    y = 2j * np.pi * F * 1e-9
    for own, quality, peak in modes:
        y = y + peak / (1 + 1j * quality * (F / own - own / F))
    return y


def test_the_strongest_poles_of_a_band_are_begun_with() -> None:
    strong, weak = (29.2e3, 100.0, 5e-3), (31.1e3, 150.0, 1e-3)
    own, quality = choice._starts(F, admittance(strong, weak), 2) or ((), ())
    assert own == pytest.approx([29.2e3, 31.1e3], rel=1e-4)
    assert quality == pytest.approx([100.0, 150.0], rel=0.02)
    own, quality = choice._starts(F, admittance(strong, weak), 1) or ((), ())
    assert own == pytest.approx([29.2e3], rel=3e-3)


def test_where_no_pole_is_found_one_begins_at_the_peak_and_two_do_not(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[int] = []

    def none(f: Any, y: Any, count: int) -> Any:
        # Below the band, above it, and too blunt to be one.
        asked.append(count)
        return np.array([1e3, 90e3, 30e3]), np.array([50.0, 50.0, choice._LEAST_QUALITY])

    monkeypatch.setattr(choice, "poles", none)
    y = admittance((30e3, 80.0, 2e-3))
    found = choice._starts(F, y, 1)
    assert found is not None
    assert (found[0].tolist(), found[1].tolist()) == ([30e3], [30.0])
    assert asked == [1, 2, 3]
    assert choice._starts(F, y, 2) is None


@dataclasses.dataclass
class Fit:
    """A fit of a layout with its sentence."""

    layout: Any
    adequacy: Adequacy


def test_corrections_that_a_sweep_does_not_tell_apart_are_named() -> None:
    def layout(*has: str) -> Any:
        return SimpleNamespace(**{name: name in has for name in impedance.CORRECTIONS})

    adequacy = Adequacy(True, 0.01, 0.01, "", "It fits.")
    told: Any = Fit(layout("leads"), adequacy)
    found = impedance._alike(told, layout("coupling_loss"))
    said = found.adequacy.sentence
    assert said.startswith("It fits. ")
    assert "a loss of the coupling" in said.lower()
    assert "leads in series" in said.lower()
    assert "drift" not in said
    assert "describe this sweep alike" in said
    assert found.layout is told.layout
