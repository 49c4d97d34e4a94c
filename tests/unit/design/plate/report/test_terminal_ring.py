"""What the terminal says of a solved disc or stator, and of a stator whose metal was fitted."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
from tests.unit.made_results import WARM, WARM_LINES, made_result
from tests.unit.printed import printed

from squeezefilm.design.plate.report.terminal import fit_sentences, show_plate
from squeezefilm.design.plate.ring import RingAnalysis, _remarks
from squeezefilm.design.plate.solved import ModeRow
from squeezefilm.physics.plate.circuit import EquivalentCircuit
from squeezefilm.physics.plate.ring.body import StatorAssumptions

WORKING = ModeRow("B(0,9)", 40523.4, 12.345, 212.34, 1.2e-7, 0.1234, 1.0, 9.3456e-3)
ASIDE = ModeRow("T(0,2)", 41001.2, 12.0, 200.0, 1e-13, 0.0, 0.0, None)
GUIDANCE = SimpleNamespace(level_dB=100.0, source="somebody 1984", evidence="to be checked")
CIRCUIT = EquivalentCircuit(40e3, 200.0, 5.4321e-9, 123.45, 0.098765, 1.2345e-10)


def fitted(**assumed: Any) -> Any:
    """A stator whose metal was fitted to 40.5 kHz."""
    return SimpleNamespace(
        ring_thickness=2.34567e-3,
        mode=SimpleNamespace(label="B(0,9)", frequency=40.5e3),
        section=SimpleNamespace(mean_diameter=53.571e-3),
        assumptions=StatorAssumptions(**assumed),
        frequency_bounds=(40.5e3, 44.12e3),
    )


LOAD = SimpleNamespace(current=12.345e-3, apparent_power=0.074071, real_power=0.021234)


def ring(**changes: Any) -> Any:
    """A solved stator, with all that there can be to say."""
    values = {
        "display": SimpleNamespace(
            title="A stator", name="stator", drive=SimpleNamespace(voltage=12.0)
        ),
        "working": WORKING,
        "rows": (WORKING, ASIDE),
        "body": SimpleNamespace(fit=None, quality_factor=None),
        "mode": SimpleNamespace(amplitude_per_volt=1.2346e-7, lobe=(0.0, 2e-3), beam=None),
        "largest_per_volt": 1.9e-7,
        "computed_per_volt": 1.1e-7,
        "annular": SimpleNamespace(harmonic=9),
        "half_wavelength_along": "mean circumference",
        "circles": np.array([10.123e-3, 20e-3]),
        "load": LOAD,
        "circuit": CIRCUIT,
        "circuit_said": "",
        "sound": SimpleNamespace(
            guidance=GUIDANCE,
            distances=(0.3, 0.5),
            sound_pressure_level_dB=np.array([120.4, 116.6]),
        ),
        "model": "annular_3d",
        "status": "2 modes in the band, within 1e-3 (estimated)",
        "heat": WARM,
        "objections": ("a doubt",),
    }  # fmt: skip
    told = {**values, **changes}
    return made_result(RingAnalysis, **told, remarks=_remarks(told["body"]))


def said(columns: int = 250, **changes: Any) -> list[str]:
    return printed(lambda: show_plate(ring(**changes)), columns)


def test_a_ring_is_said_with_all_that_there_is() -> None:
    assert said() == [
        "A stator [stator]",
        "Mode B(0,9) 40.523 kHz ± 12 Hz (estimated)",
        "Amplitude per volt 123.5 nm/V antinode at x 0 mm, y 2 mm, without a finger",
        "190 nm/V largest, touched face",
        "110 nm/V computed there (the value above is measured)",
        "Half wavelength 9.346 mm along the mean circumference",
        "Nodal circles 10.1 mm, 20 mm radius",
        "Quality factor 212.3 from the losses of its materials",
        "Effective coupling 0.123",
        "At 12 V 12.3 mA 0.0741 VA, 0.0212 W",
        "Equivalent circuit C0 5.43 nF R1 123 Ω, L1 98.8 mH, C1 123 pF",
        *WARM_LINES,
        "Sound at 0.3 m 120 dB loudest direction, touched face only; guidance 100 dB",
        "Sound at 0.5 m 117 dB",
        "Guidance (to be checked): somebody 1984",
        "Modes in the band, each alone at its antinode",
        "mode frequency ± Q per volt coupling",
        "B(0,9) 40.523 kHz 12 Hz 212 120 nm/V 0.12",
        "T(0,2) 41.001 kHz 12 Hz 200 not driven 0",
        "B(circles, diameters) bends; R and T move in the plane, radially and around.",
        "annular_3d; 2 modes in the band, within 1e-3 (estimated)",
        "! a doubt",
        "! it is hot",
    ]


def test_a_disc_has_no_more_than_there_is() -> None:
    lines = said(
        computed_per_volt=None,
        circles=np.array([]),
        circuit=None,
        circuit_said="none: the channel does not drive this mode",
        working=ModeRow("B(1,0)", 40523.4, 12.0, 212.0, 1.2e-7, 0.1, 1.0, None),
        body=SimpleNamespace(fit=None, quality_factor=200.0),
        sound=SimpleNamespace(guidance=None, distances=(), sound_pressure_level_dB=np.array([])),
    )
    assert "Equivalent circuit none the channel does not drive this mode" in lines
    assert "Quality factor 212 of the assembly, as described" in lines
    absent = ("described", "Half wave", "Nodal", "Sound", "Guidance", "Fitted")
    assert not [line for line in lines if line.startswith(absent)]
    assert not [line for line in lines if "as measured" in line]


def test_a_fitted_stator_says_that_it_predicts_nothing() -> None:
    lines = said(body=SimpleNamespace(fit=fitted(), quality_factor=200.0))
    assert lines[1].endswith("± 12 Hz (estimated); fitted, not predicted")
    # A sentence may take two lines: the terminal is not endless.
    text = " ".join(lines)
    assert all(sentence in text for sentence in fit_sentences(fitted()))
    assert text.index("Fitted:") < text.index("Teeth:") < text.index("Assumed:")


def test_labels_are_not_broken_on_a_narrow_terminal() -> None:
    assert any(line.startswith("Effective coupling 0.123") for line in said(40))


def test_a_fit_says_what_is_fitted_bounded_and_assumed() -> None:
    first, teeth, assumed = fit_sentences(fitted())
    assert first.startswith(
        "Fitted: 2.346 mm of metal under the teeth, so that B(0,9) falls on 40.5 kHz, with the "
        "mean diameter of 53.57 mm from the wavelength."
    )
    assert "80 % metal." in teeth
    assert "between 40.5 kHz and 44.12 kHz;" in teeth
    assert assumed == (
        "Assumed: phosphor bronze, hard PZT (assumed) of 0.5 mm, teeth of 1.5 mm, 8 half-wave "
        "sectors on the channel."
    )


def test_a_stator_without_teeth_has_no_sentence_about_them() -> None:
    assert [one.partition(":")[0] for one in fit_sentences(fitted(tooth_height=0.0))] == [
        "Fitted",
        "Assumed",
    ]
