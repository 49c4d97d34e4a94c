"""A texture that is played: the amplitude it wants at a place, a speed and a time."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.chain.played_texture import (
    FingerMotion,
    PlayedTexture,
    require_on_display,
    require_on_image,
    single_period,
)
from squeezefilm.physics.display import load_display
from squeezefilm.physics.render.motion.stroke import FingerPath, Stroke
from squeezefilm.physics.render.program.lowering import lower
from squeezefilm.physics.render.texture.image import Image
from squeezefilm.physics.render.texture.levels import Amplitude
from squeezefilm.physics.render.texture.pattern import AlongDirection, SpeedScaled
from squeezefilm.physics.render.texture.shapes import Bump, SineWave

LARGEST = 2e-6
PLATE = load_display("biet2008-plate")


def motion(x: Any, y: Any, speed: Any = None) -> FingerMotion:
    """Places of a finger at 0, 1, 2 … s."""
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    time = np.arange(x.size, dtype=float)
    speed = np.ones(x.size) if speed is None else np.asarray(speed, dtype=float)
    return FingerMotion(cast("Any", None), time, x, x, y, speed, None)


def test_the_sign_of_the_velocity_is_that_of_the_motion_at_the_time_asked() -> None:
    # A bump resists before its centre and helps behind it: whole or nothing at its flanks.
    bump = Amplitude(Bump(10e-3, 1e-3), 0.0, LARGEST)
    played = PlayedTexture(
        "bump",
        lower(bump, largest_amplitude=LARGEST),
        cast("Any", None),
        motion([0.0, 1.0, 1.0], [0.0, 0.0, 0.0], speed=[0.1, -0.1, 0.1]),
        0.5,
    )
    assert repr(played) == "bump"
    before = np.full(6, 9e-3)
    at = np.array([-1.0, 0.0, 0.5, 1.0, 1.5, 30.0])
    wanted = played(before, before, 0.1, at)
    np.testing.assert_allclose(wanted, LARGEST * np.array([1, 1, 0, 0, 1, 1]), atol=1e-15)
    # The loop's own speed has no sign.
    np.testing.assert_array_equal(played(before, before, -0.1, at), wanted)


def test_a_stroke_is_sampled_to_its_end_and_a_path_has_its_own_way() -> None:
    there_and_back = FingerMotion.of(Stroke(0.1, 40e-3, 2), 100.0)
    assert there_and_back.time[-1] == pytest.approx(0.8)
    assert there_and_back.time.size == 81
    np.testing.assert_array_equal(there_and_back.y, 0.0)
    assert there_and_back.speed[10] == pytest.approx(0.1)
    assert there_and_back.speed[60] == pytest.approx(-0.1)
    # Down a right angle: forward first, then only sideways, towards smaller y.
    corner = FingerPath(
        np.array([0.0, 1.0, 2.0]), np.array([0.0, 0.03, 0.03]), np.array([0.0, 0.0, -0.02])
    )
    sampled = FingerMotion.of(corner, 100.0)
    assert sampled.speed[50] == pytest.approx(0.03)
    assert sampled.speed[150] == pytest.approx(-0.02)
    assert sampled.way[-1] == pytest.approx(0.05, rel=1e-3)


def test_a_grating_has_a_period_where_it_is_steady() -> None:
    sine = SineWave(2e-3)
    assert single_period(Amplitude(sine, 0.0, LARGEST)) == 2e-3
    assert single_period(Amplitude(Bump(0.0, 1e-3), 0.0, LARGEST)) is None
    slanted = SineWave(2e-3, along=AlongDirection(0.5))
    assert single_period(Amplitude(slanted, 0.0, LARGEST)) is None
    stretched = SpeedScaled(sine, reference_speed=0.1, slowest=0.05, fastest=0.2)
    texture = Amplitude(stretched, 0.0, LARGEST)
    assert single_period(texture) is None
    for speed, period in ((0.1, 2e-3), (0.15, 3e-3), (0.01, 1e-3), (0.5, 4e-3)):
        assert single_period(texture, Stroke(speed, 40e-3, 1)) == pytest.approx(period)


def test_a_motion_stays_on_its_image() -> None:
    image = Image(np.eye(4), 1e-3, left=10e-3, bottom=-2e-3, outside="hold")
    texture = Amplitude(image, 0.0, LARGEST)
    on = motion([10e-3, 14e-3], [-2e-3, 2e-3])
    require_on_image(texture, on)
    for x, y, says in (
        ([9.9e-3, 12e-3], [0.0, 0.0], r"at 0 s the finger is at x = 9\.9 mm, y = 0"),
        ([12e-3, 14.1e-3], [0.0, 0.0], r"at 1 s the finger is at x = 14\.1 mm"),
        ([12e-3, 12e-3], [0.0, -2.1e-3], r"the image ends at x = 10 mm to 14 mm"),
        ([12e-3, 12e-3], [0.0, 2.1e-3], r"y = -2 mm to 2 mm; shorten the stroke"),
    ):
        with pytest.raises(InputError, match=says):
            require_on_image(texture, motion(x, y))
    repeated = Image(np.eye(4), 1e-3, left=10e-3, bottom=-2e-3, outside="repeat")
    require_on_image(Amplitude(repeated, 0.0, LARGEST), motion([0.0, 1.0], [0.0, 0.0]))


def test_a_motion_needs_no_more_surface_than_there_is() -> None:
    width, height = PLATE.actuator.extent
    require_on_display(PLATE.actuator, motion([-0.3, width - 0.3], [0.0, height]))
    with pytest.raises(InputError, match="along x, and the surface has"):
        require_on_display(PLATE.actuator, motion([0.0, 1.001 * width], [0.0, 0.0]))
    with pytest.raises(InputError, match="along y, and the surface has"):
        require_on_display(PLATE.actuator, motion([0.0, 0.0], [0.0, 1.001 * height]))
    with pytest.raises(InputError, match="leave y_m out"):
        require_on_display(load_display("biet2008-stator").actuator, motion([0.0], [1e-3]))
