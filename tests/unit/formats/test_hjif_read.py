"""MPEG haptics by hand: signals, cubics, units, extents, and what is left out or refused."""

from __future__ import annotations

import copy
import math
from typing import Any

import numpy as np
import pytest

from squeezefilm.errors import InputError
from squeezefilm.formats.hjif_read import friction_along, require_hjif, texture_of_hjif
from squeezefilm.render.texture.image import Image
from squeezefilm.render.texture.shapes import SineWave, SquareWave

LIMITS = {"lower_frequency_limit": 0, "upper_frequency_limit": 1000}


def key(place: int, level: float | None = None, frequency: int | None = None) -> dict[str, Any]:
    found: dict[str, Any] = {"relative_position": place}
    if level is not None:
        found["amplitude_modulation"] = level
    if frequency is not None:
        found["frequency_modulation"] = frequency
    return found


def effect(*keys: dict[str, Any], position: int = 0, **changes: Any) -> dict[str, Any]:
    return {
        "effect_type": "Basis", "position": position, "phase": 0.0, "base_signal": "Sine",
        "keyframes": list(keys), **changes,
    }  # fmt: skip


def curve(*keys: dict[str, Any], kind: str = "Linear", position: int = 0) -> dict[str, Any]:
    return {
        "band_type": "Curve", "curve_type": kind, **LIMITS,
        "effects": [effect(*keys, position=position)],
    }  # fmt: skip


def wave(*keys: dict[str, Any], position: int = 0, **changes: Any) -> dict[str, Any]:
    return {
        "band_type": "VectorialWave", **LIMITS,
        "effects": [effect(*keys, position=position, **changes)],
    }  # fmt: skip


def channel(*bands: dict[str, Any], gain: float = 1.0) -> dict[str, Any]:
    return {
        "id": 0, "description": "", "gain": gain, "mixing_coefficient": 1.0, "body_part_mask": 0,
        "bands": list(bands),
    }  # fmt: skip


def friction(*channels: dict[str, Any], **changes: Any) -> dict[str, Any]:
    return {
        "id": 0, "avatar_id": 0, "description": "", "perception_modality": "Friction",
        "unit_exponent": -3, "channels": list(channels), "effect_library": [], **changes,
    }  # fmt: skip


def document(*perceptions: dict[str, Any]) -> dict[str, Any]:
    return {
        "version": "1", "profile": "Main", "level": 1, "date": "", "description": "",
        "timescale": 1000, "avatars": [], "perceptions": list(perceptions), "syncs": [],
    }  # fmt: skip


def of_bands(*bands: dict[str, Any], **changes: Any) -> dict[str, Any]:
    return document(friction(channel(*bands), **changes))


MM = 1e-3
RAMP = curve(key(0, 0.2), key(10, 0.6))


def test_a_line_is_read_between_its_keyframes_and_is_nothing_outside() -> None:
    whole = of_bands(curve(key(10, 0.6), key(0, 0.2), key(4, 0.3), position=5))
    x = np.array([4.9, 5.0, 7.0, 9.0, 12.0, 15.0, 15.1]) * MM
    wanted = [0.0, 0.2, 0.25, 0.3, 0.45, 0.6, 0.0]
    assert friction_along(whole, x) == pytest.approx(wanted)
    assert friction_along(whole, x.reshape(7, 1)).shape == (7, 1)


def test_positions_and_values_are_in_the_units_that_the_file_names() -> None:
    x = np.array([0.0, 5.0, 10.0])
    for exponent in (0, -3, -6, -9):
        found = friction_along(of_bands(RAMP, unit_exponent=exponent), x * 10.0**exponent)
        assert found == pytest.approx([0.2, 0.4, 0.6]), exponent
    small = of_bands(curve(key(0, 200.0), key(10, 600.0)), perception_unit_exponent=-3)
    assert friction_along(small, x * MM) == pytest.approx([0.2, 0.4, 0.6])
    loud = document(friction(channel(RAMP, gain=0.5)))
    assert friction_along(loud, x * MM) == pytest.approx([0.1, 0.2, 0.3])


