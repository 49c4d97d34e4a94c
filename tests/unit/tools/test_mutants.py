"""The runner of mutants: nearest tests first, answers outlast a cut, the source is not changed."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

import mutants

ROOT = Path(__file__).parents[3]


@pytest.mark.slow
def test_the_tests_of_a_module_come_first_then_those_that_name_it() -> None:
    nearness = mutants.Nearness(ROOT)
    files = nearness.tests("squeezefilm.physics.film.gap")
    assert files[0] == "tests/unit/physics/film/test_gap.py"
    named = ["squeezefilm.physics.film.gap" in nearness.texts[name] for name in files]
    assert named == sorted(named, reverse=True)
    assert 0 < len(files) < len(nearness.texts)
    assert "tests/e2e/test_plate_cli.py" in nearness.tests("squeezefilm.physics.plate.ring.body")


def test_a_line_that_was_cut_off_is_asked_again(tmp_path: Path) -> None:
    path = tmp_path / "mutants.jsonl"
    path.write_text('{"type": "run", "seed": 1}\n{"type": "mutant", "id": "a"}\n{"type": "mut')
    assert [line.get("id") for line in mutants.read_lines(path)] == [None, "a"]
    with pytest.raises(SystemExit, match="name another file"):
        mutants.Report(path, {"seed": 2})


def test_the_name_of_a_failed_test_may_hold_blanks_and_dashes() -> None:
    asked = ["t.py::test_a[x]", "t.py::test_a[x] - y z]", "t.py::test_b"]
    assert mutants.failed_test("t.py::test_a[x] - AssertionError", asked) == asked[0]
    assert mutants.failed_test("t.py::test_a[x] - y z] - no - none", asked) == asked[1]
    assert mutants.failed_test("t.py::test_b", asked) == asked[2]
    # Where a file was asked, what stands before the message.
    assert mutants.failed_test("t.py::test_c[a b] - E", ["t.py"]) == "t.py::test_c[a b]"


def test_every_equivalent_mutant_has_a_reason() -> None:
    assert all(len(reason) > 20 for reason in mutants.equivalent_mutants().values())


@pytest.mark.nightly
def test_a_run_finds_what_survives_and_leaves_the_source_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    root = tmp_path / "project"
    files = {
        "src/squeezefilm/__init__.py": '"""A package."""\n',
        "src/squeezefilm/core/quantities/units.py": "",
        "tests/costs.py": (ROOT / "tests" / "costs.py").read_text(),
        "src/squeezefilm/gap.py": "def half(a: int) -> float:\n    b = a + 0\n    return b / 2\n"
        "\n\ndef seven() -> int:\n    return 7\n",
        # What a failing test logged stands as ERROR before the summary.
        "tests/unit/test_gap.py": "import logging\nimport os\n"
        "from squeezefilm.gap import half, seven\n\n\n"
        "def test_half():\n    logging.error('no test')\n    assert half(0) == 0\n"
        "    assert half(4) == 2\n\n\n"
        # Nobody says which test it was that ended the process.
        "def test_seven():\n    seven() == 7 or os._exit(9)\n",
    }
    for name, text in files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    for command in (["init", "-q"], ["add", "-A"], ["commit", "-qm", "a"]):
        who = ["-c", "user.name=a", "-c", "user.email=a@example.org"]
        subprocess.run(["git", *who, *command], cwd=root, check=True)
    answers, work = tmp_path / "answers.jsonl", tmp_path / "work"
    monkeypatch.setattr(mutants, "ROOT", root)
    words = ["--file", str(answers), "--work", str(work)]
    monkeypatch.setattr(sys, "argv", ["mutants.py", *words, "--count", "12"])
    mutants.main()
    lines = [json.loads(line) for line in answers.read_text().splitlines()]
    found = {(line["before"], line["after"]): line for line in lines if line["type"] == "mutant"}
    assert found["/", "*"]["noticed"]
    assert found["/", "*"]["test"] == "tests/unit/test_gap.py::test_half"
    assert found["2", "3"]["noticed"]
    assert found["0", "1"]["noticed"]
    assert found["7", "8"]["noticed"]
    assert found["7", "8"]["test"] == ""
    assert not found["+", "-"]["noticed"]  # a + 0 is a - 0
    assert "noticed, but for ties: 6 of 7" in capsys.readouterr().out
    assert (work / "tree/src/squeezefilm/gap.py").read_text() == files["src/squeezefilm/gap.py"]
    # A second run has nothing left to ask.
    before = answers.read_text()
    mutants.main()
    assert answers.read_text() == before
