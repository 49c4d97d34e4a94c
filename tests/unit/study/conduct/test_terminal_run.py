"""A session at the terminal: nothing else writes there while a person is asked."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

import pytest

from squeezefilm.core.progress import SayProgress
from squeezefilm.study.conduct.run import Presentation
from squeezefilm.study.conduct.terminal_run import Desk, run_session
from squeezefilm.study.record.store import StudyStore

from ..scripted import Script, gratings


def test_what_goes_on_is_shown_only_while_nobody_is_asked(tmp_path: Path) -> None:
    shown, asked, told = [0], [0], [0]

    @contextlib.contextmanager
    def progress() -> Iterator[SayProgress]:
        shown[0] += 1
        yield lambda _: None
        shown[0] -= 1

    class Person(Script):
        """Sees what is on the screen."""

        def ask(self, presentation: Presentation) -> str | float:
            """An answer, to a line that nothing rubs out."""
            asked[0] += 1
            assert shown[0] == 0
            return super().ask(presentation)

        def feel(self, presentation: Presentation, place: int) -> None:
            """Long enough."""
            assert shown[0] == 0

    def tell(_: str) -> None:
        told[0] += 1
        assert shown[0] == 0

    with StudyStore.create(tmp_path / "a.sqlite", gratings(), 7) as store:
        desk = Desk(tell=tell, consent=True)
        run_session(store, None, desk, Person(), progress=progress)
    assert asked[0] == 6
    assert told[0] == 1


@pytest.mark.slow
def test_the_cursor_is_there_while_a_line_is_typed(tmp_path: Path) -> None:
    """The program as it is, at a terminal: hidden and shown as often before the first question."""
    pty = pytest.importorskip("pty", reason="there are no pseudo-terminals here")
    import os
    import subprocess
    import sys
    import time

    ours, theirs = pty.openpty()
    command = ["run", "biet2008-gratings", "--store", str(tmp_path / "a.sqlite"), "--consent"]
    program = "from squeezefilm.cli import main; main()"
    with subprocess.Popen(
        [sys.executable, "-c", program, "study", *command],
        stdin=theirs,
        stdout=theirs,
        stderr=theirs,
        env={**os.environ, "TERM": "xterm"},
        start_new_session=True,
    ) as child:
        os.close(theirs)
        said = b""
        while b"press Enter" not in said:
            said += os.read(ours, 1000)
        # A spinner would turn some ten times a second.
        time.sleep(0.3)
        os.write(ours, b"\n")
        while said.count(b"press Enter") < 2:
            said += os.read(ours, 1000)
        child.kill()
    os.close(ours)
    first = said.index(b"press Enter")
    assert said.count(b"\x1b[?25l", 0, first) == said.count(b"\x1b[?25h", 0, first)
    assert b"\x1b[" not in said[first:]
