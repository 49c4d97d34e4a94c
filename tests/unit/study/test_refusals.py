"""What studies refuse because it cannot be, in a word of each message."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.physics.render.motion.stroke import FingerPath
from squeezefilm.study.adaptive.bayesian import AdaptiveDesign, BayesianAdaptive
from squeezefilm.study.conduct.rehearsal import MOST_PEOPLE, rehearse
from squeezefilm.study.design.plan import plan_study
from squeezefilm.study.design.study_design import load_design
from squeezefilm.study.psychometric.function import PsychometricFunction, PsychometricPrior
from squeezefilm.study.record.database import require_study
from squeezefilm.study.record.exploration import coverage
from squeezefilm.study.record.exports import LIST, exported_folders, own_files
from squeezefilm.study.record.store import StudyStore

DESIGN, OBSERVER = load_design("friction-jnd"), load_observer()


def created(folder: Path, name: str = "s.sqlite", **given: Any) -> StudyStore:
    return StudyStore.create(folder / name, DESIGN, **{"seed": 1, **given})


def exports(folder: Path, text: str) -> object:
    (folder / LIST).write_text(text)
    return exported_folders(SimpleNamespace(exports=folder))  # type: ignore[arg-type]


def linked(folder: Path) -> object:
    file = folder / "s.sqlite"
    file.write_bytes(b"x")
    (folder / "elsewhere").write_bytes(b"")
    file.with_name("s.sqlite-wal").symlink_to(folder / "elsewhere")
    return require_study(file)


def a_file(folder: Path) -> object:
    (folder / "f").write_text("")
    return own_files(folder / "f")


@pytest.mark.parametrize(
    ("build", "word"),
    [
        (lambda at: created(at, "s"), "suffix of its own"),
        (lambda at: created(at, "s.exports"), "suffix of its own"),
        (lambda at: created(at, seed=-1), "seed"),
        (lambda at: created(at, station=2, stations=2), "station"),
        (lambda at: rehearse(created(at), OBSERVER, 0), "from 1 to"),
        (lambda at: rehearse(created(at), OBSERVER, MOST_PEOPLE + 1), "from 1 to"),
        (
            lambda at: rehearse(created(at, station=1, stations=2), OBSERVER, 1),
            "several stations",
        ),
        (lambda at: plan_study(DESIGN, participants=0, seed=1), "participants"),
        (lambda at: exports(at, '[{"format": "other", "folder": "x"}]'), "cannot be read"),
        (lambda at: exports(at, '[{"format": "csv"}]'), "cannot be read"),
        (a_file, "is a file; give a folder"),
        (linked, "is no study's file|is a link"),
        (lambda at: require_study(at / "none.sqlite"), "does not exist"),
        (lambda at: coverage((), (0.0, 0.1)), "face"),
    ],
)
def test_what_cannot_be_is_refused(
    build: Callable[[Path], object], word: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=word):
        build(tmp_path)


def test_the_cells_that_a_path_came_over_are_counted_once() -> None:
    time = np.linspace(0, 1, 5)
    across = FingerPath(time, np.linspace(0.5e-3, 9.5e-3, 5), np.full(5, 2.5e-3))
    along = FingerPath(time, np.full(5, 4.5e-3), np.linspace(0.5e-3, 3.5e-3, 5))
    face, cell = (10e-3, 5e-3), 1e-3
    assert coverage((across,), face, cell) == pytest.approx(10 / 50)
    assert coverage((across, along, across), face, cell) == pytest.approx(13 / 50)
    assert coverage((along,), (1e-3, 2e-3), cell) == 1.0
    assert coverage((), face, cell) == 0.0


@pytest.mark.parametrize("axis", ["linear", "log"])
def test_the_estimate_is_that_of_the_posterior(axis: Any) -> None:
    """By Bayes, cell by cell, from the function that each cell stands for."""
    prior = PsychometricPrior((1.0, 4.0), (0.2, 2.0))
    design = AdaptiveDesign((1.5, 2.0, 3.0), prior, axis=axis, cells=(6, 4, 3), guess_rate=0.25)
    method = BayesianAdaptive(design)
    answers = ((2.0, True), (1.5, False), (3.0, True), (2.0, False))
    places, widths, lapses = method._nodes
    weights = np.empty((6, 4, 3))
    for at in np.ndindex(weights.shape):
        threshold = math.exp(places[at[0]]) if axis == "log" else places[at[0]]
        function = PsychometricFunction(
            "logistic", threshold, math.exp(widths[at[1]]), 0.25, lapses[at[2]], axis
        )
        chances = [float(function(x)) if right else 1 - float(function(x)) for x, right in answers]
        weights[at] = math.prod(chances)
    weights /= weights.sum()
    for intensity, right in answers:
        method.update(intensity, right)
    assert method.probability == pytest.approx(weights, rel=1e-6)
    place = np.einsum("ijk,i->", weights, places)
    threshold, width = method.estimate()
    assert threshold == pytest.approx(math.exp(place) if axis == "log" else place)
    assert width == pytest.approx(math.exp(np.einsum("ijk,j->", weights, widths)))


@pytest.mark.parametrize(("stimuli", "word"), [((0.0, 1.0), "intensity"), ((1.0,), "two or more")])
def test_stimuli_that_no_axis_has_are_refused(stimuli: tuple[float, ...], word: str) -> None:
    with pytest.raises(InputError, match=word):
        AdaptiveDesign(stimuli, PsychometricPrior((1.0, 4.0), (0.2, 2.0)), axis="log")
