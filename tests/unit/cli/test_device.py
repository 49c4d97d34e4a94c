"""The verbs about a device: defaults, units, and exit code 1 where something failed."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.e2e.program import run

from squeezefilm.cli.textures import device_app
from squeezefilm.instruments.bench.timing_checks import CheckResult, DeviceCheck
from squeezefilm.instruments.session.record.trace import TraceExport
from squeezefilm.physics.display import load_display
from squeezefilm.physics.texture_files.texture_file import load_texture

DISPLAY, TEXTURE = "biet2008-plate", "sine-3mm"
StandsIn = Callable[..., Any]
PASSED = CheckResult("link", True, "0 lost", "0")
FAILED = CheckResult("watchdog", False, "never", "60 ms", "do not play on this device")


def played(failed: bool) -> SimpleNamespace:
    """What a session leaves, as far as the verb looks at it."""
    ending = SimpleNamespace(value="faulted")
    return SimpleNamespace(
        outcome=SimpleNamespace(usable=not failed, ending=ending, said="the finger left"),
        summary=lambda: {"ending": "faulted"},
    )


@pytest.fixture
def play(stands_in: StandsIn, tmp_path: Path) -> SimpleNamespace:
    """What `play` calls."""
    return SimpleNamespace(
        asked=stands_in("instruments.bench.play:play_texture", played(failed=False)),
        shown=stands_in("instruments.report.terminal:show_play"),
        page=stands_in("instruments.report.page:write_play", tmp_path / "index.html"),
    )


def test_a_texture_is_played_on_the_twin_for_four_seconds(play: SimpleNamespace) -> None:
    done = run("play", TEXTURE, "--display", DISPLAY)
    assert done.returncode == 0, done.stderr
    display, texture = play.asked.given
    assert (display, texture.title) == (load_display(DISPLAY), load_texture(TEXTURE).title)
    named = dict(play.asked.named)
    assert callable(named.pop("show"))
    assert named == {
        "drive": "twin", "sensor": "device", "mode": "stream", "stroke": "60 mm/s over 4 cm",
        "duration": 4.0, "rate": 5000.0, "voltage": None, "surface": None,
        "compensation": "none", "amplitude_per_pickup": None, "bench_only": False, "hold": False,
        "sweep": None,
        "out": None,
        "seed": 0,
    }  # fmt: skip
    assert play.shown.given == (play.asked.answer,)
    assert done.stdout == "add --out DIR to keep the record\n"
    assert done.stderr == "  a step …\n"
    assert play.page.calls == []


def test_every_option_of_a_session_arrives(play: SimpleNamespace, tmp_path: Path) -> None:
    done = run(
        "play", TEXTURE, "--display", DISPLAY, "--drive", "serial:/dev/null", "--sensor", "x",
        "--finger", "mean",
        "--mode", "tile", "--stroke", "50 mm/s over 2 cm", "--duration", "10 s", "--rate", "2 kHz",
        "--voltage", "15 V", "--surface", "copper", "--compensate", "inverse", "--pickup",
        "2 um/V", "--bench-only", "--hold", "--sweep", "sweep.csv", "--out", tmp_path,
        "--seed", "3", "--json",
    )  # fmt: skip
    named = dict(play.asked.named)
    assert named.pop("show") is None
    assert named == {
        "drive": "serial:/dev/null", "sensor": "x", "mode": "tile", "stroke": "50 mm/s over 2 cm",
        "duration": 10.0, "rate": 2000.0, "voltage": 15.0, "surface": "copper",
        "compensation": "inverse", "amplitude_per_pickup": pytest.approx(2e-6),
        "bench_only": True, "hold": True, "sweep": Path("sweep.csv"), "out": tmp_path,
        "seed": 3,
    }  # fmt: skip
    assert "mean of people" in play.asked.given[0].whose_finger
    assert play.page.given == (play.asked.answer, tmp_path)
    assert json.loads(done.stdout) == {"ending": "faulted"}
    assert (done.returncode, done.stderr) == (0, "")
    assert play.shown.calls == []
    done = run("play", TEXTURE, "--display", DISPLAY, "--out", tmp_path)
    assert done.stdout == f"page: {tmp_path / 'index.html'}\n"


@pytest.mark.parametrize("option", ["duration", "rate", "voltage", "pickup"])
def test_a_wrong_unit_is_refused_before_anything_plays(option: str, play: SimpleNamespace) -> None:
    done = run("play", TEXTURE, "--display", DISPLAY, f"--{option}", "3 kg")
    assert done.returncode == 2
    assert f"error: --{option}: " in done.stderr
    assert play.asked.calls == []


def test_no_time_at_all_is_no_time_and_not_a_second(play: SimpleNamespace) -> None:
    run("play", TEXTURE, "--display", DISPLAY, "--duration", "0 s", "--rate", "0 Hz")
    assert (play.asked.named["duration"], play.asked.named["rate"]) == (0.0, 0.0)


def test_a_session_that_failed_ends_with_1(play: SimpleNamespace) -> None:
    play.asked.answer = played(failed=True)
    done = run("play", TEXTURE, "--display", DISPLAY)
    assert done.returncode == 1
    # The table on the terminal says what happened; beside JSON a line on stderr has to.
    assert "the finger left" not in done.stderr
    done = run("play", TEXTURE, "--display", DISPLAY, "--json")
    assert done.returncode == 1
    assert done.stderr == "faulted: the finger left\n"
    assert json.loads(done.stdout) == {"ending": "faulted"}


def test_an_export_says_what_was_written(stands_in: StandsIn, tmp_path: Path) -> None:
    exported = TraceExport("a.sqft", "a.csv", "csv", 7, ("time_s", "x_m"), 2, 0, True, ("cut",))
    asked = stands_in("instruments.session.record.trace:export_trace", exported)
    done = run("export", "a.sqft", "--to", "a.csv")
    assert asked.given[:2] == (Path("a.sqft"), Path("a.csv"))
    assert done.stdout == "a.csv: 7 rows of 2 columns, 2 events\n! cut\n"
    done = run("export", "a.sqft", "--to", "a.csv", "--json")
    assert json.loads(done.stdout)["damage"] == ["cut"]


def test_what_cannot_be_exported_is_refused(tmp_path: Path) -> None:
    done = run("export", tmp_path / "none.sqft", "--to", tmp_path / "a.csv")
    assert done.returncode == 2
    assert "none.sqft" in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_check_is_of_the_twin_and_fails_with_1(stands_in: StandsIn) -> None:
    asked = stands_in("instruments.bench.play:check_drive", DeviceCheck("twin", (PASSED,)))
    done = run("device", "check")
    assert asked.given == ("twin", DISPLAY)
    assert asked.named == {"rate": 5000.0, "sensor": "device"}
    assert done.returncode == 0
    assert "1 of 1 checks passed" in done.stdout
    assert done.stderr == "  a step …\n"

    asked.answer = DeviceCheck("serial:x", (PASSED, FAILED))
    done = run(
        "device", "check", "--drive", "serial:x", "--display", "d.toml", "--rate", "0 Hz", "--json",
        "--sensor", "touch-panel-240-hz",
    )  # fmt: skip
    named = {"rate": 0.0, "sensor": "touch-panel-240-hz"}
    assert asked.calls[-1] == (("serial:x", "d.toml"), named)
    found = json.loads(done.stdout)
    assert found["passed"] is False
    assert [one["name"] for one in found["results"]] == ["link", "watchdog"]
    assert (done.returncode, done.stderr) == (1, "")
    assert run("device", "check").returncode == 1


def test_the_group_alone_lists_its_verbs() -> None:
    (command,) = device_app.registered_commands
    done = run("device")
    said = done.stdout + done.stderr
    assert "Missing command" not in said
    assert command.callback is not None
    assert command.callback.__name__ in said
    assert "--install-completion" not in run("device", "--help").stdout
