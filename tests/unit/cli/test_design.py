"""`squeezefilm design` as a person types it: mistakes are told before any work."""

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.unit.design.search.report.made_search import made_search
from typer.testing import CliRunner

import squeezefilm as sf
from squeezefilm.cli import app
from squeezefilm.core import presets
from squeezefilm.core.errors import ConfigError, InputError, WorkersError
from squeezefilm.design.search import run as searches

PRESET = "biet2008-plate"
FEW = ["--screened", "24", "--solved", "2", "--jobs", "1"]


def invoked(*arguments: str | Path) -> tuple[int, str]:
    asked = ["design", *map(str, arguments)]
    done = CliRunner().invoke(app, asked, catch_exceptions=False)
    return done.exit_code, done.output


@pytest.fixture
def changed(tmp_path: Path) -> Callable[[str, str], Path]:
    """The preset's file with one text in place of another, and where it stands."""

    def write(old: str, new: str) -> Path:
        text = presets.resolve(PRESET, "requirements").read_text(encoding="utf-8")
        assert text.count(old) >= 1
        file = tmp_path / "mine.toml"
        file.write_text(text.replace(old, new, 1), encoding="utf-8")
        return file

    return write


@pytest.fixture
def nothing_computed(monkeypatch: pytest.MonkeyPatch) -> None:
    def computed(*_: object, **__: object) -> object:
        raise AssertionError("something was computed before the mistake was told")

    monkeypatch.setattr(searches, "reference_of", computed)
    monkeypatch.setattr(searches, "workers", computed)


def test_without_requirements_the_presets_are_listed_with_what_to_do() -> None:
    code, shown = invoked()
    assert code == 0
    assert PRESET in shown
    assert "squeezefilm design NAME" in shown
    code, shown = invoked("--json")
    assert json.loads(shown) == {"requirements": list(presets.names("requirements"))}


@pytest.mark.usefixtures("nothing_computed")
def test_an_unknown_preset_is_told_with_those_there_are() -> None:
    with pytest.raises(ConfigError, match=r"Did you mean 'biet2008-plate'\?"):
        invoked("biet2008-plat")


@pytest.mark.usefixtures("nothing_computed")
def test_what_is_no_finger_is_told() -> None:
    with pytest.raises(InputError, match="allowed are new, mean, and a file"):
        invoked(PRESET, "--finger", "nobody")


@pytest.mark.usefixtures("nothing_computed")
@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("most_stress", "most_stres", r"line \d+.*most_stres\b.*Did you mean 'most_stress'"),
        ('"200 mm/s"', '"200 mm"', r"line \d+.*touch\.speed.*wrong dimension"),
        (
            "most_lines = 16",
            "most_lines = 4",
            r"line \d+.*most_lines = 4 .* at least 5, which is least_lines",
        ),
        ('"aluminium 7075"', '"aluminum 7057"', r"line \d+.*no material 'aluminum 7057'"),
        ('type = "strips"', 'type = "stripes"', r"line \d+.*type"),
        ('compare_with = "biet2008-plate"', 'compare_with = "biet2008-plat"', r"biet2008-plat'"),
        ('start_from = "biet2008-plate"', 'start_from = "biet2008-stator"', "a measured ring"),
        ('least_voltage = "5 V"', 'least_voltage = "20 V"', "which is voltage"),
    ],
)
def test_a_mistake_in_the_file_is_told_with_its_line(
    changed: Callable[[str, str], Path], old: str, new: str, message: str
) -> None:
    with pytest.raises(InputError) as told:
        invoked(changed(old, new))
    assert re.search(message, str(told.value).replace("\n", " ")), told.value


@pytest.mark.usefixtures("nothing_computed")
def test_counts_that_cannot_be_and_places_that_cannot_be_written_are_refused(
    tmp_path: Path,
) -> None:
    file = tmp_path / "file"
    file.write_text("mine", encoding="utf-8")
    for arguments, message in (
        (["--screened", "0"], "screened"),
        (["--solved", "-1"], "solved"),
        (["--jobs", "-1"], "jobs"),
        (["--member", "-1"], "member"),
        (["--out", file], "is a file, not a folder"),
        (["--out", file / "below"], "nothing can be written there"),
    ):
        with pytest.raises(InputError, match=message):
            invoked(PRESET, *arguments)
    assert file.read_text(encoding="utf-8") == "mine"


def test_one_that_is_stopped_says_so_and_ends_as_interrupted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stopped(*_: object, **__: object) -> object:
        raise KeyboardInterrupt

    monkeypatch.setattr(searches.SearchRun, "_screen", stopped)
    monkeypatch.setattr(searches, "reference_of", lambda _: None)
    for options, hint in (
        (["--out", tmp_path], "the same command goes on"),
        ([], "add --out DIR to keep what is done"),
    ):
        code, shown = invoked(PRESET, *FEW, *options)
        assert code == 130
        assert f"stopped; {hint}" in shown
    assert "was stopped" in (tmp_path / "index.html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_one_whose_cluster_is_gone_shows_what_it_has_and_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def gone(*_: object, **__: object) -> object:
        raise WorkersError("the scheduler answers no more; start it")

    monkeypatch.setattr(searches.SearchRun, "_screen", gone)
    monkeypatch.setattr(searches, "reference_of", lambda _: None)
    with pytest.raises(WorkersError):
        invoked(PRESET, *FEW, "--out", tmp_path)
    assert not (tmp_path / "index.html").exists()
    why = "the scheduler answers no more; start it"
    part = made_search(screened=40, solved=4, stopped=True), why
    monkeypatch.setattr(searches, "search_until_stopped", lambda _: part)
    code, shown = invoked(PRESET, *FEW, "--out", tmp_path)
    assert code == 2
    assert f"{why}; the same command goes on" in shown
    assert "was stopped" in (tmp_path / "index.html").read_text(encoding="utf-8")


@pytest.mark.slow
def test_a_search_is_shown_written_kept_and_goes_on(tmp_path: Path) -> None:
    few = ["--screened", "24", "--solved", "1", "--jobs", "1"]
    code, shown = invoked(PRESET, *few, "--out", tmp_path)
    assert code in (0, 1)
    assert f"page: {tmp_path / 'index.html'}" in shown.replace("\n", "")
    again = json.loads(
        CliRunner().invoke(app, ["design", PRESET, *few, "--out", str(tmp_path), "--json"]).stdout
    )
    assert again["answers_computed"] == 0
    assert (code == 0) == bool(again["front"])
    for plate in (again["front"][0], again["front"][-1]) if again["front"] else ():
        display = sf.load_display(tmp_path / "plates" / f"{plate['name']}.toml")
        found = sf.predict(display)
        assert found.relative_friction == pytest.approx(plate["relative_friction"], rel=1e-9)
        assert found.mode.resonance_frequency == pytest.approx(plate["resonance_frequency_Hz"])


@pytest.mark.slow
def test_where_no_plate_is_found_the_exit_code_says_so(
    changed: Callable[[str, str], Path],
) -> None:
    file = changed('most_temperature_rise = "75 K"', 'most_temperature_rise = "0.1 K"')
    code, shown = invoked(file, *FEW)
    assert code == 1
    assert "No plate meets the requirements" in shown
