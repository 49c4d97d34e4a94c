"""A case of the golden programs is made as those that are stored were."""

import json
from pathlib import Path

import pytest

import golden_program
from squeezefilm.core.errors import InputError
from squeezefilm.physics.texture_files.texture_file import load_texture

SAMPLES = json.loads(golden_program.STORED.read_text("utf-8"))["cases"][0]["samples"]


def test_a_case_holds_a_program_and_what_it_gives() -> None:
    case = golden_program.golden_case("new", load_texture("pulse").texture, SAMPLES)
    assert set(case) == {"name", "program", "samples", "amplitude", "flags"}
    assert len(case["amplitude"]) == len(case["flags"]) == len(SAMPLES)
    assert max(case["amplitude"]) <= golden_program.LARGEST_AMPLITUDE


def test_it_is_appended_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stored = tmp_path / "golden.json"
    before = golden_program.STORED.read_text("utf-8")
    stored.write_text(before, "utf-8")
    monkeypatch.setattr(golden_program, "STORED", stored)
    monkeypatch.setattr("sys.argv", ["golden_program", "a pulse", "pulse"])
    golden_program.main()
    assert stored.read_text("utf-8").startswith(before[:-2])
    assert json.loads(stored.read_text("utf-8"))["cases"][-1]["name"] == "a pulse"
    with pytest.raises(SystemExit):
        golden_program.main()


def test_friction_has_no_amplitude_without_a_plate() -> None:
    with pytest.raises(InputError, match="amplitudes"):
        golden_program.golden_case("no", load_texture("biet2008-square-2mm").texture, SAMPLES)