def test_a_cubic_rises_smoothly_from_one_keyframe_to_the_next() -> None:
    whole = of_bands(curve(key(0, 0.2), key(4, 0.6), key(10, 0.3), kind="Cubic"))
    x = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 5.5, 7.0, 10.0])
    first, second = (x / 4).clip(0, 1), ((x - 4) / 6).clip(0, 1)
    wanted = 0.2 + 0.4 * first**2 * (3 - 2 * first) - 0.3 * second**2 * (3 - 2 * second)
    assert friction_along(whole, x * MM) == pytest.approx(wanted)
    # A step: two keyframes at one place.
    step = of_bands(curve(key(0, 0.2), key(4, 0.2), key(4, 0.6), key(8, 0.6), kind="Cubic"))
    assert friction_along(step, np.array([3.9, 4.1]) * MM) == pytest.approx([0.2, 0.6])
    # And one at the end.
    last = of_bands(curve(key(0, 0.2), key(4, 0.2), key(4, 0.6), kind="Cubic"))
    before, there = friction_along(last, np.array([3.9, 4.0]) * MM)
    assert before == pytest.approx(0.2)
    # At the step itself it is one side of it.
    assert there in (pytest.approx(0.2), pytest.approx(0.6))
    alone = of_bands(curve(key(0, 0.3), key(5), kind="Cubic"))
    assert friction_along(alone, np.array([0.0, 2.0, 5.0]) * MM) == pytest.approx([0.3] * 3)


SHARES = np.array([0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875])


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("Sine", np.sin(2 * np.pi * SHARES)),
        ("Square", [1, 1, 1, 1, -1, -1, -1, -1]),
        ("Triangle", [0, 0.5, 1, 0.5, 0, -0.5, -1, -0.5]),
        # From 0 up to 1 in half a period, then on from -1.
        ("SawToothUp", [0, 0.25, 0.5, 0.75, -1, -0.75, -0.5, -0.25]),
        ("SawToothDown", [0, -0.25, -0.5, -0.75, 1, 0.75, 0.5, 0.25]),
    ],
)
def test_each_signal_has_its_shape(name: str, values: Any) -> None:
    # 250 periods per metre are 4 mm each.
    one = wave(key(0, 0.1, 250), key(20, 0.1), base_signal=name)
    found = friction_along(of_bands(one), (SHARES + 2) * 4 * MM)
    assert found == pytest.approx(0.1 * np.asarray(values), abs=1e-9)
    # A phase of a quarter.
    early = wave(key(0, 0.1, 250), key(20, 0.1), base_signal=name, phase=math.pi / 2)
    x = (SHARES[:6] + 1) * 4 * MM
    assert friction_along(of_bands(early), x) == pytest.approx(
        0.1 * np.asarray(values)[2:], abs=1e-9
    )


def test_a_waves_amplitude_is_linear_and_its_phase_begins_with_it() -> None:
    swelling = wave(key(0, 0.0, 250), key(16, 0.4), position=3)
    x = np.array([3.0, 4.0, 6.0, 8.0, 18.0])
    way = x - 3
    wanted = 0.4 * way / 16 * np.sin(2 * np.pi * way / 4)
    assert friction_along(of_bands(swelling), x * MM) == pytest.approx(wanted, abs=1e-9)


def test_effects_add_up_and_a_reference_stands_where_it_is_put() -> None:
    library = [effect(key(0, 0.1), key(4, 0.3), id=7), effect(key(0, 0.5), key(4, 0.5), id=8)]
    band = curve(key(0, 0.2), key(20, 0.2))
    band["effects"] += [{"effect_type": "Reference", "position": 10, "id": 7}]
    whole = of_bands(band, effect_library=library)
    x = np.array([5.0, 10.0, 12.0, 14.0, 15.0]) * MM
    assert friction_along(whole, x) == pytest.approx([0.2, 0.3, 0.4, 0.5, 0.2])
    band["effects"][1]["id"] = 9
    with pytest.raises(InputError, match="the effect 9 is not in the library"):
        friction_along(whole, x)


