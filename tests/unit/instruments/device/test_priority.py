"""Priority and garbage of what has deadlines: what is asked of the system, and what it answers."""

from __future__ import annotations

import gc
import os
import weakref
from typing import Any

import pytest

from squeezefilm.instruments.device.priority import (
    PLAYERS_PRIORITY,
    collect_garbage_first,
    real_time_granted,
)

pytestmark = pytest.mark.skipif(not hasattr(os, "sched_param"), reason="no such scheduler")


def test_this_thread_is_to_be_scheduled_first_in_first_out(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[tuple[Any, ...]] = []
    # Not the real one: as root it would be granted, for all tests after this.
    monkeypatch.setattr(os, "sched_setscheduler", lambda *how: asked.append(how))
    assert real_time_granted(42) is True
    ((thread, policy, how),) = asked
    assert (thread, policy, how.sched_priority) == (0, os.SCHED_FIFO, 42)


@pytest.mark.parametrize("error", [PermissionError, OSError])
def test_a_refusal_is_an_answer(monkeypatch: pytest.MonkeyPatch, error: type[OSError]) -> None:
    def refused(*_: object) -> None:
        raise error

    monkeypatch.setattr(os, "sched_setscheduler", refused)
    assert real_time_granted(10) is False


def test_a_system_without_such_priorities_grants_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(os, "sched_setscheduler")
    assert real_time_granted(10) is False


def test_a_player_has_a_priority_that_the_system_knows() -> None:
    lowest, highest = (
        os.sched_get_priority_min(os.SCHED_FIFO),
        os.sched_get_priority_max(os.SCHED_FIFO),
    )
    assert lowest <= PLAYERS_PRIORITY < highest


class Loop:
    """A thing that holds itself."""

    def __init__(self) -> None:
        self.me = self


def test_garbage_goes_and_what_is_left_is_never_looked_at_again() -> None:
    was = gc.isenabled()
    gc.disable()
    gone = weakref.ref(Loop())
    try:
        assert gone() is not None
        collect_garbage_first()
        assert gone() is None
        assert gc.get_freeze_count() > 1000
        assert not any(isinstance(one, Loop) for one in gc.get_objects())
    finally:
        gc.unfreeze()
        if was:
            gc.enable()
