"""A real browser for the tests marked `chromium`."""

from __future__ import annotations

import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from playwright.sync_api import Browser

_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


@pytest.fixture(scope="session")
def chromium_path() -> str:
    """The system's Chromium. Without one the test is skipped, but fails where CI=true."""
    for name in _NAMES:
        path = shutil.which(name)
        if path is not None:
            return path
    reason = f"no Chromium found (looked for {', '.join(_NAMES)}); install the package chromium"
    if os.environ.get("CI") == "true":
        pytest.fail(f"CI=true must not skip this: {reason}")
    pytest.skip(reason)


# Not for the session: while Playwright runs, its event loop does, and no other test of the process
# could run one of its own.
@pytest.fixture(scope="module")
def browser(chromium_path: str) -> Iterator[Browser]:
    """A running Chromium for all tests of one file."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=chromium_path, args=["--no-sandbox", "--disable-gpu"]
        )
        yield browser
        browser.close()


@pytest.fixture
def chromium(browser: Browser) -> Iterator[Browser]:
    """The file's Chromium; pages that a test opens are closed after it, and draw no more."""
    before = set(browser.contexts)
    yield browser
    for context in set(browser.contexts) - before:
        context.close()


class RunningLab:
    """`squeezefilm lab` in its own process, with the link it printed."""

    def __init__(self, folder: Path, port: int | None = None, *options: str) -> None:
        self.folder = folder
        # A port asked for must be had again: another process may be about to let go of it.
        for _ in range(1 if port is None else 40):
            self._start(port or _free_port(), options)
            if port in (None, self.port):
                return
            self.kill()
            time.sleep(0.25)
        raise AssertionError(f"port {port} was not free again")

    def _start(self, port: int, options: tuple[str, ...]) -> None:
        self.process = subprocess.Popen(
            [
                sys.executable, "-c", "from squeezefilm.cli import main; main()",
                "lab", "--no-browser", "--port", str(port), "--folder", str(self.folder), *options,
            ],
            stdout=subprocess.PIPE,
            text=True,
        )  # fmt: skip
        self._read("--lan" in options)

    @classmethod
    def of(cls, process: subprocess.Popen[str], folder: Path) -> RunningLab:
        """A lab that somebody else started."""
        lab = cls.__new__(cls)
        lab.folder, lab.process = folder, process
        lab._read(tablets=False)
        return lab

    def _read(self, tablets: bool) -> None:
        assert self.process.stdout is not None
        # Whatever port it found free in the end is in the link; the line about files is the last
        # that every lab says, the fingerprint the last of one with tablets.
        end = "fingerprint" if tablets else "files are saved"
        self.said = ""
        for line in self.process.stdout:
            self.said += line
            if end in line:
                break
        found = re.search(r"https?://[\d.]+:(\d+)/\?token=\S+", self.said)
        if found is None:
            self.kill()
            raise AssertionError(f"the lab did not start; it said {self.said!r}")
        self.link, self.port = found[0], int(found[1])
        self.address = self.link.split("?")[0]
        self.cookies: list[Any] = []

    def stop(self) -> int:
        """End it as Ctrl-C does; its exit code."""
        self.process.send_signal(signal.SIGINT)
        code = self.process.wait(30)
        assert self.process.stdout is not None
        self.process.stdout.close()
        return code

    def kill(self) -> None:
        """End it as a crash does."""
        self.process.kill()
        self.process.wait(30)
        assert self.process.stdout is not None
        self.process.stdout.close()


def _free_port() -> int:
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


Start = Callable[..., RunningLab]


@pytest.fixture
def start_lab() -> Iterator[Start]:
    """Starts labs; those that still run at the end of the test are ended as Ctrl-C does."""
    started: list[RunningLab] = []

    def start(folder: Path, port: int | None = None, *options: str) -> RunningLab:
        started.append(RunningLab(folder, port, *options))
        return started[-1]

    yield start
    codes = [lab.stop() for lab in started if lab.process.returncode is None]
    assert codes == [0] * len(codes)


@pytest.fixture(scope="session")
def shared_lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningLab]:
    """A lab for all tests that neither end it nor count on what its folder holds."""
    lab = RunningLab(tmp_path_factory.mktemp("lab"))
    yield lab
    assert lab.stop() == 0


@pytest.fixture
def running_lab(tmp_path: Path, start_lab: Start) -> RunningLab:
    """A lab with an empty folder."""
    return start_lab(tmp_path / "lab")
