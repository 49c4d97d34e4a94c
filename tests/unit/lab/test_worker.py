"""Work in a process of its own: newest wins, and nothing takes for ever or eats the memory."""

from __future__ import annotations

import asyncio
import os
import signal
import sys
import threading
import time
from collections.abc import Coroutine
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.core.errors import ConfigError, SqueezefilmError
from squeezefilm.lab import worker
from squeezefilm.lab.designing.form import name_of
from squeezefilm.lab.worker import PAGE, Busy, SupersededError

LONG = 600.0


@pytest.fixture(scope="module")
def busy() -> Any:
    """One process for all tests, where they do not end it; it starts in a second or more."""
    one = Busy(LONG)
    yield one
    one.close()


class InThread:
    """A process of work without a process: what is asked runs in the thread that asks."""

    def __init__(self) -> None:
        self.ended = threading.Event()

    def ask(self, work: Any, arguments: Any, told: Any) -> tuple[bool, Any]:
        if work is endless:
            Path(arguments[0]).write_text(str(id(self)))
            self.ended.wait(LONG)
        if work is ends_itself or self.ended.is_set():
            raise EOFError
        return True, id(self)

    def end(self) -> None:
        self.ended.set()


@pytest.fixture(params=["thread", pytest.param("process", marks=pytest.mark.slow)])
def started(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """What answers: threads of this process, or processes."""
    begun: list[InThread] = []

    def start() -> InThread:
        begun.append(InThread())  # kept, so that none gets the number of one before
        return begun[-1]

    if request.param == "thread":
        monkeypatch.setattr(worker._Process, "started", start)


def play(work: Coroutine[Any, Any, None]) -> None:
    asyncio.run(asyncio.wait_for(work, 120))


async def begun(file: Path) -> int:
    """The process of a piece of work that says that it began."""
    while not file.exists() or not file.read_text():
        await asyncio.sleep(0.01)
    return int(file.read_text())


def endless(file: str) -> None:
    """Work that says where it runs and never ends."""
    Path(file).write_text(str(os.getpid()))
    time.sleep(LONG)


def forgets_itself(size: int) -> int:
    """Work that needs memory."""
    return len(bytearray(size))


def goes_on() -> str:
    """Work that says how far it is."""
    for share in (0.0, 0.5):
        worker.tell(f"step {share}", share)
        time.sleep(0.15)
    return "done"


def where() -> int:
    """The process it runs in."""
    return os.getpid()


def ends_itself() -> None:
    """Work that its process does not outlive."""
    os._exit(3)


def test_work_says_how_far_it_is_to_whom_it_was_asked_for(busy: Busy) -> None:
    heard: list[tuple[str, float]] = []

    async def asked() -> None:
        assert await busy.do(None, goes_on, told=lambda *said: heard.append(said)) == "done"
        assert heard == [("step 0.0", 0.0), ("step 0.5", 0.5)]
        # Nobody listens to the next one.
        assert await busy.do(None, goes_on) == "done"
        assert len(heard) == 2

    play(asked())
    worker.tell("outside such a process nothing is said", 0.5)


@pytest.mark.usefixtures("started")
def test_work_that_takes_too_long_is_ended_and_the_next_is_done(tmp_path: Path) -> None:
    async def work() -> None:
        longest = 0.2
        busy = Busy(longest)
        with pytest.raises(SqueezefilmError, match=rf"more than {longest:g} s.*ask for less"):
            await busy.do("slot", endless, str(tmp_path / "a"))
        busy._longest = LONG
        first = await busy.do(None, where)
        with pytest.raises(SqueezefilmError, match="starts again with the next request"):
            await busy.do(None, ends_itself)
        assert await busy.do(None, where) != first
        busy.close()

    play(work())


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="limits of memory are Linux's")
def test_work_that_needs_too_much_memory_is_refused_and_the_process_goes_on(busy: Busy) -> None:
    async def work() -> None:
        process = await busy.do(None, where)
        assert await busy.do(None, forgets_itself, 1000) == 1000
        with pytest.raises(SqueezefilmError, match=r"more than 2 GiB of memory.*ask for less"):
            await busy.do(None, forgets_itself, worker.LARGEST_MEMORY)
        assert await busy.do(None, where) == process

    play(work())


def test_what_work_raises_keeps_its_type_and_place(busy: Busy) -> None:
    async def work() -> None:
        with pytest.raises(ConfigError, match="there is no value") as error:
            await busy.do(None, name_of, "name = ")
        assert error.value.__class__ is ConfigError
        assert "there is no value" in error.value.message

    play(work())


@pytest.mark.usefixtures("started")
def test_newest_wins_and_cancel_ends_what_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(worker, "GRACE", 0.01)

    async def work() -> None:
        busy = Busy(LONG)

        def asked(name: str, **options: Any) -> asyncio.Task[None]:
            file = str(tmp_path / name)
            return asyncio.create_task(busy.do("slot", endless, file, **options))

        PAGE.set("one page")  # type: ignore[arg-type]
        first = asked("first", gives_way=True)
        process = await begun(tmp_path / "first")
        second = asked("second", gives_way=True)
        with pytest.raises(SupersededError):
            await first
        assert await begun(tmp_path / "second") != process
        # Waiting work of a slot goes at once; that of other pages does not.
        third = asked("third")
        PAGE.set("another page")  # type: ignore[arg-type]
        other = asyncio.create_task(busy.do("slot", where))
        await asyncio.sleep(0)
        busy.cancel("another page")  # type: ignore[arg-type]
        busy.cancel("one page")  # type: ignore[arg-type]
        with pytest.raises((SqueezefilmError, SupersededError)):
            await second
        await begun(tmp_path / "third")
        # What would not give way ends with the lab only.
        busy.cancel("one page")  # type: ignore[arg-type]
        busy.close()
        with pytest.raises(SqueezefilmError, match="ended"):
            await third
        assert await other > 0
        busy.close()

    play(work())


@pytest.mark.usefixtures("started")
def test_work_ends_with_its_page_unless_it_writes(tmp_path: Path) -> None:
    async def work() -> None:
        busy = Busy(LONG)
        for gives_way in (True, False):
            file = tmp_path / str(gives_way)
            task = asyncio.create_task(busy.do(None, endless, str(file), gives_way=gives_way))
            process = await begun(file)
            task.cancel()
            with pytest.raises(asyncio.CancelledError):
                await task
            if gives_way:
                assert await busy.do(None, where) != process
            else:
                assert busy._running is not None
                assert busy._running.ended_because is None
        busy.close()

    play(work())


@pytest.mark.nightly
def test_a_stopped_process_is_ended_by_its_time() -> None:
    async def work() -> None:
        busy = Busy(LONG)
        process = await busy.do(None, where)
        busy._longest = 1.0
        os.kill(process, signal.SIGSTOP)
        with pytest.raises(SqueezefilmError, match="more than 1 s"):
            await busy.do(None, where)
        busy._longest = LONG
        assert await busy.do(None, where) != process
        busy.close()

    play(work())


def test_only_what_would_give_way_and_was_asked_by_the_page_is_cancelled(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    busy = Busy(LONG)
    one, other = "one page", "another page"
    jobs: list[Any] = [
        SimpleNamespace(page=page, gives_way=gives_way)
        for page, gives_way in ((one, True), (one, False), (other, True), (one, True))
    ]
    busy._jobs = jobs
    ended: list[tuple[Any, str]] = []
    monkeypatch.setattr(busy, "_end", lambda job, why: ended.append((job, str(why))))
    busy.cancel(one)  # type: ignore[arg-type]
    assert ended == [(jobs[at], "the computation was cancelled") for at in (0, 3)]
