"""A study's session held at this terminal: its file, the questions, how it ended."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import KW_ONLY, dataclass
from pathlib import Path

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.called_with import called_with
from squeezefilm.core.errors import InputError
from squeezefilm.instruments.bench.markers import markers_if
from squeezefilm.study.conduct.terminal_run import Desk, Examiner, open_study, run_session
from squeezefilm.study.record.store import utc_now
from squeezefilm.study.report.terminal import TerminalExaminer, ask_acknowledgement


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class SessionRequest:
    """Arguments of `run_study`."""

    design: str | Path
    store: str | Path
    participant: str | None = None
    _: KW_ONLY
    examiner: Examiner | None = None
    drive: str = "none"
    amplitude_per_pickup: si.MetrePerVolt | None = None
    conditions: Path | None = None
    consent: bool = False
    acknowledge: Callable[[str], bool] = ask_acknowledgement
    seed: int | None = None
    station: int | None = None
    stations: int | None = None
    tell: Callable[[str], None] = print
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
            Desk(
                examiner,
                asked.acknowledge,
                asked.tell,
                asked.progress,
                _told_by_hand(asked) if asked.drive == "none" else None,
                mark=(lambda *_: None) if markers is None else markers.push,
                placed=placed,
            ),
            drive=asked.drive,
            amplitude_per_pickup=asked.amplitude_per_pickup,
            conditions=asked.conditions,
            consent=asked.consent,
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
