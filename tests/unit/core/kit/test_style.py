"""The style of figures: it holds within its context, is set once, and is undone."""

from __future__ import annotations

import io
import os
import re
import subprocess
import sys
from xml.etree import ElementTree

import matplotlib
import pytest
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from squeezefilm.core.kit import style

pytestmark = pytest.mark.usefixtures("figures_as_described")


def test_the_style_holds_within_another_and_is_undone() -> None:
    before = dict(matplotlib.rcParams.copy())
    with style.rc():
        within = matplotlib.rcParams["font.size"], matplotlib.rcParams["axes.linewidth"]
        with style.rc():
            assert matplotlib.rcParams["font.size"] == within[0]
        # The inner one undoes nothing of the outer one.
        assert (matplotlib.rcParams["font.size"], matplotlib.rcParams["axes.linewidth"]) == within
        assert within == (10.5, 0.8)
    assert dict(matplotlib.rcParams.copy()) == before


@pytest.mark.slow
def test_a_figure_loads_no_user_interface() -> None:
    """pyplot looks for windows and takes a third of a second."""
    code = (
        "import sys\n"
        "from squeezefilm.core.kit import style\n"
        "with style.rc():\n"
        "    figure = style.new_figure('title', 'model', 3.0)\n"
        "    figure.subplots().plot([0, 1], [1, 2])\n"
        "assert '<svg' in style.svg(figure, 'one', 'label')\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, env=os.environ.copy())


def _in_figure(figure: Figure, artist: Artist) -> tuple[float, float, float, float]:
    """Left, bottom, right, top of what is drawn, in shares of the figure."""
    box = artist.get_tightbbox()
    assert box is not None
    return tuple(box.transformed(figure.transFigure.inverted()).extents)


def _labelled(height: float) -> tuple[Figure, Axes]:
    """A figure with all that may stand around its axes."""
    with style.rc():
        figure = style.new_figure("A title " * 20, "a model " * 40, height)
        axes = figure.subplots()
        axes.plot([0, 1], [0, 1e5], label="a line")
        axes.plot([0, 1], [1e5, 0], label="another line")
        axes.set(xlabel="along", ylabel="up")
        style.micrometres_beside(axes, 10.0, "beside")
        style.legend_below(axes)
    return figure, axes


@pytest.mark.parametrize("height", [3.0, 4.4, 6.0])
def test_nothing_around_the_axes_overlaps_or_is_cut_off(height: float) -> None:
    figure, axes = _labelled(height)
    style.svg(figure, "one", "label")
    with style.rc():
        legend = axes.get_legend()
        assert legend is not None
        below = _in_figure(figure, legend)
        label = _in_figure(figure, axes.xaxis)
        whole = _in_figure(figure, axes)
        title, small = (
            _in_figure(figure, text)
            for text in figure.texts
            if text.get_text().startswith(("A title", "Model"))
        )
        assert small[3] < min(below[1], label[1])
        assert whole[3] < title[1] < title[3] < 1
        assert min(whole[:2]) > 0
        assert whole[2] < 1
        assert small[1] > 0


def test_every_name_in_a_drawing_has_its_prefix_and_every_reference_a_target() -> None:
    figure, axes = _labelled(4.4)
    axes.scatter([0.2, 0.4], [1e4, 2e4])
    text = style.svg(figure, "one", 'a "label" & more')
    assert 'aria-label="a &quot;label&quot; &amp; more"' in text
    names = set(re.findall(r'\bid="([^"]*)"', text))
    assert names
    assert all(name.startswith("one-") for name in names)
    used = re.findall(r'href="#([^"]*)"', text) + re.findall(r"url\(#([^)]*)\)", text)
    assert set(used) <= names
    assert "xlink:href" not in text
    ElementTree.fromstring(text.replace("<svg ", '<svg xmlns="http://www.w3.org/2000/svg" ', 1))


def test_a_png_is_drawn_once_and_leaves_the_figure_as_it_was() -> None:
    figure, axes = _labelled(3.0)
    counted: list[object] = []
    draw = axes.draw
    axes.draw = lambda renderer: (counted.append(renderer), draw(renderer))[1]  # type: ignore[method-assign]
    before = figure.dpi, figure.get_facecolor()
    made = style.png(figure, 50)
    assert len(counted) == 1
    assert (figure.dpi, figure.get_facecolor()) == before
    again, stream = _labelled(3.0)[0], io.BytesIO()
    with style.rc():
        again.savefig(stream, format="png", dpi=50, facecolor="white")
    assert made == stream.getvalue()


def test_micrometres_stand_beside_nanometres_per_volt() -> None:
    figure, axes = _labelled(3.0)
    figure.draw_without_rendering()
    (right,) = axes.child_axes
    low, high = axes.get_ylim()
    assert right.get_ylim() == pytest.approx((1e-2 * low, 1e-2 * high))
    assert right.get_ylabel() == "beside"
