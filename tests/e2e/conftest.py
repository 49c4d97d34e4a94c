"""A real browser for the tests marked `chromium`."""

from __future__ import annotations

import os
import re
import shutil
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

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


@pytest.fixture(scope="session")
def chromium(chromium_path: str) -> Iterator[Browser]:
    """A running Chromium for all tests of one process."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium_path, args=["--no-sandbox"])
        yield browser
        browser.close()


class RunningLab:
    """`squeezefilm lab` in its own process, with the link it printed."""

    def __init__(self, folder: Path, port: int | None = None, *options: str) -> None:
        if port is None:
            with socket.socket() as one:
                one.bind(("127.0.0.1", 0))
                port = one.getsockname()[1]
        self.folder = folder
        self.process = subprocess.Popen(
            [
                sys.executable, "-c", "from squeezefilm.cli import main; main()",
                "lab", "--no-browser", "--port", str(port), "--folder", str(folder), *options,
            ],
            stdout=subprocess.PIPE,
            text=True,
        )  # fmt: skip
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        found = re.search(r"https?://[\d.]+:(\d+)/\?token=\S+", line)
        assert found, line
        self.link, self.port = found[0], int(found[1])
        self.address = self.link.split("?")[0]

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


@pytest.fixture
def running_lab(tmp_path: Path) -> Iterator[RunningLab]:
    """A lab with an empty folder."""
    lab = RunningLab(tmp_path / "lab")
    yield lab
    assert lab.stop() == 0
