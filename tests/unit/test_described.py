"""Descriptions of figures: what changes is told, looks are not, and no figure is without one."""

from __future__ import annotations

import ast
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from tests.unit.described import Descriptions, described, difference, drawn_figures

from squeezefilm.core.kit import style

ROOT = Path(__file__).parents[2]


def figure(scale: float = 1.0, **look: object) -> Figure:
    with style.rc():
        made = style.new_figure("a title", "a model", 3.0)
        axes = made.subplots()
        x = np.linspace(0, 2, 100)
        axes.plot(x, scale * np.sin(x), **{"color": style.BLUE, "label": "a sine", **look})
        axes.bar([0, 1], [0.5, 0.25], width=0.5, color=style.BAND)
        axes.set(xlabel="along", ylim=(0, 1))
        axes.legend()
    return made


def test_a_description_can_be_read() -> None:
    said = described("draw", figure())
    assert said.startswith("draw: a title\n9.6 × 3 inches\nsmall print: Model: a model\n")
    assert '  y "" 0 … 1 linear\n' in said
    assert '  line "a sine", blue -: x #100 from 0 to 2 over 2, 0.000 … 1.000, ' in said
    bars = "x -0.25, 0.25, 0.25, -0.25, -0.25, 0.75, 1.25, 1.25, 0.75, 0.75"
    assert f"  #2 × Rectangle, band: {bars}; y 0, 0, 0.5, 0.5, 0, 0, 0, 0.25, 0.25, 0\n" in said
    assert "  legend in #1, a sine\n" in said


def test_a_changed_number_colour_or_word_is_told_and_looks_are_not() -> None:
    before = described("draw", figure())
    assert difference(before, described("draw", figure(lw=7, alpha=0.5))) == ""
    assert difference(before, described("draw", figure(1.0001))) == ""
    for other in (figure(1.01), figure(color=style.ORANGE), figure(ls="--"), figure(label="one")):
        assert difference(before, described("draw", other)).startswith("line 7: described was\n")
    assert "line 10: described was\n  \n" in difference(before, f"{before}  one more\n")


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        ("x 10", "x 10.01", True),
        ("x 10", "x 10.1", False),
        ("x 0.001", "x 0.002", True),  # of shares that are written with three digits
        ("#1000 lines", "#1001 lines", False),
        ("x −3", "x 3", False),
    ],
)
def test_what_is_the_same_number(one: str, other: str, same: bool) -> None:
    assert (difference(one, other) == "") == same


def test_figures_are_kept_once_and_the_most_similar_one_is_told(tmp_path: Path) -> None:
    file = tmp_path / "figures.txt"
    assert Descriptions(file).difference("a\n") == "figures.txt describes no figure"
    for now in ("a\nb\n", "c\nd\n", "a\nb\n"):
        Descriptions(file).add(now)
    assert file.read_text(encoding="utf-8") == "a\nb\n\nc\nd\n"
    assert Descriptions(file).difference("c\nd\n") == ""
    assert Descriptions(file).difference("c\ne\n").startswith("line 2: described was\n  d\n")


def test_it_is_known_who_draws() -> None:
    with drawn_figures() as figures:
        one = figure()
        style.message_figure("none", "nothing to draw")
    assert [figures[0], figures[1][0]] == [("a test", one), "a test"]


def test_every_function_that_draws_is_drawn_by_a_quick_test() -> None:
    drawing = set()
    for file in (ROOT / "src" / "squeezefilm").rglob("*.py"):
        text = file.read_text(encoding="utf-8")
        if "@style.drawn" in text:
            module = ".".join(file.relative_to(ROOT / "src" / "squeezefilm").with_suffix("").parts)
            drawing |= {
                f"{module}.{node.name}"
                for node in ast.parse(text).body
                if isinstance(node, ast.FunctionDef)
                and any(ast.unparse(one) == "style.drawn" for one in node.decorator_list)
            }
    known = {
        line.partition(":")[0]
        for file in (ROOT / "tests" / "unit").rglob("test_*.txt")
        for line in file.read_text(encoding="utf-8").splitlines()
    }
    assert len(drawing) > 60
    assert sorted(drawing - known) == []
