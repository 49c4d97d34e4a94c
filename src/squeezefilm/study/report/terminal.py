"""A study at the terminal: its session, the questions to a participant, what is shown of it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager
from dataclasses import KW_ONLY, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.called_with import called_with
from squeezefilm.core.errors import InputError
from squeezefilm.core.kit.numbers import M, shown
from squeezefilm.core.kit.terminal import heading, say, show_rows, table
from squeezefilm.instruments.bench.markers import markers_if
from squeezefilm.study.conduct.terminal_run import Desk, Examiner, open_study, run_session
from squeezefilm.study.record.store import utc_now

if TYPE_CHECKING:
    from squeezefilm.core.quantities import Second
    from squeezefilm.physics.perception.stimuli import Grating, Stimulus
    from squeezefilm.study.conduct.run import Acknowledgement, Presentation
    from squeezefilm.study.design.plan import StudyPlan
    from squeezefilm.study.record.deletion import Deletion
    from squeezefilm.study.record.merge import Merge
    from squeezefilm.study.record.store import StudyStore


def _balanced(people: int) -> str:
    if people == 1:
        return "balanced within each participant"
    return f"balanced over every {people} participants"


def show_plan(plan: StudyPlan) -> None:
    """Print a plan: what is presented, how often, how long it takes, what is assumed."""
    design = plan.design
    minutes = plan.duration / 60
    everyone = f"for {plan.participants} participants"
    phases = ", ".join(f"{count} {name}" for name, count in plan.phases.items())
    rows = [
        ("Task", design.task, design.spoken_question),
        ("Displays", ", ".join(design.displays), ""),
        ("Trials", f"{len(plan.schedules[0])} per participant", phases),
        ("Time", f"{minutes:.0f} min per participant", f"{design.trial_duration:g} s a trial"),
        ("In all", f"{minutes * plan.participants / 60:.1f} h", everyone),
        ("Exploring", design.exploring, _EXPLORING[design.exploring]),
        ("Order", design.order, _balanced(plan.balanced_participants)),
        ("Seed", str(plan.seed), f"design {design.sha256[:12]}"),
    ]
    show_rows(f"{design.name}: {design.title}", rows)
    heading("Presented")
    table(
        (*_GRATING, "Surface", "Friction", "Right answer"),
        [
            (
                *_grating(stimulus),
                stimulus.kind,
                "its own" if stimulus.texture else f"{stimulus.low:g} to {stimulus.high:g}",
                "" if design.compares else design.answer_to(stimulus) or "none",
            )
            for stimulus in design.stimuli
        ],
    )
    if design.alternatives:
        heading("Compared with")
        table(
            (*_GRATING, "Ridge", "Material"),
            [
                (
                    *_grating(alternative),
                    shown(alternative.ridge_height, M, 3),
                    alternative.material,
                )
                for alternative in design.alternatives
            ],
        )
    heading("First trials of the first participants")
    for number, schedule in enumerate(plan.schedules[:4]):
        names = [" / ".join(t.stimuli) or t.adaptive for t in schedule if t.phase == "main"][:8]
        say(f"{number:3d}  {schedule[0].display}: {', '.join(names)}, …")
    if plan.doubts:
        heading("To be looked at before anybody is asked")
        for said in plan.doubts:
            say(said)
    if plan.assumed:
        heading("Assumed")
        say(", ".join(plan.assumed))
    if design.note:
        say(f"\n{design.note}")


_EXPLORING = {"strokes": "to and fro along x", "free": "over the whole face, in two dimensions"}
_GRATING = ("Name", "Period", "Groove", "Length means")


def _grating(surface: Stimulus | Grating) -> tuple[str, str, str, str]:
    """Cells of a virtual or a real grating, as `_GRATING` heads it; a shape has none."""
    if surface.period != surface.period:
        return surface.name, "–", "–", "–"
    period, crossed = shown(surface.period, M, 3), getattr(surface, "second_period", math.nan)
    if crossed == crossed:
        period += f" by {shown(crossed, M, 3)}"
    return surface.name, period, shown(surface.groove_width, M, 3), surface.period_means or "–"


def show_boards(head: tuple[str, ...], rows: list[tuple[str, ...]], says: Iterable[str]) -> None:
    """Print a study's boards, and what it calls their lengths."""
    heading("Boards to be made")
    table(head, rows)
    for sentence in says:
        say(sentence)


def show_status(store: StudyStore) -> None:
    """Print who is enrolled and how far they are."""
    study = store.study
    heading(f"{study['name']}: {store.path}")
    table(
        ("Participant", "Number", "Answered", "Planned", "Set aside"),
        [
            (
                participant["uuid"],
                *(str(participant[key]) for key in ("number", "answered", "planned", "set_aside")),
            )
            for participant in store.participants()
        ],
    )


def show_deletion(done: Deletion, pseudonym: str) -> None:
    """Print what was deleted, that nothing of them is left, and what was not touched."""
    print(
        f"{pseudonym}: {done.answers} answers, {done.traces} traces and {done.sittings} sittings "
        f"deleted; {done.backups} backups and {done.exports} exports gone through; nothing found "
        f"in {done.searched} files"
        if done.enrolled
        else f"{pseudonym} was not enrolled; nothing found in {done.searched} files"
    )
    if done.left:
        print(f"left as they are, being no files of this program: {', '.join(done.left)}")


def show_merge(done: Merge, other: str) -> None:
    """Print what a merge added, and doubled numbers."""
    print(
        f"{other}: {done.added['participant']} participants and {done.added['response']} answers "
        f"added, {done.present['response']} answers were there, {done.traces} traces copied"
    )
    if done.doubled_numbers:
        numbers = ", ".join(str(doubled_number) for doubled_number in done.doubled_numbers)
        print(
            f"doubled participants' numbers: {numbers}; they had the same orders, which costs "
            "balance; give stations different --station of --stations next time"
        )


