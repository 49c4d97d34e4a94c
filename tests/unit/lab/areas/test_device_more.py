"""What the Device area asks a session to play, and what its pages hear of it."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest
from pydantic import ValidationError
from serial.tools import list_ports
from tests.unit.lab.areas.too_long import require_refused_if_longer

from squeezefilm.core import presets
from squeezefilm.lab import own_process
from squeezefilm.lab.areas.device import DEVICE, DeviceArea, OnDrive, PlayDevice
from squeezefilm.lab.designing.form import preset_text
from squeezefilm.lab.own_process import DeviceSession

if TYPE_CHECKING:
    from .conftest import Talk

STATOR = preset_text("biet2008-stator")
SINE = presets.resolve("sine-3mm", "texture").read_text(encoding="utf-8")
HOW: dict[str, Any] = {"display": STATOR, "drive": "twin", "armed": True, "preset": "bump"}


class Session:
    """What the lab's session was asked; it plays nothing."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.begun: list[tuple[Any, ...]] = []
        self.asked: list[str] = []
        self.running = False
        monkeypatch.setattr(
            DeviceSession, "start", lambda _, work, **how: self.begun.append((work, how))
        )
        monkeypatch.setattr(DeviceSession, "stop", lambda _: self.asked.append("stop"))
        monkeypatch.setattr(DeviceSession, "close", lambda _: self.asked.append("close"))
        monkeypatch.setattr(DeviceSession, "running", property(lambda _: self.running))

    @property
    def work(self) -> Any:
        """What was last begun to play."""
        play, how = self.begun[-1]
        assert play is own_process.play
        return SimpleNamespace(**how)


@pytest.fixture
def session(monkeypatch: pytest.MonkeyPatch) -> Session:
    return Session(monkeypatch)


@pytest.fixture
def lab(talk: Talk, session: Session) -> Talk:
    talk.session = DeviceArea(talk.lab).session  # type: ignore[attr-defined]
    return talk


def test_ports_are_listed_as_drives(lab: Talk, monkeypatch: pytest.MonkeyPatch) -> None:
    port = SimpleNamespace(device="/dev/ttyACM0", description="Some board")
    monkeypatch.setattr(list_ports, "comports", lambda: [port])
    assert lab.say("drives") == {
        "type": "drives",
        "ports": [{"drive": "serial:/dev/ttyACM0", "text": "/dev/ttyACM0: Some board"}],
    }


def test_what_a_page_asks_is_what_is_played(lab: Talk, session: Session) -> None:
    how = {
        "mode": "tile", "stroke": "80 mm/s over 3 cm", "sensor": "lvdt", "duration": "2.5 s",
        "voltage": "90 V", "compensation": "inverse", "hold": True, "seed": 9,
    }  # fmt: skip
    found = lab.say("play device", **HOW, **how)
    assert found["type"] == "playing"
    # Named by the time in UTC, so that none is written over.
    assert re.fullmatch(r"sessions/\d{8}T\d{6}", found["folder"])
    work = session.work
    assert work == SimpleNamespace(
        display=str(lab.folder / "sessions" / ".display.toml"),
        texture=str(presets.resolve("bump", "texture")),
        drive="twin",
        out=str(lab.folder / found["folder"]),
        **{**how, "duration": 2.5, "voltage": 90.0},
    )
    assert Path(work.display).read_text(encoding="utf-8") == STATOR
    assert lab.say("what plays") == {
        "type": "playing", "now": [{"key": DEVICE, "text": "a texture on twin", "plays": True}],
    }  # fmt: skip


def test_what_is_not_said_is_a_stroke_of_ten_seconds(lab: Talk, session: Session) -> None:
    # Above 42 V a device is not even connected where the display names no insulation.
    onto = {**HOW, "drive": "serial:/dev/ttyACM0"}
    assert "must name its touch-side insulation" in lab.refused("play device", **onto)
    assert session.begun == []
    lab.say("play device", **onto, voltage="40 V")
    work = session.work
    assert (work.drive, work.mode, work.compensation) == ("serial:/dev/ttyACM0", "stream", "none")
    assert (work.stroke, work.sensor) == ("60 mm/s over 4 cm", "device")
    assert (work.duration, work.voltage, work.seed) == (10.0, 40.0, 0)


def test_nothing_is_played_that_was_not_armed(lab: Talk, session: Session) -> None:
    said = lab.refused("play device", **{**HOW, "armed": False})
    assert said == "the device is not armed; arm it on the page first"
    for change, says in (
        ({"drive": "sound"}, "drive = 'sound' is not known; it may be twin or serial:PORT"),
        ({"drive": "my serial:X"}, "is not known"),
        ({"duration": "10 V"}, "10 V"),
        ({"voltage": "10 s"}, "10 s"),
        ({"display": 'name = "x"'}, "actuator"),
        ({"preset": None}, "a preset or a text, one of them"),
        ({"texture": SINE}, "a preset or a text, one of them"),
        ({"preset": "other"}, "there is no file other.toml"),
    ):
        assert says in lab.refused("play device", **{**HOW, **change})
    assert session.begun == []
    assert lab.say("what plays")["now"] == []


