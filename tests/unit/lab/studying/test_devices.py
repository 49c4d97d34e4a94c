"""Devices in the lab's sittings: one sitting each, stopped at once, and no answer after a fault."""

from __future__ import annotations

import asyncio
import json
import math
import threading
from collections.abc import Coroutine
from pathlib import Path
from typing import Any

import pytest

from squeezefilm.core.errors import DeviceError, InputError
from squeezefilm.lab import own_process
from squeezefilm.lab.areas import study as study_area
from squeezefilm.lab.areas.device import DeviceArea
from squeezefilm.lab.areas.study import StudyArea
from squeezefilm.lab.guard import Keys, Places
from squeezefilm.lab.own_process import DeviceSession
from squeezefilm.lab.server import PAGE, Lab
from squeezefilm.lab.studying.devices import StudyDevices
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.conduct.played_device import require_study_drive
from squeezefilm.study.conduct.playing_process import WorkerOrders
from squeezefilm.study.conduct.sessions import Exposure
from squeezefilm.study.conduct.study_device import DeviceIdentity, DeviceVerification, TrialMotion
from squeezefilm.study.record.store import StudyStore

SURFACE = (Stimulus("4 mm", 4e-3, "period"), 1)
EXPOSURE = Exposure("plate", 33e3, 0.5, 120.0, 3600.0, None, "", "made up for this test")


class Fake:
    """A device that says what it was asked, and breaks where it is told to."""

    def __init__(self) -> None:
        self.asked: list[str] = []
        self.breaks = self.presenting = False
        self.may_begin = threading.Event()
        self.may_begin.set()
        self.resonance = 33e3

    def identity(self) -> DeviceIdentity:
        return DeviceIdentity("fake", "d", "c")

    def verify_device(self) -> DeviceVerification:
        self.asked.append("verify")
        return DeviceVerification(
            resonance_frequency=self.resonance, expected_resonance_frequency=33e3
        )

    def present(self, stimulus: Stimulus, seed: int) -> None:
        assert not self.presenting
        assert self.may_begin.wait(10)
        self.asked.append(f"present {stimulus.name}")
        self.presenting = True

    def stop(self) -> TrialMotion:
        self.asked.append("stop")
        was, self.presenting = self.presenting, False
        if self.breaks and was:
            raise DeviceError("the device failed")
        return TrialMotion(0.1, 0.08, trace="time_s\n0\n") if was else TrialMotion()

    def halt(self) -> None:
        self.asked.append("halt")

    def close(self) -> None:
        self.asked.append("close")


def play(work: Coroutine[Any, Any, None]) -> None:
    asyncio.run(work)


def orders(drive: str) -> WorkerOrders:
    return WorkerOrders("plate", drive, Path())


async def begin(devices: StudyDevices, place: int = 0, token: str = "t", who: str = "s") -> None:
    await devices.present(who, orders("twin"), SURFACE, token, place)


def test_two_surfaces_one_after_the_other_are_felt_once() -> None:
    fake = Fake()
    devices = StudyDevices(lambda *_: fake)

    async def work() -> None:
        await begin(devices)
        with pytest.raises(InputError, match="surface 2 comes next, not 3"):
            await begin(devices, 2)
        await begin(devices, 1)
        felt = await devices.felt("s", "t")
        # A page that lost the answer asks again.
        assert await devices.felt("s", "t") == felt
        assert [one.path_length for one in felt] == [0.1, 0.1]
        devices.answered("s", "another")
        assert await devices.felt("s", "t") == felt
        devices.answered("s", "t")
        with pytest.raises(DeviceError, match="comes again"):
            await devices.felt("s", "t")

    play(work())
    devices.close()
    assert fake.asked[-1] == "close"
    assert not fake.presenting


def test_a_fault_and_a_stop_leave_nothing_to_answer_with() -> None:
    fake = Fake()
    devices = StudyDevices(lambda *_: fake)

    async def work() -> None:
        fake.breaks = True
        await begin(devices)
        with pytest.raises(DeviceError, match="the device failed"):
            await devices.felt("s", "t")
        # Handed in again by a page that did not hear it.
        with pytest.raises(DeviceError, match="comes again"):
            await devices.felt("s", "t")
        fake.breaks = False
        await begin(devices)
        devices.halt("s")
        assert fake.asked[-1] == "halt"
        with pytest.raises(InputError, match="begin the trial again"):
            await begin(devices, 1)
        with pytest.raises(DeviceError, match="stopped or interrupted"):
            await devices.felt("s", "t")
        assert not fake.presenting
        await begin(devices)
        assert len(await devices.felt("s", "t")) == 1

    play(work())
    devices.close()


