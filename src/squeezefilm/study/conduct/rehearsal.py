"""A study rehearsed: simulated participants do every trial of its file, as people would.

Sessions, presentations and answers are written as for people, so that analysis and exports can be
tried before anybody is asked. The sessions say that they are simulated, and analyses take it over.
So do the paths of their fingers, which a plain hand makes: strokes to and fro along x, or free
exploration (`physics.perception.free_hand`), at the speed and force of their finger class.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.formats.traces import Table, csv_text
from squeezefilm.physics.display import Display
from squeezefilm.physics.perception.free_hand import SAYS
from squeezefilm.physics.perception.observer import FingerClass, Observer
from squeezefilm.physics.perception.percepts import exploration
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.physics.render.motion.finger_path import FingerPath
from squeezefilm.study.conduct.again import spoiled_by
from squeezefilm.study.conduct.run import Presentation, Response, StudyRun
from squeezefilm.study.conduct.sessions import (
    SessionConditions,
    begin_session,
    display_wanted,
    end_session,
)
from squeezefilm.study.conduct.study_device import NoDevice, TrialMotion
from squeezefilm.study.design.matching import Exploring
from squeezefilm.study.design.trials import trials
from squeezefilm.study.record.exploration import PATH_PERIOD, explored_table
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.record.tables import SIMULATED, SIMULATED_NOTE, origin_of
from squeezefilm.study.simulated.answers import (
    SimulatedStudy,
    simulate_participants,
)
from squeezefilm.study.simulated.chain_tables import ChainTables, chain_tables
from squeezefilm.study.simulated.felt_surfaces import free_path
from squeezefilm.study.simulated.participants import finger_of

MOST_PEOPLE = 200
_CONDITIONS = SessionConditions(
    consent=True, consent_form="none: simulated", room="none", note=SIMULATED_NOTE
)


def rehearse(
    store: StudyStore,
    observer: Observer,
    participants: int,
    *,
    progress: Callable[[str], None] | None = None,
) -> tuple[str, ...]:
    """Let simulated participants answer everything, until the file has as many as asked for.

    Returns the pseudonyms of all its simulated participants. Stopped or killed it goes on where it
    stopped, with the same people: asked again for as many, it finishes those who have begun and
    enrols only who is missing. Trials are answered as `simulate_participants` says for the study's
    seed; of match-to-sample it says main trials only, practice and catch trials are then answered
    with what is right.

    Raises:
        InputError: a number out of range, a study that people took part in, or one of several
            stations.
        RecordError: the file could not be written.
    """
    if not 1 <= participants <= MOST_PEOPLE:
        raise InputError(f"participants = {participants}; from 1 to {MOST_PEOPLE} may rehearse")
    if origin_of(store) not in (SIMULATED, "nobody"):
        raise InputError(
            f"people took part in {store.path.name}; rehearse in a file of its own, so that nobody "
            "can take simulated answers for theirs"
        )
    if store.study["stations"] != 1:
        raise InputError("a file of one of several stations is not rehearsed; make another")
    tell = progress or (lambda _: None)
    people, design = _simulated(store), store.design
    missing = participants - len(people)
    if missing <= 0 and all(display_wanted(store, who) is None for who in people):
        return tuple(people)
    tables = chain_tables(design, observer, progress=tell)
    people += [store.enrol(simulated=True) for _ in range(missing)]
    unfinished = [who for who in people if display_wanted(store, who) is not None]
    # What somebody answers depends on their number, and on nobody else.
    numbers = {who: int(store.require_participant(who)["number"]) for who in unfinished}
    most = max(numbers.values()) + 1
    answered = simulate_participants(design, observer, most, int(store.study["seed"]), tables)
    for who in unfinished:
        tell(f"simulated participant {people.index(who) + 1} of {len(people)}")
        hand = _Hand(tables, answered, numbers[who])
        _answer_everything(store, who, _responses(answered, numbers[who]), hand)
    return tuple(people)


def _simulated(store: StudyStore) -> list[str]:
    """Participants enrolled by a rehearsal, in the order of their numbers; of the files of older
    versions those who have a session, which is simulated."""
    sat = {row["participant"] for row in store.rows("SELECT DISTINCT participant FROM session")}
    return [
        row["uuid"]
        for row in store.participants()
        if row["uuid"] in sat or row["uuid"] == store.simulated_pseudonym(row["number"])
    ]


def _responses(study: SimulatedStudy, person: int) -> dict[int, Response]:
    """Answers of a person by the number of the trial."""
    answers = study.answers
    names, mine = answers.design.answers, answers.participant == person
    asked = [trial.number for trial in trials(answers.design, person, study.seed) if trial.asks]
    responses = {}
    for at in np.flatnonzero(mine):
        number = int(answers.number[at])
        # What was matched is numbered among the trials that ask.
        number = number if study.matches is None else asked[number - 1]
        estimate = float(answers.estimate[at])
        responses[number] = Response(
            choice=names[answers.choice[at]] if answers.choice[at] >= 0 else "",
            estimate=None if math.isnan(estimate) else estimate,
            response_time=float(answers.response_time[at]),
        )
    return responses


# Of surfaces that are kept with what a hand left on them.
_MOST_MOTIONS = 64


class _Hand:
    """Explores a person's surfaces as their answers assume."""

    def __init__(self, tables: ChainTables, answered: SimulatedStudy, person: int) -> None:
        design, fingers = tables.design, tables.fingers
        matches = answered.matches
        finger = fingers[
            finger_of(person, len(fingers), answered.seed)
            if matches is None
            else int(matches.finger[person])
        ]
        self._design, self._force = design, finger.normal_force
        self._paths = {
            name: path_of(design.exploring, plate, tables.observer, finger)
            for name, plate in zip(design.displays, tables.plates, strict=True)
        }
        # The same hand leaves the same path on a surface each time. Surfaces are kept with it,
        # since those that a series chooses are made anew for each trial.
        self._motions: dict[tuple[str, int], tuple[Stimulus, TrialMotion]] = {}

    def explored(self, presentation: Presentation) -> tuple[TrialMotion, ...]:
        """Exploration of each virtual surface; none where the design's rules would not let it
        count, for the hand would break them again."""
        display = presentation.trial.display
        motions = tuple(
            self._motion(display, surface)
            for surface in presentation.surfaces
            if isinstance(surface, Stimulus)
        )
        return () if spoiled_by(self._design, motions) else motions

    def _motion(self, display: str, surface: Stimulus) -> TrialMotion:
        key = display, id(surface)
        if key not in self._motions:
            if len(self._motions) >= _MOST_MOTIONS:
                self._motions.clear()
            path, exploring = self._paths[display], self._design.exploring
            self._motions[key] = surface, rehearsed(path, exploring, surface, self._force)
        return self._motions[key][1]


