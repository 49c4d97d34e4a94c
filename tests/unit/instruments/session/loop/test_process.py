"""What the loop's process refuses before it is started; tests/faults plays with a real one."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace

import pytest

from squeezefilm.core.errors import InputError, LoopError
from squeezefilm.instruments.session.loop import process
from squeezefilm.instruments.session.loop.plan import LoopPlan
from squeezefilm.instruments.session.loop.process import LoopProcess

Plans = Callable[..., LoopPlan]


def test_a_system_without_posix_processes_is_told_so(
    plan_of: Plans, monkeypatch: pytest.MonkeyPatch
) -> None:
    loop = LoopProcess(plan_of(), priority=None)
    monkeypatch.setattr(process, "os", SimpleNamespace(name="nt"))
    with pytest.raises(LoopError, match="shares memory by file descriptor"):
        loop.start()


@pytest.mark.parametrize("priority", [0, 100])
def test_a_priority_is_one_of_the_systems(plan_of: Plans, priority: int) -> None:
    with pytest.raises(InputError, match=f"priority = {priority} cannot be used"):
        LoopProcess(plan_of(), priority=priority)
