"""Every example runs, is at most 60 lines, draws, and gives the number it is there to show."""

import importlib.util
import math
import re
import shutil
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import squeezefilm as sf

EXAMPLES = Path(__file__).parents[2] / "examples"


def _load(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _friction_of_the_stator(result: Any) -> None:
    assert result["relative_friction"] == pytest.approx(0.702, abs=5e-4)
    assert result["zero_friction_amplitude"] == pytest.approx(7.63e-6, abs=5e-9)


def _thinner_plate(result: Any) -> None:
    frequencies = [frequency for _, frequency, _ in result]
    assert frequencies[0] == pytest.approx(33.58e3, rel=1e-3)
    assert frequencies == sorted(frequencies, reverse=True)


def _grating_under_a_finger(result: Any) -> None:
    # tanh(period / 4 v τ) with τ = Q/(π f), the finger on the mode
    loaded = sf.predict("biet2008-plate").touch.mode
    assert loaded is not None
    tau = loaded.quality_factor / (math.pi * loaded.resonance_frequency)
    assert result[0.1] == pytest.approx(math.tanh(0.4e-3 / (4 * 0.1 * tau)), abs=2e-3)
    assert result[0.2] == pytest.approx(math.tanh(0.4e-3 / (4 * 0.2 * tau)), abs=2e-3)


def _finger_drags_its_skin(result: Any) -> None:
    # µ N = 0.9 · 0.5 N is the most that friction can do; a grating of 1 mm at 80 mm/s is 80 Hz.
    assert result["greatest_force_N"] == pytest.approx(0.45, rel=0.02)
    assert 0 < result["least_force_N"] < 0.9 * result["greatest_force_N"]
    assert result["swings_Hz"] == pytest.approx(80.0, rel=1e-3)
    # A pad of 1 N/mm that sticks is stretched to 0.45 N within 5.6 ms, and not before 2.
    assert 2e-3 < result["sticks_until_s"] < 5.7e-3
    assert result["energy_residual_J"] < 1e-12


def _texture_on_a_display(result: Any) -> None:
    assert 0.2 < result["least_friction"] < 0.8
    # The masks ask for no more than there is, and the lowest friction for all there is.
    assert result["largest_amplitude_m"] == pytest.approx(result["available_amplitude_m"])
    assert result["unreachable"] == 0
    # Between the speeds of the table, on the law itself.
    assert result["inverse_error"] < 1e-2
    # Grooves ask for all the amplitude there is, and off the antinodes for more.
    assert 0 < result["saturated"] < 0.8 * result["ticks"]


def _twice_the_finger_speed(result: Any) -> None:
    errors = [result[name].rms_error for name in ("none", "inverse", "preview")]
    assert errors == sorted(errors, reverse=True)
    lags = [result[name].lag for name in ("none", "inverse", "preview")]
    # A square trails by τ v at most; half a period, 200 µm, would be the wrong way round.
    assert 0.57e-3 * 0.239 > lags[0] > lags[1] > 10 * abs(lags[2])
    contrasts = [float(one.contrast_kept[0]) for one in result.values()]
    assert contrasts[1] > 1.5 * contrasts[0]


def _map_under_a_finger(result: Any) -> None:
    assert 0 < result["inverse"] < 0.7 * result["none"] < 0.1
    assert result["mpeg_haptics_bytes"] > 1000


def _friction_threshold(result: Any) -> None:
    # The person's own threshold is 0.11; its answers are seeded.
    assert result["low"] < 0.11 < result["high"] < 2 * result["low"]
    assert result["low"] < result["threshold"] < result["high"]
    # Half way from chance to the best is a little below 75 % where there are lapses.
    assert result["d_prime"] == pytest.approx(math.sqrt(2) * 0.6745, abs=0.1)


def _film_under_a_wave(result: Any) -> None:
    # What leaks at the edges carries less than what cannot; a wave moves less of the film.
    assert 0 < result["bent"] < result["flat"] < result["limit"]
    assert result["flat"] > result["limit"] / 2


def _how_sure_is_the_friction(result: Any) -> None:
    low, high = result["interval"]
    assert 0 <= low < result["median"] < high <= 1
    assert low < result["nominal"] < high


def _glass_and_metal(result: Any) -> None:
    assert result["biet2008-plate"] == pytest.approx(33.574e3, rel=1e-3)
    assert 20e3 < result["winfield2007-tpad"] < 30e3


def _simulated_study(result: Any) -> None:
    assert result["chance"] < result["correct"] < 1


def _modes_of_an_own_plate(result: Any) -> None:
    assert 38e3 < result["(8,0)"] < 42e3


def _sweep_over_thickness(result: Any) -> None:
    frequencies = result["resonance_frequency"]
    assert frequencies == sorted(frequencies)
    # 40 kHz lies inside of what was swept, as the pages say.
    assert frequencies[0] < 40e3 < frequencies[-1]


def _friction_over_the_plate(result: Any) -> None:
    assert 0 < result["best"] < result["median"] < result["worst"] <= 1
    assert 0 < result["share"] <= 1


def _texture_on_an_own_plate(result: Any) -> None:
    # A slow sine of 20 Hz passes a resonator of some 200 Hz; it trails by τ v.
    assert result["contrast_kept"] == pytest.approx(1, abs=0.02)
    assert 0 < result["lag"] < 60e-3 * 1e-3


CHECKS = {
    "modes_of_an_own_plate": _modes_of_an_own_plate,
    "sweep_over_thickness": _sweep_over_thickness,
    "friction_over_the_plate": _friction_over_the_plate,
    "texture_on_an_own_plate": _texture_on_an_own_plate,
    "film_under_a_wave": _film_under_a_wave,
    "how_sure_is_the_friction": _how_sure_is_the_friction,
    "glass_and_metal": _glass_and_metal,
    "simulated_study": _simulated_study,
    "friction_threshold": _friction_threshold,
    "map_under_a_finger": _map_under_a_finger,
    "friction_of_the_stator": _friction_of_the_stator,
    "thinner_plate": _thinner_plate,
    "finger_drags_its_skin": _finger_drags_its_skin,
    "grating_under_a_finger": _grating_under_a_finger,
    "texture_on_a_display": _texture_on_a_display,
    "twice_the_finger_speed": _twice_the_finger_speed,
}


def test_every_example_is_checked() -> None:
    assert {path.stem for path in EXAMPLES.glob("*.py")} == set(CHECKS)


@pytest.mark.parametrize("name", sorted(CHECKS))
def test_an_example_has_one_import_of_ours(name: str) -> None:
    text = (EXAMPLES / f"{name}.py").read_text(encoding="utf-8")
    ours = [line for line in text.splitlines() if re.match(r"\s*(import|from) squeezefilm", line)]
    assert ours == ["import squeezefilm as sf"]


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(CHECKS))
def test_example(
    name: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    # Programs find the display of the tutorial beside themselves.
    shutil.copy(EXAMPLES / "own_plate.toml", tmp_path)
    assert len((EXAMPLES / f"{name}.py").read_text().splitlines()) <= 60
    CHECKS[name](_load(name).main())
    assert capsys.readouterr().out
    assert list(tmp_path.glob("*.png"))