def test_a_reference_to_a_reference_is_refused() -> None:
    band = curve(key(0, 0.2), key(20, 0.2))
    band["effects"] += [{"effect_type": "Reference", "position": 10, "id": 7}]
    library = [{"effect_type": "Reference", "position": 0, "id": 7}]
    with pytest.raises(InputError, match="the effect 7 is not in the library"):
        friction_along(of_bands(band, effect_library=library), np.zeros(1))


def test_what_is_left_out_is_listed() -> None:
    tactile = friction(channel(RAMP), perception_modality="Vibrotactile")
    bands = [
        RAMP,
        curve(key(0, 0.2), key(5, 0.2), kind="Bezier"),
        wave(key(0, 0.1, 250), key(10, 0.1, 300)),
        wave(key(0, 0.1), key(10, 0.1)),
        curve(key(0), key(10)),
        {**RAMP, "band_type": "Transient"},
    ]
    whole = document(tactile, friction(channel(*bands), channel(), channel()), friction())
    assert texture_of_hjif(whole).lost == (
        "perception 0 is Vibrotactile, no Friction",
        "perception 2 is a second Friction; the first is read",
        "channel 1 was left out",
        "channel 2 was left out",
        "an effect of a Curve band (Bezier) was left out",
        "a wave whose frequency changes was left out",
        "a wave whose frequency changes was left out",
        "an effect without amplitudes was left out",
        "an effect of a Transient band (Linear) was left out",
    )
    # The same frequency at each keyframe is no change.
    steady = of_bands(wave(key(0, 0.1, 250), key(10, 0.1, 250)), RAMP)
    assert not any("changes" in one for one in texture_of_hjif(steady).lost)


def test_a_curve_becomes_an_image_on_the_grid_of_its_keyframes() -> None:
    found = texture_of_hjif(of_bands(curve(key(0, 0.2), key(4, 0.6), key(10, 0.3), position=-2)))
    assert (found.start, found.end) == (pytest.approx(-2 * MM), pytest.approx(8 * MM))
    assert found.lost == ()
    image = found.texture.pattern
    assert isinstance(image, Image)
    assert (found.texture.low, found.texture.high) == pytest.approx((0.2, 0.6))
    # Every 2 mm: what lies between is linear in the file and in the image.
    x = np.linspace(-2, 8, 41) * MM
    wanted = np.interp(x / MM, [-2, 2, 8], [0.2, 0.6, 0.3])
    assert found.texture(x, 0.0, 0.08, 0.0) == pytest.approx(wanted)


def test_waves_and_cubics_are_sampled_finely() -> None:
    bands = [
        curve(key(0, 0.3), key(8, 0.5), kind="Cubic"),
        curve(key(0, 0.5), key(8, 0.5)),
    ]
    smooth, straight = (texture_of_hjif(of_bands(one)) for one in bands)
    assert smooth.lost == ("waves and cubics were sampled every 10 µm",)
    assert straight.lost == ()
    x = np.linspace(0, 8, 333) * MM
    s = x / (8 * MM)
    wanted = 0.3 + 0.2 * s**2 * (3 - 2 * s)
    assert smooth.texture(x, 0.0, 0.08, 0.0) == pytest.approx(wanted, abs=1e-5)
    # A flat line has no spread, and one level.
    assert straight.texture(x, 0.0, 0.08, 0.0) == pytest.approx(0.5)


def test_keyframes_closer_than_an_image_can_hold_are_said() -> None:
    fine = of_bands(curve(key(0, 0.2), key(100_001, 0.6), key(20_000_000, 0.3)), unit_exponent=-9)
    found = texture_of_hjif(fine)
    assert found.lost == ("keyframes lie closer than an image can hold; sampled every 1e-06 m",)
    x = np.array([0.0, 50e-6, 100e-6, 10e-3, 20e-3])
    wanted = np.interp(x, [0.0, 100.001e-6, 20e-3], [0.2, 0.6, 0.3])
    assert found.texture(x, 0.0, 0.08, 0.0) == pytest.approx(wanted, abs=5e-3)


