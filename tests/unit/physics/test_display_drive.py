"""The limits that a display gives its drive, and those it leaves to be assumed."""

from __future__ import annotations

from dataclasses import replace

import pytest

from squeezefilm.core.drive_limits import Limits
from squeezefilm.core.errors import InputError
from squeezefilm.core.presets import path
from squeezefilm.physics.display import Display, Drive, load_display


def test_what_a_drive_does_not_say_is_assumed_and_named() -> None:
    drive = Drive(15.0)
    limits = drive.limits(30e3)
    assert limits == Limits(15.0, 15e3, 15.0, 2250.0, 28.5e3, 31.5e3)
    assert drive.assumed_limits == (
        "slew", "continuous_voltage", "heat", "lowest_frequency", "highest_frequency",
    )  # fmt: skip


def test_what_a_drive_says_holds() -> None:
    drive = Drive(
        100.0, "0.5 mm glass", 2e5, 50.0, 1e4, 29e3, 30e3, duty=0.5, duty_window=20.0
    )  # fmt: skip
    assert drive.limits(29.5e3) == Limits(
        100.0, 2e5, 50.0, 1e4, 29e3, 30e3, 0.5, 20.0, "0.5 mm glass"
    )
    assert drive.assumed_limits == ()
    assert drive.limits(29.5e3, 40.0).continuous_voltage == 40.0


def test_above_42_volts_a_display_names_its_insulation() -> None:
    with pytest.raises(InputError, match="touch-side insulation"):
        Drive(100.0).limits(30e3)
    assert Drive(100.0).limits(30e3, 42.0).voltage == 42.0
    assert Drive(100.0, insulation="0.5 mm glass").limits(30e3).voltage == 100.0


def test_an_assumed_insulation_counts_for_a_twin_only() -> None:
    stator = load_display("biet2008-stator")
    assert stator.limits(40.5e3, twin=True).voltage == 140.0
    with pytest.raises(InputError, match="counts for the twin only"):
        stator.limits(40.5e3, twin=False)
    assert stator.limits(40.5e3, 42.0, twin=False).voltage == 42.0
    vouched = replace(stator, provenance={})
    assert vouched.limits(40.5e3, twin=False).insulation == stator.drive.insulation
    without = replace(stator, drive=replace(stator.drive, insulation=" "))
    for twin in (True, False):
        with pytest.raises(InputError, match="mm glass, 4 kV"):
            without.limits(40.5e3, twin=twin)
    load_display("biet2008-plate").require_insulation(twin=False)


def test_more_than_the_drives_own_voltage_is_refused() -> None:
    with pytest.raises(InputError, match="voltage"):
        Drive(15.0).limits(30e3, 16.0)


@pytest.mark.parametrize("field", ["slew", "heat", "lowest_frequency", "duty"])
def test_values_outside_their_range_are_refused(field: str) -> None:
    with pytest.raises(InputError, match=field):
        Drive(15.0, **{field: -1.0})


def test_a_file_gives_the_limits_with_units() -> None:
    from squeezefilm.core.config.load import load_text

    text = path("biet2008-plate").read_text(encoding="utf-8")
    more = text.replace(
        "[drive]\n",
        '[drive]\ninsulation = { value = "0.5 mm glass", source = "data sheet" }\n'
        'slew = "2 V/ms"\nheat = "100 V2*s"\nlowest_frequency = "29 kHz"\n',
    )
    assert more != text
    drive = load_text(Display, more).drive
    assert drive.insulation == "0.5 mm glass"
    assert (drive.slew, drive.heat, drive.lowest_frequency) == (2e3, 100.0, 29e3)
    assert load_display("biet2008-plate").drive.insulation == ""
