"""Figures of a motor: the curves have their ends, the step says where it ends."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text
from tests.unit import drawn
from tests.unit.actuators.test_motor import WORKING, motor

from squeezefilm.actuators.motor.closed_loop import TrackedForce
from squeezefilm.actuators.motor.curves import motor_map, speed_force_curve
from squeezefilm.actuators.motor.plane import simulate_plane
from squeezefilm.actuators.report.motor import (
    MOTOR_FIGURES,
    force_step_figure,
    map_figure,
    plane_figure,
    speed_force_figure,
    tuning_figure,
)

pytestmark = pytest.mark.usefixtures("figures_as_described")


def words(figure: Figure) -> str:
    return " ".join(drawn.words(one.get_text()) for one in figure.findobj(Text))


def test_curves_and_map_are_drawn() -> None:
    curve = speed_force_curve(motor(), WORKING, 4)
    found = motor_map(motor(), np.array([5.0, 60.0]), np.array([0.5e-6, 2e-6]))
    made: Any = SimpleNamespace(
        curve=curve,
        resolved=np.array([[0.0, 1.0]]),
        map=found,
        motor=SimpleNamespace(motor=SimpleNamespace(cradle=SimpleNamespace(preload=20.0))),
        rest=SimpleNamespace(amplitude=1e-6),
    )
    assert "no-load speed (mm/s)" in words(map_figure(made))
    assert f"Stalls at {curve[0].force:.3g} N" in words(speed_force_figure(made))


def test_a_step_of_force_says_how_near_it_ends() -> None:
    time = np.linspace(1e-3, 4e-3, 4)
    wanted, force = np.array([1.0, 1.0, 2.0, 2.0]), np.array([0.5, 1.0, 1.5, 1.96])
    tracked = TrackedForce(time, wanted, force, 1e-6 * force, 10 * force, 0)
    found: Any = SimpleNamespace(tracked=tracked)
    assert "ends 2 % from the force" in words(force_step_figure(found))


def test_the_way_in_the_plane_is_drawn() -> None:
    moved = simulate_plane(motor(), WORKING, periods=20, steps=32)
    found: Any = SimpleNamespace(plane=moved)
    said = words(plane_figure(found))
    assert "sideways (µm)" in said
    assert f"ends at {1e3 * moved.final_velocity[0]:.3g} mm/s along" in said


def test_the_force_over_frequency_has_gaps_where_feet_stand_on_nodes() -> None:
    forces, frequencies = (0.5, 2.0, 1.0), (29e3, None, 31e3)
    tuned = [
        SimpleNamespace(force=force, working=SimpleNamespace(frequency=frequency))
        for force, frequency in zip(forces, frequencies, strict=True)
    ]
    found: Any = SimpleNamespace(
        motor=SimpleNamespace(resonance_frequency=30e3), tuned=tuned,
        shifts=np.array([-1e-3, 0.0, 1e-3]), shifted=[tuned[0], None, tuned[2]],
    )  # fmt: skip
    left, right = tuning_figure(found).axes
    x, y = left.lines[0].get_data()
    # Without a frequency of its own, a motor runs at its resonance.
    assert (list(x), list(y)) == ([29, 30, 31], list(forces))
    x, y = right.lines[0].get_data()
    assert list(x) == [-1, 0, 1]
    assert np.isnan(y).tolist() == [False, True, False]


@pytest.mark.parametrize(
    ("more", "names"),
    [
        ({"plane": None, "tracked": None}, []),
        ({"plane": object(), "tracked": object()}, ["plane", "force-step"]),
    ],
)
def test_the_page_has_a_figure_of_all_that_was_computed(
    more: dict[str, Any], names: list[str]
) -> None:
    figures = [figure.key for figure in MOTOR_FIGURES if figure.has(SimpleNamespace(**more))]
    always = ["speed-force", "map", "frequency-and-place"]
    assert figures == [*always, *names]
