"""A study of one's own, begun from a preset."""

from pathlib import Path

import pytest

from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.study.design.plan import new_study_file, plan_study
from squeezefilm.study.design.study_design import load_design


def test_a_new_study_is_the_preset_under_its_own_name_and_on_its_own_displays(
    tmp_path: Path,
) -> None:
    file = tmp_path / "my depths.toml"
    new_study_file(file, "friction-jnd", displays=("touchpad-glass", "winfield2007-tpad"))
    design, preset = load_design(file), load_design("friction-jnd")
    assert design.name == "my-depths"
    assert design.displays == ("touchpad-glass", "winfield2007-tpad")
    assert (design.stimuli, design.catch) == (preset.stimuli, preset.catch)
    assert plan_study(design, participants=1).doubts == ()
    new_study_file(file, "period-jnd", replace=True)
    assert load_design(file).displays == load_design("period-jnd").displays


def test_what_cannot_be_begun_is_refused_and_nothing_is_written(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    with pytest.raises(InputError, match="Did you mean 'friction-jnd'"):
        new_study_file(file, "friction-jn")
    with pytest.raises(ConfigError, match="neither a file nor a preset"):
        new_study_file(file, "friction-jnd", displays=("nothing",))
    assert not file.exists()
    file.write_text("mine")
    with pytest.raises(InputError, match="exists"):
        new_study_file(file, "friction-jnd")
    assert file.read_text() == "mine"
