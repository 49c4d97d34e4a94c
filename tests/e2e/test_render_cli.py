"""`squeezefilm render` as a person uses it: what it writes, what it says, what it refuses."""

import functools
import json
import math
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.e2e.program import run
from tests.pictures import picture_bytes
from tests.unit.core.formats.read_parquet import table_in_parquet
from tests.unit.core.formats.read_sound import read_sound

from squeezefilm.core import presets
from squeezefilm.core.formats.traces import table_from_csv
from squeezefilm.physics.texture_files.hjif import friction_along

STATOR = ("--display", "biet2008-stator")
GRATING = "biet2008-square-4mm"


@functools.cache
def rendered(*arguments: str) -> dict[str, Any]:
    done = run("render", *arguments, "--json")
    assert done.returncode == 0, done.stderr
    return dict(json.loads(done.stdout))


@pytest.mark.slow
def test_everything_is_written_and_belongs_together(tmp_path: Path) -> None:
    out = tmp_path / "out"
    done = run("render", GRATING, *STATOR, "--out", out, "--drive", "--hjif")
    assert done.returncode == 0, done.stderr
    assert "Lag" in done.stdout
    assert "lost" in done.stdout
    assert {path.name for path in out.iterdir()} == {
        "index.html", "trace.csv", "envelope.wav", "drive.wav", "fidelity.json", "texture.hjif",
        "render-friction.png", "render-drive.png", "render-way.png",
    }  # fmt: skip
    numbers = json.loads((out / "fidelity.json").read_text())
    trace = table_from_csv(out / "trace.csv")
    assert trace.metadata["config_sha256"] == numbers["provenance"]["config_sha256"]
    assert {"squeezefilm_version", "seed", "created_utc"} <= set(trace.metadata)
    assert np.max(np.diff(trace.column("time_s"))) == pytest.approx(1 / 19_200)
    error = trace.column("relative_friction_rendered") - trace.column("relative_friction_asked")
    assert numbers["friction_rms_error"] == pytest.approx(math.sqrt(float(np.mean(error**2))))
    envelope = read_sound((out / "envelope.wav").read_bytes())
    assert envelope.samples == pytest.approx(trace.column("amplitude_commanded_m"), abs=1e-12)
    drive = read_sound((out / "drive.wav").read_bytes())
    assert drive.rate == 192_000
    assert drive.note["unit"] == "V"
    assert drive.note["full_scale"] == numbers["voltage_V"] == 140.0
    # The carrier's amplitude is the command's share of the limit, times the voltage.
    share = float(np.max(trace.column("amplitude_commanded_m"))) / numbers["largest_amplitude_m"]
    assert np.max(np.abs(drive.samples)) == pytest.approx(140.0 * share, rel=0.02)
    line = json.loads((out / "texture.hjif").read_text())
    friction = friction_along(line, np.linspace(0.02, 0.03, 1001))
    assert (friction.min(), friction.max()) == pytest.approx((0.7, 1.0))
    page = (out / "index.html").read_text()
    for name in re.findall(r'(?:src|href)="([^"]+)"', page):
        assert (out / name).is_file(), name


@pytest.mark.slow
def test_the_table_says_what_theory_says() -> None:
    result = rendered(GRATING, *STATOR)
    tau = 200 / (math.pi * 40.5e3)
    assert result["envelope_time_constant_s"] == pytest.approx(tau)
    # A square trails by at most τ v; its fundamental keeps 1/√(1 + (2π v τ/p)²), about.
    assert 0 < result["lag_m"] < tau * 0.06
    kept = 1 / math.hypot(1, 2 * math.pi * 0.06 * tau / 4e-3)
    assert result["contrast_kept"][0] == pytest.approx(kept, abs=0.02)
    assert result["unreachable_samples"] == 0
    for key in result:
        assert not key.endswith(("_mm", "_ms", "_um")), key


