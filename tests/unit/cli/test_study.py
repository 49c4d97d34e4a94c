"""The verbs of a study, and of its file (`study_file`): what each calls, says, leaves behind."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import typer
from tests.e2e.program import Done
from tests.e2e.program import run as program

from squeezefilm.cli import study_file
from squeezefilm.cli.study import study
from squeezefilm.core.presets import study_names
from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.study.conduct.terminal_run import ask_acknowledgement
from squeezefilm.study.design.study_design import load_design
from squeezefilm.study.record.store import StudyStore

from ..study.scripted import gratings

PRESET = "biet2008-gratings"
StandsIn = Callable[..., Any]
ANSWER = SimpleNamespace(summary=lambda: {"found": 1}, curve="the curve")


def run(*arguments: str | Path, keys: str = "", cwd: Path | None = None) -> Done:
    """A verb of `study`."""
    return program("study", *arguments, keys=keys, cwd=cwd)


@pytest.fixture
def store(tmp_path: Path) -> Path:
    """A study's file with two people enrolled."""
    path = tmp_path / "a.sqlite"
    with StudyStore.create(path, gratings(), 7) as found:
        found.enrol()
        found.enrol()
    return path


def people(path: Path) -> list[str]:
    with StudyStore.open(path) as found:
        return [str(one["uuid"]) for one in found.participants()]


def test_without_a_verb_the_verbs_are_listed() -> None:
    done = run()
    said = done.stdout + done.stderr
    assert "Missing command" not in said
    assert study_file.study is study
    for command in study.registered_commands:
        assert (command.name or command.callback.__name__).replace("_", "-") in said  # type: ignore[union-attr]


def test_a_plan_is_for_twelve_people_and_seed_0_unless_asked() -> None:
    found = json.loads(run("plan", PRESET, "--json").stdout)
    assert (found["participants"], found["seed"]) == (12, 0)
    found = json.loads(run("plan", PRESET, "--participants", "3", "--seed", "5", "--json").stdout)
    assert (found["participants"], found["seed"]) == (3, 5)
    said = run("plan", PRESET).stdout
    assert "for 12 participants" in said
    assert not said.startswith("{")


def test_presets_are_named_with_their_titles() -> None:
    listing = json.loads(run("presets", "--json").stdout)
    assert [one["name"] for one in listing] == list(study_names())
    assert {"name": PRESET, "title": load_design(PRESET).title} in listing
    said = run("presets").stdout.splitlines()
    assert said == [f"{one['name']}: {one['title']}" for one in listing]


@pytest.mark.slow
def test_simulated_people_are_shown_and_written_where_asked(
    stands_in: StandsIn, tmp_path: Path
) -> None:
    tables = stands_in("study.simulated.chain_tables:chain_tables", "the tables")
    people = stands_in("study.simulated.answers:simulate_participants", ANSWER)
    shown = stands_in("study.report.terminal_analysis:show_simulated")
    written = stands_in("study.report.page:write_simulated", tmp_path / "index.html")
    done = run("simulate", PRESET)
    assert done.returncode == 0, done.stderr
    design, observer = load_design(PRESET), load_observer("fingertip")
    assert tables.given == (design, observer)
    assert tables.named["finger"] == "new"
    assert people.given[:5] == (design, observer, 12, 0, "the tables")
    assert shown.given == (ANSWER,)
    assert done.stdout == ""
    assert "  a step …" in done.stderr
    assert written.calls == []

    asked = ("--participants", "2", "--seed", "3", "--out", tmp_path, "--finger", "mean")
    done = run("simulate", PRESET, *asked)
    assert tables.calls[-1][1]["finger"] == "mean"
    assert people.calls[-1][0][2:4] == (2, 3)
    assert written.given[:2] == (ANSWER, tmp_path)
    assert done.stdout == f"page: {tmp_path / 'index.html'}\n"
    done = run("simulate", PRESET, *asked, "--json")
    assert json.loads(done.stdout) == {"found": 1}
    assert done.stderr == ""
    assert len(shown.calls) == 2


