"""A study rehearsed: simulated participants do every trial of its file, as people would.

Sessions, presentations and answers are written as for people, so that analysis and exports can be
tried before anybody is asked. The sessions say that they are simulated, and analyses take it over.
"""

from __future__ import annotations

from collections.abc import Callable

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
from squeezefilm.study.record.store import StudyStore
from squeezefilm.study.record.tables import SIMULATED, SIMULATED_NOTE, origin_of
from squeezefilm.study.simulated.chain_tables import chain_tables
from squeezefilm.study.simulated.participants import SimulatedStudy, simulate_participants

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

    Main trials are answered as `simulate_participants` says for the study's seed, practice and
    catch trials with what is right. It may be interrupted: whoever has begun can be gone on with.

    Raises:
        InputError: a number out of range, a study that people took part in, one of several
            stations, or another task than match-to-sample.
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
        answers = simulate_participants(
            design, observer, number + 1, int(store.study["seed"]), tables
        )
        tell(f"simulated participant {count + 1} of {participants}")
        _answer_everything(store, who, answers, number)
        found.append(who)
    return tuple(found)


def _answer_everything(store: StudyStore, who: str, answers: SimulatedStudy, number: int) -> None:
    names = store.design.answers
    place = {int(n): k for k, n in enumerate(answers.number[number])}
    asked = 0
    while display_wanted(store, who) is not None:
        session = begin_session(store, who, NoDevice(), _CONDITIONS, None, acknowledged=False)
        run = StudyRun(store, session)
        while (presentation := run.next_trial()) is not None:
            trial = presentation.trial
            if not trial.asks:
                run.respond(presentation.token, Response())
                continue
            if trial.phase == "main":
                k = place[asked]
                choice = names[int(answers.choice[number, k])]
                time = float(answers.response_time[number, k])
                run.respond(presentation.token, Response(choice=choice, response_time=time))
            else:
                run.respond(presentation.token, Response(choice=trial.answer))
            asked += 1
        end_session(store, session, NoDevice())
