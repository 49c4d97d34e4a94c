"""A study rehearsed: simulated participants do every trial of its file, as people would.

Sessions, presentations and answers are written as for people, so that analysis and exports can be
tried before anybody is asked. The sessions say that they are simulated, and analyses take it over.
Nothing is recorded of their fingers: for paths run a session on the twin.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from squeezefilm.core.errors import InputError
from squeezefilm.physics.perception.observer import Observer
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
    SimulatedStudy,
    simulate_participants,
)
from squeezefilm.study.simulated.chain_tables import chain_tables

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
        _answer_everything(store, who, _responses(answered, numbers[who]))
    return tuple(people)


def _simulated(store: StudyStore) -> list[str]:
    """Participants enrolled by a rehearsal, in the order of their numbers."""
    every = ((row["uuid"], row["number"]) for row in store.participants())
    return [who for who, number in every if who == store.simulated_pseudonym(number)]


def _responses(study: SimulatedStudy, person: int) -> dict[int, Response]:
    """Answers of a person by the number of the trial."""
    answers = study.answers
    names, mine = answers.design.answers, answers.participant == person
    asked = [trial.number for trial in trials(answers.design, person, study.seed) if trial.asks]
    responses = {}
    for at in np.flatnonzero(mine):
        number = int(answers.number[at])
        # What was matched is numbered among the trials that ask.
        number = asked[number - 1] if study.is_matching else number
        estimate = float(answers.estimate[at])
        responses[number] = Response(
            choice=names[answers.choice[at]] if answers.choice[at] >= 0 else "",
            estimate=None if math.isnan(estimate) else estimate,
            response_time=float(answers.response_time[at]),
        )
    return responses


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
