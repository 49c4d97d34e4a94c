"""The bodies that several tests of plates begin with."""

from __future__ import annotations

import pytest

from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import DiscPlate


@pytest.fixture(scope="session")
def disc() -> DiscPlate:
    """A glass disc on a ceramic disc, in the mode with one nodal circle."""
    actuator = load_display("winfield2007-tpad").actuator
    assert isinstance(actuator, DiscPlate)
    return actuator
