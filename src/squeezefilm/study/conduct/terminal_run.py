"""A session from the command line: open or create the file, begin, present and ask, end."""

from __future__ import annotations

import contextlib
import dataclasses
import math
import tempfile
import time
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from squeezefilm.core import config
from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.formats.traces import Table, csv_text
from squeezefilm.core.progress import SayProgress
from squeezefilm.core.results import write_whole
from squeezefilm.physics.display import Display
from squeezefilm.physics.perception.observer import load_observer
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.conduct.again import COUNTED, why_begun_again
from squeezefilm.study.conduct.run import Acknowledgement, Presentation, Response, StudyRun
from squeezefilm.study.conduct.sessions import (
    Exposure,
    SessionConditions,
    begin_session,
    display_wanted,
    end_session,
    exposure,
)
from squeezefilm.study.conduct.study_device import ByHand, NoDevice, StudyDevice, TrialMotion
from squeezefilm.study.design.study_design import load_design
from squeezefilm.study.design.trials import expected_duration
from squeezefilm.study.identification.condition_means import judged
from squeezefilm.study.record.deletion import remove_rows
from squeezefilm.study.record.store import StudyStore, utc_now


def ask_acknowledgement(statement: str, read: Callable[[str], str] = input) -> bool:
    """Show the exposure to airborne ultrasound and ask whether it is acknowledged.

    Raises `InputError` where nobody can be asked.
    """
    print(f"\n{statement}\nPeople and animals nearby are exposed too; children may hear it.")
    try:
        return read("Type 'yes' to acknowledge it: ").strip().lower() == "yes"
    except EOFError as error:
        raise InputError(
            "nobody is there to acknowledge the exposure; give acknowledge_ultrasound"
        ) from error


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Desk:
    """Where a session is held: on which device, in which conditions, and who is told what.

    Attributes:
        drive: "none", "twin" (behind a port, in real time) or "serial:PORT", whose pickup gives
            `amplitude_per_pickup` (m/V; None if not calibrated).
        conditions: TOML file of `SessionConditions`; `consent` counts beside what it says.
        acknowledge: is shown the statement on airborne ultrasound, and says whether it may go on.
        tell: is told who was enrolled, and what the experimenter has to know at the end.
    """

    drive: str = "none"
    amplitude_per_pickup: si.MetrePerVolt | None = None
    conditions: Path | None = None
    consent: bool = False
    acknowledge: Callable[[str], bool] = ask_acknowledgement
    tell: Callable[[str], None] = print


def open_study(
    path: Path,
    design: str | Path,
    seed: int | None,
    station: int | None = None,
    stations: int | None = None,
) -> StudyStore:
    """The study's file, created if it is not there: with seed 0 and for the only station unless
    others are said.

    Seed and station of a file that is there are its own; they need not be said again. Raises
    `InputError` if the file is of another design, or of another seed or station than was said.
    """
    wanted = load_design(design)
    if not path.exists():
        return StudyStore.create(
            path, wanted, seed or 0, station=station or 0, stations=stations or 1
        )
    store = StudyStore.open(path)
    here = store.design.sha256
    own = store.study["seed"]
    if here != wanted.sha256 or seed not in (None, own):
        store.close()
        said = "" if seed is None else f" with seed {seed}"
        raise InputError(
            f"{path} is of design {here[:12]} with seed {own}; asked for is "
            f"{wanted.sha256[:12]}{said}; leave seed out, or give another store"
        )
    of, every = store.study["station"], store.study["stations"]
    if station not in (None, of) or stations not in (None, every):
        store.close()
        raise InputError(
            f"{path} is of station {of} of {every}, which decides the orders of its participants; "
            "leave station and stations out, or give another store"
        )
    return store


Mark = Callable[[str, si.Second | None], None]
"""Function that is told what happened and when (s, the run's clock; now, without a moment)."""


