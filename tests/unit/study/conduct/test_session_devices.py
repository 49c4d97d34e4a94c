"""A session at the terminal on each kind of drive, without a device: who is asked and told what."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.core.progress import SayProgress
from squeezefilm.instruments.twin.hand import EXPLORING
from squeezefilm.study.conduct import played_device, terminal_run
from squeezefilm.study.conduct.playing_process import WorkerOrders
from squeezefilm.study.conduct.terminal_run import Desk, open_study, run_session
from squeezefilm.study.design.trials import expected_duration
from squeezefilm.study.record.store import StudyStore

from ..scripted import LOUD, Bench, Script, gratings


class Port(Bench):
    """A device behind a port, which must be closed."""

    def __init__(self, orders: WorkerOrders) -> None:
        super().__init__()
        self.orders = orders
        self.closed = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.closed += 1


class Named(str):
    """A display, by its name, that any drive may play."""

    __slots__ = ()

    def require_insulation(self, *, twin: bool) -> None:
        """It has it."""


class Room:
    """Where a session is held: every device and sound field made up, and what was made of them."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.exposed: list[tuple[Any, float]] = []
        self.ports: list[Port] = []
        self.asked: list[str] = []
        self.told: list[str] = []
        self.steps: list[str] = []
        monkeypatch.setattr(played_device, "load_display", lambda name: Named(f"the {name}"))
        monkeypatch.setattr(terminal_run, "exposure", self._exposure)
        monkeypatch.setattr(played_device, "SessionDevice", self._port)

    def _exposure(self, found: Any, duration: float, *, progress: SayProgress) -> Any:
        progress("the sound field")
        self.exposed.append((found, duration))
        return LOUD

    def _port(self, orders: WorkerOrders) -> Port:
        self.ports.append(Port(orders))
        return self.ports[-1]

    def acknowledge(self, statement: str) -> bool:
        """Yes."""
        self.asked.append(statement)
        return True

    @contextlib.contextmanager
    def progress(self) -> Iterator[SayProgress]:
        """Keeps what goes on."""
        yield self.steps.append

    def held(self, store: StudyStore, who: str | None, script: Script, **more: Any) -> str:
        """A session; how it ended."""
        how: dict[str, Any] = {"consent": True, **more}
        desk = Desk(acknowledge=self.acknowledge, tell=self.told.append, **how)
        return run_session(store, who, desk, script, progress=self.progress)


@pytest.fixture
def room(monkeypatch: pytest.MonkeyPatch) -> Room:
    """Nothing in it yet."""
    return Room(monkeypatch)


def test_a_session_is_on_the_twin_of_the_display_that_comes_next(
    room: Room, tmp_path: Path
) -> None:
    design = gratings(1, displays=("biet2008-plate", "biet2008-stator"))
    with StudyStore.create(tmp_path / "a.sqlite", design, 7) as store:
        who = store.enrol()
        first = store.rows("SELECT display FROM trial ORDER BY number")[0]["display"]
        second = next(one for one in design.displays if one != first)
        said = room.held(store, who, Script(), drive="twin")
        assert said == f"6 trials on {first} recorded; next display: {second}"
        assert [one.orders.target for one in room.ports] == [first]
        # Of the study's whole time, what falls to one of its two displays.
        assert room.exposed == [(f"the {first}", pytest.approx(expected_duration(design) / 2))]
        assert room.asked == [LOUD.statement]
        assert room.steps == [
            "the sound field",
            "the device is verified: keep fingers off",
        ]
        assert room.told == [f"participant {who}: go on with --participant {who}"]
        said = room.held(store, who, Script(), drive="twin")
        assert said == f"6 trials on {second} recorded"
        said = room.held(store, who, Script(), drive="twin")
        assert said == f"participant {who} has answered every trial"
        assert len(room.ports) == 2
        sessions = store.rows("SELECT device, exposure FROM session")
        assert [one["device"] for one in sessions] == ["bench", "bench"]


@pytest.mark.parametrize("drive", ["twin", "serial:/dev/ttyACM0"])
def test_a_port_is_given_the_studys_traces_and_closed_in_the_end(
    room: Room, tmp_path: Path, drive: str
) -> None:
    with StudyStore.create(tmp_path / "a.sqlite", gratings(1), 7) as store:
        room.held(store, None, Script(), drive=drive, amplitude_per_pickup=2e-6)
        (port,) = room.ports
        assert port.orders == WorkerOrders(
            "biet2008-plate", drive, store.traces, amplitude_per_pickup=2e-6, stroke=EXPLORING
        )
        assert port.closed == 1
        moments = [one["moment"] for one in store.rows("SELECT moment FROM verification")]
        assert sorted(moments) == ["after", "before"]
        assert store.rows("SELECT count(*) AS n FROM session")[0]["n"] == 1


