"""What the Feel area gets of a texture on a display: physics, shape of the wave, and samples."""

from __future__ import annotations

import functools
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError
from tests.pictures import coloured_bytes, picture_bytes

from squeezefilm import load_display
from squeezefilm.core.errors import InputError, SqueezefilmError
from squeezefilm.core.results import config_hash
from squeezefilm.lab.designing import program
from squeezefilm.lab.designing.form import edited, preset_text
from squeezefilm.lab.designing.program import TextureOnDisplay, feel, parity, pixels_of, title_of
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.render.program.inverse import LOWEST_SPEED
from squeezefilm.physics.texture_files.texture_file import load_texture

STATOR, PLATE = preset_text("biet2008-stator"), preset_text("biet2008-plate")
NOWHERE = Path("/nowhere")
PICTURE = """
[texture]
type = "relative_friction"
low = 0.6
high = 1.0
pattern = { type = "image_file", file = "islands.png", pixel = "1 mm", outside = "zero" }
"""


@functools.cache
def felt(text: str = STATOR, preset: str = "sine-3mm") -> dict[str, Any]:
    return feel(TextureOnDisplay(display=text, preset=preset), NOWHERE)


def test_a_stator_is_what_its_file_says() -> None:
    found = felt()
    assert found["title"] == "Sine grating, 3 mm"
    assert (found["quantity"], found["display"]) == ("relative_friction", "biet2008-stator")
    assert (found["voltage_V"], found["normal_force_N"]) == (140.0, 0.5)
    assert (found["friction_coefficient"], found["contact_length_m"]) == (0.9, 0.01)
    assert found["half_wavelength_m"] == pytest.approx(18.7e-3 / 2)
    assert found["largest_amplitude_m"] == pytest.approx(2e-6)
    # The whole circumference is there to touch.
    assert found["width_m"] == pytest.approx(math.pi * 53.57e-3)
    assert found["height_m"] == 0.01
    # Q/(πf): nothing is known of what the finger takes.
    assert found["resonance_frequency_Hz"] == 40.5e3
    assert found["envelope_time_constant_s"] == pytest.approx(200 / (math.pi * 40.5e3))
    assert set(found["skin"]) == {"mass", "stiffness", "damping"}
    pad = load_display("biet2008-stator").finger.fingerpad
    assert list(found["skin"].values()) == [pad.mass, pad.stiffness, pad.damping]
    assert found["vibration_model"] == "measured_stator"
    assert found["friction_model"] == "levitation"


def test_friction_falls_from_one_at_rest_to_what_the_display_makes() -> None:
    found = felt()
    amplitude, speed = np.array(found["amplitude_m"]), np.array(found["finger_speed_m_per_s"])
    rows = np.array(found["relative_friction"])
    assert amplitude.size == 257
    assert rows.shape == (speed.size, 257)
    # The faster the finger, the more of the friction at rest is left.
    assert speed[0] == 0
    assert np.all(np.diff(speed) > 0)
    assert np.all(np.diff(rows, axis=0) >= -1e-9)
    friction = rows[np.flatnonzero(speed == found["nominal_finger_speed_m_per_s"])[0]]
    assert found["lowest_finger_speed_m_per_s"] == LOWEST_SPEED
    assert amplitude[0] == 0.0
    assert amplitude[-1] == found["largest_amplitude_m"]
    np.testing.assert_allclose(np.diff(amplitude), amplitude[-1] / 256)
    assert friction[0] == pytest.approx(1.0, abs=1e-12)
    assert np.all(np.diff(friction) <= 0.0)
    alone = predict(load_display("biet2008-stator"))
    assert friction[-1] == pytest.approx(alone.relative_friction, abs=1e-4)


def test_the_wave_is_even_and_of_the_antinodes_period() -> None:
    across = edited(PLATE, "actuator.lines_across", "width")
    for text, axis in ((STATOR, "x"), (PLATE, "x"), (across, "y")):
        found = felt(text)
        wave = found["wave"]
        assert wave["along"] == axis
        assert wave["period_m"] == pytest.approx(2 * found["half_wavelength_m"])
        factor = np.array(wave["factor"])
        assert factor.size == 129
        # One at the display's best place, over an antinode of the plate and between the stator's.
        assert factor[32 if text == STATOR else 0] == pytest.approx(1.0, abs=2e-3)
        np.testing.assert_allclose(factor[:65], factor[64:], rtol=1e-6)
        np.testing.assert_allclose(factor, factor[::-1], rtol=1e-6)
        assert abs(factor[32] - factor[0]) == pytest.approx(np.ptp(factor), rel=2e-2)
        assert np.ptp(factor) > 0.1


def test_a_plate_is_as_long_and_wide_as_its_file_says_and_the_finger_damps_it() -> None:
    found = felt(PLATE)
    assert (found["width_m"], found["height_m"]) == (83e-3, 49e-3)
    assert found["vibration_model"].startswith("timoshenko")
    mode = predict(load_display("biet2008-plate"), theory="timoshenko").touch.mode
    assert mode is not None
    assert found["resonance_frequency_Hz"] == pytest.approx(mode.resonance_frequency)
    tau = mode.quality_factor / (math.pi * mode.resonance_frequency)
    assert found["envelope_time_constant_s"] == pytest.approx(tau)


