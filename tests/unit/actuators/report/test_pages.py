"""Pages of actuators: everything is in its folder, nothing from elsewhere."""

from __future__ import annotations

import itertools
import json
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from matplotlib.text import Text
from tests.shared import shared

from squeezefilm.actuators.analysis.drawn import DrawnAnswers
from squeezefilm.actuators.described import is_actuator
from squeezefilm.actuators.report import motor, skin_stretch
from squeezefilm.actuators.report.page import AnalyzedActuator, analyze_actuator, assumed_words
from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.errors import ConfigError
from squeezefilm.core.kit import style
from squeezefilm.core.kit.page_style import drawn_figures

NAMES = ("biet2008-motor", "biet2008-skin-stretch")
KINDS = {
    "biet2008-motor": motor.MOTOR_FIGURES,
    "biet2008-skin-stretch": skin_stretch.SKIN_STRETCH_FIGURES,
}


@pytest.fixture(scope="module", params=NAMES)
def analyzed(request: pytest.FixtureRequest) -> AnalyzedActuator:
    return shared(request.param, lambda: analyze_actuator(request.param))


@pytest.mark.slow
def test_all_that_a_page_shows_lies_beside_it(analyzed: AnalyzedActuator, tmp_path: Path) -> None:
    assert analyzed.figures is KINDS[analyzed.analysis.described.name]
    page = analyzed.write(tmp_path / "out")
    said = page.read_text(encoding="utf-8")
    pictures = re.findall(r'<img src="([^"]+)" alt="([^"]+)"', said)
    assert len(pictures) >= 3
    for name, _ in pictures:
        assert (page.parent / name).stat().st_size > 5000
    assert "http" not in said.replace("http-equiv", "")
    assert "the share of each spread that follows it" in said
    told = json.loads((page.parent / "result.json").read_text(encoding="utf-8"))
    assert told["stamp"]["squeezefilm_version"]
    assert told["actuator"] == analyzed.analysis.described.name


@pytest.mark.slow
def test_no_text_lies_on_another_or_is_cut_off(analyzed: AnalyzedActuator) -> None:
    drawn = drawn_figures(analyzed.figures, analyzed.analysis)
    assert len(drawn) >= 3
    for name, (_, figure) in drawn.items():
        boxes: dict[str, Any] = {}
        with style.rc():
            figure.draw_without_rendering()
        # Ticks beyond an axis's ends are there and not drawn.
        ticks = {
            id(label)
            for axes in figure.axes
            for axis in (axes.xaxis, axes.yaxis)
            for label in axis.get_ticklabels(which="both")
        }
        for text in figure.findobj(Text):
            if text.get_visible() and text.get_text().strip() and id(text) not in ticks:
                box = text.get_window_extent()
                boxes[f"{text.get_text()} {box.x0:.0f} {box.y0:.0f}"] = box
        for one, other in itertools.combinations(boxes, 2):
            assert not boxes[one].overlaps(boxes[other]), (name, one, other)
        for text, box in boxes.items():
            assert figure.bbox.x0 <= box.x0 + 1, (name, text)
            assert box.x1 <= figure.bbox.x1 + 1, (name, text)


@pytest.mark.slow
def test_the_terminal_says_what_is_assumed(
    analyzed: AnalyzedActuator, capsys: pytest.CaptureFixture[str]
) -> None:
    analyzed.show()
    said = " ".join(capsys.readouterr().out.split())
    assert "values with a source are assumed" in said
    assert analyzed.analysis.described.name in said


def test_how_many_are_assumed() -> None:
    known = {"a": Provenance("x", "assumed"), "b": Provenance("y", "measured")}
    assert assumed_words(known).startswith("1 of 2 values")


def test_an_actuator_is_told_by_its_table(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text('name = "a"\n[motor]\nslider_mass = "1 g"\n', encoding="utf-8")
    assert is_actuator(file)
    file.write_text('name = "a"\n[actuator]\n# [motor]\n', encoding="utf-8")
    assert not is_actuator(file)
    assert all(is_actuator(name) for name in NAMES)
    assert not is_actuator("biet2008-plate")
    assert not is_actuator(tmp_path / "absent.toml")


def test_a_file_that_is_wrong_is_refused_with_its_line(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    file.write_text('name = "a"\ntitle = "b"\n[motor]\nslider_mass = "1 V"\n', encoding="utf-8")
    with pytest.raises(ConfigError, match="line 4"):
        analyze_actuator(file)


def test_a_page_shows_what_it_is_given(tmp_path: Path) -> None:
    made: Any = SimpleNamespace(
        described=SimpleNamespace(title="A <motor>", name="mine", provenance={}),
        summary=lambda: {"thrust_N": 1.5},
        warnings=("it is warm",),
        drawn=DrawnAnswers({"force": (1.0, 1.5, 2.0)}, {"force": ()}, 64, 0, "", 7, ()),
    )
    numbers = [("Thrust", "1.5 N", "at rest")]
    answers = {"force": "stall force"}
    path = AnalyzedActuator(made, lambda _: numbers, (), answers).write(tmp_path / "out")
    said = path.read_text(encoding="utf-8")
    for text in ("A &lt;motor&gt;", "it is warm", "Thrust", "at rest", "of the stall force"):
        assert text in said
    told = json.loads((path.parent / "result.json").read_text(encoding="utf-8"))
    assert told["thrust_N"] == 1.5
