"""Displays that tests of several rooms ask for."""

import pytest

from squeezefilm.display import Display, load_display


@pytest.fixture(scope="session")
def stator() -> Display:
    """The paper's stator: measured, so that nothing of it is solved."""
    return load_display("biet2008-stator")