def test_answers_of_another_program_need_their_design(stands_in: StandsIn, tmp_path: Path) -> None:
    asked = stands_in("study.tasks.analyze:analyze_study", {"one": ANSWER})
    stands_in("study.report.terminal_analysis:show_analyses")
    answers = tmp_path / "answers.csv"
    run("analyze", answers, "--design", PRESET, "--columns", "choice=key, participant_id=who")
    assert asked.named["design"] == load_design(PRESET)
    assert asked.named["columns"] == {"choice": "key", "participant_id": "who"}
    for arguments in ((answers,), ("a.sqlite", "--columns", "choice=key")):
        done = run("analyze", *arguments)
        assert done.returncode == 2
        assert "say to which study they were given by --design" in done.stderr
    assert len(asked.calls) == 1


def test_power_takes_its_question_from_the_options(stands_in: StandsIn, tmp_path: Path) -> None:
    asked = stands_in("study.simulated.planned_power:planned_power", ANSWER)
    shown = stands_in("study.report.terminal_analysis:show_power")
    drawn = stands_in("subjects:plot", "the figure")
    stands_in("core.kit.style:png", b"a picture")
    done = run("power", PRESET, "8 mm", "10 mm")
    assert asked.given == (load_design(PRESET), load_observer("fingertip"), "8 mm", "10 mm")
    assert asked.named == {
        "display": None,
        "target": 0.8,
        "studies": 400,
        "seed": 0,
        "finger": "new",
    }
    assert shown.given == (ANSWER,)
    assert "  a step …" in done.stderr
    assert drawn.calls == []

    picture = tmp_path / "power.png"
    done = run(
        "power", PRESET, "8 mm", "10 mm", "--display", "biet2008-stator", "--target", "0.9",
        "--studies", "50", "--seed", "4", "--finger", "mean", "--out", picture, "--json",
    )  # fmt: skip
    assert asked.calls[-1][1] == {
        "display": "biet2008-stator", "target": 0.9, "studies": 50, "seed": 4,
        "finger": "mean",
    }  # fmt: skip
    assert picture.read_bytes() == b"a picture"
    assert drawn.given == (ANSWER,)
    assert json.loads(done.stdout) == {"found": 1}
    assert done.stderr == ""
    assert len(shown.calls) == 1


def test_power_compares_two_displays(stands_in: StandsIn) -> None:
    asked = stands_in("study.simulated.planned_precision:planned_contrast", ANSWER)
    stands_in("study.report.terminal_analysis:show_power")
    run("power", PRESET, "--against", "biet2008-plate", "--studies", "50")
    design = load_design(PRESET)
    people = load_observer("fingertip")
    assert asked.given == (design, people, design.displays[0], "biet2008-plate")
    assert asked.named == {"target": 0.8, "studies": 50, "seed": 0, "finger": "new"}
    run("power", PRESET, "--against", "biet2008-plate", "--display", "winfield2007-tpad")
    assert asked.calls[-1][0][2:] == ("winfield2007-tpad", "biet2008-plate")


def test_power_asks_for_a_precision_of_the_whole_design(stands_in: StandsIn) -> None:
    asked = stands_in("study.simulated.planned_precision:planned_precision", ANSWER)
    shown = stands_in("study.report.terminal_analysis:show_precision")
    stands_in("study.report.terminal_analysis:show_power", tells=False)
    run("power", PRESET, "--precision", "20 %", "--studies", "50")
    assert asked.given == (load_design(PRESET), load_observer("fingertip"), pytest.approx(0.2))
    assert asked.named == {
        "display": None, "target": 0.8, "studies": 50, "seed": 0, "finger": "new",
    }  # fmt: skip
    assert shown.given == (ANSWER,)


@pytest.mark.parametrize(
    ("question", "says"),
    [
        (("--precision", "20%", "--against", "biet2008-plate"), "ask two things"),
        (("8 mm", "--precision", "20%"), "--precision asks of the whole design"),
        (("8 mm", "--against", "biet2008-plate"), "--against asks of the whole design"),
        (("8 mm",), "name two stimuli of 'biet2008-gratings'"),
        ((), 'told apart ("0.4 mm", "2 mm"'),
    ],
)
def test_power_refuses_two_questions_and_none(question: tuple[str, ...], says: str) -> None:
    done = run("power", PRESET, *question)
    assert done.returncode == 2
    assert says in done.stderr
    assert done.stdout == ""


