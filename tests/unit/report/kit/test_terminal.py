"""What the command line prints: readable at 80 columns, plain where nobody looks."""

from __future__ import annotations

from typing import Any

import pytest

from squeezefilm.analysis.analyze import Analysis
from squeezefilm.errors import ConfigError
from squeezefilm.quantities import Unit
from squeezefilm.report.kit import terminal
from squeezefilm.report.kit.numbers import display_values, micro, printable, shown


@pytest.fixture(autouse=True)
def plain_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("FORCE_COLOR", "COLUMNS", "TTY_COMPATIBLE", "TTY_INTERACTIVE"):
        monkeypatch.delenv(name, raising=False)


def printed(capsys: pytest.CaptureFixture[str]) -> str:
    captured = capsys.readouterr()
    assert captured.err == ""
    assert "\x1b" not in captured.out
    assert all(len(line) <= 80 for line in captured.out.splitlines())
    return captured.out


def test_presets_are_listed_with_what_is_assumed(capsys: pytest.CaptureFixture[str]) -> None:
    listing = terminal.preset_list()
    by_name = {item["name"]: item for item in listing}
    assert {"biet2008-plate", "biet2008-stator", "touchpad-glass"} <= set(by_name)
    assert by_name["biet2008-plate"]["values_assumed"] == 15
    terminal.show_presets(listing)
    text = printed(capsys)
    assert "biet2008-stator" in text
    assert "15 of 39" in text


def test_values_are_shown_as_written(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    values = terminal.display_values("biet2008-plate")
    by_path = {item["path"]: item for item in values}
    assert by_path["actuator.thickness"] == {
        "path": "actuator.thickness",
        "text": "2 mm",
        "source": "paper, section 3.1",
        "evidence": "published",
    }
    assert by_path["actuator.substrate.poisson_ratio"]["text"] == "0.30"
    assert by_path["actuator.substrate.poisson_ratio"]["evidence"] == "assumed"
    assert by_path["actuator.patches.7.polarity"]["text"] == "1"
    assert by_path["name"]["evidence"] is None
    terminal.show_values(values)
    text = printed(capsys)
    assert "* poisson_ratio" in text
    assert "* assumed: 15 of" in text
    # Where there are colours, what is assumed stands out.
    styles: list[Any] = []
    monkeypatch.setattr(terminal, "table", lambda *_, **how: styles.append(how["styles"]))
    terminal.show_values(values)
    assert [one(("* a", "b", "")) for one in styles[:2]] == ["yellow"] * 2
    assert [one(("  a", "* b", "")) for one in styles[:2]] == [""] * 2


def test_values_of_what_cannot_be_loaded_are_refused() -> None:
    with pytest.raises(ConfigError, match="Did you mean"):
        terminal.display_values("biet2008-plat")


def test_paths_of_the_report_are_those_of_the_listing(plate_analysis: Analysis) -> None:
    written = {item["path"] for item in terminal.display_values("biet2008-plate")}
    assert written <= {value.path for value in display_values(plate_analysis.display)}


def test_what_a_model_misses_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    terminal.show_missed(terminal.plain_console(), "partial-levitation")
    text = printed(capsys)
    assert "What measurements say and 'partial-levitation' does not" in text
    assert "the faster the finger slides" in " ".join(text.split())
    assert "In the model" not in text
    terminal.show_missed(terminal.plain_console(), "film-smooth")
    assert "were not asked of the model 'film-smooth'" in printed(capsys)


def test_progress_is_plain_lines_where_no_terminal_is(capsys: pytest.CaptureFixture[str]) -> None:
    with terminal.progress(enabled=True) as step:
        step("film\x1b[2J")
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err == "  film [2J …\n"


def test_progress_can_be_silent(capsys: pytest.CaptureFixture[str]) -> None:
    with terminal.progress(enabled=False) as step:
        step("film")
    captured = capsys.readouterr()
    assert captured.out == captured.err == ""


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.6e-6, "m", "0.6 µm"),
        (2e-6, "m", "2 µm"),
        (67e-9, "m", "67 nm"),
        (0.083, "m", "83 mm"),
        (0.5, "N", "0.5 N"),
        (5.51085e-4, "s", "0.5511 ms"),
        (34656.3, "Hz", "34.66 kHz"),
        (1.0302e-7, "m/V", "103 nm/V"),
        (0.0, "m", "0 m"),
        (1900, "1", "1900"),
    ],
)
def test_quantities_read_as_the_field_says_them(value: float, unit: str, text: str) -> None:
    assert shown(value, Unit(unit)) == text


def test_micro_sign_and_printable() -> None:
    assert micro("50 um") == "50 µm"
    assert micro("copper") == "copper"
    assert printable("a\x1b[31m\n b\u202e") == "a [31m b"