def test_by_hand_nothing_is_heard_and_nobody_acknowledges(room: Room, tmp_path: Path) -> None:
    with StudyStore.create(tmp_path / "a.sqlite", gratings(1), 7) as store:
        assert room.held(store, None, Script()) == "6 trials on biet2008-plate recorded"
        assert store.rows("SELECT exposure FROM session")[0]["exposure"] == "null"
    assert (room.exposed, room.asked, room.steps) == ([], [], [])


def test_who_cannot_begin_is_not_kept_and_who_was_there_is(room: Room, tmp_path: Path) -> None:
    with StudyStore.create(tmp_path / "a.sqlite", gratings(1), 7) as store:
        known = store.enrol()
        for who in (None, known):
            with pytest.raises(InputError, match="drive = 'sound'"):
                room.held(store, who, Script(), drive="sound")
        with pytest.raises(InputError, match="consent"):
            room.held(store, None, Script(), consent=False)
        assert [one["uuid"] for one in store.participants()] == [known]
    assert room.told == room.exposed == []


def test_a_device_that_is_off_afterwards_is_told(room: Room, tmp_path: Path) -> None:
    class Warming(Script):
        """The plate warms while it is felt."""

        def feel(self, presentation: object, place: int) -> None:
            """Its resonance falls."""
            room.ports[0].resonance = 29.5e3

    with StudyStore.create(tmp_path / "a.sqlite", gratings(1), 7) as store:
        said = room.held(store, None, Warming(), drive="twin")
    assert said.startswith("6 trials on biet2008-plate recorded. CAUTION, the device is off after")
    assert "resonance is 29.5 kHz" in said


def test_a_person_who_stops_leaves_a_verification_after_it(room: Room, tmp_path: Path) -> None:
    with StudyStore.create(tmp_path / "a.sqlite", gratings(1), 7) as store:
        with pytest.raises(KeyboardInterrupt):
            room.held(store, None, Script(most=4), drive="twin")
        rows = store.rows("SELECT moment FROM verification")
        assert sorted(one["moment"] for one in rows) == ["after", "before"]
        (who,) = store.participants()
        assert who["answered"] == 4
    assert [one.closed for one in room.ports] == [1]


def test_conditions_are_those_of_the_file_and_consent_counts_from_either(
    room: Room, tmp_path: Path
) -> None:
    sitting = tmp_path / "sitting.toml"
    with StudyStore.create(tmp_path / "a.sqlite", gratings(1), 7) as store:
        for given, consent in (("true", False), ("false", True)):
            sitting.write_text(f'consent = {given}\nroom = "quiet"\n', encoding="utf-8")
            room.held(store, None, Script(), conditions=sitting, consent=consent)
        for row in store.rows("SELECT conditions FROM session"):
            assert '"room": "quiet"' in row["conditions"]
            assert '"consent": true' in row["conditions"]
        sitting.write_text("consent = false\n", encoding="utf-8")
        with pytest.raises(InputError, match="consent"):
            room.held(store, None, Script(), conditions=sitting, consent=False)


def test_a_file_is_opened_again_for_its_own_design_and_seed_alone(tmp_path: Path) -> None:
    path = tmp_path / "a.sqlite"
    with open_study(path, "biet2008-gratings", 7, station=1, stations=3) as store:
        made = store.study["uuid"]
        assert (store.study["station"], store.study["stations"]) == (1, 3)
    with open_study(path, "biet2008-gratings", 7) as store:
        assert store.study["uuid"] == made
    for design, seed in (("biet2008-gratings", 8), ("biet2008-gratings-as-widths", 7)):
        with pytest.raises(InputError, match=r"with seed 7; asked for is .*give another store"):
            open_study(path, design, seed)
    with open_study(path, "biet2008-gratings", None, station=1, stations=3) as store:
        assert store.study["uuid"] == made
    for station, stations in ((2, None), (0, 3), (1, 4)):
        with pytest.raises(InputError, match=r"is of station 1 of 3.*leave station"):
            open_study(path, "biet2008-gratings", 7, station, stations)
