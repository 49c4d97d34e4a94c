"""A study at the terminal: its plan, its file, and the questions that a participant is asked."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from types import SimpleNamespace

import pytest
from tests.unit.printed import printed

from squeezefilm.core.config.provenance import Provenance
from squeezefilm.core.errors import InputError
from squeezefilm.physics.perception.stimuli import Grating, Stimulus
from squeezefilm.study.conduct.run import Acknowledgement, Presentation
from squeezefilm.study.conduct.terminal_run import ask_acknowledgement
from squeezefilm.study.design.plan import StudyPlan
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.design.trials import Phase, Trial
from squeezefilm.study.record.deletion import Deletion
from squeezefilm.study.record.merge import Merge
from squeezefilm.study.report.terminal import (
    TerminalExaminer,
    show_deletion,
    show_merge,
    show_plan,
    show_status,
)

GRATING = Stimulus("fine", 1.2345e-3, "period", low=0.65)
STRANGE = Stimulus("odd", 5e-3, "groove width", "sine")
DESIGN = StudyDesign(
    name="small",
    title="Small study",
    displays=("plate", "ring"),
    task="match-to-sample",
    stimuli=(GRATING, STRANGE),
    alternatives=(
        Grating("board", 1.2345e-3, "period", ridge_height=12.345e-6, material="brass"),
        Grating("other", 8e-3, "groove width"),
    ),
    trial_duration=12.5,
    note="Widths are assumed.",
    provenance={
        "repetitions": Provenance("", "assumed"),
        "stimuli": Provenance("paper"),
        "blocks": Provenance("", "assumed"),
    },
)


def trial(
    stimuli: tuple[str, ...] = ("fine",),
    *,
    phase: Phase = "main",
    display: str = "plate",
    alternatives: tuple[str, ...] = (),
    adaptive: str = "",
) -> Trial:
    """A trial of which only what is shown matters."""
    return Trial(1, display, 1, phase, stimuli, alternatives, "", adaptive, False, 0.0, 5)


def plan(design: StudyDesign = DESIGN) -> StudyPlan:
    """Five people; the first has ten trials to begin with, the second two of a series."""
    mains = [trial((str(number),), display="ring") for number in range(9)]
    schedules = (
        (trial(("felt",), phase="familiarisation"), *mains),
        (trial((), adaptive="stairs"), trial(("fine", "odd"), display="ring")),
        *(((trial(),),) * 3),
    )
    return StudyPlan(design, 5, 3, schedules, 5400.0, 4, ("there are no catch trials",))


def test_a_plan_says_what_is_presented_how_often_and_for_how_long() -> None:
    assert printed(lambda: show_plan(plan())) == [
        "small: Small study",
        "Task match-to-sample Which of the gratings does the surface feel like?",
        "Displays plate, ring",
        "Trials 10 per participant 1 familiarisation, 9 main",
        "Time 90 min per participant 12.5 s a trial",
        "In all 7.5 h for 5 participants",
        "Exploring strokes to and fro along x",
        "Order williams balanced over every 4 participants",
        f"Seed 3 design {DESIGN.sha256[:12]}",
        "Presented",
        "Name Period Groove Length means Surface Friction Right answer",
        "fine 1.23 mm 0.617 mm period square grating 0.65 to 1 board",
        "odd 10 mm 5 mm groove width sine grating 0.7 to 1 none",
        "Compared with",
        "Name Period Groove Length means Ridge Material",
        "board 1.23 mm 0.617 mm period 12.3 µm brass",
        "other 16 mm 8 mm groove width 70 µm copper",
        "First trials of the first participants",
        "0 plate: 0, 1, 2, 3, 4, 5, 6, 7, …",
        "1 plate: stairs, fine / odd, …",
        "2 plate: fine, …",
        "3 plate: fine, …",
        "To be looked at before anybody is asked",
        "there are no catch trials",
        "Assumed",
        "repetitions, blocks",
        "Widths are assumed.",
    ]


def test_a_plan_of_two_surfaces_has_no_right_answer_and_nothing_to_compare_with() -> None:
    design = StudyDesign(
        "jnd", "Two", ("plate",), "two-interval", (GRATING, STRANGE), reference="odd"
    )
    lines = printed(lambda: show_plan(plan(design)))
    assert "odd 10 mm 5 mm groove width sine grating 0.7 to 1" in lines
    assert "Compared with" not in lines
    assert "Assumed" not in lines
    assert lines[-1] == "there are no catch trials"


def test_the_names_of_a_plan_are_not_broken_on_a_narrow_terminal() -> None:
    lines = printed(lambda: show_plan(plan()), 34)
    assert any(line.startswith("Displays") for line in lines)


def test_the_status_lists_people_in_their_order() -> None:
    rows = [
        {"uuid": "abc", "number": 0, "answered": 7, "planned": 9, "set_aside": 2},
        {"uuid": "def", "number": 1, "answered": 0, "planned": 9, "set_aside": 0},
    ]
    store = SimpleNamespace(
        study={"name": "small"}, path=Path("a.sqlite"), participants=lambda: rows
    )
    assert printed(lambda: show_status(store)) == [  # type: ignore[arg-type]
        "small: a.sqlite",
        "Participant Number Answered Planned Set aside",
        "abc 0 7 9 2",
        "def 1 0 9 0",
    ]


def test_a_deletion_says_what_went_and_what_was_left() -> None:
    done = Deletion(True, 7, 5, 2, 4, 3, 11, ("notes.txt", "b.txt"))
    assert printed(lambda: show_deletion(done, "abc")) == [
        "abc: 7 answers, 5 traces and 3 sittings deleted; 2 backups and 4 exports gone through; "
        "nothing found in 11 files",
        "left as they are, being no files of this program: notes.txt, b.txt",
    ]
    nobody = Deletion(False, 0, 0, 0, 0, 0, 4, ())
    assert printed(lambda: show_deletion(nobody, "abc")) == [
        "abc was not enrolled; nothing found in 4 files"
    ]


def test_a_merge_says_what_came_and_which_numbers_are_doubled() -> None:
    added, present = {"participant": 2, "response": 9}, {"participant": 7, "response": 4}
    first = "b.sqlite: 2 participants and 9 answers added, 4 answers were there, 3 traces copied"
    assert printed(lambda: show_merge(Merge(added, present, 3, ()), "b.sqlite")) == [first]
    lines = printed(lambda: show_merge(Merge(added, present, 3, (0, 2)), "b.sqlite"))
    assert lines[0] == first
    assert lines[1].startswith("doubled participants' numbers: 0, 2; they had the same orders")
    assert len(lines) == 2


class Terminal:
    """Types what it is given; keeps prompts, lines and sleeps in their order."""

    def __init__(self, *typed: str) -> None:
        self.typed, self.said = list(typed), list[object]()

    def read(self, prompt: str) -> str:
        """The next line; the end of the input after the last."""
        self.said.append(prompt)
        if not self.typed:
            raise EOFError
        return self.typed.pop(0)

    def examiner(self, modulus: float | None = None) -> TerminalExaminer:
        """One who asks here."""
        asks: dict[str, Callable[..., None] | Callable[[str], str]] = {
            "read": self.read, "write": self.said.append, "sleep": self.said.append,
        }  # fmt: skip
        if modulus is None:
            return TerminalExaminer("Which?", **asks)  # type: ignore[arg-type]
        return TerminalExaminer("Which?", modulus=modulus, **asks)  # type: ignore[arg-type]


def presented(
    *alternatives: str, phase: Phase = "main", surfaces: Sequence[Stimulus] = (GRATING,)
) -> Presentation:
    """A trial with three left."""
    return Presentation(
        trial(alternatives=alternatives, phase=phase), "", tuple(surfaces), None, 1, 3, 0.0
    )


def test_a_break_is_waited_for_and_then_enter() -> None:
    terminal = Terminal("")
    terminal.examiner().rest(12.4)
    assert terminal.said == ["\nBreak: 12 s. Leave the surface.", 12.4, "Press Enter to go on. "]
    with pytest.raises(KeyboardInterrupt):
        terminal.examiner().rest(0.0)


def test_a_surface_that_is_put_there_by_hand_is_waited_for() -> None:
    terminal = Terminal("")
    terminal.examiner().placed()
    assert terminal.said == ["\nFingers off. Press Enter when the surface is in place. "]
    with pytest.raises(KeyboardInterrupt):
        terminal.examiner().placed()


def test_what_is_felt_is_named_or_numbered() -> None:
    terminal = Terminal("", "", "")
    examiner = terminal.examiner()
    examiner.feel(presented(), 0)
    for place in (0, 1):
        examiner.feel(presented(surfaces=(GRATING, STRANGE)), place)
    assert terminal.said == [
        "\n[3 left] Feel 'fine', then press Enter. ",
        "\n[3 left] Feel surface 1 of 2, then press Enter. ",
        "\n[3 left] Feel surface 2 of 2, then press Enter. ",
    ]


def test_an_answer_is_asked_for_until_it_is_one_of_those_offered() -> None:
    terminal = Terminal("0", "4", "x", "²", "", "-1", " 3 ")
    assert terminal.examiner().ask(presented("2 mm", "4 mm", "8 mm")) == "8 mm"
    again = ["> ", "Answer with a number from 1 to 3."]
    assert terminal.said == [
        "\n[3 left] Which?", "  1  2 mm", "  2  4 mm", "  3  8 mm", *(6 * again), "> ",
    ]  # fmt: skip
    assert Terminal("1").examiner().ask(presented("2 mm", "4 mm")) == "2 mm"
    assert Terminal(" 4 mm").examiner().ask(presented("2 mm", "4 mm")) == "4 mm"
    practising = Terminal("1")
    practising.examiner().ask(presented("2 mm", "4 mm", phase="practice"))
    assert practising.said[0] == "\n[3 left] (practice) Which?"


def test_a_magnitude_is_any_number_above_0() -> None:
    terminal = Terminal("0", "-1", "inf", "nan", "x", "", " 1,5 ")
    assert terminal.examiner(10.0).ask(presented()) == 1.5
    again = ["> ", "Answer with a number above 0."]
    assert terminal.said == ["\n[3 left] Which?", "The reference is 10.", *(6 * again), "> "]
    free = Terminal("0.25")
    assert free.examiner().ask(presented()) == 0.25
    assert free.said == ["\n[3 left] Which?", "> "]


@pytest.mark.parametrize(
    ("phase", "correct", "right", "said"),
    [
        ("practice", True, "2 mm", ["Right."]),
        ("practice", False, "2 mm", ["It was '2 mm'."]),
        ("practice", None, "", []),
        ("main", True, "2 mm", []),
    ],
)
def test_what_was_right_is_told_in_practice(
    phase: Phase, correct: bool | None, right: str, said: list[str]
) -> None:
    terminal = Terminal()
    told = Acknowledgement(1, "2 mm", None, correct, right, False, 2)
    terminal.examiner().acknowledge(presented("2 mm", phase=phase), told)
    assert terminal.said == said


@pytest.mark.parametrize(("typed", "given"), [(" YES ", True), ("y", False), ("no", False)])
def test_an_exposure_is_acknowledged_by_yes_alone(
    typed: str, given: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    assert ask_acknowledgement("120 dB", Terminal(typed).read) is given
    assert capsys.readouterr().out.startswith("\n120 dB\nPeople and animals nearby are exposed")


def test_where_nobody_is_an_exposure_is_not_acknowledged() -> None:
    with pytest.raises(InputError, match="acknowledge_ultrasound"):
        ask_acknowledgement("120 dB", Terminal().read)
