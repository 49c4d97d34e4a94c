"""`squeezefilm plate` on glass plates, discs and stators, and what it refuses."""

import functools
import json
from pathlib import Path

import pytest
from tests.e2e.program import run

from squeezefilm.core import presets

SHARED_KEYS = {
    "display", "mode", "frequency_Hz", "frequency_error_Hz", "amplitude_per_volt_m_per_V",
    "largest_per_volt_m_per_V", "alone_per_volt_m_per_V", "half_wavelength_m",
    "quality_factor", "modes",
    "coupling_coefficient", "coupling_coefficient_error", "parallel_resonance_frequency_Hz",
    "parallel_resonance_frequency_error_Hz",
    "voltage_V", "current_A", "apparent_power_VA", "input_power_W", "equivalent_circuit",
    "equivalent_circuit_said",
    "sound_pressure_level_dB", "sound_guidance", "model", "status", "provenance",
}  # fmt: skip


@functools.cache
def solved(name: str, *more: str) -> dict[str, object]:
    done = run("plate", name, "--json", *more)
    assert done.returncode == 0, done.stderr
    return dict(json.loads(done.stdout))


@pytest.mark.nightly
def test_a_stator_is_solved_and_says_what_was_fitted(tmp_path: Path) -> None:
    done = run("plate", "biet2008-stator", "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    text = " ".join(done.stdout.split())
    for said in (
        "B(0,9)", "fitted, not predicted", "validates nothing", "Teeth: an equivalent",
        "Assumed: phosphor bronze", "the value above is measured", "Sound at 0.5 m",
    ):  # fmt: skip
        assert said in text
    assert {path.name for path in tmp_path.iterdir()} == {
        "index.html", "plate.json", "mode-plan.png", "line-scan.png", "frequency-response.png",
    }  # fmt: skip
    result = json.loads((tmp_path / "plate.json").read_text())
    assert set(result) >= SHARED_KEYS
    assert result["mode"] == "B(0,9)"
    assert result["frequency_Hz"] == pytest.approx(40.5e3, rel=1e-6)
    assert result["half_wavelength_m"] == pytest.approx(9.35e-3, rel=1e-3)
    assert result["half_wavelength_along"] == "circumference"
    low, high = result["fit"]["frequency_with_soft_and_stiff_teeth_Hz"]
    assert low == pytest.approx(40.5e3, rel=1e-6)
    assert high > low
    assert result["fit"]["ring_thickness_m"] > 1e-3
    labels = [row["label"] for row in result["modes"]]
    assert "B(0,9)" in labels
    frequencies = [row["frequency_Hz"] for row in result["modes"]]
    assert frequencies == sorted(frequencies)


@pytest.mark.slow
def test_a_disc_is_solved() -> None:
    result = solved("winfield2007-tpad")
    assert set(result) >= SHARED_KEYS
    assert result["mode"] == "B(1,0)"
    assert result["half_wavelength_along"] == "diameter"
    assert result["fit"] is None
    circuit = result["equivalent_circuit"]
    assert isinstance(circuit, dict)
    assert circuit["frequency_Hz"] == pytest.approx(result["frequency_Hz"])


@pytest.mark.nightly
def test_glass_presets_are_whole_displays() -> None:
    for name in ("basdogan2020-glass", "touchpad-glass"):
        done = run("analyze", name, "--json", "--samples", "0", "--amplitude", "1 um")
        assert done.returncode == 0, done.stderr
        assert 0 < json.loads(done.stdout)["relative_friction"] <= 1


GLASS = presets.path("basdogan2020-glass").read_text(encoding="utf-8")
DISC = presets.path("winfield2007-tpad").read_text(encoding="utf-8")
STATOR = presets.path("biet2008-stator").read_text(encoding="utf-8")


def with_constant(line: str) -> str:
    """The glass display with one constant of its ceramic in place of the library's."""
    table = f"[actuator.ceramic.constants]\n{line}\n\n[actuator.glue]"
    return GLASS.replace("[actuator.glue]", table)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (GLASS.replace('x = "87 mm"', 'x = "88 mm"'), "overhangs the plate"),
        (GLASS.replace('x = "87 mm"', 'x = "5 mm"'), "overlap by 1 mm"),
        (GLASS.replace('x = "6 mm"', 'x = "5 mm"'), "foam under a ceramic"),
        (GLASS.replace("[[actuator.patches]]", "[[actuator.patch]]"), "unknown key 'patch'"),
        (GLASS.replace("polarity = 1", 'polarity = 1\nelectrode = "shunted"'), "shunt_resistance"),
        (GLASS.replace('thickness = "0.5 mm"', 'thickness = "0.5 um"'), "actuator.glue.thickness"),
        (with_constant("free_permittivity_33 = 3000"), "which give 1703"),
        (with_constant('compliance_66 = "54.3e-12 m2/N"'), "2 (s11 - s12)"),
        (with_constant('charge_coefficient_31 = "-271 pm/V"'), "of one ceramic"),
        (GLASS.replace('{ value = "20 um"', '{ value = "-20 um"'), "actuator.glue.thickness"),
        (GLASS.replace("[actuator.glue]", '[actuator.glue]\nthikness = "1 um"'), "'thickness'"),
        (DISC.replace('diameter = { value = "25 mm"', 'diameter = { value = "9 mm"', 1),
         "overhangs the disc"),
        (DISC.replace('type = "disc"', 'type = "disk"'), "Did you mean 'disc'"),
        (DISC.replace('type = "disc"', 'type = "disc"\nsectors = 2'), "without nodal diameters"),
        (DISC.replace('"1.6 mm"', '"1.6 nm"'), "at least 10 nm"),
        (STATOR.replace("40.5 kHz", "400 kHz"), "no ring thickness"),
    ],
)  # fmt: skip
def test_bad_descriptions_are_one_message_and_exit_code_two(
    content: str, says: str, tmp_path: Path
) -> None:
    file = tmp_path / "bad.toml"
    file.write_text(content, encoding="utf-8")
    done = run("plate", file, "--out", tmp_path / "out")
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert says in done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("winfield2007-tpad", "--band", "27 kHz:28 kHz"), "no mode lies between"),
        (("winfield2007-tpad", "--mode", "9,0"), "no mode B(9,0)"),
        (("winfield2007-tpad", "--mode", "umbrella"), "8,0"),
        (("winfield2007-tpad", "--band", "5 kHz:4 kHz"), "lower frequency first"),
    ],
)
def test_modes_that_are_not_there(arguments: tuple[str, ...], says: str) -> None:
    done = run("plate", *arguments)
    assert done.returncode == 2
    assert says in done.stderr
    assert done.stdout == ""


def test_a_plate_that_nothing_drives_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "quiet.toml"
    file.write_text(GLASS.replace("polarity = 1", 'polarity = 1\nelectrode = "shorted"'))
    done = run("plate", file)
    assert done.returncode == 2
    assert "no electrode is driven" in done.stderr
