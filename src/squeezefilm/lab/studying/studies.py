"""Studies as the lab runs them: files, status, sittings, trials. Plain functions on one thread.

SQLite belongs to the thread that opened it, and a commit waits for the disk: everything here runs
on one thread of its own, and the server's loop goes on meanwhile.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field

from squeezefilm.core import presets
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.results import to_json, values_of
from squeezefilm.lab.files import existing, fresh, zipped
from squeezefilm.lab.studying.sittings import (
    SurfacesByHand,
    conditions_of,
    described,
)
from squeezefilm.lab.wire import FileName, Name, Request, Seed
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.conduct.again import why_begun_again
from squeezefilm.study.conduct.run import Response, StudyRun
from squeezefilm.study.conduct.sessions import (
    Exposure,
    begin_session,
    display_wanted,
    end_session,
)
from squeezefilm.study.conduct.study_device import StudyDevice
from squeezefilm.study.design.study_design import load_design
from squeezefilm.study.design.trials import expected_duration, trial_count
from squeezefilm.study.record.deletion import delete_participant
from squeezefilm.study.record.exports import export_study
from squeezefilm.study.record.merge import merge
from squeezefilm.study.record.sittings import FILE, Sitting, Sittings
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.record.tables import origin_of

if TYPE_CHECKING:
    from squeezefilm.study.conduct.playing_process import WorkerOrders

SUFFIX = ".sqlite"
Felt = Literal["on a device", "by hand", "lies there"]
"""Way in which a surface comes under the finger."""
Played = tuple[Stimulus, int]
"""A surface for a device, and its trial's seed."""
CONSENT = (
    "You will stroke surfaces with a finger and answer a question about each. It takes about "
    "{minutes} minutes, with breaks. You may stop at any time, without giving a reason, and ask "
    "for your data to be deleted. Your answers are kept under a number, not under your name."
)


class PrepareSitting(Request):
    """A sitting: what a `SessionConditions` has, and the consent's text."""

    study: Name
    participant: Name
    device: Name
    consent: str = Field(min_length=20, max_length=20_000)
    conditions: dict[str, str | float | None] = Field(default_factory=dict, max_length=20)
    acknowledged: bool = False


