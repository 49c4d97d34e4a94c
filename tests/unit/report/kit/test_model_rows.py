"""Rows about models, of an analysis that nothing computed."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from squeezefilm.report.kit.model_rows import cited, film_rows, missed_directions, theory_rows

MODE = SimpleNamespace(
    model="solid", resonance_frequency=30e3, half_wavelength=10e-3, amplitude_per_volt=100e-9
)
BEAM = SimpleNamespace(
    model="beam", resonance_frequency=31e3, half_wavelength=None, vibration_amplitude=None
)


def analysis(voltage: float | None, **changes: Any) -> Any:
    touch = SimpleNamespace(free_amplitude=1.5e-6)
    point = SimpleNamespace(mode=MODE, voltage=voltage, touch=touch, vibration_amplitude=1e-6)
    parts = {"prediction": point, "other_models": (BEAM,), "film_models": None}
    return SimpleNamespace(**{**parts, **changes})


def test_theories_are_compared_without_a_finger_each_at_its_resonance() -> None:
    used, other = theory_rows(analysis(20.0))
    assert used == ("solid (used)", "30 kHz", "10 mm", "2 µm")
    assert other == ("beam", "31 kHz", "–", "–")
    # Where the amplitude is given the free one is what is known.
    assert theory_rows(analysis(None))[0][3] == "1.5 µm"


def test_films_say_their_error_and_what_was_not_solved() -> None:
    def film(model: str, over: float, error: float) -> Any:
        return SimpleNamespace(
            model=model, over_pressure=over, over_pressure_error=error, load_share=2 * over,
            relative_friction=1 - 2 * over,
        )  # fmt: skip

    films = SimpleNamespace(
        results=(film("paper2008", 0.1, 0.0), film("film-open", 0.2, 1e-4),
                 film("film-smooth", float("nan"), 0.0))
    )  # fmt: skip
    assert film_rows(analysis(None, film_models=films)) == [
        ("paper2008", "0.1", "20 %", "0.800"),
        ("film-open", "0.2 ± 0.0001", "40 %", "0.600"),
        ("film-smooth", "not solved", "–", "–"),
    ]
    assert film_rows(analysis(None)) == []


def test_directions_are_said_with_their_source() -> None:
    assert cited("section 2.4") == "Biet et al., section 2.4"
    assert cited("elsewhere") == "elsewhere"
    (unasked,) = missed_directions("a-model")
    assert unasked == "Published directions were not asked of the model 'a-model'."