@pytest.mark.slow
def test_compensation_and_sensor_change_what_they_should() -> None:
    plain = rendered(GRATING, *STATOR)
    inverse = rendered(GRATING, *STATOR, "--compensate", "inverse")
    seen = rendered(GRATING, *STATOR, "--sensor", "touch-panel-60-hz", "--seed", "3")
    assert inverse["friction_rms_error"] < 0.9 * plain["friction_rms_error"]
    assert seen["friction_rms_error"] > 1.2 * plain["friction_rms_error"]
    assert seen["fidelity"]["position_error_m"] > 0
    more = ("--sensor", "touch-panel-60-hz", "--seed", "3", "--json")
    again = run("render", GRATING, *STATOR, *more)
    assert json.loads(again.stdout)["friction_rms_error"] == seen["friction_rms_error"]


@pytest.mark.slow
def test_what_the_display_cannot_reach_is_counted(tmp_path: Path) -> None:
    (tmp_path / "t.toml").write_text(
        '[texture]\ntype = "relative_friction"\nlow = 0.2\nhigh = 1.0\n'
        'pattern = { type = "square_wave", spatial_period = "4 mm" }\n'
    )
    result = rendered(str(tmp_path / "t.toml"), *STATOR)
    assert result["least_relative_friction"] > 0.2
    slippery = result["unreachable"]["slipperier_than_the_display"]
    assert slippery == pytest.approx(0.5 * result["samples"], rel=0.02)
    # Half the time the best there is, 0.31 away from what was asked for; and the resonator.
    least = (result["least_relative_friction"] - 0.2) / math.sqrt(2)
    assert result["friction_rms_error"] > 0.95 * least


@pytest.mark.slow
def test_the_wave_is_felt_and_made_up_for() -> None:
    at = ("island-map", "--display", "winfield2007-tpad")
    done = run("render", *at, "--wave", "felt", "--stroke", "60 mm/s over 2 cm")
    assert done.returncode == 2
    assert "disc" in done.stderr
    stroke = ("--stroke", "60 mm/s over 4 cm", "--force", "0.2 N")
    ignored = rendered("sine-3mm", *STATOR, *stroke)
    felt = rendered("sine-3mm", *STATOR, *stroke, "--wave", "felt")
    mended = rendered("sine-3mm", *STATOR, *stroke, "--wave", "compensated")
    # A contact of 8.6 mm on half a wavelength of 9.35 mm.
    assert felt["wave_greatest_factor"] == pytest.approx(1.0, abs=1e-3)
    assert felt["wave_least_factor"] < 0.95
    assert ignored["wave_least_factor"] == ignored["wave_greatest_factor"] == 1.0
    assert felt["friction_rms_error"] > 1.15 * ignored["friction_rms_error"]
    assert mended["friction_rms_error"] == pytest.approx(ignored["friction_rms_error"], rel=0.02)


def loop_over_the_map(path: Path) -> Path:
    t = np.linspace(0.0, 1.5, 301)
    rows = "\n".join(
        f"{a:.5f},{0.025 + 0.01 * math.cos(4 * a):.6f},{0.015 + 0.01 * math.sin(4 * a):.6f}"
        for a in t
    )
    path.write_text("time_s,x_m,y_m\n" + rows + "\n")
    return path


