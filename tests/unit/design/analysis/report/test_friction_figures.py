"""The figure of friction: curves, marks and words against numbers written down by hand."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.colors import to_hex
from tests.unit.drawn import labelled, words
from tests.unit.made_curves import GRID, made, point

from squeezefilm.core.kit.model_looks import look_of
from squeezefilm.core.kit.style import BAND
from squeezefilm.design.analysis.curves import measured_on_like
from squeezefilm.design.analysis.report.figures import own_friction

pytestmark = pytest.mark.usefixtures("figures_as_described")


def test_the_own_model_is_drawn_within_its_band() -> None:
    band = SimpleNamespace(
        amplitude=GRID[:4], low=np.array([1, 0.5, 0.2, 0.1]), high=np.array([1, 0.9, 0.8, 0.7]),
        level=0.9,
    )  # fmt: skip
    unsure = SimpleNamespace(
        interval=(0.2, 0.8), level=0.9, sentence="µ′/µ = 0.81 as described (0.20–0.80)"
    )
    figure = own_friction(made(band=band, uncertainty=unsure))
    axes = figure.axes[0]
    drawn = labelled(axes)
    assert list(drawn) == [
        "90 % of what it may be at an amplitude",
        "on polished (roughness 1.5 µm)", "on rough (roughness 1.5 µm)",
        "0.7: what the paper asks for", "this display: 0.81 (0.20–0.80, 90 % interval) at 2 µm",
        "measured on like plates: 4 curves, all on glass",
    ]  # fmt: skip
    area, own, other, *_ = drawn.values()
    assert to_hex(area.get_facecolor()[0]) == BAND
    assert area.get_paths()[0].vertices[:, 0].max() == pytest.approx(3)
    assert {to_hex(one.get_color()) for one in (own, other)} == {look_of("paper2008").color}
    assert own.get_linewidth() > other.get_linewidth()
    bar = next(one for one in axes.get_lines() if list(one.get_ydata()) == [0.2, 0.8])
    assert bar.get_xdata() == pytest.approx([2, 2])
    assert axes.get_xlim() == pytest.approx((0, 3))
    title = "How far friction falls with the amplitude: for 0.7 it takes 2.4 µm"
    assert words(figure.get_suptitle()) == title
    alone = own_friction(made())
    assert len(labelled(alone.axes[0])) == 5


def test_dots_are_published_measurements_on_like_plates() -> None:
    drawn = labelled(own_friction(made()).axes[0])
    dots = drawn["measured on like plates: 4 curves, all on glass"]
    # The smallest amplitude of the first person, over the friction at rest of its own line.
    assert dots.get_ydata()[0] < 1.05
    strong = made(prediction=point(normal_force=5.0))
    assert not any("measured" in name for name in labelled(own_friction(strong).axes[0]))


@pytest.mark.parametrize(
    ("frequency", "force", "curves"),
    [
        (30e3, 0.5, 4),
        (46e3, 0.5, 0),
        (44e3, 0.5, 1),
        (30e3, 0.7, 2),
        (30e3, 2.5, 0),
        (19e3, 0.5, 0),
    ],
)
def test_like_is_near_in_frequency_and_force(frequency: float, force: float, curves: int) -> None:
    like = measured_on_like(point(frequency=frequency, normal_force=force))
    assert len(like) == curves
    assert all("glass" in one.told.name for one in like)
