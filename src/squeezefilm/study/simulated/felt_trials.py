"""Recorded answers and the paths that belong to them: which surface each path explored."""

from __future__ import annotations

import math
from collections.abc import Callable

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.display import load_display
from squeezefilm.physics.perception.observer import Observer
from squeezefilm.study.record.exploration import LONGEST_STEP, ExploredTrials, touches
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.record.tables import SURFACES, Cell, origin_of, trial_table
from squeezefilm.study.simulated.felt_paths import FeltPath, felt_on_path


def felt_in_trial(
    store: StudyStore,
    participant: str,
    trial: int,
    observer: Observer | None = None,
    *,
    progress: Callable[[str], None] | None = None,
) -> tuple[FeltPath, ...]:
    """Percepts of a recorded answer's paths, one result for each surface.

    Args:
        store: the study.
        participant: the pseudonym.
        trial: number of the trial within the participant, from 1.
        observer: whose senses; the preset "fingertip" if None.
        progress: is told each surface.

    Raises:
        InputError: no such answer, one whose path was not kept, or what `felt_on_path` refuses.
    """
    row = _answer(store, participant, trial)
    names = [str(row[key]) for key in SURFACES if row[key]]
    tables = ExploredTrials(store).paths(str(row["traces"]).split())
    if len(tables) != len(names):
        raise InputError(
            f"trial {trial} of {participant} presented {len(names)} surfaces and has "
            f"{len(tables)} paths beside {store.path.name}; only a device or its twin keeps them, "
            f"in {store.traces.name}. Give another trial, or a path"
        )
    known = row["mean_normal_force_N"]
    force: si.Newton | None = None if known is None else float(known)
    if force is not None and not math.isfinite(force):
        force = None
    paths = []
    for name, table in zip(names, tables, strict=True):
        time, x, y = (table.column(key) for key in ("time_s", "x_m", "y_m"))
        paths.append(
            felt_on_path(
                store.design,
                name,
                touches(time, x, y, LONGEST_STEP),
                observer=observer,
                display=load_display(str(row["display"])),
                normal_force=force,
                source=f"trial {trial} of {participant} ({origin_of(store)})",
                choice=str(row["choice"] or ""),
                answer=str(row["answer"]),
                progress=progress,
            )
        )
    return tuple(paths)


def _answer(store: StudyStore, participant: str, trial: int) -> dict[str, Cell]:
    mine = [row for row in trial_table(store) if row["participant_id"] == participant]
    if not mine:
        people = [str(one["uuid"]) for one in store.participants()]
        raise InputError(
            f"participant '{participant}' has no answer in {store.path.name}; enrolled are: "
            f"{', '.join(people[:8]) or 'nobody'}{' …' if len(people) > 8 else ''}"
        )
    for row in mine:
        if row["trial"] == trial and row["phase"] != "familiarisation":
            if row["adaptive_series"]:
                raise InputError(
                    f"trial {trial} presented what the series '{row['adaptive_series']}' chose, "
                    "which is no stimulus of the design; give a trial of fixed stimuli"
                )
            return row
    asked = [int(str(row["trial"])) for row in mine if row["phase"] != "familiarisation"]
    raise InputError(
        f"trial {trial} of {participant} has no answer; answered are {min(asked, default=0)} to "
        f"{max(asked, default=0)}",
        quantity="trial",
    )