def test_people_are_simulated_on_another_display(stands_in: StandsIn) -> None:
    tables = stands_in("study.simulated.chain_tables:chain_tables", "the tables")
    people = stands_in("study.simulated.answers:simulate_participants", ANSWER)
    shown = stands_in("study.report.terminal_analysis:show_simulated")
    asked = ("--participants", "2", "--seed", "3", "--finger", "mean")
    done = run("simulate", PRESET, "--display", "winfield2007-tpad", *asked)
    design, observer, *rest = people.given[:5]
    assert design.displays == ("winfield2007-tpad",)
    assert (observer, *rest) == (load_observer("fingertip"), 2, 3, "the tables")
    assert (tables.given[0], tables.named["finger"]) == (design, "mean")
    assert shown.given == (ANSWER,)
    assert (done.returncode, done.stdout) == (0, "")
    found = run("simulate", PRESET, *asked, "--json")
    assert people.calls[-1][0][0] == load_design(PRESET)
    assert json.loads(found.stdout) == {"found": 1}


def test_the_boards_of_a_study_are_written_and_listed(stands_in: StandsIn, tmp_path: Path) -> None:
    written = stands_in("study.report.boards:write_boards", tmp_path / "boards.html", tells=False)
    done = run("gratings", PRESET, "--out", tmp_path, "--tolerance", "50 um")
    assert written.given == (load_design(PRESET), tmp_path, pytest.approx(50e-6))
    lines = [" ".join(line.split()) for line in done.stdout.splitlines()]
    assert "Boards to be made" in lines
    assert lines[-1] == f"page: {tmp_path / 'boards.html'}"
    run("gratings", PRESET, "--out", tmp_path)
    assert written.calls[-1][0][2] == pytest.approx(20e-6)


def test_a_rehearsal_makes_the_file_and_says_what_comes_next(
    stands_in: StandsIn, tmp_path: Path
) -> None:
    asked = stands_in("study.conduct.rehearsal:rehearse", ("a", "b", "c"))
    path = tmp_path / "tried.sqlite"
    done = run("rehearse", PRESET, "--store", path)
    assert asked.given[1:] == (load_observer("fingertip"), 3)
    assert done.stderr == ""
    assert done.stdout.splitlines() == [
        "3 simulated participants answered everything; look at it with:",
        f"squeezefilm study analyze {path}",
    ]
    with StudyStore.open(path) as found:
        assert [found.study[key] for key in ("seed", "station", "stations")] == [0, 0, 1]
        assert found.design.name == load_design(PRESET).name
    run("rehearse", PRESET, "--store", path, "--participants", "1")
    assert asked.calls[-1][0][2] == 1
    refused = run("rehearse", PRESET, "--store", path, "--seed", "1")
    assert refused.returncode == 2
    assert "give another store" in refused.stderr


def test_a_session_is_given_every_option(
    stands_in: StandsIn, capsys: pytest.CaptureFixture[str]
) -> None:
    asked = stands_in("study.report.terminal:run_study", "how it ended", tells=False)
    done = run("run", PRESET, "--store", "a.sqlite")
    assert done.stdout == "how it ended\n"
    assert asked.given == (PRESET, Path("a.sqlite"), None)
    named = dict(asked.named)
    with named.pop("progress")() as step:
        step("nobody is at a terminal")
    assert capsys.readouterr().err == ""
    assert named == {
        "drive": "none", "amplitude_per_pickup": None, "conditions": None, "consent": False,
        "acknowledge": ask_acknowledgement, "seed": None, "station": None, "stations": None,
        "tell": typer.echo, "by_hand": "terminal", "lsl": False,
    }  # fmt: skip

    run(
        "run", PRESET, "--store", "a.sqlite", "--participant", "abc", "--conditions", "c.toml",
        "--consent", "--drive", "twin", "--pickup", "2 um/V", "--acknowledge-ultrasound",
        "--seed", "5", "--station", "1", "--stations", "3", "--by-hand", "nowhere",
    )  # fmt: skip
    (_, _, participant), named = asked.calls[-1]
    assert named.pop("acknowledge")("any statement") is True
    assert named.pop("progress") is not None
    assert participant == "abc"
    assert named.pop("amplitude_per_pickup") == pytest.approx(2e-6)
    assert named == {
        "drive": "twin", "conditions": Path("c.toml"), "consent": True, "seed": 5, "station": 1,
        "stations": 3, "tell": typer.echo, "by_hand": "nowhere", "lsl": False,
    }  # fmt: skip
    refused = run("run", PRESET, "--store", "a.sqlite", "--pickup", "2 um")
    assert refused.returncode == 2
    assert "error: --pickup: " in refused.stderr


