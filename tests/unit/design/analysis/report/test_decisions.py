"""The rows that one decides from."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace
from typing import Any

import numpy as np

from squeezefilm.design.analysis.felt import FeltAt, FeltGratings
from squeezefilm.design.analysis.report.rows import (
    felt_rows,
    interval_rows,
    sensitivity_rows,
    wanted_rows,
)
from squeezefilm.design.analysis.sensitivities import (
    DisplaySensitivities,
    DisplaySensitivity,
    Shift,
)
from squeezefilm.design.analysis.wanted import VoltageInterval, Wanted
from squeezefilm.physics.uncertainty.draws import Refusals

VOLTS = VoltageInterval(
    interval=(2.5, None),
    median=9.0,
    level=0.9,
    limit=15.0,
    beyond=0.3,
    never=0.04,
    voltages=np.zeros(2),
    refused=Refusals(128),
    seed=1,
)


def test_intervals_stand_where_something_is_driven() -> None:
    assert interval_rows(None) == []
    some: Any = SimpleNamespace(amplitude_interval=None)
    assert interval_rows(some) == []
    driven: Any = SimpleNamespace(
        amplitude_interval=(1e-6, 2e-6), level=0.9, power=7.5, power_interval=(5.0, 10.0)
    )
    assert interval_rows(driven) == [
        ("", "1 µm to 2 µm", "90 % interval of the amplitude"),
        ("Power taken", "7.5 W", "plate and finger, cold"),
        ("", "5 W to 10 W", "90 % interval of the power"),
    ]


def test_a_wanted_friction_has_its_voltage_and_who_reaches_it() -> None:
    assert wanted_rows(None) == []
    wanted = Wanted(0.5, 1.04e-6, 9.31, uncertain=VOLTS)
    assert wanted_rows(wanted) == [
        ("For µ′/µ = 0.5", "9.31 V", "1.04 µm, as described"),
        ("", "2.5 V to out of reach", "90 % interval, median 9 V"),
        ("", "70 %", "of the draws reach it at the drive's 15 V; in 4 % no voltage does"),
    ]
    far = Wanted(0.1, None, None, "too far", why_no_interval="refused")
    assert wanted_rows(far) == [
        ("For µ′/µ = 0.1", "not reached", "too far"),
        ("", "no interval", "refused"),
    ]


def test_what_is_felt_stands_beside_what_survives() -> None:
    assert felt_rows(None) == []
    felt = FeltGratings(
        "somebody",
        1.0,
        (
            FeltAt(0.1, 0.335e-3, 0.125e-3, (0.125e-3, 0.45e-3), 0.0),
            FeltAt(0.2, 0.67e-3, 0.43e-3, (0.125e-3, None), 0.03),
        ),
        0.1,
    )
    assert felt_rows(felt) == [
        (
            "Finest grating felt at 100 mm/s",
            "0.125 mm or finer",
            "0.125 mm or finer at best and 0.45 mm at worst (90 % interval); 0.34 mm survives the "
            "resonator",
        ),
        (
            "Finest grating felt at 200 mm/s",
            "0.43 mm",
            "0.125 mm or finer at best and none at worst (90 % interval); none is felt in 3 % of "
            "the draws; 0.67 mm survives the resonator",
        ),
    ]
    plain = dataclasses.replace(felt, at=(FeltAt(0.1, 0.5e-3, None),))
    assert felt_rows(plain)[0][1:] == (
        "none",
        "by the senses of 'somebody'; 0.5 mm survives the resonator",
    )


def test_what_moves_most_stands_first_and_what_is_not_known_last() -> None:
    def row(path: str, frequency: float | None, friction: float) -> DisplaySensitivity:
        ends = [
            Shift(value, sign and frequency and sign * frequency, 0.0, 0.3 + sign * friction)
            if frequency is not None
            else Shift(value, None, None, None, "glue")
            for value, sign in ((1e-3, -1), (2e-3, 1))
        ]
        return DisplaySensitivity(path, 1.5e-3, "m", "assumed", "a guess", ends[0], ends[1])

    rows = (row("a", 0.0, 0.1), row("b", 0.1, 0.0), row("c", None, 0.0))
    found = DisplaySensitivities(0.3, "quick", "a beam", rows)
    assert sensitivity_rows(found) == [
        ["b", "1 mm to 2 mm", "−10 %, +10 %", "–", "0.30, 0.30", "assumed"],
        ["a", "1 mm to 2 mm", "–", "–", "0.20, 0.40", "assumed"],
        ["c", "1 mm to 2 mm", "not known", "not known", "–, –", "assumed"],
    ]
