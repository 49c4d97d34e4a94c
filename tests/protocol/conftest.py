"""The firmware in C, built once."""

from __future__ import annotations

import pytest

from .builds import Library, Sanitized


@pytest.fixture(scope="session")
def library(tmp_path_factory: pytest.TempPathFactory) -> Library:
    return Library(tmp_path_factory.mktemp("firmware"))


# The same C; what has no sanitizer runs in CI.
@pytest.fixture(
    scope="session", params=[pytest.param("plain", marks=pytest.mark.slow), "sanitized"]
)
def firmware(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Library | Sanitized:
    if request.param == "sanitized":
        return Sanitized(tmp_path_factory.mktemp("sanitized"))
    made: Library = request.getfixturevalue("library")
    return made
