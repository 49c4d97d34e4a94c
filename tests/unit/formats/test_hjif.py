"""MPEG haptics: what is written is what the reference software loads, and comes back as it was."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from squeezefilm.errors import InputError
from squeezefilm.formats.hjif import HjifExport, ReferenceDevice, hjif_of
from squeezefilm.formats.hjif_read import friction_along, read_hjif, require_hjif, texture_of_hjif
from squeezefilm.render.program.made_for import MadeForSpeed
from squeezefilm.render.texture.composition import Composable
from squeezefilm.render.texture.coordinate import AlongY
from squeezefilm.render.texture.levels import Amplitude, RelativeFriction
from squeezefilm.render.texture.noise import Noise
from squeezefilm.render.texture.pattern import Pattern
from squeezefilm.render.texture.shapes import Band, Bump, Pulse, Ramp, SineWave, SquareWave

DEVICE = ReferenceDevice("biet2008-plate", 33.6e3, 15.0, 1.7e-6)
X = np.linspace(3e-3, 37e-3, 9973)


def through_a_file(export: HjifExport, folder: Path) -> Path:
    path = folder / "t.hjif"
    path.write_text(json.dumps(export.document))
    return path


def test_what_it_was_made_for_is_said_in_the_file_and_among_what_is_lost() -> None:
    made = MadeForSpeed(0.06, -0.123, 0.045)
    export = hjif_of(
        friction(SineWave(2e-3)), 0.0, 0.02, device=DEVICE, title="waves", made_for=made
    )
    assert export.made_for is made
    assert export.document["description"] == (
        "waves; made for a finger at 60 mm/s; at half that speed relative friction is off by up to "
        "-0.12, at double by up to +0.045; relative friction along x, by squeezefilm"
    )
    assert any(made.sentence() in one for one in export.lost)
    assert hjif_of(friction(SineWave(2e-3)), 0.0, 0.02, device=DEVICE).made_for is None


def friction(pattern: Pattern) -> RelativeFriction:
    return RelativeFriction(pattern, 0.4, 0.9)


@pytest.mark.parametrize(
    "pattern",
    [
        SineWave(2e-3, phase=0.7), SineWave(0.4e-3), SquareWave(4e-3, phase=-1.1),
        SquareWave(10e-3),
    ],
)  # fmt: skip
def test_gratings_come_back_as_gratings(pattern: SineWave | SquareWave, tmp_path: Path) -> None:
    export = hjif_of(friction(pattern), 3e-3, 37e-3, device=DEVICE)
    assert export.rms_error < 1e-9
    back = read_hjif(through_a_file(export, tmp_path))
    found = back.texture.pattern
    assert type(found) is type(pattern)
    assert isinstance(found, SineWave | SquareWave)
    assert found.spatial_period == pytest.approx(pattern.spatial_period, rel=1e-12)
    assert math.remainder(found.phase - pattern.phase, 2 * math.pi) == pytest.approx(0, abs=1e-9)
    assert (back.texture.low, back.texture.high) == pytest.approx((0.4, 0.9))


@pytest.mark.parametrize(
    "pattern", [Pulse(0.02, 4e-3), Noise(0.5e-3, 3), SineWave(2.7e-3), Ramp(5e-3, 30e-3)]
)
def test_smooth_textures_come_back_within_the_tolerance(pattern: Pattern, tmp_path: Path) -> None:
    tolerance = 2e-4
    export = hjif_of(friction(pattern), 3e-3, 37e-3, device=DEVICE, tolerance=tolerance)
    assert export.largest_error <= tolerance * 1.01
    back = read_hjif(through_a_file(export, tmp_path))
    error = back.texture(X, 0.0, 0.08, 0.0) - friction(pattern)(X, 0.0, 0.08, 0.0)
    assert np.max(np.abs(error)) <= tolerance * 1.01
    assert back.start == pytest.approx(3e-3)
    assert back.end == pytest.approx(37e-3)


def test_steps_are_a_micrometre_wide(tmp_path: Path) -> None:
    texture = friction(SquareWave(2e-3, duty=0.3) & Band(8e-3, 30e-3))
    back = read_hjif(through_a_file(hjif_of(texture, 3e-3, 37e-3, device=DEVICE), tmp_path))
    wrong = np.abs(back.texture(X, 0.0, 0.08, 0.0) - texture(X, 0.0, 0.08, 0.0)) > 1e-3
    # Some 24 edges, each at most 1 µm wide, on 34 mm of way.
    assert np.mean(wrong) < 24 * 1e-6 / 34e-3 * 2
    assert np.count_nonzero(wrong) < 30


def test_what_is_lost_is_listed() -> None:
    def lost(texture: Composable, **more: Any) -> str:
        return " ".join(hjif_of(texture, 0.0, 0.02, device=DEVICE, **more).lost)

    assert "goes on outside" in lost(friction(SineWave(2e-3)))
    assert "velocity" in lost(friction(Bump(0.01, 4e-3)))
    assert "velocity" not in lost(friction(SineWave(2e-3)))
    assert "across the line" in lost(friction(SineWave(2.5e-3, along=AlongY())))
    amplitude = Amplitude(SineWave(2e-3), 0.0, 1e-6)
    assert "of amplitude" in lost(amplitude, to_friction=lambda a: 1 - 3e5 * a)
    with pytest.raises(InputError, match="pass to_friction"):
        lost(amplitude)


def test_the_device_is_in_the_file_and_frequencies_are_ordered() -> None:
    export = hjif_of(friction(SineWave(2e-3)), 0.0, 0.02, device=DEVICE)
    require_hjif(export.document)
    perception = export.document["perceptions"][0]
    assert perception["perception_modality"] == "Friction"
    device = perception["reference_devices"][0]
    assert device["maximum_voltage"] == 15.0
    assert device["maximum_displacement"] == 1.7e-6
    assert device["minimum_frequency"] <= device["resonance_frequency"]
    assert device["resonance_frequency"] <= device["maximum_frequency"]
    # What the reference software's semantic checks ask for.
    channel = perception["channels"][0]
    assert channel["reference_device_id"] == device["id"]
    direction = channel["direction"]
    assert math.hypot(*direction.values()) / 127 == pytest.approx(1.0, abs=0.01)
    for band in channel["bands"]:
        assert ("curve_type" in band) == (band["band_type"] == "Curve")
        assert band["lower_frequency_limit"] <= band["upper_frequency_limit"]


def document(**changes: Any) -> dict[str, Any]:
    whole = hjif_of(friction(SineWave(2e-3)), 0.0, 0.02, device=DEVICE).document
    found: dict[str, Any] = json.loads(json.dumps(whole))
    found["perceptions"][0].update(changes)
    return found


def test_other_files_of_the_format_are_read() -> None:
    """Triangles, cubics, references, a gain and other channels, against hand-made values."""
    level = {"effect_type": "Basis", "position": 0, "phase": 0, "base_signal": "Sine",
             "keyframes": [{"relative_position": 0, "amplitude_modulation": 0.2},
                           {"relative_position": 10, "amplitude_modulation": 0.6}]}  # fmt: skip
    wave = {"effect_type": "Basis", "position": 0, "phase": 0, "base_signal": "Triangle", "id": 7,
            "keyframes": [{"relative_position": 0, "amplitude_modulation": 0.1,
                           "frequency_modulation": 250},
                          {"relative_position": 10, "amplitude_modulation": 0.1}]}  # fmt: skip
    whole = document(effect_library=[wave])
    channel = whole["perceptions"][0]["channels"][0]
    channel["gain"] = 1.25
    band = {"lower_frequency_limit": 0, "upper_frequency_limit": 1000}
    channel["bands"] = [
        {**band, "band_type": "Curve", "curve_type": "Cubic", "effects": [level]},
        {**band, "band_type": "VectorialWave",
         "effects": [{"effect_type": "Reference", "position": 0, "id": 7}]},
        {**band, "band_type": "Transient", "effects": [level]},
    ]  # fmt: skip
    x = np.array([0.0, 1e-3, 2e-3, 5e-3, 10e-3])
    s = x / 10e-3
    curve = 0.2 + 0.4 * s**2 * (3 - 2 * s)
    # A triangle of 4 mm rises from 0 to its top in 1 mm.
    wanted = 1.25 * (curve + 0.1 * np.array([0, 1, 0, 1, 0]))
    assert friction_along(whole, x) == pytest.approx(wanted)
    found = texture_of_hjif(whole)
    assert found.texture(x, 0.0, 0.08, 0.0) == pytest.approx(friction_along(whole, x), abs=2e-3)
    assert any("Transient" in text for text in found.lost)


@pytest.mark.parametrize(
    ("path", "value", "says"),
    [
        (("version",), 3, "the file.version"),
        (("perceptions",), {}, "the file.perceptions"),
        (("perceptions", 0, "unit_exponent"), None, "does not say what its positions"),
        (("perceptions", 0, "perception_modality"), "Vibrotactile", "no Friction"),
        (("perceptions", 0, "channels", 0, "gain"), float("nan"), r"channels\[0\].gain"),
        (("perceptions", 0, "channels", 0, "gain"), -1.0, "goes down to"),
        (("perceptions", 0, "channels", 0, "gain"), 3.0, "goes up to"),
        (("perceptions", 0, "channels", 0, "bands", 0, "effects", 0, "position"), 1.5, "position"),
        (("perceptions", 0, "channels", 0, "bands", 0, "effects", 0, "base_signal"), "?", "'\\?'"),
        (("perceptions", 0, "channels", 0, "bands"), [], "no effect"),
        (("perceptions", 0, "channels", 0, "bands", 0, "effects", 0, "keyframes", 0), 1, "object"),
    ],
)
def test_what_is_no_hjif_is_refused(path: tuple[Any, ...], value: Any, says: str) -> None:
    whole = document()
    place: Any = whole
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    with pytest.raises(InputError, match=says):
        texture_of_hjif(whole)


def test_a_key_that_is_missing_is_named() -> None:
    whole = document()
    del whole["perceptions"][0]["channels"][0]["bands"][0]["band_type"]
    with pytest.raises(InputError, match=r"bands\[0\] has no 'band_type'"):
        require_hjif(whole)


def test_files_that_are_no_json(tmp_path: Path) -> None:
    (tmp_path / "a.hjif").write_text("[" * 100_000)
    with pytest.raises(InputError, match="no JSON"):
        read_hjif(tmp_path / "a.hjif")
    with pytest.raises(InputError, match="cannot be read"):
        read_hjif(tmp_path / "b.hjif")


@pytest.mark.slow
def test_too_rough_a_line_is_refused() -> None:
    with pytest.raises(InputError, match="keyframes"):
        hjif_of(friction(Noise(5e-6, 1)), 0.0, 0.5, device=DEVICE, tolerance=1e-6)
