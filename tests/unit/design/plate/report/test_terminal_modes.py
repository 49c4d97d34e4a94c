"""What is said alike of plates, discs and stators: sound levels and the table of modes."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.unit.printed import printed

from squeezefilm.design.plate.report.terminal import show_guidance, show_modes, sound_rows
from squeezefilm.design.plate.solved import ModeRow
from squeezefilm.physics.plate.sound import GUIDANCE


def sound(guidance: Any = GUIDANCE[1]) -> Any:
    """Levels at three distances."""
    return SimpleNamespace(
        guidance=guidance,
        distances=(0.3, 0.5, 1.0),
        sound_pressure_level_dB=np.array([120.4, 116.6, 110.0]),
    )


def test_the_guidance_stands_beside_the_nearest_level_only() -> None:
    assert sound_rows(sound(), "upwards") == [
        ("Sound at 0.3 m", "120 dB", "upwards; guidance 100 dB"),
        ("Sound at 0.5 m", "117 dB", ""),
        ("Sound at 1 m", "110 dB", ""),
    ]
    assert sound_rows(sound(None), "upwards")[0][2] == "upwards; no guidance"


def test_levels_and_distances_must_be_as_many() -> None:
    short = SimpleNamespace(
        guidance=None, distances=(0.3, 0.5), sound_pressure_level_dB=np.array([120.4])
    )
    with pytest.raises(ValueError, match="shorter"):
        sound_rows(short, "upwards")  # type: ignore[arg-type]


def test_the_guidance_is_told_with_where_it_is_from() -> None:
    (line,) = printed(lambda: show_guidance(sound()), 400)
    assert line.startswith("Guidance (to be checked: quoted second-hand")
    assert line.endswith(GUIDANCE[1].source)
    assert printed(lambda: show_guidance(sound(None))) == []


def mode(label: str, alone_per_volt: float) -> ModeRow:
    return ModeRow(label, 33581.26, 12.345, 212.34, alone_per_volt, 0.1234, 1.0, None)


def test_a_mode_ten_thousand_times_fainter_than_the_working_one_is_not_driven() -> None:
    rows = [mode("(8,0)", 1.2345e-7), mode("(7,0)", 1e-11), mode("(9,0)", 0.99e-11)]
    assert printed(lambda: show_modes(rows, 1e-7)) == [
        "Modes in the band, each alone at its antinode",
        "mode frequency ± Q per volt coupling",
        "(8,0) 33.581 kHz 12 Hz 212 123 nm/V 0.12",
        "(7,0) 33.581 kHz 12 Hz 212 10 pm/V 0.12",
        "(9,0) 33.581 kHz 12 Hz 212 not driven 0.12",
    ]
