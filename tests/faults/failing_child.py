"""Works on a disk that fails at its n-th call, for every n; started with `failing_disk.c` loaded.

failing_child.py FOLDER STEP JOB…
    for every job, every kind of call and every STEP-th n: what was acknowledged must be there
    afterwards, only our errors may come, and the same work must go on once the disk is well.
    Writes one JSON line a job and kind: calls counted, failures tried, how many were refused.
"""

from __future__ import annotations

import ctypes
import json
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from tests.faults.study_child import Device, Script, begin

from squeezefilm.core.errors import SqueezefilmError
from squeezefilm.instruments.session.record.trace import read_trace
from squeezefilm.instruments.session.record.trace_file import TraceWriter
from squeezefilm.lab.studying.studies import PrepareSitting, Studies
from squeezefilm.physics.perception.stimuli import Grating, Stimulus
from squeezefilm.study.conduct.terminal_run import conduct
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.record.deletion import delete_participant
from squeezefilm.study.record.exports import export_study
from squeezefilm.study.record.merge import merge
from squeezefilm.study.record.store import StudyStore

KINDS = {"write": 1, "sync": 2, "rename": 4, "cut": 8}
DESIGN = StudyDesign(
    name="faults",
    title="",
    displays=("biet2008-plate",),
    task="match-to-sample",
    stimuli=tuple(Stimulus(name, at, "period") for name, at in (("2 mm", 2e-3), ("8 mm", 8e-3))),
    alternatives=tuple(
        Grating(name, at, "period") for name, at in (("2 mm", 2e-3), ("8 mm", 8e-3))
    ),
)


class Job:
    """Some work in a folder. `prepare` on a good disk, `work` on a failing one, `check` after."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.told: list[object] = []

    def study(self, name: str = "study", station: int = 0) -> StudyStore:
        """A new study's file with one participant."""
        path = self.folder / f"{name}.sqlite"
        store = StudyStore.create(path, DESIGN, 7, station=station, stations=2)
        store.enrol()
        return store

    def opened(self) -> StudyStore:
        """The study's file."""
        store = StudyStore.open(self.folder / "study.sqlite")
        store.require_whole()
        return store

    def prepare(self) -> None:
        """Nothing."""

    def work(self) -> None:
        """To be said."""
        raise NotImplementedError

    def check(self) -> None:
        """To be said."""
        raise NotImplementedError


class Creating(Job):
    """A file is made and somebody enrolled; or there is none."""

    def work(self) -> None:
        """Create, enrol."""
        with self.study():
            self.told.append("enrolled")

    def check(self) -> None:
        """There is none; or it is there with who is in it; or one that is refused in words, of
        which nobody was told."""
        try:
            with self.opened() as store:
                assert len(store.participants()) >= len(self.told)
        except SqueezefilmError:
            assert not self.told


class Answering(Job):
    """Every trial with a trace; answers that were acknowledged stand, once, in order."""

    def prepare(self) -> None:
        """Enrol."""
        self.study().close()

    def work(self) -> None:
        """Go through all that is left."""
        script = Script()
        with StudyStore.open(self.folder / "study.sqlite") as store:
            (who,) = store.participants()
            if who["answered"] == who["planned"]:
                return
            try:
                conduct(begin(store, who["uuid"]), Device(), script)
            finally:
                self.told += script.acknowledged

    def check(self) -> None:
        """All acknowledged is there with its traces."""
        with self.opened() as store:
            rows = store.rows(
                "SELECT t.number, r.traces FROM response r JOIN trial t ON t.uuid = r.trial"
            )
            assert {row["number"] for row in rows} >= set(self.told)
            assert len(self.told) == len(set(self.told))
            for row in rows:
                for name in json.loads(row["traces"]):
                    assert (store.traces / name).read_text().startswith("time_s")


class Giving(Answering):
    """Backed up, exported, merged: the answers stay, and what was given out is whole."""

    def prepare(self) -> None:
        """Two stations with answers."""
        super().prepare()
        super().work()
        other = self.study("other", station=1)
        conduct(begin(other, other.participants()[0]["uuid"]), Device(), Script())
        other.close()

    def work(self) -> None:
        """All three."""
        with self.opened() as store:
            self.backup = store.back_up()
            export_study(store, "csv")
            merge(store, self.folder / "other.sqlite")

    def check(self) -> None:
        """Every backup that has its name is a whole study."""
        super().check()
        for path in (self.folder / "study.backups").glob("*.sqlite"):
            with StudyStore.open(path) as backup:
                backup.require_whole()
                assert backup.participants()[0]["answered"] == len(self.told)