def test_a_texture_is_a_preset_a_saved_one_or_the_text_on_the_page(
    lab: Talk, session: Session
) -> None:
    textures = lab.folder / "textures"
    for _ in range(2):
        lab.say("play device", **{**HOW, "preset": None, "texture": SINE})
        assert session.work.texture == str(textures / ".played.toml")
        assert (textures / ".played.toml").read_text(encoding="utf-8") == SINE
    broken = {**HOW, "preset": None, "texture": SINE.replace("low", "lowest")}
    assert "lowest" in lab.refused("play device", **broken)
    assert (textures / ".played.toml").read_text(encoding="utf-8") == SINE
    (textures / "mine.toml").write_text(SINE)
    lab.say("play device", **{**HOW, "preset": "mine"})
    assert session.work.texture == str(textures / "mine.toml")


def test_a_check_is_a_thing_that_plays(lab: Talk, session: Session) -> None:
    found = lab.say("check device", display=STATOR, drive="serial:X")
    assert found == {"type": "checking"}
    display = str(lab.folder / "sessions" / ".display.toml")
    assert session.begun == [(own_process.check, {"drive": "serial:X", "display": display})]
    (now,) = lab.say("what plays")["now"]
    assert now == {"key": "device", "text": "the check of serial:X", "plays": True}
    assert lab.say("stop everything") == {"type": "stopping"}
    assert session.asked == ["stop"]
    lab.lab.close()
    assert session.asked == ["stop", "close"]


def test_pages_hear_from_the_sessions_thread_and_its_end_frees_the_bar(
    lab: Talk, session: Session
) -> None:
    page, tablet = lab.opened(), lab.opened(is_participant=True)
    tell: Callable[[dict[str, Any]], None] = lab.session._tell  # type: ignore[attr-defined]
    # Before anything was played, and after the lab has ended, nobody hears.
    tell({"type": "device progress"})
    lab.say("check device", display=STATOR, drive="twin")
    tell({"type": "device progress"})
    assert [one["type"] for one in page.heard] == ["playing"]
    page.heard.clear()

    async def told(message: dict[str, Any]) -> list[str]:
        await asyncio.to_thread(tell, message)
        await asyncio.sleep(0)
        heard, page.heard = page.heard, []
        return [one["type"] for one in heard]

    async def work() -> None:
        # In this loop, as the server's.
        start = lab.lab.experimenter._known["check device"][1]
        await start(OnDrive(id=1, type="check device", display=STATOR, drive="twin"))
        page.heard.clear()
        assert await told({"type": "device progress"}) == ["device progress"]
        assert len(lab.lab.playing.message()["now"]) == 1
        # A newer one has begun before the end of the last was heard.
        session.running = True
        assert await told({"type": "device ended"}) == ["device ended"]
        assert len(lab.lab.playing.message()["now"]) == 1
        session.running = False
        assert await told({"type": "device rows"}) == ["device rows"]
        assert len(lab.lab.playing.message()["now"]) == 1
        assert await told({"type": "device ended"}) == ["playing", "device ended"]
        assert lab.lab.playing.message()["now"] == []

    asyncio.run(work())
    assert tablet.heard == []


@pytest.mark.parametrize(
    ("kind", "field", "most", "others"),
    [
        ("check device", "display", 400_000, {"drive": ""}),
        ("check device", "drive", 200, {"display": ""}),
        ("play device", "preset", 100, {"display": "", "drive": "", "armed": True}),
        ("play device", "texture", 400_000, {"display": "", "drive": "", "armed": True}),
        ("play device", "stroke", 200, {"display": "", "drive": "", "armed": True}),
        ("play device", "sensor", 100, {"display": "", "drive": "", "armed": True}),
        ("play device", "duration", 50, {"display": "", "drive": "", "armed": True}),
        ("play device", "voltage", 50, {"display": "", "drive": "", "armed": True}),
    ],
)
def test_texts_that_are_too_long_are_refused(
    lab: Talk, kind: str, field: str, most: int, others: dict[str, Any]
) -> None:
    require_refused_if_longer(lab, kind, field, most, others)


def test_a_seed_is_a_number_that_a_page_can_say() -> None:
    how: dict[str, Any] = {"id": 1, "type": "t", "display": "", "drive": "", "armed": False}
    assert PlayDevice(**how, seed=2**53).seed == 2**53
    for seed in (-1, 2**53 + 1):
        with pytest.raises(ValidationError):
            PlayDevice(**how, seed=seed)