def test_the_status_lists_who_is_enrolled(store: Path) -> None:
    found = json.loads(run("status", store, "--json").stdout)
    assert found["study"] == "small"
    assert [one["uuid"] for one in found["participants"]] == people(store)
    said = run("status", store).stdout
    assert f"small: {store}" in " ".join(said.split())
    assert not said.startswith("{")


def test_an_export_is_csv_beside_the_file_unless_asked(store: Path, tmp_path: Path) -> None:
    done = run("export", store)
    assert done.stdout == f"wrote {tmp_path / 'a.exports' / 'csv'}\n"
    assert (tmp_path / "a.exports" / "csv" / "small_trials.csv").exists()
    assert run("export", store, "--format", "psych-ds", "--out", tmp_path / "b").returncode == 0
    assert (tmp_path / "b" / "dataset_description.json").exists()
    refused = run("export", store, "--format", "xml")
    assert refused.returncode == 2
    assert "csv, psych-ds" in refused.stderr


def test_a_merge_adds_every_file_named(store: Path, tmp_path: Path) -> None:
    for name in ("b", "c"):
        with StudyStore.create(tmp_path / f"{name}.sqlite", gratings(), 7) as found:
            found.enrol()
            found.enrol()
    done = run("merge", store, "b.sqlite", "c.sqlite", cwd=tmp_path)
    lines = done.stdout.splitlines()
    assert lines[0].startswith("b.sqlite: 2 participants and 0 answers added")
    assert any(line.startswith("c.sqlite: 2 participants") for line in lines)
    assert len(people(store)) == 6


def test_a_backup_is_a_copy(store: Path) -> None:
    done = run("backup", store)
    assert done.stdout.startswith("wrote ")
    assert people(Path(done.stdout.removeprefix("wrote ").strip())) == people(store)


def test_somebody_is_deleted_only_after_a_yes(store: Path) -> None:
    first, second = people(store)
    kept = run("delete-participant", store, first, keys="n\n")
    assert kept.returncode == 1
    assert f"Delete every answer and trace of {first} for good?" in kept.stdout
    assert people(store) == [first, second]
    gone = run("delete-participant", store, first, keys="y\n")
    assert gone.returncode == 0
    assert f"{first}: 0 answers" in gone.stdout
    unasked = run("delete-participant", store, second, "--yes")
    assert unasked.returncode == 0
    assert "for good" not in unasked.stdout
    assert people(store) == []


def test_an_analysis_is_shown_and_written_a_page_per_display(
    stands_in: StandsIn, store: Path, tmp_path: Path
) -> None:
    found = {"one": ANSWER, "two": ANSWER}
    asked = stands_in("study.tasks.analyze:analyze_study", found)
    shown = stands_in("study.report.terminal_analysis:show_analyses")
    written = stands_in("study.report.page:write_overview", tmp_path / "index.html")
    done = run("analyze", store)
    assert asked.given == (store,)
    assert asked.named == {
        "design": None, "columns": {}, "values": {}, "decimal_comma": False,
        "seed": 0,
    }  # fmt: skip
    assert shown.given == (found,)
    assert "  a step …" in done.stderr
    assert done.stdout == ""
    assert written.calls == []

    out = tmp_path / "pages"
    done = run("analyze", store, "--out", out, "--seed", "6")
    assert asked.calls[-1][1] == {
        "design": None, "columns": {}, "values": {}, "decimal_comma": False,
        "seed": 6,
    }  # fmt: skip
    assert [given[:2] for given, _ in written.calls] == [(found, out)]
    assert done.stdout == f"page: {tmp_path / 'index.html'}\n"
    done = run("analyze", store, "--json")
    assert json.loads(done.stdout) == {"one": {"found": 1}, "two": {"found": 1}}
    assert done.stderr == ""
    assert len(shown.calls) == 2
