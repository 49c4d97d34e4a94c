"""A real browser for the tests marked `chromium`."""

from __future__ import annotations

import os
import shutil

import pytest

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
