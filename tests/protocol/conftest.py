"""The firmware in C, built once."""

from __future__ import annotations

import pytest

from .builds import Library, Sanitized


@pytest.fixture(scope="session")
def library(tmp_path_factory: pytest.TempPathFactory) -> Library:
    return Library(tmp_path_factory.mktemp("firmware"))


# The same C; under sanitizers, which take twice as long, CI runs it.
@pytest.fixture(
    scope="session", params=["plain", pytest.param("sanitized", marks=pytest.mark.slow)]
)
def firmware(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Library | Sanitized:
    if request.param == "sanitized":
        return Sanitized(tmp_path_factory.mktemp("sanitized"))
    made: Library = request.getfixturevalue("library")
    return made