class Deleting(Giving):
    """Somebody is taken out: the others' answers stay; repeated, it is complete."""

    def prepare(self) -> None:
        """As for giving, merged, with a backup and an export."""
        super().prepare()
        Giving.work(self)
        with self.opened() as store:
            self.kept, self.gone = (one["uuid"] for one in store.participants())

    def work(self) -> None:
        """Delete the second."""
        with self.opened() as store:
            delete_participant(store, self.gone)

    def check(self) -> None:
        """The first one's answers are all there."""
        with self.opened() as store:
            (answered,) = (p["answered"] for p in store.participants() if p["uuid"] == self.kept)
            assert answered == len(self.told)

    def well(self) -> None:
        """Nothing of the other is left."""
        for path in (self.folder).rglob("study*/**/*"):
            assert self.gone.encode() not in (path.read_bytes() if path.is_file() else b"")


class Sitting(Job):
    """The lab prepares sittings: the one that runs goes on running until a new one is there."""

    def prepare(self) -> None:
        """A sitting that runs."""
        studies = self.lab()
        studies.create("biet2008-gratings", "one", 7)
        studies.enrol("one")
        self.running = self.made(studies)
        studies.close()

    def lab(self) -> Studies:
        """The lab's studies."""
        return Studies(self.folder)

    def made(self, studies: Studies) -> str:
        """A new sitting."""
        (who,) = studies.store("one").participants()
        asked = PrepareSitting(
            id=1,
            type="prepare sitting",
            study="one",
            participant=who["uuid"],
            device="none",
            consent="You may stop at any time.",
        )
        return str(studies.prepare(asked)["sitting"])

    def work(self) -> None:
        """Another, in the same lab and in a second one."""
        studies = self.lab()
        try:
            self.same = studies
            self.running = self.made(studies)
        finally:
            studies.close()

    def check(self) -> None:
        """In memory and in the file the last one runs, and only it; or one that nobody heard of."""
        for studies in (self.same, self.lab()):
            open_ones = [one.id for one in studies.sittings.of_study("one")]
            assert len(open_ones) == 1
            self.told.append(open_ones[0] == self.running)
        assert self.told[-2] == self.told[-1]
        studies.close()


class Recording(Job):
    """A record: what was acknowledged is read back."""

    rows = 0

    def work(self) -> None:
        """Write and sync."""
        name = f"{len(list(self.folder.iterdir()))}.sqft"
        self.path = self.folder / name
        self.rows = 0
        with TraceWriter(self.path, ("tick",), {}) as writer:
            try:
                for _ in range(5):
                    writer.append(np.full((3, 1), writer.acknowledged, dtype=float))
                    writer.sync()
            finally:
                self.rows = writer.acknowledged

    def check(self) -> None:
        """Nothing, or all that was acknowledged."""
        if self.path.exists():
            found = read_trace(self.path).rows[:, 0]
            assert found[: self.rows].tolist() == np.repeat(np.arange(0, self.rows, 3), 3).tolist()
        else:
            assert self.rows == 0


def tried(
    job: type[Job], kinds: str, step: int, folder: Path, disk: ctypes.CDLL
) -> dict[str, object]:
    """A job on disks that fail at every `step`-th call of a kind, once and from then on."""

    def attempt(at: int, on: bool) -> tuple[int, bool]:
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        one = job(folder)
        one.prepare()
        disk.disk_fails(KINDS[kinds], at, on)
        refused = _refused(one.work)
        calls = disk.disk_calls()
        disk.disk_fails(0, 0, 0)
        assert at or not refused, "it fails on a good disk"
        one.check()
        # The disk is well again: the same goes on, where it is not there already.
        again = _refused(one.work)
        assert job is Creating or not again
        one.check()
        if isinstance(one, Deleting):
            one.well()
        return calls, refused

    calls, _ = attempt(0, False)
    places = range(1, calls + 1, step)
    refused = 0
    for at in places:
        for on in (False, True):
            try:
                refused += attempt(at, on)[1]
            except BaseException:
                print(f"{job.__name__}, {kinds} {at} of {calls}, goes on: {on}", file=sys.stderr)
                raise
    return {
        "job": job.__name__, "kind": kinds, "calls": calls, "tried": 2 * len(places),
        "refused": refused,
    }  # fmt: skip


def _refused(work: Callable[[], None]) -> bool:
    try:
        work()
    except SqueezefilmError:
        return True
    return False


if __name__ == "__main__":
    library = ctypes.CDLL(None)
    jobs = {
        one.__name__: one for one in (Creating, Answering, Giving, Deleting, Sitting, Recording)
    }
    for name in sys.argv[3:]:
        for kind in KINDS:
            done = tried(jobs[name], kind, int(sys.argv[2]), Path(sys.argv[1]) / "work", library)
            print(json.dumps(done), flush=True)
