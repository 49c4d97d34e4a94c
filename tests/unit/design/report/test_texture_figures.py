"""Figures of a rendered texture: what is drawn is what was asked, made and met, in its units."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.unit.drawn import words

from squeezefilm.design.report.texture_figures import drive, friction, ripple, way
from squeezefilm.physics.render.program.inverse import FrictionInverse

pytestmark = pytest.mark.usefixtures("figures_as_described")

STEPS = 6001
TIME = np.linspace(0, 0.6, STEPS)
# There and back over 30 mm in 0.6 s, and a little sideways.
X = 0.03 * (1 - np.abs(1 - TIME / 0.3))
SPEED = np.where(TIME <= 0.3, 0.1, -0.1)
ASKED = 0.8 + 0.2 * np.cos(40 * TIME)
RENDERED = 0.7 + 0.1 * np.cos(40 * TIME)
COMMAND, AMPLITUDE = 1e-6 + 1e-6 * TIME, 0.5e-6 + 1e-6 * TIME
FACTOR = 0.6 + 0.5 * TIME
FORCE = np.where(np.arange(STEPS) % 2, -0.2, 0.4)
LARGEST = 2e-6


class Texture:
    """Friction over the plane, rising evenly along both ways."""

    quantity = "relative_friction"

    def __call__(self, x: Any, y: Any, speed: Any, time: Any) -> Any:
        return 0.5 + 10 * x + 20 * y + speed + time


def made(**changes: Any) -> Any:
    parts: dict[str, Any] = {
        "stroke": SimpleNamespace(
            time=TIME, relative_friction_rendered=RENDERED, command=COMMAND, amplitude=AMPLITUDE,
            envelope=SimpleNamespace(amplitude_limit=LARGEST), saturated_top=0.1,
            saturated_bottom=0.03, model="a loop",
        ),
        "fidelity": SimpleNamespace(
            lag=0.3e-3, spatial_frequency=np.array([500.0, 250.0, 1000.0]),
            contrast_kept=np.array([0.9, np.nan, 0.4]), swing_kept=np.array([0.95, 0.2, 1.3]),
            model="a judge",
        ),
        "unjudged": None,
        "played": SimpleNamespace(
            name="grating", friction=lambda values: 2 * values,
            amplitude=lambda v, speed: v * 1e-6,
            inverse=FrictionInverse.from_function(lambda a: 1 - 0.2 * a / 1e-6, 4e-6),
        ),
        "least_friction": 0.25,
        "display": SimpleNamespace(name="plate"),
        "rms_error": 0.0321,
        "prediction": SimpleNamespace(
            model="a law", voltage=12.0, mode=SimpleNamespace(half_wavelength=7.5e-3)
        ),
        "asked": ASKED, "motion": SimpleNamespace(passes=2), "time_constant": 0.5e-3,
        "force": SimpleNamespace(
            friction_force=FORCE, sticking=np.arange(STEPS) < 3000, model="with skin"
        ),
        "finger": SimpleNamespace(
            x=X, y=np.zeros(STEPS), speed=SPEED, way=np.concatenate([X[:3001], 0.06 - X[3001:]])
        ),
        "texture": SimpleNamespace(texture=Texture()), "wave": "felt", "factor": FACTOR,
    }  # fmt: skip
    return SimpleNamespace(**{**parts, **changes})


RESULT = made()


def texts(axes: Any) -> list[str]:
    return [one.get_text() for one in axes.get_legend().get_texts()]


def test_friction_is_drawn_whole_and_around_the_middle_of_the_first_pass() -> None:
    figure = friction(RESULT)
    left, right = figure.axes
    for axes, low, high, count in ((left, 0, 0.6, 3001), (right, 0.138, 0.162, 241)):
        asked, rendered = axes.get_lines()[:2]
        assert axes.get_xlim() == pytest.approx((low, high))
        # Every other of 6001 points is enough; the part enlarged has all of its own.
        assert asked.get_xdata().size == pytest.approx(count, abs=1)
        assert asked.get_xdata()[[0, -1]] == pytest.approx([low, high], abs=2e-4)
        assert asked.get_ydata() == pytest.approx(0.8 + 0.2 * np.cos(40 * asked.get_xdata()))
        assert rendered.get_ydata() == pytest.approx(0.7 + 0.1 * np.cos(40 * asked.get_xdata()))
        assert axes.get_lines()[2].get_ydata() == [0.25, 0.25]
        assert axes.get_xlabel() == "time (s)"
    assert texts(left) == ["asked for", "rendered", "least this display reaches: 0.25"]
    assert left.get_ylabel() == "relative friction µ′/µ"
    assert left.get_ylim() == (0, 1.05)
    assert words(figure.get_suptitle()) == (
        "grating on plate: friction is rendered within 0.032 RMS of µ′/µ, 0.3 mm late"
    )
    assert figure.get_supxlabel() == "Model: a loop; friction by a law"


def test_friction_above_rest_fits_into_the_figure_and_a_still_motion_has_one_pass() -> None:
    left, right = friction(made(asked=1.5 * ASKED, motion=SimpleNamespace())).axes
    assert left.get_ylim() == pytest.approx((0, 1.03 * 1.5))
    assert right.get_xlim() == pytest.approx((0.276, 0.324))


@pytest.mark.parametrize(
    ("lag", "said"), [(0.0, "0 m late"), (-0.2e-3, "0.2 mm early"), (math.nan, ""), (None, "")]
)
def test_lateness_is_told_where_it_is_known(lag: float | None, said: str) -> None:
    judged = None if lag is None else SimpleNamespace(lag=lag)
    title = words(friction(made(fidelity=judged)).get_suptitle())
    assert title.endswith(f"RMS of µ′/µ, {said}" if said else "RMS of µ′/µ")


def test_drive_and_force_stand_over_one_time() -> None:
    figure = drive(RESULT)
    above, below = figure.axes
    commanded, vibrating, limit = above.get_lines()
    t = commanded.get_xdata()
    assert t == pytest.approx(TIME[::2])
    assert commanded.get_ydata() == pytest.approx(1 + t)
    assert vibrating.get_ydata() == pytest.approx(0.5 + t)
    assert limit.get_ydata() == pytest.approx([2, 2])
    assert texts(above) == ["commanded", "vibrating", "largest: 2 µm at 12 V"]
    tangential, stuck = below.get_lines()
    assert tangential.get_ydata() == pytest.approx(FORCE[::2])
    assert np.isfinite(stuck.get_ydata()).tolist() == (np.arange(0, STEPS, 2) < 3000).tolist()
    assert stuck.get_ydata()[:1500] == pytest.approx(FORCE[:3000:2])
    assert texts(below) == ["tangential force", "while the skin sticks"]
    assert (above.get_ylabel(), below.get_ylabel()) == ("amplitude (µm)", "force (N)")
    assert below.get_xlabel() == "time (s)"
    assert below.get_xlim() == pytest.approx((0, 0.6))
    assert words(figure.get_suptitle()) == (
        "The drive is at a limit 13 % of the time; the finger is dragged with 0.3 N on average"
    )
    assert words(figure.get_supxlabel()) == "Model: τ = 0.5 ms with the finger; pad with skin"


def test_an_amplitude_that_was_given_has_no_volts() -> None:
    given = SimpleNamespace(voltage=None)
    assert texts(drive(made(prediction=given)).axes[0])[2] == "largest: 2 µm"


def test_the_way_lies_on_the_texture_at_the_mean_speed() -> None:
    figure = way(RESULT)
    axes, bar = figure.axes
    (image,) = axes.get_images()
    # 30 mm of way with a margin of 12 %; a straight way gets 30 % of its length across.
    assert image.get_extent() == pytest.approx([-3.6, 33.6, -8.1, 8.1])
    picture = np.asarray(image.get_array())
    assert picture.shape == (round(260 * 16.2 / 37.2), 260)
    assert picture[0, 0] == pytest.approx(2 * (0.5 - 0.036 - 0.162 + 0.1))
    assert picture[0, -1] == pytest.approx(2 * (0.5 + 0.336 - 0.162 + 0.1))
    assert picture[-1, 0] == pytest.approx(2 * (0.5 - 0.036 + 0.162 + 0.1))
    assert image.origin == "lower"
    assert image.get_clim() == pytest.approx((0, picture.max()))
    assert bar.get_ylabel() == "µ′/µ asked for"
    under, finger, start = axes.get_lines()
    for line in (under, finger):
        assert line.get_xdata() == pytest.approx(1e3 * X[::2])
        assert not np.any(line.get_ydata())
    assert start.get_xydata().tolist() == [[0, 0]]
    assert texts(axes) == ["finger", "start"]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x (mm)", "y (mm)")
    assert words(figure.get_suptitle()) == (
        "60 mm of finger motion over grating, 100 mm/s on average"
    )


def test_a_way_that_is_higher_than_wide_gets_its_height() -> None:
    y = 0.01 + 0.04 * TIME / 0.6
    finger = SimpleNamespace(x=0.5 * X, y=y, speed=SPEED, way=y)
    axes = way(made(finger=finger)).axes[0]
    assert axes.get_images()[0].get_extent() == pytest.approx([-4.8, 19.8, 5.2, 54.8])
    assert axes.get_lines()[2].get_xydata() == pytest.approx(np.array([[0, 10]]))


def test_a_texture_of_amplitude_is_shown_as_the_friction_it_makes() -> None:
    texture = Texture()
    texture.quantity = "amplitude"
    (image,) = way(made(texture=SimpleNamespace(texture=texture))).axes[0].get_images()
    picture = np.asarray(image.get_array())
    assert picture[0, 0] == pytest.approx(1 - 0.2 * (0.5 - 0.036 - 0.162 + 0.1))
    assert image.get_clim() == (0, 1)


def test_the_wave_is_drawn_along_the_first_pass() -> None:
    figure = ripple(RESULT)
    above, below = figure.axes
    antinodes, met = above.get_lines()
    asked, rendered = below.get_lines()
    x = antinodes.get_xdata()
    assert np.all(np.diff(x) > 0)
    assert x[[0, -1]] == pytest.approx([0, 30], abs=0.02)
    time = x / 100
    assert antinodes.get_ydata() == pytest.approx(0.5 + time)
    assert met.get_ydata() == pytest.approx((0.5 + time) * (0.6 + 0.5 * time))
    assert asked.get_ydata() == pytest.approx(0.8 + 0.2 * np.cos(40 * time))
    assert rendered.get_ydata() == pytest.approx(0.7 + 0.1 * np.cos(40 * time))
    for line in (met, asked, rendered):
        assert line.get_xdata() == pytest.approx(x)
    assert texts(above) == ["at the antinodes", "met by the pad"]
    assert texts(below) == ["asked for", "rendered"]
    assert above.get_ylabel() == "amplitude (µm)"
    assert above.get_ylim()[0] == 0
    assert (below.get_xlabel(), below.get_ylabel()) == ("x (mm)", "µ′/µ")
    assert below.get_ylim() == (0, 1.05)
    title = words(figure.get_suptitle())
    assert title == (
        "Along the wave, every 7.5 mm, the pad meets 60 to 90 % of an antinode's amplitude."
    )
    assert figure.get_supxlabel() == "Model: standing wave felt; x = 0 is an antinode"


def test_a_wave_made_up_for_is_said_and_one_pass_is_drawn_to_its_end() -> None:
    once = SimpleNamespace(x=0.03 * TIME / 0.6, y=np.zeros(STEPS), speed=np.full(STEPS, 0.05))
    figure = ripple(made(wave="compensated", finger=once))
    assert words(figure.get_suptitle()).endswith("The renderer makes up for it.")
    assert figure.axes[0].get_lines()[0].get_xdata() == pytest.approx(1e3 * once.x[::2])


def test_a_turn_on_a_control_step_ends_the_first_pass() -> None:
    speed = np.where(np.arange(STEPS) == 3000, 0.0, SPEED)
    finger = SimpleNamespace(x=X, y=np.zeros(STEPS), speed=speed)
    x = ripple(made(finger=finger)).axes[0].get_lines()[0].get_xdata()
    assert np.all(np.diff(x) > 0)
