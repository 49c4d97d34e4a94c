"""What a task may ask of gratings, shapes and maps, and what is refused with a way out."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import pytest
from PIL import Image as Picture

from squeezefilm.core.config.load import load_text
from squeezefilm.core.config.schema import text_of
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.physics.render.texture.shapes import Band
from squeezefilm.study.design.plan import plan_study
from squeezefilm.study.design.study_design import StudyDesign, load_design
from squeezefilm.study.design.trials import trials

DISC = Stimulus("disc", pattern=Band.disc(0.02, 0.02, 0.008))
BARS = Stimulus("bars", pattern=Band(0.01, 0.03))
CHECKS = Stimulus("checks", 4e-3, "period", crossed_period=8e-3)


def shapes(**change: Any) -> StudyDesign:
    """Three surfaces of two dimensions, to be named."""
    given: dict[str, Any] = {
        "name": "shapes",
        "title": "",
        "displays": ("biet2008-plate",),
        "task": "match-to-sample",
        "stimuli": (DISC, BARS, CHECKS),
        "matched_with": "stimuli",
        "exploring": "free",
        "familiarisation": 1,
    }
    return StudyDesign(**{**given, **change})


def test_the_stimuli_are_the_answers_and_each_is_its_own() -> None:
    design = shapes()
    assert design.answers == ("disc", "bars", "checks")
    assert [design.answer_to(one) for one in design.stimuli] == list(design.answers)
    assert design.spoken_question == "Which of the surfaces was it?"
    first = trials(design, 0, 1)
    assert {one.stimuli[0] for one in first if not one.asks} == set(design.answers)
    assert all(set(one.alternatives) == set(design.answers) for one in first if one.asks)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"stimuli": (DISC,)}, "two or more stimuli"),
        ({"task": "magnitude-estimation"}, "is for match-to-sample"),
        ({"matched_with": "real gratings"}, 'say matched_with = "stimuli"'),
        (
            {"task": "magnitude-estimation", "matched_with": "real gratings"},
            "'disc' .pattern: band. has no spatial_period",
        ),
    ],
)
def test_what_does_not_fit_is_refused(change: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=says):
        shapes(**change)


def test_depths_of_shapes_are_amounts_and_periods_are_not() -> None:
    deep = shapes(
        task="magnitude-estimation", matched_with="real gratings", judged="friction_depth"
    )
    assert [deep.judged_value(one) for one in deep.stimuli] == pytest.approx([0.3] * 3)
    assert math.isnan(shapes().judged_value(DISC))


def test_a_picture_beside_the_design_is_read_kept_and_known_by_its_pixels(tmp_path: Path) -> None:
    Picture.new("L", (4, 3), 255).save(tmp_path / "map.png")
    (tmp_path / "maps.toml").write_text(
        'name = "maps"\ntitle = ""\ntask = "same-different"\nexploring = "free"\n'
        'displays = ["biet2008-plate"]\nreference = "map"\n'
        '[[stimuli]]\nname = "map"\n'
        'pattern = { type = "image_file", file = "map.png", pixel = "10 mm" }\n'
        '[[stimuli]]\nname = "flat"\nwaveform = "constant"\n'
    )
    design = load_design(tmp_path / "maps.toml")
    values = design.stimuli[0].surface()(0.01, 0.01, 0.1, 0.0)
    assert values == pytest.approx(1.0)
    again = load_text(StudyDesign, text_of(design))
    assert again == dataclasses.replace(design, provenance={})
    Picture.new("L", (4, 3), 254).save(tmp_path / "map.png")
    other = load_design(tmp_path / "maps.toml")
    assert other.stimuli[0].surface_sha256 != design.stimuli[0].surface_sha256
    assert other.sha256 != design.sha256
    (tmp_path / "map.png").unlink()
    with pytest.raises(ConfigError, match="maps"):
        load_design(tmp_path / "maps.toml")


def test_a_texture_that_is_not_there_is_told_when_planning() -> None:
    with pytest.raises(ConfigError, match="nowhere"):
        plan_study(shapes(stimuli=(DISC, Stimulus("lost", texture="nowhere.toml"))))


def test_the_preset_plans_six_surfaces_with_their_identity() -> None:
    plan = plan_study("shapes-match", participants=2)
    listed = plan.summary()["stimuli"]
    assert len({one["surface_sha256"] for one in listed}) == len(listed) == 6
    assert listed[2]["second_period_m"] == 4e-3
    assert listed[4]["spatial_period_m"] is None
    assert listed[5]["surface"] == "texture island-map"
    assert plan.balanced_participants == 1