class TerminalExaminer:
    """Examiner at the terminal: a key and Enter. `read` and `write` are for tests."""

    def __init__(
        self,
        question: str,
        *,
        modulus: float = 0.0,
        read: Callable[[str], str] = input,
        write: Callable[[str], None] = print,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self._question, self._modulus = question, modulus
        self._reads, self._write, self._sleep = read, write, sleep

    def _read(self, prompt: str) -> str:
        """A line from the terminal. The end of the input stops the session as Ctrl-C does."""
        try:
            return self._reads(prompt)
        except EOFError as error:
            raise KeyboardInterrupt from error

    def rest(self, duration: Second) -> None:
        """Wait (s), then for Enter."""
        self._write(f"\nBreak: {duration:.0f} s. Leave the surface.")
        self._sleep(duration)
        self._read("Press Enter to go on. ")

    def placed(self) -> None:
        """Return at Enter, when a surface that is put there by hand is in place."""
        self._read("\nFingers off. Press Enter when the surface is in place. ")

    def feel(self, presentation: Presentation, place: int) -> None:
        """Say what to feel; return at Enter."""
        surface = presentation.surfaces[place]
        several = len(presentation.surfaces) > 1
        what = (
            f"surface {place + 1} of {len(presentation.surfaces)}"
            if several
            else f"'{surface.name}'"
        )
        self._read(f"\n[{presentation.remaining} left] Feel {what}, then press Enter. ")

    def ask(self, presentation: Presentation) -> str | float:
        """The answer, asked for again until it is one of those offered."""
        trial = presentation.trial
        practice = " (practice)" if trial.phase == "practice" else ""
        self._write(f"\n[{presentation.remaining} left]{practice} {self._question}")
        if not trial.alternatives:
            if self._modulus:
                self._write(f"The reference is {self._modulus:g}.")
            return self._number()
        for place, name in enumerate(trial.alternatives, 1):
            self._write(f"  {place}  {name}")
        while True:
            key = self._read("> ").strip()
            if key in trial.alternatives:
                return key
            if key.isascii() and key.isdigit() and 1 <= int(key) <= len(trial.alternatives):
                return trial.alternatives[int(key) - 1]
            self._write(f"Answer with a number from 1 to {len(trial.alternatives)}.")

    def acknowledge(self, presentation: Presentation, told: Acknowledgement) -> None:
        """Say what was right, in practice only, and what comes again."""
        for said in (told.spoiled and f"It comes again later: {told.spoiled}", told.practice):
            if said:
                self._write(f"{said}.")
        if presentation.trial.feedback and told.right_answer:
            word = "Right" if told.correct else f"It was '{told.right_answer}'"
            self._write(f"{word}.")

    def _number(self) -> float:
        while True:
            try:
                value = float(self._read("> ").strip().replace(",", "."))
            except ValueError:
                value = math.nan
            if math.isfinite(value) and value > 0:
                return value
            self._write("Answer with a number above 0.")


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class SessionRequest(Desk):
    """Arguments of `run_study`."""

    design: str | Path
    store: str | Path
    participant: str | None = None
    _: KW_ONLY
    examiner: Examiner | None = None
    seed: int | None = None
    station: int | None = None
    stations: int | None = None
    progress: Callable[[], AbstractContextManager[Callable[[str], None]]] | None = None
    by_hand: str = "terminal"
    lsl: bool | str = False


@reads_text
@called_with(SessionRequest)
def run_study(asked: SessionRequest) -> str:
    """Run a session of a study; stopped by Ctrl-C, it goes on later where it stopped. Returns how
    it ended.

    `store` is the study's file, made for the preset or file `design` if it is not there; somebody
    new is enrolled without a `participant`. `examiner` asks the questions: without one, this
    terminal does. `by_hand` says where the experimenter is told which surface to put under the
    finger if no device plays: at this "terminal", in a file (its path), or "nowhere"; the terminal
    then waits until the surface is said to be in place, from when response times run. `lsl` sends
    markers to the lab streaming layer (its stream may be named), which needs pylsl. The rest, and
    what is raised, as `open_study` and `run_session`.
    """
    markers = markers_if(asked.lsl)
    path = Path(asked.store)
    with open_study(path, asked.design, asked.seed, asked.station, asked.stations) as found:
        planned = found.design
        examiner, placed = asked.examiner, None
        if examiner is None:
            examiner = TerminalExaminer(planned.spoken_question, modulus=planned.modulus)
            placed = examiner.placed
        return run_session(
            found,
            asked.participant,
            asked,
            examiner,
            progress=asked.progress,
            by_hand=_told_by_hand(asked) if asked.drive == "none" else None,
            mark=(lambda *_: None) if markers is None else markers.push,
            placed=placed,
        )


def _told_by_hand(asked: SessionRequest) -> Callable[[str], None] | None:
    """Tells the experimenter what to present, where the participant does not read it."""
    if asked.by_hand == "nowhere":
        return None
    if asked.by_hand == "terminal":
        asked.tell(
            "This terminal tells which surface to present: keep it from the participant's eyes and "
            "type the answers yourself. Or give --by-hand FILE, and watch the file in a second "
            "window (tail -f FILE)."
        )
        return lambda line: asked.tell(f"EXPERIMENTER: {line}")
    path = Path(asked.by_hand)

    def write(line: str) -> None:
        try:
            with path.open("a", encoding="utf-8") as file:
                file.write(f"{utc_now()}  {line}\n")
        except OSError as error:
            raise InputError(
                f"{path} cannot be written ({error}), so that nobody is told what to present; give "
                "by_hand another file"
            ) from error

    write("a session begins")
    return write
