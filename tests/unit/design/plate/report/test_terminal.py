"""What the terminal says of a solved film and of a solved plate."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
from tests.unit.made_results import WARM, WARM_LINES, made_result
from tests.unit.printed import printed

from squeezefilm.design.film import FilmAnswer, FilmRequest
from squeezefilm.design.plate.command import _REMARKS, PlateAnalysis
from squeezefilm.design.plate.report.terminal import show_plate
from squeezefilm.design.plate.solved import ModeRow
from squeezefilm.design.report.film import show_film
from squeezefilm.physics.plate.circuit import EquivalentCircuit

FILM = FilmAnswer(
    squeeze_number=12.3456, excursion_ratio=0.56789, request=FilmRequest("disc"),
    mean_load=1.23456789123, over_pressure=0.23456789, over_pressure_error=1.23e-4,
    stiffness_relative=0.98765432, damping_relative=0.12345678, force_error=2.1e-4,
    force_harmonics=np.zeros(8, dtype=complex), force_harmonics_error=np.zeros(8),
    iterations=3, residual=0.0,
    status="converged", model="a-model", film=None,  # type: ignore[arg-type]
)  # fmt: skip
WORKING = ModeRow("(8,0)", 33581.26, 12.345, 212.34, 1.2e-7, 0.1234, 1.0, 10e-3)
ASIDE = ModeRow("(7,1)", 30000.0, 12.0, 200.0, 1e-13, 0.0, 0.0, None)
CIRCUIT = EquivalentCircuit(40e3, 200.0, 5.4321e-9, 123.45, 0.098765, 1.2345e-10)


LOAD = SimpleNamespace(current=12.345e-3, apparent_power=0.092588, real_power=0.043211)


def plate(**changes: Any) -> Any:
    """A solved plate, with all that there can be to say."""
    values = {
        "display": SimpleNamespace(
            title="A plate", name="plate", drive=SimpleNamespace(voltage=15.0)
        ),
        "working": WORKING,
        "rows": (WORKING, ASIDE),
        "mode": SimpleNamespace(
            amplitude_per_volt=1.2346e-7,
            lobe=(41.5e-3, 24.5e-3),
            beam=SimpleNamespace(mode=SimpleNamespace(frequency=1.021 * 33581.26)),
        ),
        "largest_per_volt": 1.9e-7,
        "load": LOAD,
        "circuit": CIRCUIT,
        "circuit_said": "",
        "sound": SimpleNamespace(
            guidance=SimpleNamespace(level_dB=100.0, source="somebody 1984", evidence="doubtful"),
            distances=(0.3,),
            sound_pressure_level_dB=np.array([120.4]),
        ),
        "model": "piezoelectric_solid_3d",
        "status": "12 modes",
        "remarks": _REMARKS,
        "heat": WARM,
        "objections": ("a doubt",),
    }
    return made_result(PlateAnalysis, **{**values, **changes})


def said(columns: int = 220, **changes: Any) -> list[str]:
    return printed(lambda: show_plate(plate(**changes)), columns)


def test_a_film_is_said_with_its_error_and_what_numbers_are_relative_to() -> None:
    assert printed(lambda: show_film(FILM)) == [
        "disc, σ = 12.35, ε = 0.5679",
        "Mean load W 1.2345679 over ambient pressure × area",
        "Over-pressure W − 1 0.234568 ± 0.0001 (estimated)",
        "Stiffness 0.987654 ± 0.0002, of p0·A·ε, first harmonic",
        "Damping 0.123457 ± 0.0002, of p0·A·ε, first harmonic",
        "converged",
    ]


def test_a_plate_is_said_with_all_that_there_is() -> None:
    assert said() == [
        "A plate [plate]",
        "Mode (8,0) 33.581 kHz ± 12 Hz (estimated)",
        "Amplitude per volt 123.5 nm/V antinode at x 41.5 mm, y 24.5 mm, without a finger",
        "190 nm/V largest, upper face",
        "Quality factor 212.3 from the losses of its materials",
        "Effective coupling 0.123",
        "As a Timoshenko beam 34.286 kHz +2.1 %",
        "At 15 V 12.3 mA 0.0926 VA, 0.0432 W",
        "Equivalent circuit C0 5.43 nF R1 123 Ω, L1 98.8 mH, C1 123 pF",
        *WARM_LINES,
        "Sound at 0.3 m 120 dB loudest direction; guidance 100 dB",
        "Guidance (doubtful): somebody 1984",
        "Modes in the band, each alone at its antinode",
        "mode frequency ± Q per volt coupling",
        "(8,0) 33.581 kHz 12 Hz 212 120 nm/V 0.12",
        "(7,1) 30 kHz 12 Hz 200 not driven 0",
        "piezoelectric_solid_3d; 12 modes",
        "! a doubt",
        "! it is hot",
    ]


def test_a_mode_without_a_circuit_says_why_and_a_weak_one_how_much_of_it_is_its_own() -> None:
    lines = said(circuit=None, circuit_said="none: nothing drives it")
    assert "Equivalent circuit none nothing drives it" in lines
    assert not [line for line in lines if "R1" in line]
    lines = said(circuit_said="the mode has 13 % of the conductance at its resonance")
    at = lines.index("Equivalent circuit C0 5.43 nF R1 123 Ω, L1 98.8 mH, C1 123 pF")
    assert lines[at + 1] == "the mode has 13 % of the conductance at its resonance"


def test_labels_are_not_broken_on_a_narrow_terminal() -> None:
    assert any(line.startswith("As a Timoshenko beam 34.286") for line in said(42))
    film = printed(lambda: show_film(FILM), 42)
    assert any(line.startswith("Over-pressure W − 1 0.234568") for line in film)
