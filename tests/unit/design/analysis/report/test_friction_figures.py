"""The figure of friction: curves, marks and words against numbers written down by hand."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.colors import to_hex
from tests.unit.drawn import labelled, words
from tests.unit.made_curves import GRID, made

from squeezefilm.core.kit.model_looks import look_of
from squeezefilm.core.kit.style import BAND
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
        "90 % of what the friction may be at an amplitude",
        "as described, on polished (roughness 1.5 µm)", "as described, on rough (roughness 1.5 µm)",
        "0.7: what the paper asks for", "this display: 0.81 (0.20–0.80, 90 % interval) at 2 µm",
    ]  # fmt: skip
    area, own, other, *_ = drawn.values()
    assert to_hex(area.get_facecolor()[0]) == BAND
    assert area.get_paths()[0].vertices[:, 0].max() == pytest.approx(3)
    assert {to_hex(one.get_color()) for one in (own, other)} == {look_of("paper2008").color}
    assert own.get_linewidth() > other.get_linewidth()
    bar = next(one for one in axes.get_lines() if list(one.get_ydata()) == [0.2, 0.8])
    assert bar.get_xdata() == pytest.approx([2, 2])
    assert axes.get_xlim() == pytest.approx((0, 3))
    assert words(figure.get_suptitle()) == (
        "At 2 µm on polished µ′/µ = 0.81 as described (0.20–0.80); 0.7 takes 2.4 µm"
    )
    alone = own_friction(made())
    assert words(alone.get_suptitle()) == "At 2 µm on polished µ′/µ = 0.81; 0.7 takes 2.4 µm"
    assert len(labelled(alone.axes[0])) == 4
