"""A study rehearsed: simulated participants do every trial of its file, as people would.

Sessions, presentations and answers are written as for people, so that analysis and exports can be
tried before anybody is asked. The sessions say that they are simulated, and analyses take it over.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from squeezefilm.errors import InputError
from squeezefilm.perception.observer import Observer
from squeezefilm.study.conduct.run import Response, StudyRun
from squeezefilm.study.conduct.sessions import (
    SessionConditions,
    begin_session,
    display_wanted,
    end_session,
)
from squeezefilm.study.conduct.study_device import NoDevice
from squeezefilm.study.design.trials import trials
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.record.tables import SIMULATED, SIMULATED_NOTE, origin_of
from squeezefilm.study.simulated.answers import (
    SimulatedAnswers,
    answers_of,
    simulate_participants,
)
from squeezefilm.study.simulated.chain_tables import chain_tables
from squeezefilm.study.simulated.participants import SimulatedStudy

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
    """Enrol simulated participants and let them answer everything. Returns their pseudonyms.

    Trials are answered as `simulate_participants` says for the study's seed; of match-to-sample it
    says main trials only, practice and catch trials are then answered with what is right. It may be
    interrupted: whoever has begun can be gone on with.

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
    design = store.design
    tables = chain_tables(design, observer, progress=tell)
    found = []
    for count in range(participants):
        who = store.enrol()
        number = int(store.require_participant(who)["number"])
        tell(f"simulated participant {count + 1} of {participants}")
        answered = simulate_participants(
            design, observer, number + 1, int(store.study["seed"]), tables
        )
        _answer_everything(store, who, _responses(answered, number))
        found.append(who)
    return tuple(found)


def _responses(study: SimulatedStudy | SimulatedAnswers, person: int) -> dict[int, Response]:
    """What a person answers, by the number of the trial."""
    answers = answers_of(study) if isinstance(study, SimulatedStudy) else study.answers
    names, mine = answers.design.answers, answers.participant == person
    asked = [one.number for one in trials(answers.design, person, study.seed) if one.asks]
    # A simulated match-to-sample study counts the trials that ask.
    counted = isinstance(study, SimulatedStudy)
    found = {}
    for at in np.flatnonzero(mine):
        number = int(answers.number[at])
        number = asked[number - 1] if counted else number
        estimate = float(answers.estimate[at])
        found[number] = Response(
            choice=names[answers.choice[at]] if answers.choice[at] >= 0 else "",
            estimate=None if math.isnan(estimate) else estimate,
            response_time=float(answers.response_time[at]),
        )
    return found


def _answer_everything(store: StudyStore, who: str, known: dict[int, Response]) -> None:
    while display_wanted(store, who) is not None:
        session = begin_session(store, who, NoDevice(), _CONDITIONS, None, acknowledged=False)
        run = StudyRun(store, session)
        while (presentation := run.next_trial()) is not None:
            trial = presentation.trial
            response = Response()
            if trial.asks:
                response = known.get(trial.number, Response(choice=trial.answer))
            run.respond(presentation.token, response)
        end_session(store, session, NoDevice())
