"""A session from the command line: open or create the file, begin, conduct, end."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path

from squeezefilm import config
from squeezefilm.errors import InputError
from squeezefilm.study.conduct import Examiner, conduct
from squeezefilm.study.design import load_design
from squeezefilm.study.device import NoDevice, StudyDevice
from squeezefilm.study.exposure import Exposure
from squeezefilm.study.run import StudyRun
from squeezefilm.study.session_conditions import SessionConditions
from squeezefilm.study.sessions import begin_session, display_wanted, end_session
from squeezefilm.study.store import StudyStore

Progress = Callable[[str], None]


def open_study(
    path: Path, design: str | Path, seed: int, station: int = 0, stations: int = 1
) -> StudyStore:
    """The study's file, created if it is not there.

    Raises `InputError` if it is there and of another design or seed.
    """
    wanted = load_design(design)
    if not path.exists():
        return StudyStore.create(path, wanted, seed, station=station, stations=stations)
    store = StudyStore.open(path)
    study = store.study
    if study["design_sha256"] != wanted.sha256 or study["seed"] != seed:
        store.close()
        raise InputError(
            f"{path} is of design {study['design_sha256'][:12]} with seed {study['seed']}; asked "
            f"for is {wanted.sha256[:12]} with seed {seed}; give another --store"
        )
    return store


def run_session(
    store: StudyStore,
    participant: str,
    examiner: Examiner,
    *,
    drive: str = "none",
    conditions: Path | None = None,
    consent: bool = False,
    acknowledge: Callable[[str], bool],
    progress: Progress | None = None,
) -> str:
    """One session on the display that the participant's next trial needs. Returns how it ended.

    `conditions` is a TOML file of `SessionConditions`; `consent` counts beside what it says.
    `acknowledge` is shown the statement on airborne ultrasound. Raises what `begin_session` and
    `conduct` raise.
    """
    display = display_wanted(store, participant)
    if display is None:
        return f"participant {participant} has answered every trial"
    sitting = SessionConditions(consent=consent)
    if conditions is not None:
        sitting = config.load(SessionConditions, conditions)
        sitting = dataclasses.replace(sitting, consent=sitting.consent or consent)
    sitting.require_consent()
    device, exposed = _device(drive, store, display, progress)
    acknowledged = exposed is not None and acknowledge(exposed.statement)
    session = begin_session(store, participant, device, sitting, exposed, acknowledged=acknowledged)
    run = StudyRun(store, session)
    count = conduct(run, device, examiner)
    after = end_session(store, session, device)
    said = f"{count} trials on {display} recorded"
    if after.problems:
        said += f". CAUTION, the device is off after the session: {'; '.join(after.problems)}"
    if run.state == "display changes":
        said += f"; next display: {display_wanted(store, participant)}"
    return said


def _device(
    drive: str, store: StudyStore, display: str, progress: Progress | None
) -> tuple[StudyDevice, Exposure | None]:
    if drive == "none":
        return NoDevice(), None
    raise InputError(f"--drive '{drive}' is not known; allowed: none")
