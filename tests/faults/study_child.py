"""Runs a scripted study in a process of its own, to be killed or starved of disk.

`run` answers every trial; it tells each trial's number once it is acknowledged.

study_child.py STUDY.sqlite PARTICIPANT limit|disk
    runs until nothing more can be written, makes room, goes on; writes one JSON object.
"""

from __future__ import annotations

import json
import os
import resource
import signal
import sys
from multiprocessing.connection import Connection
from pathlib import Path

from squeezefilm.core.errors import RecordError
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.conduct.run import Acknowledgement, Presentation, StudyRun
from squeezefilm.study.conduct.sessions import SessionConditions, begin_session
from squeezefilm.study.conduct.study_device import DeviceIdentity, DeviceVerification, TrialMotion
from squeezefilm.study.conduct.terminal_run import conduct
from squeezefilm.study.record.store import StudyStore

TRACE = "time_s,x_m\n" + "".join(f"{i / 100},{i / 1000}\n" for i in range(100))


class Device:
    """Plays nothing, and hands out a trace of a kilobyte."""

    def identity(self) -> DeviceIdentity:
        """No device."""
        return DeviceIdentity("none")

    def verify_device(self) -> DeviceVerification:
        """Nothing to verify."""
        return DeviceVerification(measurable=False, remark="scripted")

    def present(self, stimulus: Stimulus, seed: int) -> None:
        """Nothing."""

    def stop(self) -> TrialMotion:
        """The trace."""
        return TrialMotion(0.1, 0.1, 0.5, TRACE)


class Script:
    """Answers by the trial's seed; knows, and tells, which trials were acknowledged."""

    def __init__(self, tells: Connection | None = None) -> None:
        self.tells = tells
        self.acknowledged: list[int] = []

    def rest(self, duration: float) -> None:
        """No rest."""

    def feel(self, presentation: Presentation, place: int) -> None:
        """Long enough."""

    def ask(self, presentation: Presentation) -> str:
        """As the seed says."""
        names = sorted(presentation.trial.alternatives)
        return names[presentation.trial.seed % len(names)]

    def acknowledge(self, presentation: Presentation, told: Acknowledgement) -> None:
        """Tell the number."""
        self.acknowledged.append(told.number)
        if self.tells is not None:
            self.tells.send(told.number)


def begin(store: StudyStore, participant: str) -> StudyRun:
    """A session without a device."""
    conditions = SessionConditions(consent=True)
    found = begin_session(store, participant, Device(), conditions, None, acknowledged=False)
    return StudyRun(store, found)


def run(tells: Connection, path: Path, participant: str) -> None:
    """Answer every trial, telling that it is ready and each trial's number."""
    with StudyStore.open(path) as store:
        tells.send("ready")
        conduct(begin(store, participant), Device(), Script(tells))
    tells.send("finished")


def full(path: Path, participant: str, how: str) -> None:
    """Run into a full disk, and on when there is room."""
    ballast = path.with_name("ballast")
    script = Script()
    with StudyStore.open(path) as store:
        study = begin(store, participant)
        if how == "limit":
            # A write beyond the limit then fails instead of killing the process.
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            size = path.with_name(f"{path.name}-wal").stat().st_size
            _, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
            resource.setrlimit(resource.RLIMIT_FSIZE, (size + 100_000, hard))
        else:
            space = os.statvfs(path.parent)
            ballast.write_bytes(b"\x00" * (space.f_bavail * space.f_bsize - 300_000))
        message = ""
        try:
            conduct(study, Device(), script)
        except RecordError as error:
            message = str(error)
        before = list(script.acknowledged)
        rows = _numbers(store)
        again = ""
        try:
            conduct(study, Device(), script)
        except RecordError as error:
            again = str(error)
        between = list(script.acknowledged)
        if how == "limit":
            resource.setrlimit(resource.RLIMIT_FSIZE, (hard, hard))
        else:
            ballast.unlink()
        conduct(study, Device(), script)
        found = {
            "message": message,
            "again": again,
            "acknowledged": before,
            "recorded": rows,
            "between": between,
            "finally": script.acknowledged,
            "order": _numbers(store),
            "integrity": store.rows("PRAGMA integrity_check")[0]["integrity_check"],
            "stray_traces": [one.name for one in store.unreferenced_traces()],
        }
    print(json.dumps(found))


def _numbers(store: StudyStore) -> list[int]:
    rows = store.rows(
        "SELECT t.number FROM response r JOIN trial t ON t.uuid = r.trial ORDER BY t.number"
    )
    return [row["number"] for row in rows]


if __name__ == "__main__":
    full(Path(sys.argv[1]), sys.argv[2], sys.argv[3])
