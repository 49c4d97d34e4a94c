"""The lab and the process that computes for it, stopped and killed while people answer.

Whatever was acknowledged is in the study's file; pages go on with the lab that is started next.
"""

from __future__ import annotations

import contextlib
import json
import os
import random
import signal
import sqlite3
import sys
import threading
import time
from pathlib import Path
from typing import Any

import pytest
from websockets.exceptions import WebSocketException
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Origin

from .lab_storm import Served

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")

CONSENT = "I consent to everything here."


class Station:
    """A lab that is started again when it was killed, and a browser's side of its messages."""

    def __init__(self, folder: Path) -> None:
        self.served = Served(folder)
        answer = self.served.comes_in().decode()
        self.cookie = answer.split("set-cookie: ", 1)[1].split(";", 1)[0]

    def page(self, path: str) -> ClientConnection:
        own = f"127.0.0.1:{self.served.port}"
        return connect(
            f"ws://{own}{path}", origin=Origin(f"http://{own}"), max_size=None, open_timeout=60,
            additional_headers={"Cookie": self.cookie},
        )  # fmt: skip

    def back(self) -> None:
        """Start the lab again at its port, as it was after a crash."""
        port = self.served.port
        self.served.process.wait(30)
        assert self.served.process.stdout is not None
        self.served.process.stdout.close()
        self.served = Served(self.served.folder, port)
        assert self.served.port == port

    def computing(self) -> list[int]:
        """The processes that the lab started."""
        pid = self.served.process.pid
        with contextlib.suppress(OSError):
            text = Path(f"/proc/{pid}/task/{pid}/children").read_text()
            return [int(one) for one in text.split()]
        return []


def ask(page: ClientConnection, type: str, **fields: Any) -> dict[str, Any]:
    """The answer to one message."""
    page.send(json.dumps({"id": 1, "type": type, **fields}))
    while (answer := json.loads(page.recv(120))).get("id") != 1:
        pass  # What was told to every page.
    return dict(answer)


def sitting_of(station: Station, study: str = "one") -> str:
    """A participant who consented, in a study of its own."""
    with station.page("/ws") as page:
        ask(page, "create study", design="biet2008-gratings", study=study, seed=1)
        person = ask(page, "enrol", study=study)["participants"][0]["pseudonym"]
        prepared = ask(
            page, "prepare sitting", study=study, participant=person, device="none",
            consent=CONSENT,
        )  # fmt: skip
    with station.page("/ws/participant") as page:
        assert ask(page, "consent", sitting=prepared["sitting"])["type"] == "where"
    return str(prepared["sitting"])


def answers(station: Station, sitting: str, rng: random.Random, most: int) -> int:
    """Answer trials until the connection is lost, or `most` were; how many were acknowledged."""
    done = 0
    lost = contextlib.suppress(OSError, WebSocketException, TimeoutError)
    with lost, station.page("/ws/participant") as page:
        while done < most:
            now = ask(page, "where", sitting=sitting)
            if now["state"] != "trial":
                now = ask(page, "next", sitting=sitting)
            if now["state"] == "finished":
                break
            for place in range(now["surfaces"]):
                ask(page, "feel", sitting=sitting, token=now["token"], place=place)
                ask(page, "surface in place", sitting=sitting)
            answer = ask(
                page, "respond", sitting=sitting, token=now["token"],
                choice=rng.choice(now["alternatives"]) if now["alternatives"] else "",
                estimate=1.0 if now["numeric"] else None, response_time=1.0,
            )  # fmt: skip
            assert answer["type"] == "acknowledged", answer
            done += 1
    return done


def recorded(station: Station, study: str = "one") -> int:
    """Answers in a study's file."""
    path = station.served.folder / "studies" / f"{study}.sqlite"
    with contextlib.closing(sqlite3.connect(path)) as file:
        assert file.execute("PRAGMA integrity_check").fetchone() == ("ok",)
        return int(file.execute("SELECT COUNT(*) FROM response").fetchone()[0])


def disturbed(station: Station, rng: random.Random, pause: float) -> None:
    """One random thing that befalls a lab."""
    time.sleep(rng.uniform(0.0, 1.0))
    what = rng.choice(("kill", "stop", "worker"))
    pid = station.served.process.pid
    if what == "kill":
        os.kill(pid, signal.SIGKILL)
        station.served.process.wait(30)
    elif what == "stop":
        os.kill(pid, signal.SIGSTOP)
        time.sleep(pause)
        os.kill(pid, signal.SIGCONT)
    else:
        for one in station.computing():
            with contextlib.suppress(ProcessLookupError):
                os.kill(one, signal.SIGKILL)


def survived(tmp_path: Path, seed: int, times: int, pause: float) -> None:
    print(f"seed {seed}")
    rng, station = random.Random(seed), Station(tmp_path / "lab")
    total = 0
    for number in range(times):
        study = f"study{number}"
        sitting = sitting_of(station, study)
        own = random.Random(rng.random())
        trouble = threading.Thread(target=disturbed, args=(station, own, pause))
        trouble.start()
        acknowledged = 0
        while trouble.is_alive():
            acknowledged += answers(station, sitting, rng, most=1)
            time.sleep(0.05)
        trouble.join()
        if station.served.process.poll() is not None:
            station.back()
        # What was on its way when the lab was killed may be written, though nobody was told.
        assert acknowledged <= recorded(station, study) <= acknowledged + 1
        acknowledged += answers(station, sitting, rng, most=2)
        assert acknowledged <= recorded(station, study) <= acknowledged + 1
        total += acknowledged
    print(f"{times} times disturbed, {total} answers acknowledged, none lost")
    assert station.served.end() == 0


@pytest.mark.slow
def test_a_killed_lab_loses_no_acknowledged_answer(tmp_path: Path) -> None:
    rng, station = random.Random(1), Station(tmp_path / "lab")
    sitting = sitting_of(station)
    before = answers(station, sitting, rng, most=3)
    with station.page("/ws") as page:
        # A page that asks while the process that computes is killed is told, and asks again.
        text = ask(page, "open display", preset="biet2008-plate")["text"]
        for one in station.computing():
            os.kill(one, signal.SIGKILL)
        told = [
            ask(page, "edit display", text=text, path="drive.voltage", value="9 V") for _ in "ab"
        ]
        assert told[-1]["type"] == "display"
    os.kill(station.served.process.pid, signal.SIGKILL)
    station.back()
    assert recorded(station) == before == 3
    assert answers(station, sitting, rng, most=2) == 2
    os.kill(station.served.process.pid, signal.SIGSTOP)
    threading.Timer(0.3, os.kill, (station.served.process.pid, signal.SIGCONT)).start()
    assert answers(station, sitting, rng, most=2) == 2
    assert recorded(station) == 7
    assert station.served.end() == 0


@pytest.mark.nightly
def test_a_lab_disturbed_at_random_moments_loses_no_acknowledged_answer(tmp_path: Path) -> None:
    survived(tmp_path, random.randrange(10**9), times=20, pause=10.0)
