"""Pictures of study pages: the same by one process and by two, and those a result has."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from squeezefilm.core import second_process
from squeezefilm.core.kit import style
from squeezefilm.core.kit.page_style import STYLE, FigureOf, picture_sections
from squeezefilm.study.report.pictures import pictures, png_files
from squeezefilm.study.report.simulated_page import load_drawing

pytestmark = pytest.mark.usefixtures("figures_as_described")

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def drawing(result: float, key: str) -> Figure:
    """A figure that says its key and what it shows."""
    figure = style.new_figure(f"{key} is {result:g}", "made up", 2.0)
    figure.subplots().plot([0.0, result])
    return figure


def never(_: Any) -> Figure:
    """Drawn by the key alone."""
    raise AssertionError


FIGURES = (
    FigureOf("first", "The first", never),
    FigureOf("second", "The second", never, file="other"),
    FigureOf("third", "The third", never, has=lambda result: result > 5),
)


def test_a_result_has_its_pictures_by_the_names_of_their_files() -> None:
    found = pictures(drawing, FIGURES, 4.0, "study-")
    assert list(found) == ["study-first", "study-other"]
    heading, picture = found["study-other"]
    assert (heading, picture.message) == ("The second", "second is 4")
    assert picture.png.startswith(b"\x89PNG")
    assert list(png_files(found)) == ["study-first.png", "study-other.png"]
    assert 'alt="first is 4"' in picture_sections(found)
    # On a narrow screen a picture is scrolled sideways rather than too small to read.
    assert picture_sections(found).count('<figure class="scroll" tabindex="0"><img ') == 2
    assert ".scroll img { min-width: 36rem; }" in STYLE
    assert list(pictures(drawing, FIGURES, 6.0)) == ["first", "other", "third"]


@pytest.mark.slow
def test_two_processes_draw_what_one_draws(monkeypatch: pytest.MonkeyPatch) -> None:
    alone = pictures(drawing, FIGURES, 6.0)
    monkeypatch.setattr(second_process, "_processors", lambda: 2)
    with second_process.second_process(load_drawing) as is_there:
        assert is_there
        assert pictures(drawing, FIGURES, 6.0) == alone