def run_session(
    store: StudyStore,
    participant: str | None,
    desk: Desk,
    examiner: Examiner,
    *,
    progress: Callable[[], AbstractContextManager[SayProgress]] | None = None,
    by_hand: Callable[[str], None] | None = None,
    mark: Mark = lambda *_: None,
    placed: Callable[[], None] | None = None,
) -> str:
    """Run a session on the display that the participant's next trial needs. Returns how it ended.

    Without a participant somebody new is enrolled and named by `desk.tell`; not so if the session
    cannot start. `progress` shows what goes on while it is open; it is closed whenever anybody is
    asked. Where no device plays `by_hand` is told which surface to put under the finger,
    which the participant must not read, and `placed` returns when it is there: without one the
    question comes, and the response time runs, as soon as the surface is asked for. `mark` is told
    what happens when, see `conduct`. Raises what `begin_session` and `conduct` raise.
    """
    sitting = _sitting(desk.conditions, desk.consent)
    shown = progress or (lambda: contextlib.nullcontext(lambda _: None))
    who = participant or store.enrol()
    with contextlib.ExitStack() as closing:
        try:
            display = display_wanted(store, who)
            if display is None:
                return f"participant {who} has answered every trial"
            with shown() as step:
                device, exposed = _device(desk, store, display, step, closing, by_hand)
            acknowledged = exposed is not None and desk.acknowledge(exposed.statement)
            with shown() as step:
                if exposed is not None:
                    step("the device is verified: keep fingers off")
                session = begin_session(
                    store, who, device, sitting, exposed, acknowledged=acknowledged
                )
        except BaseException:
            if participant is None:
                remove_rows(store, who)
            raise
        desk.tell(f"participant {who}: go on with --participant {who}")
        again = why_begun_again(store, session)
        if again:
            desk.tell(again)
        run = StudyRun(store, session)
        try:
            placed = placed if desk.drive == "none" else None
            count = conduct(run, device, examiner, mark=mark, placed=placed)
        except KeyboardInterrupt:
            # Stopped by a person: what was answered up to here deserves its verification too.
            end_session(store, session, device)
            raise
        after = end_session(store, session, device)
    said = f"{count} trials on {display} recorded"
    if after.problems:
        said += f". CAUTION, the device is off after the session: {'; '.join(after.problems)}"
    if (aside := why_begun_again(store, session)) != again:
        said += f". CAUTION, {aside}"
    said += _attended(store, who, display)
    if run.state == "display changes":
        said += f"; next display: {display_wanted(store, who)}"
    return said


def _attended(store: StudyStore, who: str, display: str) -> str:
    """Sentence to the experimenter on catch trials on a display; nothing without."""
    [found] = store.rows(
        "SELECT count(r.correct) AS asked, total(r.correct) AS right FROM response r "
        "JOIN trial t ON t.uuid = r.trial WHERE t.participant = ? AND t.display = ? "
        f"AND t.phase = 'catch' AND {COUNTED}",
        [who, display],
    )
    if not found["asked"]:
        return ""
    catches = judged(who, int(found["right"]), found["asked"])
    said = f"; {catches.right} of {catches.asked} catch trials right"
    return said if catches.attended else f"{said}: CAUTION, fewer than of somebody who attends"


def _sitting(conditions: Path | None, consent: bool) -> SessionConditions:
    """The conditions in a file, if any, with `consent` beside it; refused without consent."""
    sitting = SessionConditions(consent=consent)
    if conditions is not None:
        sitting = config.load(SessionConditions, conditions)
        sitting = dataclasses.replace(sitting, consent=sitting.consent or consent)
    sitting.require_consent()
    return sitting


def _free_path(display: Display, file: Path) -> str:
    """The file, written with the path by which the hand of a twin explores freely: as a median
    simulated person would."""
    from squeezefilm.study.simulated.chain_tables import free_path

    observer = load_observer()
    path = free_path(display, observer, observer.median_finger())
    write_whole(file, csv_text(Table({"time_s": path.time, "x_m": path.x, "y_m": path.y})))
    return str(file)


def _device(
    desk: Desk,
    store: StudyStore,
    display: str,
    tell: SayProgress,
    closing: contextlib.ExitStack,
    by_hand: Callable[[str], None] | None,
) -> tuple[StudyDevice, Exposure | None]:
    if desk.drive == "none":
        return (NoDevice() if by_hand is None else ByHand(by_hand)), None
    # Plates, film and loop take a second to import, which a study by hand need not wait for.
    from squeezefilm.instruments.twin.hand import EXPLORING
    from squeezefilm.study.conduct.played_device import SessionDevice, require_study_drive
    from squeezefilm.study.conduct.playing_process import WorkerOrders

    loaded = require_study_drive(desk.drive, display)
    duration = expected_duration(store.design) / len(store.design.displays)
    exposed = exposure(loaded, duration, progress=tell)
    stroke = EXPLORING
    if desk.drive == "twin" and store.design.exploring == "free":
        folder = closing.enter_context(tempfile.TemporaryDirectory())
        stroke = _free_path(loaded, Path(folder) / "hand.csv")
    pickup = desk.amplitude_per_pickup
    orders = WorkerOrders(
        display, desk.drive, store.traces, amplitude_per_pickup=pickup, stroke=stroke
    )
    return closing.enter_context(SessionDevice(orders)), exposed


