"""A drawing on its paper: of its size, with the lines that the description has."""

from __future__ import annotations

import math

import pytest
from matplotlib.patches import Circle, Polygon

from squeezefilm.core.formats.drawing import Drawing, Layer
from squeezefilm.core.kit.sheet import pdf, sheet_figure, views_figure

pytestmark = pytest.mark.usefixtures("figures_as_described")

LAYERS = {"BODY": Layer(45, fill="own"), "HOLES": Layer(7, fill="paper"), "LINES": Layer(1)}


@pytest.fixture(scope="module")
def drawing() -> Drawing:
    made = Drawing(LAYERS, 2.0, corner=(-20e-3, -20e-3), views=(0.0, 0.1, 0.2, 0.29))
    made.rectangle("BODY", 0.0, 0.0, 83e-3, 49e-3)
    made.line("LINES", ((0.0, 0.0), (1e-3, 1e-3)))
    made.arc("HOLES", 10e-3, 10e-3, 3e-3)
    made.arc("LINES", 10e-3, 10e-3, 5e-3, 0.0, math.pi / 2)
    made.dimension((0.0, 0.0), (83e-3, 0.0), -5e-3, (41e-3, -3.5e-3), prefix="⌀")
    made.dimension((0.0, 0.0), (0.0, 1e-3), -5e-3, (-7e-3, 1e-3), upright=True)
    made.ordinate(12e-3, 0.0, -8e-3)
    made.ordinate(0.0, 12e-3, 90e-3, upright=True)
    made.text("words and $dollars$", 1e-3, 60e-3)
    return made


def test_the_figure_has_the_papers_size_and_the_scale(drawing: Drawing) -> None:
    figure = sheet_figure(drawing)
    assert 25.4 * figure.get_size_inches() == pytest.approx([420.0, 297.0])
    (axes,) = figure.axes
    assert axes.get_xlim() == pytest.approx((-20.0, 190.0))
    body = next(one for one in axes.patches if isinstance(one, Polygon))
    corners = axes.transData.transform(body.get_xy()) / figure.dpi * 25.4
    # 83 mm at 2:1 on paper.
    assert corners[1, 0] - corners[0, 0] == pytest.approx(166.0)
    assert any(isinstance(one, Circle) for one in axes.patches)
    said = {one.get_text() for one in axes.texts}
    assert {"⌀83", "1", "12", "words and $dollars$"} <= said


def test_the_views_alone_are_a_window_of_it(drawing: Drawing) -> None:
    figure = views_figure(drawing)
    assert 25.4 * figure.get_size_inches() == pytest.approx([200.0, 190.0])
    assert figure.axes[0].get_ylim() == pytest.approx((30.0, 125.0))


def test_a_pdf_has_the_papers_size_and_no_moment(drawing: Drawing) -> None:
    data = pdf(sheet_figure(drawing))
    assert data.startswith(b"%PDF")
    assert b"CreationDate" not in data
    # In points of 1/72 inch.
    assert b"/MediaBox [ 0 0 1190.55" in data
