"""A study's file analysed: what its tasks allow, display by display."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from squeezefilm.errors import InputError
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.identification.analysis import IdentificationAnalysis, analyze_identification
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.record.tables import origin_of, trial_table

_EXPLORED = ("mean_speed_m_per_s", "mean_normal_force_N", "path_length_m")


def analyze_study(
    store: StudyStore | str | Path,
    *,
    mixed: bool = False,
    resamples: int = 1000,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
) -> dict[str, IdentificationAnalysis]:
    """The analysis of a match-to-sample study's main trials, by display.

    `store` is the study, or the path of its file.
    Practice, familiarisation and catch trials are left out. Stimuli and gratings are taken in the
    design's order; each stimulus must have the grating of its own period among the answers.
    Results say whose answers they are (`origin_of`). See `analyze_identification` for the rest.

    Raises:
        InputError: another task, stimuli that have no right answer, or no answer yet.
        RecordError: the file is damaged.
    """
    if not isinstance(store, StudyStore):
        with StudyStore.open(store) as opened:
            return analyze_study(
                opened, mixed=mixed, resamples=resamples, seed=seed, progress=progress
            )
    design = store.design
    stimuli, right = _stimuli_and_answers(design)
    store.require_whole()
    rows = [row for row in trial_table(store) if row["phase"] == "main"]
    found = {}
    for display in design.displays:
        here = [row for row in rows if row["display"] == display]
        if not here:
            continue
        columns = {
            key: np.array([row[key] for row in here], dtype=float)
            for key in ("response_time_s", *_EXPLORED)
        }
        taken = {key: values for key, values in columns.items() if np.isfinite(values).any()}
        found[display] = analyze_identification(
            np.array([str(row["participant_id"]) for row in here]),
            [stimuli.index(str(row["stimulus"])) for row in here],
            [right.index(str(row["choice"])) for row in here],
            right,
            name=f"{store.study['name']}, {display}",
            origin=origin_of(store),
            response_time=taken.pop("response_time_s", None),
            exploration=taken,
            mixed=mixed,
            resamples=resamples,
            seed=seed,
            progress=progress,
        )
    if not found:
        raise InputError(f"{store.path} has no answered main trial yet; run some first")
    return found


def _stimuli_and_answers(design: StudyDesign) -> tuple[list[str], list[str]]:
    """Names of the stimuli and their right answers. Raises `InputError` for another task, and
    where the answers are not each the right one to a stimulus."""
    if design.task != "match-to-sample":
        raise InputError(
            f"'{design.name}' is a study of {design.task}; its confusions are not defined. Export "
            "it, and fit thresholds with squeezefilm.study.psychometric.fit"
        )
    stimuli = [one.name for one in design.stimuli]
    right = [design.answer_to(one) for one in design.stimuli]
    if sorted(right) != sorted(design.answers):
        raise InputError(
            "an identification needs one right answer for each stimulus and no other answers; "
            f"stimuli: {', '.join(stimuli)}; answers: {', '.join(design.answers)}"
        )
    return stimuli, right
