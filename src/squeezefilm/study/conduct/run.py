"""A participant's run through a study, one trial after the other: present, respond, record.

The study's file is the only state. The next trial is the first planned one without an answer,
so a run that was killed goes on exactly where it stopped, in the same order, in another process
or on another day. An answer is handed in with its trial's token and is on the disk before
`respond` returns; handing it in again changes nothing and returns what was recorded.
"""

from __future__ import annotations

import dataclasses
import json
import sqlite3
import time
import uuid
from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any, Literal

from squeezefilm import __version__
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.results import to_json
from squeezefilm.physics.perception.stimuli import Grating, Stimulus
from squeezefilm.study.adaptive.series import adaptive_method, hears_choice
from squeezefilm.study.conduct.again import COUNTED, practise_again, set_aside, spoiled_by
from squeezefilm.study.conduct.sessions import display_wanted, next_planned
from squeezefilm.study.conduct.study_device import TrialMotion
from squeezefilm.study.design.trials import Trial
from squeezefilm.study.record.store import Row, StudyStore, insert, utc_now
from squeezefilm.study.record.tables import known

State = Literal["ready", "presented", "display changes", "finished"]


@dataclass(frozen=True)
class Presentation:
    """A trial to be presented now.

    Attributes:
        trial: as planned; an adaptive series has its stimuli filled in.
        token: to hand the answer in with.
        surfaces: what is felt, in order; real gratings while people get to know them.
        intensity: of an adaptive series' comparison (1), else None.
        times_presented: this one included; above 1 after an interruption.
        remaining: trials of the participant that are not answered yet, this one included.
        rest: what is left of the break before it (s), which began with the answer before.
    """

    trial: Trial
    token: str
    surfaces: tuple[Stimulus | Grating, ...]
    intensity: float | None
    times_presented: int
    remaining: int
    rest: si.Second


# `StudyRun._response_row` writes these fields, all but `explorations`, by `to_json` to the columns
# of the table `response` (`study.record.schema`) of their names with units: each needs its column.
@dataclass(frozen=True)
class Response:
    """A participant's answer and its times.

    `choice` is one of the trial's alternatives, `estimate` a number above 0 where magnitudes are
    estimated; both stay empty while gratings are only felt. Monotonic times (s) are the clock of
    the station, `response_time` (s) runs from when an answer could be given.
    """

    choice: str = ""
    estimate: float | None = None
    response_time: si.Second | None = None
    started_monotonic: si.Second = 0.0
    ended_monotonic: si.Second = 0.0
    started_utc: str = field(default_factory=utc_now)
    ended_utc: str = field(default_factory=utc_now)
    explorations: tuple[TrialMotion, ...] = ()


@dataclass(frozen=True)
class Acknowledgement:
    """Receipt for an answer that is on the disk. `repeated` says that it was there before this
    call; what was recorded first stands. `correct` is None where nothing is right or wrong."""

    number: int
    choice: str
    estimate: float | None
    correct: bool | None
    right_answer: str
    repeated: bool
    remaining: int
    spoiled: str = ""
    practice: str = ""