def test_one_sitting_at_a_time_uses_a_device() -> None:
    made: list[Fake] = []

    def make(*_: object) -> Fake:
        made.append(Fake())
        return made[-1]

    devices = StudyDevices(make)

    async def work() -> None:
        await begin(devices, who="s")
        with pytest.raises(InputError, match="in use by another sitting"):
            await begin(devices, who="other")
        await devices.present("other", orders("serial:X"), SURFACE, "t", 0)
        await devices.release("s")
        assert made[0].asked[-2:] == ["halt", "close"]
        await begin(devices, who="third")
        assert devices.holders() == ["other", "third"]

    play(work())
    devices.close()
    assert [one.asked[-1] for one in made] == ["close"] * 3


def test_a_page_that_goes_while_a_surface_begins_leaves_silence() -> None:
    fake = Fake()
    devices = StudyDevices(lambda *_: fake)

    async def work() -> None:
        fake.may_begin.clear()
        beginning = asyncio.create_task(begin(devices))
        await asyncio.sleep(0.02)
        beginning.cancel()
        with pytest.raises(asyncio.CancelledError):
            await beginning
        fake.may_begin.set()
        with pytest.raises(DeviceError, match="comes again"):
            await devices.felt("s", "t")
        assert not fake.presenting
        await begin(devices)
        assert fake.presenting

    play(work())
    devices.close()
    assert fake.asked[:3] == ["stop", "present 4 mm", "stop"]