class Studies:
    """The studies in a lab's folder. Every method is called on one and the same thread."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder / "studies"
        self.sittings = Sittings(self.folder / FILE)
        self._open: dict[str, StudyStore] = {}
        self._runs: dict[str, StudyRun] = {}
        self.by_hand = SurfacesByHand()

    def close(self) -> None:
        """Close every file."""
        for store in self._open.values():
            store.close()
        self._open.clear()
        self._runs.clear()

    def listing(self) -> dict[str, Any]:
        """Preset designs, and studies that have a file."""
        designs = []
        for name in presets.study_names():
            designs.append({"name": name, "title": load_design(name).title})
        files = sorted(self.folder.glob(f"*{SUFFIX}")) if self.folder.is_dir() else []
        return {"designs": designs, "studies": [path.stem for path in files]}

    def plan(self, design: Name) -> dict[str, Any]:
        """Message of what a design is and how long it takes."""
        loaded = load_design(design)
        return {
            **described(loaded),
            "trials": trial_count(loaded),
            "duration_s": expected_duration(loaded),
            "consent": CONSENT.format(minutes=round(expected_duration(loaded) / 60)),
        }

    def create(self, design: Name, study: FileName, seed: Seed) -> dict[str, Any]:
        """A new study's file."""
        path = fresh(self.folder, study, SUFFIX)
        self._open[path.stem] = StudyStore.create(path, load_design(design), seed)
        return self.status(path.stem)

    def store(self, name: str) -> StudyStore:
        """A study's file, open."""
        if name not in self._open:
            self._open[name] = StudyStore.open(existing(self.folder, name, SUFFIX))
        return self._open[name]

    def status(self, study: Name) -> dict[str, Any]:
        """Design, participants with their progress, and sittings."""
        store = self.store(study)
        design = store.design
        return {
            "name": study,
            "seed": store.study["seed"],
            **described(design),
            "consent": CONSENT.format(minutes=round(expected_duration(design) / 60)),
            "participants": [
                {
                    "pseudonym": participant["uuid"],
                    "planned": participant["planned"],
                    "answered": participant["answered"],
                    "display": display_wanted(store, participant["uuid"]),
                }
                for participant in store.participants()
            ],
            "sittings": [
                {
                    "id": held.id,
                    "participant": held.participant,
                    "device": held.device,
                    "begun": held.session is not None,
                    "begun_again": why_begun_again(store, held.session) if held.session else "",
                    **self.by_hand.status(held.id),
                }
                for held in self.sittings.of_study(study)
            ],
            "origin": origin_of(store),
            "devices": devices(),
        }

    def enrol(self, study: Name) -> dict[str, Any]:
        """Enrol one more participant."""
        self.store(study).enrol()
        return {"changed": study, **self.status(study)}

    def prepare(self, asked: PrepareSitting) -> dict[str, Any]:
        """A sitting for a participant, to be consented to on the participant's page."""
        self.store(asked.study).require_participant(asked.participant)
        self.display_of(asked.study, asked.participant)
        if asked.device != "none" and not asked.acknowledged:
            raise InputError(
                "the exposure to airborne ultrasound was not acknowledged; read it and accept it, "
                "or lower the display's voltage"
            )
        # Checked now, so that a mistake is the experimenter's and not the participant's to see.
        conditions_of(asked.conditions, asked.consent, consented=False)
        fields = asked.own
        sitting = self.sittings.new(consent_text=fields.pop("consent"), **fields)
        return {"sitting": sitting.id, **self.status(asked.study)}

    def display_of(self, name: str, participant: str) -> str:
        """The display a participant's next trial is on. Raises `InputError` if there is none."""
        display = display_wanted(self.store(name), participant)
        if display is None:
            raise InputError(f"participant {participant} has answered every trial; enrol another")
        return display

    def orders(self, id: str) -> WorkerOrders:
        """Orders to a sitting's device: the display is its session's, or before it that of the next
        trial."""
        from squeezefilm.study.conduct.playing_process import WorkerOrders

        sitting = self.sittings.get(id)
        display = (
            self.display_of(sitting.study, sitting.participant)
            if sitting.session is None
            else str(self.run(sitting).session["display"])
        )
        return WorkerOrders(display, sitting.device, self.store(sitting.study).traces)

    def where(self, sitting: Name) -> dict[str, Any]:
        """Message of what the participant's page shows now; nothing in it gives an answer away."""
        held = self.sittings.get(sitting)
        design = self.store(held.study).design
        if held.ended:
            return {"state": "ended"}
        if held.session is None:
            return {"state": "consent", "consent": held.consent_text}
        run = self.run(held)
        if run.state in ("finished", "display changes"):
            return {"state": run.state}
        return {
            "state": "ready",
            "question": design.spoken_question,
            "task": design.task,
            "remaining": run.remaining,
        }

    def consent(self, id: str, exposure: Exposure | None, device: StudyDevice) -> dict[str, Any]:
        """The participant consented: the session begins, or says why it cannot."""
        sitting = self.sittings.get(id)
        if sitting.session is None and not sitting.ended:
            session = begin_session(
                self.store(sitting.study),
                sitting.participant,
                device,
                conditions_of(sitting.conditions, sitting.consent_text, consented=True),
                exposure,
                acknowledged=sitting.acknowledged,
            )
            self.sittings.change(id, session=session)
        return self.where(id)

    def present(self, sitting: Name) -> dict[str, Any]:
        """The next trial without what would give its answer away (`plays`: on a device; `by_hand`:
        somebody puts its surfaces there, and is told what, as the participant's page is not). It
        counts as presented once it is `shown`."""
        held = self.sittings.get(sitting)
        if held.session is None or held.ended:
            return self.where(sitting)
        following = self.run(held).next_trial(shown=False)
        if following is None:
            return self.where(sitting)
        trial = following.trial
        virtual = isinstance(following.surfaces[0], Stimulus)
        felt_only = trial.phase == "familiarisation"
        if held.device == "none":
            names = tuple(surface.name for surface in following.surfaces)
            self.by_hand.comes_next(sitting, names)
        return {
            "changed": held.study,
            "state": "trial",
            "token": following.token,
            "phase": trial.phase.replace("catch", "main"),
            "question": self.store(held.study).design.spoken_question,
            "alternatives": list(trial.alternatives),
            "numeric": trial.asks and not trial.alternatives,
            "surfaces": len(following.surfaces),
            "plays": held.device != "none" and virtual,
            "by_hand": held.device == "none" and virtual,
            # A real grating that lies there to be known has its name on it.
            "named": following.surfaces[0].name if felt_only else "",
            "pause_s": following.rest,
            "remaining": following.remaining,
            "interrupted": following.times_presented > 1,
        }

    def asked_to_feel(self, id: str, token: str, place: int) -> tuple[Felt, Played | None]:
        """Surface number `place` (from 0) of the trial that comes next is to be felt: how, and what
        a device plays for that. It counts as presented from now on, unless somebody has to put it
        there: then that is waited for.

        Raises `InputError` for another trial, or a surface that it has not.
        """
        sitting = self.sittings.get(id)
        if sitting.ended:
            raise InputError("this sitting has ended")
        trial = self.run(sitting).next_trial(shown=False)
        if trial is None or trial.token != token:
            raise InputError("this trial is not the one to be presented now; go on with the next")
        number, count = trial.trial.number, len(trial.surfaces)
        if not 0 <= place < count:
            raise InputError(f"trial {number} has {count} surfaces; asked: {place}")
        surface, virtual = trial.surfaces[place], isinstance(trial.surfaces[0], Stimulus)
        if virtual and sitting.device == "none":
            self.by_hand.wait(id, token, place)
            return "by hand", None
        if place == 0:
            self.run(sitting).next_trial()
        if not virtual:
            return "lies there", None
        if not isinstance(surface, Stimulus):
            raise InputError(f"'{surface.name}' is a real grating; no device plays it")
        return "on a device", (surface, trial.trial.seed)

    def in_place(self, id: str) -> tuple[str, int]:
        """The surface that was waited for is in place: from the first one on the trial counts as
        presented. Returns the study and the surface's place. Raises `InputError` for none."""
        sitting = self.sittings.get(id)
        token, place = self.by_hand.in_place(id)
        trial = self.run(sitting).next_trial(shown=False)
        if trial is None or trial.token != token:
            raise InputError("the trial whose surface was waited for is over")
        if place == 0:
            self.run(sitting).next_trial()
        return sitting.study, place

    def needs_device(self, id: str, token: str) -> bool:
        """True where an answer to this trial needs a device that played it: not one that is
        recorded already, and not one of a real grating."""
        sitting = self.sittings.get(id)
        if sitting.device == "none" or sitting.session is None:
            return False
        run = self.run(sitting)
        return not run.recorded(token) and isinstance(run.presented(token).surfaces[0], Stimulus)

    def respond(self, id: str, token: str, response: Response) -> dict[str, Any]:
        """Record an answer; it is on the disk when this returns."""
        sitting = self.sittings.get(id)
        run, store = self.run(sitting), self.store(sitting.study)
        query = "SELECT max(presented_utc) AS begun FROM presentation WHERE trial = ?"
        [known] = store.rows(query, [token])
        if known["begun"] is not None:
            # When it began to play or was put in place; the page's own clock may be anything.
            response = dataclasses.replace(response, started_utc=known["begun"])
        told = run.respond(token, response)
        self.by_hand.over(id)
        [row] = store.rows("SELECT phase FROM trial WHERE uuid = ?", [token])
        feedback = row["phase"] == "practice"
        return {
            **values_of(told, "number repeated remaining spoiled practice"),
            "right": told.right_answer if feedback else None,
            "correct": told.correct if feedback else None,
            "study": sitting.study,
        }

    def end(self, id: str, device: StudyDevice) -> dict[str, Any]:
        """End a sitting; its device is verified and the result recorded."""
        sitting = self.sittings.get(id)
        problems: tuple[str, ...] = ()
        if sitting.session is not None and not sitting.ended:
            verification = end_session(self.store(sitting.study), sitting.session, device)
            problems = verification.problems
        self.sittings.change(id, ended=True)
        self._runs.pop(id, None)
        self.by_hand.over(id)
        return {"problems": list(problems), **self.status(sitting.study)}

    def delete(self, name: str, participant: str) -> dict[str, Any]:
        """Take a participant out without a trace."""
        for sitting in self.sittings.of_study(name):
            if sitting.participant == participant:
                self._runs.pop(sitting.id, None)
        deleted = delete_participant(self.store(name), participant)
        return {"deleted": to_json(deleted), **self.status(name)}

    def export(self, study: Name, format: Annotated[str, Field(max_length=20)]) -> dict[str, Any]:
        """Export a study beside its file; `zip` holds the same in base64, for a link."""
        si.require_one_of("format", format, ("csv", "psych-ds"))
        path = export_study(self.store(study), format)  # type: ignore[arg-type] # checked above
        return {"folder": str(path.relative_to(self.folder.parent)), "zip": zipped(path)}

    def path(self, name: str) -> Path:
        """A study's file."""
        return existing(self.folder, name, SUFFIX)

    def merge(self, study: Name, other: Name) -> dict[str, Any]:
        """Take in the answers of another station's file in the folder."""
        path = existing(self.folder, other, SUFFIX)
        if other in self._open:
            self._open.pop(other).close()
        merged = merge(self.store(study), path)
        return {"merged": to_json(merged), **self.status(study)}

    def run(self, sitting: Sitting) -> StudyRun:
        """The run of a sitting that was consented to."""
        if sitting.id not in self._runs:
            if sitting.session is None:
                raise InputError("this sitting was not consented to yet")
            self._runs[sitting.id] = StudyRun(self.store(sitting.study), sitting.session)
        return self._runs[sitting.id]


def devices() -> list[str]:
    """Devices for a sitting's surfaces beside nothing: the twin, and the ports there are."""
    from serial.tools import list_ports

    return ["twin", *sorted(f"serial:{port.device}" for port in list_ports.comports())]