class StudyRun:
    """A session of a participant: `next_trial`, present it, `respond`, until `state` is "finished"
    or "display changes" (then begin a session on the other display). `session` is its row."""

    def __init__(
        self, store: StudyStore, session: str, *, clock: Callable[[], si.Second] = time.monotonic
    ) -> None:
        rows = store.rows("SELECT * FROM session WHERE uuid = ?", [session])
        if not rows:
            raise InputError(f"there is no session {session} in {store.path}; begin one first")
        self._store = store
        self.session: Row = rows[0]
        self._presented: str | None = None
        self._clock = clock
        # The trial with a break before it, what was left of that, and when that was seen.
        self._break: tuple[str, si.Second, si.Second] = ("", 0.0, 0.0)
        self._answered_here = False

    @property
    def participant(self) -> str:
        """The pseudonym."""
        return str(self.session["participant"])

    @property
    def state(self) -> State:
        """State of the run; "presented" if a trial of this object waits for its answer."""
        display = display_wanted(self._store, self.participant)
        if display is None:
            return "finished"
        if display != self.session["display"]:
            return "display changes"
        return "ready" if self._presented is None else "presented"

    @property
    def remaining(self) -> int:
        """Trials without an answer."""
        rows = self._store.rows(
            "SELECT count(*) - count(r.trial) AS n FROM trial t LEFT JOIN response r "
            f"ON r.trial = t.uuid WHERE t.participant = ? AND {COUNTED}",
            [self.participant],
        )
        return int(rows[0]["n"])

    def next_trial(self, *, shown: bool = True) -> Presentation | None:
        """The trial to present now; None if none is left on this display.

        That it is presented is on the disk when this returns. Called again before the answer, it
        gives the same trial with the same token and counts another presentation. Not `shown` it
        only says what comes next: ask so while the participant rests or the surface is being put
        in place, and again when it is shown. Raises `RecordError` if nothing could be written: then
        nothing may be presented.
        """
        row = next_planned(self._store, self.participant)
        if row is None or row["display"] != self.session["display"]:
            return None
        if shown:
            self._store.add(
                "presentation",
                {
                    "uuid": str(uuid.uuid4()),
                    "trial": row["uuid"],
                    "session": self.session["uuid"],
                    "presented_utc": utc_now(),
                },
            )
            self._presented = row["uuid"]
        return self._presentation(row)

    def respond(self, token: str, response: Response) -> Acknowledgement:
        """Record an answer. When this returns, it is on the disk.

        Args:
            token: of the presentation.
            response: the answer.

        Raises:
            InputError: a token of no trial of this participant, or of one that is not its turn; an
                answer that the trial does not offer.
            RecordError: nothing was recorded; hand the same answer in again when there is room.
        """
        planned = self._planned(token)
        if (known := self._recorded(planned)) is not None:
            return known
        first = next_planned(self._store, self.participant)
        assert first is not None
        if first["uuid"] != token:
            raise InputError(
                f"trial {planned['number']} is not the one to be answered now, "
                f"{first['number']} is; present it first"
            )
        if not first["presentations"]:
            raise InputError(f"trial {planned['number']} was not presented yet; call next_trial")
        felt = self._presentation(first)
        _require_answer(felt.trial, response)
        names = [self._store.save_trace(e.trace) for e in response.explorations if e.trace]
        names += [e.raw_trace for e in response.explorations if e.raw_trace]
        row = self._response_row(felt, response, names)
        with self._store.transaction() as write:
            # Another process with the same participant may have been faster.
            done = write.execute("SELECT 1 FROM response WHERE trial = ?", [token]).fetchone()
            practice = ""
            if done is None:
                insert(write, "response", row)
                practice = self._come_again(write, planned, felt.trial, response)
        self._presented, self._answered_here = None, True
        known = self._recorded(planned)
        assert known is not None
        return dataclasses.replace(known, repeated=done is not None, practice=practice)

    def _come_again(
        self, write: sqlite3.Connection, planned: Row, trial: Trial, response: Response
    ) -> str:
        """Plan a spoiled trial again, and practice that was not good enough."""
        reason = spoiled_by(self._store.design, response.explorations) if trial.asks else ""
        if reason:
            set_aside(write, [planned], self.session["uuid"], reason)
        if trial.phase == "practice":
            return practise_again(self._store, write, self.participant, trial.display)
        return ""

    def presented(self, token: str) -> Presentation:
        """What is presented with a token. Raises `InputError` for a token of no trial of this
        participant, or of one that is answered or was not presented."""
        planned = self._planned(token)
        first = next_planned(self._store, self.participant)
        if first is None or first["uuid"] != token or not first["presentations"]:
            raise InputError(f"trial {planned['number']} is not being presented; call next_trial")
        return self._presentation(first)

    def recorded(self, token: str) -> bool:
        """True where this trial's answer is on the disk. Raises `InputError` for a token of no
        trial of this participant."""
        return self._recorded(self._planned(token)) is not None

    def _rest_left(self, row: Row) -> si.Second:
        whole = float(row["pause_s"])
        if not whole:
            return 0.0
        token, left, seen = self._break
        if token != row["uuid"]:
            left, seen = self._rest_after_answer(whole), self._clock()
            self._break = row["uuid"], left, seen
        # Its beginning was seen here: the wall clock may be set meanwhile, this one is not.
        return max(left - (self._clock() - seen), 0.0)

    def _rest_after_answer(self, whole: si.Second) -> si.Second:
        """Rest (s) of a break that began with the answer before, by the wall clock."""
        [last] = self._store.rows(
            "SELECT max(r.ended_utc) AS ended FROM response r JOIN trial t ON t.uuid = r.trial "
            "WHERE t.participant = ?",
            [self.participant],
        )
        if self._answered_here or last["ended"] is None:
            return whole
        gone = datetime.fromisoformat(utc_now()) - datetime.fromisoformat(last["ended"])
        # A clock that was set back meanwhile makes no break longer than it was planned.
        return min(max(whole - gone.total_seconds(), 0.0), whole)

    def _planned(self, token: str) -> dict[str, Any]:
        rows = self._store.rows(
            "SELECT * FROM trial WHERE uuid = ? AND participant = ?", [token, self.participant]
        )
        if not rows:
            raise InputError("this token belongs to no trial of this participant")
        return rows[0]

    def _recorded(self, planned: Row) -> Acknowledgement | None:
        rows = self._store.rows("SELECT * FROM response WHERE trial = ?", [planned["uuid"]])
        if not rows:
            return None
        row = rows[0]
        aside = self._store.rows("SELECT reason FROM set_aside WHERE trial = ?", [planned["uuid"]])
        return Acknowledgement(
            number=planned["number"],
            choice=row["choice"],
            estimate=row["estimate"],
            correct=None if row["correct"] is None else bool(row["correct"]),
            right_answer=planned["answer"],
            repeated=True,
            remaining=self.remaining,
            spoiled=aside[0]["reason"] if aside else "",
        )

    def _presentation(self, row: Row) -> Presentation:
        """The presentation of a row that `next_planned` gave."""
        trial = Trial.of_row(row)
        return Presentation(
            trial,
            row["uuid"],
            *self._surfaces(trial),
            row["presentations"] + 1,
            self.remaining,
            self._rest_left(row),
        )

    def _surfaces(self, trial: Trial) -> tuple[tuple[Stimulus | Grating, ...], float | None]:
        """What is felt in a trial, and an adaptive series' intensity."""
        design = self._store.design
        if trial.phase == "familiarisation" and design.alternatives:
            gratings = {alternative.name: alternative for alternative in design.alternatives}
            return tuple(gratings[name] for name in trial.stimuli), None
        if not trial.adaptive:
            return tuple(design.stimulus(name) for name in trial.stimuli), None
        series, task = design.series(trial.adaptive), design.described
        reference, how = design.stimulus(design.reference), (trial.reference_first, trial.answer)
        if not task.presents_comparison(*how):
            return task.arranges(reference, reference, *how), 0.0
        answers = self._store.rows(
            "SELECT r.intensity, r.correct, r.choice FROM response r "
            "JOIN trial t ON t.uuid = r.trial WHERE "
            f"t.participant = ? AND t.adaptive = ? AND t.display = ? AND {COUNTED} "
            "ORDER BY t.block, t.number",
            [self.participant, series.name, trial.display],
        )
        given = (
            (a["intensity"], a["choice"] if hears_choice(series, task) else bool(a["correct"]))
            for a in answers
        )
        intensity = adaptive_method(series, given, design.task).next_stimulus()
        comparison = design.comparison(series, intensity)
        return task.arranges(reference, comparison, *how), intensity

    def _response_row(
        self, presentation: Presentation, response: Response, traces: list[str]
    ) -> dict[str, Any]:
        trial, felt = presentation.trial, response.explorations
        correct = None
        if trial.asks and trial.answer:
            correct = int(response.choice == trial.answer)
        answered = to_json(dataclasses.replace(response, explorations=()))
        del answered["explorations"]
        return {
            "trial": presentation.token,
            "session": self.session["uuid"],
            "stimuli": json.dumps([surface.name for surface in presentation.surfaces]),
            "intensity": presentation.intensity,
            "correct": correct,
            **answered,
            "path_length_m": known(sum(motion.path_length for motion in felt)) if felt else None,
            "mean_speed_m_per_s": _mean([motion.mean_speed for motion in felt]),
            "mean_normal_force_N": _mean([motion.mean_normal_force for motion in felt]),
            "traces": json.dumps(traces),
            "seed": trial.seed,
            "squeezefilm_version": __version__,
            "device_sha256": self.session["device_sha256"],
            "calibration_sha256": self.session["calibration_sha256"],
        }


def _mean(values: list[float]) -> float | None:
    return known(sum(values) / len(values)) if values else None


def _require_answer(trial: Trial, response: Response) -> None:
    for name in ("started_monotonic", "ended_monotonic"):
        si.require(name, getattr(response, name), si.Unit("s"))
    if response.response_time is not None:
        si.require("response_time", response.response_time, si.Unit("s"), at_least=0.0)
    if not trial.asks:
        if response.choice or response.estimate is not None:
            raise InputError(f"trial {trial.number} is only felt; it takes no answer")
        return
    if trial.alternatives:
        if response.choice not in trial.alternatives or response.estimate is not None:
            raise InputError(
                f"'{response.choice}' is no answer to trial {trial.number}; answers: "
                f"{', '.join(trial.alternatives)}",
                quantity="choice",
            )
        return
    if response.estimate is None or response.choice:
        raise InputError(
            f"trial {trial.number} asks for a number above 0, as `estimate`", quantity="estimate"
        )
    si.require("estimate", response.estimate, above=0.0, at_most=1e12)