def _answer_everything(
    store: StudyStore, who: str, known: dict[int, Response], hand: _Hand
) -> None:
    while display_wanted(store, who) is not None:
        session = begin_session(store, who, NoDevice(), _CONDITIONS, None, acknowledged=False)
        run = StudyRun(store, session)
        while (presentation := run.next_trial()) is not None:
            trial = presentation.trial
            response = Response()
            if trial.asks:
                response = known.get(trial.number, Response(choice=trial.answer))
            response = dataclasses.replace(response, explorations=hand.explored(presentation))
            run.respond(presentation.token, response)
        end_session(store, session, NoDevice())


_STROKES = "Strokes to and fro along x, each pass of least jerk, as the simulated answers assume."


def path_of(
    exploring: Exploring, display: Display, observer: Observer, finger: FingerClass
) -> FingerPath:
    """Path by which a finger of that class explores a surface of a display in a rehearsal.

    Raises `InputError` for free exploration of a ring.
    """
    if exploring == "free":
        return free_path(display, observer, finger)
    strokes = exploration(observer, finger)
    times = np.append(np.arange(0.0, strokes.duration, PATH_PERIOD / 5), strokes.duration)
    return FingerPath(times, strokes.position(times), np.zeros(times.size))


def rehearsed(
    path: FingerPath, exploring: Exploring, stimulus: Stimulus, normal_force: si.Newton
) -> TrialMotion:
    """Motion along a path over a surface at a force (N), as a device would tell it."""
    times = np.arange(0.0, path.duration, PATH_PERIOD)
    x, y = path.place(times)
    about = {
        "device": "none: a simulated hand",
        "assumed": SAYS if exploring == "free" else _STROKES,
        "stimulus": stimulus.name,
        "surface_sha256": stimulus.surface_sha256,
    }
    table = Table({"time_s": times, "x_m": x, "y_m": y}, about)
    found = explored_table(table)
    return TrialMotion(
        path_length=found.path_length,
        mean_speed=found.mean_speed,
        mean_normal_force=normal_force,
        trace=csv_text(table),
        touch=1.0,
    )