@pytest.mark.parametrize("name", ["Sine", "Square"])
def test_one_wave_on_a_constant_is_a_grating(name: str) -> None:
    level = curve(key(0, 0.5), key(40, 0.5), position=3)
    bands = [level, wave(key(0, 0.3, 250), key(40, 0.3), position=3, base_signal=name, phase=0.4)]
    for order in (bands, bands[::-1]):
        whole = of_bands(*order)
        found = texture_of_hjif(whole)
        pattern = found.texture.pattern
        assert isinstance(pattern, SineWave if name == "Sine" else SquareWave)
        assert pattern.spatial_period == pytest.approx(4 * MM)
        assert (found.texture.low, found.texture.high) == pytest.approx((0.2, 0.8))
        assert found.lost == ()
        x = np.linspace(3.1, 42.9, 777) * MM
        # At an edge of a square the last digit decides.
        away = np.abs(np.mod(250 * (x - 3 * MM) + 0.4 / (2 * math.pi), 0.5) - 0.25) < 0.24
        told = found.texture(x, 0.0, 0.08, 0.0)[away]
        assert told == pytest.approx(friction_along(whole, x)[away], abs=1e-9)
        assert abs(pattern.phase) < 2 * math.pi


def test_a_grating_may_say_its_amplitudes_once() -> None:
    bands = [curve(key(0, 0.5), key(40)), wave(key(0, 0.3, 250), key(40))]
    found = texture_of_hjif(of_bands(*bands))
    assert isinstance(found.texture.pattern, SineWave)
    assert (found.texture.low, found.texture.high) == pytest.approx((0.2, 0.8))


STEADY = wave(key(0, 0.3, 250), key(40, 0.3))
LEVEL = curve(key(0, 0.5), key(40, 0.5))


@pytest.mark.parametrize(
    "bands",
    [
        (STEADY, curve(key(0, 0.5), key(40, 0.6))),
        (wave(key(0, 0.3, 250), key(40, 0.2)), LEVEL),
        (STEADY, curve(key(0, 0.5), key(40, 0.5), position=1)),
        (wave(key(0, 0.3, 250), key(40, 0.3), base_signal="Triangle"), LEVEL),
        (STEADY, STEADY | {"effects": [effect(key(0, 0.1, 9), key(40, 0.1))]}, LEVEL, LEVEL),
        (wave(key(0, 0.3, 0), key(40, 0.3)), LEVEL),
    ],
)
def test_anything_else_is_an_image(bands: tuple[dict[str, Any], ...]) -> None:
    scaled = document(friction(channel(*bands, gain=0.4)))
    assert isinstance(texture_of_hjif(scaled).texture.pattern, Image)


