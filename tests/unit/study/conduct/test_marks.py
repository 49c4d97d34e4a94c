"""What a run tells of markers, and with which moments."""

from __future__ import annotations

from pathlib import Path

from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.conduct.run import StudyRun
from squeezefilm.study.conduct.sessions import begin_session
from squeezefilm.study.conduct.study_device import NoDevice, TrialMotion
from squeezefilm.study.conduct.terminal_run import conduct
from squeezefilm.study.record.store import Row, StudyStore

from ..scripted import CONSENT, Script, gratings


class Silent(NoDevice):
    """A device whose output went to zero at a moment of its own."""

    def __init__(self, ended: float) -> None:
        self.ended = ended

    def present(self, stimulus: Stimulus, seed: int) -> None:
        """It plays."""

    def stop(self) -> TrialMotion:
        """It was silent at that moment."""
        return TrialMotion(ended=self.ended)


Told = list[tuple[str, float]]


def marks(folder: Path, device: NoDevice) -> tuple[Told, list[Row]]:
    """What was told of a run on a clock that each look moves by a second, and what was recorded."""
    told: Told = []
    now = iter(range(1, 10_000))
    with StudyStore.create(folder / "s.sqlite", gratings(repetitions=1), 1) as store:
        session = begin_session(store, store.enrol(), NoDevice(), CONSENT, None, acknowledged=False)
        conduct(
            StudyRun(store, session),
            device,
            Script(),
            clock=lambda: float(next(now)),
            mark=lambda text, at: told.append((text, at or 0.0)),
        )
        rows = store.rows(
            "SELECT r.* FROM response r JOIN trial t ON t.uuid = r.trial "
            "WHERE choice != '' ORDER BY t.number"
        )
    return told, rows


def test_an_answer_is_marked_with_the_moment_that_is_recorded(tmp_path: Path) -> None:
    told, rows = marks(tmp_path, NoDevice())
    answers = [(text, at) for text, at in told if text.startswith("answer ")]
    assert answers == [(f"answer {row['choice']}", row["ended_monotonic_s"]) for row in rows]
    # Each surface starts, and stops, before what comes of it is answered.
    kinds = [text.split()[0] for text, _ in told]
    assert kinds.count("start") == kinds.count("stop") == len(rows)
    assert kinds == ["start", "stop", "answer"] * len(rows)
    moments = [at for _, at in told]
    assert moments == sorted(moments)


def test_a_stop_is_when_the_output_was_at_zero_where_the_device_knows(tmp_path: Path) -> None:
    told, rows = marks(tmp_path, Silent(0.5))
    assert [at for text, at in told if text.startswith("stop ")] == [0.5] * len(rows)
