"""A study's session held at this terminal: its file, the questions, how it ended."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path

from squeezefilm.from_text import reads_text
from squeezefilm.quantities import MetrePerVolt
from squeezefilm.report.study.terminal import TerminalExaminer, ask_acknowledgement
from squeezefilm.study.conduct.terminal_run import open_study, run_session
from squeezefilm.study.conduct.trial_by_trial import Examiner


@reads_text
def run_study(
    design: str | Path,
    store: str | Path,
    participant: str | None = None,
    *,
    examiner: Examiner | None = None,
    drive: str = "none",
    amplitude_per_pickup: MetrePerVolt | None = None,
    conditions: Path | None = None,
    consent: bool = False,
    acknowledge: Callable[[str], bool] = ask_acknowledgement,
    seed: int = 0,
    station: int = 0,
    stations: int = 1,
    tell: Callable[[str], None] = print,
    progress: Callable[[], AbstractContextManager[Callable[[str], None]]] | None = None,
) -> str:
    """Run a session of a study; stopped by Ctrl-C, it goes on later where it stopped. Returns how
    it ended.

    `store` is the study's file, made for the preset or file `design` if it is not there; somebody
    new is enrolled without a `participant`. `examiner` asks the questions: without one, this
    terminal does. The rest, and what is raised, as `open_study` and `run_session`.
    """
    with open_study(Path(store), design, seed, station, stations) as found:
        planned = found.design
        asked = examiner or TerminalExaminer(planned.spoken_question, modulus=planned.modulus)
        return run_session(
            found,
            participant,
            asked,
            drive=drive,
            amplitude_per_pickup=amplitude_per_pickup,
            conditions=conditions,
            consent=consent,
            acknowledge=acknowledge,
            tell=tell,
            progress=progress,
        )
