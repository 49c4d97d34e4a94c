"""What the terminal says of followed modes: the first, the plate's own and the last value."""

from __future__ import annotations

import numpy as np
from tests.unit.report.printed import printed

from squeezefilm.analysis.plate.tracking import ModeTrack, ModeTracks
from squeezefilm.report.kit.terminal import plain_console
from squeezefilm.report.plate.terminal import show_tracks

NAN = float("nan")


def tracks(unit: str, values: list[float], begun: float) -> ModeTracks:
    """A driven mode, and one that was lost above the beginning."""
    alike = np.ones(4)
    return ModeTracks(
        parameter="ceramic_thickness",
        unit=unit,
        values=np.array(values),
        own=begun,
        begun=begun,
        tracks=(
            ModeTrack("(8,0)", np.array([30e3, 31e3, 33581.26, 35e3]), alike, True),
            ModeTrack("(7,1)", np.array([28e3, 29e3, 29.5e3, NAN]), alike, False),
        ),
        least_likeness=0.7,
    )


def said(found: ModeTracks) -> list[str]:
    return printed(lambda: show_tracks(plain_console(), found))


def test_modes_are_said_at_the_first_the_begun_and_the_last_value() -> None:
    # 0.95 mm is nearest to the third value, from below.
    assert said(tracks("m", [0.5e-3, 0.75e-3, 1e-3, 1.25e-3], 0.95e-3)) == [
        "Modes against ceramic_thickness",
        "mode 0.5 mm 1 mm 1.25 mm",
        "(8,0) 30 kHz 33.581 kHz 35 kHz driven",
        "(7,1) 28 kHz 29.5 kHz not followed",
    ]


def test_a_parameter_without_a_unit_is_a_plain_number() -> None:
    lines = said(tracks("1", [0.2, 0.25, 0.3, 0.35], 0.2512345))
    assert lines[1] == "mode 0.2 0.25 0.35"
    assert lines[2] == "(8,0) 30 kHz 31 kHz 35 kHz driven"