class Examiner(Protocol):
    """Link between a session and the person: a terminal, a page, or a script."""

    def rest(self, duration: si.Second) -> None:
        """Let the person rest (s)."""
        ...

    def feel(self, presentation: Presentation, place: int) -> None:
        """Return when the person has felt surface number `place` (from 0) long enough."""
        ...

    def ask(self, presentation: Presentation) -> str | float:
        """The answer: one of the trial's alternatives, or a number where there are none."""
        ...

    def acknowledge(self, presentation: Presentation, told: Acknowledgement) -> None:
        """The answer is on the disk; tell it, with what was right if the trial has feedback."""
        ...


def conduct(
    run: StudyRun,
    device: StudyDevice,
    examiner: Examiner,
    *,
    clock: Callable[[], float] = time.monotonic,
    mark: Mark = lambda *_: None,
    placed: Callable[[], None] | None = None,
) -> int:
    """Present and ask every trial that is left on the session's display. Returns how many.

    `placed` returns when a surface that somebody puts there by hand is in place; None where a
    device plays. A trial counts as presented from then on, or from when the device begins: not in
    the break before it.

    One surface plays while the question is asked, as the person compares it with what lies
    beside it; the response time runs from its onset. Two surfaces play one after the other, and
    it runs from the end of the second. Whatever happens, the device is silent afterwards.
    `mark` is told "start NAME" and "stop NAME" of each surface, and "answer CHOICE" with the moment
    that is recorded as the end of the trial.
    Raises what the device and the study's file raise; the trial then comes again.
    """
    count = 0
    while (presentation := run.next_trial(shown=False)) is not None:
        if presentation.rest:
            examiner.rest(presentation.rest)
        response = _presented(run, presentation, device, examiner, clock, mark, placed)
        told = run.respond(presentation.token, response)
        examiner.acknowledge(presentation, told)
        count += 1
    return count


def _presented(
    run: StudyRun,
    presentation: Presentation,
    device: StudyDevice,
    examiner: Examiner,
    clock: Callable[[], float],
    mark: Mark,
    placed: Callable[[], None] | None,
) -> Response:
    trial = presentation.trial
    begun, begun_utc = clock(), utc_now()
    felt: list[TrialMotion] = []
    asked, last = begun, len(presentation.surfaces) - 1
    answer: str | float | None = None
    for place, surface in enumerate(presentation.surfaces):
        # A real grating lies in its box; nothing plays.
        plays = isinstance(surface, Stimulus)
        by_hand = plays and placed is not None
        if place == 0 and not by_hand:
            run.next_trial()
        try:
            if isinstance(surface, Stimulus):
                device.present(surface, trial.seed)
                if placed is not None:
                    placed()
                    if place == 0:
                        run.next_trial()
                        begun, begun_utc = clock(), utc_now()
                mark(f"start {surface.name}", clock())
            if trial.asks and last == 0:
                asked = clock()
                answer = examiner.ask(presentation)
            else:
                examiner.feel(presentation, place)
        finally:
            if plays:
                felt.append(device.stop())
                ended = felt[-1].ended
                mark(f"stop {surface.name}", clock() if math.isnan(ended) else ended)
    if trial.asks and answer is None:
        asked = clock()
        answer = examiner.ask(presentation)
    ended = clock()
    if answer is not None:
        mark(f"answer {answer}", ended)
    return Response(
        choice=answer if isinstance(answer, str) else "",
        estimate=None if answer is None or isinstance(answer, str) else float(answer),
        response_time=ended - asked if trial.asks else None,
        started_monotonic=begun,
        ended_monotonic=ended,
        started_utc=begun_utc,
        ended_utc=utc_now(),
        explorations=tuple(felt),
    )
