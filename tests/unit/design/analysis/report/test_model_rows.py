"""Rows about models, of an analysis that nothing computed."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

from squeezefilm.design.analysis.report.rows import (
    cited,
    missed_directions,
    show_missed,
    theory_rows,
)

MODE = SimpleNamespace(
    model="solid", resonance_frequency=30e3, half_wavelength=10e-3, amplitude_per_volt=100e-9
)
BEAM = SimpleNamespace(
    model="beam", resonance_frequency=31e3, half_wavelength=11e-3, vibration_amplitude=3e-6
)


def analysis(voltage: float | None, **changes: Any) -> Any:
    touch = SimpleNamespace(free_amplitude=1.5e-6)
    point = SimpleNamespace(mode=MODE, voltage=voltage, touch=touch, vibration_amplitude=1e-6)
    parts = {"prediction": point, "other_models": (BEAM,)}
    return SimpleNamespace(**{**parts, **changes})


def test_theories_are_compared_without_a_finger_each_at_its_resonance() -> None:
    used, other = theory_rows(analysis(20.0))
    assert used == ("solid (used)", "30 kHz", "10 mm", "2 µm")
    assert other == ("beam", "31 kHz", "11 mm", "3 µm")
    # Where the amplitude is given the free one is what is known.
    assert theory_rows(analysis(None))[0][3] == "1.5 µm"


def test_directions_are_said_with_their_source() -> None:
    assert cited("section 2.4") == "Biet et al., section 2.4"
    assert cited("elsewhere") == "elsewhere"
    (unasked,) = missed_directions("a-model")
    assert unasked == "Published directions were not asked of the model 'a-model'."


def test_what_a_model_misses_is_said(printed: Callable[[], str]) -> None:
    show_missed("partial-levitation")
    text = printed()
    assert "What measurements say and 'partial-levitation' does not" in text
    assert "the faster the finger slides" in " ".join(text.split())
    assert "In the model" not in text
    show_missed("levitation-2016")
    assert "were not asked of the model 'levitation-2016'" in printed()
