"""The runner of mutants: nearest tests first, answers outlast a cut, the source is not changed."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from coverage import CoverageData

import mutants
from mutation_sites import Site
from mutations import Mutant

ROOT = Path(__file__).parents[3]


def test_the_tests_of_a_module_come_first_then_those_that_name_it() -> None:
    nearness = mutants.Nearness(ROOT)
    files = nearness.tests("squeezefilm.film.gap")
    assert files[0] == "tests/unit/film/test_gap.py"
    named = ["squeezefilm.film.gap" in nearness.texts[name] for name in files]
    assert named == sorted(named, reverse=True)
    assert 0 < len(files) < len(nearness.texts)
    assert "tests/e2e/test_plate_cli.py" in nearness.tests("squeezefilm.plate.ring.stator")


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


SOURCE = b"""def least(
    values,
):
    found = min(
        values,
        default=1,
    )
    if found > 2:
        return found
"""


def mutant_at(line: int, before: str) -> Mutant:
    return Mutant("a", "squeezefilm/gap.py", line, before, Site("constant", "", 0, 0, ""))


def test_the_lines_of_a_mutant_begin_with_its_statement() -> None:
    assert mutants.lines_of(mutant_at(6, "1"), SOURCE) == range(4, 7)
    assert mutants.lines_of(mutant_at(8, "2"), SOURCE) == range(8, 9)
    assert mutants.lines_of(mutant_at(8, "if found > 2:\n        return found"), SOURCE) == range(
        8, 10
    )


def known(folder: Path, contexts: dict[str, list[int]], seconds: dict[str, float]) -> Path:
    """The two files that `make coverage` writes, in a folder; the first of them."""
    data = CoverageData(str(folder / "coverage"))
    for context, lines in contexts.items():
        data.set_context(context)
        data.add_lines({"/anywhere/src/squeezefilm/gap.py": lines})
    data.write()
    (folder / "test-seconds.json").write_text(json.dumps(seconds))
    return folder / "coverage"


def test_the_nearest_and_quickest_are_asked_for_so_much_processor_time(tmp_path: Path) -> None:
    seconds = {"far.py::a": 0.1, "near.py::a": 3.0, "near.py::b": 2.0, "near.py::c": 9.0}
    reached = mutants.Reached(known(tmp_path, {}, seconds))
    files = ["near.py", "far.py", "new.py"]
    assert reached.affordable(seconds, files, 5.0) == ["near.py::b", "near.py::a"]
    assert reached.affordable(seconds, files, 4.9) == ["near.py::b", "far.py::a"]
    # Of whole files the sum counts; what is not known counts as a second.
    assert reached.affordable(files, files, 13.9) == ["far.py", "new.py"]
    assert reached.affordable(files, files, 14.0) == ["near.py"]


def test_the_tests_that_run_a_line_are_told_from_a_file_of_coverage(tmp_path: Path) -> None:
    contexts = {"": [1], "tests/a.py::test_b[x|y]|run": [4, 8], "tests/a.py::test_c|run": [9]}
    reached = mutants.Reached(known(tmp_path, contexts, {}))
    assert reached.tests(mutant_at(6, "1"), SOURCE) == {"tests/a.py::test_b[x|y]"}
    assert reached.tests(mutant_at(9, "found"), SOURCE) == {"tests/a.py::test_c"}
    assert reached.tests(mutant_at(1, "least"), SOURCE) == set()


@pytest.mark.nightly
def test_a_run_finds_what_survives_and_leaves_the_source_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    root = tmp_path / "project"
    files = {
        "src/squeezefilm/__init__.py": '"""A package."""\n',
        "src/squeezefilm/quantities/units.py": "",
        "src/squeezefilm/gap.py": "def half(a: int) -> float:\n    b = a + 0\n    return b / 2\n",
        # What a failing test logged stands as ERROR before the summary.
        "tests/unit/test_gap.py": "import logging\nfrom squeezefilm.gap import half\n\n\n"
        "def test_half():\n    logging.error('no test')\n    assert half(0) == 0\n"
        "    assert half(4) == 2\n",
    }
    for name, text in files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    for command in (["init", "-q"], ["add", "-A"], ["commit", "-qm", "a"]):
        who = ["-c", "user.name=a", "-c", "user.email=a@example.org"]
        subprocess.run(["git", *who, *command], cwd=root, check=True)
    answers, work = tmp_path / "answers.jsonl", tmp_path / "work"
    monkeypatch.setattr(mutants, "ROOT", root)
    coverage = known(tmp_path, {"tests/unit/test_gap.py::test_half|run": [2]}, {})
    words = ["--file", str(answers), "--work", str(work), "--coverage", str(coverage)]
    monkeypatch.setattr(sys, "argv", ["mutants.py", *words, "--count", "9"])
    mutants.main()
    lines = [json.loads(line) for line in answers.read_text().splitlines()]
    found = {(line["before"], line["after"]): line for line in lines if line["type"] == "mutant"}
    assert found["/", "*"]["noticed"]
    assert found["/", "*"]["test"] == "tests/unit/test_gap.py::test_half"
    assert found["2", "3"]["noticed"]
    assert found["0", "1"]["noticed"]
    assert not found["+", "-"]["noticed"]  # a + 0 is a - 0
    assert "noticed: 4 of 5" in capsys.readouterr().out
    assert (work / "tree/src/squeezefilm/gap.py").read_text() == files["src/squeezefilm/gap.py"]
    # A second run has nothing left to ask.
    before = answers.read_text()
    mutants.main()
    assert answers.read_text() == before


def test_only_marked_files_are_asked_for_slow_tests() -> None:
    trial = mutants.Trial.__new__(mutants.Trial)
    trial._parts = [mutants.REALTIME, mutants.SLOW]
    trial._nearness = mutants.Nearness.__new__(mutants.Nearness)
    trial._nearness.texts = {"a.py": "", "b.py": "@pytest.mark.realtime", "c.py": ""}
    assert list(trial._questions(["a.py", "b.py", "c.py"])) == [("b.py", mutants.REALTIME)]