class Talk:
    """A page's side of a conversation with a lab whose device is a fake."""

    def __init__(self, folder: Path, fake: Fake, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(study_area, "_exposure", None)
        self.lab = Lab(folder, Keys(), Places(frozenset({"x"})))

        async def exposed(*_: object) -> Exposure:
            return EXPOSURE

        monkeypatch.setattr(self.lab.slow, "do", exposed)
        StudyArea(self.lab, StudyDevices(lambda *_: fake))
        DeviceArea(self.lab)
        self.store = folder / "studies" / "one.sqlite"

    async def say(self, type: str, **fields: Any) -> dict[str, Any]:
        speaker = self.lab.experimenter if type in self.lab.experimenter._known else None
        whom = speaker or self.lab.participant
        return await whom.answer(json.dumps({"id": 1, "type": type, **fields}))

    async def playing(self) -> list[bool]:
        """Of every sitting with a device, whether it plays."""
        return [one["plays"] for one in (await self.say("what plays"))["now"]]

    async def prepared(self) -> str:
        await self.say("create study", design="biet2008-gratings", study="one", seed=3)
        study = await self.say("enrol", study="one")
        assert "twin" in study["devices"]
        who = study["participants"][0]["pseudonym"]
        how = {"study": "one", "participant": who, "consent": "I agree to take part in this."}
        for wrong, acknowledged, says in (
            ("sound", True, "does not stop by itself"),
            ("twin", False, "not acknowledged"),
        ):
            refused = await self.say(
                "prepare sitting", device=wrong, acknowledged=acknowledged, **how
            )
            assert says in refused["message"]
        made = await self.say("prepare sitting", device="twin", acknowledged=True, **how)
        return str(made["sitting"])

    async def first_played(self, sitting: str) -> dict[str, Any]:
        """The first trial that a device plays; gratings before it are only felt."""
        while not (trial := await self.say("next", sitting=sitting))["plays"]:
            await self.say("feel", sitting=sitting, token=trial["token"], place=0)
            await self.say("respond", sitting=sitting, token=trial["token"])
        return trial

    def answers(self) -> int:
        with StudyStore.open(self.store) as store:
            return int(store.rows("SELECT count(*) AS n FROM response WHERE choice != ''")[0]["n"])


def test_a_trial_is_recorded_only_with_what_its_device_presented(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fake = Fake()
    talk = Talk(tmp_path, fake, monkeypatch)
    page: Any = object()

    async def work() -> None:
        PAGE.set(page)
        sitting = await talk.prepared()
        fake.resonance = 30e3
        off = await talk.say("consent", sitting=sitting)
        assert "the device is off" in off["message"]
        assert fake.asked[-1] == "close"
        fake.resonance = 33e3
        assert (await talk.say("consent", sitting=sitting))["state"] == "ready"
        trial = await talk.first_played(sitting)
        token, choice = trial["token"], trial["alternatives"][0]
        answer = {"sitting": sitting, "token": token, "choice": choice}
        early = await talk.say("respond", **answer)
        assert "is not being presented" in early["message"]
        assert (await talk.say("feel", sitting=sitting, token=token, place=0))["place"] == 0
        fake.breaks = True
        broken = await talk.say("respond", **answer)
        assert broken["message"] == "the device failed"
        assert talk.answers() == 0
        fake.breaks = False
        again = await talk.say("next", sitting=sitting)
        assert (again["token"], again["interrupted"]) == (token, True)
        assert await talk.playing() == [False]
        await talk.say("feel", sitting=sitting, token=token, place=0)
        # The experimenter's stop stops a participant's surface as well.
        assert await talk.playing() == [True]
        await talk.say("stop everything")
        assert fake.asked[-1] == "halt"
        assert await talk.playing() == [False]
        assert "comes again" in (await talk.say("respond", **answer))["message"]
        await talk.say("feel", sitting=sitting, token=token, place=0)
        # The page goes away: nobody is there to feel it.
        for told in talk.lab.left:
            told(page)
        assert fake.asked[-1] == "halt"
        assert "comes again" in (await talk.say("respond", **answer))["message"]
        await talk.say("feel", sitting=sitting, token=token, place=0)
        wrong = await talk.say("respond", sitting=sitting, token=token, choice="no answer")
        assert "is no answer" in wrong["message"]
        assert (await talk.say("respond", **answer))["type"] == "acknowledged"
        assert talk.answers() == 1
        # Handed in again it needs no device.
        assert (await talk.say("respond", **answer))["repeated"]
        assert not fake.presenting
        ended = await talk.say("end sitting", sitting=sitting)
        assert ended["problems"] == []
        assert fake.asked[-1] == "close"
        assert await talk.playing() == []

    play(work())
    talk.lab.close()
    with StudyStore.open(talk.store) as store:
        (row,) = store.rows("SELECT * FROM response WHERE choice != ''")
        assert row["path_length_m"] == 0.1
        assert len(json.loads(row["traces"])) == 1
        passed = [one["passed"] for one in store.rows("SELECT passed FROM verification")]
        assert sorted(passed) == [0, 1, 1]
        assert math.isclose(row["mean_speed_m_per_s"], 0.08)


def test_consent_given_twice_begins_one_session(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fake = Fake()
    talk = Talk(tmp_path, fake, monkeypatch)

    async def work() -> None:
        PAGE.set(None)  # type: ignore[arg-type]
        sitting = await talk.prepared()
        first = await talk.say("consent", sitting=sitting)
        asked = list(fake.asked)
        # A double click, or a page that did not hear the answer.
        assert await talk.say("consent", sitting=sitting) == first
        assert fake.asked == asked
        await talk.say("end sitting", sitting=sitting)
        after = await talk.say("consent", sitting=sitting)
        assert after["state"] != "ready"

    play(work())
    talk.lab.close()
    with StudyStore.open(talk.store) as store:
        (count,) = store.rows("SELECT count(*) AS n FROM session")
        assert count["n"] == 1


def test_a_check_is_asked_of_the_drive_with_the_display_on_the_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    talk = Talk(tmp_path, Fake(), monkeypatch)
    begun: list[tuple[Any, ...]] = []
    monkeypatch.setattr(DeviceSession, "start", lambda _, work, **how: begun.append((work, how)))

    async def named(*_: object) -> str:
        return "mine"

    monkeypatch.setattr(talk.lab.quick, "do", named)

    async def work() -> None:
        text = 'name = "mine"'
        refused = await talk.say("check device", display=text, drive="sound")
        assert "may be twin or serial" in refused["message"]
        assert begun == []
        assert (await talk.say("check device", display=text, drive="twin"))["type"] == "checking"
        (now,) = (await talk.say("what plays"))["now"]
        assert (now["text"], now["plays"]) == ("the check of twin", True)

    play(work())
    ((what, how),) = begun
    assert (what, how["drive"]) == (own_process.check, "twin")
    assert Path(how["display"]).read_text() == 'name = "mine"'


def test_the_experimenter_is_told_what_a_device_may_not_play() -> None:
    require_study_drive("twin", "biet2008-stator")
    require_study_drive("serial:/dev/ttyACM0", "biet2008-plate")
    with pytest.raises(InputError, match="touch-side insulation"):
        require_study_drive("serial:/dev/ttyACM0", "biet2008-stator")
    with pytest.raises(InputError, match="is not known"):
        require_study_drive("sound", "biet2008-stator")
