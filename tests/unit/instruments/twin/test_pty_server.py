"""The way through a pseudo-terminal that a patient twin leaves out of its watchdog's time."""

from __future__ import annotations

import contextlib
import os
import select
import sys

import pytest

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="needs pseudo-terminals")


def test_a_byte_on_its_way_says_since_when_until_it_is_there() -> None:
    from squeezefilm.instruments.twin.pty_server import _Way

    with contextlib.closing(_Way()) as way:
        assert way.held_up_since(100) == 100
        # Taken away as it arrives, it is still on its way for all that the twin knows.
        assert select.select([way._near], [], [], 30)[0]
        os.read(way._near, 1)
        assert way.held_up_since(200) == 100
        assert way.held_up_since(300) == 100
        os.write(way._far, bytes(1))
        assert select.select([way._near], [], [], 30)[0]
        # There; and the next is sent.
        assert way.held_up_since(400) == 400
        assert select.select([way._near], [], [], 30)[0]
        assert way.held_up_since(500) == 500
