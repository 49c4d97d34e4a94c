"""The figure of what compensation does: labelled, nothing cut off, the same each time."""

from __future__ import annotations

import itertools
from typing import Any

import pytest

from squeezefilm.analysis.textures import texture_survival
from squeezefilm.render.resonator.compensation import DrivenEnvelope
from squeezefilm.report.display import texture_figures
from squeezefilm.report.kit import style

PLATE = DrivenEnvelope(0.5687e-3, 0.5687e-3, 1.72e-6, braking=True)
STATOR = DrivenEnvelope(1.572e-3, 1.572e-3, 2e-6)


FIGURES = {
    "survival": lambda: texture_figures.texture_survival(texture_survival("biet2008-plate", PLATE)),
    "stator": lambda: texture_figures.texture_survival(texture_survival("biet2008-stator", STATOR)),
    "odd name": lambda: texture_figures.texture_survival(texture_survival("$x_1$ 漢", PLATE)),
}


@pytest.mark.parametrize("key", FIGURES)
def test_texts_are_inside_the_figure_and_apart_and_axes_labelled(key: str) -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    figure = FIGURES[key]()
    FigureCanvasAgg(figure)
    with style.rc():
        figure.canvas.draw()
        renderer = figure.canvas.get_renderer()
        width, height = figure.canvas.get_width_height()
        boxes = []
        for axes in figure.axes:
            if not axes.axison:
                legend = axes.get_legend()
                boxes.append(legend.get_window_extent(renderer))
                continue
            assert axes.get_xlabel() or not any(t.get_visible() for t in axes.get_xticklabels())
            boxes.append(axes.get_tightbbox(renderer))
        for text in (figure._suptitle, figure._supxlabel):
            boxes.append(text.get_window_extent(renderer))
    for box in boxes:
        assert box.x0 >= -1
        assert box.y0 >= -1
        assert box.x1 <= width + 1
        assert box.y1 <= height + 1
    for one, other in itertools.combinations(boxes, 2):
        apart = (
            one.x1 <= other.x0 + 2 or other.x1 <= one.x0 + 2
            or one.y1 <= other.y0 + 2 or other.y1 <= one.y0 + 2
        )  # fmt: skip
        assert apart, (key, one, other)


def test_the_titles_carry_the_numbers() -> None:
    def title(figure: Any) -> str:
        return str(figure.get_suptitle()).replace("\u00a0", " ").replace("\n", " ")

    figure = FIGURES["survival"]()
    said = [one.get_text() for one in figure.axes[0].get_legend().get_texts()]
    assert said[0] == "no compensation: 68 % of the fundamental"
    assert "up to 2.3 times the finger speed" in title(FIGURES["survival"]())


def test_drawn_twice_it_is_the_same() -> None:
    one, other = (style.svg(FIGURES["survival"](), "g", "label") for _ in range(2))
    assert one == other
