"""What the terminal shows of a list of modes, and its figures."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import pytest
from tests.unit.printed import printed

from squeezefilm.design.plate.modes import ModeList, list_modes
from squeezefilm.design.plate.report.modes import (
    mode_list_rows,
    mode_list_sentences,
    pair_rows,
    shapes,
    show_mode_list,
    write_modes,
)
from squeezefilm.design.plate.ring_pair import PairAtSplit, RingPair
from squeezefilm.physics.display import load_display

pytestmark = pytest.mark.usefixtures("figures_as_described")


@pytest.fixture(scope="module")
def paper() -> ModeList:
    return list_modes(load_display("biet2008-plate"), (15e3, 45e3))


def test_the_displays_own_mode_is_marked_and_remarks_are_words(paper: ModeList) -> None:
    rows = mode_list_rows(paper)
    assert len(rows) == len(paper.modes)
    (own,) = [row for row in rows if row[0].startswith("→")]
    assert own[0] == "→ (8,0)"
    assert own[-1] == "nodal_lines = 8"
    assert rows[0][-1] == "audible, nodal_lines = 6"
    assert any("hidden" in row[-1] for row in rows)
    lines = printed(lambda: show_mode_list(paper))
    assert any(line.startswith("→ (8,0)") for line in lines)
    assert any(line.startswith("suggested Keep nodal_lines = 8, as described") for line in lines)
    assert lines[-1].endswith("the display's own mode is solved, mostly to 0.3 %")
    (said,) = [line for line in lines if "with the contribution of all other modes" in line]
    assert said.startswith(
        "(8,0) with the contribution of all other modes: 114.8 nm/V at its antinode ("
    )


def test_what_is_wrong_with_the_displays_mode_is_said(paper: ModeList) -> None:
    kinds = [kind for kind, _, _ in mode_list_sentences(paper)]
    assert kinds == ["symmetry", "symmetry", "suggested"]
    forbidden = dataclasses.replace(paper, forbidden="symmetry forbids (8,0): so it is")
    said = mode_list_sentences(forbidden)[-2]
    assert said[:2] == (
        "doubt",
        "The display asks for (8,0), and symmetry forbids (8,0): so it is.",
    )
    missing = dataclasses.replace(paper, working="(12,0)")
    assert "(12,0) is not in this list" in mode_list_sentences(missing)[-2][1]
    twice = dataclasses.replace(
        paper, modes=tuple(dataclasses.replace(mode, unique=False) for mode in paper.modes)
    )
    assert "More than one mode is labelled (8,0)" in mode_list_sentences(twice)[-2][1]


def test_a_pair_has_its_table(paper: ModeList) -> None:
    at = PairAtSplit(20.0, 0.2, 10.0, 0.099, 0.04)
    pair = RingPair("B(0,9)", 40.5e3, 200.0, 2e-6, 0.4, 300.0, (at,))
    assert pair_rows(pair) == [
        ("20 Hz (0.2 half-bandwidths)", "10", "9.9 %", "40 mm/s"),
    ]
    lines = printed(lambda: show_mode_list(dataclasses.replace(paper, pair=pair)))
    assert "One channel on the pair B(0,9)" in lines
    assert any("standing-wave ratio" in line for line in lines)


def test_numbers_are_written_without_figures_too(paper: ModeList, tmp_path: Path) -> None:
    # A ring has no shapes seen from above.
    write_modes(dataclasses.replace(paper, modes=(), screened=()), tmp_path)
    (file,) = tmp_path.iterdir()
    assert file.name == "modes.json"
    assert json.loads(file.read_text(encoding="utf-8"))["modes"] == []


def test_shapes_stand_in_the_order_of_frequency(paper: ModeList) -> None:
    titles = [axes.get_title(loc="left") for axes in shapes(paper).axes]
    shown = [float(title.split("  ")[1].split(" kHz")[0]) for title in titles if title]
    assert shown == sorted(shown)


@pytest.mark.slow
def test_figures_and_numbers_are_written(paper: ModeList, tmp_path: Path) -> None:
    assert write_modes(paper, tmp_path / "a") == tmp_path / "a"
    names = sorted(file.name for file in (tmp_path / "a").iterdir())
    assert names == ["modes.json", "shapes.png"]
    said = json.loads((tmp_path / "a" / "modes.json").read_text(encoding="utf-8"))
    assert len(said["modes"]) == len(paper.modes)