def test_a_grating_that_goes_beyond_its_range_is_refused_as_an_image_is() -> None:
    for gain, words in ((2.0, "goes up to 1.6"), (1.3, "goes up to 1.04")):
        whole = document(friction(channel(STEADY, LEVEL, gain=gain)))
        with pytest.raises(InputError, match=words):
            texture_of_hjif(whole)
    low = document(friction(channel(wave(key(0, 0.6, 250), key(40, 0.6)), LEVEL)))
    with pytest.raises(InputError, match=r"goes down to -0\.1"):
        texture_of_hjif(low)
    # Just within it is one.
    whole = document(friction(channel(wave(key(0, 0.5, 250), key(40, 0.5)), LEVEL)))
    assert isinstance(texture_of_hjif(whole).texture.pattern, SineWave)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"unit_exponent": -10}, "unit_exponent = -10"),
        ({"unit_exponent": 1}, "unit_exponent = 1"),
        ({"unit_exponent": True}, "unit_exponent = True"),
        ({"unit_exponent": -3.0}, r"unit_exponent = -3\.0"),
        ({"perception_unit_exponent": 10}, "perception_unit_exponent = 10 cannot"),
        ({"perception_unit_exponent": -10}, "perception_unit_exponent = -10 cannot"),
        ({"perception_unit_exponent": False}, "perception_unit_exponent = False"),
        ({"perception_unit_exponent": "3"}, "perception_unit_exponent = '3'"),
        ({"channels": []}, "no Friction with a channel"),
    ],
)
def test_units_that_say_nothing_are_refused(changes: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        texture_of_hjif(of_bands(RAMP, **changes))


def test_extents_that_make_no_texture_are_refused() -> None:
    with pytest.raises(InputError, match="have no extent"):
        texture_of_hjif(of_bands(curve(key(0, 0.2))))
    with pytest.raises(InputError, match="the file goes from 0 to 11 m; ±10 m"):
        texture_of_hjif(of_bands(curve(key(0, 0.2), key(11, 0.3)), unit_exponent=0))
    with pytest.raises(InputError, match="the file goes from -11 to -9 m"):
        texture_of_hjif(of_bands(curve(key(0, 0.2), key(2, 0.3), position=-11), unit_exponent=0))
    # Every 50 mm: a texture's pixels are at most 100 mm wide.
    whole = of_bands(curve(key(0, 0.2), key(50, 0.2), key(19_950, 0.3), position=-9_950))
    found = texture_of_hjif(whole)
    assert (found.start, found.end) == (pytest.approx(-9.95), pytest.approx(10.0))


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("level",), True),
        (("level",), 2**53),
        (("timescale",), 1.0),
        (("perceptions", 0, "channels", 0, "gain"), math.inf),
        (("perceptions", 0, "channels", 0, "gain"), "1"),
        (("perceptions", 0, "effect_library", 0, "id"), "7"),
        (("perceptions", 0, "effect_library", 1, "phase"), None),
        (("perceptions", 0, "effect_library", 1, "keyframes", 0, "relative_position"), 0.5),
        (("perceptions", 0, "effect_library", 1, "keyframes", 0, "frequency_modulation"), 0.5),
        (("perceptions", 0, "effect_library", 1, "keyframes", 0, "amplitude_modulation"), "x"),
    ],
)
def test_a_value_of_the_wrong_kind_is_named_with_its_place(path: Any, value: Any) -> None:
    library = [{"effect_type": "Reference", "position": 0, "id": 7}, effect(key(0, 0.1, 5), id=8)]
    whole = copy.deepcopy(of_bands(RAMP, effect_library=library))
    require_hjif(whole)
    place: Any = whole
    for step in path[:-1]:
        place = place[step]
    place[path[-1]] = value
    dotted = "".join(f"[{one}]" if isinstance(one, int) else f".{one}" for one in path)
    said = dotted.removeprefix(".") if len(path) > 1 else f"the file{dotted}"
    with pytest.raises(InputError) as refused:
        require_hjif(whole)
    assert str(refused.value).startswith(f"{said} = {value!r} is ")


@pytest.mark.parametrize("name", ["channels", "effect_library", "perception_modality", "id"])
def test_a_perception_that_lacks_something_is_named(name: str) -> None:
    whole = of_bands(RAMP)
    del whole["perceptions"][0][name]
    with pytest.raises(InputError, match=rf"perceptions\[0\] has no '{name}'"):
        require_hjif(whole)
    whole["perceptions"][0] = [name]
    with pytest.raises(InputError, match=r"perceptions\[0\] is no JSON object"):
        require_hjif(whole)


def test_the_largest_numbers_that_are_exact_are_taken() -> None:
    for level in (2**53 - 1, 1 - 2**53):
        require_hjif(of_bands(RAMP) | {"level": level})


@pytest.mark.parametrize("length", [100, 200, 250, 3_000])
def test_a_straight_line_longer_than_a_pixel_may_be_is_read_exactly(length: int) -> None:
    whole = of_bands(curve(key(0, 0.2), key(length, 0.6)))
    found = texture_of_hjif(whole)
    x = np.linspace(0.0, length, 7) * MM
    assert found.texture(x, 0.0, 0.0, 0.0) == pytest.approx(friction_along(whole, x))
    assert found.lost == ()
