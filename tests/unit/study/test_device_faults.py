"""A device that fails under a study: no answer, a message, and the trial comes again."""

from __future__ import annotations

import multiprocessing
import threading
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import DeviceError, InputError
from squeezefilm.instruments.session.play import real_time as playing
from squeezefilm.instruments.session.play.plan import PlayPlan
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.conduct.played_device import SessionDevice
from squeezefilm.study.conduct.playing_process import WorkerOrders
from squeezefilm.study.conduct.run import StudyRun
from squeezefilm.study.conduct.sessions import begin_session
from squeezefilm.study.conduct.study_device import NoDevice, TrialMotion
from squeezefilm.study.conduct.terminal_run import conduct
from squeezefilm.study.record.store import StudyStore

from .scripted import CONSENT, Script, gratings

SURFACE = Stimulus("4 mm", 4e-3, "period")
Serving = Callable[[Connection], None]


def scripted_device(
    folder: Path, monkeypatch: pytest.MonkeyPatch, *servings: Serving
) -> SessionDevice:
    """A device whose process is a thread that does what a serving says; one after the other."""
    device, left = SessionDevice(WorkerOrders("biet2008-plate", "serial:X", folder)), list(servings)

    def running() -> Connection:
        if device._connection is None:
            ours, theirs = multiprocessing.Pipe()
            serving = left.pop(0)

            def work() -> None:
                with theirs:
                    serving(theirs)

            threading.Thread(target=work).start()
            device._connection = ours
        return device._connection

    monkeypatch.setattr(device, "_running", running)
    return device


def plays(*ending: Any) -> Serving:
    """Plays whatever comes, and ends each time like that."""

    def serving(connection: Connection) -> None:
        while True:
            try:
                order = connection.recv()
            except EOFError:
                return
            if order[0] == "present":
                connection.send(("playing", 1.0))
                assert connection.recv() == ("stop",)
                connection.send(ending)

    return serving


def dies(connection: Connection) -> None:
    """Is gone while it plays."""
    connection.recv()
    connection.send(("playing", 1.0))


def refuses(connection: Connection) -> None:
    """Does not play."""
    connection.recv()
    connection.send(("failed", "the port cannot be opened"))


GOOD = ("ended", "", TrialMotion(0.1, 0.08))


@pytest.mark.parametrize(
    ("fault", "says"),
    [
        (plays("ended", "the device faulted: the amplifier tripped", TrialMotion()), "tripped"),
        (plays("failed", "the disk is full"), "the disk is full"),
        (dies, "ended without a word"),
        (refuses, "cannot be opened"),
    ],
)
def test_a_fault_is_told_and_the_trial_comes_again(
    fault: Serving, says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    design = gratings(repetitions=1)
    with StudyStore.create(tmp_path / "s.sqlite", design, 1) as store:
        session = begin_session(store, store.enrol(), NoDevice(), CONSENT, None, acknowledged=False)
        run = StudyRun(store, session)
        device = scripted_device(store.traces, monkeypatch, fault, plays(*GOOD))
        with pytest.raises(DeviceError, match=says):
            conduct(run, device, Script())
        answered = "SELECT * FROM response WHERE choice != ''"
        assert store.rows(answered) == []
        assert conduct(run, device, Script()) == 3
        device.close()
        assert len(store.rows(answered)) == 3
        shown = store.rows(
            "SELECT count(*) AS n FROM presentation p JOIN trial t ON t.uuid = p.trial "
            "WHERE t.phase = 'main' GROUP BY p.trial ORDER BY n"
        )
        assert [one["n"] for one in shown] == [1, 1, 2]


def test_one_surface_at_a_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    device = scripted_device(tmp_path, monkeypatch, plays(*GOOD))
    device.present(SURFACE, 1)
    assert device.presenting
    for ask in (device.verify_device, lambda: device.present(SURFACE, 1)):
        with pytest.raises(InputError, match="stop it first"):
            ask()
    assert device.stop().path_length == 0.1
    assert np.isnan(device.stop().path_length)
    device.close()


def test_a_surface_that_is_halted_before_it_plays_is_not_presented(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def halted(connection: Connection) -> None:
        connection.recv()
        device.halt()
        connection.send(("ended", "", TrialMotion()))
        connection.poll(10)

    device = scripted_device(tmp_path, monkeypatch, halted)
    with pytest.raises(DeviceError, match="stopped before it played"):
        device.present(SURFACE, 1)
    assert not device.presenting
    device.close()


def test_a_study_refuses_a_drive_that_does_not_stop_by_itself(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from squeezefilm.core.drive_limits import Limits
    from squeezefilm.instruments.session.loop.plan import LoopPlan
    from squeezefilm.physics.render.motion.estimator import LVDT_10_KHZ, MotionEstimator
    from squeezefilm.physics.render.program.lowering import lower
    from squeezefilm.physics.render.resonator.envelope import DrivenEnvelope
    from squeezefilm.physics.render.texture.levels import Amplitude
    from squeezefilm.physics.render.texture.shapes import SquareWave

    class Silent:
        sent = b""

        def read(self) -> bytes:
            return b""

        def write(self, data: bytes) -> None:
            self.sent += data

        def close(self) -> None:
            pass

    loop = LoopPlan(
        program=lower(Amplitude(SquareWave(2e-3), 0.5e-6, 1e-6), largest_amplitude=1e-6),
        rate=1e3,
        envelope=DrivenEnvelope(1e-3, 1e-3, 1e-6),
        amplitude_per_volt=1e-7,
        estimator=MotionEstimator.for_sensor(LVDT_10_KHZ),
    )
    plan = PlayPlan(loop, Limits(15.0, 15e3, 15.0, 2e4, 30e3, 36e3), 33.5e3)
    stream = Silent()
    monkeypatch.setattr(playing, "open_stream", lambda _: stream)
    monkeypatch.setattr(playing.SerialDrive, "stops_by_itself", False)
    with pytest.raises(InputError, match="in a study, where people touch the plate"):
        playing.run_play(plan, "serial:X", tmp_path / "a.sqft", {}, duration=1.0, use="study")
    assert stream.sent == b""
