"""What the terminal says of simulated participants: answers by display, and the reasons."""

from __future__ import annotations

import numpy as np
from tests.unit.printed import printed

from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.physics.perception.percepts import Apparatus
from squeezefilm.physics.perception.senses import Candidates
from squeezefilm.study.report.page import REMARK, evidence_said
from squeezefilm.study.report.terminal_analysis import show_simulated
from squeezefilm.study.simulated.answers import SimulatedStudy
from squeezefilm.study.simulated.chain_tables import ChainTables

from ...study.scripted import gratings, matched

DESIGN = gratings(displays=("biet2008-plate", "biet2008-stator"))
NONE = np.zeros(0)


def study() -> SimulatedStudy:
    """Two people: on the plate 8 mm is taken for 4 mm, on the stator all is right."""
    tables = ChainTables(
        DESIGN,
        load_observer(),
        load_observer().fingers()[:1],
        (Apparatus(),) * 2,
        Candidates(np.full((2, 1, 3, 1, 1), 4.05e-3), np.full((2, 1, 3, 1, 1), 3.25)),
        Candidates(NONE, NONE),
    )
    display = np.array([[0, 0, 0, 1, 1, 1, 1]] * 2)
    stimulus = np.array([[0, 1, 2, 0, 1, 2, 2]] * 2)
    choice = np.array([[0, 1, 1, 0, 1, 2, 2]] * 2)
    number = np.array([np.arange(7)] * 2)
    answers = matched(DESIGN, display, stimulus, choice, number, 1.0 * number)
    return SimulatedStudy(tables, answers, 5)


def test_each_display_has_its_answers_and_what_is_felt() -> None:
    lines = printed(lambda: show_simulated(study()))
    felt = ("Stimulus d′ Clearest rhythm", *(f"{size} mm 3.25 4.05 mm" for size in (2, 4, 8)))
    columns = "Per cent of each column; rows are what was answered, columns simulated."
    assert lines[:10] == [
        "biet2008-plate, SIMULATED: 66.7 % right, 2 simulated participants, seed 5",
        "Answered \\ presented 2 mm 4 mm 8 mm",
        "2 mm 100 % (2) 0 % (0) 0 % (0)",
        "4 mm 0 % (0) 100 % (2) 100 % (2)",
        "8 mm 0 % (0) 0 % (0) 0 % (0)",
        columns,
        *felt,
    ]
    assert lines[10:20] == [
        "biet2008-stator, SIMULATED: 100.0 % right, 2 simulated participants, seed 5",
        "Answered \\ presented 2 mm 4 mm 8 mm",
        "2 mm 100 % (2) 0 % (0) 0 % (0)",
        "4 mm 0 % (0) 100 % (2) 0 % (0)",
        "8 mm 0 % (0) 0 % (0) 100 % (4)",
        columns,
        *felt,
    ]


def test_sentence_and_remark_stand_once_below_all() -> None:
    text = " ".join(printed(lambda: show_simulated(study())))
    said = evidence_said(study().tables)
    assert text.endswith(f"{said} {REMARK}")
    assert text.count(said) == 1
