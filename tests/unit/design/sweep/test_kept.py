"""Answers kept under what was asked: the same question finds them, another does not."""

import dataclasses
import json
import math
from pathlib import Path

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.design.sweep import points
from squeezefilm.design.sweep.points import FILE, Answer, KeptAnswers, Point, address
from squeezefilm.physics.display import load_display
from squeezefilm.physics.uncertainty.parameters import with_values

STATOR = load_display("biet2008-stator")
POINT = Point(STATOR, {"voltage": 20.0, "texture": "sine-3mm"}, "predict")


def test_an_address_is_of_all_that_the_answer_depends_on_and_nothing_else(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    own = address(POINT)
    thicker = with_values(STATOR, {"actuator.radial_width": 11e-3})
    others = {
        address(dataclasses.replace(POINT, display=thicker)),
        address(dataclasses.replace(POINT, options={"voltage": 21.0})),
        address(dataclasses.replace(POINT, verb="friction")),
        address(dataclasses.replace(POINT, verb="friction", samples=32)),
    }
    assert len(others | {own}) == 5
    # A texture moves no prediction, and a prediction draws no samples.
    assert own == address(dataclasses.replace(POINT, options={"voltage": 20.0}, samples=32))
    assert own == address(dataclasses.replace(POINT, display=load_display("biet2008-stator")))
    known: dict[object, object] = {}
    assert own == address(POINT, known)
    assert own == address(POINT, known)
    monkeypatch.setattr(points, "computed_by", lambda: "another code")
    assert address(POINT) != own


def test_a_file_that_was_edited_is_another_question(tmp_path: Path) -> None:
    """Of a texture and of a motion; the same content has the same address, wherever it lies."""
    texture, motion = tmp_path / "mine.toml", tmp_path / "path.csv"

    def written(period: str, end: float) -> Point:
        pattern = f'pattern = {{ type = "square_wave", spatial_period = "{period}" }}'
        levels = "low = 0.5\nhigh = 0.9\n"
        texture.write_text(f'[texture]\ntype = "relative_friction"\n{levels}{pattern}\n')
        motion.write_text(f"time_s,x_m\n0,0\n1,{end}\n")
        return Point(STATOR, {"texture": str(texture), "motion": str(motion)}, "render")

    own = address(written("2 mm", 0.04))
    assert address(written("3 mm", 0.04)) != own
    assert address(written("2 mm", 0.05)) != own
    assert address(written("2 mm", 0.04)) == own
    known: dict[object, object] = {}
    again = written("2 mm", 0.04)
    assert address(again, known) == own
    texture.unlink()
    # Read once a run.
    assert address(again, known) == own


def test_answers_are_there_again_and_a_line_that_was_cut_off_is_not(tmp_path: Path) -> None:
    first = KeptAnswers(tmp_path / "new")
    answer = Answer({"a_m": 1 / 3, "b": math.nan}, ("careful",), "", 0.5, modes={"modes": []})
    first.add("one", POINT, answer)
    first.add("two", POINT, Answer({}, reason="no"))
    first.add("three", POINT, Answer({}, reason="a fault", lasting=False))
    assert len(first) == 3
    file = tmp_path / "new" / FILE
    with file.open("a") as there:
        there.write('{"address": "four", "numb')
    again = KeptAnswers(tmp_path / "new")
    assert len(again) == 2
    found = again.get("one")
    assert found is not None
    assert found.numbers["a_m"] == 1 / 3
    assert math.isnan(found.numbers["b"])
    assert (found.warnings, found.modes) == (("careful",), {"modes": []})
    assert again.get("three") is None
    # What follows a line that was cut off stands on its own.
    again.add("five", POINT, answer)
    assert json.loads(file.read_text().splitlines()[-1])["address"] == "five"
    assert len(KeptAnswers(tmp_path / "new")) == 3


def test_without_a_folder_they_are_in_memory_and_a_file_is_no_folder(tmp_path: Path) -> None:
    here = KeptAnswers(None)
    here.add("one", POINT, Answer({}))
    assert here.get("one") is not None
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="choose another folder"):
        KeptAnswers(tmp_path / "file")
