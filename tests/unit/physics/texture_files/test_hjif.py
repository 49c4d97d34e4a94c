"""MPEG haptics: what is written is what the reference software loads and evaluates."""

import math
from typing import Any

import numpy as np
import pytest
from tests.unit.core.formats.hjif_conformance import require_hjif

from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.program.renderer import MadeForSpeed
from squeezefilm.physics.render.texture.composition import Composable
from squeezefilm.physics.render.texture.image import Noise
from squeezefilm.physics.render.texture.levels import Amplitude, RelativeFriction
from squeezefilm.physics.render.texture.pattern import AlongY, Pattern
from squeezefilm.physics.render.texture.shapes import Band, Bump, Pulse, Ramp, SineWave, SquareWave
from squeezefilm.physics.texture_files import hjif
from squeezefilm.physics.texture_files.hjif import ReferenceDevice, friction_along, hjif_of

DEVICE = ReferenceDevice("biet2008-plate", 33.6e3, 15.0, 1.7e-6)
X = np.linspace(3e-3, 37e-3, 9973)


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
def test_gratings_are_written_as_waves(pattern: SineWave | SquareWave) -> None:
    export = hjif_of(friction(pattern), 3e-3, 37e-3, device=DEVICE)
    assert export.rms_error < 1e-9
    require_hjif(export.document)
    level, wave = export.document["perceptions"][0]["channels"][0]["bands"]
    assert (level["band_type"], wave["band_type"]) == ("Curve", "VectorialWave")
    assert wave["effects"][0]["base_signal"] == (
        "Sine" if isinstance(pattern, SineWave) else "Square"
    )
    # At an edge of a square the last digit decides.
    cycles = X / pattern.spatial_period + pattern.phase / (2 * math.pi)
    away = np.abs(np.mod(cycles, 0.5) - 0.25) < 0.24
    wanted = friction(pattern)(X, 0.0, 0.08, 0.0)
    assert friction_along(export.document, X)[away] == pytest.approx(wanted[away], abs=1e-9)


@pytest.mark.parametrize(
    "pattern", [Pulse(0.02, 4e-3), Noise(0.5e-3, 3), SineWave(2.7e-3), Ramp(5e-3, 30e-3)]
)
def test_smooth_textures_are_within_the_tolerance(pattern: Pattern) -> None:
    tolerance = 2e-4
    export = hjif_of(friction(pattern), 3e-3, 37e-3, device=DEVICE, tolerance=tolerance)
    assert export.largest_error <= tolerance * 1.01
    require_hjif(export.document)
    error = friction_along(export.document, X) - friction(pattern)(X, 0.0, 0.08, 0.0)
    assert np.max(np.abs(error)) <= tolerance * 1.01
    outside = friction_along(export.document, np.array([2.99e-3, 37.01e-3]))
    assert outside == pytest.approx([0.0, 0.0])


def test_steps_are_a_micrometre_wide() -> None:
    texture = friction(SquareWave(2e-3, duty=0.3) & Band(8e-3, 30e-3))
    document = hjif_of(texture, 3e-3, 37e-3, device=DEVICE).document
    wrong = np.abs(friction_along(document, X) - texture(X, 0.0, 0.08, 0.0)) > 1e-3
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


def test_keyframes_and_waves_are_evaluated_as_the_reference_software_does() -> None:
    document = hjif_of(friction(SineWave(4e-3)), 3e-3, 37e-3, device=DEVICE).document
    perception = document["perceptions"][0]
    level, wave = perception["channels"][0]["bands"]
    level["effects"][0].update(position=5, keyframes=[
        {"relative_position": place, "amplitude_modulation": value}
        for place, value in ((0, 0.2), (4, 0.3), (10, 0.6))
    ])  # fmt: skip
    wave["effects"][0].update(position=3, phase=math.pi / 2)
    places = np.array([4.9, 5.0, 7.0, 9.0, 12.0, 15.0, 15.1])
    joined = np.array([0.0, 0.2, 0.25, 0.3, 0.45, 0.6, 0.0])
    swing = 0.25 * np.cos(2 * np.pi * (places - 3) / 4)
    for exponent in (-3, -6):
        perception["unit_exponent"] = exponent
        wave["effects"][0]["keyframes"][0]["frequency_modulation"] = 250 * 10 ** (-3 - exponent)
        x = places * 10.0**exponent
        assert friction_along(document, x) == pytest.approx(joined + swing, abs=1e-9)
        assert friction_along(document, x.reshape(7, 1)).shape == (7, 1)


@pytest.mark.parametrize(
    ("key", "value", "place"),
    [
        ("band_type", None, r"bands\[0\] has no 'band_type'"),
        ("effects", {}, r"bands\[0\].effects"),
        ("lower_frequency_limit", True, r"bands\[0\].lower_frequency_limit"),
        ("upper_frequency_limit", 2**53, r"bands\[0\].upper_frequency_limit"),
    ],
)
def test_what_the_reference_software_would_not_load_is_named(
    key: str, value: Any, place: str
) -> None:
    document = hjif_of(friction(SineWave(2e-3)), 0.0, 0.02, device=DEVICE).document
    band = document["perceptions"][0]["channels"][0]["bands"][0]
    band.pop(key) if value is None else band.update({key: value})
    with pytest.raises(AssertionError, match=place):
        require_hjif(document)


@pytest.mark.slow
def test_too_rough_a_line_is_refused() -> None:
    with pytest.raises(InputError, match="keyframes"):
        hjif_of(friction(Noise(5e-6, 1)), 0.0, 0.5, device=DEVICE, tolerance=1e-6)


def test_more_keyframes_than_the_format_counts_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """A zigzag needs one at each of its places; a straight line its two ends."""
    monkeypatch.setattr(hjif, "_MOST_KEYFRAMES", 30)

    def zigzag(place: Any) -> Any:
        return 0.5 + 0.1 * (np.round(place * 1e6) % 2)

    band = hjif._keyframes(zigzag, 5, 34, 1e-3)
    (effect,) = band["effects"]
    assert len(effect["keyframes"]) == 30
    with pytest.raises(InputError, match=r"needs 31 keyframes and the format counts up to 30"):
        hjif._keyframes(zigzag, 5, 35, 1e-3)
    (effect,) = hjif._keyframes(lambda place: 0.2 + 1e3 * place, 5, 35, 1e-3)["effects"]
    assert [one["relative_position"] for one in effect["keyframes"]] == [0, 30]
