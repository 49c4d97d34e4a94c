"""The load of an amplifier in words."""

import dataclasses

from squeezefilm.design.analysis.report.rows import electronics_rows
from squeezefilm.physics.plate.electronics import AmplifierCheck, ElectricalLoad

LOAD = ElectricalLoad(
    33.58e3, 15.0, 75.4e-9, 1.07, 8.04, 7.83, 0.974, 3.16e6, 293e-6, 1.04, 15e-6, 14.6, 7, 0.153,
    10.8e-9, (AmplifierCheck("a kind", "a part", False, "gives 2 V/µs", "a sheet"),),
)  # fmt: skip


def test_every_number_has_its_row() -> None:
    assert electronics_rows(LOAD) == [
        ("Electrode capacitance", "75.4 nF", "7 ceramics in parallel, 10.8 nF each on average"),
        (
            "Drive current, peak", "1.07 A",
            "at 15 V and 33.58 kHz, without a finger; 7 ceramics in parallel, 153 mA each on "
            "average",
        ),
        ("Drive power", "7.83 W", "of 8.04 VA apparent; power factor 0.97"),
        ("Slew rate", "3.16 V/µs", "the sine's steepest slope"),
        (
            "Matching inductor", "293 µH parallel",
            "the amplifier then gives 1.04 A at the same voltage",
        ),
        ("", "15 µH in series", "the amplifier then gives 14.6 V for 15 V at the ceramics"),
        ("Amplifier", "cannot", "a kind, such as a part: gives 2 V/µs (a sheet)"),
    ]  # fmt: skip


def test_what_is_not_known_is_not_said() -> None:
    (row,) = electronics_rows(None)
    assert row[:2] == ("Electrical load", "not known")
    bare = dataclasses.replace(
        LOAD, capacitance=None, capacitance_per_channel=None, parallel_inductance=None,
        series_inductance=None, channels=1, amplifiers=(),
    )  # fmt: skip
    rows = electronics_rows(bare)
    assert [name for name, *_ in rows] == ["Drive current, peak", "Drive power", "Slew rate"]
    assert rows[0][2] == "at 15 V and 33.58 kHz, without a finger"


def test_what_is_assumed_of_a_load_stands_before_it() -> None:
    first, second, *_ = electronics_rows(dataclasses.replace(LOAD, assumed="its ceramic"))
    assert first == ("Electrical load", "assumed in part", "its ceramic")
    assert second[0] == "Electrode capacitance"
