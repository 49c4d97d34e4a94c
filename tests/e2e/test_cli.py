"""The command line as a person uses it."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from tests.e2e.program import PROGRAM, run, run_program

from squeezefilm.core import presets


def test_help_names_the_verbs() -> None:
    done = run_program("--help")
    assert done.returncode == 0
    for verb in ("analyze", "reproduce", "presets", "show", "new"):
        assert verb in done.stdout


def test_help_and_package_load_neither_plots_nor_pydantic_nor_numpy() -> None:
    code = (
        "import sys, squeezefilm, squeezefilm.cli as cli\n"
        "try: cli.app(['--help'])\n"
        "except SystemExit: pass\n"
        "heavy = {'matplotlib', 'pydantic', 'numpy', 'scipy', 'numba'} & set(sys.modules)\n"
        "print('loaded:', sorted(heavy), file=sys.stderr)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr.strip() == "loaded: []"


@pytest.mark.slow
def test_analyze_prints_one_object_with_units_in_its_keys() -> None:
    done = run("analyze", "biet2008-stator", "--json", "--samples", "8")
    assert done.returncode == 0
    result = json.loads(done.stdout)
    for key in (
        "resonance_frequency_Hz",
        "half_wavelength_m",
        "vibration_amplitude_m",
        "squeeze_number",
        "relative_friction",
        "friction_reduction",
        "model",
        "quality_factor",
        "envelope_time_constant_s",
        "finest_period_m",
        "warnings",
    ):
        assert key in result
    assert result["squeeze_number"] == pytest.approx(20.418, abs=5e-4)
    assert result["model"] == "levitation"
    low, high = result["relative_friction_interval"]
    assert low < result["relative_friction"] < high
    assert result["friction_reduction"] == pytest.approx(
        result["friction_coefficient"] * (1 - result["relative_friction"])
    )
    rivals = result["relative_friction_of_rival_models"]
    assert rivals["paper2008"] == pytest.approx(0.702, abs=5e-4)


@pytest.mark.slow
def test_the_papers_model_is_there_on_request_and_warns() -> None:
    result = json.loads(
        run("analyze", "biet2008-stator", "--json", "--samples", "0", "--model", "paper2008").stdout
    )
    assert result["relative_friction"] == pytest.approx(0.702, abs=5e-4)
    assert result["model"] == "paper2008"
    assert any("σ → ∞" in warning for warning in result["warnings"])


@pytest.mark.slow
def test_a_friction_has_its_interval_its_shares_and_what_to_measure_next(tmp_path: Path) -> None:
    done = run(
        "friction", "biet2008-stator", "--amplitude", "2 um", "--force", "0.5 N",
        "--samples", "16", "--wanted", "0.6", "--json", "--out", tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    low, high = result["relative_friction_interval"]
    assert low < result["relative_friction"] < high
    shares = result["load_shares"]
    assert shares["film"] + shares["asperities"] == pytest.approx(1, abs=1e-6)
    assert 0 < result["relative_friction"] == shares["asperities"]
    assert result["model"] == "levitation"
    assert f"interval {low:.2f}–{high:.2f}" in result["verdict"][0]["text"]
    assert set(result["uncertainty"]["groups"]) == {"measurable", "unknown"}
    assert result["friction_reduction"] == pytest.approx(
        result["friction_coefficient"] * (1 - result["relative_friction"])
    )
    assert result["wanted"]["relative_friction"] == 0.6
    assert result["wanted"]["voltage_V"] < result["wanted"]["vibration_amplitude_m"] / 1e-8
    ranked = [item["total_order"] for item in result["uncertainty"]["measure_next"]]
    assert ranked == sorted(ranked, reverse=True)
    assert {path.name for path in tmp_path.iterdir()} == {
        "friction.json", "friction-models.png", "friction-map.png", "friction-uncertainty.png",
        "friction-ripple.png",
    }  # fmt: skip
    again = run("friction", "biet2008-stator", "--amplitude", "2 um", "--samples", "16", "--json")
    repeated = json.loads(again.stdout)["relative_friction_interval"]
    # The same draws; a table of films that was asked before may have more nodes.
    assert repeated == pytest.approx(result["relative_friction_interval"], rel=1e-5)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--samples", "10"), "power of two"),
        (("--wanted", "1.5"), "at most 1"),
        (("--wanted", "0.005"), "at the least"),
        (("--ambient-pressure", "0 Pa"), "at least"),
        (("--force", "500 N"), "pressed through"),
    ],
)
def test_frictions_that_cannot_be_are_refused(arguments: tuple[str, str], says: str) -> None:
    done = run("friction", "biet2008-stator", *arguments)
    assert done.returncode == 2
    assert says in " ".join(done.stderr.split())
    assert "Traceback" not in done.stderr


def test_a_film_is_solved_with_its_error() -> None:
    done = run("film", "--squeeze-number", "10", "--excursion", "0.5", "--json")
    result = json.loads(done.stdout)
    assert result["mean_load"] == pytest.approx(1.160251, abs=5e-5)
    assert abs(result["over_pressure"] - 0.160251) < result["over_pressure_error"] + 1e-6
    assert {"stiffness_relative", "damping_relative", "status", "model"} <= set(result)


@pytest.mark.slow
def test_a_plate_is_solved_with_its_error(tmp_path: Path) -> None:
    out, vtu = tmp_path / "out", tmp_path / "own.vtu"
    done = run("plate", "biet2008-plate", "--json", "--out", out, "--vtu", vtu)
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    assert result["mode"] == "(8,0)"
    # The converged reference of the specification, to the 0.1 % it asks for.
    assert result["frequency_Hz"] == pytest.approx(33574, rel=1e-3)
    assert abs(result["frequency_Hz"] - 33574) < result["frequency_error_Hz"]
    assert result["largest_per_volt_m_per_V"] == pytest.approx(162.8e-9, rel=0.01)
    assert result["sound_pressure_level_dB"]["0.5 m"] > 100
    assert result["beam"]["frequency_Hz"] == pytest.approx(result["frequency_Hz"], rel=0.01)
    assert {"(8,0)", "(4,4)"} <= {row["label"] for row in result["modes"]}
    names = {path.name for path in out.iterdir()}
    pictures = {"mode-plan", "line-scan", "frequency-response", "admittance"}
    assert names == {"index.html", "plate.json", "mode.vtu", *(f"{one}.png" for one in pictures)}
    page = (out / "index.html").read_text()
    for name in names - {"index.html"}:
        assert name in page
    assert vtu.read_bytes() == (out / "mode.vtu").read_bytes()


@pytest.mark.slow
def test_a_film_map_is_drawn(tmp_path: Path) -> None:
    done = run("film", "--sweep", "--tolerance", "0.01", "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "film-map.png").read_bytes().startswith(b"\x89PNG")
    numbers = json.loads((tmp_path / "film-map.json").read_text())
    assert len(numbers["over_pressure"]) == len(numbers["squeeze_number"])


@pytest.mark.slow
def test_analyze_writes_a_report_and_a_result(tmp_path: Path) -> None:
    done = run_program("analyze", "biet2008-plate", "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert str(tmp_path / "out" / "report.html") in done.stdout.replace("\n", "")
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    assert result["mode"] == "(8,0)"
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["report.html", "result.json"]


@pytest.mark.slow
def test_working_point_options_change_the_result() -> None:
    half = json.loads(
        run("analyze", "biet2008-plate", "--json", "--samples", "0", "--voltage", "7.5 V").stdout
    )
    full = json.loads(run("analyze", "biet2008-plate", "--json", "--samples", "0").stdout)
    # Linear without the finger, which takes a little more of a small amplitude.
    free = [r["vibration_amplitude_m"] / r["amplitude_kept_under_finger"] for r in (half, full)]
    assert free[0] == pytest.approx(free[1] / 2)
    assert half["vibration_amplitude_m"] < full["vibration_amplitude_m"] / 2
    options = ("--samples", "0", "--surface", "bare", "--amplitude", "2 um", "--model", "paper2008")
    bare = json.loads(run("analyze", "biet2008-stator", "--json", *options).stdout)
    assert bare["relative_friction"] == pytest.approx(0.532, abs=5e-4)
    assert bare["voltage_V"] is None


@pytest.mark.slow
def test_new_show_and_analyze_a_file_of_ones_own(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    assert run("new", file, "--from", "biet2008-plate").returncode == 0
    text = file.read_text()
    assert 'name = "mine"' in text
    assert text.count("#") > 5
    again = run("new", file, "--from", "biet2008-plate")
    assert again.returncode == 2
    assert "exists" in again.stderr
    assert file.read_text() == text
    shown = json.loads(run("show", file, "--json").stdout)
    by_path = {item["path"]: item for item in shown}
    assert by_path["actuator.length"]["text"] == "83 mm"
    assert by_path["actuator.substrate.density"]["evidence"] == "assumed"
    file.write_text(text.replace('"83 mm"', '"166 mm"'))
    assert (
        json.loads(run("analyze", file, "--json", "--samples", "0").stdout)[
            "resonance_frequency_Hz"
        ]
        < 12e3
    )


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full here")
def test_output_that_does_not_fit_is_one_message_and_exit_code_two() -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [*PROGRAM, "presets", "--json"], stdout=full, stderr=subprocess.PIPE, text=True,
            check=False,
        )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr == (
        "error: No space left on device; give another file or folder, or free space\n"
    )


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("analyze", "biet2008-plat"), "Did you mean 'biet2008-plate'"),
        (("analyze", "none.toml"), "does not exist"),
        (("analyze", "."), "is a directory"),
        (("analyze", "biet2008-plate", "--voltage", "15"), "--voltage: '15' has no unit"),
        (("analyze", "biet2008-plate", "--voltage", "15 um"), "wrong dimension"),
        (("analyze", "biet2008-plate", "--force", "nan N"), "finite"),
        (("analyze", "biet2008-plate", "--force", "0 N"), "above 0 N"),
        (("analyze", "biet2008-plate", "--surface", "bar"), "Did you mean 'bare'"),
        (
            ("analyze", "biet2008-plate", "--voltage", "1 V", "--amplitude", "2 um"),
            "give one of them",
        ),
        (("analyze", "biet2008-plate", "--strict"), "contradict"),
        (("analyze", "biet2008-stator", "--strict", "--model", "paper2008"), "σ → ∞"),
        (("analyze", "biet2008-stator", "--model", "paper208"), "Did you mean 'paper2008'"),
        (("film", "--squeeze-number", "10", "--excursion", "1"), "below 1"),
        (("film", "--squeeze-number", "0", "--excursion", "0.5"), "at least 1e-10"),
        (("film", "--squeeze-number", "nan", "--excursion", "0.5"), "nan"),
        (("plate", "biet2008-plate", "--mode", "eight"), "8,0"),
        (("plate", "biet2008-plate", "--band", "5 kHz:4 kHz"), "lower frequency first"),
        pytest.param(
            ("plate", "biet2008-plate", "--band", "33.6 kHz:33.7 kHz"),
            "no mode lies between",
            marks=pytest.mark.slow,
        ),
        (("film", "--squeeze-number", "1", "--excursion", "0.5", "--shape", "disk"), "disc"),
        (("new", "x.toml", "--from", "biet"), "there is no preset 'biet'"),
        (("show", "nothing"), "neither a file nor a preset"),
        (("friction", "biet2008-stator", "--force", "1e99999999999999999999 N"), "too large"),
        (("reproduce", "--out", "a" * 300), "nothing can be written there"),
    ],
)
def test_mistakes_are_one_message_and_exit_code_two(
    arguments: tuple[str, ...], says: str, tmp_path: Path
) -> None:
    done = run(*arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert done.stderr.splitlines()[-1].startswith("error: ")
    assert says in done.stderr
    assert done.stdout == ""
    assert list(tmp_path.iterdir()) == []


TEXT = presets.path("biet2008-plate").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("", "is empty"),
        (TEXT.replace('"83 mm"', "83"), "line 9: actuator.length"),
        (TEXT.replace('"2 mm"', '"-2 mm"'), "at least 10 nm"),
        (TEXT.replace('"2 mm"', '"nan mm"'), "finite"),
        (TEXT.replace('x = "12 mm"', 'x = "5 mm"'), "overlap"),
        (TEXT.replace('x = "72 mm"', 'x = "80 mm"'), "overhangs"),
        (TEXT.replace("viscosity", "viscocity"), "Did you mean 'viscosity'"),
    ],
)
def test_bad_files_leave_no_output(content: str, says: str, tmp_path: Path) -> None:
    file = tmp_path / "bad.toml"
    file.write_text(content, encoding="utf-8")
    done = run("analyze", file, "--samples", "0", "--out", tmp_path / "out")
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert says in done.stderr
    assert "bad.toml" in done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_an_output_folder_that_is_a_file_is_refused_and_kept(tmp_path: Path) -> None:
    taken = tmp_path / "out"
    taken.write_text("mine")
    done = run("analyze", "biet2008-stator", "--samples", "0", "--out", taken)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert taken.read_text() == "mine"


@pytest.mark.slow
def test_reproduce_gives_every_claim_a_verdict() -> None:
    done = run("reproduce", "--json")
    assert done.returncode == 0, done.stderr
    claims = json.loads(done.stdout)["claims"]
    assert len(claims) >= 20
    assert all(claim["verdict"] == claim["verdict_on_record"] for claim in claims)