def test_a_disc_has_no_wave_along_a_line(monkeypatch: pytest.MonkeyPatch) -> None:
    # A solved disc takes seconds; its size and its wave do not come from what is predicted.
    stator = predict(load_display("biet2008-stator"))
    monkeypatch.setattr(program, "predicted", lambda *_: stator)
    disc = preset_text("winfield2007-tpad")
    found = feel(TextureOnDisplay(display=disc, preset="sine-3mm"), NOWHERE)
    assert found["wave"] is None
    assert (found["width_m"], found["height_m"]) == (25e-3, 25e-3)


def test_a_texture_comes_from_a_preset_or_from_a_text_with_pictures_beside_it(
    tmp_path: Path,
) -> None:
    (tmp_path / "islands.png").write_bytes(picture_bytes(np.array([[0.0, 1.0, 0.0]])))
    found = feel(TextureOnDisplay(display=STATOR, texture=PICTURE), tmp_path)
    assert found["title"] == "a texture of relative_friction"
    assert title_of('title = "Islands"\n' + PICTURE, tmp_path) == "Islands"
    assert title_of(PICTURE, tmp_path) == ""
    for elsewhere in (NOWHERE, tmp_path / "islands.png"):
        with pytest.raises(SqueezefilmError, match=r"islands\.png"):
            feel(TextureOnDisplay(display=STATOR, texture=PICTURE), elsewhere)
    for text, preset in ((None, None), (PICTURE, "sine-3mm")):
        with pytest.raises(InputError, match="say which texture: a preset or a text"):
            feel(TextureOnDisplay(display=STATOR, texture=text, preset=preset), tmp_path)
    with pytest.raises(ValidationError, match="quality"):
        TextureOnDisplay(display=STATOR, preset="bump", quality="rough")  # type: ignore[arg-type]


def test_the_same_display_and_texture_have_one_hash() -> None:
    stamped = felt()["provenance"]["config_sha256"]
    assert stamped == config_hash((load_display("biet2008-stator"), load_texture("sine-3mm")))
    assert stamped != felt(PLATE)["provenance"]["config_sha256"]


@pytest.mark.parametrize(("voltage", "said"), [("0 V", "0"), ("1 nV", "1e-09")])
def test_a_display_that_changes_no_friction_renders_nothing(voltage: str, said: str) -> None:
    still = edited(STATOR, "drive.voltage", voltage)
    with pytest.raises(InputError) as refused:
        felt(still)
    assert str(refused.value) == (
        f"display 'biet2008-stator, edited' changes no friction at {said} V, so it renders no "
        "texture; give it a voltage in the Design area"
    )


@pytest.mark.parametrize("preset", ["sine-3mm", "speed-stretched"])
def test_samples_are_given_the_friction_that_the_texture_asks_for(preset: str) -> None:
    given = parity(TextureOnDisplay(display=STATOR, preset=preset), NOWHERE, ticks=400)
    curve = felt(STATOR, preset)
    x = np.array(given["x_m"], dtype=float)
    y, v, t = (np.array(given[name]) for name in ("y_m", "v_m_per_s", "t_s"))
    amplitude = np.array(given["amplitude_m"])
    assert x.size == y.size == v.size == t.size == amplitude.size == 400
    assert np.all((amplitude >= 0.0) & (amplitude <= curve["largest_amplitude_m"]))
    # What hardly moves is given the amplitude for 5 mm/s.
    good = np.isfinite(x) & (np.abs(v) > 5e-3)
    asked = load_texture(preset).texture(x[good], y[good], v[good], t[good])
    made = predict(load_display("biet2008-stator")).friction(amplitude[good], v[good])
    assert np.ptp(asked) > 0.3
    np.testing.assert_allclose(made, asked, atol=2e-3)


def test_samples_lie_all_over_the_display_and_some_are_broken() -> None:
    given = parity(TextureOnDisplay(display=PLATE, preset="sine-3mm"), NOWHERE)
    assert given["display"] == "biet2008-plate"
    x, y, v, t = (given[name] for name in ("x_m", "y_m", "v_m_per_s", "t_s"))
    assert len(x) == 2000
    assert 1 <= x.count(None) <= 5
    places = [one for one in x if one is not None]
    assert 0.0 <= min(places) < 1e-3
    assert 82e-3 < max(places) <= 83e-3
    assert 0.0 <= min(y) < 1e-3
    assert 48e-3 < max(y) <= 49e-3
    # Both ways, as fast as fingers are; at intervals of 0.1 to 4 ms.
    assert abs(np.mean(v)) < 0.03
    assert np.std(v) == pytest.approx(0.3, rel=0.05)
    steps = np.diff(t)
    assert 1e-4 <= steps.min() < 1.2e-4
    assert 3.9e-3 < steps.max() <= 4e-3
    # The page may ask again.
    assert parity(TextureOnDisplay(display=PLATE, preset="sine-3mm"), NOWHERE)["x_m"] == x


def test_a_picture_has_rows_and_columns() -> None:
    assert pixels_of(picture_bytes(np.zeros((3, 5))), "flat.png") == (3, 5, "")
    rows, columns, said = pixels_of(coloured_bytes(np.zeros((3, 5, 3))), "red.png")
    assert (rows, columns) == (3, 5)
    assert said.startswith("red.png is in colour: of each pixel the brightness is used")
    with pytest.raises(InputError, match=r"flat\.png is no PNG"):
        pixels_of(b"GIF89a", "flat.png")