@pytest.mark.slow
def test_a_map_under_a_free_stroke(tmp_path: Path) -> None:
    stroke = loop_over_the_map(tmp_path / "s.csv")
    done = run(
        "render", "island-map", "--display", "winfield2007-tpad", "--stroke", stroke,
        "--out", tmp_path / "out", "--table", "parquet",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    trace = table_in_parquet((tmp_path / "out" / "trace.parquet").read_bytes())
    x, y = trace.column("position_x_m"), trace.column("position_y_m")
    assert np.hypot(x - 0.025, y - 0.015) == pytest.approx(np.full(x.size, 0.01), rel=2e-3)
    assert np.ptp(trace.column("relative_friction_asked")) > 0.2
    # A plane is nothing for a ring.
    done = run("render", "island-map", *STATOR, "--stroke", stroke)
    assert done.returncode == 2
    assert "circumference" in done.stderr


MAP = """
[texture]
type = "relative_friction"
low = 0.6
high = 1.0
pattern = { type = "image_file", file = "map.png"%s }
"""


@pytest.mark.parametrize(
    ("texture", "more", "says"),
    [
        ("sine-3", (), "neither a file nor a texture. Did you mean 'sine-3mm'"),
        ("bare.toml", (), "has no unit"),
        ("unscaled.toml", (), "'pixel' is missing"),
        ("map.toml", ("--stroke", "60 mm/s over 8 cm"), "the stroke leaves the image: at 0.8"),
        ("map.toml", ("--stroke", "nan.csv"), "nan.csv, line 3: x_m: is no number"),
        ("sine-3mm", ("--stroke", "60 mm/s"), "is no stroke"),
        ("sine-3mm", ("--sensor", "touch-panel"), "the sensor 'touch-panel' is not known"),
        ("sine-3mm", ("--compensate", "previews"), "Did you mean 'preview'"),
        ("sine-3mm", ("--wave", "felts"), "Did you mean 'felt'"),
        ("sine-3mm", ("--voltage", "0 V"), "changes no friction at 0 V"),
        ("sine-3mm", ("--table", "xlsx"), "csv or parquet"),
        ("sine-3mm", ("--display", "winfield2007-tpad"), "covers 40 mm along x"),
    ],
)
def test_mistakes_are_one_message_and_leave_nothing(
    texture: str, more: tuple[str, ...], says: str, tmp_path: Path
) -> None:
    (tmp_path / "map.png").write_bytes(picture_bytes(np.eye(50)))
    (tmp_path / "map.toml").write_text(MAP % ', pixel = "1 mm"')
    (tmp_path / "unscaled.toml").write_text(MAP % "")
    (tmp_path / "bare.toml").write_text(
        '[texture]\ntype = "amplitude"\nlow = 0\nhigh = "1 um"\npattern = { type = "constant" }\n'
    )
    (tmp_path / "nan.csv").write_text("time_s,x_m\n0,0\n0.1,nan\n0.2,0.1\n")
    done = run("render", texture, *STATOR, *more, "--out", "out", cwd=tmp_path)
    assert done.returncode == 2
    assert says in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "out").exists()


def test_files_without_a_folder_to_be_in() -> None:
    done = run("render", "sine-3mm", *STATOR, "--drive")
    assert done.returncode == 2
    assert "--out" in done.stderr


def test_a_folder_that_is_a_file_is_left_as_it_was(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("mine")
    done = run("render", "sine-3mm", *STATOR, "--out", tmp_path / "out")
    assert done.returncode == 2
    assert "not a folder" in done.stderr
    assert (tmp_path / "out").read_text() == "mine"


@pytest.mark.parametrize("name", presets.texture_names())
def test_every_preset_texture_renders(name: str) -> None:
    result = rendered(name, *STATOR)
    assert result["unreachable_samples"] == 0
    assert 0.4 < result["rendered_friction_mean"] < 1.0
    assert result["friction_rms_error"] < result["asked_friction_rms_swing"]


def test_textures_are_listed() -> None:
    done = run("textures", "--json")
    assert done.returncode == 0
    listed = json.loads(done.stdout)
    assert [one["name"] for one in listed] == list(presets.texture_names())
    assert all(one["title"] for one in listed)


def test_gratings_of_the_paper_say_what_their_period_is() -> None:
    for name in presets.texture_names():
        if name.startswith("biet2008-square"):
            text = presets.resolve(name, "texture").read_text(encoding="utf-8")
            period = name.removeprefix("biet2008-square-").removesuffix("mm")
            assert f'spatial_period = "{period} mm"' in text
            assert f"{float(period) / 2:g} mm of each" in text
            assert f"the period is {float(period) * 2:g} mm" in text


def test_a_preset_can_be_copied_and_changed(tmp_path: Path) -> None:
    source = presets.resolve("island-map", "texture")
    for path in (source, source.with_suffix(".png")):
        shutil.copy(path, tmp_path)
    result = rendered(str(tmp_path / "island-map.toml"), *STATOR)
    assert result["friction_rms_error"] == rendered("island-map", *STATOR)["friction_rms_error"]
