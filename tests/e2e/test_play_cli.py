"""The bench from one command, through a real port: play, the record, its export, device check."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from tests.e2e.program import PROGRAM

from squeezefilm.core.formats.traces import table_from_csv
from squeezefilm.instruments.session.record.trace import read_trace

pytestmark = pytest.mark.skipif(
    sys.platform == "win32", reason="a twin's port is a pseudo-terminal, which needs POSIX"
)


def run(*words: str, code: int = 0) -> subprocess.CompletedProcess[str]:
    done = subprocess.run([*PROGRAM, *words], capture_output=True, text=True, timeout=300)
    assert done.returncode == code, done.stdout + done.stderr
    return done


@pytest.mark.slow
@pytest.mark.realtime
def test_a_texture_is_played_on_a_twin_and_judged(tmp_path: Path) -> None:
    for attempt in range(3):
        out = tmp_path / f"session-{attempt}"
        words = [
            "play", "biet2008-square-4mm", "--display", "biet2008-plate", "--drive", "twin",
            "--duration", "2 s", "--rate", "2 kHz", "--out", str(out), "--json",
        ]  # fmt: skip
        done = subprocess.run([*PROGRAM, *words], capture_output=True, text=True, timeout=300)
        summary = json.loads(done.stdout)
        # A machine that holds a process up for 50 ms is stopped by the device, as it must be.
        if "watchdog" not in summary["message"]:
            break
    # How well it was played depends on what else this machine does; that it is told, does not.
    assert done.returncode == (0 if summary["usable"] else 1), done.stderr
    assert summary["usability"]["usable"] is summary["usable"]
    assert summary["ended_because"] == "the time was over", summary["message"]
    assert summary["end"]["device_at_zero"]
    assert summary["loop"]["lateness"]["made"] > 1000
    assert summary["link"]["answered"] > 100
    assert summary["by_truth"]["fidelity"] is not None
    kept = summary["by_truth"]["fidelity"]["contrast_kept"][0]
    lag = summary["by_truth"]["fidelity"]["lag_m"]
    print(f"contrast kept {kept:.3f}, lag {1e3 * lag:.3f} mm")
    names = {one.name for one in out.iterdir()}
    assert {"trace.sqft", "truth.csv", "summary.json", "play.html", "play-friction.png"} <= names
    trace = read_trace(out / "trace.sqft")
    assert trace.damage.whole
    assert trace.metadata["seed"] == 0
    assert len(trace.metadata["config_sha256"]) == 64
    page = (out / "play.html").read_text()
    assert "Truth: contrast at 4\u00a0mm" in page  # a number and its unit stay on one line
    run("export", str(out / "trace.sqft"), "--to", str(tmp_path / "rows.csv"))
    table = table_from_csv(tmp_path / "rows.csv")
    assert table.column("x_m").size == len(trace.rows)
    again = run(
        "play", "biet2008-square-4mm", "--display", "biet2008-plate", "--out", str(out), code=2
    )
    assert "never written over" in again.stderr


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--drive", "usb"), "write twin, or serial:PORT"),
        (("--drive", "serial:/dev/no-such-port"), "cannot be opened"),
        (("--compensate", "preview"), "compensation"),
        (("--voltage", "100 V"), "voltage"),
        (("--sensor", "eye"), "sensor"),
        (("--mode", "tiles"), "mode"),
        (("--duration", "0 s"), "duration"),
    ],
)
def test_what_cannot_be_played_is_said(
    words: tuple[str, ...], said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    from squeezefilm.core.errors import SqueezefilmError
    from squeezefilm.instruments.bench import play as play_command
    from squeezefilm.physics.texture_files.texture_file import load_texture

    names = {"--drive": "drive", "--compensate": "compensation", "--sensor": "sensor",
             "--mode": "mode"}  # fmt: skip
    how: dict[str, object] = {"drive": "twin"}
    option, value = words
    if option == "--voltage":
        how["voltage"] = 100.0
    elif option == "--duration":
        how["duration"] = 0.0
    else:
        how[names[option]] = value
    with pytest.raises(SqueezefilmError, match=said):
        play_command.play_texture(
            "biet2008-plate",
            load_texture("biet2008-square-4mm"),
            **how,  # type: ignore[arg-type]
        )


@pytest.mark.nightly
@pytest.mark.realtime
def test_a_twin_is_checked_through_its_port() -> None:
    words = ["device", "check", "--drive", "twin", "--rate", "1 kHz", "--json"]
    for _ in range(5):
        done = subprocess.run([*PROGRAM, *words], capture_output=True, text=True, timeout=300)
        check = json.loads(done.stdout)
        # Timing that the computer's host disturbed says nothing of the twin's.
        if not any("the host of this virtual" in one["advice"] for one in check["results"]):
            break
    assert done.returncode == 0, done.stdout + done.stderr
    assert check["passed"]
    assert len(check["results"]) >= 17
